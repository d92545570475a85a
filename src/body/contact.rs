//! Contact with obstacles and between bodies, and the maps `C_n`, `C_t` and `C_o`.

mod cone;
mod coupled;
mod crossing;
mod description;
mod front;
mod gap_table;
mod holes;
mod kinematics;
mod mortar;
mod motion;
mod obstacle;
mod obstacle_error;
mod passage;
mod range;
mod revolution;
mod surface;
mod tree;
mod triangles;

pub use coupled::{coupled_nodes, relative};
pub use description::{GapDirection, Obstacle, Place, Rotation, Shape};
pub(crate) use front::outsides;
pub use front::{Meeting, Unclear, meetings, nearest};
pub use gap_table::{GapTable, TableError};
pub use holes::holes_in_front_of;
pub use kinematics::{ContactBoundary, ContactNode, Counterpart, Coupled, End, Row, Term, contact_nodes, unreachable};
pub use mortar::{GapAt, Mortar, MortarFault, MortarOptions, MortarRow, SlaveChoice, SlaveReason, Supports};
pub use motion::{ObstacleMotion, Rates};
pub(crate) use obstacle::Round;
pub use obstacle::{Facing, PlacedObstacle};
pub use obstacle_error::ObstacleError;
pub use passage::{Passages, Passed};
pub use range::{DeformedNode, RangeLeft, TOLERATED_SHARE, range_left};
pub use triangles::{Hole, SurfaceError};
