//! The rows of one node of the stiffness, rotated into the frames of the contact nodes, and with contact eliminated.

use super::form::Form;
use super::node::Eliminated;
use super::small::Small;

/// The rows of a node, one for each direction, on all directions of its columns.
pub(super) type Border = [Vec<f64>; 3];

/// The places of the rows; `C` is the contact of a column, if it has one.
pub(super) struct Block<'a, C> {
    pub dimension: usize,
    /// The nodes of the columns.
    pub columns: &'a [usize],
    /// The index of the node itself among them.
    pub own: usize,
    pub contact: C,
}

impl<'a, C> Block<'_, C>
where
    C: Fn(usize) -> Option<&'a Eliminated>,
{
    /// Rotates rows and columns from mesh directions into the frames.
    pub(super) fn turn(&self, rows: &mut Border) {
        let d = self.dimension;
        for (k, &column) in self.columns.iter().enumerate() {
            let Some(contact) = (self.contact)(column) else { continue };
            for row in rows.iter_mut() {
                let block = &mut row[k * d..(k + 1) * d];
                let mut turned = [0.0; 3];
                turned[..d].copy_from_slice(block);
                block.copy_from_slice(&contact.in_frame(turned)[..d]);
            }
        }
        if let Some(contact) = (self.contact)(self.columns[self.own]) {
            for k in 0..self.columns.len() * d {
                let turned = contact.in_frame([0, 1, 2].map(|i| rows[i][k]));
                rows.iter_mut().zip(turned).for_each(|(row, turned)| row[k] = turned);
            }
        }
    }

    /// Rotates rows into the frames and eliminates contact. `missing` are the directions of a column that supports
    /// have removed.
    pub(super) fn eliminate(&self, form: Form, rows: &mut Border, missing: impl Fn(usize) -> [bool; 3]) {
        let d = self.dimension;
        if let Some(contact) = (self.contact)(self.columns[self.own]) {
            contact.take_friction(form, rows, self.own * d, d);
        }
        let gone = |column: usize| (self.contact)(column).map_or_else(|| missing(column), Eliminated::gone);
        let largest = (0..d).map(|a| rows[a][self.own * d + a]).fold(0.0, f64::max);
        let own_gone = gone(self.columns[self.own]);
        for (k, &column) in self.columns.iter().enumerate() {
            let column_gone = gone(column);
            for a in 0..d {
                for b in (0..d).filter(|&b| own_gone[a] || column_gone[b]) {
                    let diagonal = k == self.own && a == b;
                    let entry = &mut rows[a][k * d + b];
                    *entry = if diagonal && *entry > 0.0 {
                        *entry
                    } else if diagonal {
                        if largest > 0.0 { largest } else { 1.0 }
                    } else {
                        0.0
                    };
                }
            }
        }
    }
}

impl Eliminated {
    /// Adds the springs to the rows of this node, whose own block begins at `own`. Sweeps the effect of the reactions
    /// in the constrained rows out of the unconstrained ones.
    fn take_friction(&self, form: Form, rows: &mut Border, own: usize, dimension: usize) {
        let free = self.gone().map(|gone| !gone);
        let springs: Small = match form {
            Form::Oblique => self.springs,
            Form::Symmetric => [0, 1, 2].map(|i| {
                [0, 1, 2].map(|j| {
                    let mean = 0.5 * (self.springs[i][j] + self.springs[j][i]);
                    if free[i] && free[j] { mean } else { 0.0 }
                })
            }),
        };
        for (row, springs) in rows.iter_mut().zip(springs) {
            row[own..].iter_mut().take(dimension).zip(springs).for_each(|(entry, spring)| *entry += spring);
        }
        if form == Form::Oblique {
            let before = rows.clone();
            for i in (0..3).filter(|&i| free[i]) {
                for j in (0..3).filter(|&j| self.sweep[i][j] != 0.0) {
                    let c = self.sweep[i][j];
                    rows[i].iter_mut().zip(&before[j]).for_each(|(to, from)| *to -= c * from);
                }
            }
        }
    }
}
