//! BN along a history. Every increment starts from the last solution; with default constants, on the tangent there.

use super::increment_error::{ErrorEquations, IncrementErrors, Rate};
use super::method::Method;
use super::saved::{Snapshot, take_over};
use super::settings::HistorySettings;
use super::task::{IncrementSolver, Observe, Task};
use crate::algebra::linear::{Computed, RefinedSolver, SystemMatrix};
use crate::solver::formulation::Bdiff;
use crate::solver::laws::coulomb::TangentialCase;
use crate::solver::loading::Loading;
use crate::solver::newton::{Armijo, Bn, MethodResult, StopCriterion, Termination};
use crate::solver::problem::{ContactProblem, State};

/// The paper's stopping test `Theta ≤ ε`, a sum of N² and Pa².
const PAPER_MERIT: f64 = 1e-2;

/// The paper's normal stress in every contact node at the start, Pa; ten times this with 100 or more contact nodes.
const PAPER_PRESSURE: f64 = 1e6;

/// BN with its starts in a history.
pub(super) struct BnMethod {
    pub formulation: Bdiff,
    pub bn: Bn,
    /// `true` if the error measure stops the iteration and the forces that would clamp the nodes start the first increment,
    /// `false` if the paper's merit and pressure do.
    measured: bool,
    /// `true` if the nodes on which the body comes to rest start closed.
    closes: bool,
    z: Vec<f64>,
    /// The low-order part of `z`.
    z_lo: Vec<f64>,
    /// The end of the last increment, if it is measured and has been solved.
    last: Option<Vec<f64>>,
    /// The state on the tangent from which the last increment started, if it did.
    ahead: Option<Vec<f64>>,
    /// The estimate of the time-step error, if there is friction.
    errors: Option<IncrementErrors>,
    /// The initial rate of the last increment.
    rate: Option<Rate>,
}

impl BnMethod {
    /// Creates BN with the constants of the paper if the method is `PaperBn`, and else without tuning.
    pub(super) fn new(problem: &ContactProblem, loading: &Loading, history: &HistorySettings) -> Self {
        let measured = history.method != Method::PaperBn;
        let armijo = if measured { Armijo::HALVING } else { Armijo::PAPER };
        let formulation = Bdiff::new(problem, history.scaling, &history.conventions);
        let idle = loading.largest_force() == 0.0 && loading.largest_interference() == 0.0;
        let p_n = match problem.weight() {
            Some(l) if !measured && !idle => {
                let pressure = if l.len() < 100 { PAPER_PRESSURE } else { 10.0 * PAPER_PRESSURE };
                l.iter().map(|l| l * pressure).collect()
            }
            _ => vec![0.0; problem.contacts()],
        };
        let z = formulation.layout().packed(&State { p_n, ..State::zero(problem) }, &history.scaling);
        let estimates = history.estimates_error.then(|| loading.gaps_at(0.0));
        BnMethod {
            errors: estimates.and_then(|gaps| IncrementErrors::new(problem, &formulation, &gaps)),
            bn: Bn::new(armijo, history.max_iterations, formulation.unknowns()),
            formulation,
            measured,
            closes: !problem.rigid_modes().is_empty(),
            z_lo: vec![0.0; z.len()],
            z,
            last: None,
            ahead: None,
            rate: None,
        }
    }

    /// Takes the data of an increment, with the rate of the solution at its start; on the tangent there, if nothing has
    /// changed the solution `from` since the last increment ended there.
    pub(super) fn begin(&mut self, task: &Task<'_>, from: Option<&[f64]>, linear: &mut RefinedSolver) -> Computed<()> {
        let BnMethod { formulation, bn, errors, z, .. } = self;
        formulation.begin(task.increment, z);
        self.ahead = match from {
            Some(from) => ahead(formulation, bn, linear, from)?,
            None => None,
        };
        self.rate = match (errors, from, &self.ahead) {
            (Some(errors), Some(from), Some(ahead)) => {
                let change: Vec<f64> = ahead.iter().zip(from).map(|(ahead, z)| ahead - z).collect();
                Some(errors.rate_of(&change, task.increment, formulation))
            }
            (Some(errors), ..) => errors.rate(task.increment, &mut ErrorEquations { formulation, bn, linear })?,
            (None, ..) => None,
        };
        Ok(())
    }

    /// Updates the estimated time-step error after the increment that ends at the present solution.
    pub(super) fn follow(&mut self, problem: &ContactProblem, linear: &mut RefinedSolver) -> Computed<()> {
        let BnMethod { formulation, bn, z, errors, rate, .. } = self;
        let (rate, at) = (rate.take(), &mut ErrorEquations { formulation, bn, linear });
        errors.as_mut().map_or(Ok(()), |errors| errors.follow(rate.as_ref(), problem.weight(), at, z))
    }

    /// Returns `true` if the response of the body with clamped contact nodes already solves the increment.
    fn is_solved(&self, task: &Task<'_>) -> Computed<bool> {
        let mut z = self.z.clone();
        task.response.add_to(&mut z);
        let state = self.formulation.layout().unpacked(&z, self.formulation.scaling());
        Ok(task.error(&state)? <= task.tolerance)
    }

    /// Closes the nodes on which a body without supports comes to rest, `p_n > r (g - w_n)`: with open nodes the
    /// matrix would be singular.
    fn close_landed(&mut self, task: &Task<'_>) {
        let (layout, scaling) = (self.formulation.layout().clone(), *self.formulation.scaling());
        let all: Vec<usize> = if task.first { (0..layout.contacts()).collect() } else { Vec::new() };
        for &i in task.landed.unwrap_or(&all) {
            let gap = task.increment.gap[i] / scaling.length - task.problem.c_n().dot(i, &self.z);
            let pressed = if task.first { 0.0 } else { task.response.contact_force };
            let closed = 2.0 * self.formulation.r_n(i) * gap + pressed;
            let p_n = &mut self.z[layout.p_n(i)];
            *p_n = p_n.max(closed);
        }
    }
}

impl IncrementSolver for BnMethod {
    fn matrix(&self) -> &SystemMatrix {
        self.formulation.jacobian()
    }

    fn linearize(&mut self) {
        self.formulation.linearize(&self.z);
    }

    fn clamp_contacts(&mut self) -> Result<(), Vec<f64>> {
        self.formulation.clamp_contacts();
        self.formulation.unconstrained_mode().map_or(Ok(()), Err)
    }

    fn starts_on_tangent(&self, linear: &RefinedSolver) -> bool {
        let is_at_end = self.last.as_ref() == Some(&self.z);
        is_at_end && !self.closes && self.bn.has_factors(linear) && self.formulation.has_tangent()
    }

    fn solve(&mut self, task: &Task<'_>, linear: &mut RefinedSolver, observe: Observe<'_>) -> Computed<MethodResult> {
        let solved = self.closes && self.is_solved(task)?;
        if self.closes && !solved {
            self.close_landed(task);
        }
        let from = self.z.clone();
        let is_at_end = self.last.as_ref() == Some(&from) && task.landed.is_none() && !solved;
        self.begin(task, is_at_end.then_some(&*from), linear)?;
        let BnMethod { formulation, bn, measured, z, z_lo, last, ahead, .. } = self;
        let (layout, scaling) = (formulation.layout().clone(), *formulation.scaling());
        task.response.add_to(z);
        if task.first && *measured && !solved {
            task.response.add_forces_to(z);
        }
        let start = z.clone();
        if let Some(ahead) = ahead {
            z.copy_from_slice(ahead);
            formulation.slip_where_closing(z);
        }
        let mut error = |z: &[f64], z_lo: &[f64]| task.error(&layout.unpacked_with(z, z_lo, &scaling));
        let end = match measured {
            true => StopCriterion::Measured { tolerance: task.tolerance, error: &mut error },
            false => StopCriterion::Merit(PAPER_MERIT),
        };
        let outcome = bn.solve(formulation, linear, z, end, observe)?;
        z_lo.copy_from_slice(bn.z_lo());
        *last = None;
        if outcome.stop == Termination::Converged && formulation.is_pinned() {
            // One of many solutions: takes the nearest, if it remains a solution after rounding.
            let settled = formulation.settled(z, &start);
            if error(&settled, z_lo)? <= error(z, z_lo)?.max(task.tolerance) {
                *z = settled;
            }
        }
        if outcome.stop == Termination::Converged && *measured {
            *last = Some(z.clone());
        }
        if outcome.stop == Termination::Converged {
            self.follow(task.problem, linear)?;
        }
        Ok(outcome)
    }

    fn state(&self) -> State {
        self.formulation.layout().unpacked_with(&self.z, &self.z_lo, self.formulation.scaling())
    }

    fn ahead(
        &mut self,
        start: &[f64],
        cases: &[(bool, TangentialCase)],
        linear: &mut RefinedSolver,
    ) -> Computed<Option<State>> {
        let BnMethod { formulation, bn, .. } = self;
        let (layout, scaling) = (formulation.layout().clone(), *formulation.scaling());
        if self.ahead.is_none() {
            let (saved, is_factored) = (formulation.linearization(), bn.has_factors(linear));
            formulation.linearize_for(cases);
            if bn.factor(formulation, linear)? {
                self.ahead = ahead(formulation, bn, linear, start)?;
            }
            formulation.linearize_as(&saved);
            if is_factored {
                bn.factor(formulation, linear)?;
            }
        }
        Ok(self.ahead.as_ref().map(|z| layout.unpacked(z, &scaling)))
    }

    fn set_state(&mut self, state: &State) {
        let (layout, scaling) = (self.formulation.layout(), *self.formulation.scaling());
        self.z.copy_from_slice(&layout.packed(state, &scaling));
        self.z_lo.fill(0.0);
        self.z_lo.iter_mut().zip(&state.u_rest).for_each(|(z_lo, u_rest)| *z_lo = u_rest / scaling.length);
    }

    fn unknowns(&mut self) -> &mut Vec<f64> {
        &mut self.z
    }

    fn increment_errors(&mut self) -> Option<&mut IncrementErrors> {
        self.errors.as_mut()
    }

    fn snapshot(&self, linear: &RefinedSolver) -> Snapshot {
        Snapshot {
            unknowns: self.z.clone(),
            z_lo: self.z_lo.clone(),
            last: self.last.clone(),
            errors: self.errors.clone(),
            linearization: Some(self.formulation.linearization()),
            is_factored: self.bn.has_factors(linear),
            ..Snapshot::default()
        }
    }

    fn restore(&mut self, snapshot: Snapshot, linear: &mut RefinedSolver) -> Computed<bool> {
        let Snapshot { unknowns, z_lo, last, errors, linearization, is_factored, .. } = snapshot;
        let n = self.z.len();
        let errors_fit = match (&self.errors, &errors) {
            (Some(own), Some(kept)) => own.fit(kept),
            (own, kept) => own.is_none() && kept.is_none(),
        };
        let last_fits = last.as_ref().is_none_or(|z| z.len() == n);
        if !(take_over(&mut self.z, &unknowns) && take_over(&mut self.z_lo, &z_lo) && last_fits && errors_fit) {
            return Ok(false);
        }
        (self.last, self.errors) = (last, errors);
        if !linearization.is_some_and(|kept| self.formulation.linearize_as(&kept)) {
            return Ok(false);
        }
        Ok(!is_factored || self.bn.factor(&self.formulation, linear)?)
    }
}

/// Returns the state on the tangent at the previous solution `z`, for the new data of `formulation`. Returns `None`
/// if the factors of `linear` are not those of the last linearisation, or if it has no tangent.
pub(super) fn ahead(
    formulation: &Bdiff,
    bn: &mut Bn,
    linear: &mut RefinedSolver,
    z: &[f64],
) -> Computed<Option<Vec<f64>>> {
    if !formulation.has_tangent() {
        return Ok(None);
    }
    let h = formulation.residual_of_cases(z)?;
    let Some(dz) = bn.substitute(formulation, linear, &h)? else { return Ok(None) };
    Ok(Some(z.iter().zip(dz).map(|(z, dz)| z + dz).collect()))
}
