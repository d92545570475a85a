//! The covered part of each slave facet: segments in front of master facets, and the integrals over them.

use super::GapAt;
use super::bulge::Bulges;
use super::error::{MortarFault, place};
use super::facet::{MOST, Plane, Values, position};
use super::search::{Masters, least_distance};
use super::segment::{Point, Rules, Segment, Side, segment, size};
use crate::algebra::vector::dot;
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
            let seen = plane.project(mesh, facet);
            let whole = size(mesh.dimension, &seen);
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
                let Segment { points, too_bent } = segment(mesh.dimension, &seen, whole, &opposite, &rules);
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
                    let beyond = own.distance + bulges[1].at(mesh, edges, (f, sides[1]), &point.master).distance;
                    point.gap - (own.across(point.gap) - beyond) / own.cosine
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
        let seen = plane.project(mesh, facet);
        let whole = size(mesh.dimension, &seen);
        let moved = |facet: &[usize], shape: &Values| -> f64 {
            let along = |node: usize| u.get(node).map_or(0.0, |u| dot(plane.normal, *u));
            facet.iter().zip(shape).map(|(&node, n)| n * along(node)).sum()
        };
        for &[_, f] in group {
            // It is of the mesh as it was when the segment was found, so that no facet of it is bent too much.
            for point in segment(mesh.dimension, &seen, whole, &plane.project(mesh, &master[f]), &rules).points {
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
