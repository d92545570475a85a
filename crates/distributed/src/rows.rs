//! The rows of a shared stiffness, which each rank assembles from the elements of its own nodes.

mod numbering;

use std::sync::Arc;

use stickslip::algebra::linear::LinearError;
use stickslip::algebra::{DoubleDouble, NodeRows};

use crate::exchange::Exchange;
use crate::job::Product;
use crate::petsc::{Int, Matrix, Scatter, Vector, int};
use crate::ranks::shim::{World, broadcast};
pub(crate) use numbering::Numbering;

/// The rows of one rank, in blocks of a node. In a direction that supports have removed from a node they have the
/// node's largest entry on the diagonal, and no other.
pub(crate) struct Rows {
    pub numbering: Arc<Numbering>,
    pub matrix: Arc<Matrix>,
    exchange: Exchange,
    result: Vector,
    /// A vector that this rank has whole, and the way to it.
    to_all: (Scatter, Vector),
}

/// Returns data that are equal on all ranks if their bodies are the same.
fn head(body: &dyn NodeRows) -> [i64; 4] {
    [body.nodes() as i64, body.order() as i64, body.dimension() as i64, body.fingerprint() as i64]
}

impl Rows {
    /// Assembles the rows of this rank from its own `body`. Returns `None` on all ranks if one cannot assemble its
    /// rows, or has another body than rank 0.
    pub(crate) fn assembled(world: &World, body: Option<&dyn NodeRows>) -> Result<Option<Self>, LinearError> {
        let mut agreed = body.map_or([0; 4], head);
        broadcast(&mut agreed);
        let body = body.filter(|body| head(*body) == agreed);
        let (true, Some(body)) = (world.all(body.is_some()), body) else { return Ok(None) };
        let numbering = Numbering::new(world, body)?;
        let d = body.dimension();
        int(numbering.bounds[world.size()] * d)?;
        let own = numbering.bounds[world.rank()]..numbering.bounds[world.rank() + 1];
        let is_own = |node: usize| numbering.number(node).is_some_and(|number| own.contains(&number));
        let rows = body.rows(&(0..body.nodes()).map(is_own).collect::<Vec<bool>>());
        let (true, Some(rows)) = (world.all(rows.is_some()), rows) else { return Ok(None) };
        // Node and direction of each displacement.
        let mut place = vec![(0, 0); body.order()];
        for (node, number) in (0..body.nodes()).filter_map(|node| Some((node, numbering.number(node)?))) {
            for (direction, dof) in body.places(node).into_iter().enumerate() {
                if let Some(dof) = dof {
                    place[dof] = (number, direction);
                }
            }
        }
        let (starts, columns) = numbering.neighbours(body, own.clone())?;
        let range = |k: usize| starts[k] as usize..starts[k + 1] as usize;
        let mut values = vec![0.0; columns.len() * d * d];
        // The place of an entry of this node and direction, in a row after row of each node.
        let slot = |k: usize, a: usize, (other, b): (usize, usize)| {
            let row = &columns[range(k)];
            Some((range(k).start * d + a * row.len() + row.binary_search(&(other as Int)).ok()?) * d + b)
        };
        let mut add = |(node, a): (usize, usize), to: (usize, usize), value: f64| {
            let k = node.checked_sub(own.start).filter(|k| *k < own.len());
            if let Some(at) = k.and_then(|k| slot(k, a, to)) {
                values[at] += value;
            }
        };
        for (row, column, value) in rows.lower().entries() {
            add(place[row], place[column], value);
            if row != column {
                add(place[column], place[row], value);
            }
        }
        drop(rows);
        for (k, number) in own.clone().enumerate() {
            let diagonal: Vec<usize> = (0..d).filter_map(|a| slot(k, a, (number, a))).collect();
            let largest = diagonal.iter().map(|at| values[*at]).fold(0.0, f64::max);
            diagonal.into_iter().filter(|at| values[*at] == 0.0).collect::<Vec<_>>().into_iter().for_each(|at| {
                values[at] = if largest > 0.0 { largest } else { 1.0 };
            });
        }
        // Each row of a node has all directions of the nodes in its columns.
        let (mut row_starts, mut row_columns) = (vec![0], Vec::with_capacity(values.len()));
        for k in 0..own.len() {
            for _ in 0..d {
                row_columns.extend(columns[range(k)].iter().flat_map(|node| (*node * d as Int..).take(d)));
                row_starts.push(int(row_columns.len())?);
            }
        }
        let matrix = Arc::new(Matrix::of_rows(d, &row_starts, &row_columns, &values)?);
        let places = place.iter().filter(|_| world.rank() == 0).map(|(node, a)| (node * d + a) as Int);
        let exchange = Exchange::new(own.len() * d, &places.collect::<Vec<_>>())?;
        let (result, to_all) = (Vector::new(own.len() * d)?, Scatter::to_all(&exchange.own)?);
        Ok(Some(Rows { numbering: Arc::new(numbering), matrix, exchange, result, to_all }))
    }

    /// Collects the diagonal and the largest size in each row. Returns the number of entries on all ranks.
    pub(crate) fn norms(&self, to: [&mut [f64]; 2]) -> Result<f64, LinearError> {
        let Rows { matrix, exchange, result, .. } = self;
        matrix.norms([&exchange.own, result])?;
        let [diagonal, sizes] = to;
        exchange.collect(&exchange.own, diagonal)?;
        exchange.collect(result, sizes)?;
        exchange.own.with(|own| own.fill(0.0))?;
        matrix.entries()
    }

    /// Computes `K x`, and `|K| |x|` or `K (x + rest)` in twice the working precision, as the `product` says.
    pub(crate) fn product(
        &self,
        product: Product,
        [x, rest]: [&[f64]; 2],
        [y, more]: [&mut [f64]; 2],
    ) -> Result<(), LinearError> {
        let Rows { matrix, exchange, result, to_all: (scatter, whole), .. } = self;
        exchange.deal(x)?;
        if product != Product::Beyond {
            matrix.apply(&exchange.own, result)?;
            exchange.collect(result, y)?;
            if product == Product::Plain {
                return Ok(());
            }
            scatter.forward(&exchange.own, whole)?;
            let x = whole.with(|whole| whole.to_vec())?;
            let mut sizes = Vec::new();
            matrix.each_row(|_, columns, values| {
                sizes.push(columns.iter().zip(values).map(|(j, v)| (v * x[*j as usize]).abs()).sum());
            })?;
            return self.collect(&sizes, more);
        }
        scatter.forward(&exchange.own, whole)?;
        let x = whole.with(|whole| whole.to_vec())?;
        exchange.deal(rest)?;
        scatter.forward(&exchange.own, whole)?;
        let rest = whole.with(|whole| whole.to_vec())?;
        let mut parts = [Vec::new(), Vec::new()];
        matrix.each_row(|_, columns, values| {
            let mut sum = DoubleDouble::default();
            for (value, j) in values.iter().zip(columns) {
                sum.add_product(*value, x[*j as usize]);
                sum.add(value * rest[*j as usize]);
            }
            let [high, low] = sum.parts();
            parts[0].push(high);
            parts[1].push(low);
        })?;
        self.collect(&parts[0], y)?;
        self.collect(&parts[1], more)
    }

    fn collect(&self, own: &[f64], to: &mut [f64]) -> Result<(), LinearError> {
        self.result.with(|result| result.copy_from_slice(own))?;
        self.exchange.collect(&self.result, to)
    }

    /// Gathers row, column and value of all entries on and below the diagonal on rank 0.
    pub(crate) fn lower(&self, world: &World) -> Result<Vec<f64>, LinearError> {
        let all = self.matrix.size()?;
        let places: Vec<Int> = if world.rank() == 0 { (0..all).collect() } else { Vec::new() };
        let mut entries = Vec::new();
        self.matrix.within(&places)?.each_row(|row, columns, values| {
            let lower = columns.iter().zip(values).filter(|(column, value)| **column <= row && **value != 0.0);
            entries.extend(lower.flat_map(|(column, value)| [f64::from(row), f64::from(*column), *value]));
        })?;
        Ok(entries)
    }
}
