//! The stiffness with contact eliminated, `K̂`: on all directions of all nodes, in the frames of the contact nodes.
//!
//! It has the pattern of `K`. Held directions are rows of the diagonal, and so are those that supports have taken; springs stand where
//! forces follow displacements.

use std::ops::Range;

use rayon::prelude::*;

use super::form::Form;
use super::grid::Grid;
use super::node::{Eliminated, Local};
use super::small::Small;
use crate::linear::LinearError;
use crate::linear::error::expect_length;
use crate::linear::petsc::Rows;
use crate::linear::ranks::{Graph, partition};
use crate::sparse::Pattern;

/// Where everything is, for one pattern.
pub(super) struct Layout {
    pub dimension: usize,
    /// Displacements of the matrix.
    pub displacements: usize,
    /// The node, among those that have displacements, and the direction of each.
    pub place: Vec<(usize, usize)>,
    /// The displacements of each of these nodes.
    pub own: Vec<[Option<usize>; 3]>,
    /// The contact of each, if it has one.
    pub contact: Vec<Option<usize>>,
    /// For each contact its node among these, and the places of its forces.
    pub contacts: Vec<(usize, [Option<usize>; 3])>,
    /// What `K̃ = Qᵀ K Q` takes from `K`: for each displacement those of `K`, with their shares.
    shares: Vec<Vec<(usize, f64)>>,
    /// And the other way.
    uses: Vec<Vec<(usize, f64)>>,
    /// The columns of each node's block row, ascending.
    columns: Vec<Vec<usize>>,
    /// The nodes of each rank are between these.
    ranks: Vec<usize>,
}

/// Rows of so many nodes are made together by one thread.
const TOGETHER: usize = 512;

/// The rows of a contact node in the stiffness, in all frames, before anything is held: as long as the block row, for each direction.
pub(super) type Border = [Vec<f64>; 3];

impl Layout {
    pub(super) fn new(grid: &Grid, pattern: &Pattern) -> Result<Self, LinearError> {
        expect_length("columns of the matrix", pattern.rows(), pattern.columns())?;
        grid.checked(pattern.columns())?;
        let displacements = grid.displacements.len();
        let mut node = vec![None; grid.nodes];
        let mut own: Vec<[Option<usize>; 3]> = Vec::new();
        let mut place = Vec::with_capacity(displacements);
        for (dof, &(at, direction)) in grid.displacements.iter().enumerate() {
            let k = *node[at].get_or_insert(own.len());
            if k == own.len() {
                own.push([None; 3]);
            }
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
        let mut shares: Vec<Vec<(usize, f64)>> = (0..displacements).map(|dof| vec![(dof, 1.0)]).collect();
        let mut uses = shares.clone();
        for (e, others) in &grid.changed {
            for &(a, c) in others {
                shares[a].push((*e, c));
                uses[*e].push((a, c));
            }
        }
        let mut layout = Layout {
            ranks: vec![0, own.len()],
            dimension: grid.dimension,
            displacements,
            place,
            own,
            contact,
            contacts,
            shares,
            uses,
            columns: Vec::new(),
        };
        let mut seen = vec![usize::MAX; layout.own.len()];
        for (k, own) in layout.own.iter().enumerate() {
            let mut columns = vec![k];
            seen[k] = k;
            for dof in own.iter().flatten() {
                layout.each_neighbour(*dof, pattern, |_, _, to| {
                    let (other, _) = layout.place[to];
                    if seen[other] != k {
                        seen[other] = k;
                        columns.push(other);
                    }
                });
            }
            columns.sort_unstable();
            layout.columns.push(columns);
        }
        let entries: usize =
            layout.columns.iter().map(|columns| columns.len() * layout.dimension * layout.dimension).sum();
        if i32::try_from(entries).is_err() {
            return Err(LinearError::OutOfMemory { step: "the multigrid hierarchy, whose indices have 32 bits" });
        }
        Ok(layout)
    }

    /// The same with the nodes of each of so many `ranks` one after the other, nearly as many on each, with few couplings in between.
    ///
    /// # Errors
    /// When memory is short.
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
        Ok(Layout {
            ranks: bounds,
            place: self.place.iter().map(|&(node, direction)| (new[node], direction)).collect(),
            own: order.iter().map(|&node| self.own[node]).collect(),
            contact: order.iter().map(|&node| self.contact[node]).collect(),
            contacts: self.contacts.iter().map(|&(node, forces)| (new[node], forces)).collect(),
            columns: columns.collect(),
            ..self
        })
    }

    /// The rows of `K̂` of each rank are between these.
    pub(super) fn bounds(&self) -> Vec<usize> {
        self.ranks.iter().map(|node| node * self.dimension).collect()
    }

    /// Calls with slot of `K`, factor and column for all that row `dof` of `K̃` is made of.
    fn each_neighbour(&self, dof: usize, pattern: &Pattern, mut take: impl FnMut(usize, f64, usize)) {
        for &(e, c) in &self.shares[dof] {
            // K is symmetric: its columns are its rows.
            for slot in pattern.column_starts()[e] as usize..pattern.column_starts()[e + 1] as usize {
                if let Some(uses) = self.uses.get(pattern.row_indices()[slot] as usize) {
                    for &(to, g) in uses {
                        take(slot, c * g, to);
                    }
                }
            }
        }
    }

    /// All directions of all nodes, which `K̂` is on.
    pub(super) fn order(&self) -> usize {
        self.own.len() * self.dimension
    }

    /// Entries of `K̂`.
    pub(super) fn entries(&self) -> usize {
        self.columns.iter().map(|columns| columns.len() * self.dimension * self.dimension).sum()
    }

    /// The columns of the block row of `node`.
    pub(super) fn columns(&self, node: usize) -> &[usize] {
        &self.columns[node]
    }

    /// The rows and columns of each contact node in the matrix with `values`.
    fn locals(&self, pattern: &Pattern, values: &[f64]) -> Vec<Local> {
        let get = |row: Option<usize>, column: Option<usize>| match (row, column) {
            (Some(row), Some(column)) => pattern.slot(row, column).map_or(0.0, |slot| values[slot]),
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

    /// The contact nodes of the matrix with `values`.
    pub(super) fn nodes(&self, pattern: &Pattern, values: &[f64], form: Form) -> Vec<Eliminated> {
        self.locals(pattern, values).iter().map(|local| local.eliminated(form)).collect()
    }

    /// `K̂` of the matrix with `values` and these contact nodes, and their rows beside.
    pub(super) fn stiffness(
        &self,
        pattern: &Pattern,
        values: &[f64],
        nodes: &[Eliminated],
        form: Form,
    ) -> (Rows, Vec<Border>) {
        let (d, entries) = (self.dimension, self.entries());
        let mut starts = vec![0];
        for columns in &self.columns {
            for _ in 0..d {
                starts.push(starts[starts.len() - 1] + (columns.len() * d) as i32);
            }
        }
        let mut rows = Rows {
            starts,
            columns: vec![0; entries],
            values: vec![0.0; entries],
            block: d,
            symmetric: form == Form::Symmetric,
        };
        let mut pieces = Vec::new();
        let (mut columns_left, mut values_left) = (&mut rows.columns[..], &mut rows.values[..]);
        for first in (0..self.own.len()).step_by(TOGETHER) {
            let nodes = first..self.own.len().min(first + TOGETHER);
            let length = (rows.starts[nodes.end * d] - rows.starts[first * d]) as usize;
            let (columns, values);
            (columns, columns_left) = columns_left.split_at_mut(length);
            (values, values_left) = values_left.split_at_mut(length);
            pieces.push((nodes, columns, values));
        }
        let write = |at: &mut Vec<usize>, (piece, columns, to): (Range<usize>, &mut [i32], &mut [f64])| {
            let (mut next, mut border) = (0, Vec::new());
            for node in piece {
                let mut block = self.rows(node, pattern, values, at, nodes);
                if let Some(contact) = self.contact[node] {
                    border.push((contact, block.clone()));
                    nodes[contact].take_friction(form, &mut block, at[node] * d, d);
                }
                self.hold(node, at[node], &mut block, nodes);
                for row in block.into_iter().take(d) {
                    let places = self.columns[node].iter().flat_map(|column| column * d..(column + 1) * d);
                    columns[next..].iter_mut().zip(places).for_each(|(to, place)| *to = place as i32);
                    to[next..next + row.len()].copy_from_slice(&row);
                    next += row.len();
                }
            }
            border
        };
        let borders: Vec<_> = pieces.into_par_iter().map_init(|| vec![0; self.own.len()], write).collect();
        let mut border = vec![Border::default(); self.contacts.len()];
        for (contact, rows) in borders.into_iter().flatten() {
            border[contact] = rows;
        }
        (rows, border)
    }

    /// The rows of the contact nodes alone, where another matrix stands for `K̂`.
    pub(super) fn border(&self, pattern: &Pattern, values: &[f64], nodes: &[Eliminated]) -> Vec<Border> {
        let mut at = vec![0; self.own.len()];
        self.contacts.iter().map(|&(node, _)| self.rows(node, pattern, values, &mut at, nodes)).collect()
    }

    /// The block row of `node` of `K̃`, in all frames; its columns are left in `at`.
    fn rows(&self, node: usize, pattern: &Pattern, values: &[f64], at: &mut [usize], nodes: &[Eliminated]) -> Border {
        let d = self.dimension;
        self.columns[node].iter().enumerate().for_each(|(k, &column)| at[column] = k);
        let mut rows: Border = std::array::from_fn(|_| vec![0.0; self.columns[node].len() * d]);
        for (row, dof) in rows.iter_mut().zip(self.own[node]) {
            let Some(dof) = dof else { continue };
            self.each_neighbour(dof, pattern, |slot, factor, to| {
                let (other, direction) = self.place[to];
                row[at[other] * d + direction] += factor * values[slot];
            });
        }
        for (k, &column) in self.columns[node].iter().enumerate() {
            let Some(contact) = self.contact[column] else { continue };
            for row in &mut rows {
                let block = &mut row[k * d..(k + 1) * d];
                let mut turned = [0.0; 3];
                turned[..d].copy_from_slice(block);
                block.copy_from_slice(&nodes[contact].in_frame(turned)[..d]);
            }
        }
        if let Some(contact) = self.contact[node] {
            for k in 0..self.columns[node].len() * d {
                let turned = nodes[contact].in_frame([0, 1, 2].map(|i| rows[i][k]));
                rows.iter_mut().zip(turned).for_each(|(row, turned)| row[k] = turned);
            }
        }
        rows
    }

    /// Empties rows and columns of directions that are not solved for, but for the diagonal.
    fn hold(&self, node: usize, own: usize, rows: &mut Border, nodes: &[Eliminated]) {
        let d = self.dimension;
        let gone = |node: usize| match self.contact[node] {
            Some(contact) => nodes[contact].gone(),
            None => self.own[node].map(|dof| dof.is_none()),
        };
        let largest = (0..d).map(|a| rows[a][own * d + a]).fold(0.0, f64::max);
        let own_gone = gone(node);
        for (k, &column) in self.columns[node].iter().enumerate() {
            let column_gone = gone(column);
            for a in 0..d {
                for b in (0..d).filter(|&b| own_gone[a] || column_gone[b]) {
                    let diagonal = column == node && a == b;
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
    /// Adds the springs to the rows of this node, whose own block begins at `own`, and takes from the free ones what the reactions
    /// in the held ones bring into them.
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
