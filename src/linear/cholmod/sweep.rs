//! Forward and backward substitution with the columns of the interior, border rows included.
//!
//! Written out rather than left to CHOLMOD, whose solves know no border: they would take `L_cc` along
//! and leave `L_cr` to a second pass over the factors, and the blocks are so small that a call of the
//! BLAS for each costs more than its work. Here one pass is bound by memory alone.

use std::array::from_fn;

use super::raw::{Factor, Supernode};

/// Columns that the backward pass takes at a time: each value of the vector is then loaded once for
/// so many of the matrix, and these are read in the direction that memory likes.
const PANEL: usize = 4;

/// `[b_r; b_c] → [L_rr⁻¹ b_r; b_c - L_cr L_rr⁻¹ b_r]`, in the order of the factors.
pub(super) fn forward(factor: &Factor, interior: usize, x: &mut [f64]) {
    let mut work = Vec::new();
    for node in factor.supernodes().take_while(|node| node.first < interior) {
        gather(&node, x, &mut work);
        for k in 0..node.columns.min(interior - node.first) {
            let [column] = panel(&node, k);
            let (top, below) = work[k..].split_at_mut(1);
            top[0] /= column[0];
            let value = top[0];
            below.iter_mut().zip(&column[1..]).for_each(|(x, l)| *x -= l * value);
        }
        for (&row, &value) in node.rows.iter().zip(&work) {
            x[row as usize] = value;
        }
    }
}

/// `[y_r; x_c] → [L_rr⁻ᵀ (y_r - L_crᵀ x_c); x_c]`, in the order of the factors.
pub(super) fn backward(factor: &Factor, interior: usize, x: &mut [f64]) {
    let mut work = Vec::new();
    for node in factor.supernodes().rev().filter(|node| node.first < interior) {
        gather(&node, x, &mut work);
        let columns = node.columns.min(interior - node.first);
        let whole = columns - columns % PANEL;
        for k in (whole..columns).rev() {
            substitute::<1>(&node, k, &mut work);
        }
        for k in (0..whole).step_by(PANEL).rev() {
            substitute::<PANEL>(&node, k, &mut work);
        }
        x[node.first..node.first + columns].copy_from_slice(&work[..columns]);
    }
}

/// The values in the rows of a supernode.
fn gather(node: &Supernode<'_>, x: &[f64], work: &mut Vec<f64>) {
    work.clear();
    work.extend(node.rows.iter().map(|&row| x[row as usize]));
}

/// `W` columns of a supernode from the diagonal of the first, `k`, downwards.
fn panel<'a, const W: usize>(node: &Supernode<'a>, k: usize) -> [&'a [f64]; W] {
    let rows = node.rows.len();
    from_fn(|j| &node.values[(k + j) * rows + k..(k + j + 1) * rows])
}

/// Takes the products of `W` columns with the rows below off and divides by the pivots.
fn substitute<const W: usize>(node: &Supernode<'_>, k: usize, work: &mut [f64]) {
    let columns: [&[f64]; W] = panel(node, k);
    let (top, below) = work[k..].split_at_mut(W);
    let products = products(columns.map(|column| &column[W..]), below);
    for j in (0..W).rev() {
        let within: f64 = (j + 1..W).map(|i| columns[j][i] * top[i]).sum();
        top[j] = (top[j] - products[j] - within) / columns[j][j];
    }
}

/// The scalar products of `x` with each of the columns, in four sums each that the processor adds side
/// by side.
fn products<const W: usize>(columns: [&[f64]; W], x: &[f64]) -> [f64; W] {
    let (parts, rest) = x.as_chunks::<4>();
    let split = columns.map(|column| column[..x.len()].as_chunks::<4>());
    let column_parts = split.map(|(column_parts, _)| &column_parts[..parts.len()]);
    let mut sums = [[0.0; 4]; W];
    for (i, x) in parts.iter().enumerate() {
        for j in 0..W {
            for lane in 0..4 {
                sums[j][lane] += column_parts[j][i][lane] * x[lane];
            }
        }
    }
    from_fn(|j| {
        let end: f64 = split[j].1.iter().zip(rest).map(|(l, x)| l * x).sum();
        sums[j].iter().sum::<f64>() + end
    })
}
