//! Deformable bodies in front of each other. Figures without a closed form are those of a program that shares nothing with this one.
#![allow(clippy::unwrap_used)]

mod chains;
mod glue;
mod patch;
mod random;
mod space;
mod stack;
