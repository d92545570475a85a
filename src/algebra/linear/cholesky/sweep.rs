//! Forward and backward substitution with the first columns of `L`, including border rows.
//!
//! The solves of the backends have no border: they would include `L_cc` and leave `L_cr` to a second pass over the
//! factors. The blocks are so small that calling a matrix product for each would cost more than its work.
//!
//! # The elimination tree in branches, which can be swept at the same time
//!
//! A supernode changes only its ancestors in a forward substitution, and reads only them in a backward one. Branches, subtrees
//! without common supernodes, are therefore independent of each other. What is left of the tree, the trunk, comes after them in a
//! forward substitution and before them in a backward one. Branches depend on the factors alone, so that all sums have one order for
//! any number of threads.

use super::{Supernodal, Supernode, nodes};
use rayon::prelude::*;
use std::ops::Range;

/// Computes `[b_r; b_c] → [L_rr⁻¹ b_r; b_c - L_cr L_rr⁻¹ b_r]`, in the order of the factors.
pub(super) fn forward(factor: &dyn Supernodal, tree: &Branches, interior: usize, x: &mut [f64]) {
    let found = tree.map(|branch| {
        let mut own = x[branch.columns.clone()].to_vec();
        own.resize(own.len() + branch.outside.len(), 0.0);
        let (mut places, mut work) = (&branch.places[..], Vec::new());
        for node in fetched(branch.supernodes.clone().map(|k| factor.supernode(k))) {
            let (rows, others) = places.split_at(node.below.len());
            let own_rows = rows.iter().map(|&row| row as usize);
            eliminate(&node, node.first - branch.columns.start, own_rows, node.columns, &mut own, &mut work);
            places = others;
        }
        own
    });
    for (branch, own) in tree.branches.iter().zip(found) {
        let (inside, outside) = own.split_at(branch.columns.len());
        x[branch.columns.clone()].copy_from_slice(inside);
        branch.outside.iter().zip(outside).for_each(|(&row, value)| x[row] += value);
    }
    let mut work = Vec::new();
    let trunk = tree.trunk.iter().map(|&k| factor.supernode(k));
    for node in fetched(trunk.take_while(|node| node.first < interior)) {
        let rows = node.below.iter().map(|&row| row as usize);
        eliminate(&node, node.first, rows, node.columns.min(interior - node.first), x, &mut work);
    }
}

/// Computes `[y_r; x_c] → [L_rr⁻ᵀ (y_r - L_crᵀ x_c); x_c]`, in the order of the factors.
pub(super) fn backward(factor: &dyn Supernodal, tree: &Branches, interior: usize, x: &mut [f64]) {
    let mut work = Vec::new();
    let trunk = tree.trunk.iter().rev().map(|&k| factor.supernode(k));
    for node in fetched(trunk.filter(|node| node.first < interior)) {
        let rows = node.below.iter().map(|&row| row as usize);
        substitute(&node, node.first, rows, node.columns.min(interior - node.first), x, &mut work);
    }
    let found = tree.map(|branch| {
        let mut own = x[branch.columns.clone()].to_vec();
        own.extend(branch.outside.iter().map(|&row| x[row]));
        let (mut places, mut work) = (&branch.places[..], Vec::new());
        for node in fetched(branch.supernodes.clone().rev().map(|k| factor.supernode(k))) {
            let (others, rows) = places.split_at(places.len() - node.below.len());
            let own_rows = rows.iter().map(|&row| row as usize);
            substitute(&node, node.first - branch.columns.start, own_rows, node.columns, &mut own, &mut work);
            places = others;
        }
        own
    });
    for (branch, own) in tree.branches.iter().zip(found) {
        x[branch.columns.clone()].copy_from_slice(&own[..branch.columns.len()]);
    }
}

/// Eliminates the first `columns` of a supernode. In `x`, its columns begin at `first` and its rows below are `rows`.
fn eliminate(
    node: &Supernode<'_>,
    first: usize,
    rows: impl Iterator<Item = usize> + Clone,
    columns: usize,
    x: &mut [f64],
    work: &mut Vec<f64>,
) {
    gather(&x[first..first + node.columns], rows.clone().map(|row| x[row]), work);
    for panel in panels(columns) {
        let (top, below) = work.split_at_mut(panel.end);
        // First the columns of the panel, then all rows below them.
        for k in panel.clone() {
            let column = node.column(k);
            let (value, others) = top[k..].split_at_mut(1);
            value[0] /= column[0];
            others.iter_mut().zip(&column[1..]).for_each(|(x, l)| *x -= l * value[0]);
        }
        let values = &top[panel.clone()];
        let subtract = |(from, below): (usize, &mut [f64])| subtract_columns(node, &panel, values, from, below);
        let threads = threads_for(values.len() * below.len());
        if threads == 1 {
            subtract((panel.end, below));
        } else {
            let length = below.len().div_ceil(threads);
            let parts = below.par_chunks_mut(length).enumerate();
            parts.map(|(part, below)| (panel.end + part * length, below)).for_each(subtract);
        }
    }
    let (block, below) = work.split_at(node.columns);
    x[first..first + node.columns].copy_from_slice(block);
    rows.zip(below).for_each(|(row, &value)| x[row] = value);
}

/// Subtracts the columns of a panel, each times its value, from the rows of a supernode that begin at `from`.
fn subtract_columns(node: &Supernode<'_>, panel: &Range<usize>, values: &[f64], from: usize, x: &mut [f64]) {
    let column = |k: usize| &node.column(k)[from - k..];
    for (values, first) in values.chunks(TILE).zip(panel.clone().step_by(TILE)) {
        if let Ok(values) = <[f64; TILE]>::try_from(values) {
            let [a, b, c, d] = std::array::from_fn(|k| column(first + k));
            let rows = x.iter_mut().zip(a).zip(b).zip(c).zip(d);
            rows.for_each(|((((x, a), b), c), d)| {
                *x = *x - a * values[0] - b * values[1] - c * values[2] - d * values[3];
            });
        } else {
            for (k, value) in (first..).zip(values) {
                x.iter_mut().zip(column(k)).for_each(|(x, l)| *x -= l * value);
            }
        }
    }
}

/// Solves for the first `columns` of a supernode. In `x`, its columns begin at `first` and its rows below are `rows`.
fn substitute(
    node: &Supernode<'_>,
    first: usize,
    rows: impl Iterator<Item = usize>,
    columns: usize,
    x: &mut [f64],
    work: &mut Vec<f64>,
) {
    gather(&x[first..first + node.columns], rows.map(|row| x[row]), work);
    for panel in panels(columns).rev() {
        let (top, below) = work.split_at_mut(panel.end);
        let top = &mut top[panel.start..];
        // First the rows below the panel, in the order of memory; then the panel.
        let subtract = |(k, x): (usize, &mut f64)| {
            *x -= product(&node.column(panel.start + k)[panel.end - panel.start - k..], below);
        };
        if threads_for(top.len() * below.len()) == 1 {
            top.iter_mut().enumerate().for_each(subtract);
        } else {
            top.par_iter_mut().enumerate().for_each(subtract);
        }
        for k in (0..top.len()).rev() {
            let column = node.column(panel.start + k);
            let (upper, lower) = top.split_at_mut(k + 1);
            upper[k] = (upper[k] - product(&column[1..=lower.len()], lower)) / column[0];
        }
    }
    x[first..first + columns].copy_from_slice(&work[..columns]);
}

/// The number of columns of a supernode that are swept before threads share the rows below them.
const PANEL: usize = 128;

/// With fewer values than this, threads take more time to begin than they save.
const SHARED: usize = 1 << 17;

/// Returns the panels of the first columns of a supernode.
fn panels(columns: usize) -> impl DoubleEndedIterator<Item = Range<usize>> {
    (0..columns.div_ceil(PANEL)).map(move |k| k * PANEL..columns.min((k + 1) * PANEL))
}

/// Returns the number of threads that share this number of values. The results do not depend on it.
fn threads_for(values: usize) -> usize {
    if values < SHARED { 1 } else { rayon::current_num_threads() }
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
    // Larger supernodes would displace the values that are in use; they are read as a stream anyway.
    const CACHE: usize = 1 << 15;
    let mut supernodes = supernodes.peekable();
    std::iter::from_fn(move || {
        let supernode = supernodes.next();
        if let Some(next) = supernodes.peek().filter(|next| next.values.len() <= CACHE) {
            let lines = next.values.iter().step_by(LINE);
            std::hint::black_box(lines.fold(0_u64, |all, value| all.wrapping_add(value.to_bits())));
        }
        supernode
    })
}

/// Gathers the values in the rows of a supernode.
fn gather(block: &[f64], below: impl Iterator<Item = f64>, work: &mut Vec<f64>) {
    work.clear();
    work.extend_from_slice(block);
    work.extend(below);
}

/// No branch has more than this share of the values in `L`.
const LARGEST: f64 = 0.125;

/// The number of values from which on another thread is worth the time to wake it.
const FEWEST: usize = 1 << 18;

/// The elimination tree of `L`, with branches in the interior.
pub(super) struct Branches {
    pub branches: Vec<Branch>,
    /// The other supernodes, ascending.
    pub trunk: Vec<usize>,
}

/// Neighbouring subtrees.
pub(super) struct Branch {
    pub supernodes: Range<usize>,
    pub columns: Range<usize>,
    /// The rows of `L` below these columns in which a supernode of the branch has values, ascending.
    pub outside: Vec<usize>,
    /// The places of the rows below each supernode in the columns and `outside`, one supernode after the other.
    pub places: Vec<u32>,
}

impl Branches {
    /// Finds branches in the first `interior` columns of `L`.
    pub fn new(factor: &dyn Supernodal, interior: usize) -> Self {
        let all: Vec<_> = nodes(factor).take_while(|node| node.first < interior).collect();
        let parent = |k: usize| {
            let row = *all[k].below.first()? as usize;
            (row < interior).then(|| all.partition_point(|node| node.first <= row) - 1)
        };
        // The values, the number of supernodes and the first supernode of each subtree.
        let mut values: Vec<usize> = all.iter().map(|node| node.values.len()).collect();
        let mut sizes = vec![1; all.len()];
        let mut starts: Vec<usize> = (0..all.len()).collect();
        let total: usize = values.iter().sum();
        for k in 0..all.len() {
            if let Some(parent) = parent(k) {
                values[parent] += values[k];
                sizes[parent] += sizes[k];
                starts[parent] = starts[parent].min(starts[k]);
            }
        }
        let most = (LARGEST * total as f64) as usize;
        // The last supernode may have columns of the border. The supernodes of a subtree are neighbours if its order is a postorder.
        let is_small =
            |k: usize| values[k] <= most && all[k].first + all[k].columns <= interior && k + 1 - starts[k] == sizes[k];
        // A small subtree may contain one that is not: only those without a small one around them are branches.
        let mut is_within = vec![false; all.len()];
        for k in (0..all.len()).rev() {
            is_within[k] = parent(k).is_some_and(|parent| is_within[parent] || is_small(parent));
        }
        let mut ranges = Vec::<(Range<usize>, usize)>::new();
        if total >= FEWEST {
            for k in (0..all.len()).filter(|&k| is_small(k) && !is_within[k]) {
                let subtree = starts[k]..k + 1;
                match ranges.last_mut() {
                    Some((last, size)) if last.end == subtree.start && *size + values[k] <= most => {
                        (last.end, *size) = (subtree.end, *size + values[k]);
                    }
                    _ => ranges.push((subtree, values[k])),
                }
            }
        }
        let branches: Vec<Branch> = ranges.into_iter().map(|(range, _)| Branch::new(factor, range)).collect();
        let mut is_trunk = vec![true; factor.len()];
        for branch in &branches {
            is_trunk[branch.supernodes.clone()].fill(false);
        }
        Branches { branches, trunk: (0..factor.len()).filter(|&k| is_trunk[k]).collect() }
    }

    /// Returns the results of `work` for all branches, in their order.
    pub fn map<R: Send>(&self, work: impl Fn(&Branch) -> R + Sync + Send) -> Vec<R> {
        self.branches.par_iter().map(work).collect()
    }
}

impl Branch {
    fn new(factor: &dyn Supernodal, supernodes: Range<usize>) -> Self {
        let all = || supernodes.clone().map(|k| factor.supernode(k));
        let first = all().next().map_or(0, |node| node.first);
        let end = all().next_back().map_or(first, |node| node.first + node.columns);
        let below = || all().flat_map(|node| node.below.iter().map(|&row| row as usize));
        let mut outside: Vec<usize> = below().filter(|&row| row >= end).collect();
        outside.sort_unstable();
        outside.dedup();
        let place = |row: usize| match row.checked_sub(end) {
            None => row - first,
            Some(_) => end - first + outside.partition_point(|&other| other < row),
        };
        let places = below().map(|row| place(row) as u32).collect();
        Branch { supernodes, columns: first..end, outside, places }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::algebra::linear::FactorInfo;

    /// Supernodes of one column with these rows below, and a dense last one.
    struct Tree(Vec<Vec<i64>>, Vec<f64>);

    /// The columns of the last supernode.
    const LAST: usize = 512;

    impl Supernodal for Tree {
        fn len(&self) -> usize {
            self.0.len()
        }

        fn supernode(&self, k: usize) -> Supernode<'_> {
            let (columns, below) = (if k + 1 == self.len() { LAST } else { 1 }, &self.0[k]);
            Supernode { first: k, columns, below, values: &self.1[..columns * (columns + below.len())] }
        }

        fn info(&self) -> FactorInfo {
            FactorInfo::default()
        }
    }

    /// In an order that is no postorder, as minimum degree may leave it, a subtree without gaps contains one with a gap: column 1
    /// stands between 0 and its parent 2. No column may be in two branches, or be swept with the trunk and in a branch.
    #[test]
    fn each_supernode_is_swept_once() {
        for below in [[2, 3, 3, 4], [3, 2, 3, 4], [1, 2, 3, 4], [2, 4, 4, 4]] {
            let tree = Tree(below.iter().map(|row| vec![*row]).chain([vec![]]).collect(), vec![1.0; LAST * LAST]);
            let Branches { branches, trunk } = Branches::new(&tree, 4 + LAST);
            let mut all: Vec<usize> =
                branches.iter().flat_map(|branch| branch.supernodes.clone()).chain(trunk).collect();
            all.sort_unstable();
            assert!(!branches.is_empty() && all == [0, 1, 2, 3, 4], "{below:?}: {all:?}");
        }
    }
}
