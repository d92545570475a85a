//! The foundation of all rooms: errors of input, formulas, histories in time, units, and the memory that is left.

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
