//! The bilinear quadrilateral: patch test, rigid motions, convergence.

use crate::common::prelude::*;

const QUAD: CellKind = CellKind::Quadrilateral;

/// A block whose inner nodes are moved about by up to 0.3 of an element, the same way every time.
fn distorted(n: usize) -> Mesh {
    let mut mesh = block(&[1.0, 1.0], &[n, n]);
    let h = 1.0 / n as f64;
    for (k, x) in mesh.nodes.iter_mut().enumerate() {
        let inner = |c: f64| c > 0.5 * h && c < 1.0 - 0.5 * h;
        if inner(x[0]) && inner(x[1]) {
            let phase = k as f64 * 2.399_963;
            *x = [x[0] + 0.3 * h * phase.cos(), x[1] + 0.3 * h * (1.7 * phase).sin(), 0.0];
        }
    }
    mesh
}

fn solve(mesh: &Mesh, dofs: &Dofs, material: &Elasticity, force: &[f64]) -> Vec<f64> {
    common::solve(&assemble(mesh, dofs, Element::Bilinear, |_| *material).unwrap(), force)
}

/// Uniform stress is reproduced exactly on distorted elements, in plane strain and plane stress.
#[test]
fn patch_test() {
    let (young, poisson) = (210e9, 0.3);
    let mesh = distorted(5);
    // Statically determinate: pinned at the origin, a roller at (1, 0).
    let dofs = Dofs::new(&mesh, |node, c| node == 0 || (node == 5 && c == 1));
    let [sx, sy, txy] = [3e6, -5e6, 2e6];
    for (material, strain) in [
        (Elasticity::plane_stress(young, poisson), [(sx - poisson * sy) / young, (sy - poisson * sx) / young]),
        (
            Elasticity::isotropic(young, poisson),
            [
                (1.0 + poisson) / young * ((1.0 - poisson) * sx - poisson * sy),
                (1.0 + poisson) / young * ((1.0 - poisson) * sy - poisson * sx),
            ],
        ),
    ] {
        let [ex, ey] = strain;
        let shear = txy * 2.0 * (1.0 + poisson) / young;
        let mut force = vec![0.0; dofs.free()];
        for (side, [nx, ny]) in
            [("bottom", [0.0, -1.0]), ("right", [1.0, 0.0]), ("top", [0.0, 1.0]), ("left", [-1.0, 0.0])]
        {
            let traction = [sx * nx + txy * ny, txy * nx + sy * ny, 0.0];
            let load = facet_load(&mesh, &dofs, mesh.boundary(side).unwrap(), traction);
            force.iter_mut().zip(load).for_each(|(sum, f)| *sum += f);
        }
        let u = dofs.displacements(&solve(&mesh, &dofs, &material, &force));
        // With u_y = 0 on both bottom corners, the shear stands in u_x alone.
        for (x, u) in mesh.nodes.iter().zip(u) {
            let exact = [ex * x[0] + shear * x[1], ey * x[1]];
            for c in 0..2 {
                assert!((u[c] - exact[c]).abs() < 1e-13 * shear.abs().max(ex.abs()).max(1e-3), "{u:?} {exact:?}");
            }
        }
    }
}

/// Rigid motions, and only they, cost no energy.
#[test]
fn rigid_motions_are_the_null_space() {
    let mesh = distorted(4);
    let dofs = Dofs::new(&mesh, |_, _| false);
    let k = assemble(&mesh, &dofs, Element::Bilinear, |_| Elasticity::isotropic(1.0, 0.3)).unwrap();
    let energy = |field: &dyn Fn([f64; 3]) -> [f64; 3]| {
        let u: Vec<f64> = mesh.nodes.iter().flat_map(|&x| field(x).into_iter().take(2)).collect();
        let ku = k.times(&u).unwrap();
        u.iter().zip(&ku).map(|(a, b)| a * b).sum::<f64>()
    };
    let motions = stickslip::body::constraints::rigid_motions(&mesh, &dofs);
    assert_eq!(motions.len(), 3);
    for motion in &motions {
        assert!(energy(&|x| motion.bodies[0].at(x)).abs() < 1e-14);
    }
    assert!(energy(&|x| [x[0], 0.0, 0.0]) > 0.1);
    assert!(energy(&|x| [x[1], x[0], 0.0]) > 0.1);
    // An hourglass pattern is no mechanism with 2 × 2 points.
    assert!(energy(&|x| [(4.0 * PI * x[0]).cos() * (4.0 * PI * x[1]).cos(), 0.0, 0.0]) > 0.1);
}

/// With the body force of u = sin(πx) sin(πy) (1, 2), the L2 error falls by four when h is halved.
#[test]
fn manufactured_solution_converges_at_second_order() {
    let material = Elasticity::isotropic(1.0, 0.3);
    let (c12, g) = (material.lambda, material.mu);
    let c11 = c12 + 2.0 * g;
    let field = |x: f64, y: f64| {
        let s = (PI * x).sin() * (PI * y).sin();
        [s, 2.0 * s]
    };
    let body_force = |x: f64, y: f64| {
        let ss = PI * PI * (PI * x).sin() * (PI * y).sin();
        let cc = PI * PI * (PI * x).cos() * (PI * y).cos();
        // -div σ with u_y = 2 u_x.
        [(c11 + g) * ss - 2.0 * (c12 + g) * cc, 2.0 * (c11 + g) * ss - (c12 + g) * cc]
    };
    let error = |n: usize| {
        // A smooth map of the block keeps the element shapes the same as h falls.
        let mut mesh = block(&[1.0, 1.0], &[n, n]);
        for [x, y, _] in &mut mesh.nodes {
            let bump = 0.08 * (2.0 * PI * *x).sin() * (2.0 * PI * *y).sin();
            [*x, *y] = [*x + bump, *y - bump];
        }
        let boundary = |x: [f64; 3]| x[..2].iter().any(|&c| c.abs() < 1e-12 || (c - 1.0).abs() < 1e-12);
        let dofs = Dofs::new(&mesh, |node, _| boundary(mesh.nodes[node]));
        let point =
            |corners: &[[f64; 3]], n: &[f64]| [0, 1].map(|c| corners.iter().zip(n).map(|(x, n)| n * x[c]).sum::<f64>());
        let mut force = vec![0.0; dofs.free()];
        for cell in &mesh.cells {
            let corners = mesh.points(&cell.nodes);
            for (p, _) in quadrature(cell.kind) {
                let (_, det) = gradients(cell.kind, p, &corners).unwrap();
                let [x, y] = point(&corners, &shape(QUAD, p));
                let b = body_force(x, y);
                for (&node, n) in cell.nodes.iter().zip(shape(QUAD, p)) {
                    for (dof, b) in dofs.node(node).iter().zip(b) {
                        if let Some(dof) = *dof {
                            force[dof] += n * det * b;
                        }
                    }
                }
            }
        }
        let u = dofs.displacements(&solve(&mesh, &dofs, &material, &force));
        let mut sum = 0.0;
        for cell in &mesh.cells {
            let corners = mesh.points(&cell.nodes);
            for (p, _) in quadrature(cell.kind) {
                let (_, det) = gradients(cell.kind, p, &corners).unwrap();
                let [x, y] = point(&corners, &shape(QUAD, p));
                let exact = field(x, y);
                for c in 0..2 {
                    let computed: f64 = cell.nodes.iter().zip(shape(QUAD, p)).map(|(&node, n)| n * u[node][c]).sum();
                    sum += det * (computed - exact[c]).powi(2);
                }
            }
        }
        sum.sqrt()
    };
    let errors = [16, 32, 64, 128].map(error);
    for pair in errors.windows(2) {
        let order = (pair[0] / pair[1]).log2();
        assert!((1.9..2.1).contains(&order), "order {order} from {errors:?}");
    }
}
