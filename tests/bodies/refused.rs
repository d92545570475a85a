//! Input that is refused, each fault with its place, words and cure.

mod against_mesh;
mod axisymmetric;
pub mod bodies;
pub mod descriptions;
mod keys;
mod loads;
mod obstacles;
mod output;
mod overrides;
mod pairs;
mod values;
