//! BN along a history: every increment starts from the last solution.

use super::method::{IncrementSolver, Task};
use super::settings::HistorySettings;
use crate::formulation::{Bdiff, Formulation};
use crate::linear::{Direct, LinearError};
use crate::loading::Loading;
use crate::nonlinear::{Bn, BnSettings, Flow, IterationRecord, Outcome};
use crate::problem::{ContactProblem, State};
use crate::sparse::Csc;

pub(super) struct BnMethod {
    formulation: Bdiff,
    bn: Bn,
    z: Vec<f64>,
}

impl BnMethod {
    pub(super) fn new(
        problem: &ContactProblem,
        loading: &Loading,
        settings: &HistorySettings,
        bn: BnSettings,
        start_pressure: f64,
    ) -> Self {
        let formulation = Bdiff::new(problem, settings.scaling, &settings.conventions);
        let p_n = start_forces(problem, loading, settings, start_pressure);
        let z = formulation.layout().pack(&State { p_n, ..State::zero(problem) }, &settings.scaling);
        BnMethod { bn: Bn::new(bn, formulation.unknowns()), formulation, z }
    }
}

impl IncrementSolver for BnMethod {
    fn matrix(&self) -> &Csc {
        self.formulation.jacobian()
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
        self.formulation.begin(task.increment);
        task.response.add_to(&mut self.z);
        self.bn.solve(&mut self.formulation, linear, &mut self.z, observe)
    }

    fn state(&self) -> State {
        self.formulation.layout().unpack(&self.z, self.formulation.scaling())
    }
}

/// `p_n` before the first increment. Without load or interference that is 0, the solution. A body
/// that only contact holds starts with every node closed, `p_n > r g`: its first matrix would be
/// singular with open ones.
fn start_forces(
    problem: &ContactProblem,
    loading: &Loading,
    settings: &HistorySettings,
    start_pressure: f64,
) -> Vec<f64> {
    if loading.largest_force() == 0.0 && loading.largest_interference() == 0.0 {
        return vec![0.0; problem.contacts()];
    }
    let held = problem.free_motions.is_empty();
    let closing = |i: usize| if held { 0.0 } else { 2.0 * settings.conventions.r[i] * loading.gap[i] };
    let guess = problem.weight.iter().map(|l| l * start_pressure);
    guess.enumerate().map(|(i, p_n)| p_n.max(closing(i))).collect()
}
