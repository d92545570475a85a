//! Input that nobody would write: random and broken texts for every reader of stickslip, and random scenes that are run and judged.
//!
//! Every input follows from its target and a seed, so that whatever is found is found again. [`readers`] asks that a reader takes
//! or refuses with a message, and never panics; [`runs`] asks that what counts as converged obeys the laws, by an own measure
//! ([`runs::laws`]), and that the same body told otherwise answers the same.

pub mod corpus;
pub mod mutate;
pub mod pool;
pub mod random;
pub mod readers;
pub mod runs;
