//! The loads of a description as forces on the nodes of its mesh.

use std::sync::atomic::AtomicBool;
use std::sync::atomic::Ordering::Relaxed;

use super::constraints::Constraints;
use super::coupling::about_axes;
use super::discrete::{Discrete, Elements};
use super::find;
use super::place::{along_the_axis, counts_as_force, in_space, node, suits, with_area};
use crate::algebra::vector::{Vector, axis, cross, dot, minus, norm, unit};
use crate::base::formula::Field;
use crate::base::input_error::InputError;
use crate::body::description::{Action, Description, Where};
use crate::body::fem::{
    NodalForces, Plane, area, body_force, thermal_forces, traction as traction_of, uniform_traction,
};
use crate::body::mesh::{Boundary, Geometry, Mesh};

/// The thermal strain, equal along all axes.
#[derive(Debug, Clone)]
pub(super) struct FreeStrain {
    /// The strain at the centre of each cell.
    pub of_cells: Vec<f64>,
    /// The mean strain in each nodal volume.
    pub of_volumes: Vec<f64>,
}

/// The effect of a load at factor 1: its forces and, for a thermal load, the stress-free strain.
pub(super) type NodalLoad = (NodalForces, Option<FreeStrain>);

/// Returns the given point of the axis of a rotation, or that of a body of revolution.
fn point_of_axis(mesh: &Mesh, through: Option<Vector>, key: &str) -> Result<Vector, InputError> {
    let own = mesh.geometry.is_revolved().then(|| [0.0, 0.0].into());
    through.or(own).ok_or_else(|| {
        InputError::new(key, "the rotation has no point of its axis", "add through, such as through = [0, 0]")
    })
}

/// Computes the effect of load `k` at factor 1.
pub(super) fn load(description: &Description, discrete: &Discrete, k: usize) -> Result<NodalLoad, InputError> {
    let Discrete { mesh, elements, constraints: Constraints { dofs, couplings, .. }, .. } = discrete;
    let Elements { element, materials, volumes } = elements;
    let key = format!("load[{k}]");
    let at = |name: &str| format!("{key}.{name}");
    let boundary = |name: &str| find(mesh, name, &key);
    let thin = description.material.plane == Some(Plane::Stress);
    let mut free_strain = None;
    let forces = match &description.loads[k].action {
        Action::Traction { boundary: name, traction } => tractions(mesh, boundary(name)?, traction, &at("traction"))?,
        Action::Pressure { boundary: name, pressure } => {
            let forces = traction_of(mesh, boundary(name)?, |x, area| area.map(|a| -pressure.at(x) * a));
            defined(forces, &at("pressure"), "pressure")?
        }
        Action::Force { at: place, force } => {
            let force = in_space(mesh, force, &at("force"))?;
            match place {
                Where::Point(point) => {
                    vec![(node(mesh, *point, &description.system(mesh.dimension), &key)?, force)]
                }
                Where::Boundary(name) => {
                    let boundary = with_area(mesh, name, &at("boundary"), boundary(name)?, "a force")?;
                    uniform_traction(mesh, boundary, force.map(|f| f / area(mesh, boundary)))
                }
                Where::Coupling(name) => {
                    along_the_axis(mesh, "force", force, &at("force"))?;
                    couplings.forces(dofs, name, [force, [0.0; 3]], &key)?
                }
            }
        }
        Action::Moment { coupling, moment } => {
            let moment = about_axes(mesh, moment, &at("moment"))?;
            couplings.forces(dofs, coupling, [[0.0; 3], moment], &key)?
        }
        Action::Acceleration(acceleration) => {
            let acceleration = in_space(mesh, acceleration, &at("acceleration"))?;
            if mesh.geometry.is_revolved() && (acceleration[0] != 0.0 || acceleration[2] != 0.0) {
                let message = "acceleration has a component across the axis, which points to all sides at once";
                let help = "give [0, y], with torsion [0, y, 0]; what pulls away from the axis because the body spins is a load by rotation";
                return Err(InputError::new(at("acceleration"), message, help));
            }
            let density = description.material.densities(mesh)?;
            body_force(mesh, |e, _| acceleration.map(|a| density[e] * a))
        }
        Action::Spin { axis: given, through, speed } => {
            let through = point_of_axis(mesh, *through, &at("rotation"))?;
            suits(mesh, through, &at("rotation.through"))?;
            let own = if mesh.geometry.is_revolved() { axis(1) } else { axis(2) };
            let along = given.map_or(own, |axis| unit(axis.components()));
            if mesh.dimension == 2 && cross(along, own) != [0.0; 3] {
                let message = match mesh.geometry {
                    Geometry::Cartesian => {
                        "the axis of the rotation leaves the plane of the body, which has two dimensions"
                    }
                    _ => "the axis of the rotation is not that of the body, y",
                };
                return Err(InputError::new(at("rotation.axis"), message, "leave it out"));
            }
            if mesh.geometry.is_revolved() && through.components()[0] != 0.0 {
                let message = "the axis of the rotation does not go through that of the body, x = 0";
                let help = "give a point of the axis, such as [0, 0]";
                return Err(InputError::new(at("rotation.through"), message, help));
            }
            let density = description.material.densities(mesh)?;
            let through = through.components();
            body_force(mesh, |e, x| {
                let arm = minus(x, through);
                let up = dot(arm, along);
                minus(arm, along.map(|c| up * c)).map(|r| density[e] * speed * speed * r)
            })
        }
        Action::Temperature(temperature) => {
            let expansion = description.material.expansions(mesh, |_| false)?;
            let warm: Vec<AtomicBool> = mesh.cells.iter().map(|_| AtomicBool::new(false)).collect();
            let strain = |e: usize, x: [f64; 3]| {
                let temperature = temperature.at(x);
                warm[e].fetch_or(temperature != 0.0, Relaxed);
                expansion[e] * temperature
            };
            let of_cells: Vec<f64> = (0..mesh.cells.len()).map(|e| strain(e, mesh.centre(e))).collect();
            let of_volumes = volumes.means(mesh, strain);
            // If dilatations are averaged, thermal strains must be averaged as well; their difference would cause a
            // pressure.
            let forces = if volumes.is_empty() {
                thermal_forces(mesh, *element, thin, |e| materials[e], strain)
            } else {
                volumes.forces(&of_volumes.iter().map(|strain| 3.0 * strain).collect::<Vec<_>>())
            };
            description.material.expansions(mesh, |e| warm[e].load(Relaxed))?;
            free_strain = Some(FreeStrain { of_cells, of_volumes });
            defined(forces, &at("temperature"), "temperature")?
        }
    };
    Ok((forces, free_strain))
}

/// Computes the forces of a traction on `boundary`.
fn tractions(mesh: &Mesh, boundary: &Boundary, given: &[Field], key: &str) -> Result<NodalForces, InputError> {
    counts_as_force(mesh, key, given.len())?;
    if let Some(uniform) = given.iter().map(Field::uniform).collect::<Option<Vec<_>>>() {
        return Ok(uniform_traction(mesh, boundary, in_space(mesh, &uniform, key)?));
    }
    let at = |x: [f64; 3], size: f64| [0, 1, 2].map(|c| given.get(c).map_or(0.0, |field| size * field.at(x)));
    let forces = traction_of(mesh, boundary, |x, area| at(x, norm(area)));
    defined(forces, key, "traction")
}

/// Fails unless all `forces` are finite; a formula may be undefined somewhere.
fn defined(forces: NodalForces, key: &str, what: &str) -> Result<NodalForces, InputError> {
    if forces.iter().flat_map(|(_, force)| force).all(|f| f.is_finite()) {
        return Ok(forces);
    }
    let message = format!("the {what} is not a finite number everywhere");
    Err(InputError::new(key, message, "give a formula that has a value wherever the load acts"))
}
