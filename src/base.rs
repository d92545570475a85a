//! What every room stands on: errors of input, formulas, histories in time, units, and how much memory is left.

pub mod formula;
pub mod input;
pub mod input_error;
pub mod memory;
pub mod timeline;
pub mod units;
