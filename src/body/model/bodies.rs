//! Check for bodies that overlap when the history begins.

use std::collections::{BTreeMap, BTreeSet};

use super::{find, pair};
use crate::algebra::union_find::UnionFind;
use crate::algebra::vector::{cross, minus, norm};
use crate::base::input_error::InputError;
use crate::body::description::Description;
use crate::body::fem::overlaps;
use crate::body::mesh::{Bodies, Boundary, Mesh, MeshSource};

/// Fails if two bodies without a contact between them have coincident nodes or are inside one another; they would pass
/// through each other. Bodies that touch at a node may also be connected through contacts with other bodies, such as
/// blocks around a point.
pub(super) fn keep_apart(description: &Description, mesh: &Mesh) -> Result<(), InputError> {
    let bodies = &mesh.bodies();
    if !bodies.are_several() {
        return Ok(());
    }
    let of = bodies.of_nodes();
    let contacts = paired(description, mesh, bodies)?;
    let mut together = UnionFind::new(bodies.count());
    for &(a, b) in &contacts {
        together.join(a, b);
    }
    let together: Vec<usize> = (0..bodies.count()).map(|k| together.least(k)).collect();
    let pair = |a: usize, b: usize| (of[a].min(of[b]), of[a].max(of[b]));
    let place = |node: usize| description.system(mesh.dimension).place(mesh.nodes[node]);
    let touching = mesh.touching_nodes(bodies);
    // Bodies connected through others may touch at a point or, in three dimensions, along an edge, but not over a side.
    let mut at: BTreeMap<(usize, usize), Vec<[f64; 3]>> = BTreeMap::new();
    let mut joined = |a: usize, b: usize| {
        let of_pair = pair(a, b);
        if contacts.contains(&of_pair) {
            return true;
        }
        let places = at.entry(of_pair).or_default();
        places.push(mesh.nodes[a]);
        together[of[a]] == together[of[b]] && !spans_a_side(places, mesh.dimension)
    };
    if let Some(&(node, other)) = touching.iter().find(|&&(a, b)| !joined(a, b)) {
        let (a, b) = pair(node, other);
        let message = format!(
            "the bodies {} and {} both have a node at {}, but nothing joins them",
            bodies.told(a),
            bodies.told(b),
            place(node)
        );
        let help = "let a [[contact]] with `against` join their boundaries, make one body of them in Gmsh (Coherence, or Coherence \
                    Mesh), or move them apart";
        return Err(InputError::new(key(&description.mesh, bodies, b), message, help));
    }
    if let Some(overlap) = overlaps(mesh, bodies, |a, b| !contacts.contains(&(a.min(b), a.max(b)))).first() {
        let (inner, outer) = overlap.bodies;
        let message =
            format!("the body {} is inside {}, at {}", bodies.told(inner), bodies.told(outer), place(overlap.node));
        let help = "move them apart, or let a [[contact]] with `against` press them out of each other";
        return Err(InputError::new(key(&description.mesh, bodies, inner.max(outer)), message, help));
    }
    Ok(())
}

/// Returns `true` if `places` span more than a point or, in three dimensions, more than a line, because of the last
/// one.
fn spans_a_side(places: &[[f64; 3]], dimension: usize) -> bool {
    let (Some(first), Some(last)) = (places.first(), places.last()) else { return false };
    let arm = minus(*last, *first);
    if dimension == 2 {
        return places.len() > 1;
    }
    let aside = |other: &[f64; 3]| {
        let other = minus(*other, *first);
        norm(cross(arm, other)) > ASIDE * norm(arm) * norm(other)
    };
    places.iter().any(aside)
}

/// Points are on one line if their directions differ by less than this.
const ASIDE: f64 = 1e-6;

/// Returns the pairs of bodies with a contact between them, the smaller number first.
fn paired(description: &Description, mesh: &Mesh, bodies: &Bodies) -> Result<BTreeSet<(usize, usize)>, InputError> {
    let mut pairs = BTreeSet::new();
    for (k, contact) in description.contacts.iter().enumerate() {
        let Some(opposite) = contact.opposite() else { continue };
        let key = format!("contact[{k}]");
        let of = |boundary: &Boundary| -> BTreeSet<usize> {
            boundary.facets.iter().map(|facet| bodies.of_nodes()[facet[0]]).collect()
        };
        let first = of(find(mesh, &contact.boundary, &key)?);
        let second = of(&pair::opposite(mesh, opposite, k)?);
        pairs.extend(first.iter().flat_map(|&a| second.iter().map(move |&b| (a.min(b), a.max(b)))));
    }
    Ok(pairs)
}

/// Returns the key of body `k`.
fn key(source: &MeshSource, bodies: &Bodies, k: usize) -> String {
    let MeshSource::Bodies(given) = source else { return "mesh".to_string() };
    // If the mesh of a body has several pieces, its name is followed by a number.
    let name = &bodies.names()[k];
    let own = given
        .iter()
        .position(|body| body.name == *name)
        .or_else(|| given.iter().position(|body| name.rsplit_once(' ').is_some_and(|(first, _)| first == body.name)));
    own.map_or("body".to_string(), |k| format!("body[{k}]"))
}
