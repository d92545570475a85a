//! Hertz: two elastic spheres, by their section and a quarter of them in space.

use crate::common::convergence::distance;
use crate::common::prelude::*;

const RADII: [f64; 2] = [1.0, 0.5];
const YOUNG: [f64; 2] = [210e9, 70e9];

fn together() -> (f64, f64) {
    let sum = |values: [f64; 2]| 1.0 / (1.0 / values[0] + 1.0 / values[1]);
    (sum(RADII), sum(YOUNG.map(|young| young / (1.0 - 0.09))))
}

/// Half the section, or a quarter in space, with `n` elements up to 1.5 a below and above.
#[derive(Debug, Clone, Copy, PartialEq)]
enum Body {
    Section,
    Quarter,
}

fn spheres(body: Body, n: [usize; 2], a: f64, slave: Side) -> Description {
    let (ratio, size) = match body {
        Body::Section => (1.0 + 1.2 / n[0] as f64, 50.0 * a),
        Body::Quarter => (1.0 + 1.6 / n[0] as f64, 15.0 * a),
    };
    let round = |k: usize| Round { radius: RADII[k], n: n[k], fine: 1.5 * a, ratio, width: size, height: size };
    let (lower, upper) = match body {
        Body::Section => (round(0).half(Side::Lower), round(1).half(Side::Upper)),
        Body::Quarter => (round(0).quarter(Side::Lower), round(1).quarter(Side::Upper)),
    };
    let (radius, modulus) = together();
    let force = 4.0 / 3.0 * modulus * a.powi(3) / radius;
    let opposite = |boundary: &str| Opposite::from(boundary).within(0.5 * size);
    let together = bodies((lower.into(), YOUNG[0]), (upper.into(), YOUNG[1]), None, vec![1.0]);
    let together = match slave {
        Side::Upper => together.pair("upper:bottom", 0.0, opposite("lower:top")),
        Side::Lower => together.pair("lower:top", 0.0, opposite("upper:bottom")),
    };
    match body {
        Body::Section => {
            let pressure = force / (std::f64::consts::PI * size * size);
            let material = Material { plane: Some(Plane::Axisymmetric), ..together.material.clone() };
            Description { material, ..together }
                .support("lower:bottom", &[Axis::X, Axis::Y])
                .load(Load::new("upper:top", &[0.0, -pressure]))
        }
        Body::Quarter => ["lower", "upper"]
            .iter()
            .fold(together, |body, name| {
                body.support(&format!("{name}:left"), &[Axis::X]).support(&format!("{name}:front"), &[Axis::Y])
            })
            .support("lower:bottom", &[Axis::X, Axis::Y, Axis::Z])
            .load(Load::new("upper:top", &[0.0, 0.0, -0.25 * force / (size * size)])),
    }
}

/// The errors of p0, of a (second moment, 2 P a²/5) and of the whole pressure, for the load that was found.
fn errors(body: Body, n: [usize; 2], slave: Side) -> [f64; 3] {
    let model = Model::build(&spheres(body, n, 5e-3, slave)).unwrap();
    let linear = if body == Body::Section { LinearAlgebra::default() } else { LinearAlgebra::condensed() };
    let outcome = solved(&model, solver_of(Method::BN, linear), &mut ());
    let p_n = &outcome.state.p_n;
    let r = |x: [f64; 3]| if body == Body::Section { x[0] } else { x[0].hypot(x[1]) };
    let total: f64 = p_n.iter().sum();
    let moment: f64 = model.contact.nodes.iter().zip(p_n).map(|(contact, p)| p * r(contact.position).powi(2)).sum();
    let (radius, modulus) = together();
    let hertz = Hertz::sphere(if body == Body::Section { total } else { 4.0 * total }, radius, modulus);
    let axis = (0..p_n.len()).find(|&i| r(model.contact.nodes[i].position) == 0.0).unwrap();
    let boundary = if slave == Side::Upper { "upper:bottom" } else { "lower:top" };
    let errors = [
        p_n[axis] / model.contact.nodes[axis].weight / hertz.p0 - 1.0,
        (2.5 * moment / total).sqrt() / hertz.a - 1.0,
        distance(&model, boundary, p_n, |x| hertz.pressure(r(x))),
    ];
    let iterations = outcome.records[0].iterations;
    println!(
        "{body:?} {n:?} {slave:?}: {iterations} iterations, {} unknowns, p0, a, pressure {errors:.5?}",
        model.problem.displacements()
    );
    errors
}

fn assert_converges(body: Body, meshes: &[[usize; 2]], slave: Side) {
    let all: Vec<[f64; 3]> = meshes.iter().map(|&n| errors(body, n, slave)).collect();
    let elements: Vec<usize> = meshes.iter().map(|n| n[0]).collect();
    let orders = [0, 1, 2].map(|k| order(&elements, &all.iter().map(|errors| errors[k]).collect::<Vec<_>>()));
    println!("{body:?} {slave:?}: orders {orders:.2?}");
    assert!(orders[2] > 0.9, "{orders:?}");
    let last = all[all.len() - 1];
    assert!(last[0].abs() < 0.03 && last[1].abs() < 0.01 && last[2] < 0.04, "{last:?}");
}

#[test]
fn of_the_section() {
    assert_converges(Body::Section, &[[8, 12], [16, 24]], Side::Upper);
}

#[test]
#[ignore = "takes minutes; doc/method/verification-bodies.md has the figures"]
fn table_of_spheres() {
    assert_converges(Body::Section, &[[8, 12], [16, 24], [32, 48]], Side::Upper);
    assert_converges(Body::Quarter, &[[4, 6], [6, 9]], Side::Upper);
}
