//! The displacements of a mesh that the supports of a description hold.

use super::coupling::Couplings;
use super::find;
use super::joint::Joints;
use super::place::{nodes, normals, suits};
use crate::algebra::vector::{axis, norm, unit};
use crate::base::input_error::InputError;
use crate::base::units::UnitSystem;
use crate::body::constraints::{Dofs, ReferencePoint, SAME_DIRECTION};
use crate::body::description::{Axis, Description, Direction, Held, Support, Where};
use crate::body::mesh::{Geometry, Mesh};

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
    let axisymmetric = mesh.geometry == Geometry::Axisymmetric;
    let place = support.at.place(&units);
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
            Direction::Axis(Axis::Z) if mesh.dimension == 2 => {
                let message = format!("the support of `{place}` holds z, but the body has two dimensions");
                return refused("fix", message, "leave out \"z\"");
            }
            Direction::Rotation(_) if axisymmetric => {
                let help = "leave the rotation out";
                return refused("fix", format!("`{place}` belongs to a body of revolution, which does not turn"), help);
            }
            Direction::Rotation(Axis::X | Axis::Y) if mesh.dimension == 2 => {
                let message = format!("`{place}` belongs to a plane body, which turns about z only");
                return refused("fix", message, "fix \"rotation_z\"");
            }
            Direction::Rotation(about) => {
                // The check of the description refuses it elsewhere.
                let Some((point, [_, rotation])) = point else { continue };
                let turned = points[point].of_rotation(mesh.dimension, axis(*about as usize));
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
        if point.is_some() && axisymmetric && n[0] != 0.0 {
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
                let at = units.place(mesh.nodes[node]);
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
    if n[0] == 0.0 || !mesh.is_on_axis(node) {
        return Ok(Some((node, n, to)));
    }
    if n[1].abs() > SAME_DIRECTION {
        return Ok(Some((node, axis(1), to / n[1])));
    }
    if to == 0.0 {
        return Ok(None);
    }
    let place = units.place(mesh.nodes[node]);
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
    directions.extend((0..joints.all.len()).map(|k| joints.held(k, mesh.dimension)));
    let dofs = Dofs::with_points(mesh, points, joints.jumps(), |node| std::mem::take(&mut directions[node]));
    if dofs.free() == 0 {
        let message = "the supports fix every node of the mesh, so nothing is left to solve";
        return Err(InputError::new("support[0].boundary", message, "support fewer boundaries, or use a finer mesh"));
    }
    Ok(dofs)
}
