//! Contact tractions at the nodes of boundaries of second order, for output only.
//!
//! `p̃ / l̃` is the mean of the traction over the support of the polynomial of the node; at the top of a dome
//! it is several percent too low. One defect correction with the mass matrix of the polynomials removes this error,
//!
//! ```text
//! s_i = p̃_i / l̃_i,   λ_i = s_i + (p̃_i - Σ_j M̃_ij s_j) / l̃_i,   M̃_ij = ∫ Ñ_i Ñ_j dA,
//! ```
//!
//! and `Σ λ_i Ñ_i` at the nodes is `λ_a` at corners and `(1 - 2 α) λ_m + α (λ_a + λ_b)` between them. Next to the end of a
//! contact the correction may give tension, which is set to 0; the law and the status are those of `p̃`. Nodes that
//! supports hold have no contact force; their traction is taken from the node beside them.

use std::collections::{BTreeMap, BTreeSet};

use super::{Model, Pair};
use crate::algebra::vector::{across, dot, plus};
use crate::body::contact::{ContactBoundary, ContactNode};
use crate::body::fem::facet_mass;
use crate::body::mesh::Mesh;
use crate::solver::problem::State;

/// Returns the contact nodes beyond the end of the other body, each with the contact nodes of its facets including
/// itself. Since very little of such a node's share of the boundary is covered, its force divided by this share is not
/// a pressure; the sum of the forces of these nodes divided by the sum of their weights is.
pub(super) fn beside_the_end(
    mesh: &Mesh,
    contacts: &[ContactNode],
    boundaries: &[ContactBoundary],
) -> BTreeMap<usize, Vec<usize>> {
    let is_beyond = |i: usize| contacts[i].coupled().is_some_and(|coupled| coupled.beyond_the_end);
    beside(mesh, contacts, boundaries, is_beyond)
}

/// Returns the `wanted` contact nodes, each with the contact nodes of its facets including itself.
pub(super) fn beside(
    mesh: &Mesh,
    contacts: &[ContactNode],
    boundaries: &[ContactBoundary],
    wanted: impl Fn(usize) -> bool,
) -> BTreeMap<usize, Vec<usize>> {
    let mut beside = BTreeMap::<usize, BTreeSet<usize>>::new();
    for own in boundaries.iter().filter(|own| own.nodes.iter().any(|&i| wanted(i))) {
        let at_node: BTreeMap<usize, usize> = own.nodes.iter().map(|&i| (contacts[i].node, i)).collect();
        for facet in mesh.facets_of(&own.name) {
            let of_facet: Vec<usize> = facet.iter().filter_map(|node| at_node.get(node).copied()).collect();
            for &i in of_facet.iter().filter(|i| wanted(**i)) {
                beside.entry(i).or_default().extend(&of_facet);
            }
        }
    }
    beside.into_iter().map(|(i, others)| (i, others.into_iter().collect())).collect()
}

/// The contact nodes at the ends of an edge, if they are such, and the share α of [`Mesh::share_of_ends`].
type Ends = ([Option<usize>; 2], f64);

/// The data of the recovery of nodal tractions.
#[derive(Debug, Clone)]
pub(super) struct Recovery {
    /// For each contact node, the other nodes whose polynomials overlap its own, with `M̃`.
    mass: Vec<Vec<(usize, f64)>>,
    /// For each contact node, the contact nodes at the ends of its edge, and their share α.
    ends: Vec<Option<Ends>>,
    /// For each contact node: `true` if it is on a facet that another body covers only in part; its traction is not
    /// corrected.
    plain: Vec<bool>,
}

/// A facet counts as covered if less than this share of it is uncovered.
const UNCOVERED: f64 = 1e-9;

impl Recovery {
    /// Creates the recovery; `None` if no boundary with contact is of second order.
    pub(super) fn new(
        mesh: &Mesh,
        contacts: &[ContactNode],
        boundaries: &[ContactBoundary],
        pairs: &[Pair],
    ) -> Option<Self> {
        let facets = |own: &ContactBoundary| mesh.facets_of(&own.name);
        if boundaries.iter().flat_map(facets).all(|facet| !mesh.is_quadratic(facet)) {
            return None;
        }
        let n = contacts.len();
        let mut recovery = Recovery { mass: vec![Vec::new(); n], ends: vec![None; n], plain: vec![false; n] };
        for own in boundaries {
            let mut at_node = vec![None; mesh.nodes.len()];
            own.nodes.iter().for_each(|&i| at_node[contacts[i].node] = Some(i));
            for (f, facet) in facets(own).iter().enumerate() {
                for [a, middle, b] in mesh.bent_edges(facet) {
                    if let Some(i) = at_node[middle] {
                        recovery.ends[i] = Some(([at_node[a], at_node[b]], mesh.share_of_ends(facet)));
                    }
                }
                if own.pair.is_some_and(|pair| pairs[pair].mortar.covered[f] < 1.0 - UNCOVERED) {
                    facet.iter().filter_map(|&node| at_node[node]).for_each(|i| recovery.plain[i] = true);
                    continue;
                }
                for (row, &node) in facet_mass(mesh, facet).iter().zip(facet) {
                    let Some(i) = at_node[node] else { continue };
                    let others = facet.iter().zip(row);
                    let others = others.filter_map(|(&other, mass)| Some((at_node[other]?, *mass)));
                    recovery.mass[i].extend(others.filter(|(j, _)| *j != i));
                }
            }
        }
        Some(recovery)
    }
}

impl Model {
    /// Returns the value at contact node `i` itself from the values of rows in front of another body, `value`: on
    /// boundaries of second order `(1 - 2 α) w̃_m + α (w̃_a + w̃_b)` at a node between corners, and `w̃` elsewhere.
    pub(crate) fn of_node_from_rows(&self, i: usize, value: impl Fn(usize) -> f64) -> f64 {
        match self.contact.recovery.as_ref().and_then(|recovery| recovery.ends[i]) {
            Some(([Some(a), Some(b)], share)) => (1.0 - 2.0 * share) * value(i) + share * (value(a) + value(b)),
            _ => value(i),
        }
    }

    /// Returns the contact force of each node divided by its weight `l` (32), Pa. At a node beyond the end of the other
    /// body, the forces and weights are the sums over all nodes of its facets.
    pub fn over_weights(&self, force: impl Fn(usize) -> f64) -> Vec<f64> {
        let mut stresses: Vec<f64> =
            self.contact.nodes.iter().enumerate().map(|(i, contact)| force(i) / contact.weight).collect();
        for (&i, beside) in &self.contact.beside_the_end {
            let weight: f64 = beside.iter().map(|&j| self.contact.nodes[j].weight).sum();
            stresses[i] = beside.iter().map(|&j| force(j)).sum::<f64>() / weight;
        }
        stresses
    }

    /// Returns the pressure (Pa) at each contact node: as [`Model::over_weights`], on boundaries of second order as in
    /// [`Model::recovered_tractions`].
    pub fn contact_pressures(&self, state: &State) -> Vec<f64> {
        match self.recovered_tractions(state) {
            None => self.over_weights(|i| state.p_n[i]),
            Some(all) => {
                self.contact.nodes.iter().zip(all).map(|(contact, sigma)| dot(sigma, contact.facing.normal)).collect()
            }
        }
    }

    /// Returns the traction (Pa) of the body on the obstacle at each contact node, along the coordinate axes, if
    /// boundaries with contact are of second order.
    ///
    /// Otherwise `None`: the traction is then the contact force divided by the node's weight (32).
    pub fn recovered_tractions(&self, state: &State) -> Option<Vec<[f64; 3]>> {
        let Recovery { mass, ends, plain } = self.contact.recovery.as_ref()?;
        // Pressures are treated as scalars since normals turn along the boundary, friction as a vector since tangents
        // are arbitrary.
        let forces: Vec<[f64; 3]> = (self.contact.nodes.iter().enumerate())
            .map(|(i, contact)| across(self.contact_force(state, i), contact.facing.normal))
            .collect();
        let pressures = self.over_weights(|i| state.p_n[i]);
        let shears = [0, 1, 2].map(|c| self.over_weights(|i| forces[i][c]));
        let means: Vec<[f64; 4]> =
            (0..pressures.len()).map(|i| [pressures[i], shears[0][i], shears[1][i], shears[2][i]]).collect();
        // The polynomials add up to 1, so that p̃_i - Σ_j M̃_ij s_j = Σ_j M̃_ij (s_i - s_j).
        let corrected = |(i, contact): (usize, &ContactNode)| {
            std::array::from_fn(|c| {
                let defect: f64 = mass[i].iter().map(|(j, mass)| mass * (means[i][c] - means[*j][c])).sum();
                means[i][c] + defect / contact.weight
            })
        };
        let corrected: Vec<[f64; 4]> = self.contact.nodes.iter().enumerate().map(corrected).collect();
        let nodal = |(i, ends): (usize, &Option<Ends>)| {
            if plain[i] {
                let [pressure, x, y, z] = means[i];
                return plus([x, y, z], pressure, self.contact.nodes[i].facing.normal);
            }
            let own = corrected[i];
            let (ends, share) = ends.unwrap_or(([None; 2], 0.0));
            let [a, b] = ends.map(|end| end.map_or(own, |j| corrected[j]));
            let [pressure, x, y, z] = std::array::from_fn(|c| (1.0 - 2.0 * share) * own[c] + share * (a[c] + b[c]));
            let normal = self.contact.nodes[i].facing.normal;
            // Tension from the correction beside the end of a contact is not part of the law.
            plus(across([x, y, z], normal), f64::max(pressure, 0.0), normal)
        };
        Some(ends.iter().enumerate().map(nodal).collect())
    }
}
