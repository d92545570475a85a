//! The body of a description: supports, elements and tractions, which have to fit its mesh.

use super::find;
use crate::description::Description;
use crate::fault::Fault;
use crate::fem::{Dofs, Element};
use crate::mesh::Mesh;

/// The displacements that the supports leave free.
pub(super) fn dofs(description: &Description, mesh: &Mesh) -> Result<Dofs, Fault> {
    let mut fixed = vec![[false; 3]; mesh.nodes.len()];
    for (k, support) in description.supports.iter().enumerate() {
        if support.fix[2] && mesh.dimension == 2 {
            let message = format!("the support of `{}` holds z, but the body has two dimensions", support.boundary);
            return Err(Fault::new(format!("support[{k}].fix"), message, "leave out \"z\""));
        }
        for node in find(mesh, &support.boundary, &format!("support[{k}]"))?.nodes() {
            for (fixed, fix) in fixed[node].iter_mut().zip(support.fix) {
                *fixed |= fix;
            }
        }
    }
    let dofs = Dofs::new(mesh, |node, component| fixed[node][component]);
    if dofs.free() == 0 {
        let message = "the supports fix every node of the mesh, so nothing is left to solve";
        return Err(Fault::new("support[0].boundary", message, "support fewer boundaries, or use a finer mesh"));
    }
    Ok(dofs)
}

/// How strains follow from displacements; B-bar needs cells that have a dilatation to average.
pub(super) fn element(description: &Description, mesh: &Mesh) -> Result<Element, Fault> {
    let element = description.element;
    if element == Element::BBar && mesh.cells.iter().any(|cell| cell.kind.is_simplex()) {
        let message = "mesh.element is \"b-bar\", but the mesh has triangles or tetrahedra";
        let help = "their dilatation is uniform already, so that they lock: use quadrilaterals or hexahedra";
        return Err(Fault::new("mesh.element", message, help));
    }
    Ok(element)
}

/// The traction of load `k`, which has to have as many components as the body has dimensions.
pub(super) fn traction(description: &Description, mesh: &Mesh, k: usize) -> Result<[f64; 3], Fault> {
    let load = &description.loads[k];
    match (mesh.dimension, &load.traction[..]) {
        (2, &[x, y]) => Ok([x, y, 0.0]),
        (3, &[x, y, z]) => Ok([x, y, z]),
        (dimension, components) => {
            let n = components.len();
            let message = format!(
                "the traction on `{}` has {n} components, but the body has {dimension} dimensions",
                load.boundary
            );
            let help = if dimension == 2 { "give [x, y], N/m²" } else { "give [x, y, z], N/m²" };
            Err(Fault::new(format!("load[{k}].traction"), message, help))
        }
    }
}
