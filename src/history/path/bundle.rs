//! Increments that are solved one after the other on the contact displacements, and judged together.
//!
//! The next increment asks for nothing but the contact displacements, and the interiors of several cost little more than that of
//! one. Each is judged on the whole body all the same, as if it had been alone; where one is not good enough as it stands, it
//! is taken back with those after it, and solved alone.

use std::collections::VecDeque;
use std::time::Instant;

use super::{Path, Start, Walk};
use crate::history::Status;
use crate::history::told::Told;
use crate::history::whole::{Balanced, Whole};
use crate::laws::KktScales;
use crate::linear::{Direct, LinearError, Statistics};
use crate::nonlinear::{Outcome, Stop};

/// The most that go together: beyond that the factors are hardly read less often.
const MOST: usize = 16;

/// What is solved and not yet judged is lost if a run is killed: increments of more operations than this, about a second,
/// go alone.
const OPERATIONS: f64 = 2e10;

/// Iterations of an increment, to estimate its operations.
const ITERATIONS: f64 = 5.0;

/// An increment that is solved and not yet judged.
struct Pending {
    time: f64,
    began: Instant,
    start: Start,
    scales: KktScales,
    outcome: Outcome,
    /// What the linear algebra had done before and after it.
    work: [Statistics; 2],
    /// Its wall time so far.
    seconds: f64,
}

/// Increments in a row that are to be judged.
pub(in crate::history) struct Bundle {
    pending: VecDeque<(Pending, Balanced)>,
    /// Whether there is only one.
    alone: bool,
    /// Whether the method is where the last one ends.
    is_current: bool,
    /// Whether all were good as they stood.
    pub sound: bool,
}

/// A judged increment.
pub(in crate::history) struct Judged {
    pub time: f64,
    /// How far it came; it has not ended where equations lack contact nodes.
    pub walk: Walk,
    pub began: Instant,
    /// What the linear algebra had done before and after it.
    pub work: [Statistics; 2],
    /// Its wall time, s.
    pub seconds: f64,
}

impl Path<'_> {
    /// How many increments may go together.
    pub(in crate::history) fn together(&self) -> usize {
        let operations = |whole: Whole<'_>| {
            let free = whole.condensed.problem.displacements() as f64;
            4.0 * whole.condensed.info().entries as f64 + ITERATIONS * 2.0 / 3.0 * free.powi(3)
        };
        // A body that contact alone holds is carried first, to where the state of the whole says.
        let many =
            self.whole().is_some_and(|whole| operations(whole) < OPERATIONS) && self.problem.free_motions().is_empty();
        if many { MOST } else { 1 }
    }

    /// Solves the increments that end at `times`, as far as each ends as the method wants it: at least the first.
    pub(in crate::history) fn ahead(
        &mut self,
        times: &[f64],
        linear: &mut Direct,
        told: &mut Told<'_>,
    ) -> Result<Bundle, LinearError> {
        let alone = times.len() == 1;
        let at = (!alone).then(|| self.at.clone());
        let first = told.index;
        let (mut solved, mut states, mut forces) = (Vec::new(), Vec::new(), Vec::new());
        let mut is_current = true;
        for (k, &time) in times.iter().enumerate() {
            let (clock, before, start) = (Instant::now(), *linear.statistics(), self.start());
            told.index = first + k;
            let posed = self.pose(time);
            let outcome = match self.solve(time, &posed, linear, &mut |iteration| told.iteration(iteration)) {
                Err(_) if k > 0 => {
                    // It will come again, when those before it are judged.
                    self.go_back(start);
                    is_current = false;
                    break;
                }
                outcome => outcome?,
            };
            let (state, goes_on) = (self.method.state(), outcome.stop == Stop::Met);
            if let (Some(whole), true) = (self.whole(), k + 1 < times.len()) {
                let w = whole.condensed.problem.contact_motion(&state.u).map(|w| whole.condensed.of_all_nodes(w));
                self.move_on(time, w, posed.scales.with_state(&state));
            }
            let work = [before, *linear.statistics()];
            let seconds = clock.elapsed().as_secs_f64();
            solved.push(Pending { time, began: clock, start, scales: posed.scales, outcome, work, seconds });
            states.push((time, state));
            forces.push(self.force.clone());
            if !goes_on {
                break;
            }
        }
        told.index = first;
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
        Ok(Bundle { pending: solved.into_iter().zip(balanced).collect(), alone, is_current, sound: true })
    }

    /// Judges the next increment of a bundle; `None` when there is none left, be it that the rest was taken back.
    pub(in crate::history) fn judge(
        &mut self,
        bundle: &mut Bundle,
        linear: &mut Direct,
        told: &mut Told<'_>,
    ) -> Result<Option<Judged>, LinearError> {
        let Some((pending, balanced)) = bundle.pending.pop_front() else { return Ok(None) };
        let clock = Instant::now();
        let Pending { time, began, start, mut scales, outcome, work: [before, mut after], seconds } = pending;
        if !bundle.alone {
            scales = self.pose(time).scales;
        }
        let is_sound = |whole: Whole<'_>| whole.is_sound(&balanced, &scales.with_state(&balanced.state));
        bundle.sound &= self.whole().is_none_or(is_sound);
        let is_current = bundle.is_current && bundle.pending.is_empty();
        let attempt = if is_current {
            self.conclude(scales, outcome, balanced, linear)?
        } else {
            let attempt = self.judged(scales, outcome, balanced);
            bundle.sound &= attempt.status == Status::Converged;
            if !bundle.sound {
                self.go_back(start);
                bundle.pending.clear();
                return Ok(None);
            }
            attempt
        };
        let walk = self.increment(time, (start, attempt), linear, told)?;
        if let Walk::Ended(walked) = &walk {
            bundle.sound &= walked.status == Status::Converged && walked.ends.len() == 1;
        }
        if is_current {
            after = *linear.statistics();
        }
        let seconds = seconds + clock.elapsed().as_secs_f64();
        Ok(Some(Judged { time, walk, began, work: [before, after], seconds }))
    }
}
