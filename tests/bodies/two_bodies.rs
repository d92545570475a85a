//! Deformable bodies in front of each other. Figures without a closed form are those of a program that shares nothing with this one.
#![allow(clippy::unwrap_used)]

mod chains;
mod contrast;
mod cylinders;
mod glue;
mod patch;
mod roller;
mod shrink;
mod space;
mod spheres;
mod stack;
mod stick;
mod units;
