//! Nodal values, one for each node and each law of the cells around it, since strains jump at an interface between
//! materials.

use std::collections::HashMap;

use crate::body::fem::numbered;
use crate::body::model::Model;

/// The numbering of the nodal values of a body.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Places {
    /// The index of the value of each node of each cell.
    of_cells: Vec<usize>,
    /// The first position in `of_cells` of each cell, and the end.
    begins: Vec<usize>,
    /// The number of values.
    count: usize,
    /// The number of the law of each cell.
    laws: Vec<usize>,
}

impl Places {
    pub(super) fn new(model: &Model) -> Self {
        Self::of(model, numbered(model.materials().iter().copied()))
    }

    /// Creates the numbering with a value for each node and each law *and* group of the cells around it: elastic strains
    /// also jump where only the thermal expansion does.
    pub(super) fn by_material(model: &Model) -> Self {
        let groups = model.mesh.groups.len();
        let laws = numbered(model.materials().iter().copied());
        let of_cells = model.mesh.cells.iter().zip(laws).map(|(cell, law)| law * groups + cell.group).collect();
        Self::of(model, of_cells)
    }

    /// Creates the numbering for cells with these numbers of their `laws`.
    fn of(model: &Model, laws: Vec<usize>) -> Self {
        let (mut of_cells, mut begins, mut count) = (Vec::new(), vec![0], 0);
        // Most nodes have one law.
        let mut first: Vec<Option<(usize, usize)>> = vec![None; model.mesh.nodes.len()];
        let mut others: HashMap<(usize, usize), usize> = HashMap::new();
        for (cell, &law) in model.mesh.cells.iter().zip(&laws) {
            for &node in &cell.nodes {
                let mut new = || {
                    count += 1;
                    count - 1
                };
                of_cells.push(match first[node] {
                    Some((own, place)) if own == law => place,
                    Some(_) => *others.entry((node, law)).or_insert_with(new),
                    None => first[node].insert((law, new())).1,
                });
            }
            begins.push(of_cells.len());
        }
        Places { of_cells, begins, count, laws }
    }

    /// Returns the indices of the values of the nodes of cell `e`.
    pub(super) fn of_cell(&self, e: usize) -> &[usize] {
        &self.of_cells[self.begins[e]..self.begins[e + 1]]
    }

    /// Returns the number of values.
    pub(super) fn count(&self) -> usize {
        self.count
    }

    /// Returns the number of the law of each cell.
    pub(super) fn laws(&self) -> &[usize] {
        &self.laws
    }

    /// Computes each nodal value as the mean of the surrounding cells, weighted by their volumes. `value` takes a cell
    /// and the number of its node.
    pub(super) fn means<const N: usize>(
        &self,
        volumes: &[f64],
        value: impl Fn(usize, usize) -> [f64; N],
    ) -> Vec<[f64; N]> {
        let mut sums = vec![([0.0; N], 0.0); self.count];
        for (e, volume) in volumes.iter().enumerate() {
            for (k, &place) in self.of_cell(e).iter().enumerate() {
                let (sum, weight) = &mut sums[place];
                sum.iter_mut().zip(value(e, k)).for_each(|(sum, x)| *sum += volume * x);
                *weight += volume;
            }
        }
        sums.into_iter().map(|(sum, weight)| sum.map(|x| x / weight)).collect()
    }
}
