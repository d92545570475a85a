//! Strains and stresses in an element.

use super::shape::CellPoint;
use super::strain::{Element, Strain, strain_columns};
use crate::body::mesh::{CellKind, Geometry, quadrature_of};

/// Computes the strain `(ε_xx, ε_yy, ε_zz, γ_xy, γ_yz, γ_zx)` at the reference point `point` of a cell with `nodes`
/// (m) and their `displacements` (m).
///
/// In a body of revolution `ε_zz` is the hoop strain. `None` if the element is inverted or degenerate.
pub fn strain_at(
    kind: CellKind,
    geometry: Geometry,
    point: [f64; 3],
    nodes: &[[f64; 3]],
    displacements: &[[f64; 3]],
    element: Element,
) -> Option<[f64; 6]> {
    let here = CellPoint::new(kind, geometry, nodes, (point, 1.0))?;
    let points = CellPoint::all(kind, geometry, nodes, &quadrature_of(kind, geometry, nodes))?;
    Some(strain(kind, &here, element.mean_dilatation(&points).as_deref(), displacements))
}

/// Computes the volume (m³; in two dimensions the area, m²) of a cell, as in [`strain_at`].
pub fn cell_volume(kind: CellKind, geometry: Geometry, nodes: &[[f64; 3]]) -> Option<f64> {
    let points = CellPoint::all(kind, geometry, nodes, &quadrature_of(kind, geometry, nodes))?;
    Some(points.iter().map(|point| point.volume).sum())
}

/// Computes the strains `(ε_xx, ε_yy, ε_zz, γ_xy, γ_yz, γ_zx)` at the integration points of a cell, as in
/// [`strain_at`], each with the volume (m³; in two dimensions the area, m²) of its point.
///
/// `None` if the element is inverted or degenerate.
pub fn strains(
    kind: CellKind,
    geometry: Geometry,
    nodes: &[[f64; 3]],
    displacements: &[[f64; 3]],
    element: Element,
) -> Option<Vec<(f64, [f64; 6])>> {
    let points = CellPoint::all(kind, geometry, nodes, &quadrature_of(kind, geometry, nodes))?;
    let mean = element.mean_dilatation(&points);
    let at = |point: &CellPoint| (point.volume, strain(kind, point, mean.as_deref(), displacements));
    Some(points.iter().map(at).collect())
}

/// Computes the strain of `displacements` of the nodes, see [`strain_columns`].
fn strain(kind: CellKind, point: &CellPoint, mean: Option<&[[f64; 3]]>, displacements: &[[f64; 3]]) -> Strain {
    let columns = strain_columns(kind.dimension(), point, mean);
    let unknowns = displacements.iter().flat_map(|u| &u[..kind.dimension()]);
    let mut strain = [0.0; 6];
    for (column, u) in columns.iter().zip(unknowns) {
        strain.iter_mut().zip(column).for_each(|(sum, c)| *sum += c * u);
    }
    strain
}
