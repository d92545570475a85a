//! Inverted or degenerate elements.

use crate::body::mesh::Mesh;

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

impl InvertedElement {
    /// Creates the error of element `element` of `mesh`.
    pub(crate) fn of(mesh: &Mesh, element: usize) -> Self {
        InvertedElement { element, centre: mesh.centre(element), dimension: mesh.dimension }
    }
}

fn coordinates(centre: &[f64; 3], dimension: usize) -> String {
    centre[..dimension].iter().map(|x| format!("{x:.6}")).collect::<Vec<_>>().join(", ")
}
