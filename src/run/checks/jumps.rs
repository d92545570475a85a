//! Jumps: the end of a quasi-static motion.

use super::prelude::*;
use crate::run::force_jumps::ForceJump;

kinds! {
    /// The quasi-static motion ends, and the increments go on with a jump: later states are one of several.
    JUMP("jump", "Less friction; a support. `--method events` finds where the [jump](../method/exact-path.md#jumps) begins.",
        "never");
}

/// Warns that contact forces jump in an increment.
pub(super) fn warning(solved: &Solved<'_>) -> Option<Warning> {
    let ForceJump { from, to, share } = solved.jump?;
    let [from, to] = [from, to].map(six_digits);
    Some(WarningKind::JUMP.warning(format!(
        "contact forces jump by {:.0} % of their largest value between t = {from} s and t = {to} s, even in \
         shorter increments: no quasi-static motion continues from there, and the states after it are one of \
         several that the laws allow; only dynamics can decide which. Less friction or another support avoids \
         the jump; in the plane solver.method = \"events\" finds where it begins",
        100.0 * share
    )))
}
