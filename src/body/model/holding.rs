//! The displacements of a mesh that the supports of a description hold.

use super::coupling::Couplings;
use super::find;
use super::joint::Joints;
use super::place::{nodes, normals, suits};
use crate::algebra::vector::{axis, norm, unit};
use crate::base::input_error::InputError;
use crate::base::units::UnitSystem;
use crate::body::description::{Axis, Description, Direction, Held, Support, Where};
use crate::body::fem::{Dofs, ReferencePoint, SAME_DIRECTION};
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
    let units = description.system(mesh.dimension);
    let of_support = |(k, support): (usize, &Support)| match &support.at {
        Where::Coupling(name) => of_coupling(mesh, support, (couplings, points), name, k),
        _ => holding(mesh, support, &units, k),
    };
    description.supports.iter().enumerate().map(of_support).collect()
}

/// Returns the displacements that support `k` holds at the reference point of the coupling called `name`. The node of the
/// rotation has its angles times a length as displacements.
fn of_coupling(
    mesh: &Mesh,
    support: &Support,
    (couplings, points): (&Couplings, &[ReferencePoint]),
    name: &str,
    k: usize,
) -> Result<Holding, InputError> {
    let key = format!("support[{k}]");
    let (point, [translation, rotation]) = couplings.rigid(name, "the support", &key)?;
    let axisymmetric = mesh.geometry == Geometry::Axisymmetric;
    let mut holding = Vec::new();
    for Held { direction, displacement } in &support.held {
        let refused = |message: String, help: &str| Err(InputError::new(format!("{key}.fix"), message, help));
        match direction {
            Direction::Axis(Axis::Z) if mesh.dimension == 2 => {
                let message = format!("the support of `{name}` holds z, but the body has two dimensions");
                return refused(message, "leave out \"z\"");
            }
            Direction::Rotation(_) if axisymmetric => {
                let help = "leave the rotation out";
                return refused(format!("`{name}` belongs to a body of revolution, which does not turn"), help);
            }
            Direction::Rotation(Axis::X | Axis::Y) if mesh.dimension == 2 => {
                let message = format!("`{name}` belongs to a plane body, which turns about z only");
                return refused(message, "fix \"rotation_z\"");
            }
            Direction::Rotation(about) => {
                let turned = points[point].of_rotation(mesh.dimension, axis(*about as usize));
                let length = norm(turned);
                holding.push((rotation, turned.map(|c| c / length), displacement * length));
            }
            Direction::Axis(Axis::X) if axisymmetric => {
                if *displacement != 0.0 {
                    let message = format!("the support moves `{name}` aside, which is on the axis of the body");
                    let help = "an axisymmetric body is not moved across its axis: move it along y";
                    return Err(InputError::new(format!("{key}.displacement"), message, help));
                }
            }
            Direction::Axis(along) => holding.push((translation, axis(*along as usize), *displacement)),
            Direction::Along(vector) => {
                suits(mesh, *vector, &format!("{key}.direction"))?;
                let n = unit(vector.components());
                if axisymmetric && n[0] != 0.0 {
                    let message = format!("the direction of the support leads `{name}` off the axis of the body");
                    return Err(InputError::new(format!("{key}.direction"), message, "fix \"y\""));
                }
                holding.push((translation, n, *displacement));
            }
            // The check of the description refuses it.
            Direction::Normal => {}
        }
    }
    Ok(holding)
}

fn holding(mesh: &Mesh, support: &Support, units: &UnitSystem, k: usize) -> Result<Holding, InputError> {
    let key = format!("support[{k}]");
    let nodes = nodes(mesh, &support.at, units, &key)?;
    let mut holding = Vec::new();
    for Held { direction, displacement } in &support.held {
        let mut hold = |node: usize, n: [f64; 3]| {
            holding.extend(beside_axis(mesh, units, &key, (node, n, *displacement))?);
            Ok(())
        };
        match direction {
            Direction::Axis(Axis::Z) if mesh.dimension == 2 => {
                let place = support.at.place(units);
                let message = format!("the support of `{place}` holds z, but the body has two dimensions");
                return Err(InputError::new(format!("{key}.fix"), message, "leave out \"z\""));
            }
            Direction::Axis(along) => nodes.iter().try_for_each(|&node| hold(node, axis(*along as usize)))?,
            Direction::Along(vector) => {
                suits(mesh, *vector, &format!("{key}.direction"))?;
                let n = unit(vector.components());
                nodes.iter().try_for_each(|&node| hold(node, n))?;
            }
            // The check of the description refuses it.
            Direction::Rotation(_) => {}
            Direction::Normal => {
                let Where::Boundary(name) = &support.at else { continue };
                let normals = normals(mesh, find(mesh, name, &key)?);
                for &node in &nodes {
                    let Some(n) = normals[node] else {
                        let place = units.place(mesh.nodes[node]);
                        let message = format!("`{name}` has no normal at {place}: its facets there cancel each other");
                        return Err(InputError::new(format!("{key}.fix"), message, "give a direction, or fix axes"));
                    };
                    hold(node, n)?;
                }
            }
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
    if !mesh.is_on_axis(node) || n[0] == 0.0 {
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
