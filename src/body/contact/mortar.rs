//! Pairs of boundaries: the rows of a dual mortar method, from integrals over the common part of two boundaries.
//!
//! The contact law applies at the nodes of one of the two boundaries, the slave, with one row for each node j,
//!
//! ```text
//! w_j = Σ D_ji u_i - Σ P_jk u_k,   n_j · w_j ≤ g_j,
//! D_ji = ∫ ψ_j N_i dA / l_j,  P_jk = ∫ ψ_j N_k dA / l_j,  g_j = ∫ ψ_j (x_m - x_s) · ν dA / l_j,  l_j = ∫ ψ_j dA,
//! ```
//!
//! where i are nodes of the slave and k nodes of the master. The integrals are over the part of the slave that the
//! master covers, seen along the normal ν of each slave facet. Since ψ is biorthogonal (`cover`), D is the identity on
//! facets of first order, so that the law at each node is independent, and `2 u_m - ½ (u_a + u_b)` on facets of second
//! order. Between matching meshes the rows connect node to node.

mod bulge;
mod cover;
mod facet;
mod normals;
mod side;

use std::collections::{BTreeMap, BTreeSet};

pub(crate) use bulge::RoundSurface;
pub use normals::Supports;
pub use side::{SlaveChoice, SlaveReason};

use super::facing::faces_away;
use crate::algebra::vector::{Vector, dot, minus, plus, unit};
use crate::body::constraints::merged;
use crate::body::fem::{bernstein, facet_weights};
use crate::body::mesh::{Boundary, Facet, Mesh};
use cover::{Cover, Covers};

/// A node has no row if less than this share of it is covered.
const THIN: f64 = 1e-6;

/// A node is beyond the end of the other body if less than this share of its part in each facet is covered. If the
/// other body ends at a slave node, the whole part in one facet is covered.
const BEYOND: f64 = 0.5;

/// Options of the pairing of two boundaries.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct MortarOptions {
    /// The largest gap and overlap, m; default: a tenth of the size of the smaller boundary, the longest side of its
    /// bounding box.
    pub search: Option<f64>,
    /// The normal of all rows, out of the slave; default: at each node the mean of the slave's normal and the reversed
    /// normal of the master.
    pub direction: Option<[f64; 3]>,
}

/// The rows of a pair of boundaries.
#[derive(Debug, Clone, PartialEq)]
pub struct Mortar {
    /// The rows, by ascending slave node.
    pub rows: Vec<MortarRow>,
    /// The share of each slave facet that master facets cover.
    pub covered: Vec<f64>,
    /// The least and the largest gap at the integration points.
    pub gaps: [GapAt; 2],
    /// The search distance for the master, m.
    pub search: f64,
    /// `∫ Ñ_k dA` over the covered part for each master node, m or m² (in a body of revolution over the full
    /// circumference), by ascending node. Nodes with almost no covered part are left out.
    pub master_weights: Vec<(usize, f64)>,
    /// `true` if nodes of the master are beyond the end of the slave.
    master_beyond: bool,
    /// The slave facet and the master facet of each segment.
    segments: Vec<[usize; 2]>,
    /// The facets of the slave and of the master.
    facets: [Vec<Facet>; 2],
}

/// The row of a slave node.
#[derive(Debug, Clone, PartialEq)]
pub struct MortarRow {
    /// The slave node.
    pub node: usize,
    /// `l_j = ∫ ψ_j dA`: m in two dimensions, m² in three dimensions and for a body of revolution (full circumference).
    pub weight: f64,
    /// The mean gap `g_j` at the node, weighted by ψ_j, m: negative where bodies overlap.
    pub gap: f64,
    /// The common unit normal, out of the slave.
    pub normal: [f64; 3],
    /// The covered share of the node's part in a facet, the largest of all its facets.
    pub covered: f64,
    /// The reduction of the gap, in the same mean, between the curved surfaces that the facets of both sides
    /// approximate, m; 0 on flat boundaries.
    pub bulge: f64,
    /// The further reduction if the surfaces had no edges where facets turn by 44° to 84°, m.
    pub edges: f64,
    /// Orthonormal directions in which supports fix both sides.
    pub still: Vec<[f64; 3]>,
    /// `D_ji`, by ascending node: 1 at the node itself; 2 and twice -½ at a node between corners.
    pub slave: Vec<(usize, f64)>,
    /// `P_jk`, by ascending node; the coefficients add up to 1.
    pub master: Vec<(usize, f64)>,
}

impl MortarRow {
    /// Returns `true` if less than half of the node's part in each facet is covered, so that its force acts beyond the
    /// end of the other body.
    pub fn is_beyond_the_end(&self) -> bool {
        self.covered < BEYOND
    }

    /// Returns the mean of two rows of one node, by weight.
    fn joined(self, other: Self) -> Self {
        let weight = self.weight + other.weight;
        let share = other.weight / weight;
        let mean = |a: f64, b: f64| a + share * (b - a);
        let sum = |a: Vec<(usize, f64)>, b: Vec<(usize, f64)>| {
            let terms = a.into_iter().map(|(node, c)| (node, (1.0 - share) * c));
            merged(terms.chain(b.into_iter().map(|(node, c)| (node, share * c))).collect())
        };
        MortarRow {
            node: self.node,
            weight,
            gap: mean(self.gap, other.gap),
            normal: unit(plus(self.normal, share, minus(other.normal, self.normal))),
            covered: self.covered.max(other.covered),
            bulge: mean(self.bulge, other.bulge),
            edges: mean(self.edges, other.edges),
            still: self.still.into_iter().filter(|n| other.still.contains(n)).collect(),
            slave: sum(self.slave, other.slave),
            master: sum(self.master, other.master),
        }
    }
}

/// A gap and its position on the slave.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct GapAt {
    /// The distance from the slave to the master along the normal of the slave facet, m; negative if they overlap.
    pub gap: f64,
    /// The point of the slave, m.
    pub at: [f64; 3],
}

impl Mortar {
    /// Computes the rows of `slave` in front of `master`, both boundaries of `mesh`, with the given `supports`.
    ///
    /// # Errors
    ///
    /// Fails if no master facet or two layers of them are in front of the slave; if supports hold the slave; if a
    /// quadrilateral is not convex or normals cancel.
    pub fn new(
        mesh: &Mesh,
        slave: &Boundary,
        master: &Boundary,
        options: &MortarOptions,
        supports: &dyn Supports,
    ) -> Result<Self, MortarFault> {
        cover::convex(mesh, slave)?;
        cover::convex(mesh, master)?;
        let search = options.search.unwrap_or_else(|| cover::default_search(mesh, [slave, master]));
        let covers = Covers::new(mesh, slave, master, search)?;
        let still = normals::still(slave, &covers.facets, supports);
        let still_of = |node: usize| still.get(&node).cloned().unwrap_or_default();
        let mut normals = normals::nodal(mesh, slave, &still)?;
        if let Some(direction) = options.direction.map(unit) {
            let outwards = normals.values().all(|normal| dot(*normal, direction) > 0.0);
            if let Some(node) = faces_away(mesh, slave, |_| direction).filter(|_| !outwards) {
                return Err(MortarFault::Inwards { slave: slave.name.clone(), at: place(mesh, mesh.nodes[node]) });
            }
            normals = normals.into_keys().map(|node| (node, direction)).collect();
        }
        // Without supports: on a plane of symmetry, the row of the slave node has no component across the plane.
        let opposite = normals::nodal(mesh, master, &BTreeMap::new())?;
        let shares = covered_shares(mesh, slave, covers.facets.iter().map(|cover| &cover.functions));
        let settled = |node: usize| supports.settled(node, &still_of(node));
        let lost = lost(mesh, slave, master, &covers.facets, &normals, &settled);
        let mut edges = edges_of(mesh, &slave.facets);
        edges.extend(edges_of(mesh, &master.facets));
        let mut sums = BTreeMap::<usize, Sum>::new();
        for (facet, cover) in slave.facets.iter().zip(&covers.facets) {
            for part in cover::facet_shares(mesh, facet, cover, &lost) {
                let turns = mesh.is_quadratic(facet);
                sums.entry(part.node).or_default().add(mesh, &edges, (cover.normal, turns), part);
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
            let is_held = |(node, normal): (&usize, &[f64; 3])| normals::is_held(*normal, &settled(*node));
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

    /// Joins the rows of nodes that move alike, as at both ends of a period, if nodes of the master do so, too. `alike` returns
    /// one node for all that move as it does.
    pub(crate) fn join(&mut self, alike: impl Fn(usize) -> usize) {
        if self.facets[1].iter().flatten().all(|&node| alike(node) == node) {
            return;
        }
        let own: BTreeSet<usize> = self.rows.iter().map(|row| row.node).collect();
        let alike = |node: usize| Some(alike(node)).filter(|first| own.contains(first)).unwrap_or(node);
        let mut rows = BTreeMap::<usize, MortarRow>::new();
        for row in std::mem::take(&mut self.rows) {
            let node = alike(row.node);
            let slave = merged(row.slave.iter().map(|&(other, c)| (alike(other), c)).collect());
            let row = MortarRow { node, slave, ..row };
            let row = rows.remove(&node).map_or(row.clone(), |first| first.joined(row));
            rows.insert(node, row);
        }
        self.rows = rows.into_values().collect();
    }

    /// Returns the facets of the slave and of the master.
    pub(crate) fn sides(&self) -> [&[Facet]; 2] {
        [&self.facets[0], &self.facets[1]]
    }

    /// Returns `true` for the slave if it has nodes beyond the end of the master, and the converse for the master.
    pub fn overhangs(&self) -> [bool; 2] {
        [self.rows.iter().any(MortarRow::is_beyond_the_end), self.master_beyond]
    }

    /// Returns the number of pairs of facets with a common part.
    pub fn segments(&self) -> usize {
        self.segments.len()
    }

    /// Returns the least gap at the integration points after the nodes of `mesh` have moved by `u` (m).
    ///
    /// If it is negative, facets overlap by this amount although the law, which is imposed in a weighted mean, holds.
    /// `None` without integration points.
    pub fn least_gap(&self, mesh: &Mesh, u: &[[f64; 3]]) -> Option<GapAt> {
        cover::least_gap(mesh, [&self.facets[0], &self.facets[1]], &self.segments, u)
    }

    /// Computes the traction (N/m²) at the nodes of [`Mortar::master_weights`] from the `forces` (N) on the slave, row
    /// by row: `-Σ_j P_jk f_j`, transformed to Bernstein polynomials on facets of second order, divided by the weights.
    pub fn on_master(&self, mesh: &Mesh, forces: &[[f64; 3]]) -> Vec<(usize, [f64; 3])> {
        let mut nodal = BTreeMap::<usize, [f64; 3]>::new();
        for (row, force) in self.rows.iter().zip(forces) {
            for &(node, share) in &row.master {
                let sum = nodal.entry(node).or_default();
                *sum = plus(*sum, -share, *force);
            }
        }
        let edges = edges_of(mesh, &self.facets[1]);
        for (middle, ([a, b], of_end)) in edges {
            let Some(force) = nodal.get(&middle).copied() else { continue };
            for (node, share) in [(middle, -2.0 * of_end), (a, of_end), (b, of_end)] {
                let sum = nodal.entry(node).or_default();
                *sum = plus(*sum, share, force);
            }
        }
        let traction =
            |&(node, weight): &(usize, f64)| (node, nodal.get(&node).map_or([0.0; 3], |f| f.map(|c| c / weight)));
        self.master_weights.iter().map(traction).collect()
    }
}

/// The ends of the edge of each node between corners, and their share α of [`Mesh::share_of_ends`].
type Edges = BTreeMap<usize, ([usize; 2], f64)>;

fn edges_of(mesh: &Mesh, facets: &[Facet]) -> Edges {
    let of_facet = |facet: &Facet| {
        let share = mesh.share_of_ends(facet);
        mesh.bent_edges(facet).into_iter().map(move |[a, middle, b]| (middle, ([a, b], share)))
    };
    facets.iter().flat_map(of_facet).collect()
}

/// Converts integrals with Ñ, `terms`, to integrals with the shape functions: `N_m = Ñ_m / (1 - 2 α)` between the corners
/// a and b, `N_a = Ñ_a - α Σ N_m`.
fn nodal(terms: Vec<(usize, f64)>, edges: &Edges) -> BTreeMap<usize, f64> {
    let mut nodal = BTreeMap::new();
    for (node, value) in terms {
        let mut add = |node: usize, value: f64| *nodal.entry(node).or_default() += value;
        match edges.get(&node) {
            Some(&(ends, share)) => {
                let own = 1.0 / (1.0 - 2.0 * share);
                add(node, own * value);
                for end in ends {
                    add(end, -share * own * value);
                }
            }
            None => add(node, value),
        }
    }
    nodal
}

/// The sums over the facets at a node.
#[derive(Default)]
struct Sum {
    weight: f64,
    /// The sums of the bulges along the normals of facets of first order, m² or m³.
    bulge: [f64; 2],
    /// The sums of the bulges of facets of second order, as vectors.
    turned_bulge: [[f64; 3]; 2],
    slave: BTreeMap<usize, f64>,
    master: BTreeMap<usize, f64>,
    /// The weighted sum of the normals of the master in front of the node.
    opposite: [f64; 3],
    /// For each facet its weight, the mean of `x_m - x_s` (m), and the normal along which the gap is measured: the
    /// normal of the facet or, on facets of second order, along which it turns, the normal of the node.
    gaps: Vec<(f64, [f64; 3], Option<[f64; 3]>)>,
}

impl Sum {
    /// Adds a part of a facet with this normal; `turns` if the normal of the node takes its place.
    fn add(&mut self, mesh: &Mesh, edges: &Edges, (facing, turns): ([f64; 3], bool), part: cover::FacetShare) {
        let cover::FacetShare { node, weight, slave, master, bulge } = part;
        let [slave, master] = [slave, master].map(|terms| nodal(terms, edges));
        // Distances are taken from the node itself, so that coincident points contribute exactly 0.
        let mean = |terms: &BTreeMap<usize, f64>| {
            let to = |other: usize| minus(mesh.nodes[other], mesh.nodes[node]);
            terms.iter().fold([0.0; 3], |sum, (&other, value)| plus(sum, value / weight, to(other)))
        };
        self.gaps.push((weight, minus(mean(&master), mean(&slave)), (!turns).then_some(facing)));
        self.weight += weight;
        for (k, bulge) in bulge.into_iter().enumerate() {
            if turns {
                self.turned_bulge[k] = plus(self.turned_bulge[k], bulge, facing);
            } else {
                self.bulge[k] += bulge;
            }
        }
        for (sums, terms) in [(&mut self.slave, slave), (&mut self.master, master)] {
            for (node, value) in terms {
                *sums.entry(node).or_default() += value;
            }
        }
    }

    /// Creates the row; coverage and supports are added later.
    fn row(self, node: usize, normal: [f64; 3]) -> MortarRow {
        let Sum { weight, slave, master, gaps, .. } = self;
        let [bulge, without_edges] = [0, 1].map(|k| (self.bulge[k] + dot(self.turned_bulge[k], normal)) / weight);
        let gap = |(_, apart, along): &(f64, [f64; 3], Option<[f64; 3]>)| dot(*apart, along.unwrap_or(normal));
        // Only differences are averaged, so that the mean of equal gaps is exactly their value.
        let first = gaps.first().map_or(0.0, gap);
        let rest: f64 = gaps.iter().map(|part| part.0 * (gap(part) - first)).sum();
        let shares =
            |sums: BTreeMap<usize, f64>| sums.into_iter().map(|(node, value)| (node, value / weight)).collect();
        let gap = first + rest / weight;
        let (slave, master, edges) = (shares(slave), shares(master), without_edges - bulge);
        MortarRow { node, weight, gap, normal, covered: 1.0, bulge, edges, still: Vec::new(), slave, master }
    }
}

/// Returns the slave nodes without a row: nodes that supports hold along their normals, nodes that also belong to the
/// master, and nodes with almost no covered part.
fn lost(
    mesh: &Mesh,
    slave: &Boundary,
    master: &Boundary,
    covers: &[Cover],
    normals: &BTreeMap<usize, [f64; 3]>,
    settled: &dyn Fn(usize) -> Vec<[f64; 3]>,
) -> BTreeSet<usize> {
    let others: BTreeSet<usize> = master.facets.iter().flatten().copied().collect();
    let is_lost =
        |(node, normal): (&usize, &[f64; 3])| others.contains(node) || normals::is_held(*normal, &settled(*node));
    let mut lost: BTreeSet<usize> = normals.iter().filter(|entry| is_lost(*entry)).map(|(node, _)| *node).collect();
    let (mut whole, mut covered) = (BTreeMap::<usize, f64>::new(), BTreeMap::<usize, f64>::new());
    for (facet, cover) in slave.facets.iter().zip(covers) {
        for (&node, weight) in facet.iter().zip(bernstein(mesh, facet, &facet_weights(mesh, facet))) {
            *whole.entry(node).or_default() += weight;
        }
        for part in cover::facet_shares(mesh, facet, cover, &lost) {
            *covered.entry(part.node).or_default() += part.weight;
        }
    }
    lost.extend(covered.into_iter().filter(|(node, weight)| *weight < THIN * whole[node]).map(|(node, _)| node));
    lost
}

/// Computes for each node of `boundary` the covered share of its part in a facet, the largest of all its facets.
/// `covered` are the integrals of the functions over the covered part, facet by facet.
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

/// The error of two boundaries that cannot be paired.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[error("{}", self.message(|x| format!("{x} m"), |at| format!("{at:?}")))]
pub enum MortarFault {
    /// The master is nowhere in front of the slave within the search distance.
    NothingInFront {
        /// The slave boundary.
        slave: String,
        /// The master boundary.
        master: String,
        /// The search distance, m.
        search: f64,
        /// The least distance between the two, m.
        least: f64,
        /// The position of the least distance, m.
        at: Vector,
    },
    /// Two layers of the master are in front of part of a slave facet.
    TwoLayers {
        /// The slave boundary.
        slave: String,
        /// The master boundary.
        master: String,
        /// The centre of the facet, m.
        at: Vector,
    },
    /// A quadrilateral that cannot be clipped.
    NotConvex {
        /// The boundary.
        boundary: String,
        /// The centre of the facet, m.
        at: Vector,
    },
    /// A facet is bent so much that places in front of the other boundary have no local coordinates: the facet folds there, or an edge
    /// bends far away from its chord.
    TooBent {
        /// The boundary.
        boundary: String,
        /// The centre of the facet, m.
        at: Vector,
    },
    /// Supports hold all slave nodes in front of the master along their normals.
    SlaveHeld {
        /// The slave boundary.
        slave: String,
        /// The master boundary.
        master: String,
    },
    /// Facets that meet in a node, or that are in front of it, have opposite normals.
    NormalsCancel {
        /// The boundary.
        boundary: String,
        /// The position of the node, m.
        at: Vector,
    },
    /// The given direction points into the slave.
    Inwards {
        /// The slave boundary.
        slave: String,
        /// The position of the node, m.
        at: Vector,
    },
}

impl MortarFault {
    /// Describes the fault, with lengths and places in the words of `length` and `place`.
    pub(crate) fn message(&self, length: impl Fn(f64) -> String, place: impl Fn(&Vector) -> String) -> String {
        match self {
            MortarFault::NothingInFront { slave, master, search, least, at } => format!(
                "nothing of `{master}` is in front of `{slave}` within {}; the least distance is {}, at {}",
                length(*search),
                length(*least),
                place(at)
            ),
            MortarFault::TwoLayers { slave, master, at } => {
                format!("two layers of `{master}` are in front of the facet of `{slave}` at {}", place(at))
            }
            MortarFault::NotConvex { boundary, at } => {
                format!("the quadrilateral of `{boundary}` at {} is not convex", place(at))
            }
            MortarFault::TooBent { boundary, at } => {
                let at = place(at);
                format!("the facet of `{boundary}` at {at} is bent too much, seen along the normal of the slave")
            }
            MortarFault::SlaveHeld { slave, master } => {
                format!("supports or a coupling hold `{slave}` along its normal wherever `{master}` is in front of it")
            }
            MortarFault::NormalsCancel { boundary, at } => {
                format!("the normals of the facets of `{boundary}` around {} cancel", place(at))
            }
            MortarFault::Inwards { slave, at } => {
                format!("the direction points into the body at {} of `{slave}`", place(at))
            }
        }
    }

    /// Returns the correction, in words.
    pub fn help(&self) -> &'static str {
        match self {
            MortarFault::NothingInFront { search, least, .. } if least <= search => {
                "let the two face each other, so that the normals of the one meet facets of the other that look back"
            }
            MortarFault::NothingInFront { .. } => "give a longer `search`, or move the bodies to where they meet",
            MortarFault::TwoLayers { .. } => {
                "give a shorter `search`, or name only the part of the boundary that is to be met"
            }
            MortarFault::NotConvex { .. } => {
                "mesh again; no angle of a quadrilateral on a contact boundary may exceed 180°"
            }
            MortarFault::TooBent { .. } => {
                "mesh again, finer where the boundary is curved, or name only the part of it that faces the other"
            }
            MortarFault::SlaveHeld { .. } => "swap the two: what nothing holds is to be the slave",
            MortarFault::NormalsCancel { .. } => "name the two sides of a sharp edge as different boundaries",
            MortarFault::Inwards { .. } => "turn the direction round: it points out of the slave, towards the master",
        }
    }

    /// Returns the key in a contact that the fault concerns.
    pub(crate) fn key(&self) -> &'static str {
        match self {
            MortarFault::NothingInFront { .. } | MortarFault::TwoLayers { .. } => "search",
            MortarFault::Inwards { .. } => "direction",
            _ => "against",
        }
    }
}

/// Returns a point for messages, with two coordinates in two dimensions.
fn place(mesh: &Mesh, [x, y, z]: [f64; 3]) -> Vector {
    if mesh.dimension == 2 { [x, y].into() } else { [x, y, z].into() }
}
