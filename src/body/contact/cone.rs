//! A circular cone.

use crate::algebra::vector::{across, cross, dot, minus, norm, plus};

/// The points `x` with `r ≤ z tan α`, where `z` is the distance of `x` from the tip along the axis and `r` its distance
/// from the axis.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct SolidCone {
    /// The tip, m.
    pub apex: [f64; 3],
    /// Unit vector from the tip into the cone.
    pub axis: [f64; 3],
    /// α, the angle between axis and surface, rad.
    pub half_angle: f64,
}

impl SolidCone {
    /// Returns `z` and the vector of length `r` from the axis.
    fn split(&self, from: [f64; 3]) -> (f64, [f64; 3]) {
        (dot(from, self.axis), across(from, self.axis))
    }

    /// Returns the distance (m) from `x` to the point where the line along the unit vector `n` enters the cone,
    /// negative inside; NaN if the line does not enter the cone or leaves it before `x`.
    pub(super) fn along(&self, x: [f64; 3], n: [f64; 3]) -> f64 {
        let cot = 1.0 / self.half_angle.tan();
        let ((z, q), (n_z, n_q)) = (self.split(minus(x, self.apex)), self.split(n));
        // (z + g n_z)² = cot² |q + g n_q|², hence a g² + 2 b g + c = 0. The equation holds on the cone behind the tip
        // and on its mirror image in front, which is not part of the obstacle.
        let a = n_z * n_z - cot * cot * dot(n_q, n_q);
        let b = z * n_z - cot * cot * dot(q, n_q);
        let c = z * z - cot * cot * dot(q, q);
        // b² - a c without cancellation.
        let (lean, twist) = (plus(q.map(|q| n_z * q), -z, n_q), cross(q, n_q));
        let root = cot * (dot(lean, lean) - cot * cot * dot(twist, twist)).sqrt();
        let entry = if b > 0.0 { -c / (b + root) } else { (root - b) / a };
        // A line that leans less than the surface meets each of the two cones once, the one behind the tip later. Any
        // other line crosses one of them twice; that cone is behind `x` if both intersections are.
        let behind = c < 0.0 && b < 0.0;
        let enters = if a > 0.0 { n_z > 0.0 } else { z + entry * n_z > 0.0 && !behind };
        if enters && entry.is_finite() { entry } else { f64::NAN }
    }

    /// Returns `true` if `x` (m) is inside.
    pub(super) fn contains(&self, x: [f64; 3]) -> bool {
        let (z, q) = self.split(minus(x, self.apex));
        norm(q) < z * self.half_angle.tan()
    }

    /// Returns a vector into the cone, normal to its surface at `foot`.
    pub(super) fn inward(&self, foot: [f64; 3]) -> [f64; 3] {
        let (_, q) = self.split(minus(foot, self.apex));
        let r = norm(q);
        let (sin, cos) = self.half_angle.sin_cos();
        if r > 0.0 { plus(self.axis.map(|c| sin * c), -cos / r, q) } else { self.axis }
    }

    /// Returns the distance (m) from `x` to the nearest point of the surface, negative inside, and the unit vector of
    /// its direction.
    pub(super) fn nearest(&self, x: [f64; 3]) -> (f64, [f64; 3]) {
        let from = minus(x, self.apex);
        let (z, q) = self.split(from);
        let (r, (sin, cos)) = (norm(q), self.half_angle.sin_cos());
        if r * sin + z * cos >= 0.0 && r > 0.0 {
            return (r * cos - z * sin, self.inward(x));
        }
        // The tip is the nearest point. On the axis inside the cone, all directions are equally near.
        let distance = norm(from);
        if r > 0.0 || z < 0.0 { (distance, from.map(|c| -c / distance)) } else { (-z, self.axis) }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// For every direction the line ends on the surface, and the point before its end is outside.
    #[test]
    fn lines_end_where_they_enter() {
        let cone = SolidCone { apex: [0.1, -0.2, 0.3], axis: [0.0, 0.6, 0.8], half_angle: 0.7 };
        let depth = |x: [f64; 3]| {
            let (z, q) = cone.split(minus(x, cone.apex));
            z * cone.half_angle.tan() - norm(q)
        };
        let (mut met, mut missed) = (0, 0);
        for k in 0..2000_u32 {
            let [a, b, c, d] = [3, 5, 7, 11].map(|p| f64::from(k * p % 101) / 50.0 - 1.0);
            let n = crate::algebra::vector::unit([0.3 * a, 0.6 + 0.9 * b, 0.8 + 0.9 * c]);
            let x = plus([c, d, a], -2.0, n);
            let entry = cone.along(x, n);
            let at = |g: f64| depth(plus(x, g, n));
            if entry.is_nan() {
                missed += 1;
                assert!((-200..400).all(|g| at(f64::from(g) / 50.0) < 1e-9), "{x:?} {n:?}");
            } else {
                met += 1;
                assert!(at(entry).abs() < 1e-10 * (1.0 + entry.abs()), "{x:?} {n:?}: {entry} {}", at(entry));
                assert!(at(entry - 1e-3) < 0.0 && at(entry + 1e-3) > -1e-9, "{x:?} {n:?}");
            }
        }
        assert!(met > 500 && missed > 200, "{met} {missed}");
    }
}
