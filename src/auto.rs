//! Which linear algebra a scene is solved with, where it leaves that open: what is estimated to take the
//! least time, as far as memory allows.
//!
//! One symbolic analysis of `K` serves both estimates, see [`crate::linear::cost`]. It takes about as long as
//! ordering once.

use crate::formulation::Layout;
use crate::linear::cost::{self, Cost, Sizes, Work};
use crate::linear::{Cholesky, LinearError};
use crate::model::Model;
use crate::scene::{LinearBackend, MethodName, Scene};

/// BN keeps its factors while no contact status changes, so its factorisations grow as the root of the number
/// of increments, this many times it: 5, 7.5, 11 and 14 on the paper's block with 25, 50, 100 and 200 contact nodes (2 to
/// 100 increments), 3 to 11 on strips.
const BN_FACTORIZATIONS: f64 = 8.0;

/// Where nodes slide in a plane, the direction of their slip turns and the matrix with it: so many factorisations in an
/// increment. 6 to 10 with 2 increments, 5 to 7 with 10 and 4 to 5 with 40 on cubes and plates of 8 to 32 elements along
/// the contact.
const BN_FACTORIZATIONS_IN_A_PLANE: f64 = 5.0;

/// An interior point method changes its matrix in each iteration: 5 to 8 in an increment in the tables of the paper.
const IP_FACTORIZATIONS: f64 = 6.0;

/// The same for the exact cone, where nodes slide in a plane: 13.8 and 14.4 on a plate of 24 × 24 × 6 elements with 5 and 10
/// increments.
const IP_FACTORIZATIONS_IN_A_PLANE: f64 = 14.0;

/// A choice, with its reason if it was left open.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Choice {
    /// What solves.
    pub backend: LinearBackend,
    estimates: Option<Estimates>,
}

/// What both ways are estimated to take.
#[derive(Debug, Clone, Copy, PartialEq)]
struct Estimates {
    sparse: Cost,
    condensed: Cost,
    /// Free memory, bytes, if it was too little for the condensed system.
    short_of: Option<u64>,
}

impl Choice {
    /// What `scene` names, or else the cheaper way to solve `model`; `available` is the free memory in bytes,
    /// if it is known.
    ///
    /// # Errors
    /// When memory is short for the symbolic analysis.
    pub fn new(scene: &Scene, model: &Model, available: Option<u64>) -> Result<Self, LinearError> {
        if let Some(backend) = scene.solver.linear {
            return Ok(Choice { backend, estimates: None });
        }
        let (problem, whole) = (&model.problem, LinearBackend::default());
        let layout = Layout::new(problem);
        let sizes = Sizes {
            unknowns: layout.unknowns(),
            contact_displacements: problem.contact_displacements().len(),
            stiffness: Cholesky::predict(problem.stiffness())?,
        };
        let (method, increments) = (scene.solver.method.name(), scene.time.increments);
        let factorizations = match method {
            // Without contact the problem is linear: one matrix.
            _ if layout.contacts() == 0 => 1.0,
            MethodName::Bn if layout.has_second_tangent() => BN_FACTORIZATIONS_IN_A_PLANE * increments as f64,
            MethodName::Bn => BN_FACTORIZATIONS * (increments as f64).sqrt(),
            MethodName::Ip if layout.has_second_tangent() => IP_FACTORIZATIONS_IN_A_PLANE * increments as f64,
            MethodName::Ip => IP_FACTORIZATIONS * increments as f64,
        };
        let work = Work { increments, factorizations, all_free: method == MethodName::Ip };
        let sparse = cost::sparse(&sizes, &work, whole == LinearBackend::Faer);
        let condensed = cost::condensed(&sizes, &work);
        let short_of = available.filter(|&available| condensed.bytes > available as f64);
        let condense = condensed.seconds < sparse.seconds && short_of.is_none();
        let backend = if condense { LinearBackend::Condensed } else { whole };
        Ok(Choice { backend, estimates: Some(Estimates { sparse, condensed, short_of }) })
    }

    /// The choice and its reason in a line, if there was anything to choose.
    pub fn reason(&self) -> Option<String> {
        let Estimates { sparse, condensed, short_of } = self.estimates?;
        if let Some(available) = short_of {
            let gigabytes = |bytes: f64| bytes * 1e-9;
            let (needed, free) = (gigabytes(condensed.bytes), gigabytes(available as f64));
            return Some(format!(
                "{} (condensed would take {needed:.1} GB of memory, {free:.1} GB are free)",
                self.backend
            ));
        }
        let (taken, other, name) = match self.backend {
            LinearBackend::Condensed => (condensed, sparse, LinearBackend::default()),
            _ => (sparse, condensed, LinearBackend::Condensed),
        };
        Some(format!(
            "{} (estimated {:.2} s against {:.2} s for {name}; {:.1e} flops an iteration against {:.1e})",
            self.backend, taken.seconds, other.seconds, taken.flops, other.flops
        ))
    }
}
