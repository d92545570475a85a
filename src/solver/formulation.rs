//! Equations `H(z) = 0` of one increment and their linearisation on one fixed pattern.
//!
//! | equations | file |
//! | --- | --- |
//! | `H_N` (18), (19) with its B-derivative (20) and the linearisation (21) | `bdiff.rs` |
//! | `H_I` (25) with its partitions (26)–(31) | `constrained.rs` |
//! | the exact cone in space, for an interior point method | `cone.rs` |
//!
//! All formulations use the same [`Assembled`] problem: one layout, one pattern, one `K`.

mod assembled;
mod bdiff;
mod cone;
mod constrained;
mod interior;
mod layout;
mod mixed;
mod natural;
mod pairs;
mod scaled;

pub use assembled::Assembled;
pub use bdiff::{Bdiff, Linearization};
pub use cone::ConeSystem;
pub use constrained::{Constrained, Partition, SlackLayout};
pub use interior::InteriorPoint;
pub use layout::Layout;
pub use natural::{FormulationScaling, Pressure};
pub use pairs::{Face, Pair, largest_step};
