//! The strains of an element: from its displacements alone or with the mean dilatation (B̄).

use serde::{Deserialize, Serialize};

use super::shape::CellPoint;

/// The element formulation: the relation between strain and nodal displacements.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize)]
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
}

/// The strain `(ε_xx, ε_yy, ε_zz, γ_xy, γ_yz, γ_zx)`; in a body of revolution `ε_zz` is the hoop strain.
pub(super) type Strain = [f64; 6];

/// Computes the columns of `B` in `dimension` dimensions: the strains (1/m) of a unit displacement in each of the
/// unknowns, node by node, at a `point`. If `mean` is given, it replaces the trace of the strain:
/// `ε̄ = ε + (θ̄ - tr ε) 1 / 3`.
pub(super) fn strain_columns(dimension: usize, point: &CellPoint, mean: Option<&[[f64; 3]]>) -> Vec<Strain> {
    let mut columns = Vec::with_capacity(dimension * point.gradients.len());
    for (a, &[gx, gy, gz]) in point.gradients.iter().enumerate() {
        let h = point.hoop(a);
        let [cx, cy, cz] = mean.map_or([0.0; 3], |mean| {
            let own = point.dilatation(a);
            [0, 1, 2].map(|c| (mean[a][c] - own[c]) / 3.0)
        });
        let node = [[gx + cx, cx, h + cx, gy, 0.0, gz], [cy, gy + cy, cy, gx, gz, 0.0], [cz, cz, gz + cz, 0.0, gy, gx]];
        columns.extend_from_slice(&node[..dimension]);
    }
    columns
}

/// Replaces the dilatation of a strain by `dilatation`.
pub fn with_dilatation(strain: Strain, dilatation: f64) -> Strain {
    let [xx, yy, zz, xy, yz, zx] = strain;
    let change = (dilatation - (xx + yy + zz)) / 3.0;
    [xx + change, yy + change, zz + change, xy, yz, zx]
}

impl Element {
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

#[cfg(test)]
mod tests {
    use super::*;
    use crate::body::mesh::{CellKind, Geometry, quadrature};

    const DISTORTED: [[f64; 3]; 4] = [[0.0, 0.0, 0.0], [2.0, 0.3, 0.0], [1.7, 1.4, 0.0], [-0.2, 1.1, 0.0]];

    fn at_gauss_points(kind: CellKind, geometry: Geometry, corners: &[[f64; 3]]) -> Vec<CellPoint> {
        CellPoint::all(kind, geometry, corners, &quadrature(kind)).unwrap()
    }

    /// By Gauss's theorem, `∫ ∂N_a/∂x_c` is half the normal of the two edges at corner `a`, that is, of the diagonal
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
                    let across = k % d == 2 || k % d == 0 && geometry == Geometry::Axisymmetric;
                    assert_eq!(plain[2] == 0.0, !across);
                    assert!((bar[..3].iter().sum::<f64>() - mean[k / d][k % d]).abs() < 1e-15);
                    assert!((bar[0] - bar[1] - (plain[0] - plain[1])).abs() < 1e-15);
                    assert!((bar[1] - bar[2] - (plain[1] - plain[2])).abs() < 1e-15);
                    assert_eq!(bar[3..], plain[3..]);
                }
            }
        }
    }
}
