//! From a mesh to a [`ContactProblem`](crate::solver::problem::ContactProblem): finite elements, contact geometry, loads, error estimates.

pub mod constraints;
pub(crate) mod contact;
pub(crate) mod description;
pub(crate) mod estimate;
pub mod fem;
pub mod mesh;
pub(crate) mod model;
pub use contact::{
    ContactBoundary, ContactNode, Counterpart, Coupled, End, Facing, GapAt, GapDirection, GapTable, Mortar,
    MortarFault, MortarOptions, MortarRow, Obstacle, ObstacleError, ObstacleMotion, Passed, Place, PlacedObstacle,
    Rotation, Row, Shape, SlaveChoice, SlaveReason, Supports, SurfaceError, TableError, Term,
};
pub use description::{
    Action, Against, Axis, Bed, Contact, Coupling, CouplingKind, Description, Direction, Held, Kinks, Load, Opposite,
    Part, Pretension, Probe, ProbePlace, Slave, Support, Tightening, Where,
};
pub use estimate::{
    ContactEstimate, ContactGraph, DiscretisationError, ElementEstimate, HertzContact, PeakOf, StickZone, peak_error,
};
pub use model::{
    Balance, BetweenNodes, Body, DeformedNode, LargeMotion, Model, ModelError, Overlap, Pair, PassedNode, RangeLeft,
    Share, SurfaceStress, Wrench, range_left,
};
