//! `A x = b`: sparse matrices, linear solvers behind one trait, and small helpers of both.

pub mod jobs;
pub mod linear;
pub mod null_space;
pub mod sparse;
pub mod union_find;
pub mod vector;
