//! What a history asks of a method.

use super::bn::BnMethod;
use super::held::Response;
use super::ip::IpMethod;
use super::predictor_corrector::PredictorCorrectorMethod;
use super::settings::{HistorySettings, Method};
use crate::contact::{KktErrors, KktScales};
use crate::linear::{Direct, LinearError};
use crate::loading::Loading;
use crate::nonlinear::{Flow, IterationRecord, Outcome};
use crate::problem::{ContactProblem, Increment, State};
use crate::sparse::Csc;

/// One increment to solve.
pub(super) struct Task<'a> {
    /// Whether it is the first of its history.
    pub first: bool,
    /// Its data.
    pub increment: &'a Increment<'a>,
    /// What the change of the load does while the contact nodes are held.
    pub response: &'a Response,
    /// The scales of the error measure, from the increments before and the load of this one.
    pub scales: &'a KktScales,
    /// The error that is allowed.
    pub tolerance: f64,
}

impl Task<'_> {
    /// The error of a state at the end of the increment.
    pub(super) fn error(&self, problem: &ContactProblem, state: &State) -> f64 {
        judge(problem, self.increment, state, &self.scales.with_state(state), self.tolerance).worst().1
    }
}

/// The error measure. Near the `tolerance` the rounding of the imbalance itself would count, so there it is
/// worked out in twice the precision.
pub(super) fn judge(
    problem: &ContactProblem,
    increment: &Increment<'_>,
    state: &State,
    scales: &KktScales,
    tolerance: f64,
) -> KktErrors {
    let errors = KktErrors::measure(problem, increment, state, scales);
    let near = 0.1 * tolerance..10.0 * tolerance;
    if !state.u_rest.is_empty() || !near.contains(&errors.equilibrium) {
        return errors;
    }
    let exact = State { u_rest: vec![0.0; state.u.len()], ..state.clone() };
    KktErrors::measure(problem, increment, &exact, scales)
}

/// A method with the state it has reached, in its own units.
pub(super) trait IncrementSolver {
    /// The matrix it factors; its pattern never changes.
    fn matrix(&self) -> &Csc;

    /// Linearises at the state it has reached; see [`IncrementSolver::linearization`].
    fn linearize(&mut self);

    /// The matrix that [`IncrementSolver::linearize`] has written, on the pattern of the other.
    fn linearization(&self) -> &Csc {
        self.matrix()
    }

    /// Writes the matrix of the body with all contact nodes held; `Err` with the weights of a free
    /// motion that is possible all the same.
    fn hold_contacts(&mut self) -> Result<(), Vec<f64>>;

    /// Solves the increment from the last state.
    fn solve(
        &mut self,
        task: &Task<'_>,
        linear: &mut Direct,
        observe: &mut dyn FnMut(&IterationRecord) -> Flow,
    ) -> Result<Outcome, LinearError>;

    /// The state it has reached.
    fn state(&self) -> State;

    /// Its unknowns, to be kept and put back if an increment fails.
    fn unknowns(&mut self) -> &mut Vec<f64>;
}

/// The method that `settings` name.
pub(super) fn new<'a>(
    problem: &'a ContactProblem,
    loading: &Loading,
    settings: &HistorySettings,
) -> Box<dyn IncrementSolver + 'a> {
    match settings.method {
        Method::Bn { settings: bn, start, rescue } => {
            Box::new(BnMethod::new(problem, loading, settings, bn, start, rescue))
        }
        Method::PredictorCorrector { settings: pc, newton } => {
            Box::new(PredictorCorrectorMethod::new(problem, settings, pc, newton))
        }
        Method::Ip { settings: ip, start, partition, newton } => {
            Box::new(IpMethod::new(problem, settings, ip, start, partition, newton))
        }
    }
}
