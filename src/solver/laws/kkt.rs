//! The error measure: the distance of a state from the exact law, judged from `(u, p)` alone.
//!
//! It shares nothing with the solvers but the problem itself, in SI units: no `r`, no merit function, no scaling.
//! Every component is relative and unit-free. Forces are compared with the largest external or contact force of the
//! history so far, displacements with the largest displacement or interference: after full unloading there is no
//! other scale for rounding.

use serde::{Deserialize, Serialize};

use super::coulomb::{direction, length, positive, project};
use crate::algebra::linear::LinearError;
use crate::solver::problem::error::{expect_finite, expect_value};
use crate::solver::problem::{ContactProblem, Increment, ProblemError, State};

/// The scales for forces and displacements.
#[derive(Debug, Clone, Copy, Default, PartialEq, Serialize, Deserialize)]
pub struct KktScales {
    /// The largest external nodal force or contact force, N.
    pub force: f64,
    /// The largest displacement or interference, or the largest external nodal force divided by the largest diagonal
    /// entry of the stiffness if that is larger, since smaller motions have no effect. (In a sticking body,
    /// displacements may be mere rounding.) m.
    pub length: f64,
}

/// The number of roundings, relative to the terms, in a gap after a long motion or in a sum of loads.
const TERM_ROUNDINGS: f64 = 16.0;

impl KktScales {
    /// Returns the scales of a state after those of `earlier` states.
    pub fn after(earlier: &KktScales, problem: &ContactProblem, increment: &Increment<'_>, state: &State) -> Self {
        earlier.with_load(problem, increment).with_state(state)
    }

    /// Returns the scales of a single state.
    pub fn new(problem: &ContactProblem, increment: &Increment<'_>, state: &State) -> Self {
        KktScales::default().with_load(problem, increment).with_state(state)
    }

    /// Raises the scales to the external forces and interferences of `increment`.
    #[must_use]
    pub fn with_load(self, problem: &ContactProblem, increment: &Increment<'_>) -> Self {
        let interference = increment.gap.iter().fold(0.0_f64, |m, g| m.max(-g));
        let force = largest(increment.force);
        let stiffest = problem.stiffest();
        let least = if stiffest > 0.0 { force / stiffest } else { 0.0 };
        KktScales { force: self.force.max(force), length: self.length.max(interference).max(least) }
    }

    /// Raises the scales to the contact forces and displacements of `state`.
    #[must_use]
    pub fn with_state(self, state: &State) -> Self {
        KktScales {
            force: state
                .p_t
                .iter()
                .zip(&state.p_o)
                .fold(self.force.max(largest(&state.p_n)), |m, (t, o)| m.max(length([*t, *o]))),
            length: self.length.max(largest(&state.u)),
        }
    }

    /// Raises the scales so that rounding in differences of terms of these sizes (N and m) stays below `tolerance`.
    #[must_use]
    pub(crate) fn above_rounding(self, tolerance: f64, force: f64, length: f64) -> Self {
        let known = (TERM_ROUNDINGS * f64::EPSILON / tolerance).min(1.0);
        KktScales { force: self.force.max(known * force), length: self.length.max(known * length) }
    }

    /// Checks that the scales are finite and nonnegative.
    fn check(&self) -> Result<(), ProblemError> {
        for (array, value) in [("scales.force", self.force), ("scales.length", self.length)] {
            expect_value(array, value, "finite, and 0 or more", |scale| scale >= 0.0 && scale.is_finite())?;
        }
        Ok(())
    }

    /// Returns `|value|` relative to the force scale; infinite if the scale is 0 and the value is not.
    fn force(&self, value: f64) -> f64 {
        relative(value, self.force)
    }

    fn length(&self, value: f64) -> f64 {
        relative(value, self.length)
    }
}

fn largest(values: &[f64]) -> f64 {
    values.iter().fold(0.0, |m, v| m.max(v.abs()))
}

fn relative(value: f64, scale: f64) -> f64 {
    if value == 0.0 { 0.0 } else { value.abs() / scale }
}

/// The largest violation of each law over all nodes.
#[derive(Debug, Clone, Copy, Default, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct KktErrors {
    /// `|K u + Cᵀ p - f|`, relative to the force scale.
    pub equilibrium: f64,
    /// `(w_n - g)₊`, relative to the displacement scale.
    pub penetration: f64,
    /// `(-p_n)₊`, relative to the force scale.
    pub tension: f64,
    /// The pressure across a gap: the smaller of pressure and gap, each relative to its scale.
    pub complementarity: f64,
    /// `(|p_T| - μ p_n)₊`, relative to the force scale.
    pub cone: f64,
    /// A slip increment without full friction against it: the smaller of the slip and the distance of the force from
    /// `μ p_n` in the direction of the slip, each relative to its scale.
    pub dissipation: f64,
}

/// A law that a state may violate, a component of [`KktErrors`].
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(rename_all = "lowercase")]
pub enum Law {
    /// Equilibrium (15).
    Equilibrium,
    /// No penetration (4).
    Penetration,
    /// No tension (4).
    Tension,
    /// No pressure across a gap (4).
    Complementarity,
    /// Coulomb's cone (8).
    Cone,
    /// Slip against full friction (8).
    Dissipation,
}

/// The violation of one law at one place.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct Violation {
    /// The violated law.
    pub law: Law,
    /// The index of the displacement for equilibrium, of the contact node for the other laws.
    pub place: usize,
    /// The error, as in [`KktErrors`].
    pub error: f64,
}

impl Law {
    const ALL: [Law; 6] =
        [Law::Equilibrium, Law::Penetration, Law::Tension, Law::Complementarity, Law::Cone, Law::Dissipation];

    /// Returns the name of the law in reports.
    pub fn name(self) -> &'static str {
        match self {
            Law::Equilibrium => "equilibrium",
            Law::Penetration => "penetration",
            Law::Tension => "tension",
            Law::Complementarity => "complementarity",
            Law::Cone => "cone",
            Law::Dissipation => "dissipation",
        }
    }
}

impl Violation {
    /// Returns the largest violation in `state`.
    ///
    /// # Errors
    /// If a rank that shares the stiffness has failed, here and in all measures of equilibrium.
    pub(crate) fn worst(
        problem: &ContactProblem,
        increment: &Increment<'_>,
        state: &State,
        scales: &KktScales,
    ) -> Result<Self, LinearError> {
        let mut worst = Violation { law: Law::Equilibrium, place: 0, error: 0.0 };
        let imbalance = problem.imbalance(increment.force, state)?;
        violations(problem, increment, state, &imbalance, scales, |law, place, error| {
            if exceeds(error, worst.error) {
                worst = Violation { law, place, error };
            }
        });
        Ok(worst)
    }
}

/// Visits the violation of every law at every place; `imbalance` is [`ContactProblem::imbalance`] of the state.
fn violations(
    problem: &ContactProblem,
    increment: &Increment<'_>,
    state: &State,
    imbalance: &[f64],
    scales: &KktScales,
    mut visit: impl FnMut(Law, usize, f64),
) {
    for (dof, imbalance) in imbalance.iter().enumerate() {
        visit(Law::Equilibrium, dof, scales.force(*imbalance));
    }
    for i in 0..problem.contacts() {
        let (p_n, p_t, radius) = (state.p_n[i], friction(state, i), increment.mu[i] * positive(state.p_n[i]));
        let distance = increment.gap[i] - problem.c_n().dot(i, &state.u);
        visit(Law::Penetration, i, scales.length(positive(-distance)));
        visit(Law::Tension, i, scales.force(positive(-p_n)));
        let (pressed, apart) = (scales.force(positive(p_n)), scales.length(positive(distance)));
        visit(Law::Complementarity, i, smaller(pressed, apart));
        visit(Law::Cone, i, scales.force(positive(length(p_t) - radius)));
        if problem.tangential_maps().iter().any(|map| !map.row(i).is_empty()) {
            let slip = problem.slip(increment, state, i);
            // Judged from the nearest admissible force, so that the cone counts only once. The distance between the
            // vectors is used, not that between their dissipations, which has zero slope where they are parallel.
            let (full, there) = (direction(slip).map(|n| radius * n), project(p_t, radius));
            let lacking = length([full[0] - there[0], full[1] - there[1]]);
            visit(Law::Dissipation, i, smaller(scales.force(lacking), scales.length(length(slip))));
        }
    }
}

/// Returns `p_T` of node `i`.
fn friction(state: &State, i: usize) -> [f64; 2] {
    [state.p_t[i], state.p_o[i]]
}

/// Returns the error measure of a state whose [`ContactProblem::imbalance`] is known. Near the `tolerance` the
/// rounding of the imbalance itself would matter, so there it is computed in twice the precision.
pub(crate) fn judge(
    problem: &ContactProblem,
    increment: &Increment<'_>,
    state: &State,
    imbalance: &[f64],
    scales: &KktScales,
    tolerance: f64,
) -> Result<KktErrors, LinearError> {
    let errors = KktErrors::of_balance(problem, increment, state, imbalance, scales);
    let near = 0.1 * tolerance..10.0 * tolerance;
    if !state.u_rest.is_empty() || !near.contains(&errors.equilibrium) {
        return Ok(errors);
    }
    let exact = State { u_rest: vec![0.0; state.u.len()], ..state.clone() };
    KktErrors::of_state(problem, increment, &exact, scales)
}

impl KktErrors {
    /// Measures `state`, from whatever source, against the law of one increment, relative to `scales`.
    ///
    /// # Errors
    /// If an array of `increment` or `state` has another length than `problem` needs, if the `scales` are invalid, or
    /// if a rank that shares the stiffness has failed.
    pub fn measure(
        problem: &ContactProblem,
        increment: &Increment<'_>,
        state: &State,
        scales: &KktScales,
    ) -> Result<Self, ProblemError> {
        increment.check(problem)?;
        state.check(problem)?;
        scales.check()?;
        Ok(Self::of_state(problem, increment, state, scales)?)
    }

    fn of_state(
        problem: &ContactProblem,
        increment: &Increment<'_>,
        state: &State,
        scales: &KktScales,
    ) -> Result<Self, LinearError> {
        let imbalance = problem.imbalance(increment.force, state)?;
        Ok(Self::of_balance(problem, increment, state, &imbalance, scales))
    }

    fn of_balance(
        problem: &ContactProblem,
        increment: &Increment<'_>,
        state: &State,
        imbalance: &[f64],
        scales: &KktScales,
    ) -> Self {
        let mut errors = KktErrors::default();
        violations(problem, increment, state, imbalance, scales, |law, _, error| raise(errors.of_mut(law), error));
        errors
    }

    /// Returns the larger of both in every component.
    #[must_use]
    pub fn max(mut self, other: &KktErrors) -> Self {
        for law in Law::ALL {
            raise(self.of_mut(law), other.of(law));
        }
        self
    }

    /// Returns the component of a law.
    pub fn of(&self, law: Law) -> f64 {
        let mut errors = *self;
        *errors.of_mut(law)
    }

    fn of_mut(&mut self, law: Law) -> &mut f64 {
        match law {
            Law::Equilibrium => &mut self.equilibrium,
            Law::Penetration => &mut self.penetration,
            Law::Tension => &mut self.tension,
            Law::Complementarity => &mut self.complementarity,
            Law::Cone => &mut self.cone,
            Law::Dissipation => &mut self.dissipation,
        }
    }

    /// Returns every component with its name.
    pub fn components(&self) -> [(&'static str, f64); 6] {
        Law::ALL.map(|law| (law.name(), self.of(law)))
    }

    /// Returns the name and value of the largest component; NaN counts as the largest.
    pub fn worst(&self) -> (&'static str, f64) {
        let [first, rest @ ..] = self.components();
        rest.into_iter().fold(first, |worst, next| if exceeds(next.1, worst.1) { next } else { worst })
    }
}

/// Raises `worst` to `value`. NaN is kept, since it is a violation and not a missing value.
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

/// Returns the equilibrium error due to rounding the displacements to double precision, relative to the force scale:
/// `ε |K| |u| / F`. In slender bodies it is far above ε, and no solver can do better. It is
/// 0 without any force.
pub(crate) fn rounding_level(problem: &ContactProblem, state: &State, scales: &KktScales) -> Result<f64, LinearError> {
    if scales.force == 0.0 {
        return Ok(0.0);
    }
    let sums = problem.stiffness().sizes(&state.u)?;
    Ok(f64::EPSILON * sums.into_iter().fold(0.0, f64::max) / scales.force)
}

/// Returns `true` if the `errors` of a state exceed ten times its [`rounding_level`], or one of both is NaN.
pub(crate) fn is_more_than_rounding(
    errors: &KktErrors,
    problem: &ContactProblem,
    state: &State,
    scales: &KktScales,
) -> Result<bool, LinearError> {
    let (error, rounding) = (errors.worst().1, 10.0 * rounding_level(problem, state, scales)?);
    Ok(error > rounding || error.is_nan() || rounding.is_nan())
}

/// The status of a contact node at the end of an increment.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum ContactStatus {
    /// Apart from the obstacle.
    Open,
    /// In contact without slip.
    Stick,
    /// In contact and sliding; without friction every closed node counts as sliding.
    Slip,
}

/// Returns the status of every contact node, from the state alone: the relatively larger member of each complementary
/// pair (pressure and distance; friction reserve and slip) decides.
///
/// # Errors
/// If an array of `increment` or `state` has another length than `problem` needs, if a number of `state` is not
/// finite, or if the `scales` are invalid.
pub fn statuses(
    problem: &ContactProblem,
    increment: &Increment<'_>,
    state: &State,
    scales: &KktScales,
) -> Result<Vec<ContactStatus>, ProblemError> {
    increment.check(problem)?;
    state.check(problem)?;
    for (array, values) in [("u", &state.u), ("p_t", &state.p_t), ("p_o", &state.p_o), ("p_n", &state.p_n)] {
        expect_finite(array, values)?;
    }
    scales.check()?;
    Ok(statuses_of(problem, increment, state, scales))
}

/// Computes [`statuses`] of arrays of the right lengths.
pub(crate) fn statuses_of(
    problem: &ContactProblem,
    increment: &Increment<'_>,
    state: &State,
    scales: &KktScales,
) -> Vec<ContactStatus> {
    let status = |i: usize| {
        let distance = increment.gap[i] - problem.c_n().dot(i, &state.u);
        if scales.force(positive(state.p_n[i])) <= scales.length(positive(distance)) {
            return ContactStatus::Open;
        }
        let reserve = positive(increment.mu[i] * state.p_n[i] - length(friction(state, i)));
        let slip = length(problem.slip(increment, state, i));
        if scales.force(reserve) > scales.length(slip) { ContactStatus::Stick } else { ContactStatus::Slip }
    };
    (0..problem.contacts()).map(status).collect()
}
