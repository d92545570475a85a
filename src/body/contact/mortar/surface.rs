//! The normals of the surface on which the nodes of a boundary lie.

use std::collections::{BTreeMap, BTreeSet};

use crate::algebra::elimination::solve;
use crate::algebra::vector::{across, cross, dot, minus, norm, plus, unit};
use crate::body::mesh::{Boundary, Mesh};

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
        let straight = |[a, m, b]: [usize; 3]| {
            let [a, m, b] = [a, m, b].map(|node| mesh.nodes[node]);
            let edge = minus(b, a);
            norm(across(minus(m, a), unit(edge))) < STRAIGHT * norm(edge)
        };
        let corners = |facet: &Vec<usize>| match mesh.is_quadratic(facet) {
            true if mesh.bent_edges(facet).into_iter().all(straight) => facet.iter().step_by(2).copied().collect(),
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
    pub(super) fn has_edges(&self, least: f64) -> bool {
        let apart = |f: usize, g: usize| (least..=self.smooth).contains(&dot(self.normals[f], self.normals[g]));
        let any =
            |facets: &Vec<usize>| facets.iter().any(|&f| facets.iter().any(|&g| apart(f, g) && self.are_beside(f, g)));
        self.around.values().any(any)
    }

    /// Returns the corners of facet `f`; none if it follows the surface.
    pub(super) fn corners(&self, f: usize) -> &[usize] {
        &self.corners[f]
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
        let beyond = self.fan(node, f).into_iter().flat_map(corners).filter(|(corner, _)| *corner != node);
        beyond.filter(|corner| back(corner) > 0.0).max_by(|a, b| back(a).total_cmp(&back(b)))
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
        let (along, beyond) = across_surface.map_or((half / (u * u + v * v), 0.0), |k| (half, half * k * w * w));
        let terms = [u, v, along * u * u, 2.0 * along * u * v, along * v * v, w - beyond];
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
    let (mean, spread) = (0.5 * (first + second), (0.5 * (first - second)).hypot(twist));
    // More than the curvature of a circle of six facets comes from scattered nodes.
    let across = ((mean + spread.copysign(mean)) / length).clamp(-1.0, 1.0);
    normal.iter().all(|c| c.is_finite()).then_some(Fit { normal, across })
}
