//! BN with a fallback: the predictor–corrector interior point method solves the increments that BN does not, from the
//! last solution.

use super::bn::BnMethod;
use super::increment_error::IncrementErrors;
use super::predictor_corrector::PredictorCorrectorMethod;
use super::saved::Snapshot;
use super::settings::HistorySettings;
use super::task::{IncrementSolver, Observe, Task};
use crate::algebra::linear::{LinearError, RefinedSolver};
use crate::algebra::sparse::SystemMatrix;
use crate::solver::newton::{MethodResult, Termination};
use crate::solver::problem::State;

pub(super) struct Rescued {
    bn: BnMethod,
    settings: HistorySettings,
    /// The fallback, created when it is first needed.
    rescue: Option<PredictorCorrectorMethod>,
}

impl Rescued {
    pub(super) fn new(bn: BnMethod, settings: &HistorySettings) -> Self {
        Rescued { bn, settings: settings.clone(), rescue: None }
    }
}

impl IncrementSolver for Rescued {
    fn matrix(&self) -> &SystemMatrix {
        self.bn.matrix()
    }

    fn linearize(&mut self) {
        self.bn.linearize();
    }

    fn hold_contacts(&mut self) -> Result<(), Vec<f64>> {
        self.bn.hold_contacts()
    }

    fn starts_on_tangent(&self, linear: &RefinedSolver) -> bool {
        self.bn.starts_on_tangent(linear)
    }

    fn solve(
        &mut self,
        task: &Task<'_>,
        linear: &mut RefinedSolver,
        observe: Observe<'_>,
    ) -> Result<MethodResult, LinearError> {
        let Rescued { bn, settings, rescue } = self;
        let last = bn.last_solution(task);
        let substep = bn.solve(task, linear, observe)?;
        let left = settings.max_iterations.saturating_sub(substep.iterations);
        if left == 0 || matches!(substep.stop, Termination::Converged | Termination::Interrupted) {
            return Ok(substep);
        }
        let rescue = rescue.get_or_insert_with(|| rescue_of(bn, settings));
        rescue.limit(left);
        rescue.go_on_from(&last);
        let mut rescued = rescue.solve(task, linear, observe)?;
        if rescued.stop == Termination::Converged {
            rescued.rescued = true;
            bn.go_on_from(&rescue.state());
            bn.follow(task.problem, linear)?;
        } else if rescued.stop != Termination::Interrupted {
            // The termination of the first attempt is more informative.
            rescued.stop.clone_from(&substep.stop);
        }
        Ok(substep.then(rescued))
    }

    fn state(&self) -> State {
        self.bn.state()
    }

    fn go_on_from(&mut self, state: &State) {
        self.bn.go_on_from(state);
    }

    fn unknowns(&mut self) -> &mut Vec<f64> {
        self.bn.unknowns()
    }

    fn increment_errors(&mut self) -> Option<&mut IncrementErrors> {
        self.bn.increment_errors()
    }

    fn memory(&self, linear: &RefinedSolver) -> Snapshot {
        let rescue = self.rescue.as_ref().map(|rescue| Box::new(rescue.memory(linear)));
        Snapshot { rescue, ..self.bn.memory(linear) }
    }

    fn restore(&mut self, mut memory: Snapshot, linear: &mut RefinedSolver) -> Result<bool, LinearError> {
        if let Some(memory) = memory.rescue.take() {
            let rescue = self.rescue.insert(rescue_of(&self.bn, &self.settings));
            if !rescue.restore(*memory, linear)? {
                return Ok(false);
            }
        }
        self.bn.restore(memory, linear)
    }
}

fn rescue_of(bn: &BnMethod, settings: &HistorySettings) -> PredictorCorrectorMethod {
    PredictorCorrectorMethod::beside(bn.assembled(), settings)
}
