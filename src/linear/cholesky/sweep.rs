//! Forward and backward substitution with the first columns of `L`, border rows included.
//!
//! Written out rather than left to the backends, whose solves know no border: they would take `L_cc`
//! along and leave `L_cr` to a second pass over the factors, and the blocks are so small that a call of
//! a matrix product for each costs more than its work.

use super::{Supernodal, Supernode, nodes};
use crate::vector::dot;

/// `[b_r; b_c] → [L_rr⁻¹ b_r; b_c - L_cr L_rr⁻¹ b_r]`, in the order of the factors.
pub(super) fn forward(factor: &dyn Supernodal, interior: usize, x: &mut [f64]) {
    let mut work = Vec::new();
    for node in nodes(factor).take_while(|node| node.first < interior) {
        gather(&node, x, &mut work);
        for k in 0..node.columns.min(interior - node.first) {
            let column = node.column(k);
            let (top, below) = work[k..].split_at_mut(1);
            top[0] /= column[0];
            let value = top[0];
            below.iter_mut().zip(&column[1..]).for_each(|(x, l)| *x -= l * value);
        }
        let (block, below) = work.split_at(node.columns);
        x[node.first..node.first + node.columns].copy_from_slice(block);
        node.below.iter().zip(below).for_each(|(&row, &value)| x[row as usize] = value);
    }
}

/// `[y_r; x_c] → [L_rr⁻ᵀ (y_r - L_crᵀ x_c); x_c]`, in the order of the factors.
pub(super) fn backward(factor: &dyn Supernodal, interior: usize, x: &mut [f64]) {
    let mut work = Vec::new();
    for node in nodes(factor).rev().filter(|node| node.first < interior) {
        gather(&node, x, &mut work);
        let columns = node.columns.min(interior - node.first);
        // First all columns with the rows below the block, in the order of memory; then the block.
        let (top, below) = work.split_at_mut(columns);
        for (k, x) in top.iter_mut().enumerate() {
            *x -= dot(&node.column(k)[columns - k..], &*below);
        }
        for k in (0..columns).rev() {
            let column = node.column(k);
            top[k] = (top[k] - dot(&column[1..columns - k], &top[k + 1..])) / column[0];
        }
        x[node.first..node.first + columns].copy_from_slice(top);
    }
}

/// The values in the rows of a supernode.
fn gather(node: &Supernode<'_>, x: &[f64], work: &mut Vec<f64>) {
    work.clear();
    work.extend_from_slice(&x[node.first..node.first + node.columns]);
    work.extend(node.below.iter().map(|&row| x[row as usize]));
}
