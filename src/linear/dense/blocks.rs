//! Which entries of the whole matrix make up the stiffness, and which the contact groups.

use std::ops::Range;
use std::sync::Arc;

use faer::Mat;

use super::local::Local;
use crate::linear::LinearError;
use crate::linear::error::expect_length;
use crate::sets::Sets;
use crate::sparse::Pattern;

/// The parts of a pattern on `(u, q)`.
pub(super) struct Blocks {
    /// That of the whole matrix.
    pub pattern: Arc<Pattern>,
    /// All displacements, group after group.
    pub displacements: Vec<usize>,
    /// The place of each in that order.
    place: Vec<usize>,
    /// The groups that share neither a displacement nor a `q`.
    pub groups: Vec<Group>,
}

/// Displacements and other unknowns that contact rows tie together.
pub(super) struct Group {
    /// Its displacements, as a range of [`Blocks::displacements`].
    pub displacements: Range<usize>,
    /// Its other unknowns, as numbers of the whole matrix.
    pub others: Vec<usize>,
    /// `[A D]` and `B` as (place in the small matrix, slot in the whole one).
    rows: Vec<(usize, usize)>,
    coupling: Vec<(usize, usize)>,
}

impl Blocks {
    /// The parts of `pattern`, the first `displacements` unknowns of which are `u`.
    pub(super) fn new(pattern: &Arc<Pattern>, displacements: usize) -> Result<Self, LinearError> {
        let n = pattern.columns();
        expect_length("rows of the matrix", n, pattern.rows())?;
        expect_length("displacements in the matrix", displacements.min(n), displacements)?;
        // Everything but S, as (row, column, slot).
        let contact = |visit: &mut dyn FnMut(usize, usize, usize)| {
            for column in 0..n {
                let slots = pattern.column(column);
                let first = if column < displacements {
                    stiffness_slots(pattern, column, displacements).end
                } else {
                    slots.start
                };
                for slot in first..slots.end {
                    visit(pattern.row_indices()[slot] as usize, column, slot);
                }
            }
        };
        let mut sets = Sets::new(n);
        contact(&mut |row, column, _| sets.join(row, column));
        let (mut number, mut members) = (vec![None; n], Vec::<(Vec<usize>, Vec<usize>)>::new());
        for unknown in 0..n {
            let group = *number[sets.least(unknown)].get_or_insert(members.len());
            if group == members.len() {
                members.push((Vec::new(), Vec::new()));
            }
            let (own, others) = &mut members[group];
            (if unknown < displacements { own } else { others }).push(unknown);
        }
        // For each unknown its group, and its place there: first the displacements.
        let mut at = vec![(0, 0); n];
        let (mut order, mut groups) = (Vec::with_capacity(displacements), Vec::with_capacity(members.len()));
        for (k, (own, others)) in members.into_iter().enumerate() {
            own.iter().chain(&others).enumerate().for_each(|(place, &unknown)| at[unknown] = (k, place));
            let first = order.len();
            order.extend(own);
            groups.push(Group { displacements: first..order.len(), others, rows: Vec::new(), coupling: Vec::new() });
        }
        contact(&mut |row, column, slot| {
            let ((k, i), (_, j)) = (at[row], at[column]);
            let group = &mut groups[k];
            let (own, others) = (group.displacements.len(), group.others.len());
            if row < displacements {
                group.coupling.push((i * others + j - own, slot));
            } else {
                group.rows.push(((i - own) * (own + others) + j, slot));
            }
        });
        let mut place = vec![0; displacements];
        order.iter().enumerate().for_each(|(k, &unknown)| place[unknown] = k);
        Ok(Blocks { pattern: Arc::clone(pattern), displacements: order, place, groups })
    }

    /// Writes `S`, its rows and columns in the order of [`Blocks::displacements`].
    pub(super) fn copy_stiffness(&self, values: &[f64], to: &mut Mat<f64>) {
        let m = self.displacements.len();
        for column in 0..m {
            let to = to.col_as_slice_mut(self.place[column]);
            let slots = stiffness_slots(&self.pattern, column, m);
            for (&row, value) in self.pattern.row_indices()[slots.clone()].iter().zip(&values[slots]) {
                to[self.place[row as usize]] = *value;
            }
        }
    }
}

/// Where the entries of `S` in `column` are stored: as rows ascend, that is one run.
fn stiffness_slots(pattern: &Pattern, column: usize, displacements: usize) -> Range<usize> {
    let slots = pattern.column(column);
    let rows = &pattern.row_indices()[slots.clone()];
    slots.start..slots.start + rows.partition_point(|&row| (row as usize) < displacements)
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
