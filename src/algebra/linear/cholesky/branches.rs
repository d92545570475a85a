//! The elimination tree in branches, which can be swept at the same time.
//!
//! A supernode changes only its ancestors in a forward substitution, and reads only them in a backward one. Branches, subtrees
//! without common supernodes, are therefore independent of each other. What is left of the tree, the trunk, comes after them in a
//! forward substitution and before them in a backward one. Branches depend on the factors alone, so that all sums have one order for
//! any number of threads.

use std::ops::Range;

use rayon::prelude::*;

use super::{Supernodal, nodes};

/// No branch has more than this share of the values in `L`.
const LARGEST: f64 = 0.125;

/// With fewer values than this, a sweep takes less time than to wake another thread for it.
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
        let mut ranges = Vec::<(Range<usize>, usize)>::new();
        if total >= FEWEST {
            for k in (0..all.len()).filter(|&k| is_small(k) && parent(k).is_none_or(|parent| !is_small(parent))) {
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
        if rayon::current_num_threads() == 1 {
            return self.branches.iter().map(work).collect();
        }
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
