//! Rigid obstacles: their gaps to the nodes of a boundary, along one normal.

use crate::mesh::{Boundary, Mesh};
use crate::scene::Shape;
use crate::vector::{cross, dot, minus, norm, unit};

/// A rigid obstacle in front of a part of the boundary. Small displacements: gaps are measured once,
/// in the undeformed state, along one normal.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Obstacle {
    /// The shape.
    pub shape: Shape,
    /// Unit vector out of the body, towards the obstacle.
    pub normal: [f64; 3],
    /// Orthonormal vectors along the obstacle: the positive directions of `w_t` and `w_o`. In two dimensions
    /// the second is across the plane.
    pub tangents: [[f64; 3]; 2],
}

impl Obstacle {
    /// An obstacle in front of `boundary`. Without a `normal` it faces the mean outward normal of
    /// the boundary. Without a first `tangent`, that is in two dimensions the normal turned by +90°, which
    /// is +x above a foundation; in three it is the projection of x on the tangent plane, or of the axis
    /// that is closest to that plane where this is another. The second tangent is normal × first.
    /// `None` if the boundary is closed, so that it has no mean normal.
    pub fn facing(
        mesh: &Mesh,
        boundary: &Boundary,
        shape: Shape,
        normal: Option<[f64; 3]>,
        tangent: Option<[f64; 3]>,
    ) -> Option<Self> {
        let normal = match normal {
            Some(normal) => normal,
            None => mean_normal(mesh, boundary)?,
        };
        let first = tangent.unwrap_or_else(|| match mesh.dimension {
            2 => [-normal[1], normal[0], 0.0],
            _ => first_tangent(normal),
        });
        Some(Obstacle { shape, normal, tangents: [first, cross(normal, first)] })
    }

    /// Whether the normal points out of the body on the whole of `boundary`.
    pub fn faces(&self, mesh: &Mesh, boundary: &Boundary) -> bool {
        boundary.facets.iter().all(|facet| dot(mesh.area_vector(facet), self.normal) > 0.0)
    }

    /// The gaps (m) of `nodes` along the normal; NaN for a node that a cylinder is too narrow to
    /// stand over.
    pub fn gaps(&self, mesh: &Mesh, nodes: &[usize]) -> Vec<f64> {
        let along = |x: [f64; 3]| dot(self.normal, x);
        match self.shape {
            Shape::Plane { gap } => {
                let outermost = nodes.iter().map(|&node| along(mesh.nodes[node])).fold(f64::NEG_INFINITY, f64::max);
                nodes.iter().map(|&node| gap + (outermost - along(mesh.nodes[node]))).collect()
            }
            Shape::Cylinder { radius, apex: [x, y] } => {
                let gap = |node: [f64; 3]| {
                    let from = minus(node, [x, y, 0.0]);
                    let aside = dot(from, self.tangents[0]);
                    // R - √(R² - s²), without the loss of digits where s is small.
                    aside * aside / (radius + (radius * radius - aside * aside).sqrt()) - along(from)
                };
                nodes.iter().map(|&node| gap(mesh.nodes[node])).collect()
            }
        }
    }
}

fn mean_normal(mesh: &Mesh, boundary: &Boundary) -> Option<[f64; 3]> {
    let (mut sum, mut total) = ([0.0; 3], 0.0);
    for facet in &boundary.facets {
        let area = mesh.area_vector(facet);
        sum.iter_mut().zip(area).for_each(|(sum, c)| *sum += c);
        total += norm(area);
    }
    // + 0.0 turns -0 into 0.
    (norm(sum) > 1e-9 * total).then(|| unit(sum).map(|c| c + 0.0))
}

/// The projection on the plane at right angles to `normal` of the axis that is closest to it, x before y
/// before z.
fn first_tangent(normal: [f64; 3]) -> [f64; 3] {
    let closest = [1, 2].into_iter().fold(0, |best, c| if normal[c].abs() < normal[best].abs() { c } else { best });
    unit([0, 1, 2].map(|c| if c == closest { 1.0 } else { 0.0 } - normal[closest] * normal[c]))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::mesh::block;

    #[test]
    fn a_foundation_under_a_block() {
        let mut mesh = block(&[1.0, 1.0], &[2, 2]);
        let bottom = mesh.boundary("bottom").unwrap().clone();
        let plane = Obstacle::facing(&mesh, &bottom, Shape::Plane { gap: 1e-5 }, None, None).unwrap();
        assert_eq!((plane.normal, plane.tangents[0]), ([0.0, -1.0, 0.0], [1.0, 0.0, 0.0]));
        assert_eq!(plane.gaps(&mesh, &bottom.nodes()), [1e-5; 3]);
        // A hollow in the bottom is further away by its depth.
        mesh.nodes[1][1] = 0.25;
        assert_eq!(plane.gaps(&mesh, &bottom.nodes()), [1e-5, 1e-5 + 0.25, 1e-5]);
        let around = Boundary {
            name: "all".into(),
            facets: mesh.boundaries.iter().flat_map(|b| b.facets.iter().cloned()).collect(),
        };
        assert_eq!(Obstacle::facing(&mesh, &around, plane.shape, None, None), None);
    }

    #[test]
    fn a_cylinder_over_a_block() {
        let mesh = block(&[1.0, 1.0], &[2, 2]);
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
