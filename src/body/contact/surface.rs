//! The surfaces of rigid obstacles and their distances from points.

use std::sync::Arc;

use super::description::SKEW;
use super::gap_table::GapTable;
use super::triangles::Triangles;
use crate::algebra::vector::{across, cross, dot, minus, norm, plus, unit};
use crate::base::formula::Formula;

/// The surface of an obstacle at rest. `facing` is the unit vector out of the body towards the obstacle,
/// `N` below.
#[derive(Debug, Clone, PartialEq)]
pub(super) enum Surface {
    /// All points with `N·x = level + gap`. The two numbers are kept apart so that a small gap keeps its digits.
    Plane { level: f64, gap: f64 },
    /// A cylinder about `axis` (unit vector), or a sphere if there is none; its nearest point along `N` is `apex`. If
    /// the radius is negative, the body is inside and the centre is on the other side of the apex.
    Round { radius: f64, apex: [f64; 3], axis: Option<[f64; 3]> },
    /// A cone.
    Cone(SolidCone),
    /// Two half-planes from a ridge through `apex`, to both sides along `aside` (unit vector). Each leans away from the
    /// body by the angle with the tangent `slope`.
    Wedge { apex: [f64; 3], aside: [f64; 3], slope: f64 },
    /// Gaps along `N` from a formula of the position.
    Formula(Formula),
    /// Gaps along `N` from a table.
    Table(GapTable),
    /// Triangles.
    Triangles(Arc<Triangles>),
}

/// The rounding error of a direction, or of a length as a share of the coordinates that are subtracted: a few units in
/// the last place.
const DIRECTION_ROUNDING: f64 = 8.0 * f64::EPSILON;

impl Surface {
    /// Returns the distance (m) from `x` to the point where a line along the unit vector `n` enters the obstacle,
    /// negative if `x` is inside. NaN if the line misses or only grazes the obstacle, only leaves it (for example
    /// because the obstacle has turned its back), or has left it before `x`. Only fields of gaps need `reference`, the
    /// reference position of the point at `x`, since they are functions of reference positions, along `facing`.
    pub(super) fn along(&self, facing: [f64; 3], x: [f64; 3], n: [f64; 3], reference: [f64; 3]) -> f64 {
        match self {
            Surface::Plane { level, gap } => {
                let closing = dot(facing, n);
                if closing > GRAZING { (gap + (level - dot(facing, x))) / closing } else { f64::NAN }
            }
            Surface::Round { radius, apex, axis } => {
                // A line that leans along the axis of a cylinder is longer than its projection.
                let leaning = axis.filter(|axis| dot(*axis, n) != 0.0);
                let shadow = leaning.map_or(n, |axis| across(n, axis));
                let length = leaning.map_or(1.0, |_| norm(shadow));
                let n = shadow.map(|c| c / length);
                // The nearest point along n is R (N - n) from the apex, and R (n·N - 1) = -½ R |N - n|² along n.
                let lean = minus(facing, n);
                let flat = |a: [f64; 3]| axis.map_or(a, |axis| across(a, axis));
                let to_apex = flat(minus(x, *apex));
                let along = dot(to_apex, n) + 0.5 * radius * dot(lean, lean);
                let from = plus(to_apex, -radius, lean);
                let aside = across(from, n);
                let aside = dot(aside, aside);
                // At its side the surface is parallel to the line, and the gap is undefined.
                if aside >= radius * radius {
                    return f64::NAN;
                }
                // R - √(R² - s²), without cancellation for small s.
                let half_chord = (radius * radius - aside).sqrt();
                let sagitta = aside / (radius.abs() + half_chord);
                let entry = radius.signum() * sagitta - along;
                let behind = *radius > 0.0 && entry + 2.0 * half_chord < 0.0;
                if behind { f64::NAN } else { entry / length }
            }
            Surface::Cone(cone) => cone.along(x, n),
            Surface::Wedge { apex, aside, slope } => {
                let from = minus(x, *apex);
                let (mut entry, mut exit) = (f64::NEG_INFINITY, f64::INFINITY);
                for side in [1.0, -1.0] {
                    // A vector into the obstacle, normal to the face; its length does not matter.
                    let inward = plus(facing, -side * slope, *aside);
                    let (closing, outside) = (dot(inward, n), -dot(inward, from));
                    match closing {
                        0.0 if outside > 0.0 => exit = f64::NEG_INFINITY,
                        0.0 => {}
                        _ if closing > 0.0 => entry = entry.max(outside / closing),
                        _ => exit = exit.min(outside / closing),
                    }
                }
                if entry.is_finite() && entry <= exit && exit >= 0.0 { entry } else { f64::NAN }
            }
            Surface::Formula(_) | Surface::Table(_) if n == facing => self.above(facing, x, reference),
            Surface::Formula(_) | Surface::Table(_) => {
                crossing(|s| self.above(facing, plus(x, s, n), reference), dot(facing, n))
            }
            Surface::Triangles(triangles) => triangles.entry(x, n).map_or(f64::NAN, |entry| entry.distance),
        }
    }

    /// Returns the distance (m) of the surface of a field of gaps from `x` along `facing`, like [`Surface::along`]; NaN
    /// where the field has no value.
    fn above(&self, facing: [f64; 3], x: [f64; 3], reference: [f64; 3]) -> f64 {
        let moved = minus(x, reference);
        let base = plus(reference, 1.0, across(moved, facing));
        let gap = match self {
            Surface::Formula(formula) => formula.at(base),
            Surface::Table(table) => table.at(base),
            _ => f64::NAN,
        };
        gap - dot(moved, facing)
    }

    /// Returns `true` if a point at `x`, for which [`Surface::along`] the unit vector `n` is NaN, is inside the
    /// obstacle, so that its depth is undefined. Only closed surfaces of triangles have an inside, and a line from
    /// inside always has an entry.
    pub(super) fn swallows(&self, facing: [f64; 3], x: [f64; 3], n: [f64; 3], reference: [f64; 3]) -> bool {
        match self {
            Surface::Plane { level, gap } => gap + (level - dot(facing, x)) < 0.0,
            Surface::Round { radius, apex, axis } => {
                let flat = |a: [f64; 3]| axis.map_or(a, |axis| across(a, axis));
                let from_centre = norm(flat(minus(x, plus(*apex, *radius, facing))));
                // A line that misses a bore runs outside its cavity, unless it is parallel to the axis and on the wall
                // within rounding.
                let along_axis = norm(flat(n)) <= DIRECTION_ROUNDING;
                if *radius > 0.0 { from_centre < *radius } else { !along_axis || from_centre > -radius }
            }
            Surface::Cone(cone) => cone.contains(x),
            Surface::Wedge { apex, aside, slope } => {
                let from = minus(x, *apex);
                [1.0, -1.0].into_iter().all(|side| dot(plus(facing, -side * slope, *aside), from) > 0.0)
            }
            Surface::Formula(_) | Surface::Table(_) => self.above(facing, x, reference) < 0.0,
            Surface::Triangles(_) => false,
        }
    }

    /// Returns `true` for a bore or a socket: a line that misses it never leaves the obstacle.
    pub(super) fn surrounds(&self) -> bool {
        matches!(self, Surface::Round { radius, .. } if *radius < 0.0)
    }

    /// Returns `true` if it is round about an axis at right angles to the unit vector `tangent`.
    pub(super) fn goes_round_along(&self, tangent: [f64; 3]) -> bool {
        matches!(self, Surface::Round { axis: Some(axis), .. } if dot(*axis, tangent).abs() <= SKEW)
    }

    /// Returns `true` if a rotation about the unit vector `axis` through the point `through` (m) maps the surface to
    /// itself, within the rounding of both.
    pub(super) fn is_the_same_about(&self, facing: [f64; 3], axis: [f64; 3], through: [f64; 3]) -> bool {
        let parallel = |a: [f64; 3]| norm(cross(a, axis)) <= DIRECTION_ROUNDING;
        match self {
            Surface::Plane { .. } => parallel(facing),
            Surface::Round { radius, apex, axis: own } => {
                let to_centre = minus(plus(*apex, *radius, facing), through);
                let off = own.map_or(to_centre, |own| across(to_centre, own));
                own.is_none_or(parallel)
                    && norm(off) <= DIRECTION_ROUNDING * (radius.abs() + norm(*apex) + norm(through))
            }
            Surface::Cone(cone) => {
                let off = across(minus(cone.apex, through), axis);
                parallel(cone.axis) && norm(off) <= DIRECTION_ROUNDING * (norm(cone.apex) + norm(through))
            }
            _ => false,
        }
    }

    /// Returns a vector into the obstacle, normal to the surface at the point where the line from `x` along the unit
    /// vector `n` meets it after `gap` (m). The slopes of fields are finite differences over `step` (m) along
    /// `tangents`.
    pub(super) fn inward(
        &self,
        [facing, tangents @ ..]: [[f64; 3]; 3],
        x: [f64; 3],
        (gap, n): (f64, [f64; 3]),
        step: f64,
    ) -> [f64; 3] {
        let foot = plus(x, gap, n);
        match self {
            Surface::Plane { .. } => facing,
            Surface::Round { radius, apex, axis } => {
                let to_centre = minus(plus(*apex, *radius, facing), foot).map(|c| radius.signum() * c);
                axis.map_or(to_centre, |axis| across(to_centre, axis))
            }
            Surface::Cone(cone) => cone.inward(foot),
            Surface::Triangles(triangles) => {
                triangles.entry(x, n).map_or(facing, |entry| triangles.normals[entry.triangle].map(|c| -c))
            }
            Surface::Wedge { apex, aside, slope } => {
                let side = if dot(minus(foot, *apex), *aside) < 0.0 { -1.0 } else { 1.0 };
                plus(facing, -side * slope, *aside)
            }
            Surface::Formula(_) | Surface::Table(_) => tangents.into_iter().fold(facing, |inward, tangent| {
                let at = |s: f64| {
                    let x = plus(x, s, tangent);
                    self.along(facing, x, facing, x)
                };
                let (before, here, after) = (at(-step), at(0.0), at(step));
                // At the rim of a table, one side has no gap, and a one-sided difference is used. Without any finite
                // difference the slope is 0.
                let slopes = [(after - before) / (2.0 * step), (after - here) / step, (here - before) / step];
                let slope = slopes.into_iter().find(|slope| slope.is_finite()).unwrap_or(0.0);
                plus(inward, -slope, tangent)
            }),
        }
    }

    /// Returns the distance (m) from `x` to the nearest point of the surface, negative inside, and the unit vector of
    /// its direction; NaN and `facing` beyond the rim of a bounded surface.
    pub(super) fn nearest(&self, facing: [f64; 3], x: [f64; 3]) -> (f64, [f64; 3]) {
        match self {
            Surface::Round { radius, apex, axis } => {
                let flat = |a: [f64; 3]| axis.map_or(a, |axis| across(a, axis));
                let from = flat(minus(x, *apex));
                let to_centre = plus([0.0; 3], -1.0, plus(from, -radius, facing));
                let distance = norm(to_centre);
                // |q| - R = (|q|² - R²) / (|q| + R), without cancellation near the surface.
                let gap = (dot(from, from) - 2.0 * radius * dot(from, facing)) / (distance + radius.abs());
                // At the centre, all points are equally near.
                let normal =
                    if distance > 0.0 { to_centre.map(|c| radius.signum() * c / distance + 0.0) } else { facing };
                (radius.signum() * gap, normal)
            }
            Surface::Cone(cone) => cone.nearest(x),
            Surface::Triangles(triangles) => triangles.nearest(x).unwrap_or((f64::NAN, facing)),
            Surface::Wedge { apex, aside, slope } => {
                let from = minus(x, *apex);
                let side = if dot(from, *aside) < 0.0 { -1.0 } else { 1.0 };
                let inward = unit(plus(facing, -side * slope, *aside));
                let gap = -dot(inward, from);
                let foot = plus(from, gap, inward);
                if side * dot(foot, *aside) >= 0.0 {
                    return (gap, inward);
                }
                // In front of the ridge, the ridge is nearer than either face.
                let to_ridge = across(plus([0.0; 3], -1.0, from), unit(cross(facing, *aside)));
                let distance = norm(to_ridge);
                (distance, to_ridge.map(|c| c / distance))
            }
            _ => (self.along(facing, x, facing, x), facing),
        }
    }
}

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

/// The largest number of steps of the search. Each step at least doubles the previous step or halves the remaining
/// interval.
const MOST: usize = 200;

/// A line that approaches a surface by less than this share of its length counts as parallel to it; an intersection
/// would be millions of lengths away.
const GRAZING: f64 = 1e-6;

/// The relative rounding error of a position on the line.
const POSITION_ROUNDING: f64 = 2.0 * f64::EPSILON;

/// Returns the distance along a line at which it meets a surface. `height` is the signed distance of the surface from a
/// point of the line along the surface's own direction: positive before the surface, negative behind it. `closing` is
/// the cosine of the angle between both directions. If there are several intersections, the result is the one that the
/// iteration reaches, with steps that would end on a level surface. NaN if the line leads away from the surface or off
/// it, where the height is NaN.
pub(super) fn crossing(height: impl Fn(f64) -> f64, closing: f64) -> f64 {
    let (mut here, mut above) = (0.0, height(0.0));
    if closing <= GRAZING || above.is_nan() {
        return f64::NAN;
    }
    let (mut reach, mut ends) = (1.0 / closing, false);
    for _ in 0..MOST {
        let next = here + reach * above;
        if !next.is_finite() {
            return f64::NAN;
        }
        if above == 0.0 || (next - here).abs() <= POSITION_ROUNDING * next.abs() {
            // Steps that had to be shortened lead to the rim.
            return if ends { f64::NAN } else { here };
        }
        let there = height(next);
        if there.is_nan() {
            // The step left the surface; the line may meet it before.
            (reach, ends) = (0.5 * reach, true);
        } else if there * above <= 0.0 {
            return between(height, (here, above), (next, there));
        } else {
            (here, above) = (next, there);
            reach *= 2.0;
        }
    }
    f64::NAN
}

/// Finds the zero of `height` between two points with their heights, one positive and one not, by the Illinois method:
/// secants in which the height of a retained end is halved.
fn between(height: impl Fn(f64) -> f64, mut one: (f64, f64), mut other: (f64, f64)) -> f64 {
    for _ in 0..MOST {
        if other.1 == 0.0 || (other.0 - one.0).abs() <= POSITION_ROUNDING * other.0.abs() {
            break;
        }
        let next = other.0 - other.1 * (other.0 - one.0) / (other.1 - one.1);
        let there = height(next);
        if there.is_nan() {
            return f64::NAN;
        }
        if there * other.1 < 0.0 {
            one = other;
        } else {
            one.1 *= 0.5;
        }
        if next == other.0 {
            break;
        }
        other = (next, there);
    }
    other.0
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
        let (mut hits, mut missed) = (0, 0);
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
                hits += 1;
                assert!(at(entry).abs() < 1e-10 * (1.0 + entry.abs()), "{x:?} {n:?}: {entry} {}", at(entry));
                assert!(at(entry - 1e-3) < 0.0 && at(entry + 1e-3) > -1e-9, "{x:?} {n:?}");
            }
        }
        assert!(hits > 500 && missed > 200, "{hits} {missed}");
    }

    /// A line that leans by 30 degrees over a plane, a parabola, a roof and a step outside its path.
    #[test]
    fn the_places_where_a_line_ends() {
        let (sin, cos) = (0.5, 0.75_f64.sqrt());
        // From (x, 0) upwards to the side, to a surface at the height h(x).
        let hit = |x: f64, h: &dyn Fn(f64) -> f64| crossing(|s| h(x + s * sin) - s * cos, cos);
        let close = |a: f64, b: f64| (a - b).abs() <= 1e-15 * (1.0 + b.abs());
        assert!(close(hit(0.3, &|_| 0.7), 0.7 / cos));
        assert!(close(hit(0.3, &|_| -0.7), -0.7 / cos));
        assert_eq!(hit(0.3, &|_| 0.0), 0.0);
        // 1/2 + (s/2)² = s cos at the first of two places.
        assert!(close(hit(0.0, &|x| 0.5 + x * x), 2.0 * (cos - 0.25_f64.sqrt())));
        // A slope of 2 climbs faster than the line; downwards it is met.
        assert!(hit(0.0, &|x| 1.0 + 2.0 * x).is_nan());
        assert!(close(hit(0.0, &|x| 1.0 - 2.0 * x), 1.0 / (cos + 1.0)));
        assert!(close(hit(0.0, &|x| (x - 0.25).abs()), 0.25 / (cos + 0.5)));
        // There is no surface beyond 1, neither for the first step nor at the intersection.
        let ends = |h: f64| move |x: f64| if x < 1.0 { h - x } else { f64::NAN };
        assert!(close(hit(0.0, &ends(2.0)), 2.0 / (cos + 0.5)) && hit(0.0, &ends(9.0)).is_nan());
        assert!(crossing(|s| 1.0 + s, 0.0).is_nan() && crossing(|_| f64::NAN, 1.0).is_nan());
    }
}
