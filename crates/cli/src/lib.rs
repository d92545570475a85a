//! What the program does beyond one run: whole tables of meshes and increments, sweeps over parameters, and folders of exchange files.

pub mod compare;
pub mod problems;
pub mod sweep;
