//! `A x = b`: sparse matrices, linear solvers behind one trait, and small helpers of both.

pub(crate) mod elimination;
pub(crate) mod jobs;
pub mod linear;
pub(crate) mod null_space;
pub(crate) mod sparse;
pub(crate) mod union_find;
pub(crate) mod vector;
pub use jobs::{keep_in_this_thread, parallel_map};
pub use union_find::UnionFind;

pub use sparse::{Csc, Csr, DenseSymmetric, DoubleDouble, MatrixError, NodeRows, Pattern, Symmetric};
pub use vector::{Vector, across, axis, axis_across, cross, dot, minus, norm, plus, unit};
