//! The distribution of the nodes of a shared stiffness among ranks.

use stickslip::algebra::NodeRows;
use stickslip::algebra::linear::LinearError;

use crate::petsc::{Int, int, partition};
use crate::ranks::shim::{World, tell};

/// The number of a node without displacements.
const NONE: i64 = -1;

/// The numbers of the nodes that have displacements, rank after rank.
pub(crate) struct Numbering {
    /// The number of each node of the mesh, or [`NONE`].
    numbers: Vec<i64>,
    /// The ranges of numbers of the ranks.
    pub bounds: Vec<usize>,
}

impl Numbering {
    /// Distributes the nodes evenly among the ranks, with few couplings between them. All ranks have the same `body`.
    ///
    /// # Errors
    /// If memory is short.
    pub(crate) fn new(world: &World, body: &dyn NodeRows) -> Result<Self, LinearError> {
        let mut numbers = vec![NONE; body.nodes()];
        let has_displacements = |node: &usize| body.places(*node).iter().any(Option::is_some);
        let nodes: Vec<usize> = (0..body.nodes()).filter(has_displacements).collect();
        nodes.iter().zip(0..).for_each(|(node, number)| numbers[*node] = number);
        let mut part = vec![0; nodes.len()];
        if world.size() > 1 {
            let (starts, columns) =
                if world.rank() == 0 { graph(body, &numbers, nodes.len())? } else { Default::default() };
            part = partition(&starts, &columns)?;
        }
        // Rank 0 has the parts, and tells the numbers.
        let mut words = vec![0; body.nodes() + world.size() + 1];
        if world.rank() == 0 {
            let mut order: Vec<usize> = (0..nodes.len()).collect();
            order.sort_by_key(|&k| part[k]);
            order.iter().zip(0..).for_each(|(&k, number)| numbers[nodes[k]] = number);
            words[..body.nodes()].copy_from_slice(&numbers);
            for (rank, word) in words[body.nodes()..].iter_mut().enumerate() {
                *word = order.partition_point(|&k| part[k] < rank) as i64;
            }
        }
        tell(&mut words);
        let bounds = words.split_off(body.nodes()).into_iter().map(|bound| bound as usize).collect();
        Ok(Numbering { numbers: words, bounds })
    }

    /// Returns the number of a node, if it has displacements.
    pub(crate) fn number(&self, node: usize) -> Option<usize> {
        self.numbers.get(node).and_then(|number| usize::try_from(*number).ok())
    }

    /// Returns the rank of a node, if it has displacements.
    pub(crate) fn owner(&self, node: usize) -> Option<usize> {
        let number = self.number(node)?;
        Some(self.bounds[1..].partition_point(|end| *end <= number))
    }

    /// Returns the number of nodes that have displacements.
    pub(crate) fn count(&self) -> usize {
        self.bounds.last().copied().unwrap_or(0)
    }
}

/// Returns the graph of the nodes, in which those of a cell are neighbours: the starts of its rows, and their columns.
fn graph(body: &dyn NodeRows, numbers: &[i64], count: usize) -> Result<(Vec<Int>, Vec<Int>), LinearError> {
    int(count)?;
    let mut beside: Vec<Vec<Int>> = vec![Vec::new(); count];
    body.each_cell(&mut |cell| {
        let own = || cell.iter().map(|node| numbers[*node]).filter(|own| *own != NONE);
        for number in own() {
            beside[number as usize].extend(own().filter(|other| *other != number).map(|other| other as Int));
        }
    });
    let (mut starts, mut columns) = (vec![0], Vec::new());
    for mut row in beside {
        row.sort_unstable();
        row.dedup();
        columns.extend(row);
        starts.push(int(columns.len())?);
    }
    Ok((starts, columns))
}
