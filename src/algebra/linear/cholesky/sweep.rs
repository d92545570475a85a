//! Forward and backward substitution with the first columns of `L`, including border rows.
//!
//! The solves of the backends have no border: they would include `L_cc` and leave `L_cr` to a second pass over the
//! factors. The blocks are so small that calling a matrix product for each would cost more than its work.

use super::{Supernodal, Supernode, nodes};

/// Computes `[b_r; b_c] → [L_rr⁻¹ b_r; b_c - L_cr L_rr⁻¹ b_r]`, in the order of the factors.
pub(super) fn forward(factor: &dyn Supernodal, interior: usize, x: &mut [f64]) {
    let mut work = Vec::new();
    for node in fetched(nodes(factor).take_while(|node| node.first < interior)) {
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
    for node in fetched(nodes(factor).rev().filter(|node| node.first < interior)) {
        let columns = node.columns.min(interior - node.first);
        gather(&node, x, &mut work);
        let (top, below) = work.split_at_mut(columns);
        // First the rows below the block, in the order of memory; then the block.
        for (k, x) in top.iter_mut().enumerate() {
            *x -= product(&node.column(k)[columns - k..], below);
        }
        for k in (0..columns).rev() {
            let column = node.column(k);
            let (upper, lower) = top.split_at_mut(k + 1);
            upper[k] = (upper[k] - product(&column[1..columns - k], lower)) / column[0];
        }
        x[node.first..node.first + columns].copy_from_slice(top);
    }
}

/// The number of columns of `L` that are multiplied with the same rows at once.
const TILE: usize = 4;

/// The number of partial sums of a product. A processor adds several of them at once, and they reduce rounding.
const LANES: usize = 8;

/// Returns `Σ_i l_i x_i`.
fn product(l: &[f64], x: &[f64]) -> f64 {
    let ((l, l_rest), (x, x_rest)) = (l.as_chunks::<LANES>(), x.as_chunks::<LANES>());
    let mut sums = [0.0; LANES];
    for (l, x) in l.iter().zip(x) {
        for lane in 0..LANES {
            sums[lane] += l[lane] * x[lane];
        }
    }
    let rest: f64 = l_rest.iter().zip(x_rest).map(|(l, x)| l * x).sum();
    let [a, b, c, d, e, f, g, h] = sums;
    ((a + b) + (c + d)) + ((e + f) + (g + h)) + rest
}

/// Returns the supernodes. Before one is returned, the values of the next one are read into the cache: one read for each line
/// of the cache, and no read waits for another. Sweeps wait for the memory; these reads save a third to a half of their time.
fn fetched<'a>(supernodes: impl Iterator<Item = Supernode<'a>>) -> impl Iterator<Item = Supernode<'a>> {
    const LINE: usize = 8;
    let mut supernodes = supernodes.peekable();
    std::iter::from_fn(move || {
        let supernode = supernodes.next();
        if let Some(next) = supernodes.peek() {
            let lines = next.values.iter().step_by(LINE);
            std::hint::black_box(lines.fold(0_u64, |all, value| all.wrapping_add(value.to_bits())));
        }
        supernode
    })
}

/// Gathers the values in the rows of a supernode.
fn gather(node: &Supernode<'_>, x: &[f64], work: &mut Vec<f64>) {
    work.clear();
    work.extend_from_slice(&x[node.first..node.first + node.columns]);
    work.extend(node.below.iter().map(|&row| x[row as usize]));
}
