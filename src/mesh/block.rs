//! Structured meshes of a rectangle.

use super::{Boundary, Mesh};

/// A rectangle `size` (m) with its lower left corner in the origin, divided into `elements` equal
/// quadrilaterals along x and y; boundaries `bottom`, `right`, `top` and `left`.
pub fn block(size: [f64; 2], elements: [usize; 2]) -> Mesh {
    graded_block(size, elements, [1.0; 2])
}

/// As [`block`], with elements in geometric progression along x and y: the last is `grading` times the
/// size of the first.
pub fn graded_block(size: [f64; 2], elements: [usize; 2], grading: [f64; 2]) -> Mesh {
    let along = |c: usize| progression(size[c], elements[c], grading[c]);
    rectangle(&along(0), &along(1))
}

/// The ends of `n` lengths that fill `length` in geometric progression, the last `ratio` times the
/// first: `x_i = length (q^i - 1) / (q^n - 1)` with `q = ratio^(1 / (n - 1))`.
fn progression(length: f64, n: usize, ratio: f64) -> Vec<f64> {
    // Both fractions are exact at both ends, so the sides are exactly straight.
    if ratio == 1.0 || n == 1 {
        return (0..=n).map(|i| length * i as f64 / n as f64).collect();
    }
    let log = ratio.ln() / (n - 1) as f64;
    // exp_m1 keeps the digits of q^i - 1 for q close to 1.
    (0..=n).map(|i| length * ((log * i as f64).exp_m1() / (log * n as f64).exp_m1())).collect()
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

    #[test]
    fn sizes_are_in_geometric_progression() {
        for ratio in [1e-6, 0.25, 1.0 + 1e-9, 8.0, 1e6] {
            let xs = progression(3.0, 10, ratio);
            let sizes: Vec<f64> = xs.windows(2).map(|x| x[1] - x[0]).collect();
            assert_eq!((xs.len(), xs[0], xs[10]), (11, 0.0, 3.0));
            assert!((sizes[9] / sizes[0] / ratio - 1.0).abs() < 1e-9, "{sizes:?}");
            let q = ratio.powf(1.0 / 9.0);
            assert!(sizes.windows(2).all(|h| (h[1] / h[0] / q - 1.0).abs() < 1e-9), "{sizes:?}");
        }
        assert_eq!(graded_block([2.0, 1.0], [3, 2], [1.0; 2]), block([2.0, 1.0], [3, 2]));
        assert_eq!(progression(3.0, 1, 8.0), [0.0, 3.0]);
    }
}
