//! The distribution of the nodes of a shared stiffness among ranks.

use stickslip::algebra::NodeRows;
use stickslip::algebra::linear::LinearError;

use crate::petsc::{Int, Matrix, int, partition};
use crate::ranks::shim::{World, broadcast};

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
        let has_displacements = |node: &usize| body.places(*node).iter().any(Option::is_some);
        let nodes: Vec<usize> = (0..body.nodes()).filter(has_displacements).collect();
        let mut first = Numbering { numbers: vec![NONE; body.nodes()], bounds: Vec::new() };
        nodes.iter().zip(0..).for_each(|(node, number)| first.numbers[*node] = number);
        let mut part = vec![0; nodes.len()];
        if world.size() > 1 {
            let own = if world.rank() == 0 { 0..nodes.len() } else { 0..0 };
            let (starts, columns) = first.neighbours(body, own.clone())?;
            part = partition(&Matrix::of_rows(1, &starts, &columns, &vec![0.0; columns.len()])?, own.len())?;
        }
        // Rank 0 has the parts, and tells the numbers.
        let mut words = vec![0; body.nodes() + world.size() + 1];
        if world.rank() == 0 {
            let mut order: Vec<usize> = (0..nodes.len()).collect();
            order.sort_by_key(|&k| part[k]);
            order.iter().zip(0..).for_each(|(&k, number)| first.numbers[nodes[k]] = number);
            words[..body.nodes()].copy_from_slice(&first.numbers);
            for (rank, word) in words[body.nodes()..].iter_mut().enumerate() {
                *word = order.partition_point(|&k| part[k] < rank) as i64;
            }
        }
        broadcast(&mut words);
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

    /// Returns the nodes that have a cell in common with each of these, and these themselves: the starts of the rows,
    /// and the sorted numbers in them.
    pub(super) fn neighbours(
        &self,
        body: &dyn NodeRows,
        own: std::ops::Range<usize>,
    ) -> Result<(Vec<Int>, Vec<Int>), LinearError> {
        let mut beside: Vec<Vec<Int>> = vec![Vec::new(); own.len()];
        body.each_cell(&mut |cell| {
            let numbers = || cell.iter().filter_map(|node| self.number(*node));
            for number in numbers().filter(|number| own.contains(number)) {
                beside[number - own.start].extend(numbers().map(|other| other as Int));
            }
        });
        let (mut starts, mut columns) = (vec![0], Vec::new());
        for (number, mut row) in own.zip(beside) {
            row.push(int(number)?);
            row.sort_unstable();
            row.dedup();
            columns.extend(row);
            starts.push(int(columns.len())?);
        }
        Ok((starts, columns))
    }
}
