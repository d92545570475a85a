//! The bulge of the surface that a mesh approximates, beyond its facets.
//!
//! The nodes of a mesh are on the surface; straight facets between them are chords. With the normals n of the surface
//! in the corners of a facet and the normal ν of the facet, its distance beyond a point x of the facet is
//!
//! ```text
//! b = 2 c / (1 + √(1 - 2 κ c)),   c = ½ Σ_{i<j} N_i N_j e_ij - h (n · ν) - ½ κ h²,   e_ij = (n_j - n_i) · (x_j - x_i),
//! ```
//!
//! with the curvature κ, the largest `e_ij / |x_j - x_i|²` of the facet, and the distance h of x from `Σ N_i x_i` along ν, 0 on
//! straight facets. It is positive out of the body where it is convex, `l² / 8 R` in the middle of an edge, and exact on circles
//! and spheres with exact normals, along the normal. The cosine of the angle between that and ν is
//! `(n · ν + κ h) / √(1 - 2 κ c)`.
//!
//! On straight facets the normals are those of [`Surface`]. On curved facets of second order `e_ij` and n are those with which
//! c is 0 in all nodes: facets follow a circle closely only if the nodes between corners are in the middle.

use std::collections::BTreeMap;

use super::facet::{Plane, Projected, Values, position};
use super::surface::{FLAT, Surface};
use crate::algebra::elimination::solve;
use crate::algebra::vector::{dot, minus, norm, unit};
use crate::body::mesh::{Boundary, Mesh};

/// The ratio of the curvatures at the two ends of an edge above which one of them counts alone: the surface begins to turn
/// at the other, as at the end of a flat, or has an edge there.
const LIMIT: f64 = 3.0;

/// The least cosine of the angle, 44°, between facets of one smooth surface; beyond it is an edge of the body.
const SMOOTH: f64 = 0.7193;

/// The least cosine of the angle, 84°, between facets whose edge may be none, but too few facets.
const MEETING: f64 = 0.1;

/// The number of fits of the surface through the nodes of a facet. Each makes the error at least thirty times smaller if the
/// facet turns by 20°.
const FITS: usize = 8;

/// The weight of the curvatures in such a fit, so that those are 0 that nodes between corners do not tell.
const UNKNOWN: f64 = 1e-8;

/// The bulges of the facets of a boundary.
pub(super) struct Bulges {
    /// `None` for those without one.
    facets: Vec<Option<Bulge>>,
    /// The bulges as if the surface had no edges, if it has any.
    without_edges: Option<Vec<Option<Bulge>>>,
}

/// The curved surface beyond a facet.
struct Bulge {
    /// The facet between the corners, and its plane.
    plane: Plane,
    flat: Projected,
    /// `e_ij` (m) of two corners, by their places in the facet.
    turns: Vec<([usize; 2], f64)>,
    /// κ, 1/m.
    curvature: f64,
    /// `n · ν`, the mean over the corners.
    slope: f64,
    /// `c` in the nodes of the facet, where it is to be 0; empty if nodes between corners are on straight edges.
    left: Option<Values>,
}

/// The distance of a surface beyond a facet.
pub(super) struct Beyond {
    /// Along the normal of the surface, m.
    pub distance: f64,
    /// The cosine of the angle between the normals of the surface and of the facet.
    pub cosine: f64,
    /// The curvature of the sphere or cylinder about the same centre through the point of the facet, 1/m.
    pub curvature: f64,
}

impl Beyond {
    /// Returns the gap that is `gap` (m) along the normal of the facet, along the normal of the surface, m: the
    /// difference of the distances of its ends from the centre.
    pub(super) fn across(&self, gap: f64) -> f64 {
        let bent = gap * self.curvature;
        gap * (2.0 * self.cosine + bent) / (1.0 + (1.0 + bent * (2.0 * self.cosine + bent)).max(0.0).sqrt())
    }
}

impl Bulges {
    /// Computes the bulges of `boundary`.
    pub(super) fn new(mesh: &Mesh, boundary: &Boundary) -> Self {
        let surface = Surface::new(mesh, boundary, SMOOTH);
        let mut normals = boundary.facets.iter().map(|facet| unit(mesh.area_vector(facet)));
        let first = normals.next();
        if normals.all(|normal| Some(normal) == first) && surface.is_straight() {
            return Bulges { facets: Vec::new(), without_edges: None };
        }
        let without_edges = || Self::of_facets(mesh, boundary, &Surface::new(mesh, boundary, MEETING));
        Bulges {
            facets: Self::of_facets(mesh, boundary, &surface),
            without_edges: surface.has_edges(MEETING).then(without_edges),
        }
    }

    fn of_facets(mesh: &Mesh, boundary: &Boundary, surface: &Surface) -> Vec<Option<Bulge>> {
        let mut known = BTreeMap::new();
        let of_facet = |(f, facet): (usize, &Vec<usize>)| {
            if surface.corners(f).is_empty() {
                return Bulge::through(mesh, facet);
            }
            let corners = surface.corners(f);
            let mut normal = |node: usize, f: usize| {
                let fan = surface.fan(node, f);
                let first = fan.first().copied().unwrap_or(f);
                *known.entry((node, first)).or_insert_with(|| surface.normal(node, &fan))
            };
            let normals: Vec<[f64; 3]> = corners.iter().map(|&node| normal(node, f)).collect();
            let turn = |[i, j]: [usize; 2]| {
                let parts = surface.turns([corners[i], corners[j]], [normals[i], normals[j]]);
                let apart = norm(minus(mesh.nodes[corners[j]], mesh.nodes[corners[i]]));
                let mut alike = |[k, other]: [usize; 2], part: f64| {
                    let Some((node, g)) = surface.behind(corners[k], corners[other], f) else { return 1.0 };
                    let [_, before] = surface.turns([corners[k], node], [normals[k], normal(node, g)]);
                    let length = norm(minus(mesh.nodes[node], mesh.nodes[corners[k]]));
                    ratio([part / (apart * apart), before / (length * length)])
                };
                let goes_on = [alike([i, j], parts[0]), alike([j, i], parts[1])];
                ([i, j], limited(parts, goes_on))
            };
            let turns: Vec<([usize; 2], f64)> =
                pairs(corners.len()).map(turn).filter(|(_, turn)| *turn != 0.0).collect();
            let curvature = |&([i, j], turn): &([usize; 2], f64)| {
                let apart = minus(mesh.nodes[corners[j]], mesh.nodes[corners[i]]);
                turn / dot(apart, apart)
            };
            let curvature = turns.iter().map(curvature).max_by(|a, b| a.abs().total_cmp(&b.abs()))?;
            let plane = Plane::of(mesh, corners);
            let slope = normals.iter().map(|n| dot(*n, plane.normal)).sum::<f64>() / normals.len() as f64;
            Some(Bulge { flat: plane.project(mesh, corners), plane, turns, curvature, slope, left: None })
        };
        boundary.facets.iter().enumerate().map(of_facet).collect()
    }

    /// Returns `true` if the surface has edges that might be none.
    pub(super) fn have_edges(&self) -> bool {
        self.without_edges.is_some()
    }

    /// Returns the distance of the surface, with or without its `edges`, beyond the facet with the number `f` and the nodes `facet`,
    /// at the point with the shape functions `shape`.
    pub(super) fn at(&self, mesh: &Mesh, edges: bool, (f, facet): (usize, &[usize]), shape: &Values) -> Beyond {
        let of_facets = self.without_edges.as_ref().filter(|_| !edges).unwrap_or(&self.facets);
        let bulge = of_facets.get(f).and_then(Option::as_ref);
        let Some((bulge, (square, height))) = bulge.and_then(|bulge| Some((bulge, bulge.square(mesh, facet, shape)?)))
        else {
            return Beyond { distance: 0.0, cosine: 1.0, curvature: 0.0 };
        };
        let square = square - bulge.left.map_or(0.0, |left| left.iter().zip(shape).map(|(c, n)| c * n).sum());
        // 1 on a flat; on a sphere the distance of the facet from its centre, relative to the radius.
        let inside = (1.0 - 2.0 * bulge.curvature * square).max(0.0).sqrt();
        Beyond {
            distance: 2.0 * square / (1.0 + inside),
            cosine: ((bulge.slope + bulge.curvature * height) / inside).min(1.0),
            curvature: bulge.curvature / inside,
        }
    }
}

impl Bulge {
    /// Computes the surface through the nodes of a facet of second order: `e_ij` is that of a tensor of curvature along the plane
    /// of the corners, with the larger principal curvature across it.
    fn through(mesh: &Mesh, facet: &[usize]) -> Option<Self> {
        let corners: Vec<usize> = facet.iter().step_by(2).copied().collect();
        let plane = Plane::of(mesh, &corners);
        let flat = plane.project(mesh, &corners);
        let apart = |[i, j]: [usize; 2]| {
            let apart = minus(mesh.nodes[corners[j]], mesh.nodes[corners[i]]);
            let [u, v] = plane.axes.map(|axis| dot(axis, apart));
            [u, v, dot(plane.normal, apart)]
        };
        let squares = |[u, v, w]: [f64; 3]| [u * u, 2.0 * u * v, v * v, w * w];
        let middles = facet.iter().skip(1).step_by(2).map(|&node| {
            let under = Under::of(&plane, &flat, mesh.nodes[node])?;
            let terms = pairs(corners.len()).fold([0.0; 4], |sum, [i, j]| {
                let apart = squares(apart([i, j]));
                std::array::from_fn(|c| sum[c] + under.shape[i] * under.shape[j] * apart[c])
            });
            Some((terms, under))
        });
        let middles = middles.collect::<Option<Vec<([f64; 4], Under)>>>()?;
        let size = middles.iter().map(|([first, _, second, _], _)| first + second).sum::<f64>();
        if middles.iter().all(|(_, under)| under.distance.abs() < FLAT * size.sqrt()) {
            return None;
        }
        let (mut turns, mut curvature, mut slope) = (Vec::new(), 0.0, 1.0);
        for _ in 0..FITS {
            let mut rows = [[0.0; 4]; 3];
            for ([first, twist, second, across], under) in &middles {
                let square = 2.0 * under.square(slope, curvature) - curvature * across;
                let terms = [first / size, twist / size, second / size, square];
                for (row, a) in rows.iter_mut().zip(terms) {
                    row.iter_mut().zip(terms).for_each(|(sum, b)| *sum += a * b);
                }
            }
            rows.iter_mut().enumerate().for_each(|(k, row)| row[k] += UNKNOWN);
            solve(&mut rows)?;
            let [first, twist, second] = rows.map(|row| row[3] / size);
            let (mean, spread) = (0.5 * (first + second), (0.5 * (first - second)).hypot(twist));
            curvature = mean + spread.copysign(mean);
            let turn = |pair: [usize; 2]| {
                let squares = squares(apart(pair));
                [first, twist, second, curvature].iter().zip(squares).map(|(k, square)| k * square).sum::<f64>()
            };
            turns = pairs(corners.len()).map(|pair| (pair, turn(pair))).collect();
            // The normal of a corner leans by -½ e along each edge there.
            let lean = |k: usize| {
                let [one, other] = [1, corners.len() - 1].map(|step| [k, (k + step) % corners.len()]);
                let [a, b] = [one, other].map(|pair| (apart(pair), 0.5 * turn(pair) + slope * apart(pair)[2]));
                let determinant = a.0[0] * b.0[1] - a.0[1] * b.0[0];
                if determinant == 0.0 {
                    return a.1 / a.0[0];
                }
                ((a.1 * b.0[1] - b.1 * a.0[1]) / determinant).hypot((b.1 * a.0[0] - a.1 * b.0[0]) / determinant)
            };
            let count = corners.len();
            slope = (0..count).map(|k| (1.0 - lean(k).powi(2)).max(0.0).sqrt()).sum::<f64>() / count as f64;
        }
        let mut bulge = Bulge { plane, flat, turns, curvature, slope, left: None };
        let unit = |k: usize| std::array::from_fn(|j| f64::from(u8::from(j == k)));
        let left = |k: usize| bulge.square(mesh, facet, &unit(k)).map_or(0.0, |(square, _)| square);
        bulge.left = Some(std::array::from_fn(|k| if k < facet.len() { left(k) } else { 0.0 }));
        Some(bulge)
    }

    /// Returns `c` in the point with the shape functions `shape`, m, and the distance of the point from the plane, m.
    fn square(&self, mesh: &Mesh, facet: &[usize], shape: &Values) -> Option<(f64, f64)> {
        let under = if mesh.is_quadratic(facet) {
            Under::of(&self.plane, &self.flat, position(mesh, facet, shape))?
        } else {
            Under { shape: *shape, distance: 0.0, from_plane: self.flat.height(shape) }
        };
        let chords =
            self.turns.iter().map(|([i, j], turn)| 0.5 * under.shape[*i] * under.shape[*j] * turn).sum::<f64>();
        Some((chords - under.square(self.slope, self.curvature), under.from_plane))
    }
}

/// The place of a facet between corners that is under a point, along the normal of its plane.
struct Under {
    /// The shape functions of the corners there.
    shape: Values,
    /// The distance of the point from that place, m.
    distance: f64,
    /// The distance of the point from the plane, m.
    from_plane: f64,
}

impl Under {
    fn of(plane: &Plane, flat: &Projected, x: [f64; 3]) -> Option<Self> {
        let (place, from_plane) = plane.place(x);
        let shape = flat.shape_at(place)?;
        Some(Under { shape, distance: from_plane - flat.height(&shape), from_plane })
    }

    /// Returns the difference of `c` between the place and the point, m.
    fn square(&self, slope: f64, curvature: f64) -> f64 {
        self.distance * (slope + curvature * (self.from_plane - 0.5 * self.distance))
    }
}

/// Returns the pairs of places below `count`.
fn pairs(count: usize) -> impl Iterator<Item = [usize; 2]> {
    (0..count).flat_map(move |i| (i + 1..count).map(move |j| [i, j]))
}

/// Adds the parts of `e_ij` that both ends of an edge contribute. They are alike where the curvature changes gradually.
/// `goes_on` is the ratio of the curvature at each end to that beyond it: it is small where the surface begins to turn.
fn limited([a, b]: [f64; 2], [at_a, at_b]: [f64; 2]) -> f64 {
    let (least, most, at_least, at_most) = if a.abs() < b.abs() { (a, b, at_a, at_b) } else { (b, a, at_b, at_a) };
    if LIMIT * at_least < at_most {
        2.0 * most
    } else if ratio([a, b]) == 0.0 {
        0.0
    } else if LIMIT * ratio([a, b]) < 1.0 {
        2.0 * least
    } else {
        a + b
    }
}

/// Returns the ratio of the smaller of two curvatures to the larger, 0 if their signs differ, and 1 if both are 0.
fn ratio([a, b]: [f64; 2]) -> f64 {
    let most = a.abs().max(b.abs());
    if most == 0.0 { 1.0 } else { (a * b).max(0.0) / (most * most) }
}
