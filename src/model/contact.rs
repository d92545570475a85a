//! The contact nodes of a boundary and what is in front of them, checked.

use super::find;
use crate::contact::{ContactNode, ObstacleMotion, PlacedObstacle, contact_nodes, unreachable};
use crate::description::{Contact, Description};
use crate::fault::Fault;
use crate::fem::Dofs;
use crate::mesh::Mesh;
use crate::units::Quantity;
use crate::vector::dot;

/// How much of the body an obstacle may take up when the history begins. Strains are about this share, and
/// far less is no small deformation any more: more is a slip of the pen.
const DEEPEST: f64 = 0.2;

/// The obstacle of contact `k`, its motion, and the nodes in front of it.
pub(super) fn boundary(
    description: &Description,
    mesh: &Mesh,
    dofs: &Dofs,
    k: usize,
) -> Result<(PlacedObstacle, ObstacleMotion, Vec<ContactNode>), Fault> {
    let Contact { boundary: name, obstacle: given, .. } = &description.contacts[k];
    let boundary = find(mesh, name, &format!("contact[{k}]"))?;
    let units = description.system(mesh.dimension);
    let at_obstacle = |message: String, help: &str| Fault::new(format!("contact[{k}].obstacle"), message, help);
    let at_boundary = |message: String, help: &str| Fault::new(format!("contact[{k}].boundary"), message, help);
    let obstacle = PlacedObstacle::new(mesh, boundary, given)
        .map_err(|error| at_obstacle(format!("contact at `{name}`: {error}"), error.help()))?;
    let motion = ObstacleMotion::new(given, obstacle.normal, description.end());
    let nodes = boundary.nodes();
    if let Some(&node) = nodes.iter().find(|&&node| !obstacle.at(mesh.nodes[node]).gap.is_finite()) {
        let (what, help) = obstacle.out_of_reach();
        let place = units.place(mesh.nodes[node]);
        return Err(at_obstacle(format!("{what} the contact node at {place}"), help));
    }
    if !obstacle.faces(mesh, boundary) {
        let message = format!("the normal of the obstacle points into the body at `{name}`, or along it");
        return Err(at_obstacle(message, "let the normal point out of the body"));
    }
    let along = || mesh.nodes.iter().map(|x| dot(*x, obstacle.normal));
    let thickness = along().fold(f64::NEG_INFINITY, f64::max) - along().fold(f64::INFINITY, f64::min);
    let start = |node: usize| motion.gap(0.0, mesh.nodes[node], &obstacle.at(mesh.nodes[node]));
    if let Some(&node) = nodes.iter().min_by(|a, b| start(**a).total_cmp(&start(**b)))
        && start(node) < -DEEPEST * thickness
    {
        let place = units.place(mesh.nodes[node]);
        let (unit, told) = (units.name(Quantity::Length), |length| units.number(Quantity::Length, length));
        let message = format!(
            "the obstacle starts {:e} {unit} inside the body at {place}, which is {:e} {unit} thick there",
            told(-start(node)),
            told(thickness)
        );
        return Err(at_obstacle(message, "move the obstacle out, or the part of the motion before time 0"));
    }
    if let Some(node) = unreachable(mesh, dofs, boundary, &obstacle, &motion, &description.times) {
        let place = units.place(mesh.nodes[node]);
        let message = format!("supports hold the body where the obstacle is or comes to be, at {place}");
        let help = "use a gap of at least 0, a shorter approach or fewer supports";
        return Err(at_boundary(message, help));
    }
    let nodes = contact_nodes(mesh, dofs, boundary, &obstacle);
    if nodes.is_empty() {
        let message = format!("supports hold every node of the contact boundary `{name}`");
        return Err(at_boundary(message, "remove the contact or the support"));
    }
    Ok((obstacle, motion, nodes))
}

/// Refuses a node in front of two obstacles whose normals are opposite, for their forces would cancel, whatever they are; or
/// the same, for nothing would tell their forces apart.
pub(super) fn no_contradiction(
    description: &Description,
    k: usize,
    earlier: &[ContactNode],
    nodes: &[ContactNode],
) -> Result<(), Fault> {
    for node in nodes {
        for other in earlier.iter().filter(|other| other.node == node.node) {
            // One degree from parallel; a sharper edge of a body cannot be meshed.
            let along = dot(node.facing.normal, other.facing.normal);
            let (normals, help) = match along {
                _ if along < -0.9998 => {
                    ("opposite normals", "give an obstacle another normal, or let the boundaries share no node")
                }
                _ if along > 0.9998 => {
                    ("the same normal", "make one boundary of both, with one contact, or let them share no node")
                }
                _ => continue,
            };
            let place = description.system(3).place(node.position);
            let message = format!(
                "the node at {place} of `{}` lies in front of two obstacles with {normals}",
                description.contacts[k].boundary
            );
            return Err(Fault::new(format!("contact[{k}].obstacle"), message, help));
        }
    }
    Ok(())
}
