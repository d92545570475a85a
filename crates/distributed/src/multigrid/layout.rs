//! The places of the unknowns of a grid in a matrix on all ranks, and the matrices that eliminate contact there.
//!
//! Each rank has the rows of its nodes, with all directions, and then those of the contact forces at them.

use stickslip::algebra::linear::{Grid, LinearError, SystemMatrix};

use super::node::{Eliminated, Local};
use super::small::Small;
use crate::expect_length;
use crate::petsc::{Entry, Int, int};
use crate::rows::Numbering;
use crate::system::Contact;

/// The places of all unknowns, for one pattern.
pub(super) struct Layout {
    pub dimension: usize,
    /// The ranges of nodes and of rows of the ranks.
    pub nodes: Vec<usize>,
    pub rows: Vec<usize>,
    /// The row of each unknown.
    pub places: Vec<Int>,
    /// The directions that supports have removed: the row among displacements, and a displacement of the node.
    missing: Vec<(Int, usize)>,
    contacts: Vec<ContactPlaces>,
    /// For each displacement the others that contain a share of it.
    uses: Vec<Vec<(usize, f64)>>,
    changed: Vec<(usize, Vec<(usize, f64)>)>,
    /// The column of each displacement among those alone.
    columns: Vec<Int>,
}

/// The places of one contact node.
struct ContactPlaces {
    own: [Option<usize>; 3],
    forces: [Option<usize>; 3],
}

/// Returns an error unless all places exist in a matrix with this number of `unknowns`, and no node has two contacts.
pub(super) fn check(grid: &Grid, unknowns: usize) -> Result<(), LinearError> {
    let expect = |what, expected: usize, found: usize| {
        if found < expected { Ok(()) } else { Err(LinearError::Shape { what, expected, found }) }
    };
    let n = grid.displacements.len();
    expect("dimension of the grid, less than", 4, grid.dimension)?;
    for &(node, direction) in &grid.displacements {
        expect("nodes of the grid, more than that of a displacement,", grid.nodes, node)?;
        expect("directions of the grid, more than that of a displacement,", grid.dimension, direction)?;
    }
    let (mut taken, mut forces) = (vec![false; grid.nodes], 0);
    for contact in &grid.contacts {
        expect("nodes of the grid, more than that of a contact,", grid.nodes, contact.node)?;
        expect("contacts of a node, less than", 2, 1 + usize::from(taken[contact.node]))?;
        taken[contact.node] = true;
        for place in contact.forces.into_iter().flatten() {
            expect("unknowns, more than the place of a force,", unknowns, place)?;
            expect("places of forces after those of displacements,", place + 1, n)?;
            forces += 1;
        }
    }
    expect_length("displacements and forces of the grid", unknowns, n + forces)?;
    for motion in &grid.motions {
        expect_length("displacements of a rigid motion", n, motion.len())?;
    }
    for (e, others) in &grid.changed {
        expect("displacements, more than a changed one,", n, *e)?;
        others.iter().try_for_each(|(a, _)| expect("displacements, more than one held,", n, *a))?;
    }
    Ok(())
}

impl Layout {
    /// Creates the layout for a matrix with this number of `unknowns`. Nodes have the `numbering` of a shared
    /// stiffness, or are divided evenly among this number of `ranks`.
    pub(super) fn new(
        grid: &Grid,
        unknowns: usize,
        numbering: Option<&Numbering>,
        ranks: usize,
    ) -> Result<Self, LinearError> {
        check(grid, unknowns)?;
        let (d, n) = (grid.dimension, grid.displacements.len());
        let mut own = vec![[None; 3]; grid.nodes];
        grid.displacements.iter().enumerate().for_each(|(dof, &(node, a))| own[node][a] = Some(dof));
        let with: Vec<usize> = (0..grid.nodes).filter(|node| own[*node] != [None; 3]).collect();
        let mut number = vec![usize::MAX; grid.nodes];
        for (k, node) in with.iter().enumerate() {
            number[*node] = numbering.and_then(|numbering| numbering.number(*node)).unwrap_or(k);
        }
        let nodes = match numbering {
            Some(numbering) => numbering.bounds.clone(),
            None => (0..=ranks).map(|rank| rank * with.len() / ranks).collect(),
        };
        expect_length("nodes with displacements", nodes.last().copied().unwrap_or(0), with.len())?;
        let rank = |node: usize| nodes[1..].partition_point(|end| *end <= number[node]);
        let mut forces = vec![0; nodes.len()];
        for contact in &grid.contacts {
            if number[contact.node] == usize::MAX {
                return Err(LinearError::Shape { what: "displacements of a contact node", expected: 1, found: 0 });
            }
            forces[rank(contact.node) + 1] += contact.forces.iter().flatten().count();
        }
        (1..forces.len()).for_each(|k| forces[k] += forces[k - 1]);
        let rows: Vec<usize> = nodes.iter().zip(&forces).map(|(node, forces)| node * d + forces).collect();
        int(rows.last().copied().unwrap_or(0))?;
        // The place of a displacement of a node, behind the forces of the ranks before.
        let place = |node: usize, a: usize| (forces[rank(node)] + number[node] * d + a) as Int;
        let mut places: Vec<Int> = grid.displacements.iter().map(|&(node, a)| place(node, a)).collect();
        places.resize(unknowns, 0);
        let mut next = (0..ranks).map(|k| rows[k] + (nodes[k + 1] - nodes[k]) * d).collect::<Vec<_>>();
        let mut contacts = Vec::new();
        for contact in &grid.contacts {
            for at in contact.forces.into_iter().flatten() {
                let next = &mut next[rank(contact.node)];
                places[at] = *next as Int;
                *next += 1;
            }
            contacts.push(ContactPlaces { own: own[contact.node], forces: contact.forces });
        }
        let number = &number;
        let of_node = |node: &usize| {
            let (node, own) = (*node, own[*node]);
            let first = own.into_iter().flatten().next();
            (0..d).filter(move |a| own[*a].is_none()).filter_map(move |a| Some(((number[node] * d + a) as Int, first?)))
        };
        let mut uses = vec![Vec::new(); n];
        for (e, others) in &grid.changed {
            for &(a, c) in others {
                uses[a].push((*e, c));
            }
        }
        Ok(Layout {
            dimension: d,
            missing: with.iter().flat_map(of_node).collect(),
            columns: grid.displacements.iter().map(|&(node, a)| (number[node] * d + a) as Int).collect(),
            changed: grid.changed.clone(),
            nodes,
            rows,
            places,
            contacts,
            uses,
        })
    }

    /// Returns the orthonormal rigid motions of the displacements without shares of others, followed by zeros.
    pub(super) fn motions(&self, grid: &Grid) -> Vec<Vec<f64>> {
        let product = |a: &[f64], b: &[f64]| a.iter().zip(b).map(|(a, b)| a * b).sum::<f64>();
        let mut motions: Vec<Vec<f64>> = Vec::new();
        for mut u in grid.motions.iter().cloned() {
            for (e, others) in &self.changed {
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
                for u in &mut u {
                    *u /= size;
                }
                u.resize(self.places.len(), 0.0);
                motions.push(u);
            }
        }
        motions
    }

    /// Returns the contact nodes of `matrix`, eliminated.
    pub(super) fn nodes(&self, matrix: &SystemMatrix, oblique: bool) -> Vec<Eliminated> {
        let get = |row: Option<usize>, column: Option<usize>| match (row, column) {
            (Some(row), Some(column)) => matrix.get(row, column),
            _ => 0.0,
        };
        let block = |rows: [Option<usize>; 3], columns: [Option<usize>; 3]| {
            [0, 1, 2].map(|i| [0, 1, 2].map(|j| get(rows[i], columns[j])))
        };
        let local = |&ContactPlaces { own, forces }: &ContactPlaces| Local {
            b: block(own, forces),
            r: block(forces, own),
            d: block(forces, forces),
            directions: own.map(|dof| dof.is_some()),
            forces: forces.map(|place| place.is_some()),
            stiffness: own.map(|dof| get(dof, dof)).into_iter().fold(0.0, f64::max),
        };
        self.contacts.iter().map(|contact| local(contact).eliminated(oblique)).collect()
    }

    /// Returns the matrices that eliminate contact at these `nodes`. The ones on the diagonal of the ways to all
    /// unknowns and back are left out.
    pub(super) fn contact(&self, nodes: &[Eliminated]) -> Contact {
        let mut contact = Contact::default();
        for (e, others) in &self.changed {
            for &(a, c) in others {
                contact.to_all.push((self.places[*e], self.columns[a], c));
                contact.from_all.push((self.columns[a], self.places[*e], c));
            }
        }
        // A displacement is a share of those that contain it.
        let shares = |dof: usize| {
            let others = self.uses[dof].iter().map(|(e, c)| (self.places[*e], *c));
            std::iter::once((self.places[dof], 1.0)).chain(others)
        };
        let each = |m: &Small,
                    rows: [Option<usize>; 3],
                    columns: [Option<usize>; 3],
                    take: &mut dyn FnMut(usize, usize, f64)| {
            for (i, row) in rows.into_iter().enumerate() {
                for (j, column) in columns.into_iter().enumerate() {
                    if let (Some(row), Some(column), true) = (row, column, m[i][j] != 0.0) {
                        take(row, column, m[i][j]);
                    }
                }
            }
        };
        for (&ContactPlaces { own, forces }, node) in self.contacts.iter().zip(nodes) {
            let place = |at: usize| self.places[at];
            let column = |dof: usize| self.columns[dof];
            let push = |to: &mut Vec<Entry>, row: Int, column: Int, value: f64| to.push((row, column, value));
            each(&node.prescribed, own, forces, &mut |u, p, v| {
                shares(u).for_each(|(row, c)| push(&mut contact.held, row, place(p), c * v));
            });
            each(&node.given, forces, forces, &mut |p, q, v| push(&mut contact.held, place(p), place(q), v));
            each(&less_one(&node.free), own, own, &mut |u, w, v| {
                shares(u).for_each(|(row, c)| push(&mut contact.to_all, row, column(w), c * v));
            });
            each(&node.following, forces, own, &mut |p, w, v| push(&mut contact.to_all, place(p), column(w), v));
            each(&less_one(&node.swept), own, own, &mut |w, u, v| {
                shares(u).for_each(|(at, c)| push(&mut contact.from_all, column(w), at, c * v));
            });
            each(&node.reactions, forces, own, &mut |p, u, v| {
                shares(u).for_each(|(at, c)| push(&mut contact.reactions, place(p), at, c * v));
            });
            each(&node.added, own, own, &mut |w, x, v| push(&mut contact.added, column(w), column(x), v));
        }
        contact
    }

    /// Returns row and column of the entries of `matrix`, and their values: first those of the stiffness, unless that
    /// is `shared`, with a diagonal in the missing directions, then all others.
    pub(super) fn entries(&self, matrix: &SystemMatrix, shared: bool) -> ([[Vec<Int>; 2]; 2], [Vec<f64>; 2]) {
        let (mut places, mut values): ([[Vec<Int>; 2]; 2], [Vec<f64>; 2]) = Default::default();
        let mut push = |of: usize, row: Int, column: Int, value: f64| {
            places[of][0].push(row);
            places[of][1].push(column);
            values[of].push(value);
        };
        for (row, column, value) in matrix.rest().entries() {
            let is_stiffness = !shared && row.max(column) < self.columns.len();
            let (of, place) = if is_stiffness { (0, &self.columns) } else { (1, &self.places) };
            push(of, place[row], place[column], value);
        }
        for &(at, dof) in self.missing.iter().filter(|_| !shared) {
            push(0, at, at, Some(matrix.get(dof, dof)).filter(|k| *k > 0.0).unwrap_or(1.0));
        }
        (places, values)
    }
}

fn less_one(m: &Small) -> Small {
    [0, 1, 2].map(|i| [0, 1, 2].map(|j| m[i][j] - f64::from(u8::from(i == j))))
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
