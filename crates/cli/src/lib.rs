//! The program: its command line, and its parts beyond a single run, which are comparisons of meshes and increments, parameter
//! sweeps, and folders of exchange files.

pub mod capacity;
pub mod commands;
pub mod compare;
pub mod converge;
pub mod problems;
pub mod study;
pub mod sweep;
mod words;
