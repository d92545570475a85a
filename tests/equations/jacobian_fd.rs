//! The Jacobian (21) against finite differences of the residual (19), in every contact case.

use crate::common::prelude::*;

/// Contact cases by their choice of (p_n, gap left, p_t, slip) in units of force and length. Every
/// choice stays clear of the borders between cases, so that a small step does not change them.
const CASES: [(&str, [f64; 4]); 8] = [
    ("open, no pressure", [-0.5, 2.0, 0.3, 0.2]),
    ("open, pressure left over, sticking", [0.5, 3.0, 0.01, 0.002]),
    ("open, pressure left over, sliding", [0.5, 3.0, 0.7, 0.9]),
    ("closed, no pressure", [-0.5, -2.0, 0.3, 0.2]),
    ("closed, stick", [2.0, -0.3, 0.1, 0.05]),
    ("closed, slip forwards", [2.0, -0.3, 0.5, 2.0]),
    ("closed, slip backwards", [2.0, 0.1, -0.4, -3.0]),
    ("closed, friction beyond the cone", [1.0, -0.2, 5.0, -0.1]),
];

#[test]
fn jacobian_is_the_derivative_of_the_residual() {
    check_jacobian(&["mesh.elements=[8,3]", "contact.friction=0.4"]);
}

/// The same with rows of three nodes.
#[test]
fn jacobian_of_second_order() {
    check_jacobian(&["mesh.elements=[4,2]", "contact.friction=0.4", "mesh.cells=\"triangle6\""]);
}

fn check_jacobian(overrides: &[&str]) {
    let scene = common::block(overrides);
    let model = discretise(&scene).unwrap();
    let problem = &model.problem;
    let scaling = model.scaling();
    let mut formulation = Bdiff::new(problem, scaling, &FormulationScaling::paper(problem.weight().unwrap()));
    let layout = formulation.layout().clone();
    assert_eq!(layout.contacts(), CASES.len());

    // A state in which node i is in case i: u free, then gap and w̄_t are chosen to fit.
    let mut z: Vec<f64> = (0..layout.unknowns()).map(|k| (1.0 + k as f64 * 0.7).sin()).collect();
    let r = |i: usize| 1e12 * problem.weight().unwrap()[i] / scaling.stiffness();
    let (mut gap, mut w_t_last) = (vec![0.0; CASES.len()], vec![0.0; CASES.len()]);
    for (i, (_, [p_n, gap_left, p_t, slip])) in CASES.into_iter().enumerate() {
        z[layout.p_n(i)] = p_n;
        z[layout.p_t(i).unwrap()] = p_t;
        gap[i] = (problem.c_n().times(&z[..problem.displacements()]).unwrap()[i] + gap_left / r(i)) * scaling.length;
        w_t_last[i] = (problem.c_t().times(&z[..problem.displacements()]).unwrap()[i] - slip / r(i)) * scaling.length;
    }
    let force: Vec<f64> = (0..layout.displacements()).map(|k| (k as f64).cos() * scaling.force).collect();
    let w_o_last = vec![0.0; w_t_last.len()];
    let increment = Increment { force: &force, gap: &gap, mu: problem.mu(), w_t_last: &w_t_last, w_o_last: &w_o_last };
    formulation.begin(&increment, &vec![0.0; formulation.unknowns()]);
    assert!(formulation.linearize(&z));
    assert!(!formulation.linearize(&z), "the same state changes nothing");

    let n = layout.unknowns();
    let step = 1e-6;
    let at = |shifted: &[f64]| {
        let mut h = vec![0.0; n];
        formulation.residual(shifted, &mut h).unwrap();
        h
    };
    for column in 0..n {
        let mut shifted = z.clone();
        shifted[column] += step;
        let ahead = at(&shifted);
        shifted[column] -= 2.0 * step;
        let behind = at(&shifted);
        for row in 0..n {
            let difference = (ahead[row] - behind[row]) / (2.0 * step);
            let entry = formulation.jacobian().get(row, column);
            let case = (0..CASES.len()).find(|&i| row == layout.p_n(i) || Some(row) == layout.p_t(i));
            let name = case.map_or("equilibrium", |i| CASES[i].0);
            // r spans several units here: differences are exact to rounding / step.
            assert!((difference - entry).abs() < 1e-8, "{name}: row {row}, column {column}: {difference} {entry}");
        }
    }
}

/// Each contact case writes another row, so the test above has met all of them.
#[test]
fn the_cases_are_all_different() {
    use stickslip::solver::{NormalCase, TangentialCase, normal_case, tangential_case};
    let mut seen = Vec::new();
    for (_, [p_n, gap_left, p_t, slip]) in CASES {
        seen.push((normal_case(p_n, -gap_left, 0.0, 1.0), tangential_case([p_t, 0.0], p_n, [slip, 0.0], 0.4, 1.0)));
    }
    let slips = |sign| TangentialCase::Slip { direction: [sign, 0.0], turning: [[0.0; 2]; 2] };
    let seen = |normal, tangential: TangentialCase| {
        seen.iter().any(|(n, t): &(NormalCase, TangentialCase)| *n == normal && t.straight().is_like(&tangential))
    };
    for normal in [NormalCase::Open, NormalCase::Closed] {
        for tangential in [TangentialCase::NoPressure, TangentialCase::Stick, slips(1.0)] {
            assert!(seen(normal, tangential), "{normal:?} {tangential:?} is missing");
        }
    }
    assert!(seen(NormalCase::Closed, slips(-1.0)));
}

/// Along a Newton direction the cheap merit equals the merit of the full residual.
#[test]
fn merit_along_a_direction_is_the_merit() {
    use stickslip::algebra::linear::RefinedSolver;
    let scene = common::block(&["mesh.elements=[6,6]", "contact.friction=0.4"]);
    let model = discretise(&scene).unwrap();
    let problem = &model.problem;
    let scaling = model.scaling();
    let mut formulation = Bdiff::new(problem, scaling, &FormulationScaling::paper(problem.weight().unwrap()));
    let force = model.loading.force_at(1.0, problem).unwrap();
    let w_t_last = vec![0.0; problem.contacts()];
    let w_o_last = vec![0.0; w_t_last.len()];
    let increment = Increment {
        force: &force,
        gap: model.loading.gap(),
        mu: problem.mu(),
        w_t_last: &w_t_last,
        w_o_last: &w_o_last,
    };
    formulation.begin(&increment, &vec![0.0; formulation.unknowns()]);
    let n = formulation.unknowns();
    let z: Vec<f64> = (0..n).map(|k| (1.0 + k as f64 * 0.7).sin()).collect();
    let (mut h, mut dz) = (vec![0.0; n], vec![0.0; n]);
    formulation.residual(&z, &mut h).unwrap();
    formulation.linearize(&z);
    let mut direct = RefinedSolver::default();
    direct.analyze(formulation.jacobian()).unwrap();
    direct.factorize(formulation.jacobian()).unwrap();
    let rhs: Vec<f64> = h.iter().map(|x| -x).collect();
    direct.solve(formulation.jacobian(), &rhs, &mut dz).unwrap();
    let merit = formulation.merit_along(&z, &dz, &h);
    for t in [0.0, 0.1, 0.5, 0.9, 1.0] {
        let trial: Vec<f64> = z.iter().zip(&dz).map(|(z, dz)| z + t * dz).collect();
        let mut h = vec![0.0; n];
        formulation.residual(&trial, &mut h).unwrap();
        let full = formulation.merit(&h);
        assert!((merit(t) - full).abs() <= 1e-12 * full, "t = {t}: {} {full}", merit(t));
    }
}
