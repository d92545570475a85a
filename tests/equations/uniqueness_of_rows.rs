//! The critical friction where rows hold three nodes: by the sign of the determinant of the whole system, and condensed.

use crate::common::prelude::*;
use crate::uniqueness::{posed, posed_critical};

/// The sign of the determinant of J(κ), written down row by row and eliminated with pivots: equilibrium, then for each node the rows of
/// its tangential and its normal force.
fn sign(problem: &ContactProblem, kappa: f64, mu: f64, wanted: &[ContactStatus], s: &[f64]) -> i32 {
    let (n_u, n_c) = (problem.displacements(), problem.contacts());
    let unit = problem.stiffness().assembled().unwrap().entries().fold(0.0_f64, |m, (_, _, k)| m.max(k));
    let n = n_u + 2 * n_c;
    let mut a = vec![vec![0.0; n]; n];
    problem.stiffness().assembled().unwrap().entries().for_each(|(i, j, k)| a[i][j] = k / unit);
    for (i, status) in wanted.iter().enumerate() {
        let (t, n) = (n_u + 2 * i, n_u + 2 * i + 1);
        for (map, place) in [(problem.c_t(), t), (problem.c_n(), n)] {
            map.row(i).iter().for_each(|(dof, c)| a[*dof][place] = *c);
        }
        let hold = |a: &mut Vec<Vec<f64>>, map: &stickslip::algebra::Csr, place: usize| {
            map.row(i).iter().for_each(|(dof, c)| a[place][*dof] = *c);
        };
        match status {
            ContactStatus::Open => (a[t][t], a[n][n]) = (1.0, 1.0),
            ContactStatus::Stick => {
                hold(&mut a, problem.c_t(), t);
                hold(&mut a, problem.c_n(), n);
            }
            ContactStatus::Slip => {
                (a[t][t], a[t][n]) = (1.0, -kappa * mu * s[i]);
                hold(&mut a, problem.c_n(), n);
            }
        }
    }
    let mut sign = 1;
    for k in 0..n {
        let largest = (k..n).max_by(|&i, &j| a[i][k].abs().total_cmp(&a[j][k].abs())).unwrap();
        if largest != k {
            a.swap(k, largest);
            sign = -sign;
        }
        let pivot = a[k].clone();
        assert!(pivot[k] != 0.0);
        sign *= if pivot[k] < 0.0 { -1 } else { 1 };
        for row in a.iter_mut().skip(k + 1).filter(|row| row[k] != 0.0) {
            let factor = row[k] / pivot[k];
            row.iter_mut().zip(&pivot).skip(k).for_each(|(x, y)| *x -= factor * y);
        }
    }
    sign
}

/// The same friction of the condensed problem.
fn condensed_critical(n: usize, mu: f64, wanted: &[ContactStatus], s: &[f64]) -> f64 {
    let (model, gap, state, w_t_last) = posed("triangle6", n, mu, wanted, s);
    let condensed = Condensed::new(&model.problem, &model.loading, SparseCholesky::default()).unwrap();
    let problem = &condensed.problem;
    let force = vec![0.0; problem.displacements()];
    let zeros = vec![0.0; n];
    let increment = Increment { force: &force, gap: &gap, mu: problem.mu(), w_t_last: &w_t_last, w_o_last: &zeros };
    let state = State { u: vec![0.0; problem.displacements()], ..state };
    let mut linear = RefinedSolver::default();
    let found = critical_friction(problem, &increment, &state, model.scaling(), &mut linear);
    found.unwrap().unwrap().factor
}

#[test]
fn the_determinant_changes_its_sign_first_at_the_critical_friction() {
    use ContactStatus::{Open, Slip, Stick};
    let mut finite = 0;
    for (mu, wanted, s) in [
        (0.4, [Slip; 6], [1.0; 6]),
        (3.5, [Slip; 6], [1.0; 6]),
        (0.8, [Slip, Slip, Slip, Slip, Slip, Stick], [1.0; 6]),
        (0.8, [Slip, Slip, Open, Slip, Slip, Slip], [1.0; 6]),
        (0.8, [Slip, Slip, Slip, Stick, Slip, Slip], [1.0; 6]),
        (0.8, [Slip; 6], [1.0, 1.0, -1.0, -1.0, -1.0, -1.0]),
        (0.8, [Open, Open, Slip, Slip, Stick, Stick], [1.0; 6]),
        (0.8, [Open, Stick, Slip, Slip, Slip, Slip], [1.0; 6]),
        (0.8, [Open, Stick, Slip, Slip, Slip, Slip], [-1.0; 6]),
        (0.8, [Stick, Slip, Stick, Slip, Stick, Slip], [1.0; 6]),
    ] {
        let factor = posed_critical("triangle6", 6, mu, &wanted, &s);
        let condensed = condensed_critical(6, mu, &wanted, &s);
        assert!(
            factor == condensed || (factor / condensed - 1.0).abs() < 1e-9,
            "{wanted:?} {s:?}: {factor} {condensed}"
        );
        let problem = posed("triangle6", 6, mu, &wanted, &s).0.problem;
        let at = |kappa: f64| sign(&problem, kappa, mu, &wanted, &s);
        let until = if factor.is_finite() { factor * (1.0 - 1e-9) } else { 100.0 };
        assert!((0..=40).all(|k| at(until * f64::from(k) / 40.0) == at(0.0)), "{wanted:?} {s:?}: {factor}");
        if factor.is_finite() {
            finite += 1;
            assert_eq!(at(factor * (1.0 + 1e-9)), -at(0.0), "{wanted:?} {s:?}: {factor}");
        }
    }
    assert!(finite >= 2, "{finite}");
}
