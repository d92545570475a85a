//! Estimates of discretisation errors. The error measure checks the laws on the given mesh only; the mesh may be too
//! coarse.
//!
//! The estimates are dimensionless and need no reference solution; doc/method/estimates.md derives them and gives their
//! measured accuracy.

mod corner;
mod discretisation;
mod graph;
mod hertz;
mod locking;
mod recovery;
mod strains;
mod stresses;
mod zone;

use crate::body::model::Model;
use crate::solver::problem::ProblemError;
use crate::solver::problem::error::expect_length;
use recovery::Places;
use strains::Strains;

pub use discretisation::DiscretisationError;
pub(crate) use discretisation::error_of_force;
pub use graph::ContactGraph;
pub use hertz::HertzContact;
pub(crate) use locking::expected_locking;
pub(crate) use stresses::StressRecovery;
pub use zone::{ContactEstimate, PeakOf, StickZone, peak_error};
pub(crate) use zone::{NOTHING, PeakZone, SlipZones, largest_error};

/// Estimates of locking and of the mesh error, from the strains of the body.
#[derive(Debug, Clone, PartialEq)]
pub struct ElementEstimate {
    /// The approximate share by which locking makes the body too stiff; accurate to a factor of two where it is below
    /// 1. `None` if no cell can lock.
    pub locking: Option<f64>,
    /// The error of the mesh in the energy norm; `None` if too few cells of second order are connected, or if single layers of
    /// linear cells hide it.
    pub discretisation: Option<DiscretisationError>,
    /// The root mean square of the magnitude of the strains, weighted by the strain energy.
    pub strain: f64,
}

impl ElementEstimate {
    /// Estimates both errors from the `displacements` of all nodes (m) at time `t` (s). The reference configuration is
    /// free of strain except for the thermal loads of that time.
    ///
    /// # Errors
    /// If `displacements` does not have one entry for each node of the mesh.
    pub fn of(model: &Model, t: f64, displacements: &[[f64; 3]]) -> Result<Self, ProblemError> {
        expect_length("displacements", model.mesh.nodes.len(), displacements.len(), "one for each node of the mesh")?;
        Ok(Self::new(model, &model.thermal_factors(t), displacements, &[]))
    }

    /// Estimates both errors for displacements of the right length, with the `factors` of `Model::thermal_factors` and
    /// the closed contact nodes without a closed neighbour, `pressed`.
    pub fn new(model: &Model, factors: &[f64], displacements: &[[f64; 3]], pressed: &[usize]) -> Self {
        let strains = Strains::new(model, factors, displacements);
        if strains.are_rounding(displacements) {
            return ElementEstimate { locking: None, discretisation: None, strain: 0.0 };
        }
        let places = Places::new(model);
        ElementEstimate {
            locking: locking::locking(model, &places, &strains, pressed),
            discretisation: DiscretisationError::new(model, &places, &strains),
            strain: strains.magnitude(),
        }
    }
}
