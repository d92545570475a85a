//! Increments that are solved one after the other on the contact displacements, and judged together.
//!
//! The next increment asks for nothing but the contact displacements, and the interiors of several cost little more than that of
//! one. Each is judged on the whole body all the same, as if it had been alone; where one is not good enough as it stands, it
//! is taken back with those after it, and solved alone.

use std::collections::VecDeque;
use std::time::Instant;

use super::{IncrementDriver, IncrementProgress, Start};
use crate::algebra::linear::{LinearError, RefinedSolver, Statistics};
use crate::solver::history::Status;
use crate::solver::history::progress::Progress;
use crate::solver::history::recovery::{InteriorRecovery, RecoveredState};
use crate::solver::laws::KktScales;
use crate::solver::newton::{MethodResult, Termination};

/// The most that go together: beyond that the factors are hardly read less often.
const MOST: usize = 16;

/// What is solved and not yet judged is lost if a run is killed: increments of more operations than this, about a second,
/// go alone.
const OPERATIONS: f64 = 2e10;

/// Iterations of an increment, to estimate its operations.
const ITERATIONS: f64 = 5.0;

/// An increment that is solved and not yet judged.
struct SolvedIncrement {
    time: f64,
    began: Instant,
    start: Start,
    scales: KktScales,
    outcome: MethodResult,
    /// What the linear algebra had done before and after it.
    work: [Statistics; 2],
    /// Its wall time so far.
    seconds: f64,
}

/// Increments in a row that are to be judged.
pub(in crate::solver::history) struct Bundle {
    pending: VecDeque<(SolvedIncrement, RecoveredState)>,
    /// Whether there is only one.
    alone: bool,
    /// Whether the method is where the last one ends.
    is_current: bool,
    /// Whether all were good as they stood.
    pub needs_no_refinement: bool,
}

/// A judged increment.
pub(in crate::solver::history) struct JudgedIncrement {
    pub time: f64,
    /// How far it came; it has not ended where equations lack contact nodes.
    pub walk: IncrementProgress,
    pub began: Instant,
    /// What the linear algebra had done before and after it.
    pub work: [Statistics; 2],
    /// Its wall time, s.
    pub seconds: f64,
}

impl IncrementDriver<'_> {
    /// How many increments may go together.
    pub(in crate::solver::history) fn batch_size(&self) -> usize {
        let operations = |whole: InteriorRecovery<'_>| {
            let free = whole.condensed.problem.displacements() as f64;
            4.0 * whole.condensed.info().entries as f64 + ITERATIONS * 2.0 / 3.0 * free.powi(3)
        };
        // A body that contact alone holds is carried first, to where the state of the whole says.
        let many =
            self.whole().is_some_and(|whole| operations(whole) < OPERATIONS) && self.problem.rigid_modes().is_empty();
        if many { MOST } else { 1 }
    }

    /// Solves the increments that end at `times`, as far as each ends as the method wants it: at least the first.
    pub(in crate::solver::history) fn ahead(
        &mut self,
        times: &[f64],
        linear: &mut RefinedSolver,
        progress: &mut Progress<'_>,
    ) -> Result<Bundle, LinearError> {
        let alone = times.len() == 1;
        let at = (!alone).then(|| self.at.clone());
        let first = progress.index;
        let (mut solved, mut states, mut forces) = (Vec::new(), Vec::new(), Vec::new());
        let mut is_current = true;
        for (k, &time) in times.iter().enumerate() {
            let (clock, before, start) = (Instant::now(), *linear.statistics(), self.start());
            progress.index = first + k;
            let input = self.pose(time);
            let outcome = match self.solve(time, &input, linear, &mut |iteration| progress.iteration(iteration)) {
                Err(_) if k > 0 => {
                    // It will come again, when those before it are judged.
                    self.go_back(start);
                    is_current = false;
                    break;
                }
                outcome => outcome?,
            };
            let (state, goes_on) = (self.method.state(), outcome.stop == Termination::Converged);
            if let (Some(whole), true) = (self.whole(), k + 1 < times.len()) {
                let w = whole.condensed.problem.contact_motion(&state.u).map(|w| whole.condensed.of_all_nodes(w));
                self.move_on(time, w, input.scales.with_state(&state));
            }
            let work = [before, *linear.statistics()];
            let seconds = clock.elapsed().as_secs_f64();
            solved.push(SolvedIncrement { time, began: clock, start, scales: input.scales, outcome, work, seconds });
            states.push((time, state));
            forces.push(self.force.clone());
            if !goes_on {
                break;
            }
        }
        progress.index = first;
        let clock = Instant::now();
        let balanced = match self.whole() {
            Some(whole) => whole.states(&states, &forces)?,
            None => states.into_iter().map(|(_, state)| self.balanced(state)).collect(),
        };
        let share = clock.elapsed().as_secs_f64() / solved.len() as f64;
        for pending in &mut solved {
            pending.seconds += share;
        }
        if let Some(at) = at {
            *self.at = at;
        }
        Ok(Bundle { pending: solved.into_iter().zip(balanced).collect(), alone, is_current, needs_no_refinement: true })
    }

    /// Judges the next increment of a bundle; `None` when there is none left, be it that the rest was taken back.
    pub(in crate::solver::history) fn judge(
        &mut self,
        batch: &mut Bundle,
        linear: &mut RefinedSolver,
        progress: &mut Progress<'_>,
    ) -> Result<Option<JudgedIncrement>, LinearError> {
        let Some((pending, balanced)) = batch.pending.pop_front() else { return Ok(None) };
        let clock = Instant::now();
        let SolvedIncrement { time, began, start, mut scales, outcome, work: [before, mut after], seconds } = pending;
        if !batch.alone {
            scales = self.pose(time).scales;
        }
        let needs_no_refinement =
            |whole: InteriorRecovery<'_>| whole.needs_no_refinement(&balanced, &scales.with_state(&balanced.state));
        batch.needs_no_refinement &= self.whole().is_none_or(needs_no_refinement);
        let is_current = batch.is_current && batch.pending.is_empty();
        let substep = if is_current {
            self.conclude(scales, outcome, balanced, linear)?
        } else {
            let substep = self.judged(scales, outcome, balanced);
            batch.needs_no_refinement &= substep.status == Status::Converged;
            if !batch.needs_no_refinement {
                self.go_back(start);
                batch.pending.clear();
                return Ok(None);
            }
            substep
        };
        let walk = self.increment(time, (start, substep), linear, progress)?;
        if let IncrementProgress::Ended(walked) = &walk {
            batch.needs_no_refinement &= walked.status == Status::Converged && walked.ends.len() == 1;
        }
        if is_current {
            after = *linear.statistics();
        }
        let seconds = seconds + clock.elapsed().as_secs_f64();
        Ok(Some(JudgedIncrement { time, walk, began, work: [before, after], seconds }))
    }
}
