//! Assembly of part of the stiffness matrix, for distribution over several processes.

use super::assembly::each_stiffness;
use super::dofs::Dofs;
use crate::algebra::sparse::Symmetric;
use crate::body::fem::{Elasticity, Element, InvertedElement};
use crate::body::mesh::Mesh;

/// Assembles the entries of `K` whose row or column belongs to a node with `here` equal to `true`. The values equal
/// those of [`super::assemble`] exactly. Relative nodes and averaged dilatations are not supported.
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
    let cells = cells_at(mesh, |node| here[node]);
    let unknowns = |nodes: &[usize]| -> Vec<(Option<usize>, bool)> {
        nodes.iter().flat_map(|&node| dofs.node(node).iter().map(move |dof| (*dof, here[node]))).collect()
    };
    let mut k = Symmetric::of(dofs.free(), |take| {
        for &e in &cells {
            let unknowns = unknowns(&mesh.cells[e].nodes);
            for &(row, row_here) in &unknowns {
                for &(column, column_here) in &unknowns {
                    if let (Some(row), Some(column)) = (row, column)
                        && row >= column
                        && (row_here || column_here)
                    {
                        take(row, column);
                    }
                }
            }
        }
    });
    let mut add = |nodes: &[usize], mut stiffness: Vec<Vec<f64>>| {
        dofs.turn(nodes, &mut stiffness);
        let unknowns = unknowns(nodes);
        for (&(row, row_here), values) in unknowns.iter().zip(&stiffness) {
            for (&(column, column_here), value) in unknowns.iter().zip(values) {
                if let (Some(row), Some(column)) = (row, column)
                    && row >= column
                    && (row_here || column_here)
                {
                    k.raise(row, column, *value);
                }
            }
        }
    };
    each_stiffness(mesh, element, material, cells.len(), |k| cells[k], &mut add)?;
    Ok(k)
}

/// Returns the cells with a `wanted` node, ascending.
pub(super) fn cells_at(mesh: &Mesh, wanted: impl Fn(usize) -> bool) -> Vec<usize> {
    let has = |e: &usize| mesh.cells[*e].nodes.iter().any(|node| wanted(*node));
    (0..mesh.cells.len()).filter(has).collect()
}

#[cfg(test)]
mod tests {
    use super::super::assemble;
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
