//! The order of elimination: the interior in a fill-reducing order, then the border in the given order.

use crate::algebra::linear::LinearError;
use crate::algebra::linear::error::expect_length;
use crate::algebra::sparse::Pattern;

/// Returns a fill-reducing order with `last` at the end. Only the interior is ordered, by `interior` from the lower
/// triangle of its pattern: `last` has an order already, and the Schur complement is nearly dense in any order.
pub(super) fn with_border(
    lower: &Pattern,
    last: &[usize],
    interior: impl FnOnce(&Pattern) -> Result<Vec<usize>, LinearError>,
) -> Result<Vec<usize>, LinearError> {
    let n = lower.columns();
    let mut is_last = vec![false; n];
    let distinct = last.iter().filter(|&&k| k < n && !std::mem::replace(&mut is_last[k], true)).count();
    expect_length("distinct unknowns to eliminate last", last.len(), distinct)?;
    let inside: Vec<usize> = (0..n).filter(|&k| !is_last[k]).collect();
    let mut order = Vec::with_capacity(n);
    if !inside.is_empty() {
        let mut place = vec![None; n];
        inside.iter().enumerate().for_each(|(k, &unknown)| place[unknown] = Some(k));
        let block = Pattern::of(inside.len(), inside.len(), |take| {
            for (column, &unknown) in inside.iter().enumerate() {
                for &row in &lower.row_indices()[lower.column(unknown)] {
                    if let Some(row) = place[row as usize] {
                        take(row, column);
                    }
                }
            }
        });
        order.extend(interior(&block)?.into_iter().map(|k| inside[k]));
    }
    order.extend(last);
    Ok(order)
}
