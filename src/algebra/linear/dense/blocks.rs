//! The groups of unknowns that contact couples, and the entries of their contact rows.

use std::sync::Arc;

use super::local::Local;
use crate::algebra::linear::{Computed, SystemMatrix, expect_length};
use crate::algebra::sparse::{DenseSymmetric, Pattern};
use crate::algebra::union_find::UnionFind;

/// The blocks of a pattern on `(u, q)`.
pub(super) struct Blocks {
    /// The pattern of the entries outside `S`.
    pub pattern: Arc<Pattern>,
    /// The number of displacements, the unknowns of `S`.
    pub displacements: usize,
    /// The groups, which share neither a displacement nor a `q`.
    pub groups: Vec<Group>,
}

/// Displacements and other unknowns that contact rows couple.
pub(super) struct Group {
    /// The displacements of the group, ascending.
    pub displacements: Vec<usize>,
    /// The other unknowns of the group.
    pub others: Vec<usize>,
    /// The entries of `[A D]` and `[E B]` as (place in the small matrix, slot in the pattern).
    rows: Vec<(usize, usize)>,
    forces: Vec<(usize, usize)>,
}

impl Blocks {
    /// Finds the parts of the pattern outside the dense block of `a`.
    pub(super) fn new(a: &SystemMatrix) -> Computed<Self> {
        let (pattern, n) = (a.pattern(), a.order());
        expect_length("rows of the matrix", n, pattern.rows())?;
        let displacements = a.leading().map_or(0, DenseSymmetric::order);
        let entries = || {
            let column = |j: usize| pattern.column(j).map(move |slot| (pattern.row_indices()[slot] as usize, j, slot));
            (0..n).flat_map(column)
        };
        let mut sets = UnionFind::new(n);
        entries().for_each(|(row, column, _)| sets.join(row, column));
        let (mut number, mut groups) = (vec![None; n], Vec::<Group>::new());
        // The group of each unknown, and its place there among unknowns of its kind.
        let mut at = Vec::with_capacity(n);
        for unknown in 0..n {
            let k = *number[sets.least(unknown)].get_or_insert(groups.len());
            if k == groups.len() {
                let [displacements, others] = [(); 2].map(|()| Vec::new());
                groups.push(Group { displacements, others, rows: Vec::new(), forces: Vec::new() });
            }
            let Group { displacements: own, others, .. } = &mut groups[k];
            let kind = if unknown < displacements { own } else { others };
            at.push((k, kind.len()));
            kind.push(unknown);
        }
        for (row, column, slot) in entries() {
            let ((k, i), (_, j)) = (at[row], at[column]);
            let Group { displacements: own, others, rows, forces } = &mut groups[k];
            let (width, j) = (own.len() + others.len(), if column < displacements { j } else { own.len() + j });
            (if row < displacements { forces } else { rows }).push((i * width + j, slot));
        }
        Ok(Blocks { pattern: Arc::clone(pattern), displacements, groups })
    }
}

impl Group {
    /// Solves the contact rows of the group in a matrix with `values`. Returns `last` if it came from the same rows.
    pub(super) fn solve(&self, values: &[f64], last: Option<Local>) -> Computed<Local> {
        let same =
            |places: &[(usize, usize)], of: &[f64]| places.iter().all(|&(place, slot)| of[place] == values[slot]);
        if let Some(last) = last.filter(|last| same(&self.rows, &last.rows) && same(&self.forces, &last.forces)) {
            return Ok(last);
        }
        let (own, others) = (self.displacements.len(), self.others.len());
        let (mut rows, mut forces) = (vec![0.0; others * (own + others)], vec![0.0; own * (own + others)]);
        self.rows.iter().for_each(|&(place, slot)| rows[place] = values[slot]);
        self.forces.iter().for_each(|&(place, slot)| forces[place] = values[slot]);
        Local::new(own, others, rows, forces)
    }

    /// Iterates over the displacements, then over the other unknowns.
    pub(super) fn unknowns(&self) -> impl Iterator<Item = usize> + '_ {
        self.displacements.iter().chain(&self.others).copied()
    }
}
