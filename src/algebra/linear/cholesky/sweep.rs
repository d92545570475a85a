//! Forward and backward substitution with the first columns of `L`, including border rows.
//!
//! The solves of the backends have no border: they would include `L_cc` and leave `L_cr` to a second pass over the
//! factors. The blocks are so small that calling a matrix product for each would cost more than its work.

use super::{Supernodal, Supernode, nodes};

/// Computes `[b_r; b_c] → [L_rr⁻¹ b_r; b_c - L_cr L_rr⁻¹ b_r]`, in the order of the factors.
pub(super) fn forward(factor: &dyn Supernodal, interior: usize, x: &mut [f64]) {
    let mut work = Vec::new();
    for node in nodes(factor).take_while(|node| node.first < interior) {
        gather(&node, x, &mut work);
        let columns = node.columns.min(interior - node.first);
        for first in (0..columns).step_by(TILE) {
            // First the columns of the block, then all rows below them.
            let end = columns.min(first + TILE);
            for k in first..end {
                let column = node.column(k);
                let (top, below) = work[k..].split_at_mut(1);
                top[0] /= column[0];
                below[..end - k - 1].iter_mut().zip(&column[1..]).for_each(|(x, l)| *x -= l * top[0]);
            }
            let (top, below) = work.split_at_mut(end);
            if let Ok(values) = <[f64; TILE]>::try_from(&top[first..]) {
                let [a, b, c, d] = std::array::from_fn(|k| &node.column(first + k)[TILE - k..]);
                let rows = below.iter_mut().zip(a).zip(b).zip(c).zip(d);
                rows.for_each(|((((x, a), b), c), d)| {
                    *x = *x - a * values[0] - b * values[1] - c * values[2] - d * values[3];
                });
            } else {
                for (k, value) in (first..).zip(&top[first..]) {
                    let column = &node.column(k)[end - k..];
                    below.iter_mut().zip(column).for_each(|(x, l)| *x -= l * value);
                }
            }
        }
        let (block, below) = work.split_at(node.columns);
        x[node.first..node.first + node.columns].copy_from_slice(block);
        node.below.iter().zip(below).for_each(|(&row, &value)| x[row as usize] = value);
    }
}

/// Computes `[y_r; x_c] → [L_rr⁻ᵀ (y_r - L_crᵀ x_c); x_c]`, in the order of the factors.
pub(super) fn backward(factor: &dyn Supernodal, interior: usize, x: &mut [f64]) {
    let mut work = Vec::new();
    for node in nodes(factor).rev().filter(|node| node.first < interior) {
        let columns = node.columns.min(interior - node.first);
        gather(&node, x, &mut work);
        let (top, below) = work.split_at_mut(columns);
        // First all columns with the rows below the block; then the block.
        for first in (0..columns).step_by(TILE) {
            let column = |k: usize| &node.column(first + k)[columns - first - k..];
            if first + TILE <= columns {
                subtract_four_products(std::array::from_fn(column), below, &mut top[first..]);
            } else {
                (0..columns - first).for_each(|k| subtract_product(column(k), below, &mut top[first + k]));
            }
        }
        for k in (0..columns).rev() {
            let column = node.column(k);
            let (upper, lower) = top.split_at_mut(k + 1);
            subtract_product(&column[1..columns - k], lower, &mut upper[k]);
            upper[k] /= column[0];
        }
        x[node.first..node.first + columns].copy_from_slice(top);
    }
}

/// The number of columns of `L` that are multiplied with the same rows at once.
const TILE: usize = 4;

/// The number of products in a partial sum. Partial sums reduce rounding.
const BLOCK: usize = 64;

/// Subtracts `Σ_i l_i x_i` from the first entry of `from` for the first of four `columns`, and so on. The columns are as
/// long as `x`.
fn subtract_four_products(columns: [&[f64]; TILE], x: &[f64], from: &mut [f64]) {
    let mut parts = columns.map(|column| column.chunks(BLOCK));
    for x in x.chunks(BLOCK) {
        let [a, b, c, d] = parts.each_mut().map(|part| part.next().unwrap_or_default());
        let mut sums = [0.0; TILE];
        for ((((x, a), b), c), d) in x.iter().zip(a).zip(b).zip(c).zip(d) {
            sums[0] += a * x;
            sums[1] += b * x;
            sums[2] += c * x;
            sums[3] += d * x;
        }
        from.iter_mut().zip(sums).for_each(|(from, sum)| *from -= sum);
    }
}

/// Subtracts `Σ_i l_i x_i` from `from`, in the order of terms of [`subtract_four_products`].
fn subtract_product(column: &[f64], x: &[f64], from: &mut f64) {
    for (column, x) in column.chunks(BLOCK).zip(x.chunks(BLOCK)) {
        *from -= column.iter().zip(x).map(|(l, x)| l * x).fold(0.0, |sum, term| sum + term);
    }
}

/// Gathers the values in the rows of a supernode.
fn gather(node: &Supernode<'_>, x: &[f64], work: &mut Vec<f64>) {
    work.clear();
    work.extend_from_slice(&x[node.first..node.first + node.columns]);
    work.extend(node.below.iter().map(|&row| x[row as usize]));
}
