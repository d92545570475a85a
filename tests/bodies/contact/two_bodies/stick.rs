//! Cattaneo and Mindlin: cylinders of the same material, pressed together and then sheared.

use crate::common::convergence::distance;
use crate::common::prelude::*;

const YOUNG: f64 = 210e9;
const MU: f64 = 0.3;
/// Half of what makes it slide.
const SHARE: f64 = 0.5;

/// Contact of the half-width `a`, with `n` elements up to 1.5 a: pressed until 1, sheared without a moment until 5.
fn cylinders(n: [usize; 2], a: f64, ratio: f64, slave: Side) -> (Description, f64) {
    let (radius, modulus, width) = (1.0, 0.5 * YOUNG / (1.0 - 0.09), 0.5);
    let force = PI * a * a * modulus / (4.0 * 0.5 * radius);
    let round = |n| Round { radius, n, fine: 1.5 * a, ratio, width, height: 1.0 };
    let (lower, upper) = (round(n[0]).whole(Side::Lower), round(n[1]).whole(Side::Upper));
    let opposite = |boundary: &str| Opposite::from(boundary).within(0.3);
    let body = bodies((lower.into(), YOUNG), (upper.into(), YOUNG), None, equal_increments(5.0, 5));
    let body = match slave {
        Side::Upper => body.pair("upper:bottom", MU, opposite("lower:top")),
        Side::Lower => body.pair("lower:top", MU, opposite("upper:bottom")),
    };
    let shear = MU * SHARE * force / (2.0 * width);
    // The sides are shorter than the height by the sag.
    let aside = shear / (1.0 - round(n[1]).sag(width));
    let sheared = |boundary: &str, traction: [f64; 2]| Load::new(boundary, &traction).over(&[[1.0, 0.0], [5.0, 1.0]]);
    let body = body
        .support("lower:bottom", &[Axis::X, Axis::Y])
        .load(Load::new("upper:top", &[0.0, -0.5 * force / width]).over(&[[0.0, 0.0], [1.0, 1.0]]))
        .load(sheared("upper:top", [shear, 0.0]))
        .load(sheared("upper:right", [0.0, aside]))
        .load(sheared("upper:left", [0.0, -aside]));
    (body, force)
}

fn solve(n: [usize; 2], a: f64, ratio: f64, slave: Side) -> (Model, HistoryOutcome, f64) {
    let (body, force) = cylinders(n, a, ratio, slave);
    let model = Model::build(&body).unwrap();
    let linear = Some(LinearAlgebra::default());
    let outcome = solved(&model, SolverChoice { linear, tolerance: 1e-10, ..bn() }, &mut ());
    (model, outcome, force)
}

/// Which nodes touch and do not slip, and how far out they are.
fn sticks(model: &Model, outcome: &HistoryOutcome) -> f64 {
    let state = &outcome.state;
    let most = largest(&state.p_n);
    let sticking = (0..state.p_n.len())
        .filter(|&i| state.p_n[i] > 1e-6 * most && state.p_t[i].abs() < (1.0 - 1e-6) * MU * state.p_n[i]);
    sticking.map(|i| model.contact.nodes[i].position[0].abs()).fold(0.0, f64::max)
}

/// Slave, iterations, shear on the axis and largest shear over μ p0, largest pressure over p0, where the last nodes stick over a.
type Row = ([usize; 2], Side, [usize; 5], [f64; 4]);

const REFERENCE: [Row; 4] = [
    ([15, 15], Side::Upper, [12, 2, 2, 1, 2], [0.2919464, 0.6488424, 1.0010535, 0.7]),
    ([15, 22], Side::Upper, [14, 2, 2, 2, 2], [0.2926482, 0.6734253, 1.0007992, 0.6818182]),
    ([15, 22], Side::Lower, [12, 2, 2, 1, 2], [0.2926921, 0.6412570, 1.0004082, 0.7]),
    ([30, 30], Side::Upper, [13, 3, 2, 3, 2], [0.2928399, 0.6618853, 1.0011368, 0.7]),
];

#[test]
fn of_one_material() {
    let a = 0.02;
    let p0 = a * YOUNG / (2.0 * (1.0 - 0.09));
    let all = REFERENCE.map(|(n, slave, ..)| solve(n, a, 1.2, slave));
    for ((n, slave, iterations, expected), (model, outcome, force)) in REFERENCE.into_iter().zip(all) {
        let state = &outcome.state;
        let stress = |forces: &[f64], i: usize| forces[i].abs() / model.contact.nodes[i].weight;
        let all = 0..model.contact.nodes.len();
        let largest = |forces: &[f64]| all.clone().map(|i| stress(forces, i)).fold(0.0, f64::max);
        let place = |i: usize| model.contact.nodes[i].position[0].abs();
        let axis = all.clone().min_by(|&i, &j| place(i).total_cmp(&place(j))).unwrap();
        let found = [
            stress(&state.p_t, axis) / (MU * p0),
            largest(&state.p_t) / (MU * p0),
            largest(&state.p_n) / p0,
            sticks(&model, &outcome) / a,
        ];
        let counts: Vec<usize> = outcome.records.iter().map(|record| record.iterations).collect();
        println!("{n:?} {slave:?}: {counts:?} {found:.7?}");
        for (found, expected) in found.iter().zip(expected) {
            assert!((found - expected).abs() < 1e-6, "{n:?} {slave:?} {found} {expected}");
        }
        // Another start takes fewer in the first increment.
        assert!(
            counts.iter().zip(iterations).all(|(found, expected)| *found <= expected + 1),
            "{n:?} {slave:?} {counts:?}"
        );
        let [p, q] = [&state.p_n, &state.p_t].map(|forces| forces.iter().sum::<f64>());
        assert!((p / force - 1.0).abs() < 1e-6 && (q.abs() / (MU * SHARE * force) - 1.0).abs() < 1e-6, "{p} {q}");
    }
}

/// The distances of pressure and shear from the closed form of the forces found; the last nodes that stick are within an element.
fn errors(n: [usize; 2], slave: Side) -> [f64; 2] {
    let a = 2.5e-3;
    let (model, outcome, _) = solve(n, a, 1.0 + 2.0 / n[0] as f64, slave);
    let state = &outcome.state;
    let sum = |forces: &[f64]| forces.iter().sum::<f64>();
    let hertz = Hertz::line(sum(&state.p_n), 0.5, 0.5 * YOUNG / (1.0 - 0.09));
    let share = sum(&state.p_t) / (MU * sum(&state.p_n));
    let (c, found) = (hertz.stick(share.abs()), sticks(&model, &outcome));
    let h = 1.5 * a / n[usize::from(slave == Side::Upper)] as f64;
    println!(
        "{n:?} {slave:?}: sticks to {:.4} a, closed form {:.4} a, element {:.4} a",
        found / hertz.a,
        c / hertz.a,
        h / hertz.a
    );
    assert!((found - c).abs() < h, "{found} {c} {h}");
    let boundary = if slave == Side::Upper { "upper:bottom" } else { "lower:top" };
    [
        distance(&model, boundary, &state.p_n, |x| hertz.pressure(x[0])),
        distance(&model, boundary, &state.p_t, |x| share.signum() * MU * hertz.shear(x[0], share.abs())),
    ]
}

/// Where in an element the contact ends differs from mesh to mesh, so that from one to the next the order may be far from 1.
fn assert_converges(meshes: &[[usize; 2]], slave: Side, least: f64, most: [f64; 2]) {
    let all: Vec<[f64; 2]> = meshes.iter().map(|&n| errors(n, slave)).collect();
    let elements: Vec<usize> = meshes.iter().map(|n| n[0]).collect();
    let orders = [0, 1].map(|k| order(&elements, &all.iter().map(|errors| errors[k]).collect::<Vec<_>>()));
    println!("{meshes:?} {slave:?}: pressure, shear {all:.6?}, orders {orders:.3?}");
    let last = all[all.len() - 1];
    assert!(orders.iter().all(|order| *order > least), "{orders:?}");
    assert!(last[0] < most[0] && last[1] < most[1], "{last:?}");
}

#[test]
fn converges_to_the_closed_form() {
    assert_converges(&[[10, 15], [20, 30]], Side::Upper, 0.0, [0.0235, 0.0775]);
}

#[test]
#[ignore = "takes minutes; doc/method/verification-bodies.md has the figures"]
fn table_of_stick() {
    assert_converges(&[[10, 15], [20, 30], [40, 60]], Side::Upper, 0.95, [0.0064, 0.0201]);
}
