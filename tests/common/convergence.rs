//! Contact forces beside those of an exact stress, and the order in which errors fall.

use stickslip::algebra::norm;
use stickslip::body::Model;

/// Points of the midpoint rule along a side of a facet: the edge of the contact runs through it anywhere.
const POINTS: usize = 20;

/// `∫ N exact dA` at each contact node, `exact` by position: the forces that the exact stress puts on the nodes of `boundary`. Facets
/// are straight or rectangles.
fn nodal(model: &Model, boundary: &str, exact: impl Fn([f64; 3]) -> f64) -> Vec<f64> {
    let mesh = &model.mesh;
    let mut at_node = vec![0.0; mesh.nodes.len()];
    for facet in &mesh.boundary(boundary).unwrap().facets {
        let corners = mesh.points(facet);
        let across = if corners.len() == 2 { 1 } else { POINTS };
        let area = norm(mesh.area_vector(facet)) / (POINTS * across) as f64;
        for k in 0..POINTS * across {
            let [s, t] = [k % POINTS, k / POINTS].map(|k| (k as f64 + 0.5) / POINTS as f64);
            let shape = match corners.len() {
                2 => vec![1.0 - s, s],
                _ => vec![(1.0 - s) * (1.0 - t), s * (1.0 - t), s * t, (1.0 - s) * t],
            };
            let x = [0, 1, 2].map(|c| shape.iter().zip(&corners).map(|(n, corner)| n * corner[c]).sum());
            let stress = exact(x) * mesh.geometry.depth(x);
            facet.iter().zip(&shape).for_each(|(&node, n)| at_node[node] += n * stress * area);
        }
    }
    model.contact.nodes.iter().map(|contact| at_node[contact.node]).collect()
}

/// The distance of the contact forces from those of an exact stress on `boundary`, as stresses in the L2 norm:
/// `√(Σ (p - p_exact)² / l / Σ p_exact² / l)` over the contact nodes.
pub fn distance(model: &Model, boundary: &str, forces: &[f64], exact: impl Fn([f64; 3]) -> f64) -> f64 {
    let (mut error, mut size) = (0.0, 0.0);
    for ((contact, found), exact) in model.contact.nodes.iter().zip(forces).zip(nodal(model, boundary, exact)) {
        error += (found - exact).powi(2) / contact.weight;
        size += exact * exact / contact.weight;
    }
    (error / size).sqrt()
}

/// The power of the element size with which `errors` fall from the first to the last of meshes with so many `elements`.
pub fn order(elements: &[usize], errors: &[f64]) -> f64 {
    let fall = |values: &[f64]| (values[0] / values[values.len() - 1]).abs().ln();
    fall(errors) / -fall(&elements.iter().map(|&n| n as f64).collect::<Vec<_>>())
}
