//! The element formulation of a description; it must suit the cells of the mesh.

use crate::base::input_error::InputError;
use crate::body::description::Description;
use crate::body::fem::{Element, NodalVolumes};
use crate::body::mesh::{CellKind, Mesh};

/// Returns the element formulation and checks it: B-bar is for quadrilaterals, hexahedra and prisms of first order,
/// nodal volumes are for triangles, tetrahedra, prisms and all cells of second order. The one mean dilatation of B-bar
/// would make a cell of second order far too soft.
pub(super) fn element(description: &Description, mesh: &Mesh) -> Result<Element, InputError> {
    let element = description.element;
    let kinds = || mesh.cells.iter().map(|cell| cell.kind);
    match element {
        Element::BBar if kinds().any(CellKind::is_simplex) => {
            let message = "mesh.element is \"b-bar\", but the mesh has triangles or tetrahedra";
            let help = "use \"nodal-volume\", quadrilaterals or hexahedra, or triangles of six and tetrahedra of ten nodes without b-bar, which need no \
                        remedy up to nu = 0.499";
            Err(InputError::new("mesh.element", message, help))
        }
        Element::BBar if kinds().any(CellKind::is_quadratic) => {
            let message = "mesh.element is \"b-bar\", but the mesh has cells of second order";
            let help = "use \"nodal-volume\" near nu = 1/2; up to nu = 0.49 cells of second order need no remedy";
            Err(InputError::new("mesh.element", message, help))
        }
        Element::NodalVolume => match kinds().find(|kind| !NodalVolumes::take(*kind)) {
            None => Ok(element),
            Some(kind) => {
                let message = format!("mesh.element is \"nodal-volume\", but the mesh has a {}", kind.name());
                let help = "nodal volumes are for triangles, tetrahedra and prisms, and for second order: use \"b-bar\", or a mesh of these alone";
                Err(InputError::new("mesh.element", message, help))
            }
        },
        Element::Bilinear | Element::BBar => Ok(element),
    }
}
