//! Which entries of the whole matrix make up the stiffness, and which the contact groups.

use std::ops::Range;
use std::sync::Arc;

use super::local::Local;
use crate::linear::LinearError;
use crate::linear::error::expect_length;
use crate::sparse::{Csc, Pattern, Symmetric};

/// The parts of a pattern on `(u, q)`.
pub(super) struct Border {
    /// That of the whole matrix.
    pub pattern: Arc<Pattern>,
    /// The pattern of the lower triangle of `K`.
    lower: Arc<Pattern>,
    /// Where its values stand in the whole matrix, column after column.
    slots: Vec<Range<usize>>,
    /// The displacements that stand in a row or a column with a `q`, group after group.
    pub last: Vec<usize>,
    /// The groups that share neither a displacement nor a `q`.
    pub groups: Vec<Group>,
}

/// Displacements and other unknowns that contact rows tie together.
pub(super) struct Group {
    /// Its displacements, as a range of [`Border::last`].
    pub displacements: Range<usize>,
    /// Its other unknowns, as numbers of the whole matrix.
    pub others: Vec<usize>,
    /// `[A D]` and `B` as (place in the small matrix, slot in the whole one).
    rows: Vec<(usize, usize)>,
    coupling: Vec<(usize, usize)>,
}

impl Border {
    /// The parts of `pattern`, the first `displacements` unknowns of which are `u`.
    pub(super) fn new(pattern: &Arc<Pattern>, displacements: usize) -> Result<Self, LinearError> {
        let n = pattern.columns();
        expect_length("rows of the matrix", n, pattern.rows())?;
        expect_length("displacements in the matrix", displacements.min(n), displacements)?;
        let rows = |column: usize| &pattern.row_indices()[pattern.column(column)];
        // K below the diagonal is one run of slots in each column, as rows ascend.
        let below = |column: usize, row: usize| {
            pattern.column(column).start + rows(column).partition_point(|&found| (found as usize) < row)
        };
        let slots: Vec<Range<usize>> = (0..displacements).map(|j| below(j, j)..below(j, displacements)).collect();
        let lower = Pattern::from_entries(displacements, displacements, |take| {
            for (column, slots) in slots.iter().enumerate() {
                pattern.row_indices()[slots.clone()].iter().for_each(|&row| take(row as usize, column));
            }
        });

        // Everything but K, as (row, column, slot).
        let contact = |visit: &mut dyn FnMut(usize, usize, usize)| {
            for column in 0..n {
                let first = slots.get(column).map_or(pattern.column(column).start, |slots| slots.end);
                for slot in first..pattern.column(column).end {
                    visit(pattern.row_indices()[slot] as usize, column, slot);
                }
            }
        };
        let mut sets = Sets::new(n);
        let mut touched = vec![false; n];
        touched[displacements..].fill(true);
        contact(&mut |row, column, _| {
            sets.join(row, column);
            (touched[row], touched[column]) = (true, true);
        });
        let (mut number, mut members) = (vec![None; n], Vec::<(Vec<usize>, Vec<usize>)>::new());
        for unknown in (0..n).filter(|&unknown| touched[unknown]) {
            let group = *number[sets.find(unknown)].get_or_insert(members.len());
            if group == members.len() {
                members.push((Vec::new(), Vec::new()));
            }
            let (own, others) = &mut members[group];
            (if unknown < displacements { own } else { others }).push(unknown);
        }
        // For each unknown its group, and its place there: first the displacements.
        let mut place = vec![(0, 0); n];
        let (mut last, mut groups) = (Vec::new(), Vec::with_capacity(members.len()));
        for (k, (own, others)) in members.into_iter().enumerate() {
            own.iter().chain(&others).enumerate().for_each(|(at, &unknown)| place[unknown] = (k, at));
            let first = last.len();
            last.extend(own);
            groups.push(Group { displacements: first..last.len(), others, rows: Vec::new(), coupling: Vec::new() });
        }
        contact(&mut |row, column, slot| {
            let ((k, i), (_, j)) = (place[row], place[column]);
            let group = &mut groups[k];
            let (own, others) = (group.displacements.len(), group.others.len());
            if row < displacements {
                group.coupling.push((i * others + j - own, slot));
            } else {
                group.rows.push(((i - own) * (own + others) + j, slot));
            }
        });
        Ok(Border { pattern: Arc::clone(pattern), lower: Arc::new(lower), slots, last, groups })
    }

    /// The values of `K` below the diagonal.
    pub(super) fn stiffness_values(&self, values: &[f64]) -> Vec<f64> {
        self.slots.iter().flat_map(|slots| values[slots.clone()].iter().copied()).collect()
    }

    /// Whether those are, to the last bit, the values `known`.
    pub(super) fn has_stiffness(&self, values: &[f64], known: &[f64]) -> bool {
        let mut known = known;
        self.slots.iter().all(|slots| {
            let (now, rest) = known.split_at(slots.len().min(known.len()));
            known = rest;
            // All of a column, without a way out at each entry: that is twice as fast.
            let differ = |bits, (a, b): (&f64, &f64)| bits | (a.to_bits() ^ b.to_bits());
            values[slots.clone()].iter().zip(now).fold(0, differ) == 0
        })
    }

    /// `K` of such values.
    pub(super) fn stiffness(&self, values: Vec<f64>) -> Symmetric {
        Symmetric::from_lower(Csc { pattern: Arc::clone(&self.lower), values })
    }
}

impl Group {
    /// Its contact rows in a matrix with `values`, solved.
    pub(super) fn solve(&self, values: &[f64]) -> Result<Local, LinearError> {
        let (own, others) = (self.displacements.len(), self.others.len());
        let mut rows = vec![0.0; others * (own + others)];
        let mut coupling = vec![0.0; own * others];
        self.rows.iter().for_each(|&(place, slot)| rows[place] = values[slot]);
        self.coupling.iter().for_each(|&(place, slot)| coupling[place] = values[slot]);
        Local::new(own, others, &rows, &coupling)
    }
}

/// Sets that grow together.
struct Sets(Vec<usize>);

impl Sets {
    fn new(n: usize) -> Self {
        Sets((0..n).collect())
    }

    /// The member that stands for the set of `k`.
    fn find(&mut self, mut k: usize) -> usize {
        while self.0[k] != k {
            self.0[k] = self.0[self.0[k]];
            k = self.0[k];
        }
        k
    }

    fn join(&mut self, i: usize, j: usize) {
        let (i, j) = (self.find(i), self.find(j));
        self.0[i.max(j)] = i.min(j);
    }
}
