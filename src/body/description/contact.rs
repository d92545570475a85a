//! Boundaries that can touch obstacles or another boundary.

use super::Opposite;
use crate::base::formula::Field;
use crate::base::input_error::{InputError, each, ensure, finite};
use crate::base::timeline::check_points;
use crate::body::contact::Obstacle;

/// A boundary that can touch obstacles or another boundary.
#[derive(Debug, Clone, PartialEq)]
pub struct Contact {
    /// The boundary.
    pub boundary: String,
    /// Coulomb's friction coefficient `μ ≥ 0`. If two contacts share a node and its normal, the coefficient there is
    /// the mean of both, weighted by the node's area in each contact.
    pub friction: Field,
    /// Points `[time (s), factor]` with increasing times and factors of 0 or more that multiply the coefficient: linear
    /// between the points, constant outside. Without them the coefficient is constant.
    pub friction_history: Option<Vec<[f64; 2]>>,
    /// The opposite side of the contact.
    pub against: Against,
}

/// The opposite side of a contact: rigid obstacles or another boundary.
#[derive(Debug, Clone, PartialEq)]
pub enum Against {
    /// Rigid obstacles, at least one. A node meets the obstacle that is nearest at the beginning of the history among
    /// those that its outside faces. Among obstacles with the same normal it meets the nearest at each time.
    Obstacles(Vec<Obstacle>),
    /// Another boundary, usually of another body.
    Boundary(Opposite),
}

impl<T: Into<Vec<Obstacle>>> From<T> for Against {
    fn from(obstacles: T) -> Self {
        Against::Obstacles(obstacles.into())
    }
}

impl Contact {
    /// Creates a contact of `boundary` whose friction is constant.
    pub(super) fn new(boundary: &str, friction: impl Into<Field>, against: Against) -> Self {
        Contact { boundary: boundary.to_string(), friction: friction.into(), friction_history: None, against }
    }

    /// Returns the obstacles; empty if the contact is against another boundary.
    pub fn obstacles(&self) -> &[Obstacle] {
        match &self.against {
            Against::Obstacles(obstacles) => obstacles,
            Against::Boundary(_) => &[],
        }
    }

    /// Returns the opposite boundary, if the contact has one.
    pub fn opposite(&self) -> Option<&Opposite> {
        match &self.against {
            Against::Obstacles(_) => None,
            Against::Boundary(opposite) => Some(opposite),
        }
    }

    /// Returns the key of obstacle `j` of this contact, where `k` is the number of the contact.
    pub(crate) fn obstacle_key(&self, k: usize, j: usize) -> String {
        match self.obstacles().len() {
            1 => format!("contact[{k}].obstacle"),
            _ => format!("contact[{k}].obstacle[{j}]"),
        }
    }

    /// Checks a contact, also against the `earlier` ones.
    pub(super) fn check(&self, earlier: &[Contact]) -> Result<(), InputError> {
        if earlier.iter().any(|other| other.boundary == self.boundary) {
            let message = format!("the boundary `{}` has a [[contact]] already", self.boundary);
            let help = match self.opposite() {
                None => "keep one [[contact]] for each boundary",
                Some(_) => {
                    "keep one [[contact]] for each boundary: against may be a list of all that is in front of it"
                }
            };
            return Err(InputError::new("boundary", message, help));
        }
        if let Field::Uniform(coefficient) = self.friction {
            finite("friction", coefficient)?;
            let help = "give Coulomb's coefficient, 0 for a frictionless contact";
            ensure(coefficient >= 0.0, "friction", &coefficient, "0 or more", help)?;
        }
        if let Some(history) = &self.friction_history {
            check_points("friction_history", "factor", history)?;
            let is_valid = history.iter().all(|point| point[1] >= 0.0);
            ensure(is_valid, "friction_history", history, "of factors from 0 on", "friction cannot be negative")?;
        }
        match &self.against {
            Against::Boundary(opposite) => self.check_opposite(opposite),
            Against::Obstacles(obstacles) => match &obstacles[..] {
                [] => {
                    let message = format!("there is no obstacle in front of `{}`", self.boundary);
                    Err(InputError::new("obstacle", message, "give an obstacle, or remove the contact"))
                }
                [obstacle] => obstacle.check().map_err(|fault| fault.with_key("obstacle")),
                all => each("obstacle", all, |_, obstacle| obstacle.check()).map(drop),
            },
        }
    }

    fn check_opposite(&self, opposite: &Opposite) -> Result<(), InputError> {
        opposite.check()?;
        if opposite.boundaries.contains(&self.boundary) {
            let message = format!("the boundary `{}` is against itself", self.boundary);
            return Err(InputError::new("against", message, "name the boundary that is in front of it"));
        }
        if opposite.glued && (self.friction != Field::Uniform(0.0) || self.friction_history.is_some()) {
            let help = "remove the friction, or glue";
            return Err(InputError::new("friction", "what is glued does not slide, so that it has no friction", help));
        }
        Ok(())
    }
}
