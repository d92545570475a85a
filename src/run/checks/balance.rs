//! Forces on the body that are out of balance.

use super::prelude::*;
use crate::body::model::Pair;
use crate::run::report::BalanceRecord;

kinds! {
    /// Forces on the body are out of balance by more than a hundred tolerances, because of rounding; or moments are,
    /// because bodies act across a gap.
    UNBALANCED("unbalanced", "Move the body less, or by supports; meshes without a gap.", "the share in the message suffices");
}

/// The largest imbalance, in tolerances, that counts as balanced. It exceeds the error of each node because the errors
/// add up.
const BALANCED: f64 = 100.0;

/// Collects the imbalance over a history.
#[derive(Debug, Clone, Copy, PartialEq, Default, Serialize, Deserialize)]
pub struct BalanceWatch {
    /// The largest sum of magnitudes of forces, N.
    largest: f64,
    /// The largest imbalance, as a force or a moment, then as a force alone, N, and its time, s.
    worst: Option<[f64; 3]>,
}

impl BalanceWatch {
    /// Examines the end of a converged increment. Increments that did not converge are not balanced anyway.
    pub fn observe(&mut self, record: &BalanceRecord) {
        let imbalance = record.balance * record.size;
        self.largest = self.largest.max(record.size);
        if self.worst.is_none_or(|[worst, ..]| imbalance >= worst || imbalance.is_nan()) {
            self.worst = Some([imbalance, record.of_forces * record.size, record.time]);
        }
    }
}

/// Warns if the imbalance, relative to the largest forces of the run, exceeds the tolerance by more than a factor
/// [`BALANCED`]. One cause is rounding: forces much smaller than stiffness times displacements are lost in it, which the
/// errors of a state cannot show. Another is a gap between opposing bodies, if the forces balance but the moments do not.
pub(super) fn warning(Solved { model, solver, balance, .. }: &Solved<'_>) -> Option<Warning> {
    let [left, of_forces, time] = balance.worst?;
    let (time, tolerated) = (six_digits(time), BALANCED * solver.tolerance * balance.largest);
    if left <= tolerated {
        return None;
    }
    let share = left / balance.largest;
    let apart = |pair: &Pair| pair.mortar.gaps.iter().map(|gap| gap.gap.abs()).fold(0.0, f64::max);
    let widest = model.contact.pairs.iter().max_by(|a, b| apart(a).total_cmp(&apart(b)));
    let message = match widest.filter(|_| of_forces <= tolerated) {
        Some(pair) => format!(
            "at t = {time} s the forces on the body balance, but their moments do not, by {share:.1e} of their \
             sizes: the meshes of `{}` and `{}`, which act on each other, are up to {} apart; let the \
             two meet without a gap, on plane facets or with nodes at the same places",
            pair.slave,
            pair.master.name,
            model.units().rounded(Quantity::Length, apart(pair), 3)
        ),
        None => format!(
            "at t = {time} s the forces on the body do not balance, by {share:.1e} of their sizes: rounding \
             matters, because they are small compared with stiffness times displacements, and they may be \
             equally wrong; let the body move less, or move it by supports in place of contact or springs"
        ),
    };
    Some(WarningKind::UNBALANCED.warning(message))
}
