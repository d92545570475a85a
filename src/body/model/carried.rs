//! The relations of nodes to the reference points that carry them.

use std::collections::BTreeMap;

use super::coupling::Couplings;
use super::holding::Holding;
use crate::algebra::vector::{axis, dot};
use crate::base::input_error::InputError;
use crate::body::constraints::{Dofs, Relative, SAME_DIRECTION, Tie};
use crate::body::description::Description;
use crate::body::mesh::Mesh;

/// Returns the relations of the carried nodes to their reference points. Supports may hold a carried node only along
/// directions in which the point cannot move it.
pub(super) fn relations(
    couplings: &Couplings,
    description: &Description,
    mesh: &Mesh,
    dofs: &Dofs,
    holdings: &[Holding],
) -> Result<Vec<Relative>, InputError> {
    let mut moved: BTreeMap<usize, Vec<[f64; 3]>> = BTreeMap::new();
    for (node, n, _) in holdings.iter().flatten().filter(|(.., to)| *to != 0.0) {
        moved.entry(*node).or_default().push(*n);
    }
    let moves =
        |node: usize, n: [f64; 3]| moved.get(&node).into_iter().flatten().any(|to| dot(*to, n).abs() > SAME_DIRECTION);
    let mut relations = Vec::new();
    for (of, k, nodes) in couplings.each_rigid() {
        for node in nodes {
            let relation = dofs.carried_by(mesh, k, node);
            let mut held = dofs.held(node).filter(|n| mesh.dimension == 3 || n[2] == 0.0);
            if held.any(|n| moves(node, n) || dofs.may_move(&relation, n, moves)) {
                let coupling = &description.couplings[of];
                let place = description.system(mesh.dimension).place(mesh.nodes[node]);
                let message =
                    format!("a support holds the node at {place}, which the coupling `{}` moves", coupling.name);
                let support = holdings.iter().position(|holding| holding.iter().any(|h| h.0 == node));
                let (key, help) = match support {
                    Some(j) => (
                        format!("support[{j}].boundary"),
                        "support the coupling itself (coupling = ...), also along these directions and against \
                         rotation, or couple a boundary that shares no node with the support",
                    ),
                    None => (
                        format!("coupling[{of}].{}", coupling.part.key()),
                        "the axis of a body of revolution holds it: couple another boundary",
                    ),
                };
                return Err(InputError::new(key, message, help));
            }
            relations.push(relation);
        }
    }
    Ok(relations)
}

/// Returns the ties between the bodies that one reference point carries.
pub(super) fn ties(couplings: &Couplings, mesh: &Mesh, dofs: &Dofs) -> Vec<Tie> {
    let bodies = mesh.bodies();
    let of = bodies.of_nodes();
    let of_point = |(_, k, nodes): (usize, usize, Vec<usize>)| {
        let first = nodes.first().map(|node| of[*node]);
        let others = nodes.into_iter().filter(move |node| Some(of[*node]) != first);
        others.flat_map(move |node| {
            let relation = dofs.carried_by(mesh, k, node);
            (0..mesh.dimension).map(|c| dofs.tie(&relation, axis(c))).collect::<Vec<_>>()
        })
    };
    couplings.each_rigid().flat_map(of_point).collect()
}
