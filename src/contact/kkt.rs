//! The error measure: how far a state is from the exact law, judged from `(u, p)` alone.
//!
//! It shares nothing with the solvers but the problem itself, in SI units: no `r`, no merit
//! function, no scaling. Every component is relative and unit-free. Forces are compared with the
//! largest external or contact force, displacements with the largest displacement or interference,
//! of the history so far: after full unloading there is nothing else to compare rounding with.

use serde::Serialize;

use super::coulomb::{positive, project};
use crate::problem::{ContactProblem, Increment, State};

/// What forces and displacements are compared with.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub struct KktScales {
    /// The largest external nodal force or contact force, N.
    pub force: f64,
    /// The largest displacement or interference, m.
    pub length: f64,
}

impl KktScales {
    /// The scales of a state that others came before.
    pub fn after(earlier: &KktScales, increment: &Increment<'_>, state: &State) -> Self {
        let scales = KktScales::new(increment, state);
        KktScales { force: scales.force.max(earlier.force), length: scales.length.max(earlier.length) }
    }

    /// The scales of a single state.
    pub fn new(increment: &Increment<'_>, state: &State) -> Self {
        let largest = |values: &[f64]| values.iter().fold(0.0_f64, |m, v| m.max(v.abs()));
        let interference = increment.gap.iter().fold(0.0_f64, |m, g| m.max(-g));
        KktScales {
            force: largest(increment.force).max(largest(&state.p_n)).max(largest(&state.p_t)),
            length: largest(&state.u).max(interference),
        }
    }

    /// `|value|` relative to the force scale; an error without any force is infinite.
    fn force(&self, value: f64) -> f64 {
        relative(value, self.force)
    }

    fn length(&self, value: f64) -> f64 {
        relative(value, self.length)
    }
}

fn relative(value: f64, scale: f64) -> f64 {
    if value == 0.0 { 0.0 } else { value.abs() / scale }
}

/// The violation of each law, the largest over all nodes.
#[derive(Debug, Clone, Copy, Default, PartialEq, Serialize)]
pub struct KktErrors {
    /// `|K u + Cᵀ p - f|`, relative to the force scale.
    pub equilibrium: f64,
    /// `(w_n - g)₊`, relative to the displacement scale.
    pub penetration: f64,
    /// `(-p_n)₊`, relative to the force scale.
    pub tension: f64,
    /// A pressure across a gap: the smaller of the two, each relative to its scale.
    pub complementarity: f64,
    /// `(|p_t| - μ p_n)₊`, relative to the force scale.
    pub cone: f64,
    /// A slip increment without full friction against it: the smaller of the slip and of what the
    /// force lacks to `±μ p_n` in the direction of the slip, each relative to its scale.
    pub dissipation: f64,
}

impl KktErrors {
    /// Measures `state` against the law of one increment, relative to `scales`.
    pub fn measure(problem: &ContactProblem, increment: &Increment<'_>, state: &State, scales: &KktScales) -> Self {
        let mut balance = vec![0.0; state.u.len()];
        problem.stiffness.mul(&state.u, &mut balance);
        problem.c_n.add_transposed(&state.p_n, &mut balance);
        problem.c_t.add_transposed(&state.p_t, &mut balance);
        let mut errors = KktErrors::default();
        for (sum, force) in balance.iter().zip(increment.force) {
            raise(&mut errors.equilibrium, scales.force(sum - force));
        }
        for i in 0..problem.contacts() {
            let (p_n, p_t, radius) = (state.p_n[i], state.p_t[i], problem.mu[i] * positive(state.p_n[i]));
            let distance = increment.gap[i] - problem.c_n.dot(i, &state.u);
            raise(&mut errors.penetration, scales.length(positive(-distance)));
            raise(&mut errors.tension, scales.force(positive(-p_n)));
            let (pressed, apart) = (scales.force(positive(p_n)), scales.length(positive(distance)));
            raise(&mut errors.complementarity, smaller(pressed, apart));
            raise(&mut errors.cone, scales.force(positive(p_t.abs() - radius)));
            if !problem.c_t.row(i).is_empty() {
                let slip = problem.c_t.dot(i, &state.u) - increment.w_t_last[i];
                // Judged from the nearest admissible force, so that the cone counts only once.
                let lacking = radius - project(p_t, radius) * slip.signum();
                raise(&mut errors.dissipation, smaller(scales.force(lacking), scales.length(slip)));
            }
        }
        errors
    }

    /// Every component with its name.
    pub fn components(&self) -> [(&'static str, f64); 6] {
        [
            ("equilibrium", self.equilibrium),
            ("penetration", self.penetration),
            ("tension", self.tension),
            ("complementarity", self.complementarity),
            ("cone", self.cone),
            ("dissipation", self.dissipation),
        ]
    }

    /// The name and value of the largest component; NaN is larger than anything.
    pub fn worst(&self) -> (&'static str, f64) {
        let [first, rest @ ..] = self.components();
        rest.into_iter().fold(first, |worst, next| if exceeds(next.1, worst.1) { next } else { worst })
    }
}

/// `max` and `min` that let NaN through: a NaN is a violation, not a missing value.
fn raise(worst: &mut f64, value: f64) {
    if exceeds(value, *worst) {
        *worst = value;
    }
}

fn smaller(a: f64, b: f64) -> f64 {
    if a.is_nan() || b.is_nan() { f64::NAN } else { a.min(b) }
}

fn exceeds(a: f64, b: f64) -> bool {
    !b.is_nan() && (a.is_nan() || a > b)
}

/// The equilibrium error that rounding the displacements to double precision makes, relative to the
/// force scale: `ε |K| |u| / F`. In slender bodies it is far above ε, and no solver can do better.
pub fn rounding_level(problem: &ContactProblem, state: &State, scales: &KktScales) -> f64 {
    let mut sums = vec![0.0; state.u.len()];
    for (row, column, value) in problem.stiffness.entries() {
        sums[row] += (value * state.u[column]).abs();
    }
    f64::EPSILON * sums.into_iter().fold(0.0, f64::max) / scales.force
}

/// What a contact node does at the end of an increment.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
#[serde(rename_all = "lowercase")]
pub enum ContactStatus {
    /// Apart from the obstacle.
    Open,
    /// In contact without slip.
    Stick,
    /// In contact and sliding; without friction every closed node counts as sliding.
    Slip,
}

/// The status of every contact node, from the state alone: of each complementary pair (pressure
/// and distance; friction reserve and slip) the relatively larger one decides.
pub fn statuses(
    problem: &ContactProblem,
    increment: &Increment<'_>,
    state: &State,
    scales: &KktScales,
) -> Vec<ContactStatus> {
    let status = |i: usize| {
        let distance = increment.gap[i] - problem.c_n.dot(i, &state.u);
        if scales.force(positive(state.p_n[i])) <= scales.length(positive(distance)) {
            return ContactStatus::Open;
        }
        let reserve = positive(problem.mu[i] * state.p_n[i] - state.p_t[i].abs());
        let slip = problem.c_t.dot(i, &state.u) - increment.w_t_last[i];
        if scales.force(reserve) > scales.length(slip) { ContactStatus::Stick } else { ContactStatus::Slip }
    };
    (0..problem.contacts()).map(status).collect()
}
