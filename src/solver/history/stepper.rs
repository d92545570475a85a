//! One increment at a time, under loads that are not known in advance.

use super::driver::HistoryDriver;
use super::observer::{IncrementView, Observer};
use super::system::SystemSolver;
use super::task::Algorithm;
use super::{Error, HistoryOutcome, HistorySettings, Method, Status};
use crate::algebra::linear::{Dense, LinearError, RefinedSolver};
use crate::solver::checkpoint::Checkpoint;
use crate::solver::condensation::{Condensation, Condensed};
use crate::solver::events::Event;
use crate::solver::loading::Loading;
use crate::solver::newton::{IterationRecord, LinearSystem};
use crate::solver::problem::ContactProblem;
use std::borrow::Borrow;
use std::ops::ControlFlow;
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
/// use stickslip::algebra::sparse::{Csr, Symmetric};
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
    /// The settings, which include the checkpoint of the next increment.
    settings: HistorySettings,
    body: Body,
    linear: RefinedSolver,
    /// The ends of the converged increments, s.
    times: Vec<f64>,
}

/// The body to which the equations belong.
enum Body {
    Whole,
    /// A body that is condensed with the first increment.
    ToCondense(Condensation),
    Condensed(Box<Condensed>),
}

impl<P: Borrow<ContactProblem>> Stepper<P> {
    /// Creates a stepper at the undeformed body at t = 0.
    ///
    /// # Errors
    /// As [`super::run`] for settings that do not fit; [`Error::NotInSteps`] for a method that follows a path to a
    /// known end.
    pub fn new(problem: P, settings: HistorySettings, system: SystemSolver) -> Result<Self, Error> {
        settings.check(problem.borrow())?;
        if let Method::Events { .. } = settings.method {
            return Err(Error::NotInSteps { method: settings.method });
        }
        let (body, linear) = match system {
            SystemSolver::Whole(linear) => (Body::Whole, linear),
            SystemSolver::Condensed(condensation) => {
                (Body::ToCondense(condensation), RefinedSolver::from(Dense::default()))
            }
        };
        let settings = HistorySettings { from: None, working_set: None, ..settings };
        Ok(Stepper { problem, settings, body, linear, times: Vec::new() })
    }

    /// Returns the end of the last converged increment, s; 0 before the first.
    pub fn time(&self) -> f64 {
        self.times.last().copied().unwrap_or(0.0)
    }

    /// Advances to `time` (s), where `loading` describes the data between the end of the last increment and `time`.
    /// Returns the outcome of the history so far, with the record of this increment.
    ///
    /// # Errors
    /// As [`super::run`].
    pub fn step(&mut self, loading: &Loading, time: f64, observer: &mut dyn Observer) -> Result<HistoryOutcome, Error> {
        let start = Instant::now();
        loading.check(self.problem.borrow())?;
        self.times.push(time);
        let checked = super::check_times(&self.times).map_err(Error::from);
        let mut resting = Resting { observer, rest: None };
        let outcome = checked.and_then(|()| self.increment(loading, &mut resting, start));
        match resting.rest {
            Some(rest) => self.settings.from = Some(rest),
            None => drop(self.times.pop()),
        }
        outcome
    }

    fn increment(
        &mut self,
        loading: &Loading,
        observer: &mut dyn Observer,
        start: Instant,
    ) -> Result<HistoryOutcome, Error> {
        let (problem, settings) = (self.problem.borrow(), &self.settings);
        let outcome = HistoryOutcome::begun(problem);
        if !settings.knows(&outcome.layout) {
            return Ok(HistoryOutcome { status: Status::Unsupported, ..outcome });
        }
        if let Body::ToCondense(condensation) = &self.body {
            match Condensed::new(problem, loading, condensation.clone()) {
                Ok(condensed) => self.body = Body::Condensed(Box::new(condensed)),
                Err(LinearError::Singular { .. }) => {
                    let free_motion = settings.start(problem, loading).hold_contacts().err();
                    return Ok(HistoryOutcome { status: Status::Singular, free_motion, ..outcome });
                }
                Err(error) => return Err(error.into()),
            }
        } else if let Body::Condensed(condensed) = &mut self.body {
            condensed.load(loading)?;
        }
        let condensed = if let Body::Condensed(condensed) = &self.body { Some(&**condensed) } else { None };
        let mut stages = HistoryDriver::new(problem, loading, &self.times, settings, observer, outcome, start)?;
        stages.stage(settings, condensed, &mut self.linear)?;
        Ok(stages.outcome)
    }
}

/// An observer that keeps the checkpoint from which the history can resume.
struct Resting<'o> {
    observer: &'o mut dyn Observer,
    rest: Option<Checkpoint>,
}

impl Observer for Resting<'_> {
    fn ready(&mut self) {
        self.observer.ready();
    }

    fn iteration(&mut self, index: usize, record: &IterationRecord) -> ControlFlow<()> {
        self.observer.iteration(index, record)
    }

    fn linear_system(&mut self, index: usize, system: &LinearSystem<'_>) -> ControlFlow<()> {
        self.observer.linear_system(index, system)
    }

    fn event(&mut self, index: usize, event: &Event) {
        self.observer.event(index, event);
    }

    fn part(&mut self, part: &IncrementView<'_>) {
        self.observer.part(part);
    }

    fn increment(&mut self, step: &IncrementView<'_>) -> ControlFlow<()> {
        self.observer.increment(step)
    }

    fn rest(&mut self, here: &dyn Fn() -> Checkpoint) {
        self.observer.rest(here);
        self.rest = Some(here());
    }
}
