//! Stresses in an element.

use super::elastic::Elasticity;
use super::shape::{gradients, gradients_at};
use super::strain::{Element, mean_gradients, strain_columns};
use crate::mesh::{CellKind, quadrature_of};

/// The stress `(σ_xx, σ_yy, σ_zz, τ_xy, τ_yz, τ_zx)` (Pa) at the centre of a cell with `nodes` (m) and the
/// `displacements` (m) of these; see [`Elasticity::stress`] for the plane. `None` if the element is inverted
/// or degenerate.
pub fn centre_stress(
    kind: CellKind,
    nodes: &[[f64; 3]],
    displacements: &[[f64; 3]],
    element: Element,
    material: &Elasticity,
) -> Option<[f64; 6]> {
    stress_at(kind, kind.centre(), nodes, displacements, element, material)
}

/// The same at the reference point `point` of the cell.
pub fn stress_at(
    kind: CellKind,
    point: [f64; 3],
    nodes: &[[f64; 3]],
    displacements: &[[f64; 3]],
    element: Element,
    material: &Elasticity,
) -> Option<[f64; 6]> {
    Some(material.stress(strain_at(kind, point, nodes, displacements, element)?))
}

/// The strain `(ε_xx, ε_yy, ε_zz, γ_xy, γ_yz, γ_zx)` there.
pub fn strain_at(
    kind: CellKind,
    point: [f64; 3],
    nodes: &[[f64; 3]],
    displacements: &[[f64; 3]],
    element: Element,
) -> Option<[f64; 6]> {
    let (here, _) = gradients(kind, point, nodes)?;
    let points = gradients_at(kind, &quadrature_of(kind, nodes), nodes)?;
    let mean = mean_gradients(&points);
    let dilatation = match element {
        Element::Bilinear | Element::NodalVolume => &here,
        Element::BBar => &mean,
    };
    Some(strain(kind, &here, dilatation, displacements))
}

/// The volume (m³; in two dimensions the area, m²) of a cell as above.
pub fn cell_volume(kind: CellKind, nodes: &[[f64; 3]]) -> Option<f64> {
    Some(gradients_at(kind, &quadrature_of(kind, nodes), nodes)?.iter().map(|(_, volume)| volume).sum())
}

/// The strains `(ε_xx, ε_yy, ε_zz, γ_xy, γ_yz, γ_zx)` at the integration points of a cell as above, each with the volume (m³; in
/// two dimensions the area, m²) that its point stands for. `None` if the element is inverted or degenerate.
pub fn strains(
    kind: CellKind,
    nodes: &[[f64; 3]],
    displacements: &[[f64; 3]],
    element: Element,
) -> Option<Vec<(f64, [f64; 6])>> {
    let points = gradients_at(kind, &quadrature_of(kind, nodes), nodes)?;
    let mean = mean_gradients(&points);
    let at_point = |(gradients, volume): &(Vec<[f64; 3]>, f64)| {
        let dilatation = match element {
            Element::Bilinear | Element::NodalVolume => gradients,
            Element::BBar => &mean,
        };
        (*volume, strain(kind, gradients, dilatation, displacements))
    };
    Some(points.iter().map(at_point).collect())
}

/// The strain of `displacements` of the nodes, see [`strain_columns`].
fn strain(kind: CellKind, gradients: &[[f64; 3]], dilatation: &[[f64; 3]], displacements: &[[f64; 3]]) -> [f64; 6] {
    let columns = strain_columns(kind.dimension(), gradients, dilatation);
    let unknowns = displacements.iter().flat_map(|u| &u[..kind.dimension()]);
    let mut strain = [0.0; 6];
    for (column, u) in columns.iter().zip(unknowns) {
        strain.iter_mut().zip(column).for_each(|(sum, c)| *sum += c * u);
    }
    strain
}
