//! The paper: contact problems as matrices, the laws, Algorithms BN and IP, and histories of increments. It knows no mesh.

pub mod checkpoint;
pub mod condensation;
pub mod events;
pub mod formulation;
pub mod history;
pub mod initial_working_set;
pub mod laws;
pub mod loading;
pub mod newton;
pub mod problem;
pub mod solvability;
pub mod uniqueness;
