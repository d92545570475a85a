//! Shape functions: linear on triangles and tetrahedra, bilinear on quadrilaterals, trilinear on hexahedra.

use crate::mesh::CellKind;
use crate::vector::{cross, dot, norm};

/// The corners of the cube [-1, 1]³; those of the square are the first four, without ζ.
const CORNERS: [[f64; 3]; 8] = [
    [-1.0, -1.0, -1.0],
    [1.0, -1.0, -1.0],
    [1.0, 1.0, -1.0],
    [-1.0, 1.0, -1.0],
    [-1.0, -1.0, 1.0],
    [1.0, -1.0, 1.0],
    [1.0, 1.0, 1.0],
    [-1.0, 1.0, 1.0],
];

/// The shape functions of all corners at the reference point `[ξ, η, ζ]`: `Π ½ (1 + ξ_c ξ_ac)` over the
/// axes c of a square or cube; `1 - ξ - η - ζ, ξ, η, ζ` of a tetrahedron, without ζ of a triangle.
pub fn shape(kind: CellKind, point: [f64; 3]) -> Vec<f64> {
    let [xi, eta, zeta] = point;
    let product = |corner: &[f64; 3]| (0..kind.dimension()).map(|c| 0.5 * (1.0 + point[c] * corner[c])).product();
    match kind {
        CellKind::Triangle => vec![1.0 - xi - eta, xi, eta],
        CellKind::Tetrahedron => vec![1.0 - xi - eta - zeta, xi, eta, zeta],
        CellKind::Quadrilateral | CellKind::Hexahedron => CORNERS[..kind.corners()].iter().map(product).collect(),
    }
}

/// `∂N_a/∂(ξ, η, ζ)` of all corners; the last is 0 in the plane.
pub(super) fn local_gradients(kind: CellKind, point: [f64; 3]) -> Vec<[f64; 3]> {
    let axes = kind.dimension();
    let slope = |corner: &[f64; 3], along: usize| {
        let others = (0..axes).filter(|&c| c != along);
        0.5 * corner[along] * others.map(|c| 0.5 * (1.0 + point[c] * corner[c])).product::<f64>()
    };
    let gradient = |corner: &[f64; 3]| [0, 1, 2].map(|c| if c < axes { slope(corner, c) } else { 0.0 });
    match kind {
        CellKind::Triangle => vec![[-1.0, -1.0, 0.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]],
        CellKind::Tetrahedron => vec![[-1.0; 3], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]],
        CellKind::Quadrilateral | CellKind::Hexahedron => CORNERS[..kind.corners()].iter().map(gradient).collect(),
    }
}

/// Of the determinant of a Jacobian to the product of its rows' lengths: below this a cell is flat. Far
/// above rounding, far below any cell that was meant; stretching a rectangle does not change it.
const FLAT: f64 = 1e-12;

/// The gradients `∂N_a/∂(x, y, z)` (1/m) at a reference point of the cell with `corners` (m), and the
/// determinant of the Jacobian `∂(x, y, z)/∂(ξ, η, ζ)` (m^d), d the dimension. `None` where the cell is
/// inverted or degenerate: the determinant is not positive, to rounding.
pub fn gradients(kind: CellKind, point: [f64; 3], corners: &[[f64; 3]]) -> Option<(Vec<[f64; 3]>, f64)> {
    let local = local_gradients(kind, point);
    let mut j = [[0.0; 3]; 3];
    for (d, x) in local.iter().zip(corners) {
        for r in 0..3 {
            for c in 0..3 {
                j[r][c] += d[r] * x[c];
            }
        }
    }
    if kind.dimension() == 2 {
        // The plane is a slice of space.
        j[2] = [0.0, 0.0, 1.0];
    }
    // The columns of the inverse times the determinant.
    let cofactors = [cross(j[1], j[2]), cross(j[2], j[0]), cross(j[0], j[1])];
    let det = dot(j[0], cofactors[0]);
    let sound = det > FLAT * j.iter().map(|&row| norm(row)).product::<f64>();
    let along = |d: [f64; 3], c: usize| dot(d, cofactors.map(|column| column[c])) / det;
    sound.then(|| (local.into_iter().map(|d| [0, 1, 2].map(|c| along(d, c))).collect(), det))
}

#[cfg(test)]
mod tests {
    use super::*;

    const KINDS: [CellKind; 4] =
        [CellKind::Triangle, CellKind::Quadrilateral, CellKind::Tetrahedron, CellKind::Hexahedron];

    /// A reference cell, bent; those of the plane stay in it.
    fn distorted(kind: CellKind) -> Vec<[f64; 3]> {
        let corners: &[[f64; 3]] = match kind {
            CellKind::Triangle | CellKind::Tetrahedron => {
                &[[0.0; 3], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]]
            }
            CellKind::Quadrilateral | CellKind::Hexahedron => &CORNERS,
        };
        let bent = |[x, y, z]: [f64; 3]| [x + 0.2 * y * y + 0.1 * z, y - 0.3 * x + 0.1 * x * y, z + 0.2 * x * y * z];
        let flat = |[x, y, z]: [f64; 3]| [x, y, if kind.dimension() == 2 { 0.0 } else { z }];
        corners[..kind.corners()].iter().map(|&x| flat(bent(x))).collect()
    }

    #[test]
    fn each_function_is_one_at_its_corner() {
        for kind in KINDS {
            let simplex = kind.corners() == kind.dimension() + 1;
            for a in 0..kind.corners() {
                let mut corner = if simplex { [0.0; 3] } else { CORNERS[a] };
                if simplex && a > 0 {
                    corner[a - 1] = 1.0;
                }
                let values = shape(kind, corner);
                assert!(values.iter().enumerate().all(|(b, &n)| n == f64::from(u8::from(a == b))), "{kind:?}");
            }
        }
    }

    #[test]
    fn gradients_reproduce_a_linear_field() {
        let point = [0.2, 0.3, 0.1];
        for kind in KINDS {
            assert!((shape(kind, point).iter().sum::<f64>() - 1.0).abs() < 1e-15);
            let corners = distorted(kind);
            let (g, det) = gradients(kind, point, &corners).unwrap();
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
        for kind in KINDS {
            let scaled = |factor: f64| -> Vec<[f64; 3]> {
                distorted(kind).iter().map(|&[x, y, z]| [x, factor * (y + 0.3 * x), z]).collect()
            };
            assert!(gradients(kind, [0.2, 0.3, 0.1], &scaled(1e-6)).is_some(), "{kind:?}");
            assert!(gradients(kind, [0.2, 0.3, 0.1], &scaled(0.0)).is_none(), "{kind:?}");
            assert!(gradients(kind, [0.2, 0.3, 0.1], &scaled(-1.0)).is_none(), "{kind:?}");
        }
    }
}
