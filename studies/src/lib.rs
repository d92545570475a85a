//! The laboratory of stickslip: the paper's Tables I and II and its Figures 4 to 7 computed again, and a suite of scenes
//! at the limits of what can be solved.

pub mod elements;
pub mod extremes;
pub mod figures;
pub mod tables;
