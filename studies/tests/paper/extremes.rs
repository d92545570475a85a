//! The suite of extreme scenes: the default settings come to the right verdict in all of them, and every
//! "converged" stands up to a check that shares nothing with the library's own: the natural map of the
//! laws, summed in twice the working precision.

use std::ops::ControlFlow;
use stickslip::run::Run;
use stickslip::solver::history::{IncrementView, Observer, Status};
use stickslip::solver::{ContactProblem, Increment, State};
use stickslip_studies::extremes::{self, SuiteMethod};

/// Twice the working precision, by fused multiplication.
#[derive(Clone, Copy)]
struct Double {
    high: f64,
    low: f64,
}

impl Double {
    const ZERO: Double = Double { high: 0.0, low: 0.0 };

    fn plus(self, x: f64) -> Double {
        let sum = self.high + x;
        let back = sum - self.high;
        let error = (self.high - (sum - back)) + (x - back);
        Double { high: sum, low: self.low + error }
    }

    fn plus_product(self, a: f64, b: f64) -> Double {
        let product = a * b;
        let sum = self.plus(product);
        Double { low: sum.low + a.mul_add(b, -product), ..sum }
    }

    fn value(self) -> f64 {
        self.high + self.low
    }
}

/// `Σ c_j (u_j + rest_j)` of one row.
fn along(row: &[(usize, f64)], state: &State) -> f64 {
    let u_rest = |dof: usize| state.u_rest.get(dof).copied().unwrap_or(0.0);
    let sum = row.iter().fold(Double::ZERO, |sum, &(dof, c)| sum.plus_product(c, state.u[dof]).plus(c * u_rest(dof)));
    sum.value()
}

/// Displacements in two words, without their part along the free motions, which a body does not feel: where it has moved by much
/// more than it is strained, what rounding has left of a free motion in the entries of K is not an error of the state.
fn strained(problem: &ContactProblem, state: &State) -> [Vec<f64>; 2] {
    let product = |a: &[f64], b: &[f64]| a.iter().zip(b).map(|(a, b)| a * b).sum::<f64>();
    let mut basis: Vec<Vec<f64>> = Vec::new();
    for motion in problem.rigid_modes() {
        let mut motion = motion.clone();
        for other in &basis {
            let share = product(&motion, other) / product(other, other);
            motion.iter_mut().zip(other).for_each(|(r, other)| *r -= share * other);
        }
        basis.push(motion);
    }
    let (mut u, mut rest) = (state.u.clone(), state.u_rest.clone());
    rest.resize(u.len(), 0.0);
    for motion in basis.iter().chain(&basis) {
        let share = product(&u, motion) / product(motion, motion);
        for ((u, rest), r) in u.iter_mut().zip(&mut rest).zip(motion) {
            let left = Double::ZERO.plus(*u).plus_product(-share, *r).plus(*rest);
            *u = left.value();
            *rest = left.plus(-*u).value();
        }
    }
    [u, rest]
}

/// The largest imbalance of any displacement, relative to `force`.
fn imbalance(problem: &ContactProblem, increment: &Increment<'_>, state: &State, force: f64) -> f64 {
    let mut sums = vec![Double::ZERO; state.u.len()];
    let [u, rest] = strained(problem, state);
    for (row, column, value) in problem.stiffness().assembled().unwrap().entries() {
        sums[row] = sums[row].plus_product(value, u[column]).plus_product(value, rest[column]);
    }
    for i in 0..problem.contacts() {
        for (map, p) in [(problem.c_n(), state.p_n[i]), (problem.c_t(), state.p_t[i])] {
            for &(dof, c) in map.row(i) {
                sums[dof] = sums[dof].plus_product(c, p);
            }
        }
    }
    let largest = sums.iter().zip(increment.force).map(|(sum, f)| sum.plus(-f).value().abs()).fold(0.0, f64::max);
    if largest == 0.0 { 0.0 } else { largest / force }
}

/// The largest external or contact force so far, N, and the largest displacement or interference, m. The error measure compares
/// with no more than these.
#[derive(Default)]
struct Scales {
    force: f64,
    length: f64,
}

impl Scales {
    fn raise(&mut self, increment: &Increment<'_>, state: &State) {
        let largest = |values: &[f64]| values.iter().fold(0.0_f64, |m, x| m.max(x.abs()));
        let forces = [increment.force, &state.p_n, &state.p_t].map(largest);
        self.force = forces.into_iter().fold(self.force, f64::max);
        let interference = increment.gap.iter().fold(0.0_f64, |m, gap| m.max(-gap));
        self.length = self.length.max(interference).max(largest(&state.u));
    }
}

/// The largest component of the natural map of the contact laws: `min(p_n, g - w_n)` and
/// `p_t - Π(p_t + w_t - w̄_t)`, forces in units of `force` and lengths in units of `length`.
fn natural_map(problem: &ContactProblem, increment: &Increment<'_>, state: &State, scales: &Scales) -> f64 {
    let unit = |x: f64| if x > 0.0 { x } else { 1.0 };
    let (force, length) = (unit(scales.force), unit(scales.length));
    let mut largest = 0.0_f64;
    for i in 0..problem.contacts() {
        let (p_n, p_t) = (state.p_n[i] / force, state.p_t[i] / force);
        let distance = (increment.gap[i] - along(problem.c_n().row(i), state)) / length;
        let slip = (along(problem.c_t().row(i), state) - increment.w_t_last[i]) / length;
        let radius = problem.mu()[i] * p_n.max(0.0);
        let mut worst = p_n.min(distance).abs();
        if !problem.c_t().row(i).is_empty() {
            worst = worst.max((p_t - (p_t + slip).clamp(-radius, radius)).abs());
        }
        assert!(worst.is_finite());
        largest = largest.max(worst);
    }
    largest
}

/// Checks every converged increment.
struct Judge<'a> {
    name: &'a str,
    problem: &'a ContactProblem,
    scales: Scales,
}

impl Observer for Judge<'_> {
    fn increment(&mut self, step: &IncrementView<'_>) -> ControlFlow<()> {
        let Judge { name, problem, .. } = *self;
        if step.record.status != Status::Converged {
            return ControlFlow::Continue(());
        }
        self.scales.raise(step.increment, step.state);
        let map = natural_map(problem, step.increment, step.state, &self.scales);
        assert!(map <= 2e-10, "{name}, increment {}: natural map {map}", step.record.index);
        let (reported, truth) =
            (step.record.kkt.equilibrium, imbalance(problem, step.increment, step.state, self.scales.force));
        assert!(truth <= 1e-10, "{name}, increment {}: imbalance {truth}", step.record.index);
        // Rows with small terms are told by these.
        assert!(truth <= 10.0 * reported + 1e-15, "{name}, increment {}: {reported} for {truth}", step.record.index);
        ControlFlow::Continue(())
    }
}

/// Of one case in `every`.
fn verdicts_are_right(method: SuiteMethod, every: usize) {
    let cases = extremes::cases().unwrap();
    assert!(cases.len() >= 100);
    let mut solved = 0;
    for case in cases.iter().filter(|case| !case.long && case.methods.contains(&method)).step_by(every) {
        let name = format!("{} = {}, {}", case.sweep, case.value, method.title());
        let scene = case.scene().unwrap();
        let model = case.model(&scene).unwrap();
        let mut judge = Judge { name: &name, problem: &model.problem, scales: Scales::default() };
        let times = scene.time.all();
        let outcome = Run::of(&model, times, case.solver(&scene, method)).unwrap().history(&mut judge).unwrap();
        match case.expect {
            extremes::Expect::Solved => {
                assert_eq!(outcome.status, Status::Converged, "{name}: {:?}", outcome.violation);
                assert!(outcome.records.iter().all(|record| record.kkt.worst().1 <= 1e-10), "{name}");
                solved += 1;
            }
            extremes::Expect::None => {
                assert!(matches!(outcome.status, Status::NoEquilibrium | Status::Slips), "{name}: {}", outcome.status);
            }
            extremes::Expect::Unknown => {}
        }
    }
    assert!(solved * every >= 100, "{solved}");
}

/// One case in four takes some of every sweep.
const SOME: usize = 4;

#[test]
fn bn() {
    verdicts_are_right(SuiteMethod::Bn, SOME);
}

#[test]
fn ip() {
    verdicts_are_right(SuiteMethod::Ip, SOME);
}

#[test]
#[ignore = "half a minute"]
fn all_by_bn() {
    verdicts_are_right(SuiteMethod::Bn, 1);
}

#[test]
#[ignore = "half a minute"]
fn all_by_ip() {
    verdicts_are_right(SuiteMethod::Ip, 1);
}
