//! The contact nodes of a boundary: gaps, weights, and rows of `C_n` and `C_t` (2).

use std::ops::Range;

use super::obstacle::Obstacle;
use crate::fem::Dofs;
use crate::mesh::{Boundary, Mesh};

/// A node that can touch an obstacle.
#[derive(Debug, Clone, PartialEq)]
pub struct ContactNode {
    /// Its number in the mesh.
    pub node: usize,
    /// Its position, m.
    pub position: [f64; 2],
    /// Its row of `C_n`: `w_n = Σ coefficient · u[dof]`.
    pub normal: Vec<(usize, f64)>,
    /// Its row of `C_t`.
    pub tangent: Vec<(usize, f64)>,
    /// Its gap, m.
    pub gap: f64,
    /// Its share of the contact boundary by the trapezoidal rule, m.
    pub weight: f64,
}

/// The contact nodes of one boundary.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct ContactBoundary {
    /// Its name.
    pub name: String,
    /// Its nodes among all contact nodes.
    pub nodes: Range<usize>,
}

/// The nodes of `boundary` that can move towards the obstacle. A node that supports hold along the
/// normal carries no contact force and is left out.
pub fn contact_nodes(mesh: &Mesh, dofs: &Dofs, boundary: &Boundary, obstacle: &Obstacle) -> Vec<ContactNode> {
    let nodes = boundary.nodes();
    let gaps = obstacle.gaps(mesh, &nodes);
    let mut weights = vec![0.0; mesh.nodes.len()];
    for &edge in &boundary.edges {
        let [dx, dy] = mesh.edge_vector(edge);
        for node in edge {
            weights[node] += 0.5 * dx.hypot(dy);
        }
    }
    let row = |node: usize, direction: [f64; 2]| -> Vec<(usize, f64)> {
        let free = dofs.node(node).into_iter().zip(direction);
        free.filter_map(|(dof, c)| dof.map(|d| (d, c))).filter(|&(_, c)| c != 0.0).collect()
    };
    (nodes.iter().zip(gaps))
        .map(|(&node, gap)| ContactNode {
            node,
            position: mesh.nodes[node],
            normal: row(node, obstacle.normal),
            // With one free component, tangential motion is normal motion: nothing is left to slide.
            tangent: if dofs.node(node).contains(&None) && !row(node, obstacle.normal).is_empty() {
                Vec::new()
            } else {
                row(node, obstacle.tangent)
            },
            gap,
            weight: weights[node],
        })
        .filter(|contact| !contact.normal.is_empty())
        .collect()
}

/// The first node of `boundary` that interferes with the obstacle, once that has moved in by
/// `furthest` (m), while supports hold it there: no displacement can bring it out.
pub fn unreachable(mesh: &Mesh, dofs: &Dofs, boundary: &Boundary, obstacle: &Obstacle, furthest: f64) -> Option<usize> {
    let nodes = boundary.nodes();
    let gaps = obstacle.gaps(mesh, &nodes);
    let held = |node: usize| dofs.node(node).into_iter().zip(obstacle.normal).all(|(dof, n)| dof.is_none() || n == 0.0);
    nodes.into_iter().zip(gaps).find(|&(node, gap)| gap < furthest && held(node)).map(|(node, _)| node)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::mesh::block;
    use crate::scene::Shape;

    #[test]
    fn the_clamped_corner_is_no_contact_node() {
        let mesh = block([1.0, 1.0], [4, 4]);
        let dofs = Dofs::new(&mesh, |node, _| mesh.nodes[node][0] == 0.0);
        let bottom = mesh.boundary("bottom").unwrap();
        let plane = Obstacle::facing(&mesh, bottom, Shape::Plane { gap: 1e-5 }, None, None).unwrap();
        let contacts = contact_nodes(&mesh, &dofs, bottom, &plane);
        assert_eq!(contacts.iter().map(|c| c.position[0]).collect::<Vec<_>>(), [0.25, 0.5, 0.75, 1.0]);
        assert_eq!(contacts.iter().map(|c| c.weight).collect::<Vec<_>>(), [0.25, 0.25, 0.25, 0.125]);
        let [x, y] = dofs.node(1).map(Option::unwrap);
        assert_eq!((contacts[0].normal.clone(), contacts[0].tangent.clone()), (vec![(y, -1.0)], vec![(x, 1.0)]));
        assert_eq!(unreachable(&mesh, &dofs, bottom, &plane, 0.0), None);
        assert_eq!(unreachable(&mesh, &dofs, bottom, &plane, 2e-5), Some(0));
        assert_eq!(
            unreachable(&mesh, &dofs, bottom, &Obstacle { shape: Shape::Plane { gap: -1e-9 }, ..plane }, 0.0),
            Some(0)
        );
    }
}
