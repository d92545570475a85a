//! The displacements of a mesh that supports hold, and those that reference points determine.

use std::collections::BTreeMap;

use super::coupling::{Couplings, turning};
use super::find;
use super::joint::Joints;
use super::place::{nodes, normals, suits};
use crate::algebra::vector::{axis, dot, norm, unit};
use crate::base::input_error::InputError;
use crate::base::units::UnitSystem;
use crate::body::constraints::{Dofs, ReferencePoint, Relative, SAME_DIRECTION, Tie};
use crate::body::description::{Axis, Description, Direction, Held, Support, Where};
use crate::body::mesh::Mesh;

/// The displacements that one support holds: nodes, unit vectors and displacements (m) at factor 1.
pub(super) type Holding = Vec<(usize, [f64; 3], f64)>;

/// Returns the displacements that each support of `description` holds.
pub(super) fn holdings(
    description: &Description,
    mesh: &Mesh,
    couplings: &Couplings,
    points: &[ReferencePoint],
) -> Result<Vec<Holding>, InputError> {
    let of_support = |(k, support)| holding(description, mesh, support, (couplings, points), k);
    description.supports.iter().enumerate().map(of_support).collect()
}

/// Returns the displacements that support `k` holds. At a reference point, the node of the rotation has its angles times a
/// length as displacements.
fn holding(
    description: &Description,
    mesh: &Mesh,
    support: &Support,
    (couplings, points): (&Couplings, &[ReferencePoint]),
    k: usize,
) -> Result<Holding, InputError> {
    let (key, units) = (format!("support[{k}]"), description.system(mesh.dimension));
    let axisymmetric = mesh.geometry.is_revolved();
    let place = support.at.location(&units);
    let point = match &support.at {
        Where::Coupling(name) => Some(couplings.rigid(name, "the support", &key)?),
        _ => None,
    };
    let nodes = match point {
        Some((_, [translation, _])) => vec![translation],
        None => nodes(mesh, &support.at, &units, &key)?,
    };
    let mut holding = Vec::new();
    for Held { direction, displacement } in &support.held {
        let refused =
            |at: &str, message: String, help: &str| Err(InputError::new(format!("{key}.{at}"), message, help));
        let mut normals_of = Vec::new();
        let n = match direction {
            Direction::Axis(Axis::Z) if mesh.components() == 2 => {
                let message = format!("the support of `{place}` holds z, but the body has two dimensions");
                return refused("fix", message, "leave out \"z\"");
            }
            Direction::Rotation(about) if !mesh.rotation_axes().contains(&(*about as usize)) => {
                let message = format!("the support of `{place}` holds a rotation, but {}", turning(mesh));
                let own = ["x", "y", "z"][mesh.rotation_axes()].first();
                let help = own.map_or("leave it out".to_string(), |own| format!("fix \"rotation_{own}\""));
                return refused("fix", message, &help);
            }
            Direction::Rotation(about) => {
                // The check of the description refuses it elsewhere.
                let Some((point, [_, rotation])) = point else { continue };
                let turned = points[point].of_rotation(mesh.components(), axis(*about as usize));
                let length = norm(turned);
                holding.push((rotation, turned.map(|c| c / length), displacement * length));
                continue;
            }
            Direction::Axis(along) => axis(*along as usize),
            Direction::Along(vector) => {
                suits(mesh, *vector, &format!("{key}.direction"))?;
                unit(vector.components())
            }
            Direction::Normal => {
                // The check of the description refuses it elsewhere.
                let Where::Boundary(name) = &support.at else { continue };
                normals_of = normals(mesh, find(mesh, name, &key)?);
                [0.0; 3]
            }
        };
        if point.is_some() && axisymmetric && (n[0] != 0.0 || n[2] != 0.0) {
            if matches!(direction, Direction::Along(_)) {
                let message = format!("the direction of the support leads `{place}` off the axis of the body");
                return refused("direction", message, "fix \"y\"");
            }
            if *displacement != 0.0 {
                let message = format!("the support moves `{place}` aside, which is on the axis of the body");
                let help = "an axisymmetric body is not moved across its axis: move it along y";
                return refused("displacement", message, help);
            }
            continue;
        }
        for &node in &nodes {
            let n = if *direction == Direction::Normal { normals_of[node] } else { Some(n) };
            let Some(n) = n else {
                let at = units.point(mesh.nodes[node]);
                let message = format!("`{place}` has no normal at {at}: its facets there cancel each other");
                return refused("fix", message, "give a direction, or fix axes");
            };
            holding.extend(beside_axis(mesh, &units, &key, (node, n, *displacement))?);
        }
    }
    Ok(holding)
}

/// Returns the part that a support, which moves a node by a length (m) along a unit vector, holds in addition to the
/// axis of a body of revolution; `None` if the axis already holds this direction.
fn beside_axis(
    mesh: &Mesh,
    units: &UnitSystem,
    key: &str,
    (node, n, to): (usize, [f64; 3], f64),
) -> Result<Option<(usize, [f64; 3], f64)>, InputError> {
    if n[1] == 1.0 || !mesh.is_on_axis(node) {
        return Ok(Some((node, n, to)));
    }
    if n[1].abs() > SAME_DIRECTION {
        return Ok(Some((node, axis(1), to / n[1])));
    }
    if to == 0.0 {
        return Ok(None);
    }
    let place = units.point(mesh.nodes[node]);
    let message = format!("the support moves the node at {place} aside, which is on the axis of the body");
    let help = "an axisymmetric body is not moved across its axis: leave the axis out, or move along y";
    Err(InputError::new(format!("{key}.displacement"), message, help))
}

/// Numbers the displacements that the supports leave free.
pub(super) fn dofs(
    mesh: &Mesh,
    points: Vec<ReferencePoint>,
    joints: &Joints,
    holdings: &[Holding],
) -> Result<Dofs, InputError> {
    let mut directions = vec![Vec::new(); mesh.nodes.len() + 2 * points.len()];
    for (node, n, _) in holdings.iter().flatten() {
        directions[*node].push(*n);
    }
    directions.extend((0..joints.all.len()).map(|k| joints.held(k, mesh)));
    let dofs = Dofs::with_points(mesh, points, joints.all.iter().map(|joint| joint.jump.clone()).collect(), |node| {
        std::mem::take(&mut directions[node])
    });
    if dofs.free() == 0 {
        let message = "the supports fix every node of the mesh, so nothing is left to solve";
        return Err(InputError::new("support[0].boundary", message, "support fewer boundaries, or use a finer mesh"));
    }
    Ok(dofs)
}

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
            let mut held = dofs.held(node).filter(|n| mesh.components() == 3 || n[2] == 0.0);
            if held.any(|n| moves(node, n) || dofs.may_move(&relation, n, moves)) {
                let coupling = &description.couplings[of];
                let place = description.system(mesh.dimension).point(mesh.nodes[node]);
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
            (0..mesh.components()).map(|c| dofs.tie(&relation, axis(c))).collect::<Vec<_>>()
        })
    };
    couplings.each_rigid().flat_map(of_point).collect()
}
