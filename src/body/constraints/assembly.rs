//! Assembly of the stiffness matrix of a mesh.

use rayon::prelude::*;

use super::dofs::Dofs;
use crate::algebra::sparse::Symmetric;
use crate::algebra::vector::axis;
use crate::body::fem::{
    Elasticity, Element, InvertedElement, NodalVolume, NodalVolumes, Spring, element_stiffness, uniform_traction,
};
use crate::body::mesh::{Boundary, Mesh};

/// The number of cells whose stiffnesses are computed in parallel before they are added in the order of the cells.
const TOGETHER: usize = 4096;

/// Assembles `K`, the stiffness of `mesh` for the free unknowns of `dofs`, N/m; in two dimensions per unit depth, for a
/// body of revolution over the full circumference.
///
/// All elements have the formulation `element`; `material` returns the law of each cell.
///
/// # Errors
/// [`InvertedElement`] for the first inverted or degenerate element.
pub fn assemble(
    mesh: &Mesh,
    dofs: &Dofs,
    element: Element,
    material: impl Fn(usize) -> Elasticity + Sync,
) -> Result<Symmetric, InvertedElement> {
    let volumes = NodalVolumes::new(mesh, element, &material)?;
    assemble_watched(mesh, dofs, element, &volumes, material, |_, _| {})
}

/// Assembles `K` with the nodal volumes of the mesh. Calls `watch` with the nodes and the stiffness of every cell and
/// nodal volume, for the components x, y and z of all nodes.
pub(super) fn assemble_watched(
    mesh: &Mesh,
    dofs: &Dofs,
    element: Element,
    volumes: &NodalVolumes,
    material: impl Fn(usize) -> Elasticity + Sync,
    mut watch: impl FnMut(&[usize], &[Vec<f64>]),
) -> Result<Symmetric, InvertedElement> {
    let mut k = Symmetric::of(dofs.free(), |take| {
        let cells = mesh.cells.iter().map(|cell| &cell.nodes[..]);
        for nodes in cells.chain(volumes.iter().map(NodalVolume::nodes)) {
            let unknowns = dofs.unknowns_of(nodes);
            for (k, &column) in unknowns.iter().enumerate() {
                unknowns[k..].iter().for_each(|&row| take(row, column));
            }
        }
    });
    let mut add = |nodes: &[usize], stiffness: Vec<Vec<f64>>| {
        if dofs.are_rigid(nodes) {
            return;
        }
        watch(nodes, &stiffness);
        let (unknowns, stiffness) = dofs.reduced(nodes, stiffness);
        for (row, values) in stiffness.iter().enumerate() {
            (0..=row).for_each(|column| k.raise(unknowns[row], unknowns[column], values[column]));
        }
    };
    let law = |e: usize| {
        let whole = material(e);
        if volumes.of_cell(e).is_empty() { whole } else { whole.deviatoric() }
    };
    each_stiffness(mesh, element, law, mesh.cells.len(), |k| k, &mut add)?;
    for volume in volumes.iter() {
        add(volume.nodes(), volume.stiffness(mesh.dimension));
    }
    Ok(k)
}

/// Calls a function with the nodes and the stiffness of `count` cells in order; the cell with index `k` is `cell(k)`.
pub(super) fn each_stiffness(
    mesh: &Mesh,
    element: Element,
    law: impl Fn(usize) -> Elasticity + Sync,
    count: usize,
    cell: impl Fn(usize) -> usize + Sync,
    take: &mut impl FnMut(&[usize], Vec<Vec<f64>>),
) -> Result<(), InvertedElement> {
    let of_cell = |k: usize| {
        let e = cell(k);
        let (law, cell) = (law(e), &mesh.cells[e]);
        let stiffness = element_stiffness(cell.kind, mesh.geometry, &mesh.points(&cell.nodes), element, &law);
        stiffness.ok_or_else(|| InvertedElement::of(mesh, e))
    };
    for first in (0..count).step_by(TOGETHER) {
        let cells = first..count.min(first + TOGETHER);
        let together: Vec<_> = cells.clone().into_par_iter().map(of_cell).collect();
        for (k, stiffness) in cells.zip(together) {
            take(&mesh.cells[cell(k)].nodes, stiffness?);
        }
    }
    Ok(())
}

/// Computes the nodal forces (length n_u; N, in two dimensions per unit depth, for a body of revolution over the full
/// circumference) of a uniform `traction` (N/m²) on `boundary`: `∫ N_a t dA`.
pub fn facet_load(mesh: &Mesh, dofs: &Dofs, boundary: &Boundary, traction: [f64; 3]) -> Vec<f64> {
    dofs.forces(uniform_traction(mesh, boundary, traction))
}

impl Spring {
    /// Adds it to the stiffness `k` of the body, which already couples the nodes of a facet.
    pub fn add_to(&self, k: &mut Symmetric, dofs: &Dofs) {
        let unit_along = |place: usize| dofs.along(place / 3, axis(place % 3)).filter(|(_, c)| *c != 0.0);
        for (row, column, value) in self.entries().filter(|(.., value)| *value != 0.0) {
            for (i, along_row) in unit_along(row) {
                for (j, along_column) in unit_along(column).filter(|(j, _)| i >= *j) {
                    k.raise(i, j, value * along_row * along_column);
                }
            }
        }
    }
}
