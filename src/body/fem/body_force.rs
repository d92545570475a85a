//! Loads on the whole body: forces in proportion to its mass, and thermal strain.

use super::elastic::Elasticity;
use super::facet::NodalForces;
use super::shape::{CellPoint, gradients};
use super::strain::{Element, strain_columns};
use crate::body::mesh::{Mesh, fine_quadrature, shape};

/// The forces `∫ N_a b dV` (N; in two dimensions per unit depth, of a body of revolution all around) of the body force `force` (N/m³) of each cell and
/// position (m).
///
/// Exact for a force that is linear in the position on simplices of the first order, quadratic on undistorted quadrilaterals and
/// hexahedra and on straight simplices of the second order; of one degree less in a body of revolution.
pub fn body_force(mesh: &Mesh, force: impl Fn(usize, [f64; 3]) -> [f64; 3]) -> NodalForces {
    let mut forces = Vec::new();
    for (e, cell) in mesh.cells.iter().enumerate() {
        let nodes = mesh.points(&cell.nodes);
        for (point, weight) in fine_quadrature(cell.kind) {
            // Assembly has refused cells that have none.
            let Some((_, det)) = gradients(cell.kind, point, &nodes) else { continue };
            let shape = shape(cell.kind, point);
            let x = at(&shape, &nodes);
            let (force, depth) = (force(e, x), mesh.geometry.depth(x));
            let share = |n: &f64| force.map(|f| n * weight * det * depth * f);
            forces.extend(cell.nodes.iter().zip(&shape).map(|(&node, n)| (node, share(n))));
        }
    }
    forces
}

/// The forces `∫ Bᵀ D ε dV` (N; in two dimensions per unit depth, of a body of revolution all around) that a stress-free `strain` (without shear, equal along all axes,
/// as heat makes it) of each cell and position exerts while the nodes are held. In plane stress (`thin`) the body expands across
/// its plane as it likes.
pub fn thermal_forces(
    mesh: &Mesh,
    element: Element,
    thin: bool,
    material: impl Fn(usize) -> Elasticity,
    strain: impl Fn(usize, [f64; 3]) -> f64,
) -> NodalForces {
    let mut forces = Vec::new();
    for (e, cell) in mesh.cells.iter().enumerate() {
        let nodes = mesh.points(&cell.nodes);
        let rule = fine_quadrature(cell.kind);
        let Some(points) = CellPoint::all(cell.kind, mesh.geometry, &nodes, &rule) else { continue };
        let mean = element.mean_dilatation(&points);
        let mut of_cell = vec![[0.0; 3]; cell.nodes.len()];
        for ((place, _), point) in rule.iter().zip(&points) {
            let stress = thermal_stress(&material(e), thin, strain(e, at(&shape(cell.kind, *place), &nodes)));
            let columns = strain_columns(mesh.dimension, point, mean.as_deref());
            for (k, column) in columns.iter().enumerate() {
                let work: f64 = stress.iter().zip(column).map(|(s, e)| s * e).sum();
                of_cell[k / mesh.dimension][k % mesh.dimension] += point.volume * work;
            }
        }
        forces.extend(cell.nodes.iter().copied().zip(of_cell));
    }
    forces
}

/// The stress `(σ_xx, σ_yy, σ_zz, τ_xy, τ_yz, τ_zx)` (Pa) that a body under the stress-free `strain` is short of: what its
/// displacements make, less this, is its stress.
pub fn thermal_stress(material: &Elasticity, thin: bool, strain: f64) -> [f64; 6] {
    material.stress(free_stretch(thin, strain))
}

/// The stress-free strain `(ε_xx, ε_yy, ε_zz, γ_xy, γ_yz, γ_zx)` of a material that wants to stretch by `strain` along all axes;
/// of a thin plate what is across it does not count.
pub fn free_stretch(thin: bool, strain: f64) -> [f64; 6] {
    [strain, strain, if thin { 0.0 } else { strain }, 0.0, 0.0, 0.0]
}

/// The position at which the nodes have these shape functions.
fn at(shape: &[f64], nodes: &[[f64; 3]]) -> [f64; 3] {
    [0, 1, 2].map(|c| shape.iter().zip(nodes).map(|(n, x)| n * x[c]).sum())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::body::mesh::block;

    /// Mass, centre of mass, and the centrifugal force of every kind of cell.
    #[test]
    fn masses_are_exact() {
        let plane = block(&[2.0, 1.0], &[2, 2]);
        let space = block(&[2.0, 1.0, 1.0], &[2, 1, 1]);
        for mesh in [plane.clone(), plane.into_simplices(), space.clone(), space.into_simplices()] {
            let sum = |forces: &NodalForces, c: usize| forces.iter().map(|(_, f)| f[c]).sum::<f64>();
            let weight = body_force(&mesh, |_, _| [0.0, -3.0, 0.0]);
            assert!((sum(&weight, 1) + 6.0).abs() < 1e-14);
            let moment: f64 = weight.iter().map(|(node, f)| mesh.nodes[*node][0] * f[1]).sum();
            assert!((moment + 6.0).abs() < 1e-14);
            // ∫ x dV, and its work on the displacement x: ∫ x² dV = 8/3.
            let outwards = body_force(&mesh, |_, [x, ..]| [x, 0.0, 0.0]);
            assert!((sum(&outwards, 0) - 2.0).abs() < 1e-14);
            let work: f64 = outwards.iter().map(|(node, f)| mesh.nodes[*node][0] * f[0]).sum();
            assert!((work - 8.0 / 3.0).abs() < 1e-14, "{work}");
        }
    }
}
