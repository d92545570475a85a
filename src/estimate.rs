//! What the error measure does not see: the laws hold on the mesh that there is, but the mesh may be too coarse to tell.
//!
//! The numbers are estimates, free of units and without a reference; doc/estimates.md says where they come from and how far
//! they were right.

mod graph;
mod hertz;
mod zone;

pub use graph::ContactGraph;
pub use hertz::HertzContact;
pub use zone::{ContactEstimate, StickZone, peak_error};
