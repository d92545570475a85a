//! From a mesh to a [`ContactProblem`](crate::solver::problem::ContactProblem): finite elements, contact geometry, loads, error estimates.

pub mod contact;
pub mod description;
pub mod estimate;
pub mod fem;
pub mod mesh;
pub mod model;
