//! The covered part of each slave facet: segments in front of master facets, the integrals over them, and the biorthogonal
//! basis there with the contribution of the facet to the rows of its nodes.

use std::collections::BTreeSet;

use super::bulge::Bulges;
use super::facet::{MOST, Plane, Point, Rules, Segment, Side, Values, position, segment, size};
use super::{GapAt, MortarFault, place};
use crate::algebra::vector::{cross, dot, minus, unit};
use crate::body::contact::tree::{Bounds, Tree};
use crate::body::contact::triangles::square_distance;
use crate::body::fem::bernstein;
use crate::body::mesh::{Boundary, Facet, Mesh};

/// A facet does not contribute to the rows if less than this share of it is covered.
const COVERED: f64 = 1e-10;

/// A facet counts as covered twice if its covered share exceeds 1 by more than this.
const COVER_SLACK: f64 = 1e-9;

/// The integrals over the covered part of a slave facet, with the functions Ñ of [`bernstein`] on both sides.
pub(super) struct Cover {
    /// The covered share of the facet.
    pub share: f64,
    /// The outward unit normal.
    pub normal: [f64; 3],
    /// `∫ Ñ_i dA`, m or m².
    pub functions: Values,
    /// `∫ Ñ_i Ñ_j dA`.
    pub mass: [Values; MOST],
    /// `∫ Ñ_i Ñ_k dA` for each node k of the master, in ascending order.
    pub cross: Vec<(usize, Values)>,
    /// `∫ Ñ_i b dA`, where b is the sum of the bulges of both surfaces towards each other along the
    /// normal of the facet, m; see [`Bulges`]. First with edges of the body, then as if there were none.
    pub bulge: [Values; 2],
}

/// The covered parts of all slave facets.
pub(super) struct Covers {
    /// The cover of each slave facet.
    pub facets: Vec<Cover>,
    /// The facets of each segment: of the slave, of the master.
    pub segments: Vec<[usize; 2]>,
    /// `∫ Ñ_k dA` over the segments, for the nodes of each facet of the master.
    pub on_master: Vec<Values>,
    /// The least and the largest gap at the integration points.
    pub gaps: [GapAt; 2],
}

impl Covers {
    pub(super) fn new(mesh: &Mesh, slave: &Boundary, master: &Boundary, search: f64) -> Result<Self, MortarFault> {
        let (masters, rules) = (Masters::new(mesh, master), Rules::new());
        let bulges = [slave, master].map(|side| Bulges::new(mesh, side));
        let have_edges = bulges.iter().any(Bulges::have_edges);
        let nowhere = |gap| GapAt { gap, at: [0.0; 3] };
        let mut covers = Covers {
            facets: Vec::with_capacity(slave.facets.len()),
            segments: Vec::new(),
            on_master: vec![[0.0; MOST]; master.facets.len()],
            gaps: [nowhere(f64::INFINITY), nowhere(f64::NEG_INFINITY)],
        };
        for (e, facet) in slave.facets.iter().enumerate() {
            let plane = Plane::of(mesh, facet);
            let projected = plane.project(mesh, facet);
            let whole = size(mesh.dimension, &projected);
            let mut covered = 0.0;
            let mut cover = Cover {
                share: 0.0,
                normal: plane.normal,
                functions: [0.0; MOST],
                mass: [[0.0; MOST]; MOST],
                cross: Vec::new(),
                bulge: [[0.0; MOST]; 2],
            };
            for f in masters.facing(&mesh.points(facet), plane.normal, search) {
                let opposite = plane.project(mesh, &master.facets[f]);
                let Segment { points, too_bent } = segment(mesh.dimension, &projected, whole, &opposite, &rules);
                if points.is_empty() && too_bent.is_none() || !points.iter().all(|point| point.gap.abs() <= search) {
                    continue;
                }
                // As far as can be told it is in front of the slave, and as far as cannot, it may be.
                if let Some(side) = too_bent {
                    let (boundary, facet) = match side {
                        Side::Slave => (slave, facet),
                        Side::Master => (master, &master.facets[f]),
                    };
                    let at = place(mesh, centre(mesh, facet));
                    return Err(MortarFault::TooBent { boundary: boundary.name.clone(), at });
                }
                covered += points.iter().map(|point| point.weight).sum::<f64>();
                let sides = [&slave.facets[e], &master.facets[f]];
                let excess = |edges: bool, point: &Point| {
                    let own = bulges[0].at(mesh, edges, (e, sides[0]), &point.slave);
                    let bulge = own.distance + bulges[1].at(mesh, edges, (f, sides[1]), &point.master).distance;
                    point.gap - (own.across(point.gap) - bulge) / own.cosine
                };
                let bulge = |point: &Point| {
                    let with = excess(true, point);
                    [with, if have_edges { excess(false, point) } else { with }]
                };
                cover.add(mesh, sides, &bulge, &points, &mut covers.on_master[f]);
                covers.segments.push([e, f]);
                covers.widen(mesh, facet, &points);
            }
            cover.share = covered / whole;
            if cover.share > 1.0 + COVER_SLACK {
                let [slave, master] = [slave, master].map(|side| side.name.clone());
                return Err(MortarFault::TwoLayers { slave, master, at: place(mesh, centre(mesh, facet)) });
            }
            cover.finish();
            covers.facets.push(cover);
        }
        if covers.segments.is_empty() {
            return Err(nothing_in_front(mesh, [slave, master], search));
        }
        Ok(covers)
    }

    fn widen(&mut self, mesh: &Mesh, facet: &[usize], points: &[Point]) {
        for point in points {
            let at = || position(mesh, facet, &point.slave);
            if point.gap < self.gaps[0].gap {
                self.gaps[0] = GapAt { gap: point.gap, at: at() };
            }
            if point.gap > self.gaps[1].gap {
                self.gaps[1] = GapAt { gap: point.gap, at: at() };
            }
        }
    }
}

impl Cover {
    /// Returns `true` if enough is covered for the facet to contribute to rows.
    pub(super) fn counts(&self) -> bool {
        self.share > COVERED
    }

    /// Adds the integrals over a segment.
    fn add(
        &mut self,
        mesh: &Mesh,
        [facet, master]: [&Facet; 2],
        bulge: &dyn Fn(&Point) -> [f64; 2],
        points: &[Point],
        on_master: &mut Values,
    ) {
        let mut cross = [[0.0; MOST]; MOST];
        for point in points {
            let weight = point.weight * mesh.geometry.depth(position(mesh, facet, &point.slave));
            let bulge = bulge(point);
            let (slave, master) = (raised(mesh, facet, point.slave), raised(mesh, master, point.master));
            for (i, n) in slave.iter().enumerate() {
                let share = weight * n;
                self.functions[i] += share;
                self.bulge.iter_mut().zip(bulge).for_each(|(sums, bulge)| sums[i] += share * bulge);
                self.mass[i].iter_mut().zip(&slave).for_each(|(sum, n)| *sum += share * n);
                cross.iter_mut().zip(&master).for_each(|(sums, n)| sums[i] += share * n);
            }
            on_master.iter_mut().zip(&master).for_each(|(sum, n)| *sum += weight * n);
        }
        self.cross.extend(master.iter().copied().zip(cross));
    }

    /// Adds up the terms of each master node.
    fn finish(&mut self) {
        self.cross.sort_by_key(|(node, _)| *node);
        self.cross.dedup_by(|(node, values), (last, sum)| {
            let same = node == last;
            if same {
                sum.iter_mut().zip(values).for_each(|(sum, value)| *sum += *value);
            }
            same
        });
    }
}

/// Replaces the shape functions by Ñ.
fn raised(mesh: &Mesh, facet: &[usize], mut shape: Values) -> Values {
    if mesh.is_quadratic(facet) {
        let raised = bernstein(mesh, facet, &shape[..facet.len()]);
        shape[..facet.len()].copy_from_slice(&raised);
    }
    shape
}

/// Returns the mean of the nodes of a facet, m.
fn centre(mesh: &Mesh, facet: &[usize]) -> [f64; 3] {
    let x = mesh.points(facet);
    [0, 1, 2].map(|c| x.iter().map(|x| x[c]).sum::<f64>() / x.len() as f64)
}

/// Returns the least gap of the segments and its position after the nodes have moved by `u` (m):
/// `ν · (x_m + u_m - x_s - u_s)` at the integration points.
pub(super) fn least_gap(
    mesh: &Mesh,
    [slave, master]: [&[Facet]; 2],
    segments: &[[usize; 2]],
    u: &[[f64; 3]],
) -> Option<GapAt> {
    let rules = Rules::new();
    let mut least: Option<GapAt> = None;
    // The segments of one slave facet are consecutive.
    for group in segments.chunk_by(|a, b| a[0] == b[0]) {
        let facet = &slave[group[0][0]];
        let plane = Plane::of(mesh, facet);
        let projected = plane.project(mesh, facet);
        let whole = size(mesh.dimension, &projected);
        let moved = |facet: &[usize], shape: &Values| -> f64 {
            let along = |node: usize| u.get(node).map_or(0.0, |u| dot(plane.normal, *u));
            facet.iter().zip(shape).map(|(&node, n)| n * along(node)).sum()
        };
        for &[_, f] in group {
            // It is of the mesh as it was when the segment was found, so that no facet of it is bent too much.
            for point in segment(mesh.dimension, &projected, whole, &plane.project(mesh, &master[f]), &rules).points {
                let gap = point.gap + moved(&master[f], &point.master) - moved(facet, &point.slave);
                if least.is_none_or(|least| gap < least.gap) {
                    least = Some(GapAt { gap, at: position(mesh, facet, &point.slave) });
                }
            }
        }
    }
    least
}

/// Returns the error that the second boundary covers nothing, or almost nothing, of the first within `search` (m).
pub(super) fn nothing_in_front(mesh: &Mesh, sides: [&Boundary; 2], search: f64) -> MortarFault {
    let (least, at) = least_distance(mesh, sides);
    let [slave, master] = sides.map(|side| side.name.clone());
    MortarFault::NothingInFront { slave, master, search, least, at: place(mesh, at) }
}

/// A sum counts as rounding if it is at most this share of its terms.
const CANCELLED_SHARE: f64 = 1e-13;

/// A pivot below this counts as rounding; the diagonal is scaled to 1.
const SINGULAR: f64 = 1e-15;

/// The contribution of a facet to the row of one of its nodes.
pub(super) struct FacetShare {
    pub node: usize,
    /// `∫ ψ_j dA`, m or m².
    pub weight: f64,
    /// `∫ ψ_j Ñ_i dA` for nodes of the facet.
    pub slave: Vec<(usize, f64)>,
    /// `∫ ψ_j Ñ_k dA` for nodes of the master, in ascending order; the values add up to the weight.
    pub master: Vec<(usize, f64)>,
    /// `∫ ψ_j b dA` with the bulges `b` of both sides, see [`Cover::bulge`], m² or m³.
    pub bulge: [f64; 2],
}

/// Computes the contributions of a `facet` to its nodes that are not `lost`. The functions ψ_j are
///
/// ```text
/// ψ = A Ñ,   A = diag(∫ Ñ) (∫ Ñ Ñᵀ)⁻¹:   ∫ ψ_i Ñ_j dA = δ_ij ∫ Ñ_j dA,   Σ ψ_j = 1,
/// ```
///
/// with integrals over the covered part of the facet. The function of a lost node is added in equal parts to the
/// functions of the nodes that [`takers`] returns. Empty if the cover is too thin to distinguish the functions.
pub(super) fn facet_shares(mesh: &Mesh, facet: &[usize], cover: &Cover, lost: &BTreeSet<usize>) -> Vec<FacetShare> {
    let (kept, gone): (Vec<usize>, Vec<usize>) = (0..facet.len()).partition(|&i| !lost.contains(&facet[i]));
    let Some(dual) = dual(cover, facet.len()).filter(|_| cover.counts() && !kept.is_empty()) else { return Vec::new() };
    let edges = if gone.is_empty() { Vec::new() } else { mesh.bent_edges(facet) };
    let gone: Vec<(usize, Vec<usize>)> = gone.into_iter().map(|k| (k, takers(facet, &edges, &kept, k))).collect();
    let share_of = |&i: &usize| {
        let received = gone.iter().filter(|(_, takers)| takers.contains(&i));
        let terms =
            || std::iter::once((i, 1.0)).chain(received.clone().map(|(k, takers)| (*k, 1.0 / takers.len() as f64)));
        let weight = terms().map(|(k, share)| share * cover.functions[k]).sum();
        let slave = terms().map(|(k, share)| (facet[k], share * cover.functions[k]));
        let bulge = cover.bulge.map(|bulge| {
            terms().map(|(k, share)| share * dual[k].iter().zip(&bulge).map(|(a, c)| a * c).sum::<f64>()).sum()
        });
        let psi: Values = std::array::from_fn(|j| terms().map(|(k, share)| share * dual[k][j]).sum());
        FacetShare { node: facet[i], weight, slave: slave.collect(), master: on_master(cover, &psi, weight), bulge }
    };
    kept.iter().map(share_of).collect()
}

/// Returns the nodes of `kept`, by their local numbers, that take the function of the lost node `k` of a facet. On
/// facets of second order the displacement of a node between corners contains those of the two corners. If both corners
/// took the function, each would have a displacement relative to the other. Therefore a corner takes it only if no
/// other end of that edge is kept; if no node qualifies, the kept node with the lowest number takes it.
fn takers(facet: &[usize], edges: &[[usize; 3]], kept: &[usize], k: usize) -> Vec<usize> {
    let edge = |node: usize| edges.iter().find(|[_, middle, _]| *middle == node);
    let Some(&[a, _, b]) = edge(facet[k]) else { return kept.to_vec() };
    let other_end_is_kept = |i: usize| kept.iter().any(|&j| j != i && [a, b].contains(&facet[j]));
    let takes = |i: &usize| edge(facet[*i]).is_some() || !other_end_is_kept(*i);
    let takers: Vec<usize> = kept.iter().copied().filter(takes).collect();
    if takers.is_empty() { kept.iter().copied().min_by_key(|&i| facet[i]).into_iter().collect() } else { takers }
}

/// Computes `∫ ψ Ñ_k dA` without rounding errors of zeros; the largest value is set so that the sum equals the weight.
fn on_master(cover: &Cover, psi: &Values, weight: f64) -> Vec<(usize, f64)> {
    let integral = |(node, values): &(usize, Values)| {
        let (sum, size) =
            psi.iter().zip(values).fold((0.0, 0.0), |(sum, size), (a, c)| (sum + a * c, size + (a * c).abs()));
        (sum.abs() > CANCELLED_SHARE * size).then_some((*node, sum))
    };
    let mut master: Vec<(usize, f64)> = cover.cross.iter().filter_map(integral).collect();
    let rest = weight - master.iter().map(|(_, value)| value).sum::<f64>();
    if let Some((_, largest)) = master.iter_mut().max_by(|(_, a), (_, b)| a.abs().total_cmp(&b.abs())) {
        *largest += rest;
    }
    if let [(_, only)] = &mut master[..] {
        *only = weight;
    }
    master
}

/// Computes A by elimination in the mass matrix with its diagonal scaled to 1, so that a thin cover does not harm the
/// condition.
fn dual(cover: &Cover, count: usize) -> Option<[Values; MOST]> {
    let scale: Values = std::array::from_fn(|i| if i < count { cover.mass[i][i].sqrt().recip() } else { 0.0 });
    let mut mass: [Values; MOST] =
        std::array::from_fn(|i| std::array::from_fn(|j| cover.mass[i][j] * scale[i] * scale[j]));
    let mut inverse: [Values; MOST] = std::array::from_fn(|i| std::array::from_fn(|j| f64::from(u8::from(i == j))));
    for k in 0..count {
        let pivot = mass[k][k];
        if !(SINGULAR..f64::INFINITY).contains(&pivot) {
            return None;
        }
        for matrix in [&mut mass, &mut inverse] {
            matrix[k] = matrix[k].map(|c| c / pivot);
        }
        for i in (0..count).filter(|&i| i != k) {
            let factor = mass[i][k];
            for matrix in [&mut mass, &mut inverse] {
                let row = matrix[k];
                matrix[i].iter_mut().zip(row).for_each(|(c, r)| *c -= factor * r);
            }
        }
    }
    Some(std::array::from_fn(|i| std::array::from_fn(|j| cover.functions[i] * scale[i] * inverse[i][j] * scale[j])))
}

/// Two facets face each other if the cosine of the angle between their normals is below minus this.
const FACING: f64 = 0.1;

/// The default search distance, as a share of the size of the smaller boundary.
const SHARE_OF_SIZE: f64 = 0.1;

/// The facets of the master, in a tree.
struct Masters {
    normals: Vec<[f64; 3]>,
    tree: Tree,
}

impl Masters {
    pub(super) fn new(mesh: &Mesh, master: &Boundary) -> Self {
        let bounds = master.facets.iter().map(|facet| Bounds::of(&mesh.points(facet)));
        let normals = master.facets.iter().map(|facet| unit(mesh.area_vector(facet))).collect();
        Masters { tree: Tree::new(bounds), normals }
    }

    /// Returns the facets within `search` (m) of a slave facet with nodes at `points` that face its `normal`, in
    /// ascending order.
    pub(super) fn facing(&self, points: &[[f64; 3]], normal: [f64; 3], search: f64) -> Vec<usize> {
        let around = Bounds::of(points).grown(search);
        let faces = |k: &usize| dot(self.normals[*k], normal) < -FACING;
        let mut facing: Vec<usize> = self.tree.around(&around).filter(faces).collect();
        facing.sort_unstable();
        facing
    }
}

/// Returns a tenth of the longest side of the bounding box of the smaller boundary, m.
pub(super) fn default_search(mesh: &Mesh, sides: [&Boundary; 2]) -> f64 {
    let size = |side: &Boundary| Bounds::of(&mesh.points(&side.facets.concat())).extent();
    SHARE_OF_SIZE * size(sides[0]).min(size(sides[1]))
}

/// Fails if a quadrilateral is not convex.
pub(super) fn convex(mesh: &Mesh, boundary: &Boundary) -> Result<(), MortarFault> {
    for facet in boundary.facets.iter().filter(|facet| mesh.dimension == 3 && matches!(facet.len(), 4 | 8)) {
        let corners: Vec<usize> = facet.iter().step_by(facet.len() / 4).copied().collect();
        let (normal, points) = (mesh.area_vector(facet), mesh.points(&corners));
        let turns = |k: usize| {
            let to = |other: usize| minus(points[other % 4], points[k]);
            dot(cross(to(k + 1), to(k + 3)), normal) > 0.0
        };
        if !(0..4).all(turns) {
            let centre = [0, 1, 2].map(|c| points.iter().map(|x| 0.25 * x[c]).sum());
            return Err(MortarFault::NotConvex { boundary: boundary.name.clone(), at: place(mesh, centre) });
        }
    }
    Ok(())
}

/// Returns the least distance (m) from a node of either boundary to the other boundary, and the position of that node.
fn least_distance(mesh: &Mesh, sides: [&Boundary; 2]) -> (f64, [f64; 3]) {
    let mut least = (f64::INFINITY, [0.0; 3]);
    for [from, to] in [sides, [sides[1], sides[0]]] {
        let fan = |facet: &Vec<usize>| {
            let x = mesh.points(facet);
            let corners = move |k: usize| [x[0], x[k], x[(k + 1).min(x.len() - 1)]];
            (1..facet.len().max(3) - 1).map(corners).collect::<Vec<_>>()
        };
        let triangles: Vec<[[f64; 3]; 3]> = to.facets.iter().flat_map(fan).collect();
        let tree = Tree::new(triangles.iter().map(|corners| Bounds::of(corners)));
        for node in from.nodes() {
            let x = mesh.nodes[node];
            if let Some((square, _)) =
                tree.nearest(x, |k| square_distance(&triangles[k], x)).filter(|of| of.0.sqrt() < least.0)
            {
                least = (square.sqrt(), x);
            }
        }
    }
    least
}
