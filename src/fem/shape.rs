//! Bilinear shape functions of the 4-node quadrilateral.

/// The reference coordinates of the corners, counterclockwise.
const CORNERS: [[f64; 2]; 4] = [[-1.0, -1.0], [1.0, -1.0], [1.0, 1.0], [-1.0, 1.0]];

/// `N_a = (1 + ξ ξ_a)(1 + η η_a) / 4` at the reference point `[ξ, η]`.
pub fn shape([xi, eta]: [f64; 2]) -> [f64; 4] {
    CORNERS.map(|[a, b]| 0.25 * (1.0 + xi * a) * (1.0 + eta * b))
}

/// The gradients `∂N_a/∂(x, y)` (1/m) at a reference point of the element with `corners` (m), and
/// the determinant of the Jacobian `∂(x, y)/∂(ξ, η)` (m²), positive in a sound element.
pub fn gradients([xi, eta]: [f64; 2], corners: &[[f64; 2]; 4]) -> ([[f64; 2]; 4], f64) {
    let local = CORNERS.map(|[a, b]| [0.25 * a * (1.0 + eta * b), 0.25 * b * (1.0 + xi * a)]);
    let mut j = [[0.0; 2]; 2];
    for (d, x) in local.iter().zip(corners) {
        for r in 0..2 {
            for c in 0..2 {
                j[r][c] += d[r] * x[c];
            }
        }
    }
    let det = j[0][0] * j[1][1] - j[0][1] * j[1][0];
    let global =
        local.map(|[dxi, deta]| [(j[1][1] * dxi - j[0][1] * deta) / det, (j[0][0] * deta - j[1][0] * dxi) / det]);
    (global, det)
}

#[cfg(test)]
mod tests {
    use super::*;

    const DISTORTED: [[f64; 2]; 4] = [[0.0, 0.0], [2.0, 0.3], [1.7, 1.4], [-0.2, 1.1]];

    #[test]
    fn partition_of_unity() {
        let p = [0.3, -0.7];
        assert!((shape(p).iter().sum::<f64>() - 1.0).abs() < 1e-15);
        let (g, det) = gradients(p, &DISTORTED);
        assert!(det > 0.0);
        for c in 0..2 {
            assert!(g.iter().map(|g| g[c]).sum::<f64>().abs() < 1e-14);
        }
    }

    #[test]
    fn gradients_reproduce_a_linear_field() {
        let field = |x: [f64; 2]| 1.0 + 2.0 * x[0] - 3.0 * x[1];
        let (g, _) = gradients([-0.4, 0.9], &DISTORTED);
        for (c, exact) in [2.0, -3.0].into_iter().enumerate() {
            let sum: f64 = g.iter().zip(&DISTORTED).map(|(g, &x)| g[c] * field(x)).sum();
            assert!((sum - exact).abs() < 1e-13);
        }
    }
}
