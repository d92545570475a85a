//! The laboratory of stickslip: the paper's Tables I and II and its Figures 4 to 7 computed again, a suite of scenes at the
//! limits of what can be solved, kinds of elements beside each other, and the estimates of a run beside what is true.

pub mod elements;
pub mod estimates;
pub mod extremes;
pub mod figures;
pub mod gaps;
pub mod tables;
pub mod told;
pub mod warnings;
