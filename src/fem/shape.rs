//! Gradients of shape functions in space.

use crate::mesh::{CellKind, Jacobian};
use crate::vector::{dot, norm};

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

/// The same at each point of a rule, with the volume (m^d) that the point stands for in place of the determinant.
pub(super) fn gradients_at(
    kind: CellKind,
    rule: &[([f64; 3], f64)],
    nodes: &[[f64; 3]],
) -> Option<Vec<(Vec<[f64; 3]>, f64)>> {
    let at = |(point, weight): &([f64; 3], f64)| {
        gradients(kind, *point, nodes).map(|(gradients, det)| (gradients, det * weight))
    };
    rule.iter().map(at).collect()
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
