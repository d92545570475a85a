//! The warning of a jump of contact forces.

use super::warnings::{Warning, WarningKind};
use crate::base::units::six_digits;

/// An increment in which contact forces jump, however short it is made.
#[derive(Debug, Clone, Copy, PartialEq)]
#[non_exhaustive]
pub struct ForceJump {
    /// Its beginning, s.
    pub from: f64,
    /// Its end, s.
    pub to: f64,
    /// The change of the contact forces relative to their largest value, both as the root of `Σ |p|² / l`.
    pub share: f64,
}

impl ForceJump {
    /// Warns that the quasi-static motion ends there.
    pub(super) fn warning(&self) -> Warning {
        let ForceJump { from, to, share } = *self;
        let [from, to] = [from, to].map(six_digits);
        let message = format!(
            "contact forces jump by {:.0} % of their largest value between t = {from} s and t = {to} s, even in \
             shorter increments: no quasi-static motion continues from there, and the states after it are one of \
             several that the laws allow; only dynamics can decide which. Less friction or another support avoids \
             the jump; in the plane solver.method = \"events\" finds where it begins",
            100.0 * share
        );
        Warning { kind: WarningKind::Jump, message }
    }
}
