//! The foundation of all rooms: errors of input, formulas, histories in time, units, and the memory that is left.

/// Displays types as the words that serde writes.
macro_rules! displayed_as_written {
    ($($kind:ty),+) => {$(
        impl std::fmt::Display for $kind {
            fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
                serde::Serialize::serialize(self, f)
            }
        }
    )+};
}
pub(crate) use displayed_as_written;

pub(crate) mod formula;
pub(crate) mod input;
pub(crate) mod input_error;
pub(crate) mod memory;
pub(crate) mod timeline;
pub(crate) mod units;
pub use formula::{Field, Formula, FormulaError, FormulaUnits};
pub use input::{Contents, read_bytes, with_contents};
pub use input_error::{InputError, finite, positive};
pub use memory::{Budget, Source, in_words, kilobytes};
pub use timeline::{equal_increments, kinks, kinks_between, within};
pub use units::{Depth, LengthUnit, Quantity, Scaling, StressUnit, UnitSystem, Units, six_digits};
