//! The facets of a pair as seen along a normal: shape functions in the order of the nodes of a facet, the local coordinates
//! of a point of the plane, and the part of a slave facet that a master facet covers.

use crate::algebra::vector::{cross, dot, minus, plus, unit};
use crate::body::mesh::{GAUSS3, Mesh};

/// The largest number of nodes of a facet.
pub(super) const MOST: usize = 8;

/// A value for each node of a facet; 0 beyond the last node.
pub(super) type Values = [f64; MOST];

/// A point of the plane; in two dimensions its second coordinate is 0.
pub(super) type Flat = [f64; 2];

/// A facet counts as curved if the middle node of an edge is off by more than this share of the edge; a quadrilateral,
/// if it deviates this much from a parallelogram. Rounding errors of coordinates are far smaller.
const STRAIGHT: f64 = 1e-10;

/// Newton's method stops if a step is shorter than this, in local coordinates.
const FOUND: f64 = 1e-14;

/// A place whose last step is longer is not found. Where it is, each step has twice the digits of the one before, and what rounding of
/// coordinates leaves is far less.
const LOST: f64 = 1e-6;

/// The nodes of a quadrilateral of second order in its local coordinates, all around.
const AROUND: [Flat; MOST] =
    [[-1.0, -1.0], [0.0, -1.0], [1.0, -1.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0], [-1.0, 1.0], [-1.0, 0.0]];

#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Kind {
    Edge,
    BentEdge,
    Triangle,
    Quadrilateral,
    BentTriangle,
    BentQuadrilateral,
}

impl Kind {
    pub(super) fn of(mesh: &Mesh, facet: &[usize]) -> Self {
        match (mesh.dimension, facet.len()) {
            (2, 3) => Kind::BentEdge,
            (2, _) => Kind::Edge,
            (_, 4) => Kind::Quadrilateral,
            (_, 6) => Kind::BentTriangle,
            (_, 8) => Kind::BentQuadrilateral,
            _ => Kind::Triangle,
        }
    }

    fn nodes(self) -> usize {
        match self {
            Kind::Edge => 2,
            Kind::BentEdge | Kind::Triangle => 3,
            Kind::Quadrilateral => 4,
            Kind::BentTriangle => 6,
            Kind::BentQuadrilateral => 8,
        }
    }

    fn centre(self) -> Flat {
        match self {
            Kind::Edge | Kind::BentEdge => [0.5, 0.0],
            Kind::Triangle | Kind::BentTriangle => [1.0 / 3.0; 2],
            Kind::Quadrilateral | Kind::BentQuadrilateral => [0.0; 2],
        }
    }

    /// Returns the shape functions at `[ξ, η]`: ξ goes from 0 to 1 along edges; a quadrilateral is the square [-1, 1]².
    fn shape(self, [x, y]: Flat) -> Values {
        let z = 1.0 - x - y;
        match self {
            Kind::Edge => filled([1.0 - x, x]),
            Kind::BentEdge => filled([(1.0 - x) * (1.0 - 2.0 * x), 4.0 * x * (1.0 - x), x * (2.0 * x - 1.0)]),
            Kind::Triangle => filled([z, x, y]),
            Kind::Quadrilateral => {
                let at = |a: f64, b: f64| 0.25 * (1.0 + a * x) * (1.0 + b * y);
                filled([at(-1.0, -1.0), at(1.0, -1.0), at(1.0, 1.0), at(-1.0, 1.0)])
            }
            Kind::BentTriangle => {
                let corner = |l: f64| l * (2.0 * l - 1.0);
                filled([corner(z), 4.0 * z * x, corner(x), 4.0 * x * y, corner(y), 4.0 * y * z])
            }
            Kind::BentQuadrilateral => AROUND.map(|[a, b]| match () {
                () if a == 0.0 => 0.5 * (1.0 - x * x) * (1.0 + b * y),
                () if b == 0.0 => 0.5 * (1.0 - y * y) * (1.0 + a * x),
                () => 0.25 * (1.0 + a * x) * (1.0 + b * y) * (a * x + b * y - 1.0),
            }),
        }
    }

    /// Returns the derivatives of the shape functions along ξ and along η.
    fn slopes(self, [x, y]: Flat) -> [Values; 2] {
        let z = 1.0 - x - y;
        match self {
            Kind::Edge => [filled([-1.0, 1.0]), [0.0; MOST]],
            Kind::BentEdge => [filled([4.0 * x - 3.0, 4.0 - 8.0 * x, 4.0 * x - 1.0]), [0.0; MOST]],
            Kind::Triangle => [filled([-1.0, 1.0, 0.0]), filled([-1.0, 0.0, 1.0])],
            Kind::Quadrilateral => [
                filled([-(1.0 - y), 1.0 - y, 1.0 + y, -(1.0 + y)].map(|c| 0.25 * c)),
                filled([-(1.0 - x), -(1.0 + x), 1.0 + x, 1.0 - x].map(|c| 0.25 * c)),
            ],
            Kind::BentTriangle => [
                filled([1.0 - 4.0 * z, 4.0 * (z - x), 4.0 * x - 1.0, 4.0 * y, 0.0, -4.0 * y]),
                filled([1.0 - 4.0 * z, -4.0 * x, 0.0, 4.0 * x, 4.0 * y - 1.0, 4.0 * (z - y)]),
            ],
            Kind::BentQuadrilateral => {
                let slopes = AROUND.map(|[a, b]| match () {
                    () if a == 0.0 => [-x * (1.0 + b * y), 0.5 * b * (1.0 - x * x)],
                    () if b == 0.0 => [0.5 * a * (1.0 - y * y), -y * (1.0 + a * x)],
                    () => [
                        0.25 * a * (1.0 + b * y) * (2.0 * a * x + b * y),
                        0.25 * b * (1.0 + a * x) * (2.0 * b * y + a * x),
                    ],
                });
                [0, 1].map(|c| slopes.map(|slope| slope[c]))
            }
        }
    }
}

/// Returns values with 0 beyond the last.
fn filled<const N: usize>(given: [f64; N]) -> Values {
    let mut values = [0.0; MOST];
    values[..N].copy_from_slice(&given);
    values
}

/// The plane of a facet (in two dimensions a line) and the normal along which other facets are projected on it.
#[derive(Debug)]
pub(super) struct Plane {
    origin: [f64; 3],
    /// Unit vectors at right angles to each other and to the normal; in two dimensions the second is 0.
    pub axes: [[f64; 3]; 2],
    /// The outward unit normal.
    pub normal: [f64; 3],
}

impl Plane {
    pub(super) fn of(mesh: &Mesh, facet: &[usize]) -> Self {
        let normal = unit(mesh.area_vector(facet));
        let points = mesh.points(facet);
        let origin = [0, 1, 2].map(|c| points.iter().map(|x| x[c]).sum::<f64>() / points.len() as f64);
        let axes = if mesh.dimension == 2 {
            [unit(minus(points[points.len() - 1], points[0])), [0.0; 3]]
        } else {
            let side = minus(points[if mesh.is_quadratic(facet) { 2 } else { 1 }], points[0]);
            let along = unit(plus(side, -dot(side, normal), normal));
            [along, cross(normal, along)]
        };
        Plane { origin, axes, normal }
    }

    pub(super) fn project(&self, mesh: &Mesh, facet: &[usize]) -> Projected {
        let kind = Kind::of(mesh, facet);
        let mut projected = Projected { kind, at: [[0.0; 2]; MOST], height: [0.0; MOST], straight: true };
        for (k, &node) in facet.iter().enumerate() {
            (projected.at[k], projected.height[k]) = self.coordinates(mesh.nodes[node]);
        }
        projected.straight = projected.is_straight();
        projected
    }

    /// Returns the place of `x` in the plane, and its distance from it, m.
    pub(super) fn coordinates(&self, x: [f64; 3]) -> (Flat, f64) {
        let from = minus(x, self.origin);
        (self.axes.map(|axis| dot(axis, from)), dot(self.normal, from))
    }
}

/// Returns the point of a facet with the shape functions `shape`, m.
pub(super) fn position(mesh: &Mesh, facet: &[usize], shape: &Values) -> [f64; 3] {
    [0, 1, 2].map(|c| facet.iter().zip(shape).map(|(&node, n)| n * mesh.nodes[node][c]).sum())
}

/// A facet, projected to a plane.
#[derive(Debug)]
pub(super) struct Projected {
    kind: Kind,
    /// The positions of its nodes in the plane, m.
    pub at: [Flat; MOST],
    /// The distances of its nodes from the plane, m.
    height: Values,
    /// `true` if the local coordinates are linear in the coordinates of the plane.
    pub straight: bool,
}

impl Projected {
    fn is_straight(&self) -> bool {
        let p = &self.at;
        let small = |off: Flat, edge: Flat| off[0].hypot(off[1]) <= STRAIGHT * edge[0].hypot(edge[1]);
        let between = |[a, m, b]: [usize; 3]| {
            small([0, 1].map(|c| p[m][c] - 0.5 * (p[a][c] + p[b][c])), [0, 1].map(|c| p[b][c] - p[a][c]))
        };
        let parallelogram = |[a, b, c, d]: [usize; 4]| {
            small([0, 1].map(|k| p[a][k] - p[b][k] + p[c][k] - p[d][k]), [0, 1].map(|k| p[c][k] - p[a][k]))
        };
        match self.kind {
            Kind::Edge | Kind::Triangle => true,
            Kind::BentEdge => between([0, 1, 2]),
            Kind::BentTriangle => [[0, 1, 2], [2, 3, 4], [4, 5, 0]].into_iter().all(between),
            Kind::Quadrilateral => parallelogram([0, 1, 2, 3]),
            Kind::BentQuadrilateral => {
                parallelogram([0, 2, 4, 6]) && [[0, 1, 2], [2, 3, 4], [4, 5, 6], [6, 7, 0]].into_iter().all(between)
            }
        }
    }

    /// Returns `true` if the products of shape functions of both facets are polynomials of degree five at most in the
    /// coordinates of the plane.
    fn is_of_low_degree(&self, other: &Self) -> bool {
        let low = |facet: &Self| facet.straight && facet.kind != Kind::BentQuadrilateral;
        low(self) && low(other)
    }

    /// Returns the two ends along the axis, in two dimensions.
    pub(super) fn ends(&self) -> [f64; 2] {
        [self.at[0][0], self.at[self.kind.nodes() - 1][0]]
    }

    /// Returns the polygons that make up the facet, in the order of its nodes: four, in a quadrilateral five, if edges
    /// between three nodes are bent.
    pub(super) fn polygons(&self) -> Vec<Vec<Flat>> {
        let pick = |places: &[usize]| places.iter().map(|&k| self.at[k]).collect();
        match self.kind {
            Kind::BentTriangle if self.straight => vec![pick(&[0, 2, 4])],
            Kind::BentTriangle => [[0, 1, 5], [1, 2, 3], [3, 4, 5], [1, 3, 5]].map(|places| pick(&places)).into(),
            Kind::BentQuadrilateral if self.straight => vec![pick(&[0, 2, 4, 6])],
            Kind::BentQuadrilateral => {
                let corners = [[0, 1, 7], [2, 3, 1], [4, 5, 3], [6, 7, 5]].map(|places| pick(&places));
                corners.into_iter().chain([pick(&[1, 3, 5, 7])]).collect()
            }
            kind => vec![self.at[..kind.nodes()].to_vec()],
        }
    }

    /// Computes the shape functions at the point of the facet that is projected to `y`, by Newton's method. Returns `None` if the method
    /// finds none, for example where the facet folds or beyond an edge that is bent much.
    pub(super) fn shape_at(&self, y: Flat) -> Option<Values> {
        let mut local = self.kind.centre();
        let mut left = f64::INFINITY;
        for _ in 0..20 {
            let (values, slopes) = (self.kind.shape(local), self.kind.slopes(local));
            let sum = |weights: &Values, c: usize| weights.iter().zip(&self.at).map(|(w, x)| w * x[c]).sum::<f64>();
            let off = [0, 1].map(|c| sum(&values, c) - y[c]);
            let along = |r: usize| [0, 1].map(|c| sum(&slopes[r], c));
            let step = match self.kind {
                Kind::Edge | Kind::BentEdge => [off[0] / along(0)[0], 0.0],
                _ => {
                    let ([a, b], [c, d]) = (along(0), along(1));
                    let determinant = a * d - b * c;
                    [(d * off[0] - c * off[1]) / determinant, (a * off[1] - b * off[0]) / determinant]
                }
            };
            local = [local[0] - step[0], local[1] - step[1]];
            if !local.iter().all(|c| c.is_finite()) {
                return None;
            }
            left = step[0].abs().max(step[1].abs());
            if left < FOUND {
                break;
            }
        }
        (left <= LOST).then(|| self.kind.shape(local))
    }

    /// Returns the distance from the plane of the point with the shape functions `shape`, m.
    pub(super) fn height(&self, shape: &Values) -> f64 {
        shape.iter().zip(&self.height).map(|(n, h)| n * h).sum()
    }
}

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
            let clipped = clip(polygon.clone(), &window);
            if area(&clipped) > NO_PART * size {
                add_fan(&clipped, rule, &mut places);
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
    let mut clipped = polygon;
    for (k, a) in window.iter().enumerate() {
        let b = window[(k + 1) % window.len()];
        let side = |x: &Flat| (b[0] - a[0]) * (x[1] - a[1]) - (b[1] - a[1]) * (x[0] - a[0]);
        let mut inside = Vec::with_capacity(clipped.len() + 1);
        let Some(mut last) = clipped.last().copied() else { return clipped };
        let mut last_side = side(&last);
        for x in clipped {
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
        clipped = inside;
    }
    clipped
}

#[cfg(test)]
mod tests {
    use super::*;

    const ALL: [Kind; 6] =
        [Kind::Edge, Kind::BentEdge, Kind::Triangle, Kind::Quadrilateral, Kind::BentTriangle, Kind::BentQuadrilateral];

    #[test]
    fn slopes_are_derivatives_and_add_up_to_nothing() {
        let (at, step) = ([0.3, 0.2], 1e-6);
        for kind in ALL {
            assert!((kind.shape(at).iter().sum::<f64>() - 1.0).abs() < 1e-15);
            for c in 0..2 {
                let moved = |s: f64| kind.shape([0, 1].map(|k| at[k] + if k == c { s } else { 0.0 }));
                let slopes = kind.slopes(at)[c];
                if c == 1 && matches!(kind, Kind::Edge | Kind::BentEdge) {
                    assert_eq!(slopes, [0.0; MOST]);
                    continue;
                }
                for ((ahead, behind), slope) in moved(step).iter().zip(moved(-step)).zip(slopes) {
                    assert!(((ahead - behind) / (2.0 * step) - slope).abs() < 1e-9, "{kind:?}");
                }
            }
        }
    }

    /// Nodes between corners are off by a seventh of the edge: there are places beside the facet that Newton's method wanders around.
    #[test]
    fn places_without_local_coordinates_are_not_given_others() {
        let moves = [[0.029, 0.142], [-0.043, 0.131], [0.101, -0.128]];
        let mut at = [[0.0; 2]; MOST];
        at[..6].copy_from_slice(&[[0.0, 0.0], [0.5, 0.0], [1.0, 0.0], [0.5, 0.5], [0.0, 1.0], [0.0, 0.5]]);
        for (k, by) in [1, 3, 5].into_iter().zip(moves) {
            (0..2).for_each(|c| at[k][c] += by[c]);
        }
        let facet = Projected { kind: Kind::BentTriangle, at, height: [0.0; MOST], straight: false };
        let (mut found, mut lost) = (0, 0);
        for (i, j) in (-20..120).flat_map(|i| (-20..120).map(move |j| (i, j))) {
            let y = [0.01 * f64::from(i), 0.01 * f64::from(j)];
            let Some(shape) = facet.shape_at(y) else {
                lost += 1;
                continue;
            };
            let there = [0, 1].map(|c| shape.iter().zip(&at).map(|(n, x)| n * x[c]).sum::<f64>());
            assert!((there[0] - y[0]).hypot(there[1] - y[1]) < 1e-9, "{y:?}: {there:?}");
            found += 1;
        }
        assert!(found > 10_000 && lost > 100, "{found} {lost}");
    }

    /// The projection of a point with given local coordinates has these local coordinates.
    #[test]
    fn points_of_bent_facets_are_found() {
        let bend = |[x, y]: Flat| [x + 0.1 * y * y, y - 0.2 * x + 0.05 * x * x];
        let nodes: [(Kind, &[Flat]); 6] = [
            (Kind::Edge, &[[0.0, 0.0], [1.0, 0.0]]),
            (Kind::BentEdge, &[[0.0, 0.0], [0.45, 0.0], [1.0, 0.0]]),
            (Kind::Triangle, &[[0.0, 0.0], [1.0, 0.0], [0.0, 1.0]]),
            (Kind::Quadrilateral, &[[-1.0, -1.0], [1.0, -1.0], [1.0, 1.0], [-1.0, 1.0]]),
            (Kind::BentTriangle, &[[0.0, 0.0], [0.5, 0.0], [1.0, 0.0], [0.5, 0.5], [0.0, 1.0], [0.0, 0.5]]),
            (Kind::BentQuadrilateral, &AROUND),
        ];
        for (kind, nodes) in nodes {
            let edge = matches!(kind, Kind::Edge | Kind::BentEdge);
            let mut facet = Projected { kind, at: [[0.0; 2]; MOST], height: [0.0; MOST], straight: false };
            for (k, &x) in nodes.iter().enumerate() {
                facet.at[k] = if edge { x } else { bend(x) };
            }
            let shape = kind.shape(if edge { [0.3, 0.0] } else { [0.3, 0.2] });
            let y = [0, 1].map(|c| shape.iter().zip(&facet.at).map(|(n, x)| n * x[c]).sum());
            for (found, n) in facet.shape_at(y).unwrap().iter().zip(shape) {
                assert!((found - n).abs() < 1e-14, "{kind:?}");
            }
        }
    }

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
