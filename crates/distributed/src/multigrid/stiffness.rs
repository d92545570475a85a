//! The stiffness with contact eliminated, `K̂`: on all directions of all nodes, in the frames of the contact nodes.
//!
//! It has the pattern of `K`. Constrained directions, and those that supports have removed, have only a diagonal
//! entry. Forces that follow displacements are springs.

use super::block::{Block, Border};
use super::form::Form;
use super::grid::OnGrid;
use super::node::{Eliminated, Local};
use super::piece::State;
use super::rows::rows;
use super::shared::SharedStiffness;
use crate::expect_length;
use crate::petsc::Rows;
use crate::ranks::{Graph, partition};
use stickslip::algebra::Pattern;
use stickslip::algebra::linear::{Distributed, Grid, LinearError, SystemMatrix};

/// The places of all unknowns, for one pattern.
pub(super) struct BlockLayout {
    pub dimension: usize,
    /// The number of displacements of the matrix.
    pub displacements: usize,
    /// The node, among those with displacements, and the direction of each displacement.
    pub place: Vec<(usize, usize)>,
    /// The displacements of each of these nodes.
    pub own: Vec<[Option<usize>; 3]>,
    /// The contact of each of these nodes, if it has one.
    pub contact: Vec<Option<usize>>,
    /// The node of each contact among these, and the places of its forces.
    pub contacts: Vec<(usize, [Option<usize>; 3])>,
    /// The terms of `K̃ = Qᵀ K Q`: for each displacement those of `K`, with their shares.
    shares: Vec<Vec<(usize, f64)>>,
    /// The inverse relation of `shares`.
    uses: Vec<Vec<(usize, f64)>>,
    /// The columns of each node's block row, ascending; for a shared stiffness only those of contact nodes.
    columns: Vec<Vec<usize>>,
    /// The number of entries of `K̂`.
    entries: usize,
    /// The ranges of nodes of the ranks.
    ranks: Vec<usize>,
}

impl BlockLayout {
    /// Creates the layout for matrices with the pattern of `matrix`. If ranks share its stiffness, the nodes are
    /// numbered already.
    pub(super) fn new(
        grid: &Grid,
        matrix: &SystemMatrix,
        shared: Option<&SharedStiffness>,
    ) -> Result<Self, LinearError> {
        expect_length("columns of the matrix", matrix.pattern().rows(), matrix.order())?;
        grid.checked(matrix.order())?;
        let displacements = grid.displacements.len();
        if let Some(shared) = shared {
            expect_length("displacements of the shared stiffness", shared.order(), displacements)?;
            expect_length("nodes of the shared stiffness", shared.nodes(), grid.nodes)?;
            expect_length("changed displacements of a shared stiffness", 0, grid.changed.len())?;
        }
        let (mut node, mut known) = (vec![None; grid.nodes], 0);
        let mut own: Vec<[Option<usize>; 3]> = Vec::new();
        let mut place = Vec::with_capacity(displacements);
        for (dof, &(at, direction)) in grid.displacements.iter().enumerate() {
            let k = *node[at].get_or_insert_with(|| shared.and_then(|shared| shared.number(at)).unwrap_or(known));
            known = known.max(k + 1);
            own.resize(known, [None; 3]);
            own[k][direction] = Some(dof);
            place.push((k, direction));
        }
        let mut contact = vec![None; own.len()];
        let mut contacts = Vec::new();
        for (i, of) in grid.contacts.iter().enumerate() {
            let Some(k) = node[of.node] else {
                return Err(LinearError::Shape { what: "displacements of a contact node", expected: 1, found: 0 });
            };
            contact[k] = Some(i);
            contacts.push((k, of.forces));
        }
        let mut layout = BlockLayout {
            ranks: shared.map_or_else(|| vec![0, own.len()], |shared| shared.bounds().to_vec()),
            dimension: grid.dimension,
            displacements,
            place,
            own,
            contact,
            contacts,
            shares: Vec::new(),
            uses: Vec::new(),
            columns: Vec::new(),
            entries: 0,
        };
        if shared.is_none() {
            layout.change(grid);
        }
        let mut seen = vec![usize::MAX; layout.own.len()];
        for (k, own) in layout.own.iter().enumerate() {
            let mut columns = vec![k];
            seen[k] = k;
            // Only rows of contact nodes of a distributed stiffness are stored here.
            let here = shared.is_none() || layout.contact[k].is_some();
            for dof in own.iter().flatten().filter(|_| here) {
                layout.each_neighbour(*dof, matrix, |_, to| {
                    let (other, _) = layout.place[to];
                    if seen[other] != k {
                        seen[other] = k;
                        columns.push(other);
                    }
                });
            }
            columns.sort_unstable();
            layout.columns.push(if here { columns } else { Vec::new() });
        }
        let entries = layout.columns.iter().map(|columns| columns.len() * layout.dimension * layout.dimension).sum();
        layout.entries = shared.map_or(entries, Distributed::entries);
        Ok(layout)
    }

    /// Adds the displacements that contain shares of others.
    fn change(&mut self, grid: &Grid) {
        self.shares = (0..self.displacements).map(|dof| vec![(dof, 1.0)]).collect();
        self.uses = self.shares.clone();
        for (e, others) in &grid.changed {
            for &(a, c) in others {
                self.shares[a].push((*e, c));
                self.uses[*e].push((a, c));
            }
        }
    }

    /// Reorders the nodes by rank, with nearly as many nodes on each of the `ranks` and few couplings between them.
    ///
    /// # Errors
    /// If memory is short.
    pub(super) fn shared_among(self, ranks: usize) -> Result<Self, LinearError> {
        const STEP: &str = "dealing the nodes among ranks";
        if ranks == 1 {
            return Ok(self);
        }
        let rank = partition(STEP, Graph::new(STEP, self.columns.iter().map(|row| (1, row.iter().copied())))?, ranks)?;
        let mut order: Vec<usize> = (0..rank.len()).collect();
        order.sort_by_key(|&node| rank[node]);
        let bounds = (0..=ranks).map(|k| order.partition_point(|&node| rank[node] < k)).collect();
        let mut new = vec![0; order.len()];
        order.iter().enumerate().for_each(|(k, &node)| new[node] = k);
        let columns = order.iter().map(|&node| {
            let mut row: Vec<usize> = self.columns[node].iter().map(|&column| new[column]).collect();
            row.sort_unstable();
            row
        });
        Ok(BlockLayout {
            ranks: bounds,
            place: self.place.iter().map(|&(node, direction)| (new[node], direction)).collect(),
            own: order.iter().map(|&node| self.own[node]).collect(),
            contact: order.iter().map(|&node| self.contact[node]).collect(),
            contacts: self.contacts.iter().map(|&(node, forces)| (new[node], forces)).collect(),
            columns: columns.collect(),
            ..self
        })
    }

    /// Returns the ranges of rows of `K̂` of the ranks.
    pub(super) fn bounds(&self) -> Vec<usize> {
        self.ranks.iter().map(|node| node * self.dimension).collect()
    }

    /// Calls `take` with value and column of all terms of row `dof` of `K̃`. K is symmetric: its columns are its
    /// rows.
    fn each_neighbour(&self, dof: usize, matrix: &SystemMatrix, mut take: impl FnMut(f64, usize)) {
        let (pattern, values) = (matrix.pattern(), matrix.rest().values());
        let Some((shared, factor)) = matrix.distributed() else {
            for &(e, c) in &self.shares[dof] {
                let slots = pattern.column_starts()[e] as usize..pattern.column_starts()[e + 1] as usize;
                for (row, value) in pattern.row_indices()[slots.clone()].iter().zip(&values[slots]) {
                    for &(to, g) in self.uses.get(*row as usize).into_iter().flatten() {
                        take(c * g * value, to);
                    }
                }
            }
            return;
        };
        let near = shared.near();
        let slots =
            |pattern: &Pattern| pattern.column_starts()[dof] as usize..pattern.column_starts()[dof + 1] as usize;
        for slot in slots(near.pattern()) {
            take(factor * near.values()[slot], near.pattern().row_indices()[slot] as usize);
        }
        // The springs that pin unconstrained modes are stored outside it.
        for slot in slots(pattern).filter(|slot| pattern.row_indices()[*slot] as usize == dof) {
            take(values[slot], dof);
        }
    }

    /// Returns the data of `matrix` that ranks need for their rows of `K̂`, besides their shared stiffness.
    pub(super) fn state(&self, matrix: &SystemMatrix, nodes: &[Eliminated], form: Form) -> State {
        let (pattern, values) = (matrix.pattern(), matrix.rest().values());
        let spring = |dof: usize| Some((self.at(dof), values[pattern.slot(dof, dof)?])).filter(|(_, k)| *k != 0.0);
        State {
            factor: matrix.distributed().map_or(1.0, |(_, factor)| factor),
            form,
            springs: (0..self.displacements).filter_map(spring).collect(),
            contacts: self.contacts.iter().map(|(node, _)| *node).zip(nodes.iter().copied()).collect(),
        }
    }

    /// Returns the place of a displacement among all directions of all nodes.
    fn at(&self, dof: usize) -> usize {
        let (node, direction) = self.place[dof];
        node * self.dimension + direction
    }

    /// Returns the order of `K̂`: the number of all directions of all nodes.
    pub(super) fn order(&self) -> usize {
        self.own.len() * self.dimension
    }

    /// Returns the number of entries of `K̂`.
    pub(super) fn entries(&self) -> usize {
        self.entries
    }

    /// Returns the columns of the block row of `node`.
    pub(super) fn columns(&self, node: usize) -> &[usize] {
        &self.columns[node]
    }

    /// Returns the rows and columns of each contact node.
    fn locals(&self, matrix: &SystemMatrix) -> Vec<Local> {
        let get = |row: Option<usize>, column: Option<usize>| match (row, column) {
            (Some(row), Some(column)) => matrix.get(row, column),
            _ => 0.0,
        };
        let local = |&(node, forces): &(usize, [Option<usize>; 3])| {
            let own = self.own[node];
            let block = |rows: [Option<usize>; 3], columns: [Option<usize>; 3]| {
                [0, 1, 2].map(|i| [0, 1, 2].map(|j| get(rows[i], columns[j])))
            };
            let diagonal = own.map(|dof| get(dof, dof));
            Local {
                b: block(own, forces),
                r: block(forces, own),
                d: block(forces, forces),
                directions: own.map(|dof| dof.is_some()),
                forces: forces.map(|place| place.is_some()),
                stiffness: diagonal.into_iter().fold(0.0, f64::max),
            }
        };
        self.contacts.iter().map(local).collect()
    }

    /// Returns the eliminated contact nodes of `matrix`.
    pub(super) fn nodes(&self, matrix: &SystemMatrix, form: Form) -> Vec<Eliminated> {
        self.locals(matrix).iter().map(|local| local.eliminated(form)).collect()
    }

    /// Returns `K̂` of `matrix` with these contact nodes, and the rows of the contact nodes.
    ///
    /// # Errors
    /// If it has more entries than PETSc can count.
    pub(super) fn stiffness(
        &self,
        matrix: &SystemMatrix,
        nodes: &[Eliminated],
        form: Form,
    ) -> Result<(Rows, Vec<Border>), LinearError> {
        let d = self.dimension;
        let make = |at: &mut Vec<usize>, node: usize, columns: &mut [i32], values: &mut [f64]| {
            let mut rows = self.rows(node, matrix, at, nodes);
            let border = self.contact[node].map(|contact| (contact, rows.clone()));
            let missing = |column: usize| self.own[column].map(|dof| dof.is_none());
            self.block(node, at[node], nodes).eliminate(form, &mut rows, missing);
            let width = self.columns[node].len() * d;
            for (row, values) in rows.iter().zip(values.chunks_exact_mut(width)) {
                values.copy_from_slice(row);
            }
            for columns in columns.chunks_exact_mut(width) {
                let places = self.columns[node].iter().flat_map(|column| column * d..(column + 1) * d);
                columns.iter_mut().zip(places).for_each(|(to, place)| *to = place as i32);
            }
            border
        };
        let widths = self.columns.iter().map(Vec::len);
        let (rows, borders) = rows(d, form, widths, || vec![0; self.own.len()], make)?;
        let mut border = vec![Border::default(); self.contacts.len()];
        for (contact, rows) in borders {
            border[contact] = rows;
        }
        Ok((rows, border))
    }

    /// Returns the rows of the contact nodes alone, if `K̂` is reused or assembled by ranks.
    pub(super) fn border(&self, matrix: &SystemMatrix, nodes: &[Eliminated]) -> Vec<Border> {
        let mut at = vec![0; self.own.len()];
        self.contacts.iter().map(|&(node, _)| self.rows(node, matrix, &mut at, nodes)).collect()
    }

    /// Returns the block row of `node` of `K̃`, in all frames; its columns are left in `at`.
    fn rows(&self, node: usize, matrix: &SystemMatrix, at: &mut [usize], nodes: &[Eliminated]) -> Border {
        let d = self.dimension;
        self.columns[node].iter().enumerate().for_each(|(k, &column)| at[column] = k);
        let mut rows: Border = std::array::from_fn(|_| vec![0.0; self.columns[node].len() * d]);
        for (row, dof) in rows.iter_mut().zip(self.own[node]) {
            let Some(dof) = dof else { continue };
            self.each_neighbour(dof, matrix, |value, to| {
                let (other, direction) = self.place[to];
                row[at[other] * d + direction] += value;
            });
        }
        self.block(node, at[node], nodes).turn(&mut rows);
        rows
    }

    /// Returns the places of the block row of `node`, which is the column `own` itself.
    fn block<'a>(
        &'a self,
        node: usize,
        own: usize,
        nodes: &'a [Eliminated],
    ) -> Block<'a, impl Fn(usize) -> Option<&'a Eliminated>> {
        let contact = |column: usize| self.contact[column].map(|contact| &nodes[contact]);
        Block { dimension: self.dimension, columns: &self.columns[node], own, contact }
    }
}
