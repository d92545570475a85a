//! Rigid obstacles.

use crate::mesh::{Boundary, Mesh};

/// A rigid plane in front of a part of the boundary.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Plane {
    /// Unit vector out of the body, towards the obstacle.
    pub normal: [f64; 2],
    /// Unit vector along the obstacle: the positive direction of `w_t`.
    pub tangent: [f64; 2],
    /// Distance to the nearest point of the boundary, m; negative for interference.
    pub gap: f64,
}

impl Plane {
    /// A plane in front of `boundary`. Without a `normal` it stands across the mean outward normal
    /// of the boundary; without a `tangent`, that is the normal turned by +90°, which is +x above a
    /// foundation. `None` if the boundary is closed, so that it has no mean normal.
    pub fn facing(
        mesh: &Mesh,
        boundary: &Boundary,
        gap: f64,
        normal: Option<[f64; 2]>,
        tangent: Option<[f64; 2]>,
    ) -> Option<Self> {
        let normal = match normal {
            Some(normal) => normal,
            None => mean_normal(mesh, boundary)?,
        };
        let tangent = tangent.unwrap_or([-normal[1], normal[0]]);
        Some(Plane { normal, tangent, gap })
    }

    /// The gaps (m) of `nodes`: `gap` for the node furthest out along the normal, more for others.
    pub fn gaps(&self, mesh: &Mesh, nodes: &[usize]) -> Vec<f64> {
        let along = |node: usize| {
            let [x, y] = mesh.nodes[node];
            self.normal[0] * x + self.normal[1] * y
        };
        let outermost = nodes.iter().map(|&node| along(node)).fold(f64::NEG_INFINITY, f64::max);
        nodes.iter().map(|&node| self.gap + (outermost - along(node))).collect()
    }
}

fn mean_normal(mesh: &Mesh, boundary: &Boundary) -> Option<[f64; 2]> {
    let (mut sum, mut total) = ([0.0; 2], 0.0);
    for &edge in &boundary.edges {
        let [dx, dy] = mesh.edge_vector(edge);
        sum[0] += dy;
        sum[1] -= dx;
        total += dx.hypot(dy);
    }
    let length = sum[0].hypot(sum[1]);
    // + 0.0 turns -0 into 0.
    (length > 1e-9 * total).then(|| sum.map(|c| c / length + 0.0))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::mesh::block;

    #[test]
    fn a_foundation_under_a_block() {
        let mut mesh = block([1.0, 1.0], [2, 2]);
        let bottom = mesh.boundary("bottom").unwrap().clone();
        let plane = Plane::facing(&mesh, &bottom, 1e-5, None, None).unwrap();
        assert_eq!((plane.normal, plane.tangent), ([0.0, -1.0], [1.0, 0.0]));
        assert_eq!(plane.gaps(&mesh, &bottom.nodes()), [1e-5; 3]);
        // A hollow in the bottom is further away by its depth.
        mesh.nodes[1][1] = 0.25;
        assert_eq!(plane.gaps(&mesh, &bottom.nodes()), [1e-5, 1e-5 + 0.25, 1e-5]);
        let around = Boundary {
            name: "all".into(),
            edges: mesh.boundaries.iter().flat_map(|b| b.edges.iter().copied()).collect(),
        };
        assert_eq!(Plane::facing(&mesh, &around, 0.0, None, None), None);
    }
}
