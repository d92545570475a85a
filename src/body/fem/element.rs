//! Elements: gradients of their shape functions, strains from displacements alone or with the mean dilatation (B̄), and
//! stiffness.

use serde::{Deserialize, Serialize};

use super::material::Elasticity;
use crate::algebra::vector::{dot, norm};
use crate::body::mesh::{CellKind, Geometry, Jacobian, Mesh, quadrature_of, shape};

/// The element formulation: the relation between strain and nodal displacements.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize, schemars::JsonSchema)]
#[serde(rename_all = "kebab-case")]
pub enum Element {
    /// The strain of the displacements, for all shape functions: linear, quadratic, bilinear or trilinear. It locks as
    /// `ν → 1/2`: every Gauss point is a volume constraint, four in a quadrilateral and eight in a hexahedron, with two
    /// or three displacements for each element.
    #[default]
    Bilinear,
    /// The strain with its volumetric part replaced by the mean over the element (Hughes, Int. J. Numer. Meth. Engng 15
    /// (1980) 1413; Simo & Hughes, *Computational Inelasticity*, ch. 4). Intended for plane strain, bodies of
    /// revolution and three dimensions: in two dimensions, the correction has a component `ε_zz`.
    BBar,
    /// The strain with the mean dilatation over the cells around each corner (see `NodalVolumes`), for
    /// triangles in plane strain and in bodies of revolution, tetrahedra, prisms and all cells of second order. A single
    /// cell, and a cell of another kind, has the strain of its displacements.
    NodalVolume,
}

impl Element {
    /// Returns the name in a scene.
    pub fn name(self) -> &'static str {
        match self {
            Element::Bilinear => "bilinear",
            Element::BBar => "b-bar",
            Element::NodalVolume => "nodal-volume",
        }
    }

    /// Computes the dilatations (1/m) of unit displacements that replace those at the `points` of a cell: for B̄ their
    /// means over the cell, `∫ tr B dV / V`; otherwise `None`. With two Gauss points along each axis both integrals are
    /// exact for any quadrilateral or hexahedron: gradient times determinant, and the determinant itself, are
    /// polynomials of at most second degree in each of ξ, η and ζ; times the distance from an axis they are cubic.
    pub(super) fn mean_dilatation(self, points: &[CellPoint]) -> Option<Vec<[f64; 3]>> {
        if self != Element::BBar {
            return None;
        }
        let volume: f64 = points.iter().map(|point| point.volume).sum();
        let mut mean = vec![[0.0; 3]; points.first().map_or(0, |point| point.gradients.len())];
        for point in points {
            for (a, mean) in mean.iter_mut().enumerate() {
                let own = point.dilatation(a);
                for c in 0..3 {
                    mean[c] += point.volume / volume * own[c];
                }
            }
        }
        Some(mean)
    }
}

/// The strain `(ε_xx, ε_yy, ε_zz, γ_xy, γ_yz, γ_zx)`; in a body of revolution `ε_zz` is the hoop strain.
pub(super) type Strain = [f64; 6];

/// Computes the columns of `B` for displacements of so many `components`: the strains (1/m) of a unit displacement in each
/// of the unknowns, node by node, at a `point`. If `mean` is given, it replaces the trace of the strain:
/// `ε̄ = ε + (θ̄ - tr ε) 1 / 3`.
pub(super) fn strain_columns(components: usize, point: &CellPoint, mean: Option<&[[f64; 3]]>) -> Vec<Strain> {
    let mut columns = Vec::with_capacity(components * point.gradients.len());
    for (a, &[gx, gy, gz]) in point.gradients.iter().enumerate() {
        let h = point.hoop(a);
        let [cx, cy, cz] = mean.map_or([0.0; 3], |mean| {
            let own = point.dilatation(a);
            [0, 1, 2].map(|c| (mean[a][c] - own[c]) / 3.0)
        });
        let node =
            [[gx + cx, cx, h + cx, gy, 0.0, gz], [cy, gy + cy, cy, gx, gz, 0.0], [cz, cz, gz + cz, 0.0, gy, gx - h]];
        columns.extend_from_slice(&node[..components]);
    }
    columns
}

/// Replaces the dilatation of a strain by `dilatation`.
pub fn with_dilatation(strain: Strain, dilatation: f64) -> Strain {
    let [xx, yy, zz, xy, yz, zx] = strain;
    let change = (dilatation - (xx + yy + zz)) / 3.0;
    [xx + change, yy + change, zz + change, xy, yz, zx]
}

/// The least ratio of the determinant of a Jacobian to the product of its rows' lengths; below it a cell counts as
/// flat. The value is far above rounding and far below that of any intended cell; stretching a rectangle does not
/// change the ratio.
const FLAT: f64 = 1e-12;

/// Computes the gradients `∂N_a/∂(x, y, z)` (1/m) at a reference point of the cell with `nodes` (m), and the
/// determinant of the Jacobian `∂(x, y, z)/∂(ξ, η, ζ)` (m^d), d the dimension.
///
/// `None` if the cell is inverted or degenerate: the determinant is not positive, within rounding.
pub fn gradients(kind: CellKind, point: [f64; 3], nodes: &[[f64; 3]]) -> Option<(Vec<[f64; 3]>, f64)> {
    let Jacobian { local, rows, cofactors, determinant: det } = Jacobian::new(kind, point, nodes);
    let is_regular = det > FLAT * rows.iter().map(|&row| norm(row)).product::<f64>();
    let along = |d: [f64; 3], c: usize| dot(d, cofactors.map(|column| column[c])) / det;
    is_regular.then(|| (local.into_iter().map(|d| [0, 1, 2].map(|c| along(d, c))).collect(), det))
}

/// A point counts as on the axis if its radius is below this share of the largest radius of the cell.
const ON_AXIS: f64 = 1e-9;

/// A point of a cell with the data of its strains and its volume.
pub(super) struct CellPoint {
    /// `∂N_a/∂(x, y, z)`, 1/m.
    pub gradients: Vec<[f64; 3]>,
    /// `N_a / r` (1/m) in a body of revolution: the hoop strain for a unit radial displacement of the node. Empty for
    /// other bodies.
    pub hoops: Vec<f64>,
    /// The volume (m³; in two dimensions the area, m²) of the point; in a body of revolution over the full
    /// circumference.
    pub volume: f64,
}

impl CellPoint {
    /// Creates the reference point `point` of the cell with `nodes` (m) and its weight in a rule. `None` as for
    /// [`gradients`].
    pub(super) fn new(
        kind: CellKind,
        geometry: Geometry,
        nodes: &[[f64; 3]],
        (point, weight): ([f64; 3], f64),
    ) -> Option<Self> {
        let (gradients, det) = gradients(kind, point, nodes)?;
        let area = det * weight;
        if geometry == Geometry::Cartesian {
            return Some(CellPoint { gradients, hoops: Vec::new(), volume: area });
        }
        let values = shape(kind, point);
        let r: f64 = values.iter().zip(nodes).map(|(n, x)| n * x[0]).sum();
        let largest = nodes.iter().fold(0.0_f64, |m, x| m.max(x[0]));
        let hoops = if r > ON_AXIS * largest {
            values.into_iter().map(|n| n / r).collect()
        } else {
            // On the axis u_r is 0, and u_r / r is its derivative.
            gradients.iter().map(|gradient| gradient[0]).collect()
        };
        Some(CellPoint { gradients, hoops, volume: area * geometry.depth([r, 0.0, 0.0]) })
    }

    /// Creates the points of a rule.
    pub(super) fn all(
        kind: CellKind,
        geometry: Geometry,
        nodes: &[[f64; 3]],
        rule: &[([f64; 3], f64)],
    ) -> Option<Vec<Self>> {
        rule.iter().map(|point| CellPoint::new(kind, geometry, nodes, *point)).collect()
    }

    /// Returns `N_a / r` of node `a` (1/m); 0 except in a body of revolution.
    pub(super) fn hoop(&self, a: usize) -> f64 {
        self.hoops.get(a).copied().unwrap_or(0.0)
    }

    /// Returns the dilatations (1/m) of unit displacements of node `a`: its gradient plus the hoop strain.
    pub(super) fn dilatation(&self, a: usize) -> [f64; 3] {
        let [x, y, z] = self.gradients[a];
        [x + self.hoop(a), y, z]
    }
}

/// Computes the stiffness `∫ Bᵀ D B` of a cell with `nodes` (m), N/m; in two dimensions per unit depth, for a body of
/// revolution over the full circumference.
///
/// Unknowns are `(u_x, u_y)` or, in space and with torsion, `(u_x, u_y, u_z)` node by node. `None` if the element is
/// inverted or degenerate.
pub fn element_stiffness(
    kind: CellKind,
    geometry: Geometry,
    nodes: &[[f64; 3]],
    element: Element,
    material: &Elasticity,
) -> Option<Vec<Vec<f64>>> {
    let points = CellPoint::all(kind, geometry, nodes, &quadrature_of(kind, geometry, nodes))?;
    let mean = element.mean_dilatation(&points);
    let components = geometry.components(kind.dimension());
    let unknowns = components * nodes.len();
    let mut k = vec![vec![0.0; unknowns]; unknowns];
    for point in &points {
        let b = strain_columns(components, point, mean.as_deref());
        for (row, strain) in k.iter_mut().zip(&b) {
            let stress = material.stress(*strain);
            for (entry, strain) in row.iter_mut().zip(&b) {
                *entry += point.volume * stress.iter().zip(strain).map(|(s, e)| s * e).sum::<f64>();
            }
        }
    }
    Some(k)
}

/// Computes the strain `(ε_xx, ε_yy, ε_zz, γ_xy, γ_yz, γ_zx)` at the reference point `point` of a cell with `nodes`
/// (m) and their `displacements` (m).
///
/// In a body of revolution `ε_zz` is the hoop strain. `None` if the element is inverted or degenerate.
pub fn strain_at(
    kind: CellKind,
    geometry: Geometry,
    point: [f64; 3],
    nodes: &[[f64; 3]],
    displacements: &[[f64; 3]],
    element: Element,
) -> Option<[f64; 6]> {
    let here = CellPoint::new(kind, geometry, nodes, (point, 1.0))?;
    let points = CellPoint::all(kind, geometry, nodes, &quadrature_of(kind, geometry, nodes))?;
    Some(strain(&here, element.mean_dilatation(&points).as_deref(), displacements))
}

/// Computes the volume (m³; in two dimensions the area, m²) of a cell, as in [`strain_at`].
pub fn cell_volume(kind: CellKind, geometry: Geometry, nodes: &[[f64; 3]]) -> Option<f64> {
    let points = CellPoint::all(kind, geometry, nodes, &quadrature_of(kind, geometry, nodes))?;
    Some(points.iter().map(|point| point.volume).sum())
}

/// Computes the strains `(ε_xx, ε_yy, ε_zz, γ_xy, γ_yz, γ_zx)` at the integration points of a cell, as in
/// [`strain_at`], each with the volume (m³; in two dimensions the area, m²) of its point.
///
/// `None` if the element is inverted or degenerate.
pub fn strains(
    kind: CellKind,
    geometry: Geometry,
    nodes: &[[f64; 3]],
    displacements: &[[f64; 3]],
    element: Element,
) -> Option<Vec<(f64, [f64; 6])>> {
    let points = CellPoint::all(kind, geometry, nodes, &quadrature_of(kind, geometry, nodes))?;
    let mean = element.mean_dilatation(&points);
    let at = |point: &CellPoint| (point.volume, strain(point, mean.as_deref(), displacements));
    Some(points.iter().map(at).collect())
}

/// Computes the strain of `displacements` of the nodes, see [`strain_columns`].
fn strain(point: &CellPoint, mean: Option<&[[f64; 3]]>, displacements: &[[f64; 3]]) -> Strain {
    let columns = strain_columns(3, point, mean);
    let mut strain = [0.0; 6];
    for (column, u) in columns.iter().zip(displacements.as_flattened()) {
        strain.iter_mut().zip(column).for_each(|(sum, c)| *sum += c * u);
    }
    strain
}

/// An element whose Jacobian is not positive at an integration point.
#[derive(Debug, Clone, Copy, PartialEq, thiserror::Error)]
#[error("element {element} near ({}) is inverted or degenerate", coordinates(centre, *dimension))]
pub struct InvertedElement {
    /// The number of the element, from 0.
    pub element: usize,
    /// The centre of the element, m.
    pub centre: [f64; 3],
    /// The dimension of the mesh.
    pub dimension: usize,
}

impl InvertedElement {
    /// Creates the error of element `element` of `mesh`.
    pub(crate) fn of(mesh: &Mesh, element: usize) -> Self {
        InvertedElement { element, centre: mesh.centre(element), dimension: mesh.dimension }
    }
}

fn coordinates(centre: &[f64; 3], dimension: usize) -> String {
    centre[..dimension].iter().map(|x| format!("{x:.6}")).collect::<Vec<_>>().join(", ")
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::body::mesh::{CellKind, Geometry, quadrature};

    const DISTORTED: [[f64; 3]; 4] = [[0.0, 0.0, 0.0], [2.0, 0.3, 0.0], [1.7, 1.4, 0.0], [-0.2, 1.1, 0.0]];

    fn at_gauss_points(kind: CellKind, geometry: Geometry, corners: &[[f64; 3]]) -> Vec<CellPoint> {
        CellPoint::all(kind, geometry, corners, &quadrature(kind)).unwrap()
    }

    /// `∫ ∂N_a/∂x_c` is, by Gauss's theorem, half the normal of the two edges at corner `a`, that is, of the diagonal
    /// between its neighbours.
    #[test]
    fn the_mean_is_exact_on_a_distorted_element() {
        let points = at_gauss_points(CellKind::Quadrilateral, Geometry::Cartesian, &DISTORTED);
        let volume: f64 = points.iter().map(|point| point.volume).sum();
        for (a, mean) in Element::BBar.mean_dilatation(&points).unwrap().iter().enumerate() {
            let [next, last] = [DISTORTED[(a + 1) % 4], DISTORTED[(a + 3) % 4]];
            let exact = [0.5 * (next[1] - last[1]), -0.5 * (next[0] - last[0])];
            for c in 0..2 {
                assert!((mean[c] * volume - exact[c]).abs() < 1e-15, "{mean:?} {exact:?}");
            }
        }
    }

    #[test]
    fn only_the_trace_is_replaced() {
        // The quadrilateral as a bent prism.
        let above = |[x, y, _]: [f64; 3]| [x + 0.1 * y, y - 0.2 * x, 1.5 + 0.1 * x * y];
        let prism: Vec<[f64; 3]> = DISTORTED.into_iter().chain(DISTORTED.map(above)).collect();
        for (kind, geometry, corners) in [
            (CellKind::Quadrilateral, Geometry::Cartesian, &DISTORTED[..]),
            (CellKind::Quadrilateral, Geometry::Axisymmetric, &DISTORTED.map(|[x, y, z]| [x + 1.0, y, z])[..]),
            (CellKind::Hexahedron, Geometry::Cartesian, &prism[..]),
        ] {
            let d = kind.dimension();
            let points = at_gauss_points(kind, geometry, corners);
            let mean = Element::BBar.mean_dilatation(&points).unwrap();
            for point in &points {
                let (plain, bar) = (strain_columns(d, point, None), strain_columns(d, point, Some(&mean)));
                for (k, (plain, bar)) in plain.iter().zip(bar).enumerate() {
                    let across = k % d == 2 || k % d == 0 && geometry.is_revolved();
                    assert_eq!(plain[2] == 0.0, !across);
                    assert!((bar[..3].iter().sum::<f64>() - mean[k / d][k % d]).abs() < 1e-15);
                    assert!((bar[0] - bar[1] - (plain[0] - plain[1])).abs() < 1e-15);
                    assert!((bar[1] - bar[2] - (plain[1] - plain[2])).abs() < 1e-15);
                    assert_eq!(bar[3..], plain[3..]);
                }
            }
        }
    }

    /// Returns a distorted reference cell; plane cells remain plane.
    fn distorted(kind: CellKind) -> Vec<[f64; 3]> {
        let bent = |[x, y, z]: [f64; 3]| [x + 0.2 * y * y + 0.1 * z, y - 0.3 * x + 0.1 * x * y, z + 0.2 * x * y * z];
        (0..kind.nodes()).map(|k| bent(kind.reference_node(k))).collect()
    }

    #[test]
    fn gradients_reproduce_a_linear_field() {
        for kind in CellKind::ALL {
            let corners = distorted(kind);
            let (g, det) = gradients(kind, [0.2, 0.3, 0.1], &corners).unwrap();
            assert!(det > 0.0);
            let field = |x: [f64; 3]| 1.0 + 2.0 * x[0] - 3.0 * x[1] + 4.0 * x[2];
            for (c, exact) in [2.0, -3.0, 4.0].into_iter().enumerate().take(kind.dimension()) {
                let sum: f64 = g.iter().zip(&corners).map(|(g, &x)| g[c] * field(x)).sum();
                assert!((sum - exact).abs() < 1e-13, "{kind:?} {sum}");
            }
        }
    }

    /// A needle a million times as long as it is thick is valid, a cell without volume is not.
    #[test]
    fn flat_is_not_the_same_as_thin() {
        for kind in CellKind::ALL {
            let scaled = |factor: f64| -> Vec<[f64; 3]> {
                distorted(kind).iter().map(|&[x, y, z]| [x, factor * (y + 0.3 * x), z]).collect()
            };
            assert!(gradients(kind, [0.2, 0.3, 0.1], &scaled(1e-6)).is_some(), "{kind:?}");
            assert!(gradients(kind, [0.2, 0.3, 0.1], &scaled(0.0)).is_none(), "{kind:?}");
            assert!(gradients(kind, [0.2, 0.3, 0.1], &scaled(-1.0)).is_none(), "{kind:?}");
        }
    }

    #[test]
    fn stiffness_is_symmetric_and_inverted_elements_are_refused() {
        let corners = [[0.0, 0.0, 0.0], [2.0, 0.3, 0.0], [1.7, 1.4, 0.0], [-0.2, 1.1, 0.0]];
        let material = Elasticity::isotropic(1.0, 0.3);
        for element in [Element::Bilinear, Element::BBar] {
            let of = |corners: &[[f64; 3]]| {
                element_stiffness(CellKind::Quadrilateral, Geometry::Cartesian, corners, element, &material)
            };
            let k = of(&corners).unwrap();
            for (i, row) in k.iter().enumerate() {
                for (j, &value) in row.iter().enumerate() {
                    assert!((value - k[j][i]).abs() < 1e-15);
                }
            }
            let [a, b, c, d] = corners;
            assert!(of(&[a, d, c, b]).is_none());
        }
    }
}
