//! The local part of a shared stiffness: the rows of one rank's nodes, and the hierarchies built from them.
//!
//! Vectors are whole on rank 0, with all directions of the numbered nodes. For a product, each rank receives the part
//! in the columns of its rows: its own nodes and one layer of its neighbours'. The results of its rows are gathered.

mod job;
mod told;

use std::collections::HashMap;

use rayon::prelude::*;

use super::block::{Block, Border};
use super::node::Eliminated;
use super::numbering::Numbering;
use super::rows::rows;
use crate::petsc::{Rows, Share};
use crate::ranks::World;
pub(super) use job::Job;
use stickslip::algebra::linear::LinearError;
use stickslip::algebra::{NodeRows, Symmetric};
pub(super) use told::State;

/// The rows of one rank.
pub(crate) struct Piece {
    dimension: usize,
    /// The ranges of nodes of the ranks.
    bounds: Vec<usize>,
    /// The nodes in the columns of the rows, ascending; `missing` are the directions that supports have removed from
    /// each.
    nodes: Vec<usize>,
    missing: Vec<[bool; 3]>,
    /// The ranges of the vector parts that the ranks need.
    needs: Vec<usize>,
    /// The ranges of the columns of each block row, as places among `nodes`.
    starts: Vec<usize>,
    columns: Vec<u32>,
    /// The values, row by row.
    values: Vec<f64>,
    hierarchies: HashMap<i64, Share>,
}

/// Returns data that are equal on all ranks if their bodies are the same.
fn head(body: &dyn NodeRows) -> [i64; 4] {
    [body.nodes() as i64, body.order() as i64, body.dimension() as i64, body.fingerprint() as i64]
}

impl Piece {
    /// Assembles the rows of a rank other than 0; see [`Piece::assembled`].
    pub(crate) fn helping(world: &World, body: Option<&dyn NodeRows>) -> Option<Self> {
        Self::assembled(world, body, None)
    }

    /// Assembles the rows of this rank from its own `body`, with the `numbering` of rank 0. All ranks must call it.
    /// Returns `None` if a rank cannot assemble its rows, or has another body than rank 0.
    pub(super) fn assembled(world: &World, body: Option<&dyn NodeRows>, numbering: Option<&Numbering>) -> Option<Self> {
        let mut told = body.filter(|_| numbering.is_some()).map_or([0; 4], head);
        world.tell(&mut told);
        let body = body.filter(|body| head(*body) == told);
        let (true, Some(body)) = (world.all(body.is_some()), body) else { return None };
        let numbering = Numbering::told(numbering, body.nodes(), world);
        let own = numbering.bounds[world.rank()]..numbering.bounds[world.rank() + 1];
        let is_own = |node: usize| numbering.number(node).is_some_and(|number| own.contains(&number));
        let rows = body.rows(&(0..body.nodes()).map(is_own).collect::<Vec<bool>>());
        let (true, Some(rows)) = (world.all(rows.is_some()), rows) else { return None };
        let mut piece = Piece::of(body, &numbering, own, &rows);
        piece.needs = world.bounds(piece.nodes.len() * piece.dimension);
        Some(piece)
    }

    fn of(body: &dyn NodeRows, numbering: &Numbering, own: std::ops::Range<usize>, rows: &Symmetric) -> Self {
        let d = body.dimension();
        let mut beside: Vec<Vec<u32>> = own.clone().map(|number| vec![number as u32]).collect();
        body.each_cell(&mut |cell| {
            let numbers = || cell.iter().filter_map(|node| numbering.number(*node));
            for number in numbers().filter(|number| own.contains(number)) {
                beside[number - own.start].extend(numbers().map(|other| other as u32));
            }
        });
        for beside in &mut beside {
            beside.sort_unstable();
            beside.dedup();
        }
        let mut nodes: Vec<usize> = beside.iter().flatten().map(|number| *number as usize).collect();
        nodes.sort_unstable();
        nodes.dedup();
        let mut starts = vec![0];
        let mut columns = Vec::with_capacity(beside.iter().map(Vec::len).sum());
        for row in &beside {
            columns.extend(row.iter().map(|number| nodes.partition_point(|node| *node < *number as usize) as u32));
            starts.push(columns.len());
        }
        let mut missing = vec![[true; 3]; nodes.len()];
        let mut place = vec![(0_u32, 0_u8); body.order()];
        for (node, number) in (0..body.nodes()).filter_map(|node| Some((node, numbering.number(node)?))) {
            let places = body.places(node);
            if let Ok(k) = nodes.binary_search(&number) {
                missing[k] = places.map(|dof| dof.is_none());
            }
            for (direction, dof) in places.into_iter().enumerate() {
                if let Some(place) = dof.and_then(|dof| place.get_mut(dof)) {
                    *place = (number as u32, direction as u8);
                }
            }
        }
        let mut values = vec![0.0; columns.len() * d * d];
        let mut add = |row: usize, column: usize, value: f64| {
            let ((node, a), (other, b)) = (place[row], place[column]);
            let Some(k) = (node as usize).checked_sub(own.start).filter(|k| *k < own.len()) else { return };
            if let Ok(at) = beside[k].binary_search(&other) {
                values[starts[k] * d * d + (a as usize * beside[k].len() + at) * d + b as usize] += value;
            }
        };
        for (row, column, value) in rows.lower().entries() {
            add(row, column, value);
            if row != column {
                add(column, row, value);
            }
        }
        let (bounds, needs, hierarchies) = (numbering.bounds.clone(), Vec::new(), HashMap::new());
        Piece { dimension: d, bounds, nodes, missing, needs, starts, columns, values, hierarchies }
    }

    /// Returns the ranges of the rows of the ranks.
    fn row_bounds(&self) -> Vec<usize> {
        self.bounds.iter().map(|bound| bound * self.dimension).collect()
    }

    /// Returns the first node of this rank.
    fn first(&self, world: &World) -> usize {
        self.bounds[world.rank()]
    }

    /// Computes a result for each row from the columns and values of its blocks.
    fn of_rows<T: Send>(&self, of: impl Fn(&[u32], &[f64]) -> T + Sync) -> Vec<T> {
        let Piece { dimension, starts, columns, values, .. } = self;
        let d = *dimension;
        let row = |row: usize| {
            let (start, end) = (starts[row / d], starts[row / d + 1]);
            let first = start * d * d + row % d * (end - start) * d;
            of(&columns[start..end], &values[first..first + (end - start) * d])
        };
        (0..(starts.len() - 1) * d).into_par_iter().with_min_len(1024).map(row).collect()
    }

    /// Computes `Σ term(K_ij, x_j)` in each row `i`, for the local part `x` of a vector.
    fn sums(&self, x: &[f64], term: impl Fn(f64, f64) -> f64 + Sync) -> Vec<f64> {
        match self.dimension {
            2 => self.sums_in::<2>(x, term),
            _ => self.sums_in::<3>(x, term),
        }
    }

    /// Computes these sums in `D` dimensions.
    fn sums_in<const D: usize>(&self, x: &[f64], term: impl Fn(f64, f64) -> f64 + Sync) -> Vec<f64> {
        let x = x.as_chunks::<D>().0;
        self.of_rows(|columns, values| {
            let mut sums = [0.0; D];
            for (values, column) in values.as_chunks::<D>().0.iter().zip(columns) {
                let x = &x[*column as usize];
                for c in 0..D {
                    sums[c] += term(values[c], x[c]);
                }
            }
            sums.iter().sum()
        })
    }

    /// Returns the largest size in each row, and its diagonal entry.
    fn norms(&self, first: usize) -> [Vec<f64>; 2] {
        let norm = |_: &[u32], values: &[f64]| values.iter().fold(0.0_f64, |m, value| m.max(value.abs()));
        let d = self.dimension;
        let diagonal = (0..(self.starts.len() - 1) * d).map(|row| {
            let (own, a) = (row / d, row % d);
            let columns = &self.columns[self.starts[own]..self.starts[own + 1]];
            let at = columns.iter().position(|column| self.nodes[*column as usize] == first + own).unwrap_or(0);
            self.values[self.starts[own] * d * d + (a * columns.len() + at) * d + a]
        });
        [self.of_rows(norm), diagonal.collect()]
    }

    /// Returns row, column and value of all entries on and below the diagonal.
    fn lower(&self, first: usize) -> Vec<f64> {
        let d = self.dimension;
        let mut entries = Vec::new();
        for own in 0..self.starts.len() - 1 {
            let columns = &self.columns[self.starts[own]..self.starts[own + 1]];
            let values = &self.values[self.starts[own] * d * d..self.starts[own + 1] * d * d];
            for (a, values) in values.chunks_exact(columns.len() * d).enumerate() {
                let row = (first + own) * d + a;
                let places = columns.iter().flat_map(|column| {
                    let node = self.nodes[*column as usize];
                    (0..d).map(move |b| node * d + b)
                });
                let lower = places.zip(values).filter(|(column, value)| *column <= row && **value != 0.0);
                entries.extend(lower.flat_map(|(column, value)| [row as f64, column as f64, *value]));
            }
        }
        entries
    }

    /// Returns the rows of `K̂` of this rank.
    fn eliminated(&self, first: usize, state: &State) -> Result<Rows, LinearError> {
        // Hierarchies are not shared with other threads.
        let Piece { dimension, nodes, missing, starts, columns: beside, values: own_values, .. } = self;
        let d = *dimension;
        let State { factor, form, springs, contacts } = state;
        let contact_of: HashMap<usize, usize> = contacts.iter().enumerate().map(|(k, (node, _))| (*node, k)).collect();
        let contact: Vec<Option<usize>> = nodes.iter().map(|node| contact_of.get(node).copied()).collect();
        let springs: HashMap<usize, f64> = springs.iter().copied().collect();
        let make = |(): &mut (), own: usize, places: &mut [i32], values: &mut [f64]| {
            let range = starts[own]..starts[own + 1];
            let columns: Vec<usize> = beside[range.clone()].iter().map(|column| *column as usize).collect();
            let width = columns.len() * d;
            let here = &own_values[range.start * d * d..range.end * d * d];
            let mut block: Border = std::array::from_fn(|a| match here.get(a * width..(a + 1) * width) {
                Some(values) => values.iter().map(|value| factor * value).collect(),
                None => vec![0.0; width],
            });
            let at = columns.iter().position(|column| nodes[*column] == first + own).unwrap_or(0);
            for (a, row) in block.iter_mut().enumerate().take(d) {
                row[at * d + a] += springs.get(&((first + own) * d + a)).copied().unwrap_or(0.0);
            }
            let of = |column: usize| -> Option<&Eliminated> { contact[column].map(|k| &contacts[k].1) };
            let place = Block { dimension: d, columns: &columns, own: at, contact: of };
            place.turn(&mut block);
            place.eliminate(*form, &mut block, |column| missing[column]);
            for ((row, places), values) in
                block.iter().zip(places.chunks_exact_mut(width)).zip(values.chunks_exact_mut(width))
            {
                values.copy_from_slice(row);
                let all = columns.iter().flat_map(|column| (0..d).map(move |b| nodes[*column] * d + b));
                places.iter_mut().zip(all).for_each(|(to, place)| *to = place as i32);
            }
            None::<()>
        };
        let widths = starts.windows(2).map(|pair| pair[1] - pair[0]);
        Ok(rows(d, *form, widths, || (), make)?.0)
    }
}
