//! The distribution of nodes among ranks.

use stickslip::algebra::NodeRows;
use stickslip::algebra::linear::LinearError;

use crate::petsc::{Entries, Int, Matrix, partition};
use crate::ranks::shim::{World, broadcast};

/// The numbers of the nodes that have displacements, rank after rank.
#[derive(Debug)]
pub(crate) struct Numbering {
    /// The number of each node of the mesh, if it has one, else -1.
    pub numbers: Vec<i64>,
    /// The ranges of numbers of the ranks.
    pub bounds: Vec<usize>,
}

impl Numbering {
    /// Distributes the nodes, of which those with displacements are `true`, in their order.
    pub(crate) fn even(nodes: impl Iterator<Item = bool>, ranks: usize) -> Self {
        let mut count = 0;
        let numbers = nodes.map(|has| if has { (count, count += 1).0 } else { -1 }).collect();
        Numbering { numbers, bounds: (0..=ranks).map(|rank| rank * count as usize / ranks).collect() }
    }

    /// Distributes the nodes evenly among the ranks, with few couplings between them. All ranks have the same `body`.
    ///
    /// # Errors
    /// If memory is short.
    pub(crate) fn new(world: &World, body: &dyn NodeRows) -> Result<Self, LinearError> {
        let mut made = Numbering::even((0..body.nodes()).map(|node| body.places(node) != [None; 3]), world.size);
        if world.size == 1 {
            return Ok(made);
        }
        let (mut graph, many) = (Entries::default(), if world.rank == 0 { made.bounds[world.size] } else { 0 });
        body.each_cell(&mut |cell| {
            let numbers = || cell.iter().filter(|_| many > 0).filter_map(|node| made.number(*node));
            numbers().for_each(|row| numbers().for_each(|column| graph.push(row as Int, column as Int, 0.0)));
        });
        let part = partition(&Matrix::of(many, graph)?, many)?;
        // Rank 0 has the parts, and tells the numbers.
        let mut order: Vec<usize> = (0..many).collect();
        order.sort_by_key(|&k| part[k]);
        let mut numbers = vec![-1; many];
        order.iter().zip(0..).for_each(|(&k, number)| numbers[k] = number);
        let new = |first: &i64| numbers.get(*first as usize).map_or(-1, |number| *number);
        let mut words: Vec<i64> = made.numbers.iter().map(new).collect();
        words.extend((0..=world.size).map(|rank| order.partition_point(|&k| part[k] < rank) as i64));
        broadcast(&mut words);
        made.bounds = words.split_off(body.nodes()).into_iter().map(|bound| bound as usize).collect();
        Ok(Numbering { numbers: words, ..made })
    }

    /// Returns the number of a node, if it has displacements.
    pub(crate) fn number(&self, node: usize) -> Option<usize> {
        self.numbers.get(node).and_then(|number| usize::try_from(*number).ok())
    }

    /// Returns the rank of a node, if it has displacements.
    pub(crate) fn owner(&self, node: usize) -> Option<usize> {
        self.number(node).map(|number| self.bounds[1..].partition_point(|end| *end <= number))
    }
}
