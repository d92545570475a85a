//! Contact with obstacles and between bodies, and the maps `C_n`, `C_t` and `C_o`.

mod assignment;
mod description;
mod facing;
mod gap_table;
mod kinematics;
mod mortar;
mod motion;
mod obstacle;
mod passage;
mod surface;
mod tree;
mod triangles;

pub(crate) use assignment::outsides;
pub(crate) use assignment::{NodeObstacle, Unclear, holes_in_front_of, meetings, nearest};
pub use description::{GapDirection, Obstacle, Place, Rotation, Shape};
pub use gap_table::{GapTable, TableError};
pub use kinematics::{
    ContactBoundary, ContactNode, Counterpart, Coupled, End, Row, Term, contact_nodes, coupled_nodes, relative,
    unreachable,
};
pub(crate) use mortar::RoundSurface;
pub use mortar::{GapAt, Mortar, MortarFault, MortarOptions, MortarRow, SlaveChoice, SlaveReason, Supports};
pub use motion::{ObstacleMotion, Rates};
pub(crate) use obstacle::Round;
pub use obstacle::{Facing, ObstacleError, PlacedObstacle};
pub use passage::{Passages, Passed};
pub use triangles::SurfaceError;
