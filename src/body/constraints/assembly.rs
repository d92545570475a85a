//! Assembly of the stiffness matrix of a mesh, and of its rows at held nodes: support forces, and forces on the rest of the
//! body due to prescribed displacements.

use std::collections::BTreeMap;

use rayon::prelude::*;

use super::dofs::Dofs;
use crate::algebra::sparse::{Csr, Symmetric};
use crate::body::fem::{
    Elasticity, Element, InvertedElement, NodalForces, NodalVolume, NodalVolumes, Spring, element_stiffness,
    uniform_traction,
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
    assemble_watched(mesh, dofs, element, (&volumes, &[]), material, |_, _| {})
}

/// Assembles the entries of `K` whose row or column belongs to a node with `here` equal to `true`, for distribution over
/// several processes. The values equal those of [`assemble`] exactly. Relative nodes and averaged dilatations are not
/// supported.
///
/// # Errors
/// [`InvertedElement`] for the first inverted or degenerate element at these nodes.
pub(crate) fn assemble_part(
    mesh: &Mesh,
    dofs: &Dofs,
    element: Element,
    material: impl Fn(usize) -> Elasticity + Sync,
    here: &[bool],
) -> Result<Symmetric, InvertedElement> {
    let mut wanted = vec![false; dofs.free()];
    for (node, here) in here.iter().enumerate() {
        dofs.node(node).iter().flatten().for_each(|dof| wanted[*dof] = *here);
    }
    let (cells, none) = (cells_at(mesh, |node| here[node]), (&NodalVolumes::default(), &[][..]));
    assemble_entries(mesh, dofs, element, none, material, (&cells, |i, j| wanted[i] || wanted[j]), |_, _| {})
}

/// Assembles `K` with the nodal volumes of the mesh and springs. Calls `watch` with the nodes and the stiffness of every cell,
/// nodal volume and spring, for the components x, y and z of all nodes.
fn assemble_watched(
    mesh: &Mesh,
    dofs: &Dofs,
    element: Element,
    (volumes, springs): (&NodalVolumes, &[Spring]),
    material: impl Fn(usize) -> Elasticity + Sync,
    watch: impl FnMut(&[usize], &[Vec<f64>]),
) -> Result<Symmetric, InvertedElement> {
    let cells: Vec<usize> = (0..mesh.cells.len()).collect();
    assemble_entries(mesh, dofs, element, (volumes, springs), material, (&cells, |_, _| true), watch)
}

/// Assembles the `wanted` entries of `K`, by row and column, of `cells`, nodal volumes and springs, whose nodes the cells
/// already couple.
fn assemble_entries(
    mesh: &Mesh,
    dofs: &Dofs,
    element: Element,
    (volumes, springs): (&NodalVolumes, &[Spring]),
    material: impl Fn(usize) -> Elasticity + Sync,
    (cells, wanted): (&[usize], impl Fn(usize, usize) -> bool),
    mut watch: impl FnMut(&[usize], &[Vec<f64>]),
) -> Result<Symmetric, InvertedElement> {
    let mut k = Symmetric::of(dofs.free(), |take| {
        let of_cells = cells.iter().map(|&e| &mesh.cells[e].nodes[..]);
        for nodes in of_cells.chain(volumes.volumes.iter().map(|volume: &NodalVolume| &volume.nodes[..])) {
            let unknowns = dofs.unknowns_of(nodes);
            for (k, &column) in unknowns.iter().enumerate() {
                unknowns[k..].iter().filter(|row| wanted(**row, column)).for_each(|&row| take(row, column));
            }
        }
    });
    let mut add = |nodes: &[usize], stiffness: &[Vec<f64>]| {
        watch(nodes, stiffness);
        let (unknowns, stiffness) = dofs.reduced(nodes, stiffness);
        for (&row, values) in unknowns.iter().zip(&stiffness) {
            for (&column, &value) in unknowns.iter().zip(values).take_while(|(column, _)| **column <= row) {
                if value != 0.0 && wanted(row, column) {
                    k.raise(row, column, value);
                }
            }
        }
    };
    let law = |e: usize| {
        let whole = material(e);
        if volumes.of_cell(e).is_empty() { whole } else { whole.deviatoric() }
    };
    // Rigid parts have no strain.
    each_stiffness(mesh, element, law, cells, &mut |nodes, k| {
        if !dofs.are_rigid(nodes) {
            add(nodes, &k);
        }
    })?;
    for volume in volumes.volumes.iter().filter(|volume| !dofs.are_rigid(&volume.nodes)) {
        add(&volume.nodes, &volume.stiffness(mesh.components()));
    }
    for spring in springs {
        add(spring.nodes(), spring.stiffness());
    }
    Ok(k)
}

/// Calls a function with the nodes and the stiffness of each of `cells` in order.
fn each_stiffness(
    mesh: &Mesh,
    element: Element,
    law: impl Fn(usize) -> Elasticity + Sync,
    cells: &[usize],
    take: &mut impl FnMut(&[usize], Vec<Vec<f64>>),
) -> Result<(), InvertedElement> {
    let of_cell = |&e: &usize| {
        let (law, cell) = (law(e), &mesh.cells[e]);
        let stiffness = element_stiffness(cell.kind, mesh.geometry, &mesh.points(&cell.nodes), element, &law);
        stiffness.ok_or_else(|| InvertedElement::of(mesh, e))
    };
    for cells in cells.chunks(TOGETHER) {
        let together: Vec<_> = cells.par_iter().map(of_cell).collect();
        for (e, stiffness) in cells.iter().zip(together) {
            take(&mesh.cells[*e].nodes, stiffness?);
        }
    }
    Ok(())
}

/// Returns the cells with a `wanted` node, ascending.
fn cells_at(mesh: &Mesh, wanted: impl Fn(usize) -> bool) -> Vec<usize> {
    let has = |e: &usize| mesh.cells[*e].nodes.iter().any(|node| wanted(*node));
    (0..mesh.cells.len()).filter(has).collect()
}

/// Computes the nodal forces (length n_u; N, in two dimensions per unit depth, for a body of revolution over the full
/// circumference) of a uniform `traction` (N/m²) on `boundary`: `∫ N_a t dA`.
pub fn facet_load(mesh: &Mesh, dofs: &Dofs, boundary: &Boundary, traction: [f64; 3]) -> Vec<f64> {
    dofs.forces(uniform_traction(mesh, boundary, traction))
}

/// The rows of the stiffness of a body, including springs, at held nodes and at nodes whose displacements are relative
/// to held nodes. Rows and columns are for the components x, y and z of all nodes; the rows of other nodes are empty.
#[derive(Debug, Clone)]
pub(crate) struct HeldRows(Csr);

impl HeldRows {
    /// Assembles `K` like [`super::assemble`], with `springs`, and the rows at the held nodes of `dofs`; `volumes` are
    /// those of the mesh.
    ///
    /// # Errors
    /// [`InvertedElement`] for the first inverted or degenerate element.
    pub fn beside(
        mesh: &Mesh,
        dofs: &Dofs,
        element: Element,
        volumes: &NodalVolumes,
        material: impl Fn(usize) -> Elasticity + Sync,
        springs: &[Spring],
    ) -> Result<(Symmetric, Self), InvertedElement> {
        let mut gathered = Gathered::new(dofs);
        let watch = |nodes: &[usize], stiffness: &[Vec<f64>]| gathered.add(nodes, stiffness);
        let stiffness = assemble_watched(mesh, dofs, element, (volumes, springs), material, watch)?;
        Ok((stiffness, gathered.rows()))
    }

    /// Assembles only the rows, for a body without springs and nodal volumes whose `K` other processes assemble.
    ///
    /// # Errors
    /// [`InvertedElement`] for the first inverted or degenerate element at these nodes.
    pub fn rows_only(
        mesh: &Mesh,
        dofs: &Dofs,
        element: Element,
        material: impl Fn(usize) -> Elasticity + Sync,
    ) -> Result<Self, InvertedElement> {
        let mut gathered = Gathered::new(dofs);
        let cells = cells_at(mesh, |node| gathered.rows.contains_key(&node));
        let mut add = |nodes: &[usize], stiffness: Vec<Vec<f64>>| gathered.add(nodes, &stiffness);
        each_stiffness(mesh, element, material, &cells, &mut add)?;
        Ok(gathered.rows())
    }

    /// Computes `K u` at these nodes, and 0 at others, N, for the displacements `u` (m) of all nodes plus `u_rest`,
    /// their low-order part.
    pub fn forces(&self, u: &[[f64; 3]], u_rest: &[[f64; 3]]) -> Vec<[f64; 3]> {
        let (u_of, u_rest) = (u.as_flattened(), u_rest.as_flattened());
        (0..u.len()).map(|node| [0, 1, 2].map(|c| self.0.difference(3 * node + c, u_of, u_rest, 0.0))).collect()
    }

    /// Computes `K u` at all nodes (N) if only these nodes are displaced, by `displacements` (m, all nodes).
    pub fn response(&self, displacements: &[[f64; 3]]) -> NodalForces {
        let mut forces = vec![0.0; self.0.columns()];
        self.0.add_transposed(displacements.as_flattened(), &mut forces);
        forces.as_chunks().0.iter().copied().enumerate().filter(|(_, force)| *force != [0.0; 3]).collect()
    }
}

/// Accumulates the rows cell by cell.
struct Gathered {
    /// The number of all nodes.
    all: usize,
    rows: BTreeMap<usize, [Vec<(usize, f64)>; 3]>,
}

impl Gathered {
    fn new(dofs: &Dofs) -> Self {
        let held = (0..dofs.nodes()).filter(|node| dofs.is_held(*node));
        let rows = held.chain(dofs.followers()).map(|node| (node, Default::default())).collect();
        Gathered { all: dofs.nodes(), rows }
    }

    /// Adds the stiffness of a cell or spring with these nodes.
    fn add(&mut self, nodes: &[usize], stiffness: &[Vec<f64>]) {
        let d = stiffness.len() / nodes.len();
        for (a, node) in nodes.iter().enumerate() {
            let Some(of_node) = self.rows.get_mut(node) else { continue };
            for (row, values) in of_node.iter_mut().zip(&stiffness[d * a..d * (a + 1)]) {
                row.extend(values.iter().enumerate().map(|(j, value)| (3 * nodes[j / d] + j % d, *value)));
            }
        }
    }

    fn rows(mut self) -> HeldRows {
        let of_node = |node: usize| self.rows.remove(&node).unwrap_or_default();
        HeldRows(Csr::of_rows(3 * self.all, (0..self.all).flat_map(of_node)))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::body::mesh::block;

    #[test]
    fn parts_are_rows_of_the_whole() {
        let mesh = block(&[1.0, 1.0, 2.0], &[3, 2, 4]);
        let dofs = Dofs::new(&mesh, |node, c| node < 5 && c == 1);
        let material = |e: usize| Elasticity::isotropic(1.0 + e as f64, 0.3);
        let whole = assemble(&mesh, &dofs, Element::Bilinear, material).unwrap();
        let here: Vec<bool> = (0..mesh.nodes.len()).map(|node| node % 7 < 2).collect();
        let part = assemble_part(&mesh, &dofs, Element::Bilinear, material, &here).unwrap();
        let is_here = |dof: usize| here[dofs.node_of(dof).unwrap()];
        let mut count = 0;
        for (row, column, value) in whole.lower_entries() {
            let wanted = is_here(row) || is_here(column);
            assert_eq!(part.get(row, column), if wanted { value } else { 0.0 });
            assert_eq!(part.stores(row, column), wanted);
            count += usize::from(wanted);
        }
        assert!(count > 0 && count == part.lower().values().len());
    }
}
