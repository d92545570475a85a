//! The parts of the program beyond a single run: comparisons of meshes and increments, parameter sweeps, and folders of
//! exchange files.

pub mod compare;
pub mod converge;
pub mod problems;
pub mod sweep;
