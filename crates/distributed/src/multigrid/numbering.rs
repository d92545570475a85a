//! The distribution of the nodes of a shared stiffness among ranks.

use crate::ranks::{Graph, World, partition};
use stickslip::algebra::NodeRows;
use stickslip::algebra::linear::LinearError;

/// The number of a node without displacements.
const NONE: u32 = u32::MAX;

/// The numbers of the nodes that have displacements, rank after rank.
pub(super) struct Numbering {
    /// The number of each node of the mesh.
    numbers: Vec<u32>,
    /// The ranges of numbers of the ranks.
    pub bounds: Vec<usize>,
}

impl Numbering {
    /// Distributes the nodes evenly among this number of `ranks`, with few couplings between them.
    ///
    /// # Errors
    /// If memory is short.
    pub(super) fn new(body: &dyn NodeRows, ranks: usize) -> Result<Self, LinearError> {
        const STEP: &str = "dealing the nodes among ranks";
        let mut numbers = vec![NONE; body.nodes()];
        let mut nodes = Vec::new();
        for (node, number) in numbers.iter_mut().enumerate() {
            if body.places(node).iter().any(Option::is_some) {
                *number = u32::try_from(nodes.len()).map_err(|_| LinearError::OutOfMemory { step: STEP })?;
                nodes.push(node);
            }
        }
        let mut beside: Vec<Vec<u32>> = vec![Vec::new(); nodes.len()];
        body.each_cell(&mut |cell| {
            for own in cell.iter().map(|node| numbers[*node]).filter(|own| *own != NONE) {
                beside[own as usize].extend(cell.iter().map(|node| numbers[*node]).filter(|other| *other != NONE));
            }
        });
        for beside in &mut beside {
            beside.sort_unstable();
            beside.dedup();
        }
        let vertices = beside.iter().map(|beside| (1, beside.iter().map(|other| *other as usize)));
        let part = partition(STEP, Graph::new(STEP, vertices)?, ranks)?;
        let mut order: Vec<usize> = (0..nodes.len()).collect();
        order.sort_by_key(|&k| part[k]);
        let bounds = (0..=ranks).map(|rank| order.partition_point(|&k| part[k] < rank)).collect();
        order.iter().enumerate().for_each(|(number, &k)| numbers[nodes[k]] = number as u32);
        Ok(Numbering { numbers, bounds })
    }

    /// Broadcasts the numbering from rank 0, the only rank that has one, with this number of `nodes`. All ranks must
    /// call it.
    pub(super) fn told(own: Option<&Numbering>, nodes: usize, world: &World) -> Self {
        let mut words = vec![0; nodes + world.size() + 1];
        if let Some(Numbering { numbers, bounds }) = own {
            let all = numbers.iter().map(|number| i64::from(*number)).chain(bounds.iter().map(|bound| *bound as i64));
            words.iter_mut().zip(all).for_each(|(word, number)| *word = number);
        }
        world.tell(&mut words);
        Numbering {
            numbers: words[..nodes].iter().map(|word| *word as u32).collect(),
            bounds: words[nodes..].iter().map(|word| *word as usize).collect(),
        }
    }

    /// Returns the number of a node, if it has displacements.
    pub(super) fn number(&self, node: usize) -> Option<usize> {
        self.numbers.get(node).filter(|number| **number != NONE).map(|number| *number as usize)
    }

    /// Returns the rank of a node, if it has displacements.
    pub(super) fn owner(&self, node: usize) -> Option<usize> {
        let number = self.number(node)?;
        Some(self.bounds[1..].partition_point(|end| *end <= number))
    }

    /// Returns the number of nodes of the mesh.
    pub(super) fn nodes(&self) -> usize {
        self.numbers.len()
    }

    /// Returns the number of nodes that have displacements.
    pub(super) fn count(&self) -> usize {
        self.bounds.last().copied().unwrap_or(0)
    }
}
