//! The mesh of a body of revolution.

use std::sync::Arc;

use crate::base::input_error::InputError;
use crate::body::description::Description;
use crate::body::fem::Plane;
use crate::body::mesh::{Geometry, Mesh, MeshFault};

/// Returns the mesh of `description`; for an axisymmetric material, as half the section of a body of revolution.
pub(super) fn meridian(description: &Description, mesh: Arc<Mesh>) -> Result<Arc<Mesh>, InputError> {
    match (description.material.plane, mesh.geometry) {
        // The check of the material fails for a plane state of a three-dimensional mesh.
        (Some(Plane::Axisymmetric), _) if mesh.dimension == 2 => {}
        (_, Geometry::Cartesian) => return Ok(mesh),
        (_, Geometry::Axisymmetric) => {
            let message = "the mesh is the section of a body of revolution, but the material is not axisymmetric";
            return Err(InputError::new("material.plane", message, "use \"axisymmetric\""));
        }
    }
    let place = |nodes: &[usize]| {
        let furthest = nodes.iter().copied().min_by(|&a, &b| mesh.nodes[a][0].total_cmp(&mesh.nodes[b][0]));
        furthest.map_or(String::new(), |node| description.system(2).place(mesh.nodes[node]))
    };
    let axisymmetric = Mesh::clone(&mesh).into_axisymmetric();
    axisymmetric.map(Arc::new).map_err(|fault| {
        let message = match &fault {
            MeshFault::LeftOfAxis(nodes) => format!(
                "the body is axisymmetric, with x as the distance from the axis, but its mesh reaches to {}",
                place(nodes)
            ),
            other => other.to_string(),
        };
        InputError::new("material.plane", message, fault.help())
    })
}
