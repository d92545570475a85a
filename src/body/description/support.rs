//! Supports, springs and elastic foundations, which hold a body.

use super::Axis;
use super::load::{Where, axial, components, direction};
use crate::algebra::vector::Vector;
use crate::base::input_error::{InputError, ensure, finite};
use crate::base::timeline::check_points;
use crate::base::units::UnitSystem;

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
                    let is_valid = matches!(self.at, Where::Boundary(_));
                    let help = "name a boundary, or give a direction";
                    ensure(is_valid, "fix", &"normal", "an axis where a single point is held", help)?;
                }
                Direction::Along(vector) => direction("direction", *vector)?,
                Direction::Rotation(_) => {
                    let is_valid = matches!(self.at, Where::Coupling(_));
                    let help = "name a coupling, whose reference point can turn, or remove the rotation";
                    ensure(is_valid, "fix", &"rotation", "x, y, z or normal where there is no coupling", help)?;
                }
            }
        }
        self.history.as_ref().map_or(Ok(()), |history| check_points("history", "factor", history))
    }
}

/// An elastic foundation of a boundary, or a spring at the node at a point. Its force in the undeformed body is 0.
#[derive(Debug, Clone, PartialEq)]
pub enum Bed {
    /// Stiffness along the axes.
    Axes {
        /// The boundary, the point or the coupling.
        at: Where,
        /// Two or three components: N/m³ for a boundary, N/m at a point or a coupling (in two dimensions per m of depth).
        stiffness: Vec<f64>,
    },
    /// Stiffness of the rotation of the reference point of a coupling.
    Rotational {
        /// The name of the coupling.
        coupling: String,
        /// The moment per angle about z in two dimensions, N m per m of depth; about x, y and z in three, N m.
        rotational: Vec<f64>,
    },
    /// Stiffness along the normal of a boundary and tangentially.
    Surface {
        /// The boundary.
        boundary: String,
        /// The stiffness along the normal, N/m³.
        normal: f64,
        /// The tangential stiffness, N/m³.
        tangential: f64,
    },
}

impl Bed {
    /// Creates a foundation of `boundary` with the stiffness `normal` (N/m³) along the normal and `tangential` (N/m³)
    /// across it.
    pub fn surface(boundary: &str, normal: f64, tangential: f64) -> Self {
        Bed::Surface { boundary: boundary.to_string(), normal, tangential }
    }

    /// Describes what the spring acts on, with coordinates in `units`.
    pub fn location(&self, units: &UnitSystem) -> String {
        match self {
            Bed::Axes { at, .. } => at.location(units),
            Bed::Rotational { coupling: name, .. } | Bed::Surface { boundary: name, .. } => name.clone(),
        }
    }

    /// Returns the name of the coupling that it acts on.
    pub(crate) fn coupling(&self) -> Option<&str> {
        match self {
            Bed::Axes { at, .. } => at.coupling(),
            Bed::Rotational { coupling, .. } => Some(coupling),
            Bed::Surface { .. } => None,
        }
    }

    pub(super) fn check(&self) -> Result<(), InputError> {
        let help = "give stiffnesses of 0 or more, not all of them 0";
        let stiff = |key: &str, values: &[f64]| {
            let is_valid = values.iter().all(|k| *k >= 0.0) && values.iter().any(|k| *k > 0.0);
            ensure(is_valid, key, &values, "0 or more, and not 0 throughout", help)
        };
        match self {
            Bed::Axes { at, stiffness } => {
                at.check()?;
                components("stiffness", stiffness)?;
                stiff("stiffness", stiffness)
            }
            Bed::Rotational { rotational, .. } => {
                axial("rotational", rotational)?;
                stiff("rotational", rotational)
            }
            Bed::Surface { normal, tangential, .. } => {
                finite("normal", *normal)?;
                finite("tangential", *tangential)?;
                stiff("normal", &[*normal, *tangential])
            }
        }
    }
}
