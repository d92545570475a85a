//! The rows of a shared stiffness, which each rank assembles from the elements of its own nodes.

mod numbering;

use std::sync::Arc;

use stickslip::algebra::linear::LinearError;
use stickslip::algebra::{DoubleDouble, NodeRows};

use crate::job::Own;
use crate::petsc::{self, Entries, Exchange, Int, Matrix, Vector, int};
use crate::ranks::shim::{World, broadcast};
pub(crate) use numbering::Numbering;

/// The rows of one rank: all directions of its nodes. In a direction that supports have removed from a node they have
/// the node's largest entry on the diagonal, and zeros elsewhere, so that all blocks have one shape. The last rank has
/// empty rows for contact forces besides.
pub(crate) struct Rows {
    pub matrix: Arc<Matrix>,
    exchange: Exchange,
    result: Vector,
    /// The number of rows of all ranks.
    order: usize,
}

impl Rows {
    /// Assembles the rows of this rank from its own `body`, and empty ones for this number of `forces`. Collects the
    /// diagonal, the largest size in each row, and the numbers of nodes and entries. Returns `None` on all ranks if one
    /// cannot assemble its rows, or has another body than rank 0.
    pub(crate) fn assembled(world: &World, forces: usize, to: Own<'_>) -> Result<Option<Self>, LinearError> {
        petsc::start("")?;
        // Data that are equal on all ranks if their bodies are the same.
        let head = |of: &dyn NodeRows| [of.nodes() as u64, of.order() as u64, of.dimension() as u64, of.fingerprint()];
        let mut agreed = to.body.map_or([0; 4], head);
        broadcast(&mut agreed);
        let body = to.body.filter(|body| head(*body) == agreed);
        let (true, Some(body)) = (world.all(body.is_some()), body) else { return Ok(None) };
        let numbering = Numbering::new(world, body)?;
        let (d, bounds) = (body.dimension(), &numbering.bounds);
        let order = int(bounds[world.size] * d + forces)? as usize;
        let is_own = |node: usize| numbering.owner(node) == Some(world.rank);
        let rows = body.rows(&(0..body.nodes()).map(is_own).collect::<Vec<bool>>());
        let (true, Some(rows)) = (world.all(rows.is_some()), rows) else { return Ok(None) };
        let (mut entries, own_diagonal) = (Entries::default(), rows.diagonal());
        // The place of each displacement, and the removed directions of each node.
        let (mut places, mut removed) = (vec![0; body.order()], vec![Vec::new(); bounds[world.size]]);
        for (node, number) in (0..body.nodes()).filter_map(|node| Some((node, numbering.number(node)?))) {
            for (dof, place) in body.places(node).into_iter().zip((number * d) as Int..).take(d) {
                dof.map_or_else(|| removed[number].push(place), |dof| places[dof] = place);
            }
            let largest = body.places(node).into_iter().flatten().map(|dof| own_diagonal[dof]).fold(0.0, f64::max);
            for place in removed[number].iter().filter(|_| is_own(node)) {
                entries.push(*place, *place, if largest > 0.0 { largest } else { 1.0 });
            }
        }
        // Each row of a node has all directions of the nodes in its columns.
        let with_removed = |place: Int| std::iter::once(place).chain(removed[place as usize / d].iter().copied());
        let own = (bounds[world.rank] * d) as Int..(bounds[world.rank + 1] * d) as Int;
        for (row, column, value) in rows.entries().map(|(row, column, value)| (places[row], places[column], value)) {
            for (i, j) in with_removed(row).flat_map(|i| with_removed(column).map(move |j| (i, j))) {
                if own.contains(&i) {
                    entries.push(i, j, if (i, j) == (row, column) { value } else { 0.0 });
                }
            }
        }
        drop(rows);
        let size = own.len() + if world.rank + 1 == world.size { forces } else { 0 };
        // A copy is without the places of the entries.
        let matrix = Arc::new(Matrix::of(size, entries)?.copy()?);
        let exchange = Exchange::new(size, if world.rank == 0 { places } else { Vec::new() })?;
        let result = Vector::new(size)?;
        matrix.norms([&exchange.own, &result])?;
        let [diagonal, sizes] = to.y;
        exchange.collect(&exchange.own, diagonal)?;
        exchange.collect(&result, sizes)?;
        let entries = matrix.entries()? as usize;
        if let Some(to) = to.numbering {
            *to = Some((numbering, entries));
        }
        Ok(Some(Rows { matrix, exchange, result, order }))
    }

    /// Computes `K x`.
    pub(crate) fn product(&self, own: Own<'_>) -> Result<(), LinearError> {
        let (Rows { matrix, exchange, result, .. }, Own { x, y: [y, _], .. }) = (self, own);
        exchange.deal(x[0], &exchange.own)?;
        matrix.apply(&exchange.own, result)?;
        exchange.collect(result, y)
    }

    /// Computes `K (x + rest)` in twice the working precision if that is to be `beyond`, else `K x` and `|K| |x|`.
    pub(crate) fn sums(&self, beyond: bool, own: Own<'_>) -> Result<(), LinearError> {
        let ([x, rest], mut parts) = (own.x.map(|x| self.everywhere(x)), [Vec::new(), Vec::new()]);
        self.matrix.each_row(|columns, values| {
            let (mut sum, mut sums) = (DoubleDouble::default(), [0.0; 2]);
            for (value, j) in values.iter().zip(columns.iter().map(|j| *j as usize)) {
                if beyond {
                    sum.add_product(*value, x[j]);
                    sum.add(value * rest[j]);
                } else {
                    sums = [sums[0] + value * x[j], sums[1] + (value * x[j]).abs()];
                }
            }
            parts.iter_mut().zip(if beyond { sum.parts() } else { sums }).for_each(|(part, sum)| part.push(sum));
        })?;
        for (part, y) in parts.iter().zip(own.y) {
            self.result.with(|result| result.copy_from_slice(part))?;
            self.exchange.collect(&self.result, y)?;
        }
        Ok(())
    }

    /// Tells all ranks the vector `x` of rank 0, in the order of the rows.
    fn everywhere(&self, x: &[f64]) -> Vec<f64> {
        let mut all = vec![0.0; self.order];
        self.exchange.places.iter().zip(x).for_each(|(place, x)| all[*place as usize] = *x);
        broadcast(&mut all);
        all
    }
}
