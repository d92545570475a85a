//! One increment at a time, under loads that are not known in advance.

use super::body::Body;
use super::driver::HistoryDriver;
use super::record::Observer;
use super::saved::Snapshot;
use super::stage::Stage;
use super::state::HistoryState;
use super::system::SystemSolver;
use super::task::Algorithm;
use super::{Error, HistoryOutcome, HistorySettings, Status};
use crate::algebra::linear::{Dense, LinearError, RefinedSolver};
use crate::solver::checkpoint::CheckpointError;
use crate::solver::condensation::{Condensation, Condensed};
use crate::solver::loading::Loading;
use crate::solver::problem::ContactProblem;
use std::borrow::Borrow;
use std::sync::Arc;
use std::time::Instant;

/// A history whose future is unknown: for a caller's own time loop, and for coupled simulations.
///
/// Each increment starts at the end of the last converged one. An increment that failed may be tried again, with an
/// earlier end time or another load. The symbolic analysis or the condensed body is kept between increments.
///
/// ```
/// use stickslip::solver::history::{HistorySettings, Method, Status, Stepper, SystemSolver};
/// use stickslip::solver::{LoadCase, Loading};
/// use stickslip::solver::{ContactProblem, Parts};
/// use stickslip::algebra::{Csr, Symmetric};
///
/// // A node on a spring of 2 N/m, a metre from a wall, pulled with 3 N, then with 4 N.
/// let stiffness = Symmetric::from_triplets(1, &[(0, 0, 2.0)])?;
/// let problem = ContactProblem::new(Parts::new(stiffness, Csr::from_rows(1, [[(0, 1.0)]])?))?;
/// let load = |f: f64| Loading::new(vec![LoadCase::new(vec![f], vec![])?], vec![1.0]);
/// let settings = HistorySettings::new(&problem, &load(3.0)?, Method::BN)?;
/// let mut stepper = Stepper::new(&problem, settings, SystemSolver::default())?;
/// assert_eq!(stepper.step(&load(3.0)?, 1.0, &mut ())?.state.p_n, [1.0]);
/// assert_eq!(stepper.step(&load(4.0)?, 2.0, &mut ())?.state.p_n, [2.0]);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub struct Stepper<P> {
    problem: P,
    settings: HistorySettings,
    body: StepperBody,
    linear: RefinedSolver,
    /// The ends of the converged increments, s.
    times: Vec<f64>,
    /// The results up to the end of the last converged increment.
    done: HistoryOutcome,
    history: HistoryState,
    /// The equations, from the first increment on.
    stage: Option<Stage>,
    /// The loading for which they were set up.
    loading: Option<Loading>,
    /// The snapshot to which the method must return after an increment that failed.
    restart: Option<Snapshot>,
    /// Distinguishes it from all other steppers.
    identity: Arc<()>,
}

/// Where a [`Stepper`] was when [`Stepper::save`] was called.
#[derive(Clone)]
pub struct StepperState {
    times: Vec<f64>,
    done: HistoryOutcome,
    history: HistoryState,
    /// The snapshot of the method; `None` before the equations were set up.
    method: Option<Snapshot>,
    /// The stepper that it belongs to.
    of: Arc<()>,
}

/// The body to which the equations belong.
enum StepperBody {
    Whole,
    /// A body that is condensed with the first increment.
    ToCondense(Condensation),
    Condensed(Box<Condensed>),
}

impl<P: Borrow<ContactProblem>> Stepper<P> {
    /// Creates a stepper at the undeformed body at t = 0.
    ///
    /// # Errors
    /// As [`super::run`], for settings that do not fit.
    pub fn new(problem: P, settings: HistorySettings, system: SystemSolver) -> Result<Self, Error> {
        settings.check(problem.borrow())?;
        let (body, linear) = match system {
            SystemSolver::Whole(linear) => (StepperBody::Whole, linear),
            SystemSolver::Condensed(condensation) => {
                (StepperBody::ToCondense(condensation), RefinedSolver::new(Box::new(Dense::default())))
            }
        };
        Ok(Stepper {
            done: HistoryOutcome::unsolved(problem.borrow()),
            history: HistoryState::start(problem.borrow()),
            settings: HistorySettings { from: None, working_set: None, ..settings },
            problem,
            body,
            linear,
            times: Vec::new(),
            stage: None,
            loading: None,
            restart: None,
            identity: Arc::new(()),
        })
    }

    /// Returns the end of the last converged increment, s; 0 before the first.
    pub fn time(&self) -> f64 {
        self.times.last().copied().unwrap_or(0.0)
    }

    /// Returns where the stepper is, for [`Stepper::restore`]: an implicit coupling takes increments back.
    pub fn save(&self) -> StepperState {
        let now = || self.stage.as_ref().map(|stage| stage.method.snapshot(&self.linear));
        StepperState {
            times: self.times.clone(),
            done: self.done.clone(),
            history: self.history.clone(),
            method: self.restart.clone().or_else(now),
            of: Arc::clone(&self.identity),
        }
    }

    /// Returns to a `state` that this stepper has saved. The next increment is what it would have been there.
    ///
    /// ```
    /// # use stickslip::solver::history::{HistorySettings, Method, Stepper, SystemSolver};
    /// # use stickslip::solver::{ContactProblem, LoadCase, Loading, Parts};
    /// # use stickslip::algebra::{Csr, Symmetric};
    /// # let stiffness = Symmetric::from_triplets(1, &[(0, 0, 2.0)])?;
    /// # let problem = ContactProblem::new(Parts::new(stiffness, Csr::from_rows(1, [[(0, 1.0)]])?))?;
    /// # let load = |f: f64| Loading::new(vec![LoadCase::new(vec![f], vec![])?], vec![1.0]);
    /// # let settings = HistorySettings::new(&problem, &load(3.0)?, Method::BN)?;
    /// // The node of the example above: its force depends on the answer.
    /// let mut stepper = Stepper::new(&problem, settings.clone(), SystemSolver::default())?;
    /// let (before, mut p) = (stepper.save(), 0.0);
    /// for _ in 0..60 {
    ///     stepper.restore(&before)?;
    ///     p = stepper.step(&load(3.0 + 0.5 * p)?, 1.0, &mut ())?.state.p_n[0];
    /// }
    /// assert!((p - 2.0).abs() < 1e-14 && stepper.time() == 1.0);
    ///
    /// // Another stepper refuses the state.
    /// let mut other = Stepper::new(&problem, settings, SystemSolver::default())?;
    /// assert!(other.restore(&before).is_err());
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    ///
    /// # Errors
    /// [`CheckpointError::Other`] for a state that another stepper has saved.
    pub fn restore(&mut self, state: &StepperState) -> Result<(), Error> {
        let StepperState { times, done, history, method, of } = state.clone();
        if !Arc::ptr_eq(&of, &self.identity) {
            return Err(CheckpointError::Other { what: "the stepper" }.into());
        }
        if method.is_none() {
            // The equations are set up again, with whatever the next increment brings.
            (self.stage, self.loading) = (None, None);
        }
        (self.times, self.done, self.history, self.restart) = (times, done, history, method);
        Ok(())
    }

    /// Advances to `time` (s), where `loading` describes the data between the end of the last increment and `time`.
    /// Returns the outcome of the history so far, with the record of this increment.
    ///
    /// An increment costs as much as one of a history. If the nodal forces of the loads change, and not only their
    /// factors, an increment that does not start on the tangent at the last state costs one more factorisation, with
    /// clamped contact nodes.
    ///
    /// # Errors
    /// As [`super::run`].
    pub fn step(&mut self, loading: &Loading, time: f64, observer: &mut dyn Observer) -> Result<HistoryOutcome, Error> {
        loading.check(self.problem.borrow())?;
        self.times.push(time);
        let before = self.history.clone();
        let checked = super::check_times(&self.times).map_err(Error::from);
        let outcome = checked.and_then(|()| self.increment(loading, observer));
        match &outcome {
            Ok(outcome) if outcome.status == Status::Converged => {
                self.done = outcome.so_far();
                self.restart = None;
            }
            _ => {
                self.history = before;
                self.times.pop();
            }
        }
        outcome
    }

    fn increment(&mut self, loading: &Loading, observer: &mut dyn Observer) -> Result<HistoryOutcome, Error> {
        let Stepper { problem, settings, body, linear, times, history, stage, loading: last, restart, .. } = self;
        let problem = (*problem).borrow();
        let outcome = self.done.clone();
        if !settings.knows(&outcome.layout) {
            return Ok(HistoryOutcome { status: Status::Unsupported, ..outcome });
        }
        let start = Instant::now();
        let new_forces = last.as_ref().is_none_or(|last| !last.has_forces_of(loading));
        if new_forces {
            // Until the equations have the new forces, they have none that a later increment may rely on.
            *last = None;
        }
        match body {
            StepperBody::Whole => {}
            StepperBody::ToCondense(condensation) => match Condensed::new(problem, loading, condensation.clone()) {
                Ok(condensed) => *body = StepperBody::Condensed(Box::new(condensed)),
                Err(LinearError::Singular { .. }) => {
                    let mut outcome = outcome;
                    outcome.end_unconstrained(settings, problem, loading);
                    return Ok(outcome);
                }
                Err(error) => return Err(error.into()),
            },
            StepperBody::Condensed(condensed) if new_forces => condensed.load(loading)?,
            StepperBody::Condensed(condensed) => condensed.load_again(loading),
        }
        let condensed = if let StepperBody::Condensed(condensed) = body { Some(&**condensed) } else { None };
        let body = Body { problem, loading, condensed };
        if let Some(stage) = stage {
            let moves = stage.may_move_rigidly && new_forces;
            if moves && restart.is_none() {
                *restart = Some(stage.method.snapshot(linear));
            }
            if new_forces {
                stage.clamped = None;
            }
            if moves {
                stage.clamp(body, settings, linear)?;
            }
            if let Some(snapshot) = restart.clone()
                && !stage.method.restore(snapshot, linear)?
            {
                return Err(CheckpointError::Other { what: "the method" }.into());
            }
        }
        *last = Some(loading.clone());
        let is_ready = stage.is_some();
        let mut driver = HistoryDriver::new(problem, loading, times, settings, observer, history);
        (driver.start, driver.outcome, driver.is_ready) = (start, outcome, is_ready);
        if stage.is_none() {
            *stage = driver.set_up(settings, body, linear)?;
        }
        let Some(stage) = stage else { return Ok(driver.outcome) };
        *restart = Some(stage.method.snapshot(linear));
        driver.increments(stage, body, linear)?;
        Ok(driver.outcome)
    }
}
