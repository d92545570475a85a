//! Structured meshes of a rectangle.

use super::{Boundary, Mesh};

/// A rectangle `size` (m) with its lower left corner in the origin, divided into `elements` equal
/// quadrilaterals along x and y; boundaries `bottom`, `right`, `top` and `left`.
pub fn block(size: [f64; 2], elements: [usize; 2]) -> Mesh {
    // i / n is exact at both ends, so the sides are exactly straight.
    let along = |c: usize| (0..=elements[c]).map(|i| size[c] * i as f64 / elements[c] as f64).collect::<Vec<f64>>();
    rectangle(&along(0), &along(1))
}

/// The mesh of the products of the coordinates `xs` and `ys`, both ascending.
pub(super) fn rectangle(xs: &[f64], ys: &[f64]) -> Mesh {
    let (nx, ny) = (xs.len() - 1, ys.len() - 1);
    let node = |i: usize, j: usize| j * (nx + 1) + i;
    let nodes = ys.iter().flat_map(|&y| xs.iter().map(move |&x| [x, y])).collect();
    let quads = (0..ny)
        .flat_map(|j| (0..nx).map(move |i| [node(i, j), node(i + 1, j), node(i + 1, j + 1), node(i, j + 1)]))
        .collect();
    let side = |name: &str, edges: Vec<[usize; 2]>| Boundary { name: name.into(), edges };
    let boundaries = vec![
        side("bottom", (0..nx).map(|i| [node(i, 0), node(i + 1, 0)]).collect()),
        side("right", (0..ny).map(|j| [node(nx, j), node(nx, j + 1)]).collect()),
        side("top", (0..nx).rev().map(|i| [node(i + 1, ny), node(i, ny)]).collect()),
        side("left", (0..ny).rev().map(|j| [node(0, j + 1), node(0, j)]).collect()),
    ];
    Mesh { nodes, quads, boundaries }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn boundaries_run_around_the_body() {
        let mesh = block([2.0, 1.0], [3, 2]);
        assert_eq!((mesh.nodes.len(), mesh.quads.len()), (12, 6));
        assert_eq!(mesh.boundary("bottom").unwrap().nodes(), [0, 1, 2, 3]);
        assert_eq!(mesh.boundary("top").unwrap().nodes(), [11, 10, 9, 8]);
        // Twice the area from the boundary edges (Green) equals that of the rectangle.
        let area: f64 = (mesh.boundaries.iter().flat_map(|b| &b.edges))
            .map(|&[a, b]| mesh.nodes[a][0] * mesh.nodes[b][1] - mesh.nodes[b][0] * mesh.nodes[a][1])
            .sum();
        assert!((area - 4.0).abs() < 1e-14);
    }
}
