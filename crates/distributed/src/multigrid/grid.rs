//! The geometric data of multigrid besides the matrix: the positions of the unknowns.

use crate::expect_length;
use stickslip::algebra::linear::{Grid, LinearError};

/// The use of a [`Grid`] by multigrid.
pub(crate) trait OnGrid {
    /// Returns an error unless all places exist in a matrix with this number of `unknowns`, and no node has two
    /// contacts.
    fn checked(&self, unknowns: usize) -> Result<(), LinearError>;
    /// Replaces `ũ` by `u = Q ũ`.
    fn to_mesh(&self, u: &mut [f64]);
    /// Replaces `r` by `Qᵀ r`.
    fn residual_from_mesh(&self, r: &mut [f64]);
    /// Replaces `u` by `Q⁻¹ u`.
    fn displacements_from_mesh(&self, u: &mut [f64]);
    /// Returns the rigid modes, in `ũ`.
    fn motions(&self) -> Vec<Vec<f64>>;
}

impl OnGrid for Grid {
    fn checked(&self, unknowns: usize) -> Result<(), LinearError> {
        let expect = |what, expected: usize, found: usize| {
            if found < expected { Ok(()) } else { Err(LinearError::Shape { what, expected, found }) }
        };
        let n = self.displacements.len();
        expect("dimension of the grid, less than", 4, self.dimension)?;
        for &(node, direction) in &self.displacements {
            expect("nodes of the grid, more than that of a displacement,", self.nodes, node)?;
            expect("directions of the grid, more than that of a displacement,", self.dimension, direction)?;
        }
        let mut taken = vec![false; self.nodes];
        for contact in &self.contacts {
            expect("nodes of the grid, more than that of a contact,", self.nodes, contact.node)?;
            expect("contacts of a node, less than", 2, 1 + usize::from(taken[contact.node]))?;
            taken[contact.node] = true;
            for place in contact.forces.into_iter().flatten() {
                expect("unknowns, more than the place of a force,", unknowns, place)?;
                expect("places of forces after those of displacements,", place + 1, n)?;
            }
        }
        for motion in &self.motions {
            expect_length("displacements of a rigid motion", n, motion.len())?;
        }
        for (e, others) in &self.changed {
            expect("displacements, more than a changed one,", n, *e)?;
            others.iter().try_for_each(|(a, _)| expect("displacements, more than one held,", n, *a))?;
        }
        Ok(())
    }

    fn to_mesh(&self, u: &mut [f64]) {
        for (e, others) in &self.changed {
            u[*e] += others.iter().map(|(a, c)| c * u[*a]).sum::<f64>();
        }
    }

    fn residual_from_mesh(&self, r: &mut [f64]) {
        for (e, others) in &self.changed {
            for (a, c) in others {
                r[*a] += c * r[*e];
            }
        }
    }

    fn displacements_from_mesh(&self, u: &mut [f64]) {
        for (e, others) in &self.changed {
            u[*e] -= others.iter().map(|(a, c)| c * u[*a]).sum::<f64>();
        }
    }

    fn motions(&self) -> Vec<Vec<f64>> {
        let mut motions = self.motions.clone();
        for u in &mut motions {
            self.displacements_from_mesh(u);
        }
        motions
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use stickslip::algebra::linear::GridContact;

    #[test]
    fn a_grid_that_does_not_fit_is_an_error() {
        // Two nodes in the plane; the second has a contact without friction.
        let grid = Grid {
            interior: false,
            dimension: 2,
            nodes: 2,
            displacements: vec![(0, 0), (1, 0), (1, 1)],
            contacts: vec![GridContact { node: 1, forces: [None, None, Some(3)] }],
            changed: vec![(1, vec![(0, 0.5)])],
            motions: vec![vec![1.0, 1.0, 0.0]],
        };
        assert_eq!(grid.checked(4), Ok(()));
        let changes: [&dyn Fn(&mut Grid); 9] = [
            &|grid| grid.dimension = 4,
            &|grid| grid.displacements[0].0 = 2,
            &|grid| grid.displacements[0].1 = 2,
            &|grid| grid.contacts[0].forces[2] = Some(4),
            &|grid| grid.contacts[0].forces[2] = Some(2),
            &|grid| grid.contacts.push(grid.contacts[0]),
            &|grid| grid.changed[0].0 = 3,
            &|grid| grid.changed[0].1[0].0 = 3,
            &|grid| grid.motions[0].truncate(2),
        ];
        for (k, change) in changes.into_iter().enumerate() {
            let mut grid = grid.clone();
            change(&mut grid);
            assert!(matches!(grid.checked(4), Err(LinearError::Shape { .. })), "{k}");
        }
    }
}
