//! Curved surfaces that triangles approximate: how far they are beyond the triangles.

use std::collections::{BTreeMap, BTreeSet};

use super::Triangles;
use crate::algebra::vector::{cross, dot, minus, norm, plus, unit};

/// Triangles whose normals differ by less than this angle, rad, are one flat face: coordinates are rounded.
const FLAT: f64 = 1e-4;

/// The largest angle, 44°, between faces of a curved surface; beyond it is an edge.
const SMOOTH: f64 = 0.768;

/// Faces are of one curved surface if their curvatures differ by less than this factor. Flats beside roundings have less, and chamfers
/// end at edges.
const ALIKE: f64 = 2.0;

/// The faces of a surface of triangles.
pub(in crate::body::contact) struct Chords<'a> {
    surface: &'a Triangles,
    /// The triangles at each edge.
    beside: Vec<Vec<usize>>,
    known: BTreeMap<usize, f64>,
}

/// A flat face.
struct Face {
    triangles: BTreeSet<usize>,
    normal: [f64; 3],
    /// The centre of its area, m.
    centre: [f64; 3],
}

/// The bend between two faces.
struct Bend {
    edge: usize,
    /// A triangle of the other face.
    other: usize,
    /// The angle divided by the distance of the centres of both faces, positive if convex, 1/m.
    curvature: f64,
    /// The largest distance of the face beyond its centre, away from the edge, m.
    half: f64,
}

impl<'a> Chords<'a> {
    pub(in crate::body::contact) fn new(surface: &'a Triangles) -> Self {
        let mut beside = vec![Vec::new(); surface.edges.len()];
        for (t, sides) in surface.sides.iter().enumerate() {
            for &edge in sides {
                beside[edge].push(t);
            }
        }
        Chords { surface, beside, known: BTreeMap::new() }
    }

    /// Returns the distance of the curved surface from the centre of the face of a triangle, m: 0 unless at least two neighbours and
    /// theirs bend alike.
    pub(in crate::body::contact) fn beyond(&mut self, triangle: usize) -> f64 {
        if let Some(known) = self.known.get(&triangle) {
            return *known;
        }
        let face = self.face(triangle);
        let bends: Vec<Bend> = self.bends(&face).into_iter().filter(|bend| self.goes_on(bend)).collect();
        let has_like = |bend: &&Bend| {
            bends.iter().any(|other| other.other != bend.other && alike(other.curvature, bend.curvature))
        };
        let heights = bends.iter().filter(has_like).map(|bend| 0.5 * bend.curvature.abs() * bend.half * bend.half);
        let beyond = heights.fold(0.0, f64::max);
        self.known.extend(face.triangles.iter().map(|&t| (t, beyond)));
        beyond
    }

    /// Returns `true` if the face behind a bend bends alike at another of its edges.
    fn goes_on(&self, bend: &Bend) -> bool {
        let next = self.bends(&self.face(bend.other));
        next.iter().any(|next| next.edge != bend.edge && alike(next.curvature, bend.curvature))
    }

    fn face(&self, first: usize) -> Face {
        let Triangles { corners, normals, sides, .. } = self.surface;
        let (mut triangles, mut next) = (BTreeSet::from([first]), vec![first]);
        while let Some(t) = next.pop() {
            for &other in sides[t].iter().flat_map(|&edge| &self.beside[edge]) {
                if angle(normals[first], normals[other]) < FLAT && triangles.insert(other) {
                    next.push(other);
                }
            }
        }
        let (mut area, mut moment) = (0.0, [0.0; 3]);
        for &t in &triangles {
            let [a, b, c] = corners[t];
            let size = norm(cross(minus(b, a), minus(c, a)));
            area += size;
            moment = [a, b, c].into_iter().fold(moment, |sum, x| plus(sum, size / 3.0, x));
        }
        Face { triangles, normal: normals[first], centre: moment.map(|c| c / area) }
    }

    /// Returns the bends of a face to faces of the same curved surface.
    fn bends(&self, face: &Face) -> Vec<Bend> {
        let Triangles { corners, normals, sides, .. } = self.surface;
        let mut bends = Vec::new();
        for (&t, k) in face.triangles.iter().flat_map(|t| (0..3).map(move |k| (t, k))) {
            let edge = sides[t][k];
            let Some(&other) = self.beside[edge].iter().find(|other| !face.triangles.contains(other)) else { continue };
            let turn = angle(face.normal, normals[other]);
            if self.beside[edge].len() != 2 || turn > SMOOTH {
                continue;
            }
            let from = corners[t][k];
            let along = minus(corners[t][(k + 1) % 3], from);
            let inward = unit(cross(face.normal, along));
            let own = dot(minus(face.centre, from), inward);
            let behind = self.face(other);
            let across = dot(minus(behind.centre, from), unit(cross(along, behind.normal)));
            let far = face.triangles.iter().flat_map(|&t| corners[t]).map(|x| dot(minus(x, face.centre), inward));
            let convex = dot(face.normal, minus(behind.centre, from)) < 0.0;
            let curvature = turn / (own + across.abs());
            bends.push(Bend {
                edge,
                other: behind.triangles.first().copied().unwrap_or(other),
                curvature: if convex { curvature } else { -curvature },
                half: far.fold(0.0, f64::max),
            });
        }
        bends
    }
}

/// Returns the angle between unit vectors, rad.
fn angle(a: [f64; 3], b: [f64; 3]) -> f64 {
    norm(cross(a, b)).atan2(dot(a, b))
}

fn alike(a: f64, b: f64) -> bool {
    a * b > 0.0 && a.abs() < ALIKE * b.abs() && b.abs() < ALIKE * a.abs()
}
