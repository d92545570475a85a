//! The places of the unknowns of a grid in a matrix on all ranks, and the matrices that eliminate contact there.
//!
//! Each rank has the rows of its nodes, with all directions; the last one those of the contact forces besides.

use stickslip::algebra::linear::{Grid, LinearError, SystemMatrix};

use super::node::{Eliminated, Local};
use super::small::{ONE, minus};
use crate::expect_length;
use crate::petsc::{Entries, Int, int};
use crate::rows::Numbering;
use crate::system::Contact;

/// The places of all unknowns, for one pattern.
pub(super) struct Layout {
    /// The ranges of rows of the ranks, and the number of rows of displacements.
    pub rows: Vec<usize>,
    pub displacements: usize,
    /// The row of each unknown.
    pub places: Vec<Int>,
    /// The rows without an unknown that need a diagonal.
    empty: Vec<Int>,
    /// The displacements and the forces of each contact node.
    contacts: Vec<[[Option<usize>; 3]; 2]>,
}

/// Returns an error unless all places exist in a matrix with this number of `unknowns`, and no node has two contacts.
pub(super) fn check(grid: &Grid, unknowns: usize) -> Result<(), LinearError> {
    let Grid { dimension: d, nodes, displacements, contacts, changed, .. } = grid;
    let (n, mut of_node) = (displacements.len(), contacts.iter().map(|contact| contact.node).collect::<Vec<_>>());
    of_node.sort_unstable();
    let forces: Vec<usize> = contacts.iter().flat_map(|contact| contact.forces).flatten().collect();
    let mut all = std::iter::once(("dimension of the grid, less than", 4, *d))
        .chain([("forces of the contacts, less than", 1 + d * contacts.len(), forces.len())])
        .chain(displacements.iter().map(|at| ("nodes of the grid, more than that of a displacement,", *nodes, at.0)))
        .chain(displacements.iter().map(|at| ("directions of the grid, more than that of a displacement,", *d, at.1)))
        .chain(contacts.iter().map(|contact| ("nodes of the grid, more than that of a contact,", *nodes, contact.node)))
        .chain(of_node.windows(2).map(|of| ("contacts of a node, less than", 2, 1 + usize::from(of[0] == of[1]))))
        .chain(forces.iter().map(|place| ("unknowns, more than the place of a force,", unknowns, *place)))
        .chain(forces.iter().map(|place| ("places of forces after those of displacements,", place + 1, n)))
        .chain(changed.iter().map(|(e, _)| ("displacements, more than a changed one,", n, *e)))
        .chain(changed.iter().flat_map(|(_, of)| of).map(|(a, _)| ("displacements, more than one held,", n, *a)));
    if let Some((what, expected, found)) = all.find(|(_, limit, found)| found >= limit) {
        return Err(LinearError::Shape { what, expected, found });
    }
    expect_length("displacements and forces of the grid", unknowns, n + forces.len())?;
    grid.motions.iter().try_for_each(|motion| expect_length("displacements of a rigid motion", n, motion.len()))
}

impl Layout {
    /// Creates the layout for a matrix of this `size`. Nodes have the numbering of a `shared`
    /// stiffness, or are divided evenly among this number of `ranks`.
    pub(super) fn new(grid: &Grid, size: usize, shared: Option<&Numbering>, ranks: usize) -> Result<Self, LinearError> {
        check(grid, size)?;
        let (d, n) = (grid.dimension, grid.displacements.len());
        let mut own = vec![[None; 3]; grid.nodes];
        grid.displacements.iter().enumerate().for_each(|(dof, &(node, a))| own[node][a] = Some(dof));
        grid.contacts.iter().try_for_each(|contact| {
            expect_length("displacements of a contact node", 1, usize::from(own[contact.node] != [None; 3]))
        })?;
        let even = Numbering::even(own.iter().map(|own| *own != [None; 3]), ranks);
        let Numbering { numbers, bounds } = shared.unwrap_or(&even);
        expect_length("nodes with displacements", bounds[ranks], even.bounds[ranks])?;
        let mut rows: Vec<usize> = bounds.iter().map(|bound| bound * d).collect();
        let displacements = rows[ranks];
        rows[ranks] += grid.contacts.len() * d;
        let end = int(rows[ranks])?;
        let mut places: Vec<Int> =
            grid.displacements.iter().map(|&(node, a)| (numbers[node] as usize * d + a) as Int).collect();
        places.extend((displacements as Int..).take(size - n));
        let mut is_empty = vec![true; rows[ranks]];
        places.iter().copied().for_each(|place| is_empty[place as usize] = false);
        let first = if shared.is_some() { displacements as Int } else { 0 };
        Ok(Layout {
            empty: (first..end).filter(|row| is_empty[*row as usize]).collect(),
            contacts: grid.contacts.iter().map(|contact| [own[contact.node], contact.forces]).collect(),
            rows,
            displacements,
            places,
        })
    }

    /// Returns the shares of displacements that others contain: the matrix and its transpose.
    pub(super) fn shares(&self, grid: &Grid) -> [Entries; 2] {
        let mut shares = [Entries::default(), Entries::default()];
        for (e, a, c) in grid.changed.iter().flat_map(|(e, others)| others.iter().map(move |(a, c)| (e, a, c))) {
            shares[0].push(self.places[*e], self.places[*a], *c);
            shares[1].push(self.places[*a], self.places[*e], *c);
        }
        shares
    }

    /// Returns the orthonormal rigid motions of the displacements without shares of others, followed by zeros.
    pub(super) fn motions(&self, grid: &Grid) -> Vec<Vec<f64>> {
        let product = |a: &[f64], b: &[f64]| a.iter().zip(b).map(|(a, b)| a * b).sum::<f64>();
        let mut motions: Vec<Vec<f64>> = Vec::new();
        for mut u in grid.motions.iter().cloned() {
            for (e, others) in &grid.changed {
                u[*e] -= others.iter().map(|(a, c)| c * u[*a]).sum::<f64>();
            }
            let before = product(&u, &u).sqrt();
            for other in motions.iter().chain(&motions) {
                let share = product(other, &u);
                u.iter_mut().zip(other).for_each(|(u, other)| *u -= share * other);
            }
            let size = product(&u, &u).sqrt();
            // A motion that depends on the others is left out.
            if size > 1e-10 * before {
                u.resize(self.places.len(), 0.0);
                motions.push(u.iter().map(|u| u / size).collect());
            }
        }
        motions
    }

    /// Returns the contact nodes of `matrix`, eliminated.
    pub(super) fn nodes(&self, matrix: &SystemMatrix, oblique: bool) -> Vec<Eliminated> {
        let get = |row: Option<usize>, column| row.zip(column).map_or(0.0, |(row, column)| matrix.get(row, column));
        let block = |rows: [_; 3], columns: [_; 3]| rows.map(|row| columns.map(|column| get(row, column)));
        let local = |&[own, forces]: &[[Option<usize>; 3]; 2]| Local {
            b: block(own, forces),
            r: block(forces, own),
            d: block(forces, forces),
            directions: own.map(|dof| dof.is_some()),
            forces: forces.map(|place| place.is_some()),
            stiffness: own.map(|dof| get(dof, dof)).into_iter().fold(0.0, f64::max),
        };
        self.contacts.iter().map(|contact| local(contact).eliminated(oblique)).collect()
    }

    /// Returns the matrices that eliminate contact at these `nodes`, in `d` dimensions.
    pub(super) fn contact(&self, nodes: &[Eliminated], d: usize) -> Contact {
        let mut contact = Contact::default();
        for (k, (of, node)) in self.contacts.iter().zip(nodes).enumerate() {
            let [own, forces] = of.map(|side| side.map(|at| at.map(|at| self.places[at])));
            let all = [0, 1, 2].map(|i| (i < d).then_some((self.displacements + k * d + i) as Int));
            for (to, rows, columns, m) in [
                (0, own, forces, node.prescribed),
                (0, forces, forces, node.given),
                (1, own, own, minus(&node.free, &ONE)),
                (1, forces, own, node.following),
                (2, own, own, minus(&node.swept, &ONE)),
                (3, forces, own, node.reactions),
                (4, own, own, node.added),
                (4, all, all, ONE),
            ] {
                for (i, j) in (0..9).map(|k| (k / 3, k % 3)) {
                    // The last matrix couples displacements alone. Multigrid needs full blocks of nodes.
                    if let (Some(row), Some(column), true) = (rows[i], columns[j], to == 4 || m[i][j] != 0.0) {
                        contact[to].push(row, column, m[i][j]);
                    }
                }
            }
        }
        contact
    }

    /// Returns the entries of `matrix` outside a shared stiffness, with a diagonal in the rows without an unknown.
    pub(super) fn entries(&self, matrix: &SystemMatrix) -> Entries {
        let mut entries = Entries::default();
        for (row, column, value) in matrix.rest().entries() {
            entries.push(self.places[row], self.places[column], value);
        }
        let displacements = self.places.iter().filter(|place| (**place as usize) < self.displacements).count();
        let largest = (0..displacements).map(|k| matrix.get(k, k)).fold(0.0, f64::max);
        self.empty.iter().for_each(|row| entries.push(*row, *row, if largest > 0.0 { largest } else { 1.0 }));
        entries
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
        assert_eq!(check(&grid, 4), Ok(()));
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
            assert!(matches!(check(&grid, 4), Err(LinearError::Shape { .. })), "{k}");
        }
    }
}
