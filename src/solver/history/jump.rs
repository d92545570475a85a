//! Jumps: increments beyond the end of the quasi-static motion, to a state that the laws of an increment allow.
//!
//! Which of these states a body reaches is a question of dynamics. Newton's method starts from the last state, the
//! interior point method from a point of its own. If neither reaches the end of the increment, both try half of the
//! increment, a quarter, and so on.

use super::driver::HistoryDriver;
use super::record::{IncrementRecord, Status};
use super::settings::HistorySettings;
use super::state::HistoryState;
use super::{Error, HistoryOutcome, Observer};
use crate::algebra::linear::RefinedSolver;
use crate::solver::condensation::Condensation;
use crate::solver::laws::KktScales;
use crate::solver::loading::Loading;
use crate::solver::problem::{ContactProblem, State};

/// The start of a jump, or of increments that are solved again.
pub(crate) struct RestartPoint<'a> {
    pub problem: &'a ContactProblem,
    pub loading: &'a Loading,
    pub settings: &'a HistorySettings,
    /// The time at which the motion ended, s.
    pub time: f64,
    /// The state at that time.
    pub state: State,
    pub scales: KktScales,
}

/// The result of a jump.
pub(super) struct AfterJump {
    /// The time, s.
    pub time: f64,
    /// The state at that time.
    pub state: State,
    /// The record of the increment.
    pub record: IncrementRecord,
}

/// The linear solver of a jump.
pub(crate) enum JumpSolver<'m> {
    /// The solver of the whole body.
    Whole(&'m mut RefinedSolver),
    /// The factorisation of the condensed body.
    Condensed(&'m Condensation),
}

impl RestartPoint<'_> {
    /// Jumps to the time `to` (s), or as far towards it as a solution is found. Returns `None` if none is found.
    ///
    /// # Errors
    /// As [`super::run`].
    pub(super) fn jump(&self, to: f64, means: &mut JumpSolver<'_>) -> Result<Option<AfterJump>, Error> {
        let settings = HistorySettings { halvings: 0, ..self.settings.clone() };
        for halvings in 0..=self.settings.halvings {
            let time = self.time + (to - self.time) * 0.5_f64.powi(halvings as i32);
            if time <= self.time {
                break;
            }
            let outcome = self.try_to(&[time], &settings, &mut (), means)?;
            if let (Status::Converged, Some(record)) = (outcome.status, outcome.records.last()) {
                let record = record.clone();
                return Ok(Some(AfterJump { time, state: outcome.state, record }));
            }
        }
        Ok(None)
    }

    /// Solves the increments that end at `times` (s), as far as they converge, and shows them to `observer`. Returns
    /// the last outcome.
    ///
    /// # Errors
    /// As [`super::run`].
    pub(crate) fn go_on(
        &self,
        times: &[f64],
        observer: &mut dyn Observer,
        means: &mut JumpSolver<'_>,
    ) -> Result<Status, Error> {
        Ok(self.try_to(times, self.settings, observer, means)?.status)
    }

    fn try_to(
        &self,
        times: &[f64],
        settings: &HistorySettings,
        observer: &mut dyn Observer,
        means: &mut JumpSolver<'_>,
    ) -> Result<HistoryOutcome, Error> {
        let &RestartPoint { problem, loading, ref state, ref scales, .. } = self;
        let [w_n, w_t, w_o] = problem.contact_motion(&state.u);
        let mut history = HistoryState {
            reached: Some(self.time),
            state: Some(state.clone()),
            scales: scales.clone(),
            w_n,
            w_t,
            w_o,
            ..HistoryState::start(problem)
        };
        let mut driver = HistoryDriver::new(problem, loading, times, settings, observer, &mut history);
        driver.is_ready = true;
        match means {
            JumpSolver::Whole(linear) => {
                driver.stage(settings, driver.body, linear)?;
            }
            JumpSolver::Condensed(condensation) => driver.condensed(settings, condensation)?,
        }
        Ok(driver.outcome)
    }
}
