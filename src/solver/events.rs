//! The exact solution in time: from event to event, without increments.
//!
//! Between two corners of the loads all data are linear in time. As long as no contact node changes its status,
//! displacements and forces are linear too. If all nodes slide along lines, as in the plane, the solution of the
//! quasi-static problem is therefore piecewise linear in time. [`ExactPath`] goes from one of its corners, an
//! *event*, to the next:
//!
//! 1. The rate problem (`rate.rs`) determines the next statuses and the rates.
//! 2. The step ends at the first of these events: a gap closes, a pressure vanishes, or friction reaches the border
//!    of its cone.
//! 3. The state there is solved anew with the next statuses, so that rounding does not accumulate.
//!
//! Between two events every node sticks, slips in one direction or is open. Each state is therefore that of a
//! backward Euler increment from the previous state, and the error measure of increments applies. If no rates obey
//! the laws, the quasi-static motion ends.
//!
//! | content | file |
//! | --- | --- |
//! | the exact path and its snapshots; the data along it | `exact_path.rs`, `stretch.rs` |
//! | the rate problem and its laws | `rate_problem.rs` |
//! | the search for its statuses | `rate.rs` |
//! | the linear complementarity problem, if corrections fail, and Lemke's method | `complementarity.rs` |
//! | the linear equations of given statuses: sparse, and refined in twice the precision for slender bodies | `tangent.rs` |
//! | dense equations: changes of rank one | `dictionary.rs` |
//! | displacements of which each contact row is one | `coordinates.rs` |
//!
//! ```
//! use stickslip::solver::{Equations, SegmentEnd, ExactPath};
//! use stickslip::algebra::linear::RefinedSolver;
//! use stickslip::solver::{LoadCase, Loading};
//! use stickslip::solver::{ContactProblem, Parts};
//! use stickslip::algebra::{Csr, Symmetric};
//!
//! // A node on two springs of 2 N/m, 0.25 m above a floor, pressed with 1 N and pulled along it with 0.6 N; friction 0.5.
//! let stiffness = Symmetric::from_triplets(2, &[(0, 0, 2.0), (1, 1, 2.0)])?;
//! let c_n = Csr::from_rows(2, [[(1, -1.0)]])?;
//! let c_t = Csr::from_rows(2, [[(0, 1.0)]])?;
//! let problem = ContactProblem::new(Parts { c_t, mu: vec![0.5], ..Parts::new(stiffness, c_n) })?;
//! let load = LoadCase::new(vec![0.6, -1.0], vec![[0.0, 0.0], [1.0, 1.0]])?;
//! let loading = Loading::new(vec![load], vec![0.25])?;
//!
//! let mut linear = RefinedSolver::default();
//! let scaling = problem.scaling(loading.largest_force(), 0.0);
//! let mut walk = ExactPath::new(&problem, &loading, scaling, Equations::Sparse(&mut linear))?;
//! let mut times = Vec::new();
//! while let stickslip::solver::PathSegment { stop: SegmentEnd::Event | SegmentEnd::Corner, .. } = walk.step(1.0)? {
//!     times.push(walk.time());
//! }
//! // It touches when half of the load is there, slips at once, and ends with half the force on the floor.
//! assert!((times[0] - 0.5).abs() < 1e-12);
//! assert!((walk.state().p_n[0] - 0.5).abs() < 1e-12 && (walk.state().p_t[0] - 0.25).abs() < 1e-12);
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```

mod complementarity;
mod coordinates;
mod dictionary;
mod exact_path;
mod node;
mod rate;
mod rate_problem;
mod stretch;
mod tangent;

use serde::Serialize;

pub use exact_path::ExactPath;
pub(crate) use exact_path::SavedExactPath;
pub use node::NodeStatus;
pub use rate_problem::Effort;

use crate::algebra::linear::{LinearError, RefinedSolver};
use crate::solver::problem::ProblemError;

/// The linear equations of an exact path.
pub enum Equations<'a> {
    /// Sparse equations in all displacements and contact forces: one factorisation for each set of statuses, on one
    /// pattern.
    Sparse(&'a mut RefinedSolver),
    /// Dense equations in the contact displacements of a condensed problem, updated by rank-one changes.
    Dense,
}

/// A change of status of one contact node.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct Event {
    /// The time of the change, s.
    pub time: f64,
    /// The index of the contact node, from 0.
    pub node: usize,
    /// The status before the event.
    pub from: NodeStatus,
    /// The status after the event.
    pub to: NodeStatus,
}

/// A step of the exact path.
#[derive(Debug, Clone, PartialEq)]
pub struct PathSegment {
    /// The changes of status at the start of the step.
    pub events: Vec<Event>,
    /// The exact work that friction dissipated in the step, J; in two dimensions J per m of depth.
    pub friction_work: f64,
    /// The reason why the step ended.
    pub stop: SegmentEnd,
}

/// The reason why a step ended.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum SegmentEnd {
    /// A node reached the border of a law.
    Event,
    /// The rates of the loads change.
    Corner,
    /// The requested time is reached.
    Until,
    /// No rates obey the laws: the quasi-static motion ends here.
    PathEnd(PathEnd),
}

/// The end of the quasi-static motion.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, schemars::JsonSchema)]
pub struct PathEnd {
    /// The time of the end, s.
    pub time: f64,
    /// `true` if all statuses of the nodes concerned were tried and none was singular. Otherwise Lemke's method ended
    /// on a ray, which is a proof only in some problems.
    pub certain: bool,
}

/// The reason why there is no exact path.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum PathError {
    /// The path is not piecewise linear where the slip direction turns.
    #[error("a contact node can slide in more than one direction, so that the path in time is curved")]
    SlidesInAPlane,
    /// The path is not piecewise linear where `μ(t) p_n(t)` is not.
    #[error("friction changes in time, so that the path is curved")]
    FrictionChanges,
    /// The contact rows are linearly dependent, so the contact forces are not unique.
    #[error("contact rows depend on each other, so that their forces cannot be told apart")]
    DependentRows,
    /// The loading does not fit the problem.
    #[error(transparent)]
    Problem(#[from] ProblemError),
    /// The linear solver failed.
    #[error(transparent)]
    Linear(#[from] LinearError),
}
