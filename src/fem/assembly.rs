//! The stiffness matrix of a mesh.

use super::dofs::Dofs;
use super::elastic::Elasticity;
use super::stiffness::element_stiffness;
use super::strain::Element;
use crate::mesh::{Cell, Mesh};
use crate::sparse::Symmetric;

/// An element whose Jacobian is not positive at an integration point.
#[derive(Debug, Clone, Copy, PartialEq, thiserror::Error)]
#[error("element {element} near ({}) is inverted or degenerate", coordinates(centre, *dimension))]
pub struct InvertedElement {
    /// The number of the element, from 0.
    pub element: usize,
    /// The centre of the element, m.
    pub centre: [f64; 3],
    /// The dimension of the mesh.
    pub dimension: usize,
}

fn coordinates(centre: &[f64; 3], dimension: usize) -> String {
    centre[..dimension].iter().map(|x| format!("{x:.6}")).collect::<Vec<_>>().join(", ")
}

/// `K`, the stiffness of `mesh` for the free unknowns of `dofs`, N/m, in two dimensions per unit
/// depth; every element is an `element`, and `material` is that of each.
///
/// # Errors
/// [`InvertedElement`] for the first element that is not sound.
pub fn assemble(
    mesh: &Mesh,
    dofs: &Dofs,
    element: Element,
    material: impl Fn(usize) -> Elasticity,
) -> Result<Symmetric, InvertedElement> {
    assemble_watched(mesh, dofs, element, material, |_, _| {})
}

/// The same, showing `watch` the stiffness of every cell: as all nodes have it, with the components x, y and z.
pub(super) fn assemble_watched(
    mesh: &Mesh,
    dofs: &Dofs,
    element: Element,
    material: impl Fn(usize) -> Elasticity,
    mut watch: impl FnMut(&Cell, &[Vec<f64>]),
) -> Result<Symmetric, InvertedElement> {
    let mut k = Symmetric::of(dofs.free(), |take| {
        for cell in &mesh.cells {
            let unknowns = dofs.element(&cell.nodes);
            for &column in unknowns.iter().flatten() {
                for &row in unknowns.iter().flatten() {
                    take(row, column);
                }
            }
        }
    });
    for (e, cell) in mesh.cells.iter().enumerate() {
        let mut stiffness = element_stiffness(cell.kind, &mesh.points(&cell.nodes), element, &material(e))
            .ok_or_else(|| InvertedElement { element: e, centre: mesh.centre(e), dimension: mesh.dimension })?;
        watch(cell, &stiffness);
        dofs.turn(&cell.nodes, &mut stiffness);
        let unknowns = dofs.element(&cell.nodes);
        for (row, values) in unknowns.iter().zip(&stiffness) {
            for (column, value) in unknowns.iter().zip(values) {
                if let (Some(row), Some(column)) = (*row, *column)
                    && row >= column
                {
                    k.raise(row, column, *value);
                }
            }
        }
    }
    Ok(k)
}
