//! Parts of a grid: the cells of each rank, if several share the body.

use super::vtu::{Field, Grid, Values};
use std::collections::BTreeSet;

/// The field with the rank of each cell.
pub(super) const RANK: &str = "rank";

impl Grid {
    /// Returns the ranks that have cells, ascending; none if the grid is not shared.
    pub fn ranks(&self) -> BTreeSet<i32> {
        self.of_ranks().iter().copied().collect()
    }

    /// Returns the cells of `rank` with their points, both in their present order. Points on the border of a part are
    /// also in other parts.
    #[must_use]
    pub fn part(&self, rank: i32) -> Grid {
        let own = self.of_ranks().iter().enumerate().filter(|(_, of)| **of == rank);
        let cells: Vec<usize> = own.map(|(cell, _)| cell).collect();
        let mut points: Vec<usize> = cells.iter().flat_map(|&cell| &self.cells[cell].0).copied().collect();
        points.sort_unstable();
        points.dedup();
        let index = |point: &usize| points.partition_point(|other| other < point);
        let moved = |(corners, kind): &(Vec<usize>, u8)| (corners.iter().map(index).collect(), *kind);
        Grid {
            units: self.units,
            points: points.iter().map(|&point| self.points[point]).collect(),
            cells: cells.iter().map(|&cell| moved(&self.cells[cell])).collect(),
            point_fields: self.point_fields.iter().map(|field| field.at(&points)).collect(),
            cell_fields: self.cell_fields.iter().map(|field| field.at(&cells)).collect(),
        }
    }

    /// Returns the rank of each cell; empty if the grid is not shared.
    fn of_ranks(&self) -> &[i32] {
        match self.cell_fields.iter().find(|field| field.name == RANK) {
            Some(Field { values: Values::Whole(ranks), .. }) => ranks,
            _ => &[],
        }
    }
}

impl Field {
    /// Returns the values of these points or cells.
    fn at(&self, indices: &[usize]) -> Field {
        let Field { name, components, values } = self;
        let values = match values {
            Values::Real(values) => Values::Real(values_at(values, *components, indices)),
            Values::Whole(values) => Values::Whole(values_at(values, *components, indices)),
        };
        Field { name, components: *components, values }
    }
}

fn values_at<T: Copy>(values: &[T], components: usize, indices: &[usize]) -> Vec<T> {
    indices.iter().flat_map(|place| &values[place * components..][..components]).copied().collect()
}

#[cfg(test)]
pub(super) mod tests {
    use super::*;
    use stickslip::base::UnitSystem;

    /// 3 x 2 squares, each with a number of its own, as their points have; the ranks 0 and 2 have cells.
    pub(crate) fn squares() -> Grid {
        let points: Vec<[f64; 3]> = (0..12).map(|k| [f64::from(k % 4), f64::from(k / 4), 0.0]).collect();
        let corner = [0, 1, 2, 4, 5, 6];
        let displacement = (0..36).map(|k| if k == 7 { f64::NAN } else { f64::from(k) }).collect();
        let real = |name, components, values| Field { name, components, values: Values::Real(values) };
        let whole = |name, values| Field { name, components: 1, values: Values::Whole(values) };
        Grid {
            units: UnitSystem::si(2),
            points,
            cells: corner.map(|k| (vec![k, k + 1, k + 5, k + 4], 9)).to_vec(),
            point_fields: vec![real("displacement", 3, displacement), whole("status", (100..112).collect())],
            cell_fields: vec![
                real("principal_stress", 3, (0..18).map(f64::from).collect()),
                whole(RANK, vec![2, 0, 0, 2, 2, 0]),
            ],
        }
    }

    /// Returns all data of each cell: corners, values at these, values of the cell, to the last bit.
    fn cell_data(grid: &Grid) -> Vec<Vec<u64>> {
        let bits = |fields: &[Field], index: usize| {
            let of = |Field { components, values, .. }: &Field| match values {
                Values::Real(values) => {
                    values[index * components..][..*components].iter().map(|x| x.to_bits()).collect()
                }
                Values::Whole(values) => vec![values[index] as u64],
            };
            fields.iter().flat_map(of).collect::<Vec<u64>>()
        };
        let cell = |(k, (corners, kind)): (usize, &(Vec<usize>, u8))| {
            let at = |&k: &usize| [grid.points[k].map(f64::to_bits).to_vec(), bits(&grid.point_fields, k)].concat();
            let corners = corners.iter().flat_map(at);
            corners.chain(bits(&grid.cell_fields, k)).chain([u64::from(*kind)]).collect()
        };
        grid.cells.iter().enumerate().map(cell).collect()
    }

    #[test]
    fn parts_together_are_the_grid_and_each_has_its_own_cells() {
        let grid = squares();
        assert!(grid.ranks().into_iter().eq([0, 2]));
        let [zero, one, two] = [0, 1, 2].map(|rank| grid.part(rank));
        assert_eq!((zero.cells.len(), one.cells.len(), two.cells.len()), (3, 0, 3));
        // Four of the twelve points are on the border.
        assert_eq!((zero.points.len(), one.points.len(), two.points.len()), (8, 0, 8));
        let mut parts = [cell_data(&zero), cell_data(&two)].concat();
        let mut whole = cell_data(&grid);
        parts.sort();
        whole.sort();
        assert_eq!(parts, whole);
        assert!(zero.ranks().into_iter().eq([0]) && two.ranks().into_iter().eq([2]));
    }

    #[test]
    fn what_nobody_shares_has_no_ranks() {
        let mut grid = squares();
        grid.cell_fields.pop();
        assert!(grid.ranks().is_empty() && grid.part(0).cells.is_empty());
    }
}
