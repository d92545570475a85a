//! The rows of one rank of a shared stiffness, assembled from the elements of its own nodes. For a product each rank
//! receives the vector at the columns of its rows: its own nodes and one layer of its neighbours'.

mod numbering;

use std::sync::Arc;

use rayon::prelude::*;
use stickslip::algebra::linear::LinearError;
use stickslip::algebra::{DoubleDouble, NodeRows, Symmetric};

use crate::exchange::Exchange;
use crate::part::Job;
use crate::petsc::{Int, Matrix, Scatter, Vector, int};
use crate::ranks::shim::{World, tell};
pub(crate) use numbering::Numbering;

/// The rows of one rank, in blocks of a node.
pub(crate) struct Rows {
    pub dimension: usize,
    pub numbering: Arc<Numbering>,
    /// The first node of this rank.
    first: usize,
    /// The nodes in the columns of the rows, ascending; `missing` are the directions that supports have removed from
    /// each.
    nodes: Vec<usize>,
    missing: Vec<[bool; 3]>,
    /// The ranges of the columns of each block row, as places among `nodes`.
    starts: Vec<usize>,
    columns: Vec<u32>,
    /// The values, row by row.
    values: Vec<f64>,
    exchange: Exchange,
    /// A vector at the columns, and its way from the parts.
    near: Vector,
    to_near: Scatter,
}

/// Returns data that are equal on all ranks if their bodies are the same.
fn head(body: &dyn NodeRows) -> [i64; 4] {
    [body.nodes() as i64, body.order() as i64, body.dimension() as i64, body.fingerprint() as i64]
}

impl Rows {
    /// Assembles the rows of this rank from its own `body`. Returns `None` on all ranks if one cannot assemble its rows, or
    /// has another body than rank 0.
    pub(crate) fn assembled(world: &World, body: Option<&dyn NodeRows>) -> Result<Option<Self>, LinearError> {
        let mut told = body.map_or([0; 4], head);
        tell(&mut told);
        let body = body.filter(|body| head(*body) == told);
        let (true, Some(body)) = (world.all(body.is_some()), body) else { return Ok(None) };
        let numbering = Numbering::new(world, body)?;
        let own = numbering.bounds[world.rank()]..numbering.bounds[world.rank() + 1];
        let is_own = |node: usize| numbering.number(node).is_some_and(|number| own.contains(&number));
        let rows = body.rows(&(0..body.nodes()).map(is_own).collect::<Vec<bool>>());
        let (true, Some(rows)) = (world.all(rows.is_some()), rows) else { return Ok(None) };
        Self::of(world, body, numbering, own, &rows).map(Some)
    }

    fn of(
        world: &World,
        body: &dyn NodeRows,
        numbering: Numbering,
        own: std::ops::Range<usize>,
        rows: &Symmetric,
    ) -> Result<Self, LinearError> {
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
        int(numbering.bounds[world.size()] * d)?;
        let leads = world.rank() == 0;
        let places = place.iter().filter(|_| leads).map(|(node, a)| (*node as usize * d + usize::from(*a)) as Int);
        let exchange = Exchange::new(own.len() * d, &places.collect::<Vec<_>>())?;
        let near = Vector::new(nodes.len() * d)?;
        let at: Vec<Int> = nodes.iter().flat_map(|node| node * d..(node + 1) * d).map(|at| at as Int).collect();
        let to_near = Scatter::new(&exchange.own, &at, &near, &near.places()?.collect::<Vec<_>>())?;
        let (first, numbering) = (own.start, Arc::new(numbering));
        Ok(Rows { dimension: d, numbering, first, nodes, missing, starts, columns, values, exchange, near, to_near })
    }

    /// Computes a result for each row from the columns and values of its blocks.
    fn of_rows<T: Send>(&self, of: impl Fn(&[u32], &[f64]) -> T + Sync) -> Vec<T> {
        // PETSc's objects are not shared with other threads.
        let Rows { dimension, starts, columns, values, .. } = self;
        let d = *dimension;
        let row = |row: usize| {
            let (start, end) = (starts[row / d], starts[row / d + 1]);
            let first = start * d * d + row % d * (end - start) * d;
            of(&columns[start..end], &values[first..first + (end - start) * d])
        };
        (0..(starts.len() - 1) * d).into_par_iter().with_min_len(1024).map(row).collect()
    }

    /// Computes `Σ term(K_ij, x_j)` in each row `i`, for a vector at the columns.
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

    /// Collects the largest size in each row, and the diagonal. Returns the number of entries on all ranks.
    pub(crate) fn norms(&mut self, world: &World, to: [&mut [f64]; 2]) -> Result<usize, LinearError> {
        let norms = self.of_rows(|_, values| values.iter().fold(0.0_f64, |m, value| m.max(value.abs())));
        let d = self.dimension;
        let diagonal: Vec<f64> = (0..(self.starts.len() - 1) * d).map(|row| self.diagonal(row / d, row % d)).collect();
        let [all_norms, all_diagonal] = to;
        self.exchange.collect_from(&norms, all_norms)?;
        self.exchange.collect_from(&diagonal, all_diagonal)?;
        Ok(world.of_each([self.values.len() as f64]).into_iter().map(|[count]| count as usize).sum())
    }

    fn diagonal(&self, own: usize, a: usize) -> f64 {
        let (d, columns) = (self.dimension, &self.columns[self.starts[own]..self.starts[own + 1]]);
        let at = columns.iter().position(|column| self.nodes[*column as usize] == self.first + own).unwrap_or(0);
        self.values[self.starts[own] * d * d + (a * columns.len() + at) * d + a]
    }

    /// Computes `K x` and, if the `job` says so, `|K| |x|`, or `K (x + rest)` in twice the working precision.
    pub(crate) fn products(
        &mut self,
        job: Job,
        [x, rest]: [&[f64]; 2],
        [y, more]: [&mut [f64]; 2],
    ) -> Result<(), LinearError> {
        let x = self.near(x)?;
        let results = if job == Job::Beyond {
            let (d, rest) = (self.dimension, self.near(rest)?);
            let sums = self.of_rows(|columns, values| {
                let mut sum = DoubleDouble::default();
                for (values, column) in values.chunks_exact(d).zip(columns) {
                    for (value, at) in values.iter().zip(*column as usize * d..) {
                        sum.add_product(*value, x[at]);
                        sum.add(value * rest[at]);
                    }
                }
                sum.parts()
            });
            [0, 1].map(|k| sums.iter().map(|parts| parts[k]).collect())
        } else {
            let sizes = |value: f64, x: f64| (value * x).abs();
            let sizes = if job == Job::Products { self.sums(&x, sizes) } else { Vec::new() };
            [self.sums(&x, |value, x| value * x), sizes]
        };
        self.exchange.collect_from(&results[0], y)?;
        if job == Job::Product { Ok(()) } else { self.exchange.collect_from(&results[1], more) }
    }

    /// Returns a vector of rank 0 at the columns of this rank.
    fn near(&mut self, x: &[f64]) -> Result<Vec<f64>, LinearError> {
        self.exchange.deal(x)?;
        self.to_near.forward(&self.exchange.own, &mut self.near)?;
        self.near.with(|near| near.to_vec())
    }

    /// Gathers row, column and value of all entries on and below the diagonal.
    pub(crate) fn lower(&self, world: &World) -> Result<Vec<f64>, LinearError> {
        let d = self.dimension;
        let mut entries = Vec::new();
        for own in 0..self.starts.len() - 1 {
            let columns = &self.columns[self.starts[own]..self.starts[own + 1]];
            let values = &self.values[self.starts[own] * d * d..self.starts[own + 1] * d * d];
            for (a, values) in values.chunks_exact(columns.len() * d).enumerate() {
                let row = (self.first + own) * d + a;
                let places = columns.iter().flat_map(|column| {
                    let node = self.nodes[*column as usize];
                    (0..d).map(move |b| node * d + b)
                });
                let lower = places.zip(values).filter(|(column, value)| *column <= row && **value != 0.0);
                entries.extend(lower.flat_map(|(column, value)| [row as f64, column as f64, *value]));
            }
        }
        world.collect(&entries)
    }

    /// Creates a matrix for these rows, followed by `forces` rows of contact on this rank.
    pub(crate) fn room(&self, forces: usize) -> Result<Matrix, LinearError> {
        let (d, last) = (self.dimension, self.first + self.starts.len() - 1);
        let (mut own, mut beyond) = (Vec::new(), Vec::new());
        for ends in self.starts.windows(2) {
            let columns = &self.columns[ends[0]..ends[1]];
            let is_here = |column: &&u32| (self.first..last).contains(&self.nodes[**column as usize]);
            let here = columns.iter().filter(is_here).count();
            // Three forces at the node, at most.
            own.extend(std::iter::repeat_n((here * d + 3) as Int, d));
            beyond.extend(std::iter::repeat_n(((columns.len() - here) * d) as Int, d));
        }
        own.extend(std::iter::repeat_n((d + 3) as Int, forces));
        beyond.resize(own.len(), 0);
        Matrix::with_room(&own, &beyond)
    }

    /// Adds `factor` times these rows to a `matrix` in which the rows of each rank begin at `starts`. Directions that
    /// supports have removed get a diagonal entry.
    pub(crate) fn add_to(&self, matrix: &mut Matrix, factor: f64, starts: &[usize]) -> Result<(), LinearError> {
        let (d, bounds) = (self.dimension, &self.numbering.bounds);
        let place = |node: usize| {
            let rank = bounds[1..].partition_point(|end| *end <= node);
            (starts[rank] + (node - bounds[rank]) * d) as Int
        };
        let places: Vec<Int> = self.nodes.iter().map(|node| place(*node)).collect();
        for own in 0..self.starts.len() - 1 {
            let blocks = self.starts[own]..self.starts[own + 1];
            let first = place(self.first + own);
            let rows: Vec<Int> = (first..).take(d).collect();
            let begins = self.columns[blocks.clone()].iter().map(|column| places[*column as usize]);
            let columns: Vec<Int> = begins.flat_map(|begin| (begin..).take(d)).collect();
            let values = self.values[blocks.start * d * d..blocks.end * d * d].iter().map(|value| factor * value);
            matrix.add(&rows, &columns, &values.collect::<Vec<_>>())?;
            let largest = (0..d).map(|a| self.diagonal(own, a)).fold(0.0, f64::max);
            let k = if largest > 0.0 { factor * largest } else { 1.0 };
            if let Ok(at) = self.nodes.binary_search(&(self.first + own)) {
                for a in (0..d).filter(|a| self.missing[at][*a]) {
                    matrix.add(&[rows[a]], &[rows[a]], &[k])?;
                }
            }
        }
        Ok(())
    }
}
