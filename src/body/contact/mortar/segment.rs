//! Segments: the part of a slave facet that a master facet covers, and the integration points there.

use super::facet::{Flat, Projected, Values};
use crate::body::mesh::GAUSS3;

/// A common part counts as rounding if it is smaller than this share of the slave facet.
const NO_PART: f64 = 1e-12;

/// A point of a segment.
pub(super) struct Point {
    /// Length (m) or area (m²) in the plane of the slave facet.
    pub weight: f64,
    /// The shape functions of both facets.
    pub slave: Values,
    pub master: Values,
    /// The distance from the slave to the master along the normal of the slave, m.
    pub gap: f64,
}

/// Six Gauss points on [0, 1].
const GAUSS6: [(f64, f64); 6] = [
    (0.033_765_242_898_423_99, 0.085_662_246_189_585_17),
    (0.169_395_306_766_867_74, 0.180_380_786_524_069_3),
    (0.380_690_406_958_401_55, 0.233_956_967_286_345_52),
    (0.619_309_593_041_598_5, 0.233_956_967_286_345_52),
    (0.830_604_693_233_132_3, 0.180_380_786_524_069_3),
    (0.966_234_757_101_576, 0.085_662_246_189_585_17),
];

/// The integration points of a triangle in barycentric coordinates, with weights that add up to 1.
pub(super) struct Rules {
    /// Exact for polynomials of degree five (Radon).
    straight: Vec<([f64; 3], f64)>,
    /// Exact for degree ten, for bent facets, where local coordinates raise the degree of polynomials, and for
    /// quadrilaterals of eight nodes, whose functions are cubic.
    bent: Vec<([f64; 3], f64)>,
}

impl Rules {
    pub(super) fn new() -> Self {
        let root = 15.0_f64.sqrt();
        let orbit = |a: f64, weight: f64| {
            let far = 1.0 - 2.0 * a;
            [([a, a, far], weight), ([a, far, a], weight), ([far, a, a], weight)]
        };
        let mut straight = vec![([1.0 / 3.0; 3], 0.225)];
        straight.extend(orbit((6.0 - root) / 21.0, (155.0 - root) / 1200.0));
        straight.extend(orbit((6.0 + root) / 21.0, (155.0 + root) / 1200.0));
        let bent = GAUSS6
            .into_iter()
            .flat_map(|(a, w_a)| GAUSS6.map(|(b, w_b)| ([1.0 - a, a * (1.0 - b), a * b], 2.0 * w_a * w_b * a)));
        Rules { straight, bent: bent.collect() }
    }
}

/// Returns the length or area of a facet in its own plane, m or m².
pub(super) fn size(dimension: usize, facet: &Projected) -> f64 {
    if dimension == 2 {
        let [from, to] = facet.ends();
        return (to - from).abs();
    }
    facet.polygons().iter().map(|polygon| area(polygon)).sum()
}

/// The common part of a slave facet and a master facet.
#[derive(Default)]
pub(super) struct Segment {
    /// The integration points; none if the facets have no common part.
    pub points: Vec<Point>,
    /// The side on which a point was not found, because its facet is bent too much. Then points are missing.
    pub too_bent: Option<Side>,
}

/// One of the two boundaries.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Side {
    Slave,
    Master,
}

/// Computes the common part of a slave facet of this `size` and a master facet.
pub(super) fn segment(dimension: usize, slave: &Projected, size: f64, master: &Projected, rules: &Rules) -> Segment {
    let places = if dimension == 2 {
        overlap(slave, size, master)
    } else {
        common(slave, size, master, if slave.is_of_low_degree(master) { &rules.straight } else { &rules.bent })
    };
    let mut segment = Segment::default();
    for (y, weight) in places {
        match (slave.shape_at(y), master.shape_at(y)) {
            (Some(of_slave), Some(of_master)) => {
                let gap = master.height(&of_master) - slave.height(&of_slave);
                segment.points.push(Point { weight, slave: of_slave, master: of_master, gap });
            }
            (None, _) => segment.too_bent = Some(Side::Slave),
            (_, None) => segment.too_bent = Some(Side::Master),
        }
    }
    segment
}

/// Returns the integration points of the common part of two lines.
fn overlap(slave: &Projected, size: f64, master: &Projected) -> Vec<(Flat, f64)> {
    let ([a, b], [c, d]) = (slave.ends(), master.ends());
    let (from, to) = (a.min(b).max(c.min(d)), a.max(b).min(c.max(d)));
    if to - from > NO_PART * size {
        let (middle, half) = (0.5 * (from + to), 0.5 * (to - from));
        GAUSS3.map(|(x, weight)| ([middle + x * half, 0.0], weight * half)).into()
    } else {
        Vec::new()
    }
}

/// Returns the integration points of the common part of two plane facets, polygon by polygon.
fn common(slave: &Projected, size: f64, master: &Projected, rule: &[([f64; 3], f64)]) -> Vec<(Flat, f64)> {
    let counterclockwise = |polygon: &Vec<Flat>| area(polygon) > 0.0;
    // A facet that faces the slave has the opposite orientation.
    let turned = |polygon: Vec<Flat>| polygon.into_iter().rev().collect::<Vec<Flat>>();
    let masters: Vec<Vec<Flat>> = master.polygons().into_iter().map(turned).filter(counterclockwise).collect();
    let mut places = Vec::new();
    for window in slave.polygons().into_iter().filter(counterclockwise) {
        for polygon in &masters {
            let part = clip(polygon.clone(), &window);
            if area(&part) > NO_PART * size {
                add_fan(&part, rule, &mut places);
            }
        }
    }
    places
}

/// Adds the integration points of the triangles that a polygon forms with its middle.
fn add_fan(polygon: &[Flat], rule: &[([f64; 3], f64)], places: &mut Vec<(Flat, f64)>) {
    let middle = [0, 1].map(|c| polygon.iter().map(|x| x[c]).sum::<f64>() / polygon.len() as f64);
    let whole = area(polygon);
    for (k, &a) in polygon.iter().enumerate() {
        let b = polygon[(k + 1) % polygon.len()];
        let triangle = area(&[middle, a, b]);
        // Triangles of coincident corners are left out.
        if triangle > NO_PART * whole {
            let at = |l: &[f64; 3]| [0, 1].map(|c| l[0] * middle[c] + l[1] * a[c] + l[2] * b[c]);
            places.extend(rule.iter().map(|(l, weight)| (at(l), weight * triangle)));
        }
    }
}

/// Computes the area of a polygon, positive if it is counterclockwise.
fn area(polygon: &[Flat]) -> f64 {
    let Some(&[x, y]) = polygon.first() else { return 0.0 };
    let next = polygon.iter().skip(1);
    0.5 * polygon.iter().zip(next).map(|(a, b)| (a[0] - x) * (b[1] - y) - (b[0] - x) * (a[1] - y)).sum::<f64>()
}

/// Clips a polygon to a convex counterclockwise `window` (Sutherland and Hodgman 1974).
fn clip(polygon: Vec<Flat>, window: &[Flat]) -> Vec<Flat> {
    let mut part = polygon;
    for (k, a) in window.iter().enumerate() {
        let b = window[(k + 1) % window.len()];
        let side = |x: &Flat| (b[0] - a[0]) * (x[1] - a[1]) - (b[1] - a[1]) * (x[0] - a[0]);
        let mut inside = Vec::with_capacity(part.len() + 1);
        let Some(mut last) = part.last().copied() else { return part };
        let mut last_side = side(&last);
        for x in part {
            let x_side = side(&x);
            if (x_side >= 0.0) != (last_side >= 0.0) {
                let share = last_side / (last_side - x_side);
                inside.push([0, 1].map(|c| last[c] + (x[c] - last[c]) * share));
            }
            if x_side >= 0.0 {
                inside.push(x);
            }
            (last, last_side) = (x, x_side);
        }
        part = inside;
    }
    part
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn polygons_are_clipped() {
        let square = [[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0]];
        let moved = |d: Flat| square.map(|x| [x[0] + d[0], x[1] + d[1]]).to_vec();
        assert_eq!(area(&clip(moved([0.0, 0.0]), &square)), 1.0);
        assert_eq!(area(&clip(moved([0.25, 0.5]), &square)), 0.375);
        assert_eq!(area(&clip(moved([1.0, 0.0]), &square)), 0.0);
        assert!(clip(moved([1.5, 0.0]), &square).is_empty());
        let diamond = vec![[0.5, -0.25], [1.25, 0.5], [0.5, 1.25], [-0.25, 0.5]];
        let part = clip(diamond, &square);
        assert!(part.len() == 8 && (area(&part) - 0.875).abs() < 1e-15, "{part:?}");
    }

    /// `∫ x^a y^b = a! b! / (a + b + 2)!` over the unit triangle.
    #[test]
    fn rules_are_exact() {
        let rules = Rules::new();
        let factorial = |n: i32| (1..=n).map(f64::from).product::<f64>();
        for (rule, degree) in [(&rules.straight, 5), (&rules.bent, 10)] {
            for (a, b) in (0..=degree).flat_map(|a| (0..=degree - a).map(move |b| (a, b))) {
                let sum: f64 = rule.iter().map(|([_, x, y], w)| 0.5 * w * x.powi(a) * y.powi(b)).sum();
                let exact = factorial(a) * factorial(b) / factorial(a + b + 2);
                assert!((sum - exact).abs() < 1e-15, "{a} {b}");
            }
        }
    }
}
