//! Gauss–Seidel sweeps: each contact in turn is solved exactly with the others fixed.
//!
//! They converge for most problems, though slowly. They find open, sticking and slipping contacts soon, at a cost far
//! below a factorisation.

use super::scaled::ScaledContacts;
use super::single;

/// Performs `sweeps` sweeps over all contacts, starting from `r`.
pub(super) fn sweep(scaled: &ScaledContacts, r: &mut [f64], sweeps: usize) {
    for _ in 0..sweeps {
        for (k, law) in scaled.laws.iter().enumerate() {
            let (range, own, block) = (scaled.range(k), scaled.at(k, r), &scaled.diagonal[k]);
            let mut without = [0.0; 3];
            for (c, row) in range.enumerate() {
                let by_own: f64 = (0..3).map(|l| block[c][l] * own[l]).sum();
                without[c] = scaled.q[row] + scaled.row_product(row, r) - by_own;
            }
            scaled.put(k, single::force(law, block, without), r);
        }
    }
}
