//! Dilatations averaged at the corners of triangles, tetrahedra, prisms and cells of second order. Figures without a closed form are those of a program that
//! shares nothing with this one.

use crate::common::prelude::*;
use crate::common::solve;
use stickslip::body::fem::traction;

/// Cells without parallel sides inside; those of second order are straight, and, the second of each, curved.
fn irregular() -> Vec<Mesh> {
    let moved = |mut mesh: Mesh| {
        let (bounds, d) = (mesh.bounds(), mesh.dimension);
        let inner = |x: &[f64; 3]| (0..d).all(|c| x[c] > bounds[c].0 + 0.05 && x[c] < bounds[c].1 - 0.05);
        for (k, x) in mesh.nodes.iter_mut().enumerate().filter(|(_, x)| inner(x)) {
            (0..d).for_each(|c| x[c] += 0.04 * (2.4 * k as f64 * (c + 1) as f64).sin());
        }
        mesh
    };
    let curved = |mut mesh: Mesh, corners: usize| {
        for (k, x) in mesh.nodes.iter_mut().enumerate().skip(corners) {
            (0..mesh.dimension).for_each(|c| x[c] += 0.01 * (1.7 * k as f64 * (c + 1) as f64).sin());
        }
        mesh
    };
    let mut all = vec![moved(block(&[1.0, 0.9, 0.8], &[3, 3, 3]).into_prisms())];
    for mesh in [block(&[1.0, 0.8], &[5, 4]), block(&[1.0, 0.9, 0.8], &[3, 3, 3])] {
        all.push(moved(mesh.into_simplices()));
    }
    for mesh in [block(&[1.0, 0.8], &[3, 3]), block(&[1.0, 0.9, 0.8], &[2, 2, 2])] {
        let corners = mesh.nodes.len();
        for cells in [mesh.clone().into_simplices(), mesh.clone().into_prisms(), mesh] {
            let straight = moved(cells).into_second_order();
            all.extend([straight.clone(), curved(straight, corners)]);
        }
    }
    all
}

/// A linear displacement field leaves the forces of its uniform stress on the surface and no others.
#[test]
fn patch_test() {
    let gradient = [[0.3, -0.2, 0.4], [0.7, 0.4, -0.5], [0.1, 0.6, -0.35]];
    for mesh in irregular() {
        let d = mesh.dimension;
        let dofs = Dofs::new(&mesh, |_, _| false);
        let strain = |a: usize, b: usize| if a.max(b) < d { gradient[a][b] } else { 0.0 };
        let gamma = |a: usize, b: usize| strain(a, b) + strain(b, a);
        for poisson in [-0.5, 0.0, 0.3, 0.4999] {
            let law = Elasticity::isotropic(1.0, poisson);
            let k = assemble(&mesh, &dofs, Element::NodalVolume, |_| law).unwrap();
            let u: Vec<f64> =
                mesh.nodes.iter().flat_map(|&x| gradient[..d].iter().map(move |row| 0.1 + dot(*row, x))).collect();
            let mut force = k.times(&u).unwrap();
            let [xx, yy, zz, xy, yz, zx] =
                law.stress([strain(0, 0), strain(1, 1), strain(2, 2), gamma(0, 1), gamma(1, 2), gamma(2, 0)]);
            let stress = [[xx, xy, zx], [xy, yy, yz], [zx, yz, zz]];
            for boundary in &mesh.boundaries {
                let load = traction(&mesh, boundary, |_, area| stress.map(|row| dot(row, area)));
                force.iter_mut().zip(dofs.forces(load)).for_each(|(sum, f)| *sum -= f);
            }
            let worst = largest(&force);
            let kind = mesh.cells[0].kind;
            assert!(worst < 2e-14 * (law.lambda.abs() + law.mu), "{worst:e} of {kind:?} at nu = {poisson}");
        }
    }
}

/// The pivots of a Cholesky factorisation of `K + Σ r rᵀ`, r orthonormal rigid motions, are positive, and no `K r` is more than
/// rounding: rigid motions and no others are free of energy. Two laws have a border in between.
#[test]
fn only_rigid_motions_are_free_of_energy() {
    for mesh in irregular() {
        let dofs = Dofs::new(&mesh, |_, _| false);
        let laws = [Elasticity::isotropic(1.0, 0.4999), Elasticity::isotropic(3.0, 0.3)];
        let k = assemble(&mesh, &dofs, Element::NodalVolume, |e| laws[usize::from(mesh.centre(e)[0] > 0.5)]).unwrap();
        let mut basis: Vec<Vec<f64>> = Vec::new();
        for motion in rigid_motions(&mesh, &dofs) {
            let mut r = motion.displacements(&mesh, &dofs);
            for other in &basis {
                let along = dot(&r, other);
                r.iter_mut().zip(other).for_each(|(x, y)| *x -= along * y);
            }
            let length = dot(&r, &r).sqrt();
            basis.push(r.into_iter().map(|x| x / length).collect());
        }
        assert_eq!(basis.len(), [3, 6][mesh.dimension - 2]);
        let n = k.order();
        let mut a = vec![vec![0.0; n]; n];
        k.entries().for_each(|(i, j, value)| a[i][j] = value);
        for r in &basis {
            assert!(k.times(r).unwrap().iter().all(|f| f.abs() < 1e-14 * laws[0].lambda));
            (0..n).for_each(|i| (0..n).for_each(|j| a[i][j] += r[i] * r[j]));
        }
        for p in 0..n {
            let pivot = a[p].clone();
            let kind = mesh.cells[0].kind;
            assert!(pivot[p] > 1e-3, "pivot {p} of {n} is {:e} of {kind:?}", pivot[p]);
            for row in a.iter_mut().skip(p + 1) {
                let factor = row[p] / pivot[p];
                row.iter_mut().zip(&pivot).skip(p).for_each(|(x, y)| *x -= factor * y);
            }
        }
    }
}

/// Entry, trace, norm and energy of one straight element.
#[test]
fn stiffness_of_one_element() {
    const TRIANGLE: [[f64; 3]; 3] = [[1.0, 0.2, 0.0], [3.0, 0.5, 0.0], [1.5, 2.0, 0.0]];
    const TETRAHEDRON: [[f64; 3]; 4] = [[0.0; 3], [2.0, 0.1, 0.2], [0.3, 1.5, 0.1], [0.2, 0.4, 1.8]];
    const PRISM: [[f64; 3]; 6] =
        [[0.0; 3], [2.0, 0.1, 0.0], [0.3, 1.5, 0.1], [0.1, 0.2, 1.8], [2.2, 0.3, 1.6], [0.4, 1.7, 2.0]];
    for (kind, corners, expected) in [
        (
            CellKind::Triangle,
            &TRIANGLE[..],
            [3.832_218_506_132e-1, 1.174_631_487_675e1, 5.339_672_832_008, 7.369_077_674_279e-1],
        ),
        (
            CellKind::Tetrahedron,
            &TETRAHEDRON,
            [1.584_447_531_953e-1, 1.202_417_748_112e1, 3.957_350_827_202, 1.944_822_242_821e-1],
        ),
        (CellKind::Prism, &PRISM, [3.842_849_321_796e-1, 6.193_171_299_339, 2.527_470_383_322, 8.798_370_401_751e-1]),
    ] {
        let cell = Cell { kind, nodes: (0..corners.len()).collect(), group: 0 };
        let mesh = Mesh::new(corners.to_vec(), vec![cell], Vec::new(), Vec::new()).unwrap();
        let mesh = if kind.is_simplex() { mesh.into_second_order() } else { mesh };
        let dofs = Dofs::new(&mesh, |_, _| false);
        let k = assemble(&mesh, &dofs, Element::NodalVolume, |_| Elasticity::isotropic(1.0, 0.3)).unwrap();
        let field = |&[x, y, z]: &[f64; 3]| match mesh.dimension {
            2 => vec![0.1 * x + 0.2 * y * y + 0.05 * x * y, 0.3 * x - 0.1 * y + 0.07 * x * x],
            _ => {
                vec![0.1 * x + 0.2 * y * y + 0.05 * x * z, 0.3 * x - 0.1 * y + 0.07 * x * x, 0.2 * z + 0.11 * x * y]
            }
        };
        let u: Vec<f64> = mesh.nodes.iter().flat_map(field).collect();
        let trace: f64 = (0..k.order()).map(|i| k.get(i, i)).sum();
        let frobenius = k.entries().map(|(_, _, x)| x * x).sum::<f64>().sqrt();
        let energy = dot(&u, k.times(&u).unwrap());
        for (found, expected) in [k.get(0, 0), trace, frobenius, energy].into_iter().zip(expected) {
            assert!((found / expected - 1.0).abs() < 1e-12, "{kind:?}: {found:.12e} {expected:.12e}");
        }
    }
}

/// What is made of quadrilaterals, the element, and for so many along each side what is expected.
type Case = (fn(Mesh) -> Mesh, Element, &'static [(usize, f64)]);

/// Cook's membrane with nu = 0.4999, see `locking.rs`: the displacement of the middle of the free side.
#[test]
fn cooks_membrane() {
    use Element::{BBar, Bilinear, NodalVolume};
    let law = Elasticity::isotropic(1.0, 0.4999);
    let as_quadrilaterals = |mesh: Mesh| mesh;
    let as_triangles = Mesh::into_simplices;
    let of_second_order = |mesh: Mesh| mesh.into_simplices().into_second_order();
    let cases: [Case; 4] = [
        (as_triangles, NodalVolume, &[(4, 8.127_717_226_8), (8, 12.876_026_445_9), (16, 16.375_622_029_3)]),
        (as_quadrilaterals, BBar, &[(4, 15.909_295_664_8), (8, 17.649_023_516_0), (16, 18.211_449_007_1)]),
        (of_second_order, Bilinear, &[(2, 11.055_646_402_5), (4, 15.366_450_984_3), (8, 17.373_955_768_6)]),
        (of_second_order, NodalVolume, &[(2, 15.696_540_539_4), (4, 17.606_141_414_0), (8, 18.167_667_944_7)]),
    ];
    for (cells, element, sizes) in cases {
        for &(n, expected) in sizes {
            let mut mesh = cells(block(&[1.0, 1.0], &[n, n]));
            let middle = mesh.nodes.iter().position(|x| x[0] == 1.0 && x[1] == 0.5).unwrap();
            for x in &mut mesh.nodes {
                let (bottom, top) = (44.0 * x[0], 44.0 + 16.0 * x[0]);
                *x = [48.0 * x[0], bottom + (top - bottom) * x[1], 0.0];
            }
            let dofs = Dofs::new(&mesh, |node, _| mesh.nodes[node][0] == 0.0);
            let force = facet_load(&mesh, &dofs, mesh.boundary("right").unwrap(), [0.0, 1.0 / 16.0, 0.0]);
            let k = assemble(&mesh, &dofs, element, |_| law).unwrap();
            let tip = dofs.displacements(&solve(&k, &force))[middle][1];
            let kind = mesh.cells[0].kind;
            assert!((tip / expected - 1.0).abs() < 1e-9, "{kind:?}, {element:?}, {n}: {tip:.10}");
        }
    }
}
