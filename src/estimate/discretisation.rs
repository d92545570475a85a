//! The error of the mesh in the energy norm, by recovered strains (Zienkiewicz and Zhu, Int. J. Numer. Meth. Engng 24 (1987) 337).
//!
//! Strains of a mesh jump from cell to cell; means of them in the nodes, interpolated, are nearer to the truth. What is between
//! the two is taken for the error,
//!
//! ```text
//! η² = ∫ (ε* - ε) D (ε* - ε) dV,
//! ```
//!
//! relative to `√(uᵀ K u + η²)`. Means are those of the cells of one law around a node, each with the weight of its volume.

use std::collections::{HashMap, HashSet};

use super::strains::Strains;
use crate::mesh::{CellKind, quadrature, shape};
use crate::model::Model;

/// The error of a mesh.
#[derive(Debug, Clone, PartialEq)]
pub struct DiscretisationError {
    /// The whole, as a share of the energy norm of the solution.
    pub whole: f64,
    /// Of each cell, in the same measure: their squares add up to that of the whole.
    pub of_cells: Vec<f64>,
}

/// What a kind of cell needs.
struct Recovery {
    /// For each node the weights with which values at the integration points continue to there.
    extrapolation: Vec<Vec<f64>>,
    /// For each integration point the shape functions of the nodes.
    interpolation: Vec<Vec<f64>>,
}

impl Recovery {
    /// Of a linear cell; of those of second order means are not enough.
    fn new(kind: CellKind) -> Option<Self> {
        let interpolation: Vec<Vec<f64>> = quadrature(kind).iter().map(|(point, _)| shape(kind, *point)).collect();
        let extrapolation = match (kind.is_quadratic(), interpolation.len()) {
            (true, _) => return None,
            (false, 1) => vec![vec![1.0]; kind.nodes()],
            // As many points as nodes: the values in the nodes that have these between them.
            (false, _) => inverse(interpolation.clone()),
        };
        Some(Recovery { extrapolation, interpolation })
    }
}

/// The inverse of a small matrix, by Gauss and Jordan.
fn inverse(mut a: Vec<Vec<f64>>) -> Vec<Vec<f64>> {
    let n = a.len();
    for (k, row) in a.iter_mut().enumerate() {
        row.extend((0..n).map(|j| f64::from(u8::from(j == k))));
    }
    for k in 0..n {
        let largest = (k..n).max_by(|&i, &j| a[i][k].abs().total_cmp(&a[j][k].abs())).unwrap_or(k);
        a.swap(k, largest);
        let scale = a[k][k];
        a[k].iter_mut().for_each(|x| *x /= scale);
        let pivot = a[k].clone();
        for (_, row) in a.iter_mut().enumerate().filter(|(i, _)| *i != k) {
            let factor = row[k];
            row.iter_mut().zip(&pivot).for_each(|(x, p)| *x -= factor * p);
        }
    }
    a.into_iter().map(|row| row[n..].to_vec()).collect()
}

/// A sum of arrays with weights.
fn combined<'a>(terms: impl Iterator<Item = (&'a f64, [f64; 6])>) -> [f64; 6] {
    terms.fold([0.0; 6], |mut sum, (weight, term)| {
        sum.iter_mut().zip(term).for_each(|(sum, x)| *sum += weight * x);
        sum
    })
}

impl DiscretisationError {
    /// That of a state with these strains; none on cells of second order, or where nothing is strained.
    pub(super) fn new(model: &Model, strains: &Strains) -> Option<Self> {
        let cells = &model.mesh.cells;
        let kinds: HashSet<CellKind> = cells.iter().map(|cell| cell.kind).collect();
        let recoveries = kinds.into_iter().map(|kind| Some((kind, Recovery::new(kind)?)));
        let recoveries: HashMap<CellKind, Recovery> = recoveries.collect::<Option<_>>()?;
        let in_nodes = strains.means(model, |e, k| {
            let weights = &recoveries[&cells[e].kind].extrapolation[k];
            combined(weights.iter().zip(strains.of_cell(e).iter().map(|(_, strain)| *strain)))
        });
        let (mut squares, mut energy) = (Vec::with_capacity(cells.len()), 0.0);
        for (e, (cell, law)) in cells.iter().zip(model.materials()).enumerate() {
            let mut square = 0.0;
            for ((volume, strain), shape) in strains.of_cell(e).iter().zip(&recoveries[&cell.kind].interpolation) {
                let nodes = (0..cell.nodes.len()).map(|k| in_nodes[strains.place(e, k)]);
                let recovered = combined(shape.iter().zip(nodes));
                let off: [f64; 6] = std::array::from_fn(|c| recovered[c] - strain[c]);
                square += 2.0 * volume * law.energy_density(&off);
                energy += 2.0 * volume * law.energy_density(strain);
            }
            squares.push(square);
        }
        let all = energy + squares.iter().sum::<f64>();
        let share = |square: f64| (square / all).sqrt();
        (all > 0.0).then(|| DiscretisationError {
            whole: share(squares.iter().sum()),
            of_cells: squares.into_iter().map(share).collect(),
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// What is in the space of the shape functions is continued as it is.
    #[test]
    fn values_in_nodes_are_met() {
        for kind in CellKind::ALL {
            let Some(recovery) = Recovery::new(kind) else { continue };
            let values: Vec<f64> =
                (0..kind.nodes()).map(|k| if kind.is_simplex() { 3.0 } else { (k * k) as f64 }).collect();
            let times = |row: &Vec<f64>, x: &[f64]| row.iter().zip(x).map(|(a, x)| a * x).sum::<f64>();
            let at_points: Vec<f64> = recovery.interpolation.iter().map(|row| times(row, &values)).collect();
            for (row, value) in recovery.extrapolation.iter().zip(&values) {
                assert!((times(row, &at_points) - value).abs() < 1e-12, "{kind:?}");
            }
        }
    }
}
