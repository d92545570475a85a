//! The elements of a description, which have to suit the cells of its mesh.

use crate::description::Description;
use crate::fault::Fault;
use crate::fem::Element;
use crate::mesh::Mesh;

/// How strains follow from displacements; B-bar needs cells that have a dilatation to average.
pub(super) fn element(description: &Description, mesh: &Mesh) -> Result<Element, Fault> {
    let element = description.element;
    if element == Element::BBar && mesh.cells.iter().any(|cell| cell.kind.is_simplex()) {
        let message = "mesh.element is \"b-bar\", but the mesh has triangles or tetrahedra";
        let help = "use quadrilaterals or hexahedra, or triangles of six and tetrahedra of ten nodes without b-bar: those of the first \
                    order have a uniform dilatation already, so that they lock";
        return Err(Fault::new("mesh.element", message, help));
    }
    Ok(element)
}
