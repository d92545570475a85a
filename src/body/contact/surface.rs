//! The surfaces of rigid obstacles and their distances from points.

use std::sync::Arc;

use super::cone::SolidCone;
use super::crossing::{GRAZING, crossing};
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
                triangles.entry(x, n).map_or(facing, |entry| triangles.normal(entry.triangle).map(|c| -c))
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
