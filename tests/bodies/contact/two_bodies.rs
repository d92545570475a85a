//! Deformable bodies in front of each other. Figures without a closed form are those of a program that shares nothing with this one.

// Figures as that program prints them; those of doc/method/verification-bodies.md with --nocapture.
#![allow(clippy::unreadable_literal)]

mod chains;
mod contrast;
mod covered;
mod curved;
mod cylinders;
mod glue;
mod judged;
mod passing;
mod patch;
mod random;
mod roller;
mod seams;
mod shrink;
mod spheres;
mod stack;
mod stick;
mod supported;
mod units;
mod whole;
