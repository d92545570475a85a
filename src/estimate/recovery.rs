//! Strains in the nodes, recovered from those at the integration points.
//!
//! On linear cells they are means of what the cells of one law around a node have there, each with the weight of its volume. On
//! cells of second order means are not good enough: each corner has a quadratic polynomial, fitted to the strains of the cells
//! around (Zienkiewicz and Zhu, Int. J. Numer. Meth. Engng 33 (1992) 1331), and a node between two corners the mean of both.

use std::collections::{BTreeSet, HashMap};

use super::strains::Strains;
use crate::mesh::{CellKind, Geometry, quadrature_of, shape};
use crate::model::Model;
use crate::vector::{minus, norm};

/// So many more strains than coefficients a polynomial is fitted to.
const SPARE: usize = 2;

/// A patch grows by a layer of cells until it has enough; so often at most.
const LAYERS: usize = 4;

/// A pivot that is smaller, of a matrix whose columns are as large as one, is what rounding leaves.
const SINGULAR: f64 = 1e-10;

/// The strains at the places of [`Strains::place`]; none where too few cells of second order hang together.
pub(super) fn recovered(model: &Model, strains: &Strains) -> Option<Vec<[f64; 6]>> {
    if model.mesh.cells.iter().any(|cell| cell.kind.is_quadratic()) {
        return fitted(model, strains);
    }
    let mut known: HashMap<CellKind, Vec<Vec<f64>>> = HashMap::new();
    for cell in &model.mesh.cells {
        known.entry(cell.kind).or_insert_with(|| continuation(cell.kind, model.mesh.geometry));
    }
    Some(strains.means(model, |e, k| {
        let weights = &known[&model.mesh.cells[e].kind][k];
        let mut sum = [0.0; 6];
        for (weight, (_, strain)) in weights.iter().zip(strains.of_cell(e)) {
            sum.iter_mut().zip(strain).for_each(|(sum, x)| *sum += weight * x);
        }
        sum
    }))
}

/// For each node of a linear cell the weights with which values at its integration points continue to there.
fn continuation(kind: CellKind, geometry: Geometry) -> Vec<Vec<f64>> {
    let between: Vec<Vec<f64>> = rule(kind, geometry).iter().map(|(point, _)| shape(kind, *point)).collect();
    let points = between.len();
    if points == 1 {
        return vec![vec![1.0]; kind.nodes()];
    }
    // As many points as nodes: the values in the nodes that have these between them.
    let unit = |k: usize| (0..points).map(move |j| f64::from(u8::from(j == k)));
    let rows = between.into_iter().enumerate().map(|(k, row)| row.into_iter().chain(unit(k)).collect());
    // The shape functions are independent at the points.
    solved(rows.collect()).unwrap_or_else(|| vec![vec![f64::NAN; points]; points])
}

/// The integration points of a linear cell, the same for all of a kind.
fn rule(kind: CellKind, geometry: Geometry) -> Vec<([f64; 3], f64)> {
    let nodes: Vec<[f64; 3]> = (0..kind.nodes()).map(|k| kind.reference_node(k)).collect();
    quadrature_of(kind, geometry, &nodes)
}

/// By Gauss and Jordan, `A⁻¹ B` of rows that hold those of A, and behind them those of B; none where A is singular.
fn solved(mut rows: Vec<Vec<f64>>) -> Option<Vec<Vec<f64>>> {
    let n = rows.len();
    for k in 0..n {
        let largest = (k..n).max_by(|&i, &j| rows[i][k].abs().total_cmp(&rows[j][k].abs()))?;
        rows.swap(k, largest);
        let pivot = rows[k][k];
        if pivot.abs() < SINGULAR {
            return None;
        }
        rows[k].iter_mut().for_each(|x| *x /= pivot);
        let scaled = rows[k].clone();
        for (_, row) in rows.iter_mut().enumerate().filter(|(i, _)| *i != k) {
            let factor = row[k];
            row.iter_mut().zip(&scaled).for_each(|(x, y)| *x -= factor * y);
        }
    }
    Some(rows.into_iter().map(|row| row[n..].to_vec()).collect())
}

/// A polynomial of second degree for each strain, about a point.
struct Polynomial {
    about: [f64; 3],
    /// The size of the patch, m: coordinates are measured by it.
    size: f64,
    /// Of each monomial.
    coefficients: Vec<Vec<f64>>,
}

/// The monomials up to the second degree at `x`.
fn monomials([x, y, z]: [f64; 3], dimension: usize) -> Vec<f64> {
    match dimension {
        2 => vec![1.0, x, y, x * x, x * y, y * y],
        _ => vec![1.0, x, y, z, x * x, x * y, y * y, x * z, y * z, z * z],
    }
}

impl Polynomial {
    /// The nearest, in the mean square, to these strains; none where they do not determine one.
    fn new(about: [f64; 3], samples: &[([f64; 3], [f64; 6])], dimension: usize) -> Option<Self> {
        let count = monomials(about, dimension).len();
        if samples.len() < count + SPARE {
            return None;
        }
        let size = samples.iter().map(|(x, _)| norm(minus(*x, about))).fold(0.0, f64::max);
        let mut rows = vec![vec![0.0; count + 6]; count];
        for (x, strain) in samples {
            let q = monomials(minus(*x, about).map(|c| c / size), dimension);
            for (row, a) in rows.iter_mut().zip(&q) {
                row.iter_mut().zip(q.iter().chain(strain)).for_each(|(sum, b)| *sum += a * b / samples.len() as f64);
            }
        }
        Some(Polynomial { about, size, coefficients: solved(rows)? })
    }

    fn at(&self, x: [f64; 3], dimension: usize) -> [f64; 6] {
        let q = monomials(minus(x, self.about).map(|c| c / self.size), dimension);
        std::array::from_fn(|c| q.iter().zip(&self.coefficients).map(|(q, of)| q * of[c]).sum())
    }
}

/// The strains in the nodes by a polynomial for each corner.
fn fitted(model: &Model, strains: &Strains) -> Option<Vec<[f64; 6]>> {
    let (mesh, d) = (&model.mesh, model.mesh.dimension);
    let samples_of = |e: usize| {
        let cell = &mesh.cells[e];
        let nodes = mesh.points(&cell.nodes);
        let at = |point| {
            let n = shape(cell.kind, point);
            [0, 1, 2].map(|c| n.iter().zip(&nodes).map(|(n, x)| n * x[c]).sum::<f64>())
        };
        let points =
            quadrature_of(cell.kind, mesh.geometry, &nodes).into_iter().map(|(point, _)| at(point)).collect::<Vec<_>>();
        points.into_iter().zip(strains.of_cell(e).iter().map(|(_, strain)| *strain)).collect::<Vec<_>>()
    };
    let samples: Vec<_> = (0..mesh.cells.len()).map(samples_of).collect();
    let corners = |e: usize| (0..mesh.cells[e].kind.corners()).map(move |k| strains.place(e, k));
    let mut around: HashMap<usize, Vec<usize>> = HashMap::new();
    for e in 0..mesh.cells.len() {
        corners(e).for_each(|place| around.entry(place).or_default().push(e));
    }
    let mut polynomials: HashMap<usize, Polynomial> = HashMap::new();
    for (e, cell) in mesh.cells.iter().enumerate() {
        for (k, place) in corners(e).enumerate() {
            if polynomials.contains_key(&place) {
                continue;
            }
            let mut patch: BTreeSet<usize> = around[&place].iter().copied().collect();
            let fit = (0..LAYERS).find_map(|_| {
                let of_patch: Vec<_> = patch.iter().flat_map(|&e| samples[e].iter().copied()).collect();
                let fit = Polynomial::new(mesh.nodes[cell.nodes[k]], &of_patch, d);
                if fit.is_none() {
                    let next: Vec<usize> = patch.iter().flat_map(|&e| corners(e)).collect();
                    patch.extend(next.iter().flat_map(|place| &around[place]));
                }
                fit
            });
            polynomials.insert(place, fit?);
        }
    }
    Some(strains.means(model, |e, k| {
        let cell = &mesh.cells[e];
        let at = mesh.nodes[cell.nodes[k]];
        match cell.kind.ends(k) {
            None => polynomials[&strains.place(e, k)].at(at, d),
            Some(ends) => {
                let [a, b] = ends.map(|end| polynomials[&strains.place(e, end)].at(at, d));
                std::array::from_fn(|c| 0.5 * (a[c] + b[c]))
            }
        }
    }))
}

#[cfg(test)]
mod tests {
    use super::*;

    /// What is in the space of the shape functions is continued as it is.
    #[test]
    fn values_in_nodes_are_met() {
        for kind in CellKind::ALL.into_iter().filter(|kind| !kind.is_quadratic()) {
            for geometry in [Geometry::Cartesian, Geometry::Axisymmetric] {
                let rule = super::rule(kind, geometry);
                let value = |k: usize| if rule.len() == 1 { 3.0 } else { (k * k) as f64 };
                let times =
                    |row: &[f64], x: &dyn Fn(usize) -> f64| row.iter().enumerate().map(|(k, a)| a * x(k)).sum::<f64>();
                let points: Vec<f64> = rule.iter().map(|(point, _)| times(&shape(kind, *point), &value)).collect();
                for (k, row) in continuation(kind, geometry).iter().enumerate() {
                    assert!((times(row, &|j| points[j]) - value(k)).abs() < 1e-12, "{kind:?}");
                }
            }
        }
    }

    #[test]
    fn a_quadratic_strain_is_fitted_as_it_is() {
        for d in [2, 3] {
            let strain = |x: [f64; 3]| -> [f64; 6] {
                let q = monomials(x, d);
                std::array::from_fn(|c| q.iter().enumerate().map(|(k, q)| q * ((k + 2 * c) as f64).sin()).sum())
            };
            let place = |k: usize| {
                [0, 1, 2].map(|c| if c < d { 1e-3 * (0.618 * ((k + 1) * (k + 3 * c + 2)) as f64).fract() } else { 0.0 })
            };
            let samples: Vec<_> = (0..20).map(place).map(|x| (x, strain(x))).collect();
            let fit = Polynomial::new(place(20), &samples, d).unwrap();
            let (found, exact) = (fit.at(place(21), d), strain(place(21)));
            assert!(found.iter().zip(exact).all(|(a, b)| (a - b).abs() < 1e-10), "{found:?} {exact:?}");
            assert!(Polynomial::new(place(20), &samples[..6], d).is_none());
            assert!(Polynomial::new(place(20), &[samples[0]; 20], d).is_none());
        }
    }
}
