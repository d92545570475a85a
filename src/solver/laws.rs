//! The laws of Signorini and Coulomb, and the error measure that judges every solution.

pub(crate) mod coulomb;
mod kkt;

pub use coulomb::{NormalCase, TangentialCase, direction, length, normal_case, positive, project, tangential_case};
pub use kkt::{ContactStatus, KktErrors, KktScales, Law, Violation, statuses};
pub(crate) use kkt::{Judgement, ROUNDING, statuses_of};
