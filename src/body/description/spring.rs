//! Springs and elastic foundations.

use super::load::{Where, axial, components};
use crate::base::input_error::{InputError, ensure, finite};
use crate::base::units::UnitSystem;

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
    pub fn place(&self, units: &UnitSystem) -> String {
        match self {
            Bed::Axes { at, .. } => at.place(units),
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
            let sound = values.iter().all(|k| *k >= 0.0) && values.iter().any(|k| *k > 0.0);
            ensure(sound, key, &values, "0 or more, and not 0 throughout", help)
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
