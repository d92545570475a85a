//! The strains of a quadrilateral: bilinear, or with the mean dilatation (B̄).

/// How the strain follows from the corner displacements of a quadrilateral.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Element {
    /// That of the bilinear displacements. It locks when `ν → 1/2` in plane strain: four volumes
    /// are held, one at each Gauss point, by two displacements for each element.
    #[default]
    Bilinear,
    /// Its volumetric part is the mean over the element (Hughes, Int. J. Numer. Meth. Engng 15
    /// (1980) 1413; Simo & Hughes, *Computational Inelasticity*, ch. 4). Meant for plane strain:
    /// the correction has a component `ε_zz`.
    BBar,
}

/// The columns of `B`: the strains `(ε_xx, ε_yy, ε_zz, γ_xy)` (1/m) of a unit displacement in each
/// of the eight unknowns `(u_x, u_y)`, corner by corner.
pub(super) type StrainColumns = [[f64; 4]; 8];

/// `B` at a point with the gradients `∂N_a/∂(x, y)` (1/m), with `dilatation` in place of the trace of
/// the strain: `ε̄ = ε + (θ̄ - tr ε) 1 / 3`.
/// A unit displacement of corner `a` along `c` has `tr ε = ∂N_a/∂x_c`, so `dilatation` has the shape of
/// the gradients, and the gradients themselves leave `B` as it is.
pub(super) fn strain_columns(gradients: &[[f64; 2]; 4], dilatation: &[[f64; 2]; 4]) -> StrainColumns {
    let mut columns = [[0.0; 4]; 8];
    for (a, ([gx, gy], [x, y])) in gradients.iter().zip(dilatation).enumerate() {
        let [cx, cy] = [(x - gx) / 3.0, (y - gy) / 3.0];
        columns[2 * a] = [gx + cx, cx, cx, *gy];
        columns[2 * a + 1] = [cy, gy + cy, cy, *gx];
    }
    columns
}

/// The means over the element of the gradients at `points`, each with its weight: `∫ ∂N_a/∂x_c / V`.
/// With 2 × 2 Gauss points both integrals are exact for any quadrilateral: gradient times
/// determinant, and the determinant itself, are polynomials of at most second degree in each of ξ
/// and η.
pub(super) fn mean_gradients(points: &[([[f64; 2]; 4], f64); 4]) -> [[f64; 2]; 4] {
    let volume: f64 = points.iter().map(|(_, weight)| weight).sum();
    let mut mean = [[0.0; 2]; 4];
    for (gradients, weight) in points {
        for (mean, gradient) in mean.iter_mut().zip(gradients) {
            for c in 0..2 {
                mean[c] += weight / volume * gradient[c];
            }
        }
    }
    mean
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::fem::{GAUSS_2X2, gradients};

    const DISTORTED: [[f64; 2]; 4] = [[0.0, 0.0], [2.0, 0.3], [1.7, 1.4], [-0.2, 1.1]];

    /// By Gauss's theorem, `∫ ∂N_a/∂x_c` is half the normal of the two edges at corner `a`, that is
    /// of the diagonal between its neighbours.
    #[test]
    fn the_mean_is_exact_on_a_distorted_element() {
        let points = GAUSS_2X2.map(|point| gradients(point, &DISTORTED));
        let volume: f64 = points.iter().map(|(_, det)| det).sum();
        for (a, mean) in mean_gradients(&points).iter().enumerate() {
            let [next, last] = [DISTORTED[(a + 1) % 4], DISTORTED[(a + 3) % 4]];
            let exact = [0.5 * (next[1] - last[1]), -0.5 * (next[0] - last[0])];
            for c in 0..2 {
                assert!((mean[c] * volume - exact[c]).abs() < 1e-15, "{mean:?} {exact:?}");
            }
        }
    }

    #[test]
    fn only_the_trace_is_replaced() {
        let points = GAUSS_2X2.map(|point| gradients(point, &DISTORTED));
        let mean = mean_gradients(&points);
        for (g, _) in &points {
            let (plain, bar) = (strain_columns(g, g), strain_columns(g, &mean));
            for (k, (plain, bar)) in plain.iter().zip(bar).enumerate() {
                assert_eq!(plain[2].to_bits(), 0);
                assert!((bar[..3].iter().sum::<f64>() - mean[k / 2][k % 2]).abs() < 1e-15);
                assert!((bar[0] - bar[1] - (plain[0] - plain[1])).abs() < 1e-15);
                assert_eq!(bar[3].to_bits(), plain[3].to_bits());
            }
        }
    }
}
