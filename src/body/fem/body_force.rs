//! Loads on the volume of a body: forces proportional to mass, and thermal strain.

use super::element::{CellPoint, Element, gradients, strain_columns};
use super::facet::NodalForces;
use super::material::Elasticity;
use crate::body::mesh::{Mesh, fine_quadrature, shape};

/// Computes the forces `∫ N_a b dV` (N; in two dimensions per unit depth, for a body of revolution over the full
/// circumference) of the body force `force` (N/m³), a function of cell and position (m).
///
/// The result is exact for a force that is linear in the position on simplices of first order, and quadratic on
/// undistorted quadrilaterals and hexahedra and on straight simplices of second order; in a body of revolution the
/// degree is one less.
pub fn body_force(mesh: &Mesh, force: impl Fn(usize, [f64; 3]) -> [f64; 3]) -> NodalForces {
    let mut forces = Vec::new();
    for (e, cell) in mesh.cells.iter().enumerate() {
        let nodes = mesh.points(&cell.nodes);
        for (point, weight) in fine_quadrature(cell.kind) {
            // Assembly has already failed for invalid cells.
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

/// Computes the forces `∫ Bᵀ D ε dV` (N; in two dimensions per unit depth, for a body of revolution over the full
/// circumference) of the stress-free `strain` with all nodes held.
///
/// `strain` is a function of cell and position, without shear and equal along all axes, like thermal strain. In plane
/// stress (`thin`) the expansion normal to the plane is free.
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
            let columns = strain_columns(3, point, mean.as_deref());
            for (sum, column) in of_cell.as_flattened_mut().iter_mut().zip(&columns) {
                *sum += point.volume * stress.iter().zip(column).map(|(s, e)| s * e).sum::<f64>();
            }
        }
        forces.extend(cell.nodes.iter().copied().zip(of_cell));
    }
    forces
}

/// Returns the stress `(σ_xx, σ_yy, σ_zz, τ_xy, τ_yz, τ_zx)` (Pa) that belongs to the stress-free `strain`; the stress
/// of the body is that of its displacements minus this.
pub(crate) fn thermal_stress(material: &Elasticity, thin: bool, strain: f64) -> [f64; 6] {
    material.stress(free_stretch(thin, strain))
}

/// Returns the stress-free strain `(ε_xx, ε_yy, ε_zz, γ_xy, γ_yz, γ_zx)` of a material that expands by `strain` along
/// all axes; for a thin plate without the component normal to it.
pub(crate) fn free_stretch(thin: bool, strain: f64) -> [f64; 6] {
    [strain, strain, if thin { 0.0 } else { strain }, 0.0, 0.0, 0.0]
}

/// Returns the position at which the nodes have these shape functions.
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
