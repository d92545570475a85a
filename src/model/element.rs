//! The elements of a description, which have to suit the cells of its mesh.

use crate::description::Description;
use crate::fault::Fault;
use crate::fem::{Element, NodalVolumes};
use crate::mesh::{CellKind, Mesh};

/// How strains follow from displacements: B-bar needs cells that have a dilatation to average, nodal volumes cells that have none.
pub(super) fn element(description: &Description, mesh: &Mesh) -> Result<Element, Fault> {
    let element = description.element;
    let kinds = || mesh.cells.iter().map(|cell| cell.kind);
    match element {
        Element::BBar if kinds().any(CellKind::is_simplex) => {
            let message = "mesh.element is \"b-bar\", but the mesh has triangles or tetrahedra";
            let help = "use quadrilaterals or hexahedra, or triangles of six and tetrahedra of ten nodes without b-bar: those of the \
                        first order have a uniform dilatation already, so that they lock; for them there is \"nodal-volume\"";
            Err(Fault::new("mesh.element", message, help))
        }
        Element::NodalVolume => match kinds().find(|kind| !NodalVolumes::take(*kind)) {
            None => Ok(element),
            Some(kind) => {
                let message = format!("mesh.element is \"nodal-volume\", but the mesh has a {}", kind.name());
                let help = if kind.is_quadratic() {
                    "use \"bilinear\": triangles of six and tetrahedra of ten nodes need no remedy up to nu = 0.499"
                } else {
                    "nodal volumes are for linear triangles and tetrahedra: use \"b-bar\", or a mesh of these alone"
                };
                Err(Fault::new("mesh.element", message, help))
            }
        },
        Element::Bilinear | Element::BBar => Ok(element),
    }
}
