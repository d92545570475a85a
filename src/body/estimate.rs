//! What the error measure does not see: the laws hold on the mesh that there is, but the mesh may be too coarse to tell.
//!
//! The numbers are estimates, free of units and without a reference; doc/estimates.md says where they come from and how far
//! they were right.

mod corner;
mod discretisation;
mod graph;
mod hertz;
mod locking;
mod places;
mod recovery;
mod slip;
mod strains;
mod zone;

use crate::body::model::Model;
use crate::solver::problem::ProblemError;
use crate::solver::problem::error::expect_length;
use places::Places;
use strains::Strains;

pub use discretisation::DiscretisationError;
pub use graph::ContactGraph;
pub use hertz::HertzContact;
pub(crate) use locking::expected_locking;
pub(crate) use slip::SlipZones;
pub use zone::{ContactEstimate, PeakOf, StickZone, peak_error};

/// What the strains of a body tell of its elements.
#[derive(Debug, Clone, PartialEq)]
pub struct ElementEstimate {
    /// By what share the body is too stiff because elements lock, about: within a factor of two where it is below 1. None where no
    /// cell can lock.
    pub locking: Option<f64>,
    /// The error of the mesh in the energy norm; none where too few cells of second order hang together.
    pub discretisation: Option<DiscretisationError>,
}

impl ElementEstimate {
    /// Of a body with these `displacements` of all nodes (m) at time `t` (s), which count from where nothing is strained but by
    /// the loads by temperature of that time.
    ///
    /// # Errors
    /// When there is not one displacement for each node of the mesh.
    pub fn of(model: &Model, t: f64, displacements: &[[f64; 3]]) -> Result<Self, ProblemError> {
        expect_length("displacements", model.mesh.nodes.len(), displacements.len(), "one for each node of the mesh")?;
        Ok(Self::new(model, &model.thermal_factors(t), displacements, &[]))
    }

    /// The same of displacements that fit, with the `factors` of `Model::thermal_factors`, and the nodes that a contact presses alone.
    pub fn new(model: &Model, factors: &[f64], displacements: &[[f64; 3]], pressed: &[usize]) -> Self {
        let strains = Strains::new(model, factors, displacements);
        if strains.are_rounding(displacements) {
            return ElementEstimate { locking: None, discretisation: None };
        }
        let places = Places::new(model);
        ElementEstimate {
            locking: locking::locking(model, &places, &strains, pressed),
            discretisation: DiscretisationError::new(model, &places, &strains),
        }
    }
}
