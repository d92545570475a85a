//! Bodies that are in each other's way when the history begins.

use crate::description::Description;
use crate::fault::Fault;
use crate::fem::overlaps;
use crate::mesh::{Bodies, Mesh, MeshSource};

/// Fails where two bodies that nothing joins, as `joined` says of their numbers, the lesser one first, have nodes in the same
/// place or are inside one another: they would pass through each other. What joins bodies is a contact between them.
pub(super) fn keep_apart(
    description: &Description,
    mesh: &Mesh,
    bodies: &Bodies,
    joined: impl Fn(usize, usize) -> bool,
) -> Result<(), Fault> {
    if !bodies.are_several() {
        return Ok(());
    }
    let of = bodies.of_nodes();
    let pair = |a: usize, b: usize| (of[a].min(of[b]), of[a].max(of[b]));
    let place = |node: usize| description.system(mesh.dimension).place(mesh.nodes[node]);
    let touching = mesh.touching_nodes(bodies);
    if let Some(&(node, other)) = touching.iter().find(|&&(a, b)| !joined(pair(a, b).0, pair(a, b).1)) {
        let (a, b) = pair(node, other);
        let message = format!(
            "the bodies {} and {} both have a node at {}, but nothing joins them",
            bodies.told(a),
            bodies.told(b),
            place(node)
        );
        let help = "let a [[contact]] with `against` join their boundaries, make one body of them in Gmsh (Coherence, or Coherence \
                    Mesh), or move them apart";
        return Err(Fault::new(key(&description.mesh, bodies, b), message, help));
    }
    if let Some(overlap) = overlaps(mesh, bodies, |a, b| !joined(a, b)).first() {
        let (inner, outer) = overlap.bodies;
        let message =
            format!("the body {} is inside {}, at {}", bodies.told(inner), bodies.told(outer), place(overlap.node));
        let help = "move them apart, or let a [[contact]] with `against` press them out of each other";
        return Err(Fault::new(key(&description.mesh, bodies, inner.max(outer)), message, help));
    }
    Ok(())
}

/// The key of body `k`.
fn key(source: &MeshSource, bodies: &Bodies, k: usize) -> String {
    let MeshSource::Bodies(given) = source else { return "mesh".to_string() };
    // A body whose mesh has several pieces is numbered behind its name.
    let name = &bodies.names()[k];
    let own = given
        .iter()
        .position(|body| body.name == *name)
        .or_else(|| given.iter().position(|body| name.rsplit_once(' ').is_some_and(|(first, _)| first == body.name)));
    own.map_or("body".to_string(), |k| format!("body[{k}]"))
}
