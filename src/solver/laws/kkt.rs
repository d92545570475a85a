//! The error measure: the distance of a state from the exact law, judged from `(u, p)` alone.
//!
//! It shares nothing with the solvers but the problem itself: no `r`, no merit function, no scaling. Every error is
//! relative to the size of what the law compares, in the natural units of the problem ([`NaturalUnits`]), and without
//! a unit. No number elsewhere, however large, makes a violation small: not that of a row that no law compares it with,
//! not that of a part of the body that neither elasticity nor contact connects, not that of an earlier increment.

use serde::{Deserialize, Serialize};

use super::coulomb::{direction, length, positive, project};
use crate::algebra::linear::Computed;
use crate::algebra::vector::dot;
use crate::base::displayed_as_written;
use crate::solver::problem::error::{expect_each, expect_finite, expect_length};
use crate::solver::problem::{ContactProblem, Increment, NaturalUnits, ProblemError, State};

/// The largest terms in each part of the body: those of the earlier increments have left their rounding in the present
/// one, and after full unloading there is no other scale.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize)]
pub struct KktScales(Vec<Terms>);

/// The largest terms in a part of the body, √J.
#[derive(Debug, Clone, Copy, Default, PartialEq, Serialize, Deserialize)]
struct Terms {
    /// `|K| |u| + |C|ᵀ |p| + |f|`, of the balance of forces.
    balance: f64,
    /// `k (|C_n| |u| + |g|)`, of the gaps.
    gaps: f64,
}

/// The rounding that is left of the largest terms. Forces below it are no forces.
pub(crate) const ROUNDING: f64 = 16.0 * f64::EPSILON;

impl KktScales {
    /// Creates the scales from the values of [`KktScales::values`].
    ///
    /// # Errors
    /// If a value is negative or not finite, or their number is odd.
    pub fn new(values: &[f64]) -> Result<Self, ProblemError> {
        expect_each("scales", values, "finite, and 0 or more", |scale| scale >= 0.0 && scale.is_finite())?;
        expect_length("scales", 2 * (values.len() / 2), values.len(), "two for each part of the body")?;
        Ok(KktScales(values.chunks(2).map(|pair| Terms { balance: pair[0], gaps: pair[1] }).collect()))
    }

    /// Returns two values for each part of the body, the largest terms of the balance of forces and of the gaps (√J);
    /// none before the first increment.
    pub fn values(&self) -> Vec<f64> {
        self.0.iter().flat_map(|terms| [terms.balance, terms.gaps]).collect()
    }

    /// Returns the scales of `state` and of the `earlier` states.
    ///
    /// # Errors
    /// As [`KktErrors::measure`].
    pub fn after(
        earlier: &KktScales,
        problem: &ContactProblem,
        increment: &Increment<'_>,
        state: &State,
    ) -> Result<Self, ProblemError> {
        increment.check(problem)?;
        state.check(problem)?;
        earlier.check(problem)?;
        Ok(earlier.with_terms(problem, &terms(problem, increment, state)?).with_gaps(problem, increment, &state.u))
    }

    /// Checks that there are values for each part of the body, or none.
    fn check(&self, problem: &ContactProblem) -> Result<(), ProblemError> {
        let parts = if self.0.is_empty() { 0 } else { problem.natural().parts };
        expect_length("scales", 2 * parts, 2 * self.0.len(), "two for each part of the body")
    }

    /// Raises the scales to terms of the balance of forces, n_u, N.
    #[must_use]
    pub(crate) fn with_terms(&self, problem: &ContactProblem, terms: &[f64]) -> Self {
        let NaturalUnits { part, displacement, parts, .. } = problem.natural();
        let mut scales = self.0.clone();
        scales.resize(*parts, Terms::default());
        for ((&part, unit), term) in part.iter().zip(displacement).zip(terms) {
            scales[part].balance = scales[part].balance.max(term / unit);
        }
        KktScales(scales)
    }

    /// Raises the scales to the terms of the gaps at displacements `u`.
    #[must_use]
    pub(crate) fn with_gaps(mut self, problem: &ContactProblem, increment: &Increment<'_>, u: &[f64]) -> Self {
        let NaturalUnits { contact_part, contact, .. } = problem.natural();
        for (i, (&part, unit)) in contact_part.iter().zip(contact).enumerate() {
            let moved: f64 = problem.c_n().row(i).iter().map(|&(dof, c)| (c * u[dof]).abs()).sum();
            self.0[part].gaps = self.0[part].gaps.max((moved + increment.gap[i].abs()) * unit);
        }
        self
    }
}

/// Returns `|K| |u| + |C|ᵀ |p| + |f|`, N, the terms of the balance of forces.
fn terms(problem: &ContactProblem, increment: &Increment<'_>, state: &State) -> Computed<Vec<f64>> {
    let mut terms = problem.stiffness().sizes(&state.u)?;
    for (map, forces) in [(problem.c_n(), &state.p_n), (problem.c_t(), &state.p_t), (problem.c_o(), &state.p_o)] {
        for (i, p) in forces.iter().enumerate().filter(|(_, p)| **p != 0.0) {
            map.row(i).iter().for_each(|&(dof, c)| terms[dof] += (c * p).abs());
        }
    }
    terms.iter_mut().zip(increment.force).for_each(|(term, force)| *term += force.abs());
    Ok(terms)
}

/// A sum of forces along a rigid mode up to this share of them may be the rounding of displacements, which the imbalance judges.
/// Above it the forces themselves are nothing but that rounding.
const DRIVEN: f64 = 1e-4;

/// Returns the sum of the external and contact forces along each rigid mode `r`, `rᵀ (f - Cᵀ p)`, relative to the sizes of its
/// terms, or to the `least` size of one of them. The imbalance hides this sum where `K u` is the rounding of large displacements.
fn driven(
    problem: &ContactProblem,
    increment: &Increment<'_>,
    state: &State,
    least: impl Fn(usize) -> f64,
) -> Vec<f64> {
    let (mut forces, mut sizes): (Vec<f64>, Vec<f64>) = increment.force.iter().map(|f| (*f, f.abs())).unzip();
    for (map, p) in [(problem.c_n(), &state.p_n), (problem.c_t(), &state.p_t), (problem.c_o(), &state.p_o)] {
        for (i, p) in p.iter().enumerate().filter(|(_, p)| **p != 0.0) {
            for &(dof, c) in map.row(i) {
                forces[dof] -= c * p;
                sizes[dof] += (c * p).abs();
            }
        }
    }
    let along = |mode: &Vec<f64>| {
        let size: f64 = mode.iter().zip(&sizes).map(|(r, size)| (r * size).abs()).sum();
        let size = mode.iter().enumerate().fold(size, |most, (dof, r)| most.max((r * least(dof)).abs()));
        let error = relative(dot(mode, &forces), size);
        if error > DRIVEN { error } else { 0.0 }
    };
    problem.rigid_modes().iter().map(along).collect()
}

fn relative(value: f64, scale: f64) -> f64 {
    if value == 0.0 { 0.0 } else { value.abs() / scale }
}

/// The largest violation of each law over all nodes.
#[derive(Debug, Clone, Copy, Default, PartialEq, Serialize, Deserialize, schemars::JsonSchema)]
pub struct KktErrors {
    /// `|K u + Cᵀ p - f|` of a displacement, relative to the largest force of its part, or to its terms if they are
    /// smaller; and `|rᵀ (f - Cᵀ p)|` of a rigid mode, relative to the sizes of its terms, if it is more than 1e-4.
    pub equilibrium: f64,
    /// `k (w_n - g)₊`, with the stiffness `k` of the contact node: the force that would push it out. This one and those
    /// below are relative to the largest contact force of the part.
    pub penetration: f64,
    /// `(-p_n)₊`.
    pub tension: f64,
    /// The pressure across a gap: the smaller of `p_n` and `k (g - w_n)`.
    pub complementarity: f64,
    /// `(|p_T| - μ p_n)₊`.
    pub cone: f64,
    /// A slip increment without full friction against it: the smaller of `k |w_T - w̄_T|` and the distance of the force
    /// from `μ p_n` in the direction of the slip.
    pub dissipation: f64,
}

/// A law that a state may violate, a component of [`KktErrors`].
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, schemars::JsonSchema)]
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
}

displayed_as_written!(Law);

/// A state, with all that its errors are relative to.
pub(crate) struct Judgement<'a> {
    problem: &'a ContactProblem,
    increment: &'a Increment<'a>,
    state: &'a State,
    imbalance: Vec<f64>,
    terms: Vec<f64>,
    scales: KktScales,
    /// The parts without forces but the rounding of the earlier terms, or of the terms of the loads.
    is_unloaded: Vec<bool>,
    largest: Vec<Largest>,
    /// The sums of forces along the rigid modes, which are 0 by (15), relative to their sizes.
    driven: Vec<f64>,
}

/// The largest of each kind in a part of the body.
#[derive(Debug, Clone, Copy, Default)]
struct Largest {
    /// The external forces, √J.
    load: f64,
    /// The contact forces of closed nodes, √J.
    contact: f64,
    /// The contact forces of open nodes, which are the rest of an iteration.
    open: f64,
    /// The forces that would push contact nodes out, √J.
    penetration: f64,
    /// The external and contact forces on displacements, N.
    force: f64,
}

impl<'a> Judgement<'a> {
    /// Prepares the errors of a state whose [`ContactProblem::imbalance`] is known, after increments with the scales
    /// `earlier`.
    ///
    /// # Errors
    /// If a rank that shares the stiffness has failed, here and in all measures of equilibrium.
    pub(crate) fn new(
        problem: &'a ContactProblem,
        increment: &'a Increment<'a>,
        state: &'a State,
        imbalance: Vec<f64>,
        earlier: &KktScales,
    ) -> Computed<Self> {
        let NaturalUnits { part, contact_part, parts, displacement, contact: unit, .. } = problem.natural();
        let terms = terms(problem, increment, state)?;
        let scales = earlier.with_terms(problem, &terms).with_gaps(problem, increment, &state.u);
        let mut largest = vec![Largest::default(); *parts];
        for (i, (&part, unit)) in contact_part.iter().zip(unit).enumerate() {
            let Largest { contact, open, penetration, force, .. } = &mut largest[part];
            let pressed = state.p_n[i].abs().max(length(friction(state, i)));
            let apart = distance(problem, increment, state, i) * unit;
            let kind = if is_open(state.p_n[i] / unit, apart) { open } else { contact };
            *kind = kind.max(pressed / unit);
            *penetration = penetration.max(positive(-apart));
            let row = problem.c_n().row(i).iter().map(|(_, c)| c * c).sum::<f64>().sqrt();
            *force = force.max(row * pressed.max(positive(-apart) * unit));
        }
        for ((&part, unit), f) in part.iter().zip(displacement).zip(increment.force) {
            let Largest { load, force, .. } = &mut largest[part];
            *load = load.max(f.abs() / unit);
            *force = force.max(f.abs());
        }
        // The terms of the state itself do not count: those of a body that flies away are as large as one likes.
        let mut earlier: Vec<f64> = earlier.0.iter().map(|terms| terms.balance).collect();
        earlier.resize(*parts, 0.0);
        let is_unloaded = (0..*parts).map(|part| {
            let Largest { load, contact, open, penetration, .. } = largest[part];
            let Terms { balance, gaps } = scales.0[part];
            load.max(contact).max(open) <= ROUNDING * earlier[part] && penetration <= ROUNDING * balance.max(gaps)
        });
        let is_unloaded: Vec<bool> = is_unloaded.collect();
        let least = |dof: usize| {
            let Terms { balance, gaps } = scales.0[part[dof]];
            if is_unloaded[part[dof]] { balance.max(gaps) * displacement[dof] } else { largest[part[dof]].force }
        };
        let driven = driven(problem, increment, state, least);
        Ok(Judgement { problem, increment, state, imbalance, terms, scales, is_unloaded, largest, driven })
    }

    /// Prepares the errors of a state. Near the `tolerance` the rounding of the imbalance itself would matter, so there
    /// it is computed in twice the precision.
    pub(crate) fn near(
        problem: &'a ContactProblem,
        increment: &'a Increment<'a>,
        state: &'a State,
        earlier: &KktScales,
        tolerance: f64,
    ) -> Computed<Self> {
        let imbalance = problem.imbalance(increment.force, state)?;
        let judgement = Self::new(problem, increment, state, imbalance, earlier)?;
        let near = 0.1 * tolerance..10.0 * tolerance;
        if !state.u_rest.is_empty() || !near.contains(&judgement.errors().equilibrium) {
            return Ok(judgement);
        }
        let exact = State { u_rest: vec![0.0; state.u.len()], ..state.clone() };
        Ok(Judgement { imbalance: problem.imbalance(increment.force, &exact)?, ..judgement })
    }

    /// Returns the scales of this state and the earlier ones.
    pub(crate) fn scales(self) -> KktScales {
        self.scales
    }

    /// Returns the largest terms of a part if it is unloaded.
    fn rounded(&self, part: usize) -> Option<f64> {
        let Terms { balance, gaps } = self.scales.0[part];
        self.is_unloaded[part].then(|| balance.max(gaps))
    }

    /// Returns a force on displacement `dof`, N, relative to the largest force of its part, or to the terms of the row if
    /// they are smaller, unless it is the rounding of the largest terms.
    fn balance(&self, dof: usize, value: f64) -> f64 {
        let NaturalUnits { part, displacement, .. } = self.problem.natural();
        let (part, unit) = (part[dof], displacement[dof]);
        let (largest, terms) = (self.largest[part].force, self.scales.0[part].balance);
        match self.rounded(part) {
            Some(terms) => relative(value / unit, terms),
            None if value.abs() <= ROUNDING * terms * unit => relative(value, largest),
            None => relative(value, largest.min(self.terms[dof])),
        }
    }

    /// Returns what contact forces of a part are relative to, √J: the largest of closed nodes, or the largest terms of
    /// the balance or of the gaps if all are the rounding of these. If no node is closed, it is the largest load, or force
    /// of an open node.
    fn contact_scale(&self, part: usize) -> f64 {
        let Largest { load, contact, open, penetration, .. } = self.largest[part];
        let (closed, Terms { balance, gaps }) = (contact.max(penetration), self.scales.0[part]);
        let own = match closed.max(open) {
            largest if largest <= ROUNDING * balance.max(gaps) => balance.max(gaps),
            _ if closed == 0.0 => load.max(open),
            _ => closed,
        };
        self.rounded(part).unwrap_or(own)
    }

    /// Returns the error of penetration of contact node `i`.
    pub(crate) fn penetration(&self, i: usize) -> f64 {
        let apart = distance(self.problem, self.increment, self.state, i);
        self.motion(i, positive(-apart))
    }

    /// Returns a contact force of node `i` relative to the largest.
    fn force(&self, i: usize, value: f64) -> f64 {
        let NaturalUnits { contact_part, contact, .. } = self.problem.natural();
        relative(value / contact[i], self.contact_scale(contact_part[i]))
    }

    /// Returns a motion of node `i` as the force against it, relative to the largest contact force.
    fn motion(&self, i: usize, value: f64) -> f64 {
        self.force(i, value * self.problem.natural().contact_stiffness[i])
    }

    /// Visits the violation of every law at every place.
    fn visit(&self, mut visit: impl FnMut(Law, usize, f64)) {
        let Judgement { problem, increment, state, .. } = *self;
        for (dof, imbalance) in self.imbalance.iter().enumerate() {
            visit(Law::Equilibrium, dof, self.balance(dof, *imbalance));
        }
        for (mode, error) in problem.rigid_modes().iter().zip(&self.driven) {
            let largest = (0..mode.len()).max_by(|a, b| mode[*a].abs().total_cmp(&mode[*b].abs()));
            visit(Law::Equilibrium, largest.unwrap_or(0), *error);
        }
        for i in 0..problem.contacts() {
            let (p_n, p_t, radius) = (state.p_n[i], friction(state, i), increment.mu[i] * positive(state.p_n[i]));
            let distance = distance(problem, increment, state, i);
            visit(Law::Penetration, i, self.motion(i, positive(-distance)));
            visit(Law::Tension, i, self.force(i, positive(-p_n)));
            let (pressed, apart) = (self.force(i, positive(p_n)), self.motion(i, positive(distance)));
            visit(Law::Complementarity, i, smaller(pressed, apart));
            visit(Law::Cone, i, self.force(i, positive(length(p_t) - radius)));
            if problem.tangential_maps().iter().any(|map| !map.row(i).is_empty()) {
                let slip = problem.slip(increment, state, i);
                // Judged from the nearest admissible force, so that the cone counts only once. The distance between
                // the vectors is used, not that between their dissipations, which has zero slope where they are
                // parallel.
                let (full, there) = (direction(slip).map(|n| radius * n), project(p_t, radius));
                let lacking = length([full[0] - there[0], full[1] - there[1]]);
                visit(Law::Dissipation, i, smaller(self.force(i, lacking), self.motion(i, length(slip))));
            }
        }
    }

    /// Returns the error measure.
    pub(crate) fn errors(&self) -> KktErrors {
        let mut errors = KktErrors::default();
        self.visit(|law, _, error| raise(errors.of_mut(law), error));
        errors
    }

    /// Returns the largest violation.
    pub(crate) fn worst(&self) -> Violation {
        let mut worst = Violation { law: Law::Equilibrium, place: 0, error: 0.0 };
        self.visit(|law, place, error| {
            if exceeds(error, worst.error) {
                worst = Violation { law, place, error };
            }
        });
        worst
    }

    /// Returns the equilibrium error due to rounding the displacements to double precision, `ε |K| |u|`. In slender
    /// bodies it is far above ε, and no solver can do better.
    pub(crate) fn rounding(&self) -> f64 {
        let level = |(dof, terms): (usize, &f64)| self.balance(dof, f64::EPSILON * terms);
        self.terms.iter().enumerate().map(level).fold(0.0, f64::max)
    }
}

/// Returns `g - w_n` of contact node `i`, m.
fn distance(problem: &ContactProblem, increment: &Increment<'_>, state: &State, i: usize) -> f64 {
    -problem.c_n().difference(i, &state.u, &state.u_rest, increment.gap[i])
}

/// Returns `p_T` of node `i`.
fn friction(state: &State, i: usize) -> [f64; 2] {
    [state.p_t[i], state.p_o[i]]
}

impl KktErrors {
    /// Measures `state`, from whatever source, against the law of one increment, after increments with the scales
    /// `earlier`.
    ///
    /// # Errors
    /// If an array of `increment`, `state` or `earlier` has another length than `problem` needs, or if a rank that
    /// shares the stiffness has failed.
    pub fn measure(
        problem: &ContactProblem,
        increment: &Increment<'_>,
        state: &State,
        earlier: &KktScales,
    ) -> Result<Self, ProblemError> {
        increment.check(problem)?;
        state.check(problem)?;
        earlier.check(problem)?;
        let imbalance = problem.imbalance(increment.force, state)?;
        Ok(Judgement::new(problem, increment, state, imbalance, earlier)?.errors())
    }

    /// Returns the larger of both in every component.
    #[must_use]
    pub fn max(mut self, other: &KktErrors) -> Self {
        for (law, error) in other.components() {
            raise(self.of_mut(law), error);
        }
        self
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

    /// Returns every component with its law.
    pub fn components(&self) -> [(Law, f64); 6] {
        let mut errors = *self;
        Law::ALL.map(|law| (law, *errors.of_mut(law)))
    }

    /// Returns the law and value of the largest component; NaN counts as the largest.
    pub fn worst(&self) -> (Law, f64) {
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

/// Returns the status of every contact node, from the state alone: the larger member of each complementary pair (`p_n`
/// and `k (g - w_n)`; the friction reserve and `k |w_T - w̄_T|`, with the stiffness `k` of the node) decides.
///
/// # Errors
/// If an array of `increment` or `state` has another length than `problem` needs, or if a number of `state` is not
/// finite.
pub fn statuses(
    problem: &ContactProblem,
    increment: &Increment<'_>,
    state: &State,
) -> Result<Vec<ContactStatus>, ProblemError> {
    increment.check(problem)?;
    state.check(problem)?;
    for (array, values) in [("u", &state.u), ("p_t", &state.p_t), ("p_o", &state.p_o), ("p_n", &state.p_n)] {
        expect_finite(array, values)?;
    }
    Ok(statuses_of(problem, increment, state))
}

/// Returns `true` if a node with this normal force, and this force as its distance, is open.
fn is_open(p_n: f64, apart: f64) -> bool {
    positive(p_n) <= positive(apart)
}

/// Computes [`statuses`] of arrays of the right lengths.
pub(crate) fn statuses_of(problem: &ContactProblem, increment: &Increment<'_>, state: &State) -> Vec<ContactStatus> {
    let status = |(i, k): (usize, &f64)| {
        if is_open(state.p_n[i], k * distance(problem, increment, state, i)) {
            return ContactStatus::Open;
        }
        let reserve = positive(increment.mu[i] * state.p_n[i] - length(friction(state, i)));
        let slip = length(problem.slip(increment, state, i));
        if reserve > k * slip { ContactStatus::Stick } else { ContactStatus::Slip }
    };
    problem.contact_stiffness().iter().enumerate().map(status).collect()
}
