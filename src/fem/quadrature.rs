//! Integration points of the reference cells.

use crate::mesh::CellKind;

/// 1/√3.
const A: f64 = 0.577_350_269_189_625_8;

/// 2 × 2 × 2 Gauss points on [-1, 1]³, corner by corner; those of a square are the first four.
const GAUSS: [[f64; 3]; 8] =
    [[-A, -A, -A], [A, -A, -A], [A, A, -A], [-A, A, -A], [-A, -A, A], [A, -A, A], [A, A, A], [-A, A, A]];

/// The points and weights of a cell's reference: Gauss points of weight 1, which are exact for cubic
/// polynomials in each of [ξ, η, ζ], two along each axis of a square or cube; the centre of a triangle or
/// tetrahedron, exact for linear ones.
pub fn quadrature(kind: CellKind) -> Vec<([f64; 3], f64)> {
    match kind {
        CellKind::Triangle => vec![([1.0 / 3.0, 1.0 / 3.0, 0.0], 0.5)],
        CellKind::Quadrilateral => GAUSS[..4].iter().map(|&[xi, eta, _]| ([xi, eta, 0.0], 1.0)).collect(),
        CellKind::Tetrahedron => vec![([0.25; 3], 1.0 / 6.0)],
        CellKind::Hexahedron => GAUSS.iter().map(|&point| (point, 1.0)).collect(),
    }
}

/// The same, exact for quadratic polynomials on triangles and tetrahedra, too.
pub fn fine_quadrature(kind: CellKind) -> Vec<([f64; 3], f64)> {
    let corner = |k: usize, near: f64, far: f64| [0, 1, 2].map(|c| if c == k { near } else { far });
    match kind {
        CellKind::Triangle => (0..3)
            .map(|k| {
                let [xi, eta, _] = corner(k, 2.0 / 3.0, 1.0 / 6.0);
                ([xi, eta, 0.0], 1.0 / 6.0)
            })
            .collect(),
        CellKind::Tetrahedron => {
            let far = (5.0 - 5.0_f64.sqrt()) / 20.0;
            (0..4).map(|k| (corner(k, 1.0 - 3.0 * far, far), 1.0 / 24.0)).collect()
        }
        CellKind::Quadrilateral | CellKind::Hexahedron => quadrature(kind),
    }
}
