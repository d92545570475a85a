//! Runs as the library offers them: steps, checkpoints, the choice of the linear algebra.

mod auto;
mod checkpoints;
mod door;
mod steps;
