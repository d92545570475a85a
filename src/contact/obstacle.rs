//! Rigid obstacles: their gaps to the nodes of a boundary, along one normal.

use crate::mesh::{Boundary, Mesh};
use crate::scene::Shape;

/// A rigid obstacle in front of a part of the boundary. Small displacements: gaps are measured once,
/// in the undeformed state, along one normal.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Obstacle {
    /// The shape.
    pub shape: Shape,
    /// Unit vector out of the body, towards the obstacle.
    pub normal: [f64; 2],
    /// Unit vector along the obstacle: the positive direction of `w_t`.
    pub tangent: [f64; 2],
}

impl Obstacle {
    /// An obstacle in front of `boundary`. Without a `normal` it faces the mean outward normal of
    /// the boundary; without a `tangent`, that is the normal turned by +90°, which is +x above a
    /// foundation. `None` if the boundary is closed, so that it has no mean normal.
    pub fn facing(
        mesh: &Mesh,
        boundary: &Boundary,
        shape: Shape,
        normal: Option<[f64; 2]>,
        tangent: Option<[f64; 2]>,
    ) -> Option<Self> {
        let normal = match normal {
            Some(normal) => normal,
            None => mean_normal(mesh, boundary)?,
        };
        let tangent = tangent.unwrap_or([-normal[1], normal[0]]);
        Some(Obstacle { shape, normal, tangent })
    }

    /// Whether the normal points out of the body on the whole of `boundary`.
    pub fn faces(&self, mesh: &Mesh, boundary: &Boundary) -> bool {
        boundary.edges.iter().all(|&edge| {
            let [dx, dy] = mesh.edge_vector(edge);
            dy * self.normal[0] - dx * self.normal[1] > 0.0
        })
    }

    /// The gaps (m) of `nodes` along the normal; NaN for a node that a cylinder is too narrow to
    /// stand over.
    pub fn gaps(&self, mesh: &Mesh, nodes: &[usize]) -> Vec<f64> {
        let along = |[x, y]: [f64; 2]| self.normal[0] * x + self.normal[1] * y;
        match self.shape {
            Shape::Plane { gap } => {
                let outermost = nodes.iter().map(|&node| along(mesh.nodes[node])).fold(f64::NEG_INFINITY, f64::max);
                nodes.iter().map(|&node| gap + (outermost - along(mesh.nodes[node]))).collect()
            }
            Shape::Cylinder { radius, apex } => {
                let gap = |[x, y]: [f64; 2]| {
                    let from = [x - apex[0], y - apex[1]];
                    let aside = from[0] * self.tangent[0] + from[1] * self.tangent[1];
                    // R - √(R² - s²), without the loss of digits where s is small.
                    aside * aside / (radius + (radius * radius - aside * aside).sqrt()) - along(from)
                };
                nodes.iter().map(|&node| gap(mesh.nodes[node])).collect()
            }
        }
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
        let plane = Obstacle::facing(&mesh, &bottom, Shape::Plane { gap: 1e-5 }, None, None).unwrap();
        assert_eq!((plane.normal, plane.tangent), ([0.0, -1.0], [1.0, 0.0]));
        assert_eq!(plane.gaps(&mesh, &bottom.nodes()), [1e-5; 3]);
        // A hollow in the bottom is further away by its depth.
        mesh.nodes[1][1] = 0.25;
        assert_eq!(plane.gaps(&mesh, &bottom.nodes()), [1e-5, 1e-5 + 0.25, 1e-5]);
        let around = Boundary {
            name: "all".into(),
            edges: mesh.boundaries.iter().flat_map(|b| b.edges.iter().copied()).collect(),
        };
        assert_eq!(Obstacle::facing(&mesh, &around, plane.shape, None, None), None);
    }

    #[test]
    fn a_cylinder_over_a_block() {
        let mesh = block([1.0, 1.0], [2, 2]);
        let top = mesh.boundary("top").unwrap();
        let shape = Shape::Cylinder { radius: 1.25, apex: [0.0, 1.0] };
        let cylinder = Obstacle::facing(&mesh, top, shape, None, None).unwrap();
        let gaps = cylinder.gaps(&mesh, &[6, 7, 8]);
        let expected = [0.0, 1.25 - (1.25_f64 * 1.25 - 0.25).sqrt(), 0.5];
        assert!(gaps.iter().zip(expected).all(|(g, e)| (g - e).abs() < 1e-15), "{gaps:?}");
        let narrow = Obstacle { shape: Shape::Cylinder { radius: 0.6, apex: [0.0, 1.0] }, ..cylinder };
        assert!(narrow.gaps(&mesh, &[8])[0].is_nan());
    }
}
