//! Hertz: two elastic cylinders, half of each.

use crate::common::convergence::distance;
use crate::common::prelude::*;

const RADII: [f64; 2] = [1.0, 0.5];
const YOUNG: [f64; 2] = [210e9, 70e9];

/// `1 / (1/R1 + 1/R2)` and `E*`.
fn together() -> (f64, f64) {
    let sum = |values: [f64; 2]| 1.0 / (1.0 / values[0] + 1.0 / values[1]);
    (sum(RADII), sum(YOUNG.map(|young| young / (1.0 - 0.09))))
}

/// Contact of the half-width `a` with `n` elements up to 2 a below and above.
fn cylinders(n: [usize; 2], a: f64, ratio: f64, slave: Side) -> (Description, f64) {
    let width = [0.9, 0.45];
    let round = |k: usize| Round { radius: RADII[k], n: n[k], fine: 2.0 * a, ratio, width: width[k], height: 1.0 };
    let (lower, upper) = (round(0).half(Side::Lower), round(1).half(Side::Upper));
    let (radius, modulus) = together();
    let force = PI * a * a * modulus / (4.0 * radius);
    let opposite = |boundary: &str| Opposite::from(boundary).within(0.3);
    let body = bodies((lower.into(), YOUNG[0]), (upper.into(), YOUNG[1]), None, vec![1.0]);
    let body = match slave {
        Side::Upper => body.pair("upper:bottom", 0.0, opposite("lower:top")),
        Side::Lower => body.pair("lower:top", 0.0, opposite("upper:bottom")),
    };
    let body = body
        .support("lower:bottom", &[Axis::X, Axis::Y])
        .support("lower:left", &[Axis::X])
        .support("upper:left", &[Axis::X])
        .load(Load::new("upper:top", &[0.0, -0.5 * force / width[1]]));
    (body, force)
}

fn solve(
    n: [usize; 2],
    a: f64,
    ratio: f64,
    slave: Side,
    method: Method,
    linear: LinearAlgebra,
) -> (Model, HistoryOutcome) {
    let model = Model::build(&cylinders(n, a, ratio, slave).0).unwrap();
    // What rounding leaves is 3e-12 on the finest of these meshes.
    let solver = SolverChoice { linear: Some(linear), tolerance: 1e-11, ..SolverChoice::new(method) };
    let outcome = solved(&model, solver, &mut ());
    (model, outcome)
}

/// Where contact is, x and forces from the axis outwards.
fn sorted(model: &Model, p: &[f64]) -> Vec<(f64, f64, f64)> {
    let mut all: Vec<_> = model.contact.nodes.iter().zip(p).map(|(c, p)| (c.position[0], *p, c.weight)).collect();
    all.sort_by(|a, b| a.0.total_cmp(&b.0));
    all
}

/// Iterations, nodes that are closed, largest pressure, half-width, displacement of the far side, force, and that of the node on the axis.
type Row = ([usize; 2], Side, usize, usize, [f64; 5]);

const REFERENCE: [Row; 5] = [
    ([8, 8], Side::Upper, 10, 5, [1.0008447915, 1.0070555094, -2.9290590370e-3, 2.7187199654e7, 4.3306325596e6]),
    ([8, 12], Side::Upper, 11, 7, [0.9942727311, 0.9990896527, -2.9318689229e-3, 2.7187194531e7, 2.8681103509e6]),
    ([8, 12], Side::Lower, 9, 5, [0.9941107124, 1.0152496134, -2.9301598365e-3, 2.7187213116e7, 4.3014540249e6]),
    ([16, 24], Side::Upper, 12, 13, [1.0002872963, 0.9978872158, -2.9346021150e-3, 2.7187197158e7, 1.4393902533e6]),
    ([16, 24], Side::Lower, 11, 9, [0.9994945426, 1.0022948965, -2.9340375624e-3, 2.7187201833e7, 2.1623696902e6]),
];

#[test]
fn of_two_materials() {
    let a = 0.02;
    let (radius, modulus) = together();
    let p0 = a * modulus / (2.0 * radius);
    let of_row = |(n, slave, ..): Row| {
        let (model, outcome) = solve(n, a, 1.15, slave, Method::BN, LinearAlgebra::default());
        let line = sorted(&model, &outcome.state.p_n);
        let total: f64 = line.iter().map(|(_, p, _)| p).sum();
        let moment: f64 = line.iter().map(|(x, p, _)| p * x * x).sum();
        let largest = line.iter().map(|(_, p, l)| p / l).fold(0.0, f64::max);
        let u = model.displacements(1.0, &outcome.state.u).unwrap();
        let far = model.mesh.boundary("upper:top").unwrap().nodes();
        let far = far.into_iter().find(|&i| model.mesh.nodes[i][0] == 0.0).unwrap();
        let found = [largest / p0, 2.0 * (moment / total).sqrt() / a, u[far][1], total, line[0].1];
        let most = line.iter().map(|(_, p, _)| *p).fold(0.0, f64::max);
        let count = line.iter().filter(|(_, p, _)| *p > 1e-9 * most).count();
        println!("{n:?} {slave:?}: {} iterations, {count} closed, {found:?}", outcome.records[0].iterations);
        (outcome.records[0].iterations, count, found)
    };
    let all = REFERENCE.map(of_row);
    for ((n, slave, most, closed, expected), (iterations, count, found)) in REFERENCE.into_iter().zip(all) {
        // The closed form, and the digits of before.
        assert!((found[0] - 1.0).abs() < 6e-3 && (found[1] - 1.0).abs() < 0.016, "{n:?} {slave:?} {found:?}");
        for (found, expected) in found.iter().zip(expected) {
            assert!((found / expected - 1.0).abs() < 1e-8, "{n:?} {slave:?} {found:.10e} {expected:.10e}");
        }
        assert_eq!(count, closed, "{n:?} {slave:?}");
        // Another start takes fewer.
        assert!(iterations <= most + 1, "{n:?} {slave:?} {iterations}");
    }
}

#[test]
fn all_ways_agree() {
    use stickslip::algebra::linear::{SparseCholesky, SparseLu};
    let (_, reference) = solve([8, 12], 0.02, 1.15, Side::Upper, Method::BN, LinearAlgebra::default());
    for (method, linear) in [
        (Method::BN, LinearAlgebra::Whole(SparseLu::Faer)),
        (Method::BN, LinearAlgebra::Condensed(SparseCholesky::default())),
        (Method::BN, LinearAlgebra::Condensed(SparseCholesky::Faer)),
        (Method::Ip, LinearAlgebra::Whole(SparseLu::default())),
        (Method::Ip, LinearAlgebra::Condensed(SparseCholesky::default())),
        (Method::Bn { r_factor: 1.0, rescue: true }, LinearAlgebra::Whole(SparseLu::default())),
    ] {
        let (_, outcome) = solve([8, 12], 0.02, 1.15, Side::Upper, method, linear);
        let apart = apart(&outcome.state.p_n, &reference.state.p_n);
        assert!(apart < 1e-9, "{method:?} {linear:?} {apart:e}");
    }
}

/// The errors of p0, of a (second moment, P a²/4) and of the whole pressure, for the load that was found.
fn errors(n: [usize; 2], slave: Side) -> [f64; 3] {
    let (model, outcome) = solve(n, 2.5e-3, 1.0 + 1.2 / n[0] as f64, slave, Method::BN, LinearAlgebra::default());
    let line = sorted(&model, &outcome.state.p_n);
    let total: f64 = line.iter().map(|(_, p, _)| p).sum();
    let moment: f64 = line.iter().map(|(x, p, _)| p * x * x).sum();
    let (radius, modulus) = together();
    let hertz = Hertz::line(2.0 * total, radius, modulus);
    let boundary = if slave == Side::Upper { "upper:bottom" } else { "lower:top" };
    [
        line[0].1 / line[0].2 / hertz.p0 - 1.0,
        2.0 * (moment / total).sqrt() / hertz.a - 1.0,
        distance(&model, boundary, &outcome.state.p_n, |x| hertz.pressure(x[0])),
    ]
}

/// Against the closed form, on bodies that are large beside the contact.
fn assert_converges(meshes: &[[usize; 2]], slave: Side) {
    let all: Vec<[f64; 3]> = meshes.iter().map(|&n| errors(n, slave)).collect();
    let elements: Vec<usize> = meshes.iter().map(|n| n[0]).collect();
    let pressure: Vec<f64> = all.iter().map(|errors| errors[2]).collect();
    let order = order(&elements, &pressure);
    println!("{meshes:?} {slave:?}: p0, a, pressure {all:.6?}, order {order:.3}");
    assert!(order > 0.9, "{order}");
    let last = all[all.len() - 1];
    assert!(last[0].abs() < 0.01 && last[1].abs() < 0.01 && last[2] < 0.02, "{last:?}");
}

#[test]
fn converge_to_the_closed_form() {
    assert_converges(&[[8, 12], [16, 24]], Side::Upper);
}

#[test]
#[ignore = "takes minutes; doc/method/verification-bodies.md has the figures"]
fn table_of_cylinders() {
    for slave in [Side::Upper, Side::Lower] {
        assert_converges(&[[8, 12], [16, 24], [32, 48]], slave);
    }
}
