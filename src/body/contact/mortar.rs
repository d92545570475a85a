//! Pairs of boundaries: the rows of a dual mortar method, from the integrals over what two boundaries have in common.
//!
//! One of the two, the slave, has the law: one row a node j,
//!
//! ```text
//! w_j = Σ D_ji u_i - Σ P_jk u_k,   n_j · w_j ≤ g_j,
//! D_ji = ∫ ψ_j N_i dA / l_j,  P_jk = ∫ ψ_j N_k dA / l_j,  g_j = ∫ ψ_j (x_m - x_s) · ν dA / l_j,  l_j = ∫ ψ_j dA,
//! ```
//!
//! i over nodes of the slave, k over those of the master, all over the part of the slave that the master is in front of, seen along the
//! normal ν of each slave facet. With the biorthogonal ψ (`basis`) D is the identity on facets of the first order, so that each node has
//! a law of its own, and `2 u_m - ½ (u_a + u_b)` on those of the second; between meshes that match the rows are those from node to node.

mod basis;
mod bulge;
mod cover;
mod error;
mod facet;
mod normals;
mod search;
mod segment;
mod side;
mod supports;

use std::collections::{BTreeMap, BTreeSet};

pub use error::MortarFault;
pub use side::{SlaveChoice, SlaveReason};
pub use supports::Supports;

use crate::algebra::vector::{dot, minus, plus, unit};
use crate::body::fem::{bernstein, facet_weights};
use crate::body::mesh::{Boundary, Facet, Mesh};
use cover::{Cover, Covers};
use error::place;

/// A node of which less than this share is covered has no row.
const THIN: f64 = 1e-6;

/// A node of whose share in each facet less than this is covered is beyond the end of the other body. Where that ends at a node of the
/// slave, the whole share of one facet is covered.
const BEYOND: f64 = 0.5;

/// How two boundaries are paired.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct MortarOptions {
    /// No gap may be larger, nor an overlap, m; without it a tenth of the size of the smaller boundary, the longest side of the box
    /// around it.
    pub search: Option<f64>,
    /// The normal of all rows, out of the slave; without it each node has the mean of the slave's normal and the opposite of the
    /// master's.
    pub direction: Option<[f64; 3]>,
}

/// The rows of a pair of boundaries.
#[derive(Debug, Clone, PartialEq)]
pub struct Mortar {
    /// By ascending slave node.
    pub rows: Vec<MortarRow>,
    /// The share of each slave facet that master facets are in front of.
    pub covered: Vec<f64>,
    /// The least and the largest gap at the integration points.
    pub gaps: [GapAt; 2],
    /// How far was looked for the master, m.
    pub search: f64,
    /// `∫ Ñ_k dA` over the covered part for the nodes of the master, m or m², all
    /// around in a body of revolution; by ascending node, without nodes of which next to nothing is covered.
    pub master_weights: Vec<(usize, f64)>,
    /// Whether nodes of the master are beyond the end of the slave.
    master_beyond: bool,
    /// The facets of each segment: of the slave, of the master.
    segments: Vec<[usize; 2]>,
    /// The facets of the slave and of the master.
    facets: [Vec<Facet>; 2],
}

/// The row of a slave node.
#[derive(Debug, Clone, PartialEq)]
pub struct MortarRow {
    /// The slave node.
    pub node: usize,
    /// `l_j = ∫ ψ_j dA`: m in two dimensions, m² in three and, all around, in a body of revolution.
    pub weight: f64,
    /// The mean gap `g_j` at the node, weighted by ψ_j, m: negative where bodies overlap.
    pub gap: f64,
    /// The common unit normal, out of the slave.
    pub normal: [f64; 3],
    /// The largest share of what the node has in one of its facets that is covered.
    pub covered: f64,
    /// By how much the gap is smaller, in the same mean, between the curved surfaces that the facets of both sides stand for, m; 0 on flat
    /// boundaries and those of the second order.
    pub bulge: f64,
    /// Orthonormal directions along which supports let neither side move.
    pub still: Vec<[f64; 3]>,
    /// `D_ji`, by ascending node: 1 at the node itself; 2 and twice -½ at a node between corners.
    pub slave: Vec<(usize, f64)>,
    /// `P_jk`, by ascending node; they add up to 1.
    pub master: Vec<(usize, f64)>,
}

impl MortarRow {
    /// Whether less than half of what the node has in a facet is covered, so that its force acts beyond the end of the other body.
    pub fn is_beyond_the_end(&self) -> bool {
        self.covered < BEYOND
    }
}

/// A gap and its place on the slave.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct GapAt {
    /// From the slave to the master along the normal of the slave facet, m; negative where they overlap.
    pub gap: f64,
    /// The point of the slave, m.
    pub at: [f64; 3],
}

impl Mortar {
    /// The rows of `slave` in front of `master`, both boundaries of `mesh`, whose nodes `supports` hold.
    ///
    /// # Errors
    ///
    /// Fails if nothing is in front of the slave, or twice; if supports hold the slave; if quadrilaterals are not convex, or normals
    /// cancel.
    pub fn new(
        mesh: &Mesh,
        slave: &Boundary,
        master: &Boundary,
        options: &MortarOptions,
        supports: &dyn Supports,
    ) -> Result<Self, MortarFault> {
        search::convex(mesh, slave)?;
        search::convex(mesh, master)?;
        let search = options.search.unwrap_or_else(|| search::default_search(mesh, [slave, master]));
        let covers = Covers::new(mesh, slave, master, search)?;
        let still = supports::still(slave, &covers.facets, supports);
        let still_of = |node: usize| still.get(&node).cloned().unwrap_or_default();
        let mut normals = normals::nodal(mesh, slave, &still)?;
        if let Some(direction) = options.direction.map(unit) {
            for (&node, normal) in &mut normals {
                let outwards = dot(*normal, direction) > 0.0;
                if !outwards {
                    return Err(MortarFault::Inwards { slave: slave.name.clone(), at: place(mesh, mesh.nodes[node]) });
                }
                *normal = direction;
            }
        }
        // As its facets are: on a plane of symmetry the row of the slave's node there has no part across it.
        let opposite = normals::nodal(mesh, master, &BTreeMap::new())?;
        let shares = covered_shares(mesh, slave, covers.facets.iter().map(|cover| &cover.functions));
        let lost = lost(mesh, slave, master, &covers.facets, &normals, supports);
        let mut edges = edges_of(mesh, &slave.facets);
        edges.extend(edges_of(mesh, &master.facets));
        let mut sums = BTreeMap::<usize, Sum>::new();
        for (facet, cover) in slave.facets.iter().zip(&covers.facets) {
            for part in basis::parts(mesh, facet, cover, &lost) {
                let along = (!mesh.is_quadratic(facet)).then_some(cover.normal);
                sums.entry(part.node).or_default().add(mesh, &edges, along, part);
            }
            for (k, values) in cover.cross.iter().filter(|_| options.direction.is_none()) {
                for (node, value) in facet.iter().zip(values) {
                    if let Some(sum) = sums.get_mut(node) {
                        sum.opposite = plus(sum.opposite, *value, opposite[k]);
                    }
                }
            }
        }
        let row = |(node, sum): (usize, Sum)| {
            let normal = if options.direction.is_some() {
                normals[&node]
            } else {
                normals::common(normals[&node], sum.opposite, &still_of(node)).ok_or_else(|| {
                    MortarFault::NormalsCancel { boundary: master.name.clone(), at: place(mesh, mesh.nodes[node]) }
                })?
            };
            Ok(MortarRow { covered: shares[&node], still: still_of(node), ..sum.row(node, normal) })
        };
        let rows = sums.into_iter().map(row).collect::<Result<Vec<MortarRow>, MortarFault>>()?;
        if rows.is_empty() {
            let is_held = |(node, normal): (&usize, &[f64; 3])| normals::is_held(*normal, &supports.held(*node));
            let faced = slave.facets.iter().zip(&covers.facets).filter(|(_, cover)| cover.share > 0.0);
            let meets = faced.flat_map(|(facet, _)| facet).filter_map(|node| normals.get_key_value(node)).any(is_held);
            return Err(if meets {
                let [slave, master] = [slave, master].map(|side| side.name.clone());
                MortarFault::SlaveHeld { slave, master }
            } else {
                cover::nothing_in_front(mesh, [slave, master], search)
            });
        }
        Ok(Mortar {
            rows,
            covered: covers.facets.iter().map(|cover| cover.share).collect(),
            gaps: covers.gaps,
            search,
            master_weights: master_weights(mesh, master, &covers),
            master_beyond: covered_shares(mesh, master, covers.on_master.iter())
                .into_values()
                .any(|share| (THIN..BEYOND).contains(&share)),
            segments: covers.segments,
            facets: [slave, master].map(|side| side.facets.clone()),
        })
    }

    /// The facets of the slave and of the master.
    pub(super) fn sides(&self) -> [&[Facet]; 2] {
        [&self.facets[0], &self.facets[1]]
    }

    /// Whether the slave has nodes beyond the end of the master, and the master such beyond that of the slave.
    pub fn overhangs(&self) -> [bool; 2] {
        [self.rows.iter().any(MortarRow::is_beyond_the_end), self.master_beyond]
    }

    /// How many pairs of facets have a part in common.
    pub fn segments(&self) -> usize {
        self.segments.len()
    }

    /// The least gap at the integration points when the nodes of `mesh` have moved by `u` (m): where it is negative, facets overlap by as
    /// much, although the law, which is asked in the mean, holds. `None` without integration points.
    pub fn least_gap(&self, mesh: &Mesh, u: &[[f64; 3]]) -> Option<GapAt> {
        cover::least_gap(mesh, [&self.facets[0], &self.facets[1]], &self.segments, u)
    }

    /// The traction (N/m²) on the nodes of [`Mortar::master_weights`] of `forces` (N) on the slave, row by row: the opposite of
    /// `Σ_j P_jk f_j`, put on Bernstein's polynomials on facets of second order, over their weights.
    pub fn on_master(&self, mesh: &Mesh, forces: &[[f64; 3]]) -> Vec<(usize, [f64; 3])> {
        let mut nodal = BTreeMap::<usize, [f64; 3]>::new();
        for (row, force) in self.rows.iter().zip(forces) {
            for &(node, share) in &row.master {
                let sum = nodal.entry(node).or_default();
                *sum = plus(*sum, -share, *force);
            }
        }
        let edges = edges_of(mesh, &self.facets[1]);
        for (middle, [a, b]) in edges {
            let Some(force) = nodal.get(&middle).copied() else { continue };
            for (node, share) in [(middle, -0.5), (a, 0.25), (b, 0.25)] {
                let sum = nodal.entry(node).or_default();
                *sum = plus(*sum, share, force);
            }
        }
        let traction =
            |&(node, weight): &(usize, f64)| (node, nodal.get(&node).map_or([0.0; 3], |f| f.map(|c| c / weight)));
        self.master_weights.iter().map(traction).collect()
    }
}

/// The ends of the edge of each node between corners.
type Edges = BTreeMap<usize, [usize; 2]>;

fn edges_of(mesh: &Mesh, facets: &[Facet]) -> Edges {
    facets.iter().flat_map(|facet| mesh.bent_edges(facet)).map(|[a, middle, b]| (middle, [a, b])).collect()
}

/// Integrals with the shape functions from `terms`, those with Ñ: `N_m = 2 Ñ_m` between the corners a and b, `N_a = Ñ_a - ½ Σ Ñ_m`.
fn nodal(terms: Vec<(usize, f64)>, edges: &Edges) -> BTreeMap<usize, f64> {
    let mut nodal = BTreeMap::new();
    for (node, value) in terms {
        let mut add = |node: usize, value: f64| *nodal.entry(node).or_default() += value;
        match edges.get(&node) {
            Some(ends) => {
                add(node, 2.0 * value);
                for &end in ends {
                    add(end, -0.5 * value);
                }
            }
            None => add(node, value),
        }
    }
    nodal
}

/// What the facets at a node add up to.
#[derive(Default)]
struct Sum {
    weight: f64,
    bulge: f64,
    slave: BTreeMap<usize, f64>,
    master: BTreeMap<usize, f64>,
    /// The sum of the normals of the master in front of the node, by their weights.
    opposite: [f64; 3],
    /// Of each facet its weight, the mean of `x_m - x_s`, m, and the normal along which that is the gap: its own, or on facets of the
    /// second order, along which it turns, that of the node.
    gaps: Vec<(f64, [f64; 3], Option<[f64; 3]>)>,
}

impl Sum {
    fn add(&mut self, mesh: &Mesh, edges: &Edges, along: Option<[f64; 3]>, part: basis::FacetShare) {
        let basis::FacetShare { node, weight, slave, master, bulge } = part;
        let [slave, master] = [slave, master].map(|terms| nodal(terms, edges));
        // Seen from the node itself, what is one with it adds nothing.
        let mean = |terms: &BTreeMap<usize, f64>| {
            let to = |other: usize| minus(mesh.nodes[other], mesh.nodes[node]);
            terms.iter().fold([0.0; 3], |sum, (&other, value)| plus(sum, value / weight, to(other)))
        };
        self.gaps.push((weight, minus(mean(&master), mean(&slave)), along));
        self.weight += weight;
        self.bulge += bulge;
        for (sums, terms) in [(&mut self.slave, slave), (&mut self.master, master)] {
            for (node, value) in terms {
                *sums.entry(node).or_default() += value;
            }
        }
    }

    /// The row, without what its facets and supports say of it.
    fn row(self, node: usize, normal: [f64; 3]) -> MortarRow {
        let Sum { weight, slave, master, gaps, bulge, .. } = self;
        let gap = |(_, apart, along): &(f64, [f64; 3], Option<[f64; 3]>)| dot(*apart, along.unwrap_or(normal));
        // As far as they differ: the mean of gaps that are one is that one.
        let first = gaps.first().map_or(0.0, gap);
        let rest: f64 = gaps.iter().map(|part| part.0 * (gap(part) - first)).sum();
        let shares =
            |sums: BTreeMap<usize, f64>| sums.into_iter().map(|(node, value)| (node, value / weight)).collect();
        let gap = first + rest / weight;
        let (slave, master, bulge) = (shares(slave), shares(master), bulge / weight);
        MortarRow { node, weight, gap, normal, covered: 1.0, bulge, still: Vec::new(), slave, master }
    }
}

/// The nodes of the slave that have no row: those that supports hold along their normals, those that are the master's, too, and
/// those of which next to nothing is covered.
fn lost(
    mesh: &Mesh,
    slave: &Boundary,
    master: &Boundary,
    covers: &[Cover],
    normals: &BTreeMap<usize, [f64; 3]>,
    supports: &dyn Supports,
) -> BTreeSet<usize> {
    let others: BTreeSet<usize> = master.facets.iter().flatten().copied().collect();
    let is_lost =
        |(node, normal): (&usize, &[f64; 3])| others.contains(node) || normals::is_held(*normal, &supports.held(*node));
    let mut lost: BTreeSet<usize> = normals.iter().filter(|entry| is_lost(*entry)).map(|(node, _)| *node).collect();
    let (mut whole, mut covered) = (BTreeMap::<usize, f64>::new(), BTreeMap::<usize, f64>::new());
    for (facet, cover) in slave.facets.iter().zip(covers) {
        for (&node, weight) in facet.iter().zip(bernstein(mesh, facet, &facet_weights(mesh, facet))) {
            *whole.entry(node).or_default() += weight;
        }
        for part in basis::parts(mesh, facet, cover, &lost) {
            *covered.entry(part.node).or_default() += part.weight;
        }
    }
    lost.extend(covered.into_iter().filter(|(node, weight)| *weight < THIN * whole[node]).map(|(node, _)| node));
    lost
}

/// For each node of `boundary` the largest share of what it has in one of its facets that is covered, where `covered` are the integrals of
/// its functions over the covered part, facet by facet.
fn covered_shares<'a>(
    mesh: &Mesh,
    boundary: &Boundary,
    covered: impl Iterator<Item = &'a facet::Values>,
) -> BTreeMap<usize, f64> {
    let mut shares = BTreeMap::<usize, f64>::new();
    for (facet, covered) in boundary.facets.iter().zip(covered) {
        let whole = bernstein(mesh, facet, &facet_weights(mesh, facet));
        for (&node, (covered, whole)) in facet.iter().zip(covered.iter().zip(whole)) {
            let share = shares.entry(node).or_default();
            *share = share.max(covered / whole);
        }
    }
    shares
}

fn master_weights(mesh: &Mesh, master: &Boundary, covers: &Covers) -> Vec<(usize, f64)> {
    let mut weights = BTreeMap::<usize, [f64; 2]>::new();
    for (facet, values) in master.facets.iter().zip(&covers.on_master) {
        let whole = bernstein(mesh, facet, &facet_weights(mesh, facet));
        for (&node, both) in facet.iter().zip(values.iter().zip(whole)) {
            let sum = weights.entry(node).or_default();
            *sum = [sum[0] + both.0, sum[1] + both.1];
        }
    }
    let counts = |(node, [covered, whole]): (usize, [f64; 2])| (covered > THIN * whole).then_some((node, covered));
    weights.into_iter().filter_map(counts).collect()
}
