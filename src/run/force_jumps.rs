//! Jumps of contact forces: increments in which they change by a finite amount, however short the increments are.
//!
//! At the end of a quasi-static motion, an increment leads to one of the states that the laws allow beyond it, and
//! every law holds at its end. During a jump friction falls while nodes slip, which releases energy. Increments in
//! which this happens are therefore halved repeatedly, each time the half with the larger change. A change that follows
//! the loads is distributed over both halves. A jump remains in one of them, or has no solution in shorter increments.

use serde::{Deserialize, Serialize};

use crate::body::model::Model;
use crate::solver::formulation::Layout;
use crate::solver::history::{
    Error, HistoryMethod, HistorySettings, IncrementView, Observer, RestartPoint, Status, SystemSolver,
};
use crate::solver::laws::KktScales;
use crate::solver::newton::IterationRecord;
use crate::solver::problem::{ContactProblem, State};
use std::ops::ControlFlow;

/// Changes of the contact forces below this share of their largest value are ignored.
const LARGE: f64 = 0.02;

/// Changes in which friction releases a smaller share of the energy are ignored, see [`released`]. The share was at
/// most 0.05 for nodes that continue to slip, and 0.40 to 0.99 for increments across the end of a motion.
const RELEASED: f64 = 0.1;

/// The number of increments examined, those with the largest shares.
const MOST: usize = 3;

/// The number of times an increment is halved.
const ROUNDS: usize = 15;

/// A change that remains is a jump if the share fed by friction is larger than this, see [`released`]. The rest is fed
/// by the loads.
const FED_BY_FRICTION: f64 = 0.5;

/// The share of the change that remains in one half for a jump. The rest follows the loads.
const STAYS: f64 = 0.6;

/// An increment in which contact forces jump, however short it is made.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct ForceJump {
    /// Its beginning, s.
    pub from: f64,
    /// Its end, s.
    pub to: f64,
    /// The change of the contact forces relative to their largest value, both as the root of `Σ |p|² / l`.
    pub share: f64,
}

/// Collects increments in which contact forces may have jumped.
#[derive(Debug, Clone, PartialEq, Default, Serialize, Deserialize)]
pub(super) struct JumpDetector {
    /// `false` without friction, where contact forces follow the loads, and for an exact path, which finds its end
    /// itself.
    may_jump: bool,
    /// The end of the last increment.
    last: Option<End>,
    /// The increments that may be jumps, the largest share of released energy first.
    suspected: Vec<Suspect>,
    /// The largest contact forces so far, see [`size`].
    largest: f64,
}

/// The end of an increment.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
struct End {
    time: f64,
    state: State,
    /// The external nodal forces, N.
    force: Vec<f64>,
}

/// An increment with a large change of the contact forces in which friction releases energy.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
struct Suspect {
    from: End,
    to: End,
    /// The change of the contact forces, and the share [`released`].
    change: f64,
    released: f64,
}

impl JumpDetector {
    /// Begins a history of `model` solved by `method`.
    pub(super) fn new(model: &Model, method: HistoryMethod) -> Self {
        let layout = Layout::new(&model.problem);
        let has_friction = (0..layout.contacts()).any(|i| layout.has_friction(i));
        let may_jump = has_friction && !method.is_exact_path();
        JumpDetector { may_jump, ..JumpDetector::default() }
    }

    /// Returns the largest contact forces so far, as the root of `Σ |p|² / l`; 0 without friction.
    pub(super) fn largest(&self) -> f64 {
        self.largest
    }

    /// Returns `true` if the data, restored from another run, fits `model`.
    pub(super) fn fit(&self, model: &Model) -> bool {
        let fits = |end: &End| {
            end.state.u.len() == model.problem.displacements() && end.state.p_n.len() == model.problem.contacts()
        };
        let forces = |suspect: &Suspect| suspect.to.state.p_n.len() == model.problem.contacts();
        self.last.iter().chain(self.suspected.iter().map(|suspect| &suspect.from)).all(fits)
            && self.suspected.iter().all(forces)
    }

    /// Examines the end of an increment.
    pub(super) fn observe(&mut self, model: &Model, step: &IncrementView<'_>) {
        if step.record.status != Status::Converged || !self.may_jump {
            return;
        }
        let (problem, state) = (&model.problem, step.state);
        self.largest = self.largest.max(size(problem, state, None));
        let Some(from) = self.last.replace(End::of(step)) else { return };
        let change = size(problem, state, Some(&from.state));
        if change <= LARGE * self.largest {
            return;
        }
        let released = released(problem, step, &from);
        if released <= RELEASED {
            return;
        }
        let to = End { time: step.record.time, state: contact_forces(state), force: Vec::new() };
        let index = self.suspected.partition_point(|other| other.released > released);
        self.suspected.insert(index, Suspect { from, to, change, released });
        self.suspected.truncate(MOST);
    }

    /// Returns the increments that must be solved again to decide if contact forces jump in them.
    fn suspects(&self) -> impl Iterator<Item = &Suspect> {
        self.suspected.iter().filter(|suspect| suspect.change > LARGE * self.largest)
    }

    /// Returns `true` if there are such increments.
    pub(super) fn are_suspected(&self) -> bool {
        self.suspects().next().is_some()
    }

    /// Returns the first of these increments in which contact forces jump. `observer` sees the iterations of the new
    /// solutions.
    ///
    /// # Errors
    /// When the linear algebra cannot go on.
    pub(super) fn first(
        &self,
        model: &Model,
        settings: &HistorySettings,
        scales: &KktScales,
        system: &mut SystemSolver,
        observer: &mut dyn Observer,
    ) -> Result<Option<ForceJump>, Error> {
        let mut first: Option<ForceJump> = None;
        for suspect in self.suspects() {
            let jump = suspect.jump(model, settings, scales, system, observer)?;
            let jump = jump.map(|(from, to, change)| ForceJump { from, to, share: change / self.largest });
            first = [first, jump].into_iter().flatten().min_by(|a, b| a.from.total_cmp(&b.from));
        }
        Ok(first)
    }
}

impl Suspect {
    /// Returns the times (s) between which contact forces jump and the size of the jump, if any.
    fn jump(
        &self,
        model: &Model,
        settings: &HistorySettings,
        scales: &KktScales,
        system: &mut SystemSolver,
        observer: &mut dyn Observer,
    ) -> Result<Option<(f64, f64, f64)>, Error> {
        let (problem, loading) = (&model.problem, &model.loading);
        let (mut from, mut to, mut change) = (self.from.clone(), self.to.clone(), self.change);
        let stays = STAYS * self.change;
        let mut share = self.released;
        for _ in 0..ROUNDS {
            let middle = 0.5 * (from.time + to.time);
            if middle <= from.time || middle >= to.time {
                break;
            }
            let (state, scales) = (from.state.clone(), scales.clone());
            let edge = RestartPoint { problem, loading, settings, time: from.time, state, scales };
            let mut halves = Halves { observer, problem, stays, ends: vec![from], found: None };
            let status = edge.proceed(&[middle, to.time], &mut halves, system)?;
            let Halves { mut ends, found, .. } = halves;
            let Some(found) = found else {
                if matches!(status, Status::Converged | Status::Interrupted | Status::OutOfMemory) {
                    return Ok(None);
                }
                // The increment has a solution as a whole, but its remainder has none in halves.
                let Some(last) = ends.pop() else { return Ok(None) };
                let left = size(problem, &to.state, Some(&last.state));
                return Ok((left >= stays).then_some((last.time, to.time, left)));
            };
            let (Some(end), Some(begin)) = (ends.pop(), ends.pop()) else { return Ok(None) };
            ((change, share), to, from) = (found, end, begin);
        }
        // If loads or obstacles move fast, a change that follows them may be as short.
        Ok((share > FED_BY_FRICTION).then_some((from.time, to.time, change)))
    }
}

impl End {
    fn of(step: &IncrementView<'_>) -> Self {
        End { time: step.record.time, state: step.state.clone(), force: step.increment.force.to_vec() }
    }
}

/// Observer that keeps the ends of increments and substeps up to the first change as large as a jump.
struct Halves<'a> {
    observer: &'a mut dyn Observer,
    problem: &'a ContactProblem,
    stays: f64,
    ends: Vec<End>,
    /// The change, and the share released by friction in it.
    found: Option<(f64, f64)>,
}

impl Halves<'_> {
    fn add(&mut self, step: &IncrementView<'_>) {
        if self.found.is_some() {
            return;
        }
        let Some(last) = self.ends.last() else { return };
        let change = size(self.problem, step.state, Some(&last.state));
        if change >= self.stays {
            self.found = Some((change, released(self.problem, step, last)));
        }
        self.ends.push(End::of(step));
    }
}

impl Observer for Halves<'_> {
    fn iteration(&mut self, index: usize, record: &IterationRecord) -> ControlFlow<()> {
        self.observer.iteration(index, record)
    }

    fn substep(&mut self, substep: &IncrementView<'_>) {
        self.add(substep);
    }

    fn increment(&mut self, step: &IncrementView<'_>) -> ControlFlow<()> {
        if step.record.status == Status::Converged {
            self.add(step);
        }
        if self.found.is_some() { ControlFlow::Break(()) } else { ControlFlow::Continue(()) }
    }
}

/// Returns the norm of the contact forces of a state, or of their difference from those of another state.
fn size(problem: &ContactProblem, state: &State, other: Option<&State>) -> f64 {
    let forces = |state: &State, i: usize| [state.p_n[i], state.p_t[i], state.p_o[i]];
    problem.force_norm(|i| {
        let [n, t, o] = forces(state, i);
        let [before_n, before_t, before_o] = other.map_or([0.0; 3], |other| forces(other, i));
        [n - before_n, t - before_t, o - before_o]
    })
}

/// Returns the energy that friction releases in an increment, relative to the elastic energy of its change of
/// displacements: `-Σ Δp_T·Δw_T / (Δuᵀ K Δu)`, with the slip `Δw_T` and `Δuᵀ K Δu = Δfᵀ Δu - Σ Δp·Δw` from the balance
/// of forces at both ends.
///
/// Friction that opposes a change of slip takes energy, and the value is negative. Only the loads and friction feed a
/// jump, and the loads hardly change in it.
fn released(problem: &ContactProblem, step: &IncrementView<'_>, from: &End) -> f64 {
    let (state, before) = (step.state, &from.state);
    let change: Vec<f64> = state.u.iter().zip(&before.u).map(|(now, before)| now - before).collect();
    let loads: f64 =
        step.increment.force.iter().zip(&from.force).zip(&change).map(|((now, before), u)| (now - before) * u).sum();
    let product = |now: &[f64], before: &[f64], w: &[f64]| {
        now.iter().zip(before).zip(w).map(|((now, before), w)| (now - before) * w).sum::<f64>()
    };
    let tangential =
        |[w_t, w_o]: [&[f64]; 2]| product(&state.p_t, &before.p_t, w_t) + product(&state.p_o, &before.p_o, w_o);
    let [w_n, w_t, w_o] = problem.contact_motion(&change);
    let energy = loads - product(&state.p_n, &before.p_n, &w_n) - tangential([&w_t, &w_o]);
    let [_, now_t, now_o] = problem.contact_motion(&state.u);
    let slip = |now: &[f64], last: &[f64]| now.iter().zip(last).map(|(now, last)| now - last).collect::<Vec<f64>>();
    let slips = [slip(&now_t, step.increment.w_t_last), slip(&now_o, step.increment.w_o_last)];
    if energy > 0.0 { -tangential([&slips[0], &slips[1]]) / energy } else { 0.0 }
}

/// Returns the part of a state that [`size`] needs.
fn contact_forces(State { p_n, p_t, p_o, .. }: &State) -> State {
    State { p_n: p_n.clone(), p_t: p_t.clone(), p_o: p_o.clone(), ..State::default() }
}
