//! Supports of a body.

use super::Axis;
use super::load::{Where, direction};
use crate::algebra::vector::Vector;
use crate::base::input_error::{InputError, ensure, finite};
use crate::base::timeline::check_points;

/// Prescribed displacements, zero or not, of a boundary, of the node at a point, or of the reference point of a coupling.
#[derive(Debug, Clone, PartialEq)]
pub struct Support {
    /// The boundary, the point or the coupling.
    pub at: Where,
    /// The directions and their displacements.
    pub held: Vec<Held>,
    /// Points `[time (s), factor]` of the factor of all displacements, with increasing times: linear between them,
    /// constant outside. Default: the factor grows from 0 at the beginning to 1 at the end.
    pub history: Option<Vec<[f64; 2]>>,
}

/// A prescribed displacement along one direction.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Held {
    /// The direction.
    pub direction: Direction,
    /// The displacement at factor 1, m; for a rotation the angle, rad.
    pub displacement: f64,
}

/// A direction along which a support prescribes the displacement.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Direction {
    /// An axis of coordinates.
    Axis(Axis),
    /// The outward normal of the boundary; at each node the mean over its facets.
    Normal,
    /// A vector of any length.
    Along(Vector),
    /// The rotation of the reference point of a coupling about an axis of coordinates.
    Rotation(Axis),
}

impl Support {
    /// Creates a support that fixes the displacements of `boundary` along `axes` at zero.
    pub fn new(boundary: &str, axes: &[Axis]) -> Self {
        let held = axes.iter().map(|axis| Held { direction: Direction::Axis(*axis), displacement: 0.0 });
        Support { at: Where::Boundary(boundary.to_string()), held: held.collect(), history: None }
    }

    /// Creates a support that fixes the normal displacement of `boundary` at zero; the boundary can slide tangentially.
    pub fn normal(boundary: &str) -> Self {
        Support { held: vec![Held { direction: Direction::Normal, displacement: 0.0 }], ..Support::new(boundary, &[]) }
    }

    /// Creates a support that moves `boundary` along `direction` by `displacement` (m) from the beginning to the end.
    pub fn along(boundary: &str, direction: impl Into<Vector>, displacement: f64) -> Self {
        let held = vec![Held { direction: Direction::Along(direction.into()), displacement }];
        Support { held, ..Support::new(boundary, &[]) }
    }

    /// Applies the support to the node at `point` (m) only.
    #[must_use]
    pub fn at(self, point: impl Into<Vector>) -> Self {
        Support { at: Where::Point(point.into()), ..self }
    }

    /// Applies the support to the reference point of a coupling; `axes` are the axes of the rotations that it fixes at zero
    /// in addition to the displacements.
    #[must_use]
    pub fn of_coupling(mut self, name: &str, axes: &[Axis]) -> Self {
        let rotations = axes.iter().map(|axis| Held { direction: Direction::Rotation(*axis), displacement: 0.0 });
        self.held.extend(rotations);
        Support { at: Where::Coupling(name.to_string()), ..self }
    }

    /// Sets the displacements (m), one for each direction, from the beginning to the end.
    #[must_use]
    pub fn moved(mut self, displacements: &[f64]) -> Self {
        self.held.iter_mut().zip(displacements).for_each(|(held, to)| held.displacement = *to);
        self
    }

    /// Sets the history of the factor of the displacements: points `[time (s), factor]`.
    #[must_use]
    pub fn over(self, history: &[[f64; 2]]) -> Self {
        Support { history: Some(history.to_vec()), ..self }
    }

    /// Returns the points `[time (s), factor]` of the history; the default history ends at `end` (s).
    pub fn factors(&self, end: f64) -> Vec<[f64; 2]> {
        self.history.clone().unwrap_or_else(|| vec![[0.0, 0.0], [end, 1.0]])
    }

    /// Returns `true` if a prescribed displacement is not zero.
    pub fn moves(&self) -> bool {
        self.held.iter().any(|held| held.displacement != 0.0)
    }

    pub(super) fn check(&self) -> Result<(), InputError> {
        self.at.check()?;
        if self.held.is_empty() {
            return Err(InputError::new("fix", "fix is empty, so the support holds nothing", "use [\"x\", \"y\"]"));
        }
        for Held { direction: along, displacement } in &self.held {
            finite("displacement", *displacement)?;
            match along {
                Direction::Axis(_) => {}
                Direction::Normal => {
                    let sound = matches!(self.at, Where::Boundary(_));
                    let help = "name a boundary, or give a direction";
                    ensure(sound, "fix", &"normal", "an axis where a single point is held", help)?;
                }
                Direction::Along(vector) => direction("direction", *vector)?,
                Direction::Rotation(_) => {
                    let sound = matches!(self.at, Where::Coupling(_));
                    let help = "name a coupling, whose reference point can turn, or remove the rotation";
                    ensure(sound, "fix", &"rotation", "x, y, z or normal where there is no coupling", help)?;
                }
            }
        }
        self.history.as_ref().map_or(Ok(()), |history| check_points("history", "factor", history))
    }
}
