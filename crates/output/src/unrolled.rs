//! Contact surfaces around an axis, such as a bore or a shaft: the plane into which they are unrolled.

use stickslip::algebra::{across, axis, axis_across, cross, dot, minus, norm, plus, unit};

/// Facets whose normals differ by more than this angle do not show themselves in one view: the cosine of 78 degrees. A
/// quarter of a bore has them.
const ROUND: f64 = 0.2;
/// A surface is around its axis if its normals are across it, and the radii of its facets equal, up to this share.
const OFF: f64 = 0.1;
/// A surface that leaves more than this angle open is not closed around its axis.
const OPEN: f64 = 0.6;
/// Two angles are equal up to this, rad.
const EQUAL: f64 = 1e-6;

const TURN: f64 = 2.0 * std::f64::consts::PI;

/// The centre (m) and the area vector (m²) of a facet.
type Facet = ([f64; 3], [f64; 3]);

/// A cylinder with the plane into which it is unrolled: to the right the arc, upwards the position along the axis.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Cylinder {
    pub axis: [f64; 3],
    centre: [f64; 3],
    pub radius: f64,
    /// The directions of the angles 0 and 90 degrees.
    pub zero: [[f64; 3]; 2],
    /// The least angle, rad.
    start: f64,
}

impl Cylinder {
    /// Returns the cylinder of a surface, given by its facets and their nodes
    /// (m); `None` if one view shows all of it, or if it is no cylinder.
    pub(super) fn of(facets: &[Facet], nodes: &[[f64; 3]]) -> Option<Self> {
        let normals: Vec<[f64; 3]> = facets.iter().map(|(_, area)| unit(*area)).collect();
        let (first, last) = (normals.first()?, nodes.first()?);
        // The first of those that are most across the first one.
        let most = normals.iter().map(|normal| norm(cross(*first, *normal))).fold(0.0, f64::max);
        let other = normals.iter().find(|normal| norm(cross(*first, **normal)) >= (1.0 - EQUAL) * most)?;
        let is_round = normals.iter().any(|a| dot(*a, *first) < ROUND)
            || normals.iter().any(|a| normals.iter().step_by(normals.len().div_ceil(50)).any(|b| dot(*a, *b) < ROUND));
        if !is_round || most < OFF {
            return None;
        }
        let along = upright(unit(cross(*first, *other)));
        if normals.iter().any(|normal| dot(*normal, along).abs() > OFF) {
            return None;
        }
        let second = (0..3).find(|&c| along[c].abs() < 0.8).map(|c| axis_across(c, along))?;
        let zero = [second, cross(along, second)];
        let centre = centre(facets, zero, *last)?;
        let radius = |x: [f64; 3]| norm(across(minus(x, centre), along));
        let radii: Vec<f64> = nodes.iter().map(|x| radius(*x)).collect();
        let mean = radii.iter().sum::<f64>() / radii.len() as f64;
        if radii.iter().any(|radius| (radius - mean).abs() > OFF * mean) {
            return None;
        }
        let mut cylinder = Cylinder { axis: along, centre, radius: mean, zero, start: -0.5 * TURN };
        cylinder.start = cylinder.start(nodes);
        Some(cylinder)
    }

    /// Returns the end of the widest angle without nodes; -180 degrees if the surface is closed.
    fn start(&self, nodes: &[[f64; 3]]) -> f64 {
        let mut angles: Vec<f64> = nodes.iter().map(|x| self.angle(*x)).collect();
        angles.sort_by(f64::total_cmp);
        let round = angles.first().map(|first| first + TURN);
        let gaps = angles.iter().zip(angles.iter().skip(1).copied().chain(round)).map(|(a, b)| (b - a, b));
        match gaps.max_by(|a, b| a.0.total_cmp(&b.0)) {
            Some((gap, end)) if gap > OPEN => end - if end >= 0.5 * TURN { TURN } else { 0.0 },
            _ => self.start,
        }
    }

    /// Returns the angle of a point, rad, from the start up to a whole turn more.
    pub(super) fn angle(&self, x: [f64; 3]) -> f64 {
        let [a, b] = self.zero.map(|direction| dot(minus(x, self.centre), direction));
        (b.atan2(a) - self.start + EQUAL).rem_euclid(TURN) - EQUAL + self.start
    }

    /// Returns the position in the plane, m, of a point at this angle (rad).
    pub(super) fn at(&self, angle: f64, x: [f64; 3]) -> [f64; 2] {
        [self.radius * angle, dot(x, self.axis)]
    }

    /// Returns the components of a vector at a point along the arc and along the axis.
    pub(super) fn along(&self, x: [f64; 3], v: [f64; 3]) -> [f64; 2] {
        let outwards = unit(across(minus(x, self.centre), self.axis));
        [dot(v, cross(self.axis, outwards)), dot(v, self.axis)]
    }
}

/// Returns the point nearest to the lines along the normals of all facets, by its coordinates across the axis.
fn centre(facets: &[Facet], plane: [[f64; 3]; 2], any: [f64; 3]) -> Option<[f64; 3]> {
    let (mut matrix, mut right) = ([[0.0; 2]; 2], [0.0; 2]);
    for (point, area) in facets {
        let aside = plane.map(|direction| dot(*area, direction));
        let (aside, from) = ([-aside[1], aside[0]], plane.map(|direction| dot(minus(*point, any), direction)));
        let distance = aside[0] * from[0] + aside[1] * from[1];
        for k in 0..2 {
            right[k] += aside[k] * distance;
            (0..2).for_each(|l| matrix[k][l] += aside[k] * aside[l]);
        }
    }
    let [[a, b], [c, d]] = matrix;
    let det = a * d - b * c;
    if det.abs() <= 1e-9 * (a + d) * (a + d) {
        return None;
    }
    let solved = [(d * right[0] - b * right[1]) / det, (a * right[1] - c * right[0]) / det];
    Some(plus(plus(any, solved[0], plane[0]), solved[1], plane[1]))
}

/// Turns a unit vector so that its largest component is positive; a coordinate axis within rounding is that axis.
fn upright(v: [f64; 3]) -> [f64; 3] {
    let steepest = (0..3).fold(0, |best, c| if v[c].abs() > v[best].abs() + EQUAL { c } else { best });
    if v[steepest].abs() > 1.0 - EQUAL {
        return axis(steepest);
    }
    let sign = v[steepest].signum();
    v.map(|c| sign * c + 0.0)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The facets and the nodes of a part of a bore of radius 2 about an axis along y through (1, 0, 3).
    fn bore(from: f64, to: f64, n: usize) -> (Vec<Facet>, Vec<[f64; 3]>) {
        let at = |k: f64| (from + (to - from) * k / n as f64).to_radians();
        let point = |k: f64, y: f64| [1.0 + 2.0 * at(k).cos(), y, 3.0 + 2.0 * at(k).sin()];
        let facet = |k: usize| {
            let middle = at(k as f64 + 0.5);
            (point(k as f64 + 0.5, 0.5), [-middle.cos(), 0.0, -middle.sin()])
        };
        let nodes = (0..=n).flat_map(|k| [0.0, 1.0].map(|y| point(k as f64, y)));
        ((0..n).map(facet).collect(), nodes.collect())
    }

    #[test]
    fn a_bore_is_unrolled_about_its_axis() {
        for (from, to) in [(0.0, 90.0), (100.0, 260.0), (0.0, 360.0), (-150.0, 120.0)] {
            let (facets, nodes) = bore(from, to, 18);
            let cylinder = Cylinder::of(&facets, &nodes).unwrap();
            assert!(cylinder.axis == [0.0, 1.0, 0.0] && (cylinder.radius - 2.0).abs() < 1e-9, "{cylinder:?}");
            // A connected surface stays connected.
            let angles: Vec<f64> = nodes.iter().map(|x| cylinder.angle(*x)).collect();
            let [low, high] = [f64::min, f64::max].map(|f| angles.iter().copied().reduce(f).unwrap());
            let open = if to - from < 360.0 { 0.0 } else { 20.0 };
            assert!((high - low).to_degrees() <= to - from - open + 1e-6, "{from} {to}: {low} {high}");
            assert_eq!(cylinder.at(0.5, [9.0, 7.0, 9.0]), [0.5 * cylinder.radius, 7.0]);
            let along = cylinder.along([3.0, 0.0, 3.0], [0.0, 5.0, -4.0]);
            assert!((along[0].abs() - 4.0).abs() < 1e-9 && along[1] == 5.0, "{along:?}");
        }
        // One view shows an eighth of it, and a sphere has no axis.
        let (facets, nodes) = bore(0.0, 45.0, 18);
        assert_eq!(Cylinder::of(&facets, &nodes), None);
        let directions = [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]];
        assert_eq!(Cylinder::of(&directions.map(|n| (n, n)), &directions), None);
    }
}
