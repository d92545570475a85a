//! A steel roller on an aluminium block (NAFEMS, Konter 2006, benchmark 1): R = 50 mm, 200 mm × 200 mm, 35 kN/mm; by Hertz a = 6.21 mm and
//! 3585.37 MPa.

use crate::common::prelude::*;
use crate::common::round::lines;

const RADIUS: f64 = 0.05;
const FORCE: f64 = 35e6;
/// Half of where the meshes are fine.
const HALF_WIDTH: f64 = 6.215e-3;

/// The half x ≥ 0 of a disc that stands on the origin, with `n` elements along the first 2 a of its boundary: rings, and triangles around
/// the centre.
fn disc(n: usize) -> Mesh {
    let fine = 2.0 * HALF_WIDTH;
    let angles = lines(fine / RADIUS, n, PI, 1.15);
    let depths = lines(2.0 * fine / n as f64, 2, RADIUS, 1.15);
    let rings = depths.len() - 1;
    let (last, count) = (angles.len() - 1, angles.len());
    let node = |j: usize, i: usize| j * count + i;
    let place = |j: usize, i: usize| {
        let r = RADIUS - depths[j];
        let x = if i == 0 || i == last { 0.0 } else { r * angles[i].sin() };
        let y = if (j, i) == (0, 0) { 0.0 } else { RADIUS - r * angles[i].cos() };
        [x, y, 0.0]
    };
    let mut nodes: Vec<[f64; 3]> =
        (0..rings).flat_map(|j| (0..count).map(move |i| (j, i))).map(|(j, i)| place(j, i)).collect();
    let centre = nodes.len();
    nodes.push([0.0, RADIUS, 0.0]);
    let cell = |kind, nodes| Cell { kind, nodes, group: 0 };
    let quad =
        |j, i| cell(CellKind::Quadrilateral, vec![node(j, i), node(j, i + 1), node(j + 1, i + 1), node(j + 1, i)]);
    let triangle = |i| cell(CellKind::Triangle, vec![node(rings - 1, i), node(rings - 1, i + 1), centre]);
    let cells = (0..rings - 1).flat_map(|j| (0..last).map(move |i| (j, i))).map(|(j, i)| quad(j, i));
    let cells: Vec<Cell> = cells.chain((0..last).map(triangle)).collect();
    let rim: Vec<Vec<usize>> =
        (0..last).filter(|&i| angles[i] < PI / 3.0).map(|i| vec![node(0, i), node(0, i + 1)]).collect();
    let below = (0..rings - 1).map(|j| vec![node(j, 0), node(j + 1, 0)]);
    let above = (0..rings - 1).map(|j| vec![node(j, last), node(j + 1, last)]);
    let ends = [vec![node(rings - 1, 0), centre], vec![node(rings - 1, last), centre]];
    let boundaries = vec![
        Boundary { name: "bottom".into(), facets: rim },
        Boundary { name: "left".into(), facets: below.chain(above).chain(ends).collect() },
    ];
    Mesh::new(nodes, cells, Vec::new(), boundaries).unwrap()
}

/// With `n` elements in 2 a on the block and on the disc.
fn roller(block: usize, disc_elements: usize, slave: Side, friction: f64, increments: usize) -> Description {
    let block = Round { radius: f64::INFINITY, n: block, fine: 2.0 * HALF_WIDTH, ratio: 1.15, width: 0.1, height: 0.2 };
    let lower = (block.half(Side::Lower).into(), 70e9);
    let body = bodies(lower, (disc(disc_elements).into(), 210e9), None, equal_increments(1.0, increments));
    let opposite = |boundary: &str| Opposite::from(boundary).within(RADIUS);
    let body = match slave {
        Side::Upper => body.pair("upper:bottom", friction, opposite("lower:top")),
        Side::Lower => body.pair("lower:top", friction, opposite("upper:bottom")),
    };
    let crown = Where::Point([0.0, 2.0 * RADIUS].into());
    body.support("lower:bottom", &[Axis::X, Axis::Y])
        .support("lower:left", &[Axis::X])
        .support("upper:left", &[Axis::X])
        .load(Load::from(Action::Force { at: crown, force: vec![0.0, -0.5 * FORCE] }))
}

/// Largest pressure, that of the ellipse that fits the middle 0.8 a best, and largest shear, MPa; half-width by the second moment, mm;
/// displacement of the centre, m.
fn figures(model: &Model, outcome: &HistoryOutcome) -> [f64; 5] {
    let state = &outcome.state;
    let all = || model.contact.nodes.iter().enumerate();
    let largest = |p: &[f64]| all().map(|(i, c)| p[i].abs() / c.weight).fold(0.0, f64::max) / 1e6;
    let total: f64 = state.p_n.iter().sum();
    let moment: f64 = all().map(|(i, c)| state.p_n[i] * c.position[0].powi(2)).sum();
    let a = 6.215e-3;
    let (mut fit, mut size) = (0.0, 0.0);
    for (i, contact) in all().filter(|(_, contact)| contact.position[0] <= 0.8 * a) {
        let bow = (1.0 - (contact.position[0] / a).powi(2)).sqrt();
        fit += state.p_n[i] / contact.weight * bow;
        size += bow * bow;
    }
    let u = model.displacements(1.0, &state.u).unwrap();
    let centre = (0..u.len()).find(|&i| model.mesh.nodes[i] == [0.0, RADIUS, 0.0]).unwrap();
    let shear = if state.p_t.is_empty() { 0.0 } else { largest(&state.p_t) };
    [largest(&state.p_n), fit / size / 1e6, shear, 2e3 * (moment / total).sqrt(), u[centre][1]]
}

fn solve(n: [usize; 2], slave: Side, friction: f64, increments: usize) -> (Vec<usize>, [f64; 5]) {
    let model = Model::build(&roller(n[1], n[0], slave, friction, increments)).unwrap();
    let solver = SolverChoice { linear: Some(LinearAlgebra::default()), tolerance: 1e-10, ..bn() };
    let outcome = solved(&model, solver, &mut ());
    let iterations: Vec<usize> = iterations(&outcome);
    let figures = figures(&model, &outcome);
    println!(
        "disc:block {n:?}, slave {slave:?}, friction {friction}: {iterations:?}, p_max, fit, shear, a, u_y {figures:.10?}"
    );
    (iterations, figures)
}

/// Elements in 2 a of disc and block, slave, friction, iterations, figures.
type Row = ([usize; 2], Side, f64, &'static [usize], [f64; 5]);

const SMALL: [Row; 3] = [
    ([12, 18], Side::Upper, 0.0, &[9], [3569.7855, 3575.93, 0.0, 6.25160, -1.5621976388e-3]),
    (
        [12, 18],
        Side::Upper,
        0.1,
        &[9, 2, 2, 2, 1, 1, 3, 1, 1, 3],
        [3628.9611, 3609.65, 268.0236, 6.19962, -1.5606629775e-3],
    ),
    ([24, 36], Side::Upper, 0.0, &[10], [3577.9674, 3584.18, 0.0, 6.21600, -1.5633272146e-3]),
];

const LARGE: [Row; 3] = [
    ([48, 72], Side::Upper, 0.0, &[11], [3580.1927, 3586.41, 0.0, 6.20724, -1.5636278542e-3]),
    ([48, 72], Side::Lower, 0.0, &[12], [3585.9994, 3588.79, 0.0, 6.21053, -1.5642059277e-3]),
    (
        [48, 72],
        Side::Upper,
        0.1,
        &[13, 4, 4, 3, 2, 3, 4, 2, 3, 3],
        [3648.4840, 3615.34, 271.0542, 6.15632, -1.5620252910e-3],
    ),
];

fn assert_agrees(rows: &[Row]) {
    let all: Vec<_> = rows.iter().map(|(n, slave, mu, each, _)| solve(*n, *slave, *mu, each.len())).collect();
    for ((n, slave, friction, expected_iterations, expected), (iterations, found)) in rows.iter().zip(all) {
        // As many digits as are known.
        for ((found, expected), digit) in found.iter().zip(expected).zip([1e-4, 1e-2, 1e-4, 1e-5, 1e-13]) {
            assert!((found - expected).abs() < digit, "{n:?} {slave:?} {friction}: {found} {expected}");
        }
        // Another start takes fewer in the first increment.
        let more = iterations.iter().zip(*expected_iterations).any(|(found, expected)| *found > expected + 1);
        assert!(!more, "{n:?} {slave:?} {friction}: {iterations:?} {expected_iterations:?}");
    }
}

#[test]
fn a_roller_on_a_block() {
    assert_agrees(&SMALL);
}

#[test]
#[ignore = "takes a minute; doc/method/verification.md has the figures"]
fn table_of_rollers() {
    assert_agrees(&LARGE);
}
