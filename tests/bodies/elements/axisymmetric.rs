//! Bodies of revolution: elements, patch tests, rigid motions. Figures without a closed form are those of a program that shares
//! nothing with this one.

use crate::common::prelude::*;
use crate::common::solve;
use stickslip::body::fem::{NodalForces, bernstein, facet_weights, traction, uniform_traction};

const TRIANGLE: [[f64; 3]; 3] = [[1.0, 0.2, 0.0], [3.0, 0.5, 0.0], [1.5, 2.0, 0.0]];
const QUADRILATERAL: [[f64; 3]; 4] = [[1.0, 0.2, 0.0], [3.0, 0.5, 0.0], [2.6, 2.0, 0.0], [1.2, 1.7, 0.0]];

/// The one cell as a mesh, with straight edges.
fn one(kind: CellKind, corners: &[[f64; 3]]) -> Mesh {
    let linear = if corners.len() == 3 { CellKind::Triangle } else { CellKind::Quadrilateral };
    let cell = Cell { kind: linear, nodes: (0..corners.len()).collect(), group: 0 };
    let mesh = Mesh::new(corners.to_vec(), vec![cell], Vec::new(), Vec::new()).unwrap();
    let mesh = if kind.is_quadratic() { mesh.into_second_order() } else { mesh };
    mesh.into_axisymmetric().unwrap()
}

/// The first entry, the trace, the norm, and the energy in a given motion.
#[test]
fn single_elements() {
    let plain = Element::Bilinear;
    let (t, q) = (&TRIANGLE[..], &QUADRILATERAL[..]);
    for (kind, corners, element, expected) in [
        (
            CellKind::Quadrilateral,
            q,
            plain,
            [5.197_421_001_053e0, 6.309_110_235_884e1, 3.151_473_988_437e1, 2.241_193_867_402e1],
        ),
        (
            CellKind::Quadrilateral,
            q,
            Element::BBar,
            [4.398_907_594_269e0, 5.482_369_505_584e1, 2.967_591_877_522e1, 2.159_737_135_708e1],
        ),
        (
            CellKind::Triangle,
            t,
            plain,
            [6.351_487_859_372e0, 3.908_600_825_047e1, 2.362_011_648_045e1, 1.224_194_053_195e1],
        ),
        (
            CellKind::Triangle6,
            t,
            plain,
            [4.612_695_807_137e0, 1.803_722_606_692e2, 8.189_165_307_355e1, 1.100_046_571_076e1],
        ),
    ] {
        let mesh = one(kind, corners);
        let law = Elasticity::isotropic(1.0, 0.3);
        let k = element_stiffness(kind, Geometry::Axisymmetric, &mesh.nodes, element, &law).unwrap();
        let u: Vec<f64> = (mesh.nodes.iter())
            .flat_map(|[x, y, _]| [0.1 * x + 0.2 * y * y + 0.05 * x * y, 0.3 * x - 0.1 * y + 0.07 * x * x])
            .collect();
        let energy: f64 =
            k.iter().zip(&u).map(|(row, u_i)| u_i * row.iter().zip(&u).map(|(k, u)| k * u).sum::<f64>()).sum();
        let trace: f64 = (0..u.len()).map(|i| k[i][i]).sum();
        let norm = k.iter().flatten().map(|x| x * x).sum::<f64>().sqrt();
        for (found, expected) in [k[0][0], trace, norm, energy].into_iter().zip(expected) {
            assert!((found / expected - 1.0).abs() < 2e-12, "{kind:?} {element:?}: {found:.12e} {expected:.12e}");
        }
    }
}

/// All elements there are, on an irregular mesh of the square `[inner, inner + 1] x [0, 1]`; of those of second order one mesh has
/// curved edges inside.
fn meshes(inner: f64) -> Vec<(Mesh, Element)> {
    let irregular = |mesh: Mesh| {
        let mut mesh = mesh;
        let inside = |x: &[f64; 3]| (0..2).all(|c| x[c] > 0.01 && x[c] < 0.99);
        for (k, x) in mesh.nodes.iter_mut().enumerate().filter(|(_, x)| inside(x)) {
            (0..2).for_each(|c| x[c] += 0.05 * (2.4 * k as f64 * (c + 1) as f64).sin());
        }
        mesh
    };
    let plain = || irregular(block(&[1.0, 1.0], &[3, 3]));
    let curved = || {
        let mut mesh = plain().into_simplices().into_second_order();
        for (k, x) in mesh.nodes.iter_mut().enumerate().skip(16) {
            if (0..2).all(|c| x[c] > 0.01 && x[c] < 0.99) {
                (0..2).for_each(|c| x[c] += 0.03 * (1.7 * k as f64 * (c + 1) as f64).cos());
            }
        }
        mesh
    };
    [
        (plain(), Element::Bilinear),
        (plain(), Element::BBar),
        (plain().into_simplices(), Element::Bilinear),
        (plain().into_simplices(), Element::NodalVolume),
        (plain().into_simplices().into_second_order(), Element::Bilinear),
        (curved(), Element::Bilinear),
    ]
    .into_iter()
    .map(|(mut mesh, element)| {
        mesh.nodes.iter_mut().for_each(|x| x[0] += inner);
        (mesh.into_axisymmetric().unwrap(), element)
    })
    .collect()
}

/// Uniform stress along the axis, and the same pressure on all sides: the displacements are linear, and exact.
#[test]
fn patch_tests() {
    for inner in [0.0, 0.7] {
        for (mesh, element) in meshes(inner) {
            for poisson in [0.0, 0.3, 0.4999] {
                let law = Elasticity::isotropic(1.0, poisson);
                let dofs = Dofs::new(&mesh, |node, c| c == 1 && mesh.nodes[node][1] == 0.0);
                let k = assemble(&mesh, &dofs, element, |_| law).unwrap();
                let on = |name: &str, t: [f64; 3]| uniform_traction(&mesh, mesh.boundary(name).unwrap(), t);
                let pressed = |sides: &[&str]| -> NodalForces {
                    let load = |name: &&str| traction(&mesh, mesh.boundary(name).unwrap(), |_, area| area.map(|a| -a));
                    sides.iter().flat_map(load).collect()
                };
                let sides: &[&str] = if inner > 0.0 { &["top", "left", "right"] } else { &["top", "right"] };
                let all_round = -(1.0 - 2.0 * poisson);
                for (load, [along_r, along_y]) in [
                    (on("top", [0.0, -1.0, 0.0]), [poisson, -1.0]),
                    (pressed(&["top"]), [poisson, -1.0]),
                    (pressed(sides), [all_round, all_round]),
                ] {
                    let u = dofs.displacements(&solve(&k, &dofs.forces(load)));
                    let off = mesh.nodes.iter().zip(&u).fold(0.0_f64, |m, (x, u)| {
                        m.max((u[0] - along_r * x[0]).abs()).max((u[1] - along_y * x[1]).abs())
                    });
                    // Rounding grows as the volume resists.
                    assert!(off < 1e-14 * (10.0 + law.lambda), "{element:?} {poisson} {inner}: {off:e}");
                }
            }
        }
    }
}

/// The pivots of a Cholesky factorisation of `K + r rᵀ`, r the translation along the axis, are positive, and `K r` is nothing: that is
/// the one motion without energy, of single elements, too.
#[test]
fn only_the_translation_along_the_axis_is_free_of_energy() {
    let single = [
        (CellKind::Triangle, &TRIANGLE[..]),
        (CellKind::Quadrilateral, &QUADRILATERAL),
        (CellKind::Triangle6, &TRIANGLE),
    ];
    let single = single.into_iter().map(|(kind, corners)| (one(kind, corners), Element::Bilinear));
    for (mesh, element) in meshes(0.0).into_iter().chain(meshes(0.7)).chain(single) {
        let dofs = Dofs::new(&mesh, |_, _| false);
        let k = assemble(&mesh, &dofs, element, |_| Elasticity::isotropic(1.0, 0.3)).unwrap();
        let motions = rigid_motions(&mesh, &dofs);
        assert_eq!(motions.iter().map(ToString::to_string).collect::<Vec<_>>(), ["a translation along (0, 1)"]);
        let r = motions[0].displacements(&mesh, &dofs);
        assert!(k.times(&r).unwrap().iter().all(|f| f.abs() < 1e-13));
        let n = k.order();
        let mut a = vec![vec![0.0; n]; n];
        k.entries().for_each(|(i, j, value)| a[i][j] = value);
        (0..n).for_each(|i| (0..n).for_each(|j| a[i][j] += r[i] * r[j] / n as f64));
        for p in 0..n {
            let pivot = a[p].clone();
            assert!(pivot[p] > 1e-3, "{element:?}: pivot {p} of {n} is {:e}", pivot[p]);
            for row in a.iter_mut().skip(p + 1) {
                let factor = row[p] / pivot[p];
                row.iter_mut().zip(&pivot).skip(p).for_each(|(x, y)| *x -= factor * y);
            }
        }
    }
}

/// The shares of the nodes of an edge in its area all around, for radii 1 and 3 at a distance of 2.5.
#[test]
fn shares_of_the_area_all_round() {
    let near = |found: &[f64], expected: &[f64]| {
        let unit = std::f64::consts::TAU * 2.5;
        assert_eq!(found.len(), expected.len());
        assert!(found.iter().zip(expected).all(|(f, e)| (f - unit * e).abs() < 1e-13), "{found:?}");
    };
    for (r, s) in [([1.0, 3.0], 1.5), ([0.0, 2.0], 1.5)] {
        let corners = [[r[0], 0.0, 0.0], [r[1], s, 0.0], [r[0], 4.0, 0.0]];
        let [a, b] = r;
        let linear = one(CellKind::Triangle, &corners);
        near(&facet_weights(&linear, &[0, 1]), &[(2.0 * a + b) / 6.0, (a + 2.0 * b) / 6.0]);
        let quadratic = one(CellKind::Triangle6, &corners);
        let weights = facet_weights(&quadratic, &[0, 3, 1]);
        near(&weights, &[a / 6.0, (a + b) / 3.0, b / 6.0]);
        let of_law = bernstein(&quadratic, &[0, 3, 1], &weights);
        near(&of_law, &[(3.0 * a + b) / 12.0, (a + b) / 6.0, (a + 3.0 * b) / 12.0]);
    }
}
