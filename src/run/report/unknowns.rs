//! The unknowns of a run, and the eliminated ones.

use std::collections::BTreeSet;

use serde::Serialize;

use crate::body::contact::ContactNode;
use crate::body::model::Model;
use crate::solver::formulation::Layout;
use crate::solver::history::Method;

/// The reason why a contact node is not in the working set.
const OUT_OF_REACH: &str = "at nodes out of reach: they are added as soon as they would penetrate";

/// The numbers of unknowns.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, schemars::JsonSchema)]
pub struct Unknowns {
    /// The number of displacements.
    pub u: usize,
    /// The number of tangential contact forces along the first tangent.
    pub p_t: usize,
    /// The number of tangential forces along second tangents, in three dimensions.
    pub p_o: usize,
    /// The number of normal contact forces.
    pub p_n: usize,
    /// The number of distances, which are slacks of the interior point method.
    pub v_n: usize,
    /// The number of friction reserves, which are slacks of the interior point method: two for each `p_t` in two
    /// dimensions, one for each cone in three.
    pub s: usize,
    /// The number of multipliers of the interior point method, equal to that of the slacks.
    pub lambda: usize,
}

/// Unknowns eliminated from the equations.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, schemars::JsonSchema)]
pub struct EliminatedUnknown {
    /// The number of eliminated unknowns.
    pub count: usize,
    /// The kind of the unknowns: `"u"`, `"p_n"`, `"p_t and p_o"`.
    pub unknown: &'static str,
    /// The reason, in words.
    pub reason: &'static str,
}

impl Unknowns {
    /// Returns the unknowns of `method` for those in `layout`.
    pub fn new(layout: &Layout, method: Method) -> Self {
        let (u, p_n) = (layout.displacements(), layout.contacts());
        let with = |has: &dyn Fn(usize) -> bool| (0..p_n).filter(|&i| has(i)).count();
        let p_o = with(&|i| layout.p_o(i).is_some());
        let p_t = layout.tangentials() - p_o;
        let reserves = if layout.has_second_tangent() { with(&|i| layout.has_friction(i)) } else { 2 * p_t };
        let (v_n, s) = if method.is_interior() { (p_n, reserves) } else { (0, 0) };
        Unknowns { u, p_t, p_o, p_n, v_n, s, lambda: s }
    }
}

impl EliminatedUnknown {
    /// Lists the unknowns that a run of `model` eliminates, with or without a `condensed` interior. Condensed equations
    /// contain the contact nodes `working_set` at first, or all.
    pub fn all(model: &Model, condensed: bool, working_set: Option<&[usize]>) -> Vec<Self> {
        let Model { mesh, problem, contact, .. } = model;
        let contacts = &contact.nodes;
        let tangential = if mesh.components() == 2 { "p_t" } else { "p_t and p_o" };
        let unreached: usize = contact.boundaries.iter().map(|boundary| boundary.unreached).sum();
        let supported = contact.boundaries.iter().filter_map(|boundary| {
            let nodes = mesh.boundary(&boundary.name)?.nodes();
            // The nodes at both ends of a period are one.
            let all = nodes
                .into_iter()
                .map(|node| model.constraints.dofs.moving_alike(node))
                .collect::<BTreeSet<usize>>()
                .len();
            Some(all.saturating_sub(boundary.unreached + boundary.nodes.len()))
        });
        let smooth = contacts.iter().zip(problem.mu()).filter(|(_, mu)| **mu == 0.0);
        let frictional = contacts.iter().zip(problem.mu()).filter(|(_, mu)| **mu > 0.0);
        let free = |contact: &ContactNode| contact.tangents.iter().filter(|row| !row.is_empty()).count();
        let nodes = working_set.map_or_else(|| (0..contacts.len()).collect(), <[usize]>::to_vec);
        let held_displacements = problem.contact_displacements_of(nodes.iter().copied()).len();
        let interior = if condensed { problem.displacements() - held_displacements } else { 0 };
        let layout = Layout::new(problem);
        let of_node = |i: usize| layout.tangential(i).into_iter().flatten().count();
        let apart = layout.tangentials() - nodes.iter().map(|&i| of_node(i)).sum::<usize>();
        let held_by = if mesh.geometry.is_revolved() { "held by supports or on the axis" } else { "held by supports" };
        let counted = [
            (mesh.nodes.len() * mesh.components() - problem.displacements(), "u", held_by),
            (interior, "u", "within the body: condensed, known once those at the contact are"),
            (contacts.len() - nodes.len(), "p_n", OUT_OF_REACH),
            (apart, tangential, OUT_OF_REACH),
            (supported.sum(), "p_n", "at nodes that supports hold along the normal"),
            (unreached, "p_n", "at nodes that no obstacle ever reaches"),
            (smooth.map(|(contact, _)| free(contact)).sum(), tangential, "at nodes without friction"),
            (
                frictional.map(|(contact, _)| mesh.components() - 1 - free(contact)).sum(),
                tangential,
                "along directions in which supports, or a second obstacle, prevent sliding",
            ),
        ];
        let present = counted.into_iter().filter(|(count, ..)| *count > 0);
        present.map(|(count, unknown, reason)| EliminatedUnknown { count, unknown, reason }).collect()
    }
}
