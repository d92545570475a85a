//! What a body stands on elastically.

use super::load::{Where, components};
use crate::base::input_error::{InputError, ensure, finite};
use crate::base::units::UnitSystem;

/// An elastic foundation of a boundary, or a spring at the node at a point; it is without force in the undeformed body.
#[derive(Debug, Clone, PartialEq)]
pub enum Bed {
    /// Stiffness along the axes.
    Axes {
        /// The boundary or the point.
        at: Where,
        /// Two components or three: N/m³ of a boundary, N/m at a point (in two dimensions per m of depth).
        stiffness: Vec<f64>,
    },
    /// Stiffness along the normal of a boundary and across it.
    Surface {
        /// The boundary.
        boundary: String,
        /// Along the normal, N/m³.
        normal: f64,
        /// Across it, N/m³.
        tangential: f64,
    },
}

impl Bed {
    /// A foundation that stands against motion along the normal of `boundary` with the stiffness `normal` (N/m³), and across
    /// it with `tangential` (N/m³).
    pub fn surface(boundary: &str, normal: f64, tangential: f64) -> Self {
        Bed::Surface { boundary: boundary.to_string(), normal, tangential }
    }

    /// What stands on it, in words, with coordinates in `units`.
    pub fn place(&self, units: &UnitSystem) -> String {
        match self {
            Bed::Axes { at, .. } => at.place(units),
            Bed::Surface { boundary, .. } => boundary.clone(),
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
            Bed::Surface { normal, tangential, .. } => {
                finite("normal", *normal)?;
                finite("tangential", *tangential)?;
                stiff("normal", &[*normal, *tangential])
            }
        }
    }
}
