//! The contact nodes of a pair of boundaries.

use super::kinematics::{ContactNode, Counterpart, Coupled, Row, tangents};
use super::mortar::MortarRow;
use super::obstacle::{Facing, first_tangent};
use crate::algebra::vector::{across, cross, norm, plus, unit};
use crate::body::constraints::{Coefficient, Dofs, Relative};
use crate::body::mesh::Mesh;

/// The least length of a projected tangent; a shorter one is almost parallel to the normal.
const LEANS: f64 = 0.1;

/// Returns the relation that makes the displacement of the node of `row` relative to the other nodes of the row, see
/// [`Relative`]. If `glued`, the node is tied to them.
pub fn relative(row: &MortarRow, glued: bool) -> Relative {
    let own = row.slave.iter().find(|(node, _)| *node == row.node).map_or(1.0, |(_, c)| *c);
    let beside = row.slave.iter().filter(|(node, _)| *node != row.node).map(|&(node, c)| (node, -c));
    let others = beside.chain(row.master.iter().copied()).map(|(node, c)| (node, Coefficient::Factor(c)));
    Relative { node: row.node, own, others: others.collect(), tied: glued }
}

/// Creates the contact nodes of the pair `pair` from its `rows`.
///
/// `gap` (m) is the gap of each row, and how much less it may be, see [`super::Coupled::edges`]; `relative` marks the nodes with relative displacements in this pair. Normals are
/// those of the rows; the first tangent is that of an obstacle with their mean normal, turned with the normal.
pub fn coupled_nodes(
    mesh: &Mesh,
    dofs: &Dofs,
    pair: usize,
    rows: &[MortarRow],
    gap: impl Fn(&MortarRow) -> [f64; 2],
    relative: impl Fn(usize) -> bool,
) -> Vec<ContactNode> {
    let mean = rows.iter().fold([0.0; 3], |sum, row| plus(sum, row.weight, row.normal));
    let first = first_tangent(unit(mean));
    let node = |row: &MortarRow| {
        let normal = row.normal;
        let first = match mesh.dimension {
            2 => [-normal[1], normal[0], 0.0],
            _ => across(first, normal),
        };
        let first = if norm(first) > LEANS { unit(first) } else { first_tangent(normal) };
        let frame = [first, cross(normal, first)];
        let [gap, edges] = gap(row);
        let facing = Facing { gap, normal, tangents: frame, inward: normal };
        let nodes = |side: &[(usize, f64)], sign: f64| {
            side.iter().map(|&(node, c)| (node, mesh.nodes[node], sign * c)).collect::<Vec<_>>()
        };
        let (slave, master) = (nodes(&row.slave, 1.0), nodes(&row.master, -1.0));
        let coupled = Coupled {
            pair,
            relative: relative(row.node),
            beyond_the_end: row.is_beyond_the_end(),
            edges,
            still: row.still.clone(),
            slave,
            master,
        };
        let mut contact = ContactNode {
            node: row.node,
            position: mesh.nodes[row.node],
            ends: None,
            carried: Vec::new(),
            normal: Row::new(),
            tangents: [Row::new(), Row::new()],
            counterpart: Counterpart::Boundary(coupled),
            others: Vec::new(),
            facing,
            frame,
            weight: row.weight,
        };
        // Along directions in which supports hold only this side, the other side moves past it.
        let moves = |n: &[f64; 3]| !row.still.contains(n) && !contact.row(dofs, |_| *n).is_empty();
        let fixed: Vec<[f64; 3]> = dofs.held(row.node).filter(|n| !moves(n)).collect();
        let tangents = tangents(&fixed, &contact.facing);
        contact.facing.tangents = [0, 1].map(|k| tangents.get(k).copied().unwrap_or_default());
        contact.with_rows(dofs)
    };
    // A node whose two sides move alike along its normal, as at the end of a weld, can neither open nor close.
    rows.iter().map(node).filter(|contact| !contact.normal.is_empty()).collect()
}
