//! BN along a history: every increment starts from the last solution.

use super::method::{IncrementSolver, Task};
use super::predictor_corrector::PredictorCorrectorMethod;
use super::settings::{FirstGuess, HistorySettings};
use crate::formulation::{Bdiff, Formulation};
use crate::linear::{Direct, LinearError};
use crate::loading::Loading;
use crate::nonlinear::{Bn, BnSettings, Flow, IterationRecord, Outcome, PredictorCorrectorSettings, Stop};
use crate::problem::{ContactProblem, State};
use crate::scene::NewtonSystem;
use crate::sparse::Csc;

pub(super) struct BnMethod<'a> {
    problem: &'a ContactProblem,
    formulation: Bdiff,
    bn: Bn,
    start: FirstGuess,
    rescue: Option<Rescue<'a>>,
    z: Vec<f64>,
    /// What rounding leaves off `z`.
    rest: Vec<f64>,
}

/// The interior point method that solves what BN does not.
struct Rescue<'a> {
    settings: PredictorCorrectorSettings,
    history: HistorySettings,
    /// Made when it is first needed.
    method: Option<PredictorCorrectorMethod<'a>>,
}

impl<'a> BnMethod<'a> {
    pub(super) fn new(
        problem: &'a ContactProblem,
        loading: &Loading,
        history: &HistorySettings,
        settings: BnSettings,
        start: FirstGuess,
        rescue: Option<PredictorCorrectorSettings>,
    ) -> Self {
        let formulation = Bdiff::new(problem, history.scaling, &history.conventions);
        let p_n = start_forces(problem, loading, history, start);
        let z = formulation.layout().pack(&State { p_n, ..State::zero(problem) }, &history.scaling);
        let rescue = rescue.map(|settings| Rescue { settings, history: history.clone(), method: None });
        BnMethod {
            bn: Bn::new(settings, formulation.unknowns()),
            problem,
            formulation,
            start,
            rescue,
            rest: vec![0.0; z.len()],
            z,
        }
    }
}

impl IncrementSolver for BnMethod<'_> {
    fn matrix(&self) -> &Csc {
        self.formulation.jacobian()
    }

    fn linearize(&mut self) {
        self.formulation.linearize(&self.z);
    }

    fn hold_contacts(&mut self) -> Result<(), Vec<f64>> {
        self.formulation.hold_contacts();
        self.formulation.unheld_motion().map_or(Ok(()), Err)
    }

    fn solve(
        &mut self,
        task: &Task<'_>,
        linear: &mut Direct,
        observe: &mut dyn FnMut(&IterationRecord) -> Flow,
    ) -> Result<Outcome, LinearError> {
        let BnMethod { problem, formulation, bn, start, rescue, z, rest } = self;
        let (layout, scaling) = (formulation.layout().clone(), *formulation.scaling());
        // Before the first increment there is no solution to go on from, only a guess.
        let last = if task.first { State::zero(problem) } else { layout.unpack(z, &scaling) };
        formulation.begin(task.increment);
        task.response.add_to(z);
        if task.first && *start == FirstGuess::Held {
            task.response.add_forces_to(z);
        }
        let mut error = |z: &[f64], rest: &[f64]| task.error(problem, &layout.unpack_with(z, rest, &scaling));
        let mut outcome = bn.solve(formulation, linear, z, &mut error, observe)?;
        rest.copy_from_slice(bn.rest());
        let unsolved = !matches!(outcome.stop, Stop::Met | Stop::Interrupted);
        let left = |rescue: &Rescue| rescue.settings.max_iterations.saturating_sub(outcome.iterations);
        if let Some(rescue) = rescue.as_mut().filter(|rescue| unsolved && left(rescue) > 0) {
            let left = left(rescue);
            let method = rescue.method.get_or_insert_with(|| {
                PredictorCorrectorMethod::new(problem, &rescue.history, rescue.settings, NewtonSystem::Reduced)
            });
            method.go_on_from(&last, left);
            let mut rescued = method.solve(task, linear, observe)?;
            if rescued.stop == Stop::Met {
                rescued.rescued = true;
                let state = method.state();
                z.copy_from_slice(&layout.pack(&state, &scaling));
                rest.fill(0.0);
                rest.iter_mut().zip(&state.u_rest).for_each(|(rest, u_rest)| *rest = u_rest / scaling.length);
            } else if rescued.stop != Stop::Interrupted {
                // How the first attempt ended tells more.
                rescued.stop.clone_from(&outcome.stop);
            }
            outcome = outcome.then(rescued);
        }
        Ok(outcome)
    }

    fn state(&self) -> State {
        self.formulation.layout().unpack_with(&self.z, &self.rest, self.formulation.scaling())
    }

    fn unknowns(&mut self) -> &mut Vec<f64> {
        &mut self.z
    }
}

/// `p_n` before the first increment. Without load or interference that is 0, the solution. A body
/// that only contact holds starts with every node closed, `p_n > r g`: its first matrix would be
/// singular with open ones.
fn start_forces(
    problem: &ContactProblem,
    loading: &Loading,
    settings: &HistorySettings,
    start: FirstGuess,
) -> Vec<f64> {
    if loading.largest_force() == 0.0 && loading.largest_interference() == 0.0 {
        return vec![0.0; problem.contacts()];
    }
    let held = problem.free_motions.is_empty();
    let closing = |i: usize| if held { 0.0 } else { 2.0 * settings.conventions.r_n[i] * loading.gap[i] };
    let pressure = match start {
        FirstGuess::Pressure(pressure) => pressure,
        FirstGuess::Held => 0.0,
    };
    let guess = problem.weight.iter().map(|l| l * pressure);
    guess.enumerate().map(|(i, p_n)| p_n.max(closing(i))).collect()
}
