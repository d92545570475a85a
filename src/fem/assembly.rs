//! The stiffness matrix of a mesh.

use super::dofs::Dofs;
use super::elastic::Elasticity;
use super::stiffness::element_stiffness;
use super::strain::Element;
use crate::mesh::Mesh;
use crate::sparse::Symmetric;

/// An element whose Jacobian is not positive at a Gauss point.
#[derive(Debug, Clone, Copy, PartialEq, thiserror::Error)]
#[error("element {element} near ({:.6}, {:.6}) is inverted or degenerate", centre[0], centre[1])]
pub struct InvertedElement {
    /// Its number, from 0.
    pub element: usize,
    /// Its centre, m.
    pub centre: [f64; 2],
}

/// `K`, the stiffness of `mesh` for the free unknowns of `dofs`, N/m per unit depth; every
/// element is an `element`, and `material` is that of each.
///
/// # Errors
/// [`InvertedElement`] for the first element that is not sound.
pub fn assemble(
    mesh: &Mesh,
    dofs: &Dofs,
    element: Element,
    material: impl Fn(usize) -> Elasticity,
) -> Result<Symmetric, InvertedElement> {
    let mut k = Symmetric::from_entries(dofs.free(), |take| {
        for quad in &mesh.quads {
            let element = dofs.element(quad);
            for column in element.into_iter().flatten() {
                for row in element.into_iter().flatten() {
                    take(row, column);
                }
            }
        }
    });
    for (e, quad) in mesh.quads.iter().enumerate() {
        let corners = mesh.corners(e);
        let stiffness = element_stiffness(&corners, element, &material(e))
            .ok_or_else(|| InvertedElement { element: e, centre: mesh.centre(e) })?;
        let dofs = dofs.element(quad);
        for (i, row) in dofs.iter().enumerate() {
            for (j, column) in dofs.iter().enumerate() {
                if let (Some(row), Some(column)) = (*row, *column) {
                    k.add(row, column, stiffness[i][j]);
                }
            }
        }
    }
    Ok(k)
}
