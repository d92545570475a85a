//! Gradients of shape functions in space.

use crate::algebra::vector::{dot, norm};
use crate::body::mesh::{CellKind, Geometry, Jacobian, shape};

/// Of the determinant of a Jacobian to the product of its rows' lengths: below this a cell is flat. Far
/// above rounding, far below any cell that was meant; stretching a rectangle does not change it.
const FLAT: f64 = 1e-12;

/// The gradients `∂N_a/∂(x, y, z)` (1/m) at a reference point of the cell with `nodes` (m), and the
/// determinant of the Jacobian `∂(x, y, z)/∂(ξ, η, ζ)` (m^d), d the dimension. `None` where the cell is
/// inverted or degenerate: the determinant is not positive, to rounding.
pub fn gradients(kind: CellKind, point: [f64; 3], nodes: &[[f64; 3]]) -> Option<(Vec<[f64; 3]>, f64)> {
    let Jacobian { local, rows, cofactors, determinant: det } = Jacobian::new(kind, point, nodes);
    let sound = det > FLAT * rows.iter().map(|&row| norm(row)).product::<f64>();
    let along = |d: [f64; 3], c: usize| dot(d, cofactors.map(|column| column[c])) / det;
    sound.then(|| (local.into_iter().map(|d| [0, 1, 2].map(|c| along(d, c))).collect(), det))
}

/// A radius below this share of the largest of a cell is that of the axis, to rounding.
const ON_AXIS: f64 = 1e-9;

/// A point of a cell: what its strains follow from, and what it stands for.
pub(super) struct CellPoint {
    /// `∂N_a/∂(x, y, z)`, 1/m.
    pub gradients: Vec<[f64; 3]>,
    /// `N_a / r` (1/m) in a body of revolution: the strain around the axis that a unit displacement of the node away from it makes.
    /// Empty in others.
    pub hoops: Vec<f64>,
    /// The volume (m³; in two dimensions the area, m²) that it stands for; in a body of revolution all around.
    pub volume: f64,
}

impl CellPoint {
    /// The reference point `point` of the cell with `nodes` (m), of this weight in a rule. `None` as [`gradients`].
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
            // Nothing moves aside on the axis, where u_r / r is the slope of u_r.
            gradients.iter().map(|gradient| gradient[0]).collect()
        };
        Some(CellPoint { gradients, hoops, volume: area * geometry.depth([r, 0.0, 0.0]) })
    }

    /// The points of a rule.
    pub(super) fn all(
        kind: CellKind,
        geometry: Geometry,
        nodes: &[[f64; 3]],
        rule: &[([f64; 3], f64)],
    ) -> Option<Vec<Self>> {
        rule.iter().map(|point| CellPoint::new(kind, geometry, nodes, *point)).collect()
    }

    /// `N_a / r` of node `a` (1/m), 0 where nothing goes round an axis.
    pub(super) fn hoop(&self, a: usize) -> f64 {
        self.hoops.get(a).copied().unwrap_or(0.0)
    }

    /// The dilatations (1/m) of unit displacements of node `a`: its gradient, and what it stretches around the axis.
    pub(super) fn dilatation(&self, a: usize) -> [f64; 3] {
        let [x, y, z] = self.gradients[a];
        [x + self.hoop(a), y, z]
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A reference cell, bent; those of the plane stay in it.
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

    /// A needle a million times as long as it is thick is sound, a cell without volume is not.
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
}
