//! The bulge of the surface that a mesh approximates, beyond its facets.
//!
//! The nodes of a mesh are on the surface; straight facets between them are chords. With the normals n of the surface
//! in the corners of a facet and the normal ν of the facet, its distance beyond a point x of the facet is
//!
//! ```text
//! b = 2 c / (1 + √(1 - 2 κ c)),   c = ½ Σ_{i<j} N_i N_j e_ij - h (n · ν) - ½ κ h²,   e_ij = (n_j - n_i) · (x_j - x_i),
//! ```
//!
//! with the largest curvature κ of the facet, and the distance h of x from `Σ N_i x_i` along ν, 0 on
//! straight facets. It is positive out of the body where it is convex, `l² / 8 R` in the middle of an edge, and exact on circles
//! and spheres with exact normals, along the normal. The cosine of the angle between that and ν is
//! `(n · ν + κ h) / √(1 - 2 κ c)`. Where the two parts of `e_ij`, of n_i and of n_j, differ, `(N_i - N_j)` times half of their
//! difference is added to `½ e_ij`, so that the surface is smooth across corners.
//!
//! On straight facets the normals are those of [`Surface`]. On curved facets of second order `e_ij` and n are those with which
//! c is 0 in all nodes: facets follow a circle closely only if the nodes between corners are in the middle.

use std::collections::{BTreeMap, BTreeSet};

use super::facet::{Plane, Projected, Values, position};
use crate::algebra::elimination::solve;
use crate::algebra::vector::{across, cross, dot, minus, norm, plus, unit};
use crate::body::contact::facing::SMOOTH;
use crate::body::mesh::{Boundary, Facet, Mesh, Round};

/// The ratio of the curvatures at the two ends of an edge above which one of them counts alone: the surface begins to turn
/// at the other, as at the end of a flat, or has an edge there.
const LIMIT: f64 = 3.0;

/// The least cosine of the angle, 84°, between facets whose edge may be none, but too few facets.
const MEETING: f64 = 0.1;

/// The number of fits of the surface through the nodes of a facet. Each makes the error at least thirty times smaller if the
/// facet turns by 20°.
const FITS: usize = 8;

/// The weight of the curvatures in such a fit, so that those are 0 that nodes between corners do not tell.
const UNKNOWN: f64 = 1e-8;

/// The bulges of the facets of a boundary.
#[derive(Debug)]
pub(super) struct Bulges {
    /// `None` for those without one.
    facets: Vec<Option<Bulge>>,
    /// The bulges as if the surface had no edges, if it has any.
    without_edges: Option<Vec<Option<Bulge>>>,
}

/// The curved surface beyond a facet.
#[derive(Debug)]
struct Bulge {
    /// The facet between the corners, and its plane.
    plane: Plane,
    flat: Projected,
    /// The parts of `e_ij` (m) of two corners, by their places in the facet.
    turns: Vec<([usize; 2], [f64; 2])>,
    /// κ, 1/m.
    curvature: f64,
    /// The normals in the corners of a straight facet.
    normals: Vec<[f64; 3]>,
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
            if surface.corners[f].is_empty() {
                return Bulge::through(mesh, facet);
            }
            let corners = &surface.corners[f];
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
            let turns: Vec<([usize; 2], [f64; 2])> =
                pairs(corners.len()).map(turn).filter(|(_, [a, b])| a + b != 0.0).collect();
            let plane = Plane::of(mesh, corners);
            let along = |[i, j]: [usize; 2]| {
                let apart = minus(mesh.nodes[corners[j]], mesh.nodes[corners[i]]);
                plane.axes.map(|axis| dot(axis, apart))
            };
            let of_edge =
                |(pair, [a, b]): &([usize; 2], [f64; 2])| (a + b) / along(*pair).map(|x| x * x).iter().sum::<f64>();
            let most = turns.iter().map(of_edge).max_by(|a, b| a.abs().total_cmp(&b.abs()))?;
            // The three edges of a triangle determine the curvature in all directions.
            let of_triangle = || {
                let mut rows = [[0.0; 4]; 3];
                for (row, pair) in rows.iter_mut().zip(pairs(3)) {
                    let ([u, v], turn) = (along(pair), turns.iter().find(|(own, _)| *own == pair));
                    *row = [u * u, 2.0 * u * v, v * v, turn.map_or(0.0, |(_, [a, b])| a + b)];
                }
                solve(&mut rows)?;
                Some(principal(rows.map(|row| row[3])))
            };
            let curvature = if corners.len() == 3 { of_triangle().unwrap_or(most) } else { most };
            let slope = normals.iter().map(|n| dot(*n, plane.normal)).sum::<f64>() / normals.len() as f64;
            Some(Bulge { flat: plane.project(mesh, corners), plane, turns, curvature, normals, slope, left: None })
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

/// The surface of which facets are chords, with the facets between all nodes that are on it.
#[derive(Debug)]
pub(crate) struct RoundSurface {
    mesh: Mesh,
    facets: Vec<Facet>,
    /// The place of the first chord of each facet.
    first: Vec<usize>,
    chords: Boundary,
    bulges: Bulges,
}

impl RoundSurface {
    /// Creates the surface of these `facets` of `mesh`.
    pub(crate) fn new(mesh: &Mesh, facets: Vec<Facet>) -> Self {
        let (mut chords, mut first) = (Boundary { name: String::new(), facets: Vec::new() }, Vec::new());
        for facet in &facets {
            first.push(chords.facets.len());
            match facet[..] {
                _ if !mesh.is_quadratic(facet) => chords.facets.push(facet.clone()),
                _ if is_straight(mesh, facet) => chords.facets.push(facet.iter().step_by(2).copied().collect()),
                [a, m, b] => chords.facets.extend([vec![a, m], vec![m, b]]),
                [a, m, b, n, c, o] => {
                    chords.facets.extend([vec![a, m, o], vec![m, b, n], vec![o, n, c], vec![n, o, m]]);
                }
                _ => {}
            }
        }
        let bulges = Bulges::new(mesh, &chords);
        let mesh = Mesh { cells: Vec::new(), boundaries: Vec::new(), ..mesh.clone() };
        RoundSurface { mesh, facets, first, chords, bulges }
    }
}

impl Round for RoundSurface {
    fn normal(&self, facet: usize) -> [f64; 3] {
        unit(self.mesh.area_vector(&self.facets[facet]))
    }

    fn point(&self, facet: usize, shares: [f64; 3]) -> Option<[f64; 3]> {
        let first = self.first[facet];
        let count = self.first.get(facet + 1).unwrap_or(&self.chords.facets.len()) - first;
        // The chord at a corner, or the one between the others.
        let corner = (0..3).find(|&k| shares[k] > 0.5 || (count == 2 && shares[k] == 0.5));
        let (k, shares) = match (count, corner) {
            (1, _) => (0, shares),
            (_, Some(k)) => (k, std::array::from_fn(|i| 2.0 * shares[i] - f64::from(u8::from(i == k)))),
            (_, None) => (3, shares.map(|share| 1.0 - 2.0 * share)),
        };
        let (f, chord) = (first + k, &self.chords.facets[first + k]);
        let bulge = self.bulges.facets.get(f)?.as_ref()?;
        let shape: Values = std::array::from_fn(|i| if i < chord.len() { shares[i] } else { 0.0 });
        let normal = bulge.normals.iter().zip(shares).fold([0.0; 3], |sum, (n, share)| plus(sum, share, *n));
        let distance = self.bulges.at(&self.mesh, true, (f, chord), &shape).distance;
        Some(plus(position(&self.mesh, chord, &shape), distance, unit(normal)))
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
            curvature = principal([first, twist, second]);
            let turn = |pair: [usize; 2]| {
                let squares = squares(apart(pair));
                [first, twist, second, curvature].iter().zip(squares).map(|(k, square)| k * square).sum::<f64>()
            };
            turns = pairs(corners.len()).map(|pair| (pair, [0.5 * turn(pair); 2])).collect();
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
        let mut bulge = Bulge { plane, flat, turns, curvature, normals: Vec::new(), slope, left: None };
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
        let chord = |([i, j], [a, b]): &([usize; 2], [f64; 2])| {
            let [i, j] = [under.shape[*i], under.shape[*j]];
            0.5 * i * j * (a + b + (i - j) * (a - b))
        };
        let chords = self.turns.iter().map(chord).sum::<f64>();
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
        let (point, from_plane) = plane.coordinates(x);
        let shape = flat.shape_at(point)?;
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

/// Returns the parts of `e_ij` that both ends of an edge contribute. They are alike where the curvature changes gradually.
/// `goes_on` is the ratio of the curvature at each end to that beyond it: it is small where the surface begins to turn.
fn limited([a, b]: [f64; 2], [at_a, at_b]: [f64; 2]) -> [f64; 2] {
    let (least, most, at_least, at_most) = if a.abs() < b.abs() { (a, b, at_a, at_b) } else { (b, a, at_b, at_a) };
    if LIMIT * at_least < at_most {
        [most; 2]
    } else if ratio([a, b]) == 0.0 {
        [0.0; 2]
    } else if LIMIT * ratio([a, b]) < 1.0 {
        [least; 2]
    } else if (a - b).abs() <= IN_SPACE[1] * (a + b).abs() {
        // The fits tell no difference.
        [0.5 * (a + b); 2]
    } else {
        [a, b]
    }
}

/// Returns the principal curvature of larger magnitude of a form with these components.
fn principal([first, twist, second]: [f64; 3]) -> f64 {
    let (mean, spread) = (0.5 * (first + second), (0.5 * (first - second)).hypot(twist));
    mean + spread.copysign(mean)
}

/// Returns `true` if the nodes between the corners of a facet of second order are on straight edges.
fn is_straight(mesh: &Mesh, facet: &[usize]) -> bool {
    let straight = |[a, m, b]: [usize; 3]| {
        let [a, m, b] = [a, m, b].map(|node| mesh.nodes[node]);
        let edge = minus(b, a);
        norm(across(minus(m, a), unit(edge))) < STRAIGHT * norm(edge)
    };
    mesh.bent_edges(facet).into_iter().all(straight)
}

/// Returns the ratio of the smaller of two curvatures to the larger, 0 if their signs differ, and 1 if both are 0.
fn ratio([a, b]: [f64; 2]) -> f64 {
    let most = a.abs().max(b.abs());
    if most == 0.0 { 1.0 } else { (a * b).max(0.0) / (most * most) }
}

/// A node between two others belongs to a straight edge if it is off by less than this share of it.
const STRAIGHT: f64 = 1e-6;

/// A surface that turns by less than this along an edge is flat: coordinates are rounded.
pub(super) const FLAT: f64 = 1e-9;

/// The weight of the curvatures in the first and in later fits in space, beside that of the points, so that curvatures
/// are 0 where points do not tell them: along the axis of a tube of one facet in length.
const IN_SPACE: [f64; 2] = [1e-3, 1e-5];

/// That weight in two dimensions, where it is needed for one facet alone.
const IN_PLANE: f64 = 1e-7;

/// The largest number of fits after the first. Each makes the error at least ten times smaller between facets that turn by 20°.
const MAX_FITS: usize = 10;

/// The number of points around a node that determine three curvatures and two slopes with one to spare.
const ENOUGH: usize = 6;

/// The normal and the curvatures of a surface in a node are those of the quadric that fits the nodes around it best,
///
/// ```text
/// n · (x_k - x) = -½ κ(x_k - x, x_k - x),
/// ```
///
/// where n has two unknown components and κ three along the surface (Cazals and Pouget 2005). Across the surface κ is
/// the larger of the principal curvatures, so that the result is exact on spheres and cylinders; in two dimensions it
/// is the circle through three nodes. Nodes beyond an edge of the body do not count. Where the nodes of the facets
/// around a node are on one side only, those of the next facets count, too.
pub(super) struct Surface<'a> {
    mesh: &'a Mesh,
    /// The corners of each facet; none if it is curved.
    corners: Vec<Vec<usize>>,
    /// The unit normal of each facet.
    normals: Vec<[f64; 3]>,
    /// The facets of each node.
    around: BTreeMap<usize, Vec<usize>>,
    /// The least cosine of the angle between facets of one smooth surface.
    smooth: f64,
}

impl<'a> Surface<'a> {
    pub(super) fn new(mesh: &'a Mesh, boundary: &Boundary, smooth: f64) -> Self {
        let corners = |facet: &Vec<usize>| match mesh.is_quadratic(facet) {
            true if is_straight(mesh, facet) => facet.iter().step_by(2).copied().collect(),
            true => Vec::new(),
            false => facet.clone(),
        };
        let corners: Vec<Vec<usize>> = boundary.facets.iter().map(corners).collect();
        let mut around = BTreeMap::<usize, Vec<usize>>::new();
        for (f, corners) in corners.iter().enumerate() {
            for &node in corners {
                around.entry(node).or_default().push(f);
            }
        }
        let normals = boundary.facets.iter().map(|facet| unit(mesh.area_vector(facet))).collect();
        Surface { mesh, corners, normals, around, smooth }
    }

    /// Returns `true` if no facet follows the surface.
    pub(super) fn is_straight(&self) -> bool {
        self.corners.iter().all(|corners| !corners.is_empty())
    }

    /// Returns `true` if facets beside each other are apart whose normals have an angle with a cosine above `least`.
    fn has_edges(&self, least: f64) -> bool {
        let apart = |f: usize, g: usize| (least..=self.smooth).contains(&dot(self.normals[f], self.normals[g]));
        let any =
            |facets: &Vec<usize>| facets.iter().any(|&f| facets.iter().any(|&g| apart(f, g) && self.are_beside(f, g)));
        self.around.values().any(any)
    }

    /// Returns the unit normal in `node` of the surface of the facets `fan`, see [`Surface::fan`].
    pub(super) fn normal(&self, node: usize, fan: &BTreeSet<usize>) -> [f64; 3] {
        let mut points = self.points(node, fan);
        let enough = if self.mesh.dimension == 2 { 2 } else { ENOUGH };
        if points.len() < enough || !self.is_closed(node, fan) {
            let next = |&f: &usize| self.corners[f].iter().flat_map(move |&corner| self.fan(corner, f));
            points = self.points(node, &fan.iter().flat_map(next).collect());
        }
        let mean = unit(fan.iter().fold([0.0; 3], |sum, &f| plus(sum, 1.0, self.normals[f])));
        let apart: Vec<[f64; 3]> = points.iter().map(|&k| minus(self.mesh.nodes[k], self.mesh.nodes[node])).collect();
        let found = match self.mesh.dimension {
            2 => fit(mean, &apart, None, IN_PLANE).map(|fit| fit.normal),
            _ => fitted(mean, &apart),
        };
        found.unwrap_or(mean)
    }

    /// Returns the parts `-n_i · (x_j - x_i)` and `n_j · (x_j - x_i)` of the turn of the normals `n` along an edge, m.
    pub(super) fn turns(&self, nodes: [usize; 2], n: [[f64; 3]; 2]) -> [f64; 2] {
        let apart = minus(self.mesh.nodes[nodes[1]], self.mesh.nodes[nodes[0]]);
        let rounding = FLAT * norm(apart);
        [-dot(n[0], apart), dot(n[1], apart)].map(|turn| if turn.abs() > rounding { turn } else { 0.0 })
    }

    /// Returns the corner beyond `node`, seen from `other`, on the smooth surface of facet `f`, with a facet that has both.
    pub(super) fn behind(&self, node: usize, other: usize, f: usize) -> Option<(usize, usize)> {
        let along = |k: usize| unit(minus(self.mesh.nodes[k], self.mesh.nodes[node]));
        let back = |&(corner, _): &(usize, usize)| -dot(along(corner), along(other));
        let corners = |g: usize| self.corners[g].iter().map(move |&corner| (corner, g));
        let others = self.fan(node, f).into_iter().flat_map(corners).filter(|(corner, _)| *corner != node);
        others.filter(|corner| back(corner) > 0.0).max_by(|a, b| back(a).total_cmp(&back(b)))
    }

    /// Returns the facets at `node` that belong to the same smooth surface as facet `f`.
    pub(super) fn fan(&self, node: usize, f: usize) -> BTreeSet<usize> {
        let (mut fan, mut next) = (BTreeSet::from([f]), vec![f]);
        while let Some(f) = next.pop() {
            for &g in &self.around[&node] {
                if !fan.contains(&g) && self.continues(f, g) {
                    fan.insert(g);
                    next.push(g);
                }
            }
        }
        fan
    }

    /// Returns `true` if two facets share an edge, in two dimensions a node, across which the surface is smooth.
    fn continues(&self, f: usize, g: usize) -> bool {
        self.are_beside(f, g) && dot(self.normals[f], self.normals[g]) > self.smooth
    }

    fn are_beside(&self, f: usize, g: usize) -> bool {
        let shared = self.corners[f].iter().filter(|node| self.corners[g].contains(node)).count();
        shared + 1 >= self.mesh.dimension
    }

    /// Returns `true` if facets are all around `node`: none of their edges there belongs to one of them only.
    fn is_closed(&self, node: usize, fan: &BTreeSet<usize>) -> bool {
        if self.mesh.dimension == 2 {
            return fan.len() == 2;
        }
        let mut ends = BTreeMap::<usize, usize>::new();
        for corners in fan.iter().map(|&f| &self.corners[f]) {
            let (count, place) = (corners.len(), corners.iter().position(|&corner| corner == node).unwrap_or(0));
            for beside in [place + 1, place + count - 1] {
                *ends.entry(corners[beside % count]).or_default() += 1;
            }
        }
        ends.values().all(|&count| count > 1)
    }

    /// Returns the corners of `facets` without `node`.
    fn points(&self, node: usize, facets: &BTreeSet<usize>) -> BTreeSet<usize> {
        facets.iter().flat_map(|&f| &self.corners[f]).copied().filter(|&corner| corner != node).collect()
    }
}

/// Fits the quadric to the points at the distances `apart` (m) from a node; returns its normal there. `about` is a unit
/// vector near the normal.
fn fitted(about: [f64; 3], apart: &[[f64; 3]]) -> Option<[f64; 3]> {
    let mut found = fit(about, apart, None, IN_SPACE[0])?;
    let mut last = f64::INFINITY;
    for _ in 0..MAX_FITS {
        let next = fit(found.normal, apart, Some(found.across), IN_SPACE[1])?;
        let step = norm(minus(next.normal, found.normal));
        if step >= last {
            break;
        }
        (found, last) = (next, step);
    }
    Some(found.normal)
}

/// A quadric in a node.
struct Fit {
    normal: [f64; 3],
    /// The curvature across the surface times the mean distance of the points.
    across: f64,
}

/// Fits the quadric with the curvature `across` that of the fit before. Without one, the square of the distance takes
/// its place, which is exact on spheres.
fn fit(about: [f64; 3], apart: &[[f64; 3]], across_surface: Option<f64>, unknown: f64) -> Option<Fit> {
    let first = unit(across(*apart.first()?, about));
    let axes = [first, cross(about, first)];
    let mean = apart.iter().map(|x| norm(*x)).sum::<f64>() / apart.len() as f64;
    let mut rows = [[0.0; 6]; 5];
    for x in apart {
        let length = norm(*x);
        let ([u, v], w) = (axes.map(|axis| dot(axis, *x) / length), dot(about, *x) / length);
        let half = 0.5 * length / mean;
        let (along, curved) = across_surface.map_or((half / (u * u + v * v), 0.0), |k| (half, half * k * w * w));
        let terms = [u, v, along * u * u, 2.0 * along * u * v, along * v * v, w - curved];
        for (row, a) in rows.iter_mut().zip(terms) {
            row.iter_mut().zip(terms).for_each(|(sum, b)| *sum += a * b / apart.len() as f64);
        }
    }
    for (k, row) in rows.iter_mut().enumerate() {
        row[k] += match k {
            // In two dimensions nothing is aside.
            0 | 1 => f64::from(u8::from(row[k] == 0.0)),
            // The twist counts twice, so that the sum does not depend on the axes.
            3 => 2.0 * unknown,
            _ => unknown,
        };
    }
    solve(&mut rows)?;
    let [a, b, first, twist, second] = rows.map(|row| row[5]);
    // The curvatures are those of this normal, which is not of length 1.
    let normal = plus(plus(about, -a, axes[0]), -b, axes[1]);
    let length = norm(normal);
    let normal = normal.map(|c| c / length);
    // More than the curvature of a circle of six facets comes from scattered nodes.
    let across = (principal([first, twist, second]) / length).clamp(-1.0, 1.0);
    normal.iter().all(|c| c.is_finite()).then_some(Fit { normal, across })
}
