//! Sparse matrices of dense blocks: compressed rows of blocks.

use super::words::Words;
use stickslip::base::InputError;

/// Reads the entries of a matrix with this number of `rows` and `columns`.
pub(super) fn read(words: &mut Words<'_>, rows: usize, columns: usize) -> Result<Vec<(usize, usize, f64)>, InputError> {
    let help = "correct the sizes, which contradict each other";
    let blocks = words.count("the number of blocks")?;
    let in_a_column = words.count("the rows of blocks")?;
    let in_a_row = words.count("the columns of blocks")?;
    let row_ends = words.counts("the last row of each row of blocks", in_a_column)?;
    let column_ends = words.counts("the last column of each column of blocks", in_a_row)?;
    for (ends, all, what) in [(&row_ends, rows, "rows"), (&column_ends, columns, "columns")] {
        if ends.windows(2).any(|pair| pair[0] > pair[1]) || ends.last().copied().unwrap_or(0) != all {
            return Err(words.fault(&format!("the blocks do not have the {all} {what} of the matrix"), help));
        }
    }
    let (filled_rows, filled) = (words.count("the starts of rows of blocks")?, words.count("the number of blocks")?);
    let starts = words.counts("the starts of rows of blocks", filled_rows)?;
    let places = words.counts("the columns of blocks", filled)?;
    let fits = filled == blocks
        && starts.first().is_none_or(|start| *start == 0)
        && starts.last().copied().unwrap_or(0) == blocks
        && filled_rows <= in_a_column.saturating_add(1)
        && starts.windows(2).all(|pair| pair[0] <= pair[1]);
    if !fits {
        return Err(words.fault("the rows of blocks do not hold all blocks", help));
    }
    if let Some(place) = places.iter().find(|place| **place >= in_a_row) {
        return Err(words.fault(&format!("a block is in column {place} of {in_a_row}, counted from 0"), help));
    }
    let before = |ends: &[usize], k: usize| k.checked_sub(1).map_or(0, |k| ends[k]);
    let mut entries = Vec::new();
    for row in 0..filled_rows.saturating_sub(1) {
        for (block, &column) in places.iter().enumerate().take(starts[row + 1]).skip(starts[row]) {
            let number = words.count("the number of a block")?;
            if number != block {
                return Err(words.fault(&format!("expected block {block}, found {number}"), "number the blocks from 0"));
            }
            let (top, left) = (before(&row_ends, row), before(&column_ends, column));
            let (height, width) = (row_ends[row] - top, column_ends[column] - left);
            for j in 0..width {
                for i in 0..height {
                    let value = words.number("the entries of a block")?;
                    if value != 0.0 {
                        entries.push((top + i, left + j, value));
                    }
                }
            }
        }
    }
    Ok(entries)
}
