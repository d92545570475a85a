//! Contact: obstacles, the maps `C_n`, `C_t` and `C_o`, the laws of Signorini and Coulomb, and the error
//! measure that judges every solution.

pub mod coulomb;
mod kinematics;
mod kkt;
mod obstacle;

pub use kinematics::{ContactBoundary, ContactNode, Row, contact_nodes, unreachable};
pub use kkt::{ContactStatus, KktErrors, KktScales, Law, Violation, rounding_level, statuses};
pub use obstacle::Obstacle;
