//! Recovery of strains at the nodes from strains at the integration points: one value for each node and each law of the cells
//! around it, since strains jump at an interface between materials.
//!
//! On linear cells a nodal value is the mean over the surrounding cells of one law, weighted by volume. On cells of
//! second order means are not accurate enough: each corner has a quadratic polynomial, fitted to the strains of the
//! surrounding cells (Zienkiewicz and Zhu, Int. J. Numer. Meth. Engng 33 (1992) 1331). A node between two corners, in
//! hexahedra and prisms every node, has the mean of the polynomials of all corners of its cells.

use std::collections::{BTreeMap, HashMap, HashSet};

use super::strains::{Strains, sum};
use crate::algebra::elimination::solve;
use crate::algebra::vector::{minus, norm, plus, unit};
use crate::body::fem::{facet_normals, numbered};
use crate::body::mesh::{Cell, CellKind, Geometry, quadrature_of, shape, stiffness_rule};
use crate::body::model::Model;

/// The least number of strains beyond the number of coefficients in the fit of a polynomial.
pub(super) const SPARE: usize = 2;

/// The largest number of patches tried for a fit; each has one more layer of cells than the last.
pub(super) const LAYERS: usize = 4;

/// A surface has one normal at a node if the sum of those of its sides is at least this share of the sum of their sizes.
const ROUND: f64 = 0.9;

/// Strains are unknown if single layers of linear cells without a free side bear a larger share of the strain energy of a part.
const HIDDEN: f64 = 0.1;

/// Recovers the strains at the `places`; `None` if too few cells of second order are connected, or if they are unknown.
///
/// Across one layer of cells, nothing in it shows how the stresses vary: there, no traction acts on free sides of the surface.
pub(super) fn recovered(model: &Model, places: &Places, strains: &Strains) -> Option<Vec<[f64; 6]>> {
    let mut recovered = in_cells(model, places, strains)?;
    let mesh = &model.mesh;
    // The strains of triangles and tetrahedra vary within a layer, too.
    let surface = if mesh.cells.iter().all(|cell| cell.kind.is_simplex()) { Vec::new() } else { mesh.surface() };
    let outer: HashSet<usize> = surface.iter().flat_map(|(facet, _)| facet).copied().collect();
    let is_outside = |cell: &Cell| cell.nodes[..cell.kind.corners()].iter().all(|node| outer.contains(node));
    let is_layer = |cell: &Cell| !cell.kind.is_simplex() && is_outside(cell);
    let (layer, thick): (Vec<usize>, Vec<usize>) = (0..mesh.cells.len()).partition(|e| is_layer(&mesh.cells[*e]));
    if layer.is_empty() {
        return Some(recovered);
    }
    let thick: HashSet<usize> = thick.into_iter().flat_map(|e| &mesh.cells[e].nodes).copied().collect();
    let untouched = model.untouched();
    let mut normals: BTreeMap<usize, ([f64; 3], f64, usize)> = BTreeMap::new();
    for (facet, e) in surface.iter().filter(|(facet, _)| facet.iter().any(|node| untouched[*node])) {
        for (node, normal) in facet.iter().zip(facet_normals(mesh, facet)).filter(|(node, _)| !thick.contains(node)) {
            let Some(k) = mesh.cells[*e].nodes.iter().position(|of_cell| of_cell == node) else { continue };
            let (sum, size, cell) = normals.entry(places.of_cell(*e)[k]).or_default();
            (*sum, *size, *cell) = (plus(*sum, 1.0, normal), *size + norm(normal), *e);
        }
    }
    let mut released = HashSet::new();
    for (place, (sum, _, e)) in normals.into_iter().filter(|(_, (sum, size, _))| norm(*sum) >= ROUND * size) {
        recovered[place] = model.materials()[e].released(recovered[place], unit(sum));
        released.insert(place);
    }
    let is_seen =
        |e: usize| mesh.cells[e].kind.is_quadratic() || places.of_cell(e).iter().any(|k| released.contains(k));
    let mut hidden = vec![0.0; strains.energies.len()];
    layer.into_iter().filter(|e| !is_seen(*e)).for_each(|e| hidden[e] = strains.energies[e]);
    let is_known = |cells: &Vec<usize>| sum(cells, &hidden) <= HIDDEN * sum(cells, &strains.energies);
    strains.parts().iter().all(is_known).then_some(recovered)
}

/// Computes the means and polynomials.
fn in_cells(model: &Model, places: &Places, strains: &Strains) -> Option<Vec<[f64; 6]>> {
    let cells = &model.mesh.cells;
    if cells.iter().any(|cell| cell.kind.is_quadratic()) {
        return fitted(model, places, strains);
    }
    let mut known: [Option<Vec<[f64; COLUMNS]>>; CellKind::ALL.len()] = Default::default();
    for cell in cells {
        known[cell.kind as usize].get_or_insert_with(|| continuation(cell.kind, model.mesh.geometry));
    }
    Some(places.means(&strains.volumes, |e, k| {
        let points = strains.of_cell(e);
        let mut sum = [0.0; 6];
        let Some(weights) = &known[cells[e].kind as usize] else { return sum };
        for (weight, (_, strain)) in weights[k].iter().zip(points) {
            sum.iter_mut().zip(strain).for_each(|(sum, x)| *sum += weight * x);
        }
        sum
    }))
}

/// Computes for each node of a linear cell the weights of the extrapolation from the integration points.
fn continuation(kind: CellKind, geometry: Geometry) -> Vec<[f64; COLUMNS]> {
    let mut rows: Vec<[f64; COLUMNS]> = (stiffness_rule(kind, geometry, false).into_iter().enumerate())
        .map(|(k, (point, _))| {
            let mut row = [0.0; COLUMNS];
            row.iter_mut().zip(shape(kind, point)).for_each(|(row, n)| *row = n);
            row[kind.nodes() + k] = 1.0;
            row
        })
        .collect();
    let mut weights = [0.0; COLUMNS];
    if let [_] = rows[..] {
        weights[0] = 1.0;
        return vec![weights; kind.nodes()];
    }
    // There are as many points as nodes. The nodal values are those whose interpolation has the values at the points,
    // where the shape functions are independent.
    let is_solved = solve(&mut rows).is_some();
    let of_node = |row: &[f64; COLUMNS]| {
        weights[..kind.nodes()].copy_from_slice(&row[kind.nodes()..2 * kind.nodes()]);
        if is_solved { weights } else { [f64::NAN; COLUMNS] }
    };
    rows.iter().map(of_node).collect()
}

/// The largest length of a row: the monomials of a quadratic polynomial in three dimensions, and the components of
/// strain.
pub(super) const COLUMNS: usize = MONOMIALS + 6;

/// A quadratic polynomial for each component of strain, about a point.
struct Polynomial {
    about: [f64; 3],
    /// The size of the patch along each axis, m. Coordinates are scaled by it because cells may be much longer than
    /// high.
    size: [f64; 3],
    dimension: usize,
    /// The coefficients of each monomial.
    coefficients: Vec<[f64; 6]>,
}

/// The number of monomials up to the second degree in three dimensions.
pub(super) const MONOMIALS: usize = 10;

/// Computes the monomials up to the second degree at `x`; in two dimensions only the first six are nonzero.
pub(super) fn monomials([x, y, z]: [f64; 3], dimension: usize) -> [f64; MONOMIALS] {
    match dimension {
        2 => [1.0, x, y, x * x, x * y, y * y, 0.0, 0.0, 0.0, 0.0],
        _ => [1.0, x, y, z, x * x, x * y, y * y, x * z, y * z, z * z],
    }
}

/// Divides the components of `x` by those of `size`.
pub(super) fn scaled(x: [f64; 3], size: [f64; 3]) -> [f64; 3] {
    [0, 1, 2].map(|c| x[c] / size[c])
}

impl Polynomial {
    /// Fits a polynomial to these strains by least squares; `None` if they do not determine one.
    fn new(about: [f64; 3], samples: &[([f64; 3], [f64; 6])], dimension: usize) -> Option<Self> {
        let count = if dimension == 2 { 6 } else { MONOMIALS };
        if samples.len() < count + SPARE {
            return None;
        }
        let extent = |c: usize| samples.iter().map(|(x, _)| (x[c] - about[c]).abs()).fold(0.0, f64::max);
        let size = [0, 1, 2].map(|c| if c < dimension { extent(c) } else { 1.0 });
        if size.contains(&0.0) {
            return None;
        }
        let mut rows = [[0.0; COLUMNS]; MONOMIALS];
        let rows = &mut rows[..count];
        for (x, strain) in samples {
            let q = monomials(scaled(minus(*x, about), size), dimension);
            for (row, a) in rows.iter_mut().zip(&q) {
                let a = a / samples.len() as f64;
                row.iter_mut().zip(q[..count].iter().chain(strain)).for_each(|(sum, b)| *sum += a * b);
            }
        }
        solve(rows)?;
        let coefficients = rows.iter().map(|row| std::array::from_fn(|c| row[count + c])).collect();
        Some(Polynomial { about, size, dimension, coefficients })
    }

    fn at(&self, x: [f64; 3]) -> [f64; 6] {
        let q = monomials(scaled(minus(x, self.about), self.size), self.dimension);
        let mut strain = [0.0; 6];
        for (q, of) in q.iter().zip(&self.coefficients) {
            strain.iter_mut().zip(of).for_each(|(strain, of)| *strain += q * of);
        }
        strain
    }
}

/// Returns `true` for hexahedra and prisms of second order. In the middle of a hexahedron their functions are -¼ at the
/// eight corners and ¼ at the twelve edges, so that differences of corners from edges grow: there corners, too, have the
/// mean of the polynomials of all corners of their cells.
fn differences_grow(kind: CellKind) -> bool {
    kind.dimension() == 3 && !kind.is_simplex()
}

/// Recovers the strains at the nodes by a polynomial for each corner.
fn fitted(model: &Model, places: &Places, strains: &Strains) -> Option<Vec<[f64; 6]>> {
    let (mesh, d) = (&model.mesh, model.mesh.dimension);
    let mut samples: Vec<([f64; 3], [f64; 6])> = Vec::new();
    let mut begins = vec![0];
    for (e, cell) in mesh.cells.iter().enumerate() {
        let nodes = mesh.points(&cell.nodes);
        for ((point, _), (_, strain)) in
            quadrature_of(cell.kind, mesh.geometry, &nodes).into_iter().zip(strains.of_cell(e))
        {
            let n = shape(cell.kind, point);
            let at = [0, 1, 2].map(|c| n.iter().zip(&nodes).map(|(n, x)| n * x[c]).sum::<f64>());
            samples.push((at, *strain));
        }
        begins.push(samples.len());
    }
    let corners = |e: usize| &places.of_cell(e)[..mesh.cells[e].kind.corners()];
    let mut around = vec![Vec::new(); places.count];
    let mut nodes = vec![0; places.count];
    for (e, cell) in mesh.cells.iter().enumerate() {
        for &place in corners(e) {
            around[place].push(e);
        }
        places.of_cell(e).iter().zip(&cell.nodes).for_each(|(&place, &node)| nodes[place] = node);
    }
    let mut sums = vec![([0.0; 6], 0.0); places.count];
    // The corner whose polynomial was last added at each place.
    let mut last = vec![usize::MAX; places.count];
    for (corner, own) in around.iter().enumerate().filter(|(_, own)| !own.is_empty()) {
        let mut patch = own.clone();
        let fit = (0..LAYERS).find_map(|_| {
            let of_patch: Vec<_> = patch.iter().flat_map(|&e| &samples[begins[e]..begins[e + 1]]).copied().collect();
            let fit = Polynomial::new(mesh.nodes[nodes[corner]], &of_patch, d);
            if fit.is_none() {
                patch = patch.iter().flat_map(|&e| corners(e)).flat_map(|&place| &around[place]).copied().collect();
                patch.sort_unstable();
                patch.dedup();
            }
            fit
        })?;
        for &e in own {
            for (k, &place) in places.of_cell(e).iter().enumerate() {
                let takes = place == corner || k >= corners(e).len() || differences_grow(mesh.cells[e].kind);
                if takes && std::mem::replace(&mut last[place], corner) != corner {
                    let (sum, count) = &mut sums[place];
                    sum.iter_mut().zip(fit.at(mesh.nodes[nodes[place]])).for_each(|(sum, x)| *sum += x);
                    *count += 1.0;
                }
            }
        }
    }
    Some(sums.into_iter().map(|(sum, count)| sum.map(|x| x / count)).collect())
}

/// The numbering of the nodal values of a body.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Places {
    /// The index of the value of each node of each cell.
    of_cells: Vec<usize>,
    /// The first position in `of_cells` of each cell, and the end.
    begins: Vec<usize>,
    /// The number of values.
    pub(super) count: usize,
    /// The number of the law of each cell.
    pub(super) laws: Vec<usize>,
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

#[cfg(test)]
mod tests {
    use super::*;

    /// Fields in the space of the shape functions are extrapolated exactly.
    #[test]
    fn values_in_nodes_are_met() {
        for kind in CellKind::ALL.into_iter().filter(|kind| !kind.is_quadratic()) {
            for geometry in [Geometry::Cartesian, Geometry::Axisymmetric] {
                let rule = stiffness_rule(kind, geometry, false);
                let value = |k: usize| if rule.len() == 1 { 3.0 } else { (k * k) as f64 };
                let points: Vec<f64> = (rule.iter())
                    .map(|(point, _)| shape(kind, *point).iter().enumerate().map(|(k, n)| n * value(k)).sum())
                    .collect();
                for (k, row) in continuation(kind, geometry).iter().enumerate() {
                    let continued: f64 = row.iter().zip(&points).map(|(weight, x)| weight * x).sum();
                    assert!((continued - value(k)).abs() < 1e-12, "{kind:?}");
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
            let (found, exact) = (fit.at(place(21)), strain(place(21)));
            assert!(found.iter().zip(exact).all(|(a, b)| (a - b).abs() < 1e-10), "{found:?} {exact:?}");
            assert!(Polynomial::new(place(20), &samples[..6], d).is_none());
            assert!(Polynomial::new(place(20), &[samples[0]; 20], d).is_none());
        }
    }
}
