//! Gradients of shape functions with respect to position.

use crate::algebra::vector::{dot, norm};
use crate::body::mesh::{CellKind, Geometry, Jacobian, shape};

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
    let sound = det > FLAT * rows.iter().map(|&row| norm(row)).product::<f64>();
    let along = |d: [f64; 3], c: usize| dot(d, cofactors.map(|column| column[c])) / det;
    sound.then(|| (local.into_iter().map(|d| [0, 1, 2].map(|c| along(d, c))).collect(), det))
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

#[cfg(test)]
mod tests {
    use super::*;

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
}
