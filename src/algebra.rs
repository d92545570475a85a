//! `A x = b`: sparse matrices, linear solvers behind one trait, and small helpers of both.

pub(crate) mod jobs;
pub mod linear;
pub(crate) mod null_space;
pub mod sparse;
pub(crate) mod union_find;
pub mod vector;
pub use jobs::{keep_in_this_thread, parallel_map};
pub use union_find::UnionFind;
