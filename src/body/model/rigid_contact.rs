//! Contact between rigid parts, whose contact forces are not determined.

use std::collections::BTreeMap;

use crate::algebra::null_space::{Row, null_space};
use crate::base::input_error::InputError;
use crate::body::constraints::Dofs;
use crate::body::contact::{ContactBoundary, ContactNode};
use crate::body::description::Description;
use crate::body::mesh::Mesh;

/// The cure for such a contact.
const HELP: &str =
    "end the coupled boundary before the contact, use a distributing coupling, or let one part be elastic";

/// Fails if reference points carry every node of both sides of contact `k`.
pub(super) fn not_between_carried(
    description: &Description,
    mesh: &Mesh,
    dofs: &Dofs,
    k: usize,
) -> Result<(), InputError> {
    let contact = &description.contacts[k];
    let carried = |name: &String| mesh.boundary(name).is_some_and(|boundary| dofs.are_rigid(&boundary.nodes()));
    let Some(opposite) = contact.opposite().filter(|_| carried(&contact.boundary)) else { return Ok(()) };
    if !opposite.boundaries.iter().all(carried) {
        return Ok(());
    }
    let message = format!("`{}` and the boundary against it are rigid by couplings", contact.boundary);
    Err(InputError::new(format!("contact[{k}].boundary"), message, HELP))
}

/// Fails if the forces of obstacles on the nodes that a reference point carries are not determined: their rows of `C_n`,
/// `C_t` and `C_o`, in the unknowns of the point, depend on each other.
///
/// `mu` are the friction coefficients of `nodes`.
pub(super) fn determined(
    (nodes, mu): (&[ContactNode], &[f64]),
    boundaries: &[ContactBoundary],
    description: &Description,
    dofs: &Dofs,
) -> Result<(), InputError> {
    let mut of_point: BTreeMap<usize, Vec<usize>> = BTreeMap::new();
    for (i, node) in nodes.iter().enumerate().filter(|(_, node)| node.obstacle().is_some()) {
        if let Some(point) = dofs.point_carrying(node.node) {
            of_point.entry(point).or_default().push(i);
        }
    }
    for carried in of_point.values() {
        let rows = |&i: &usize| {
            let ContactNode { normal, tangents, .. } = &nodes[i];
            let tangents = tangents.iter().filter(move |row| mu[i] != 0.0 && !row.is_empty());
            std::iter::once(normal).chain(tangents)
        };
        let rows: Vec<_> = carried.iter().flat_map(rows).collect();
        let mut columns = BTreeMap::new();
        for &(dof, _) in rows.iter().copied().flatten() {
            let next = columns.len();
            columns.entry(dof).or_insert(next);
        }
        let row = |row: &&Vec<(usize, f64)>| {
            let mut entries = vec![0.0; columns.len()];
            row.iter().for_each(|(dof, c)| entries[columns[dof]] += c);
            Row::of_unit_size(entries)
        };
        let left = null_space(columns.len(), rows.iter().map(row)).len();
        if columns.len() - left == rows.len() {
            continue;
        }
        let boundary = boundaries.iter().find(|boundary| carried.iter().any(|i| boundary.nodes.contains(i)));
        let k = boundary.map_or(0, |boundary| boundary.contact);
        let message = format!(
            "a rigid coupling carries {} nodes in contact with a rigid obstacle, `{}` among them",
            carried.len(),
            description.contacts[k].boundary,
        );
        return Err(InputError::new(format!("contact[{k}].boundary"), message, HELP));
    }
    Ok(())
}
