//! A ring shrunk on another (Lamé).

use crate::common::prelude::*;

const RADII: [f64; 3] = [0.05, 0.1, 0.2];
const YOUNG: [f64; 2] = [70e9, 210e9];
const NU: f64 = 0.3;
const INTERFERENCE: f64 = 1e-5;

/// How a ring is meshed: a quarter of it, or its section.
#[derive(Debug, Clone, Copy, PartialEq)]
enum Ring {
    Quarter,
    Section,
}

/// `n` elements across the wall and twice as many around, or along.
fn ring(ring: Ring, kind: CellKind, radii: [f64; 2], n: usize) -> Mesh {
    let across = n;
    let along = 2 * n;
    let mut mesh = block(&[1.0, 1.0], &[across, along]);
    if kind.is_simplex() {
        mesh = mesh.into_simplices();
    }
    if kind.is_quadratic() {
        mesh = mesh.into_second_order();
    }
    moved(mesh, |[s, t, _]| {
        let r = radii[0] + s * (radii[1] - radii[0]);
        match ring {
            Ring::Section => [r, 0.1 * t, 0.0],
            Ring::Quarter => {
                let angle = FRAC_PI_2 * t;
                [if t == 1.0 { 0.0 } else { r * angle.cos() }, r * angle.sin(), 0.0]
            }
        }
    })
}

/// Lamé: plane stress, as of rings that are free to become longer.
fn exact() -> f64 {
    let [a, c, b] = RADII.map(|r| r * r);
    let outer = ((b + c) / (b - c) + NU) / YOUNG[1];
    let inner = ((c + a) / (c - a) - NU) / YOUNG[0];
    INTERFERENCE / (RADII[1] * (outer + inner))
}

/// The errors of the mean pressure and of the displacement of the bore, and how far pressures are from the mean.
fn errors(shape: Ring, kind: CellKind, n: usize, inner_is_slave: bool) -> [f64; 3] {
    let plane = if shape == Ring::Section { Plane::Axisymmetric } else { Plane::Stress };
    let mut material = Material::new(YOUNG[0], NU).in_plane(plane);
    let group = |name: &str, young| MaterialGroup { name: name.into(), young, poisson: NU, ..MaterialGroup::default() };
    material.groups = vec![group("inner", YOUNG[0]), group("outer", YOUNG[1])];
    let mesh = MeshSource::Bodies(vec![
        Body::new("inner", ring(shape, kind, [RADII[0], RADII[1]], n)),
        Body::new("outer", ring(shape, kind, [RADII[1], RADII[2]], 3 * n / 2)),
    ]);
    let [slave, master] = if inner_is_slave { ["inner:right", "outer:left"] } else { ["outer:left", "inner:right"] };
    let tight = Opposite::from(master).within(0.02).apart(-INTERFERENCE);
    let body = Description::new(mesh, material, vec![1.0]).pair(slave, 0.0, tight);
    let body = ["inner", "outer"].iter().fold(body, |body, name| {
        let body = body.support(&format!("{name}:bottom"), &[Axis::Y]);
        if shape == Ring::Quarter { body.support(&format!("{name}:top"), &[Axis::X]) } else { body }
    });
    let model = Model::build(&body).unwrap();
    let solver = SolverChoice { linear: Some(LinearAlgebra::default()), tolerance: 1e-11, ..bn() };
    let state = solved(&model, solver, &mut ()).state;
    let weights: f64 = model.contact.nodes.iter().map(|contact| contact.weight).sum();
    let mean = state.p_n.iter().sum::<f64>() / weights;
    let off = model.contact.nodes.iter().zip(&state.p_n).map(|(contact, p)| (p / contact.weight / mean - 1.0).abs());
    let p = exact();
    let [a, c] = [RADII[0], RADII[1]];
    let bore = -2.0 * p * c * c * a / (YOUNG[0] * (c * c - a * a));
    let u = model.displacements(1.0, &state.u).unwrap();
    let nodes = model.mesh.boundary("inner:left").unwrap().nodes();
    let radial = |&i: &usize| {
        let x = model.mesh.nodes[i];
        if shape == Ring::Section { u[i][0] } else { (u[i][0] * x[0] + u[i][1] * x[1]) / x[0].hypot(x[1]) }
    };
    let moved = nodes.iter().map(radial).sum::<f64>() / nodes.len() as f64;
    [mean / p - 1.0, moved / bore - 1.0, off.fold(0.0, f64::max)]
}

fn orders_of(shape: Ring, kind: CellKind, elements: &[usize], inner_is_slave: bool) -> ([f64; 3], [f64; 3]) {
    let all: Vec<[f64; 3]> = elements.iter().map(|&n| errors(shape, kind, n, inner_is_slave)).collect();
    let orders = [0, 1, 2].map(|k| order(elements, &all.iter().map(|errors| errors[k]).collect::<Vec<_>>()));
    let slave = if inner_is_slave { "inner" } else { "outer" };
    println!(
        "{shape:?} {kind:?} {elements:?}, slave {slave}: mean pressure, bore, pressures {all:.8?}, orders {orders:.2?}"
    );
    (all[all.len() - 1], orders)
}

#[test]
fn of_rings() {
    use CellKind::{Quadrilateral, Triangle6};
    for shape in [Ring::Quarter, Ring::Section] {
        for inner_is_slave in [true, false] {
            let (last, orders) = orders_of(shape, Quadrilateral, &[4, 8], inner_is_slave);
            assert!(last[0].abs() < 5e-3 && last[1].abs() < 1e-2, "{last:?}");
            assert!(orders[0] > 1.7 && orders[1] > 1.7, "{orders:?}");
            let (last, orders) = orders_of(shape, Triangle6, &[4, 8], inner_is_slave);
            assert!(last[0].abs() < 5e-4 && last[1].abs() < 5e-4, "{last:?}");
            assert!(orders[0] > 1.9 && orders[1] > 1.9, "{orders:?}");
        }
    }
}

#[test]
#[ignore = "takes a minute; doc/method/verification-bodies.md has the figures"]
fn table_of_rings() {
    use CellKind::{Quadrilateral, Triangle, Triangle6};
    for shape in [Ring::Quarter, Ring::Section] {
        for kind in [Quadrilateral, Triangle, Triangle6] {
            for inner_is_slave in [true, false] {
                orders_of(shape, kind, &[4, 8, 16, 32], inner_is_slave);
            }
        }
    }
}
