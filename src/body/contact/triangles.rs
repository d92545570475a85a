//! A rigid surface of triangles: intersection with lines, nearest points, holes and cracks.
//!
//! Triangles are counterclockwise as seen from outside the obstacle, as in an STL file. The surface may be closed or
//! have a rim; beyond the rim it has no distance.

mod chords;
mod read;

use std::collections::{HashMap, HashSet};
use std::path::Path;

pub(super) use chords::Chords;
pub use read::SurfaceError;

use super::tree::{Bounds, Tree};
use crate::algebra::vector::{cross, dot, minus, norm, plus, unit};

/// A surface of triangles.
#[derive(Debug, Clone)]
pub(super) struct Triangles {
    corners: Vec<[[f64; 3]; 3]>,
    /// Unit normals out of the obstacle.
    pub(super) normals: Vec<[f64; 3]>,
    /// The indices in `vertices` of the corners of each triangle.
    points: Vec<[usize; 3]>,
    /// The indices in `edges` of the sides of each triangle; side k begins at corner k.
    sides: Vec<[usize; 3]>,
    vertices: Vec<Feature>,
    edges: Vec<Feature>,
    tree: Tree,
    /// The longest side of the bounding box, m.
    pub(super) extent: f64,
}

/// An edge or a corner of the surface.
#[derive(Debug, Clone, PartialEq, Default)]
struct Feature {
    /// The sum of the normals of the triangles that meet there, weighted by their angles at a corner; its sign
    /// distinguishes inside from outside (Bærentzen and Aanæs, 2005).
    normal: [f64; 3],
    /// On a rim, the unit vectors pointing off the surface.
    off: Vec<[f64; 3]>,
}

/// The point where a line enters the obstacle.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Entry {
    /// The distance along the line, m.
    pub distance: f64,
    /// The triangle that the line crosses.
    pub triangle: usize,
}

/// A face, side or corner of a triangle.
#[derive(Debug, Clone, Copy)]
pub(super) enum TriangleFeature {
    Face,
    Side(usize),
    Corner(usize),
}

/// The rounding error of a position, as a share of the size of the surface. With this tolerance a line through an edge
/// meets both triangles.
const POSITION_ROUNDING: f64 = 1e-12;

/// The rounding error in single precision, which most STL files have. A line meets a triangle only if the cosine between
/// line and normal exceeds it.
const SINGLE: f64 = 1e-6;

/// A point may lie beyond a rim by this share of the size of the surface, so that what is in front of a crack meets the
/// triangles beside it.
const CRACK: f64 = 1e-5;

/// A triangle is slender if the square of its longest side exceeds this multiple of the area of the parallelogram, and
/// its parts are about this share of the surface long.
const SLENDER: f64 = 8.0;
const PART: f64 = 0.25;

/// Calls `add` with boxes that together contain a triangle. The box of a slender oblique triangle is much larger than
/// the triangle, so that its parts have boxes of their own.
fn cover(corners: &[[f64; 3]; 3], extent: f64, add: &mut impl FnMut(Bounds)) {
    let square = |k: usize| norm(minus(corners[(k + 1) % 3], corners[k])).powi(2);
    let k = (1..3).fold(0, |best, k| if square(k) > square(best) { k } else { best });
    let [a, b, c] = [0, 1, 2].map(|j| corners[(k + j) % 3]);
    let area = norm(cross(minus(b, a), minus(c, a)));
    if square(k) <= SLENDER * area || square(k) <= (PART * extent).powi(2) {
        return add(Bounds::of(corners));
    }
    let middle = plus(a, 0.5, minus(b, a));
    cover(&[a, middle, c], extent, add);
    cover(&[middle, b, c], extent, add);
}

/// Returns the bits of a point, for exact comparison; + 0.0 turns -0 into 0.
fn key(x: [f64; 3]) -> [u64; 3] {
    x.map(|c| (c + 0.0).to_bits())
}

/// Returns the corners of a triangle rotated to begin with the least one; the orientation is kept.
fn from_least(corners: &[[f64; 3]; 3]) -> [[u64; 3]; 3] {
    let mut keys = corners.map(key);
    let least = (0..3).min_by_key(|k| keys[*k]).unwrap_or(0);
    keys.rotate_left(least);
    keys
}

impl PartialEq for Triangles {
    fn eq(&self, other: &Self) -> bool {
        self.corners == other.corners
    }
}

impl Triangles {
    /// Reads the STL file or the Gmsh file at `path`, whose unit is `scale` (m).
    pub(super) fn read(path: &Path, scale: f64) -> Result<Self, SurfaceError> {
        let corners = read::corners(path)?;
        let corners = corners.into_iter().map(|corners| corners.map(|x| x.map(|c| c * scale))).collect();
        Self::new(corners).map_err(|message| SurfaceError::Unsound { file: path.display().to_string(), message })
    }

    /// Creates the surface of these triangles, without those of zero area and repeated ones. The error is the reason,
    /// in words.
    fn new(mut corners: Vec<[[f64; 3]; 3]>) -> Result<Self, String> {
        let area = |[a, b, c]: &[[f64; 3]; 3]| cross(minus(*b, *a), minus(*c, *a));
        corners.retain(|corners| norm(area(corners)) > 0.0);
        let mut known = HashSet::new();
        corners.retain(|corners| known.insert(from_least(corners)));
        if corners.is_empty() {
            return Err("the surface has no triangle with an area".to_string());
        }
        let normals: Vec<[f64; 3]> = corners.iter().map(|corners| unit(area(corners))).collect();
        let (mut points, mut vertices) = (Vec::with_capacity(corners.len()), Vec::new());
        let mut numbers = HashMap::new();
        for (corners, normal) in corners.iter().zip(&normals) {
            points.push([0, 1, 2].map(|k| {
                let number = *numbers.entry(key(corners[k])).or_insert(vertices.len());
                if number == vertices.len() {
                    vertices.push(Feature::default());
                }
                let [one, other] = [1, 2].map(|j| unit(minus(corners[(k + j) % 3], corners[k])));
                let angle = norm(cross(one, other)).atan2(dot(one, other));
                vertices[number].normal = plus(vertices[number].normal, angle, *normal);
                number
            }));
        }
        let extent = Bounds::of(corners.as_flattened()).extent();
        let mut boxes = Vec::with_capacity(corners.len());
        corners.iter().enumerate().for_each(|(t, corners)| cover(corners, extent, &mut |part| boxes.push((part, t))));
        let mut surface = Triangles {
            sides: Vec::new(),
            edges: Vec::new(),
            tree: Tree::of_boxes(boxes.into_iter()),
            extent,
            corners,
            normals,
            points,
            vertices,
        };
        surface.find_edges()?;
        Ok(surface)
    }

    /// Finds the sides that triangles share, and the sides on rims.
    fn find_edges(&mut self) -> Result<(), String> {
        let mut numbers = HashMap::new();
        // For each edge its first triangle with the side, and the number of its triangles.
        let mut first: Vec<(usize, usize, usize)> = Vec::new();
        for (t, points) in self.points.iter().enumerate() {
            self.sides.push([(); 3].map(|()| 0));
            for k in 0..3 {
                let (a, b) = (points[k], points[(k + 1) % 3]);
                let edge = *numbers.entry((a.min(b), a.max(b))).or_insert(first.len());
                if edge == first.len() {
                    first.push((t, k, 0));
                    self.edges.push(Feature::default());
                }
                self.sides[t][k] = edge;
                self.edges[edge].normal = plus(self.edges[edge].normal, 1.0, self.normals[t]);
                first[edge].2 += 1;
                let (other, j, count) = first[edge];
                if count == 2 && self.points[other][j] == a {
                    let [x, y, z] = self.corners[t][k];
                    return Err(format!("two triangles at ({x}, {y}, {z}) m are turned to different sides"));
                }
            }
        }
        for (edge, (t, k, _)) in first.into_iter().enumerate().filter(|(_, (.., count))| *count == 1) {
            let ends = [k, (k + 1) % 3];
            let along = minus(self.corners[t][ends[1]], self.corners[t][ends[0]]);
            let off = unit(cross(along, self.normals[t]));
            self.edges[edge].off.push(off);
            for end in ends {
                self.vertices[self.points[t][end]].off.push(off);
            }
        }
        Ok(())
    }

    /// Returns the number of triangles.
    pub(super) fn count(&self) -> usize {
        self.corners.len()
    }

    /// Returns the point where the line through `x` along the unit vector `n` enters the obstacle: behind `x` if `x` is
    /// inside, otherwise the first one ahead.
    pub(super) fn entry(&self, x: [f64; 3], n: [f64; 3]) -> Option<Entry> {
        [POSITION_ROUNDING, CRACK].into_iter().find_map(|slack| self.entry_within(x, n, slack * self.extent))
    }

    /// Computes [`Triangles::entry`] with triangles enlarged by `slack` (m) all around.
    fn entry_within(&self, x: [f64; 3], n: [f64; 3], slack: f64) -> Option<Entry> {
        let (mut behind, mut ahead): (Option<Entry>, Option<Entry>) = (None, None);
        let mut left = f64::NEG_INFINITY;
        for triangle in self.tree.along(x, n, slack) {
            let (normal, corners) = (self.normals[triangle], self.corners[triangle]);
            let facing = dot(normal, n);
            if facing.abs() <= SINGLE {
                continue;
            }
            let distance = dot(minus(corners[0], x), normal) / facing;
            let foot = plus(x, distance, n);
            let within = |k: usize| {
                let side = minus(corners[(k + 1) % 3], corners[k]);
                let inwards = dot(minus(foot, corners[k]), cross(normal, side));
                inwards >= 0.0 || inwards * inwards <= slack * slack * dot(side, side)
            };
            if !(0..3).all(within) {
                continue;
            }
            let entry = Entry { distance, triangle };
            match (facing < 0.0, distance <= 0.0) {
                (true, true) if behind.is_none_or(|last| last.distance < distance) => behind = Some(entry),
                (true, false) if ahead.is_none_or(|first| distance < first.distance) => ahead = Some(entry),
                (false, true) => left = left.max(distance),
                _ => {}
            }
        }
        behind.filter(|entry| entry.distance >= left).or(ahead)
    }

    /// Returns the distance (m) from `x` to the nearest point, negative inside, and the unit vector of its direction,
    /// into the obstacle; `None` if `x` is beyond the rim.
    pub(super) fn nearest(&self, x: [f64; 3]) -> Option<(f64, [f64; 3])> {
        let (_, triangle) = self.tree.nearest(x, |k| square_distance(&self.corners[k], x))?;
        let (foot, part) = nearest_of(&self.corners[triangle], x);
        let to = minus(foot, x);
        let feature = match part {
            TriangleFeature::Face => {
                let normal = self.normals[triangle].map(|c| -c);
                return Some((dot(to, normal), normal));
            }
            TriangleFeature::Side(k) => &self.edges[self.sides[triangle][k]],
            TriangleFeature::Corner(k) => &self.vertices[self.points[triangle][k]],
        };
        let distance = norm(to);
        if feature.off.iter().any(|off| -dot(to, off) > CRACK * distance.max(self.extent)) {
            return None;
        }
        let inward = unit(feature.normal.map(|c| -c));
        // Beyond a rim the surface goes on as a plane; on the surface itself, the direction to the nearest point is undefined.
        if !feature.off.is_empty() || distance <= SINGLE * self.extent {
            return Some((dot(to, inward), inward));
        }
        let sign = if dot(to, inward) < 0.0 { -1.0 } else { 1.0 };
        Some((sign * distance, to.map(|c| sign * c / distance)))
    }

    /// Returns the holes of the surface and the cracks of at most the width `reach` (m). Openings within rounding do
    /// not count.
    pub(super) fn holes(&self, reach: f64) -> Vec<Hole> {
        let (holes, others): (Vec<_>, Vec<_>) = self.rims().into_iter().partition(|rim| self.is_hole(rim));
        let along_crack =
            |rim: Vec<Side>| rim.into_iter().filter(|side| self.continues_across(side, reach)).collect::<Vec<_>>();
        holes.into_iter().chain(others.into_iter().map(along_crack)).filter_map(|rim| Hole::around(&rim)).collect()
    }

    /// Returns the rims: closed paths along sides that belong to only one triangle.
    fn rims(&self) -> Vec<Vec<Side>> {
        let mut from: HashMap<usize, Vec<(usize, Side)>> = HashMap::new();
        for (t, sides) in self.sides.iter().enumerate() {
            for (k, side) in sides.iter().enumerate() {
                let Some(off) = self.edges[*side].off.first() else { continue };
                let [a, b] = [k, (k + 1) % 3];
                let side = Side { ends: [self.corners[t][a], self.corners[t][b]], off: *off };
                from.entry(self.points[t][a]).or_default().push((self.points[t][b], side));
            }
        }
        let mut starts: Vec<usize> = from.keys().copied().collect();
        starts.sort_unstable();
        let mut rims = Vec::new();
        for start in starts {
            let (mut rim, mut at) = (Vec::new(), start);
            while let Some((next, side)) = from.get_mut(&at).and_then(Vec::pop) {
                rim.push(side);
                at = next;
                if at == start {
                    rims.push(std::mem::take(&mut rim));
                }
            }
            if !rim.is_empty() {
                rims.push(rim);
            }
        }
        rims
    }

    /// Returns `true` if the surface is around the rim and not within it: directions off the surface point into the
    /// rim.
    fn is_hole(&self, rim: &[Side]) -> bool {
        let centre = middle(rim);
        let into = rim.iter().map(|side| side.length() * dot(side.off, minus(centre, side.middle()))).sum::<f64>();
        let area = rim.iter().fold([0.0; 3], |sum, side| {
            plus(sum, 0.5, cross(minus(side.ends[0], centre), minus(side.ends[1], centre)))
        });
        let length = rim.iter().map(Side::length).sum::<f64>();
        // A rim that encloses no area is a seam whose corners differ by little; lines do not pass through it.
        let width = 2.0 * norm(area) / length;
        width > 2.0 * CRACK * self.extent && into > INTO * 2.0 * norm(area)
    }

    /// Returns `true` if another part of the surface is beyond the side of a rim, at most `distance_limit` (m) away,
    /// with a crack between them.
    fn continues_across(&self, side: &Side, distance_limit: f64) -> bool {
        let across = |step: f64| self.nearest(plus(side.middle(), step, side.off)).map(|(distance, _)| distance.abs());
        // The triangles beside a narrower crack meet what is in front of it.
        let is_open = across(PAST * CRACK * self.extent).is_none();
        is_open && across(distance_limit).is_some_and(|distance| distance < 0.5 * distance_limit)
    }
}

/// Returns the square of the distance of `x` from a triangle.
pub(super) fn square_distance(triangle: &[[f64; 3]; 3], x: [f64; 3]) -> f64 {
    let away = minus(nearest_of(triangle, x).0, x);
    dot(away, away)
}

/// Returns the point of a triangle that is nearest to `x`, and the face, side or corner that contains it (Ericson,
/// Real-Time Collision Detection, 5.1.5). If two corners coincide, the triangle is a side.
fn nearest_of(&[a, b, c]: &[[f64; 3]; 3], x: [f64; 3]) -> ([f64; 3], TriangleFeature) {
    let (ab, ac) = (minus(b, a), minus(c, a));
    let [from_a, from_b, from_c] = [a, b, c].map(|corner| minus(x, corner));
    let (d1, d2) = (dot(ab, from_a), dot(ac, from_a));
    let (d3, d4) = (dot(ab, from_b), dot(ac, from_b));
    let (d5, d6) = (dot(ab, from_c), dot(ac, from_c));
    let (of_a, of_b, of_c) = (d3 * d6 - d5 * d4, d5 * d2 - d1 * d6, d1 * d4 - d3 * d2);
    match () {
        () if d1 <= 0.0 && d2 <= 0.0 => (a, TriangleFeature::Corner(0)),
        () if d3 >= 0.0 && d4 <= d3 => (b, TriangleFeature::Corner(1)),
        () if d6 >= 0.0 && d5 <= d6 => (c, TriangleFeature::Corner(2)),
        () if of_c <= 0.0 && d1 >= 0.0 && d3 <= 0.0 => (plus(a, d1 / (d1 - d3), ab), TriangleFeature::Side(0)),
        () if of_b <= 0.0 && d2 >= 0.0 && d6 <= 0.0 => (plus(a, d2 / (d2 - d6), ac), TriangleFeature::Side(2)),
        () if of_a <= 0.0 && d4 >= d3 && d5 >= d6 => {
            (plus(b, (d4 - d3) / ((d4 - d3) + (d5 - d6)), minus(c, b)), TriangleFeature::Side(1))
        }
        () => {
            let all = of_a + of_b + of_c;
            (plus(plus(a, of_b / all, ab), of_c / all, ac), TriangleFeature::Face)
        }
    }
}

/// A hole or a crack in a surface.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Hole {
    /// The middle of its rim, m.
    pub middle: [f64; 3],
    /// The bounding box of its rim: the least and the largest coordinates, m.
    pub bounds: [[f64; 3]; 2],
    /// The longest side of that box, m.
    pub size: f64,
}

/// A side of a triangle on a rim.
#[derive(Debug, Clone, Copy)]
struct Side {
    ends: [[f64; 3]; 2],
    /// The unit vector pointing off the surface.
    off: [f64; 3],
}

impl Side {
    fn middle(&self) -> [f64; 3] {
        plus(self.ends[0], 0.5, minus(self.ends[1], self.ends[0]))
    }

    fn length(&self) -> f64 {
        norm(minus(self.ends[1], self.ends[0]))
    }
}

/// The least share of a hole's rim. The share measures how far the directions off the surface point into the area that
/// the rim encloses: 1 for a hole in a plane, -1 for the outer rim of a plane, 0 for the rim of a bowl.
const INTO: f64 = 0.5;

/// A point so many times as far from a rim as triangles reach meets only what is beyond a crack.
const PAST: f64 = 1.01;

/// Returns the mean of the middles of the sides, weighted by their lengths, m.
fn middle(rim: &[Side]) -> [f64; 3] {
    let length = rim.iter().map(Side::length).sum::<f64>();
    rim.iter().fold([0.0; 3], |sum, side| plus(sum, side.length() / length, side.middle()))
}

impl Hole {
    /// Returns the centre of the bounding box of its rim, m.
    pub fn box_centre(&self) -> [f64; 3] {
        let [low, high] = self.bounds;
        plus(low, 0.5, minus(high, low))
    }

    fn around(rim: &[Side]) -> Option<Self> {
        let points: Vec<[f64; 3]> = rim.iter().flat_map(|side| side.ends).collect();
        let bounds = (!points.is_empty()).then(|| Bounds::of(&points))?;
        Some(Hole { middle: middle(rim), bounds: [bounds.low, bounds.high], size: bounds.extent() })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Returns two triangles over the unit square at z = 1, facing down.
    fn ceiling() -> Triangles {
        let [a, b, c, d] = [[0.0, 0.0, 1.0], [1.0, 0.0, 1.0], [1.0, 1.0, 1.0], [0.0, 1.0, 1.0]];
        Triangles::new(vec![[a, c, b], [a, d, c], [a, a, b]]).unwrap()
    }

    /// Returns the unit cube, facing outwards.
    fn cube() -> Triangles {
        let at = |k: usize| [k & 1, k >> 1 & 1, k >> 2 & 1].map(|c| c as f64);
        let faces = [[0, 2, 3, 1], [4, 5, 7, 6], [0, 1, 5, 4], [2, 6, 7, 3], [0, 4, 6, 2], [1, 3, 7, 5]];
        let halves = faces.into_iter().flat_map(|[a, b, c, d]| [[a, b, c], [a, c, d]]);
        Triangles::new(halves.map(|corners| corners.map(at)).collect()).unwrap()
    }

    /// A line meets few boxes of a fan of slender triangles, and finds what it finds among all.
    #[test]
    fn slender_triangles_have_small_boxes() {
        let n = 2000;
        let at = |k: usize| (std::f64::consts::TAU * k as f64 / n as f64).sin_cos();
        let rim = |k: usize| [at(k).1, at(k).0, 0.1 * at(3 * k).1];
        let fan = Triangles::new((0..n).map(|k| [[0.0, 0.0, 0.5], rim(k), rim(k + 1)]).collect()).unwrap();
        for x in [[0.31, 0.44, 0.0], [-0.6, 0.6, 0.0], [0.2, -0.71, 0.3]] {
            let visited: HashSet<usize> = fan.tree.along(x, [0.0, 0.0, -1.0], 0.0).collect();
            assert!(visited.len() < n / 20, "{} of {n}", visited.len());
            let found = fan.entry(x, [0.0, 0.0, -1.0]).unwrap();
            assert!(visited.contains(&found.triangle));
            let nearest = |t: &[[f64; 3]; 3]| norm(minus(nearest_of(t, x).0, x));
            let least = fan.corners.iter().map(nearest).fold(f64::INFINITY, f64::min);
            assert!((fan.nearest(x).unwrap().0.abs() - least).abs() < 1e-12);
        }
    }

    /// A repeated triangle, beginning at any of its corners, counts once.
    #[test]
    fn repeated_triangles_are_left_out() {
        let cube = cube();
        let mut corners = cube.corners.clone();
        let turned = |[a, b, c]: [[f64; 3]; 3]| [b, c, a];
        corners.extend(cube.corners.iter().map(|corners| turned(*corners)));
        corners.push(turned(turned(cube.corners[3].map(|x| x.map(|c| if c == 0.0 { -0.0 } else { c })))));
        assert_eq!(Triangles::new(corners), Ok(cube));
        // The other side of a triangle is not the same.
        let [a, b, c] = ceiling().corners[0];
        assert_eq!(Triangles::new(vec![[a, b, c], [c, b, a]]).unwrap().count(), 2);
    }

    #[test]
    fn lines_enter_also_through_edges_and_from_within() {
        let up = [0.0, 0.0, 1.0];
        let at = |surface: &Triangles, x: [f64; 3], n: [f64; 3]| surface.entry(x, n).map(|entry| entry.distance);
        let ceiling = ceiling();
        assert_eq!(ceiling.count(), 2);
        for x in [[0.3, 0.3, 0.0], [0.0, 0.0, 0.0], [1.0, 0.5, 0.0], [1.0 + 9e-6, 0.5, 0.0]] {
            assert_eq!(at(&ceiling, x, up), Some(1.0));
        }
        assert_eq!(at(&ceiling, [0.3, 0.4, 1.1], up).map(|d| (1e12 * d).round()), Some(-1e11));
        assert_eq!(at(&ceiling, [0.3, 0.4, 2.0], [0.0, 0.0, -1.0]), None);
        assert_eq!(at(&ceiling, [1.0 + 1.1e-5, 0.5, 0.0], up), None);
        let cube = cube();
        assert_eq!(at(&cube, [0.5, 0.5, -2.0], up), Some(2.0));
        assert_eq!(at(&cube, [0.5, 0.5, 0.25], up), Some(-0.25));
        assert_eq!(at(&cube, [0.5, 0.5, 1.25], up), None);
    }

    #[test]
    fn the_nearest_point_of_faces_edges_and_corners() {
        let (ceiling, cube) = (ceiling(), cube());
        let third = 3.0_f64.sqrt().recip();
        for (x, distance, normal) in [
            ([0.5, 0.25, -0.5], 0.5, [0.0, 0.0, 1.0]),
            ([0.5, 0.5, 0.25], -0.25, [0.0, 0.0, 1.0]),
            ([-0.3, 0.5, -0.4], 0.5, [0.6, 0.0, 0.8]),
            ([-1.0, -1.0, -1.0], 1.0 / third, [third; 3]),
            ([1.0, 1.0, 1.0], 0.0, [-third; 3]),
        ] {
            let (d, n) = cube.nearest(x).unwrap();
            assert!((d - distance).abs() < 1e-14 && norm(minus(n, normal)) < 1e-14, "{x:?}: {d} {n:?}");
        }
        assert_eq!(ceiling.nearest([0.5, 0.5, 1.5]), Some((-0.5, [0.0, 0.0, 1.0])));
        // Beyond the rim there is no nearest point; directly below the rim there is.
        assert_eq!(ceiling.nearest([1.2, 0.5, 0.5]), None);
        assert_eq!(ceiling.nearest([1.2, 1.2, 1.0]), None);
        assert_eq!(ceiling.nearest([1.0, 1.0, 0.5]), Some((0.5, [0.0, 0.0, 1.0])));
    }

    #[test]
    fn surfaces_that_are_none() {
        assert!(Triangles::new(vec![[[1.0; 3]; 3]]).unwrap_err().contains("no triangle with an area"));
        let [a, b, c, d] = [[0.0; 3], [1.0, 0.0, 0.0], [1.0, 1.0, 0.0], [0.0, 1.0, 0.0]];
        assert!(Triangles::new(vec![[a, b, c], [a, d, c]]).is_err_and(|said| said.contains("different sides")));
    }
}
