//! Meshes of rings.

use std::f64::consts::FRAC_PI_2;

use stickslip::body::mesh::{Boundary, Cell, CellKind, Mesh};

/// A quarter of a ring between the radii `a` and `b`, with `n` elements along each.
pub fn ring(a: f64, b: f64, n: usize) -> Mesh {
    let node = |i: usize, j: usize| j * (n + 1) + i;
    let place = |i: usize, j: usize| {
        let (r, angle) = (a + (b - a) * i as f64 / n as f64, FRAC_PI_2 * j as f64 / n as f64);
        [if j == n { 0.0 } else { r * angle.cos() }, r * angle.sin(), 0.0]
    };
    let nodes = (0..=n).flat_map(|j| (0..=n).map(move |i| place(i, j))).collect();
    let quad = |i: usize, j: usize| Cell {
        kind: CellKind::Quadrilateral,
        nodes: vec![node(i, j), node(i + 1, j), node(i + 1, j + 1), node(i, j + 1)],
        group: 0,
    };
    let cells = (0..n).flat_map(|j| (0..n).map(move |i| quad(i, j))).collect();
    let side = |name: &str, facets: Vec<Vec<usize>>| Boundary { name: name.to_string(), facets };
    let boundaries = vec![
        side("x axis", (0..n).map(|i| vec![node(i, 0), node(i + 1, 0)]).collect()),
        side("outer", (0..n).map(|j| vec![node(n, j), node(n, j + 1)]).collect()),
        side("y axis", (0..n).rev().map(|i| vec![node(i + 1, n), node(i, n)]).collect()),
        side("inner", (0..n).rev().map(|j| vec![node(0, j + 1), node(0, j)]).collect()),
    ];
    Mesh::new(nodes, cells, vec!["ring".to_string()], boundaries).unwrap()
}
