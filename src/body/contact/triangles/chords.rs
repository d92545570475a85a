//! Curved surfaces that triangles approximate: how far they are beyond the triangles.

use std::collections::BTreeMap;
use std::rc::Rc;

use super::Triangles;
use crate::algebra::vector::{cross, dot, minus, norm, plus, unit};

/// Triangles whose normals differ by less than this angle, rad, are one flat face: coordinates are rounded.
const FLAT: f64 = 1e-4;

/// The largest angle, 44°, between faces of a curved surface; beyond it is an edge.
const SMOOTH: f64 = 0.768;

/// Faces are of one curved surface if their curvatures differ by less than this factor. Flats beside roundings have less, and chamfers
/// end at edges.
const ALIKE: f64 = 2.0;

/// The faces of a surface of triangles, each found when it is asked for, and once: a flat face may have most of the triangles.
pub(in crate::body::contact) struct Chords<'a> {
    surface: &'a Triangles,
    /// The triangles at each edge.
    beside: Vec<Vec<usize>>,
    /// The face of each triangle that belongs to a known one.
    face_of: BTreeMap<usize, usize>,
    faces: Vec<Face>,
}

/// A flat face.
struct Face {
    normal: [f64; 3],
    /// The centre of its area, m.
    centre: [f64; 3],
    /// Its border: a triangle of the face with the number of the side in it.
    border: Vec<(usize, usize)>,
    /// The bends to faces of the same curved surface, and the distance of this surface from the centre, once they are known.
    bends: Option<Rc<[Bend]>>,
    sagitta: Option<f64>,
}

/// The bend between two faces.
struct Bend {
    edge: usize,
    /// The other face.
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
        Chords { surface, beside, face_of: BTreeMap::new(), faces: Vec::new() }
    }

    /// Returns the distance of the curved surface from the centre of the face of a triangle, m: 0 unless at least two neighbours and
    /// theirs bend alike.
    pub(in crate::body::contact) fn sagitta(&mut self, triangle: usize) -> f64 {
        let face = self.face(triangle);
        if let Some(known) = self.faces[face].sagitta {
            return known;
        }
        let all = self.bends(face);
        let bends: Vec<&Bend> = all.iter().filter(|bend| self.goes_on(bend)).collect();
        let has_like = |bend: &&&Bend| {
            bends.iter().any(|other| other.other != bend.other && alike(other.curvature, bend.curvature))
        };
        let heights = bends.iter().filter(has_like).map(|bend| 0.5 * bend.curvature.abs() * bend.half * bend.half);
        let sagitta = heights.fold(0.0, f64::max);
        self.faces[face].sagitta = Some(sagitta);
        sagitta
    }

    /// Returns `true` if the face behind a bend bends alike at another of its edges.
    fn goes_on(&mut self, bend: &Bend) -> bool {
        let next = self.bends(bend.other);
        next.iter().any(|next| next.edge != bend.edge && alike(next.curvature, bend.curvature))
    }

    /// Returns the face of a triangle.
    fn face(&mut self, first: usize) -> usize {
        if let Some(known) = self.face_of.get(&first) {
            return *known;
        }
        let Triangles { corners, normals, sides, .. } = self.surface;
        let (face, normal) = (self.faces.len(), normals[first]);
        let (mut next, mut border) = (vec![first], Vec::new());
        let (mut area, mut moment) = (0.0, [0.0; 3]);
        self.face_of.insert(first, face);
        while let Some(t) = next.pop() {
            let [a, b, c] = corners[t];
            let size = norm(cross(minus(b, a), minus(c, a)));
            area += size;
            moment = [a, b, c].into_iter().fold(moment, |sum, x| plus(sum, size / 3.0, x));
            for (k, &edge) in sides[t].iter().enumerate() {
                let is_within = |other: &usize| *other != t && angle(normal, normals[*other]) < FLAT;
                match self.beside[edge].iter().copied().find(is_within) {
                    None => border.push((t, k)),
                    Some(other) if self.face_of.contains_key(&other) => {}
                    Some(other) => {
                        self.face_of.insert(other, face);
                        next.push(other);
                    }
                }
            }
        }
        let centre = moment.map(|c| c / area);
        self.faces.push(Face { normal, centre, border, bends: None, sagitta: None });
        face
    }

    /// Returns the bends of a face to faces of the same curved surface.
    fn bends(&mut self, face: usize) -> Rc<[Bend]> {
        if let Some(known) = &self.faces[face].bends {
            return Rc::clone(known);
        }
        let Triangles { corners, normals, sides, .. } = self.surface;
        let Face { normal, centre, .. } = self.faces[face];
        let border = self.faces[face].border.clone();
        // The face is flat, so that its furthest points are on its border.
        let rim: Vec<[f64; 3]> = border.iter().flat_map(|&(t, _)| corners[t]).map(|x| minus(x, centre)).collect();
        let mut bends = Vec::new();
        for (t, k) in border {
            let edge = sides[t][k];
            let Some(&other) = self.beside[edge].iter().find(|other| **other != t) else { continue };
            let turn = angle(normal, normals[other]);
            if self.beside[edge].len() != 2 || turn > SMOOTH {
                continue;
            }
            let from = corners[t][k];
            let along = minus(corners[t][(k + 1) % 3], from);
            let inward = unit(cross(normal, along));
            let own = dot(minus(centre, from), inward);
            let other = self.face(other);
            let behind = &self.faces[other];
            let across = dot(minus(behind.centre, from), unit(cross(along, behind.normal)));
            let convex = dot(normal, minus(behind.centre, from)) < 0.0;
            let curvature = turn / (own + across.abs());
            bends.push(Bend {
                edge,
                other,
                curvature: if convex { curvature } else { -curvature },
                half: rim.iter().map(|x| dot(*x, inward)).fold(0.0, f64::max),
            });
        }
        let bends: Rc<[Bend]> = bends.into();
        self.faces[face].bends = Some(Rc::clone(&bends));
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
