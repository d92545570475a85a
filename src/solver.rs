//! The paper's problem and algorithms: contact problems as matrices, the laws, BN and IP, condensation, histories of
//! increments. Beyond the paper: friction in space, the exact path in time, solvability and uniqueness. It knows no mesh.

pub(crate) mod checkpoint;
pub(crate) mod condensation;
pub(crate) mod events;
pub mod formulation;
pub mod history;
pub(crate) mod influence;
pub(crate) mod initial_working_set;
pub(crate) mod laws;
pub(crate) mod loading;
pub(crate) mod newton;
pub(crate) mod problem;
pub(crate) mod solvability;
pub(crate) mod uniqueness;
pub use checkpoint::{Checkpoint, CheckpointError};
pub use condensation::{Condensation, Condensed};
pub use events::{Effort, Equations, Event, ExactPath, NodeStatus, PathEnd, PathError, PathSegment, SegmentEnd};
pub use initial_working_set::{AFFORDABLE, InitialWorkingSet, working_set};
pub use laws::{
    ContactStatus, KktErrors, KktScales, Law, NormalCase, TangentialCase, Violation, direction, length, normal_case,
    positive, project, statuses, tangential_case,
};
pub use loading::{FrictionHistory, GapCorrection, LoadCase, Loading, Motion};
pub use newton::{
    Armijo, Bn, Centring, Ip, IpSettings, Iteration, IterationRecord, LinearSystem, Measure, MethodResult,
    StopCriterion, Termination,
};
pub use problem::{ContactProblem, Increment, Parts, ProblemError, State};
pub use solvability::{Conditions, rigid_equilibrium, rigid_equilibrium_with};
pub use uniqueness::{CriticalFriction, critical_friction};
