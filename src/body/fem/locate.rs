//! Reference coordinates of a point in a cell.

use crate::algebra::vector::dot;
use crate::body::mesh::{CellKind, Jacobian, shape};

/// The largest distance outside a cell of a point that counts as on its side, in reference coordinates.
const SLACK: f64 = 1e-9;

/// The largest number of Newton steps. Bilinear cells need four or five; a cell that needs more is invalid.
const MAX_STEPS: usize = 30;

/// Returns the reference point `[ξ, η, ζ]` that the shape functions map to `x` (m), if `x` is in the cell with `nodes`
/// (m), including its sides; `None` for a point outside.
pub(crate) fn reference_point(kind: CellKind, nodes: &[[f64; 3]], x: [f64; 3]) -> Option<[f64; 3]> {
    // The initial guess is the centre.
    let mut point = kind.centre();
    for _ in 0..MAX_STEPS {
        let values = shape(kind, point);
        let at = |c: usize| values.iter().zip(nodes).map(|(n, node)| n * node[c]).sum::<f64>();
        let left = [0, 1, 2].map(|c| x[c] - at(c));
        let Jacobian { cofactors, determinant: det, .. } = Jacobian::new(kind, point, nodes);
        let step = cofactors.map(|cofactor| dot(left, cofactor) / det);
        (0..3).for_each(|r| point[r] += step[r]);
        let length = step.iter().fold(0.0_f64, |m, s| m.max(s.abs()));
        // Far outside, the map may not be invertible.
        if length.is_nan() || point.iter().any(|c| c.abs() > 10.0) {
            return None;
        }
        if length <= 1e-12 {
            return inside(kind, point).then_some(point);
        }
    }
    None
}

fn inside(kind: CellKind, point: [f64; 3]) -> bool {
    let [xi, eta, zeta] = point;
    match kind {
        _ if kind.is_prism() => {
            [1.0 - xi - eta, xi, eta].iter().all(|share| *share >= -SLACK) && zeta.abs() <= 1.0 + SLACK
        }
        _ if kind.is_simplex() => [1.0 - xi - eta - zeta, xi, eta, zeta].iter().all(|share| *share >= -SLACK),
        _ => point.iter().all(|c| c.abs() <= 1.0 + SLACK),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::body::mesh::corner_shape;

    const CORNERS: [[f64; 3]; 8] = [
        [0.0, 0.0, 0.0],
        [2.0, 0.3, 0.1],
        [1.7, 1.4, 0.0],
        [-0.2, 1.1, -0.1],
        [0.1, 0.1, 1.0],
        [2.1, 0.2, 1.2],
        [1.6, 1.5, 0.9],
        [-0.1, 1.0, 1.1],
    ];

    #[test]
    fn points_are_found_where_they_are() {
        for kind in CellKind::ALL {
            let flat = |x: [f64; 3]| if kind.dimension() == 2 { [x[0], x[1], 0.0] } else { x };
            let spatial_simplex = kind.is_simplex() && kind.dimension() == 3;
            let chosen: Vec<usize> = match kind {
                _ if kind.is_prism() => vec![0, 1, 3, 4, 5, 7],
                _ if spatial_simplex => vec![0, 1, 3, 4],
                _ => (0..8).collect(),
            };
            let corners: Vec<_> = chosen[..kind.corners()].iter().map(|&k| flat(CORNERS[k])).collect();
            // Nodes between corners are moved off the middle.
            let off = |k: usize| flat([0.03 * (k as f64).sin(), 0.02 * (k as f64).cos(), 0.01]);
            let between = (corners.len()..kind.nodes()).map(|k| {
                let values = corner_shape(kind, kind.reference_node(k));
                [0, 1, 2].map(|c| values.iter().zip(&corners).map(|(n, x)| n * x[c]).sum::<f64>() + off(k)[c])
            });
            let nodes: Vec<_> = corners.iter().copied().chain(between).collect();
            let place = |reference: [f64; 3]| {
                let values = shape(kind, reference);
                [0, 1, 2].map(|c| values.iter().zip(&nodes).map(|(n, x)| n * x[c]).sum::<f64>())
            };
            let triangular = kind.is_simplex() || kind.is_prism();
            let reference = flat(if triangular { [0.2, 0.3, 0.1] } else { [0.7, -0.9, 0.3] });
            let found = reference_point(kind, &nodes, place(reference)).unwrap();
            assert!((0..3).all(|c| (found[c] - reference[c]).abs() < 1e-12), "{kind:?}: {found:?}");
            // Corners belong to the cell; a point beyond a side does not, at any distance.
            assert!(corners.iter().all(|&corner| reference_point(kind, &nodes, corner).is_some()), "{kind:?}");
            let beyond = flat(if triangular { [-1e-6, 0.3, 0.1] } else { [1.0 + 1e-6, 0.0, 0.0] });
            assert_eq!(reference_point(kind, &nodes, place(beyond)), None, "{kind:?}");
            assert_eq!(reference_point(kind, &nodes, flat([90.0, -40.0, 7.0])), None, "{kind:?}");
        }
    }
}
