//! Nodes in contact with two obstacles or two bodies.

use std::collections::BTreeMap;

use super::kinematics::ContactNode;
use crate::algebra::vector::{cross, norm, unit};
use crate::body::fem::Dofs;

/// Restricts the tangents of nodes in contact with two obstacles, for example on an edge of the body.
///
/// If such a node touches both, it can slide only along the edge, and friction in other directions would make the
/// equations dependent. It therefore has one tangent, along the edge, at the obstacle that is nearer at first (among
/// those with friction, `mu`, n_c). A node that is not free in all three directions, or meets more obstacles, as in a
/// corner, carries no friction.
pub fn share_edges(contacts: &mut [ContactNode], mu: &[f64], dofs: &Dofs) {
    let mut at_node: BTreeMap<usize, Vec<usize>> = BTreeMap::new();
    for (i, contact) in contacts.iter().enumerate() {
        at_node.entry(contact.node).or_default().push(i);
    }
    for (node, sharing) in at_node.into_iter().filter(|(_, sharing)| sharing.len() > 1) {
        let free = dofs.node(node).iter().flatten().count() == 3;
        let edge = match sharing[..] {
            [a, b] if free => cross(contacts[a].facing.normal, contacts[b].facing.normal),
            _ => [0.0; 3],
        };
        let edge = if norm(edge) > 0.0 { unit(edge) } else { edge };
        let gap = |i: &usize| contacts[*i].facing.gap;
        let rough = sharing.iter().copied().filter(|&i| mu[i] > 0.0);
        let carrier = rough.min_by(|a, b| gap(a).total_cmp(&gap(b)));
        for i in sharing {
            let tangent = if Some(i) == carrier { edge } else { [0.0; 3] };
            contacts[i].slide_along(dofs, [tangent, [0.0; 3]]);
        }
    }
}
