//! Contact forces that jump: increments in which they change by more than their share of the history, however short these are made.
//!
//! Where a quasi-static motion ends, an increment leads over its end to one of the states that the laws allow beyond, and every law holds at its
//! end. So increments that change the contact forces by several times what drives the body changes are solved again in parts, and the part with the
//! largest change in parts again. What follows the loads has its change spread over the parts; a jump stays in one of them, or has no solution
//! in increments that are shorter.

use serde::{Deserialize, Serialize};

use crate::contact::KktScales;
use crate::formulation::Layout;
use crate::history::{Edge, Error, HistorySettings, Means, Method, Observer, Status, Step};
use crate::model::Model;
use crate::nonlinear::{Flow, IterationRecord};
use crate::problem::{ContactProblem, State};
use crate::report::Leap;

/// A change of the contact forces that is a smaller share of their largest is not looked at.
const LARGE: f64 = 0.02;

/// Changes up to so many times the share of the loads are not looked at: contact that spreads changes forces faster than loads change.
const STEEP: f64 = 2.0;

/// So many increments are looked at, the steepest first.
const MOST: usize = 3;

/// An increment is solved again in so many parts, and the part with the largest change again, so many times in all.
const PARTS: usize = 8;
const ROUNDS: usize = 5;

/// The share of the change that stays in one part of a jump: the rest are the loads, which go on.
const STAYS: f64 = 0.5;

/// Watches the contact forces of a history.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub(super) struct Leaps {
    /// Whether forces may jump: without friction they follow the loads, and an exact path tells its end.
    may_jump: bool,
    /// The end of the last increment.
    last: Option<End>,
    /// The steepest increments, the steepest first.
    steepest: Vec<Steep>,
    /// The largest contact forces so far, see [`size`].
    largest: f64,
}

/// The end of an increment.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
struct End {
    time: f64,
    state: State,
}

/// An increment in which contact forces change much.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
struct Steep {
    from: End,
    to: End,
    /// The change of the contact forces, and the share of what drives the body that changes with it.
    change: f64,
    share: f64,
}

impl Leaps {
    /// Before the first increment of a history of `model` that `method` solves.
    pub(super) fn new(model: &Model, method: Method) -> Self {
        let layout = Layout::new(&model.problem);
        let has_friction = (0..layout.contacts()).any(|i| layout.has_friction(i));
        let may_jump = has_friction && !matches!(method, Method::Events { .. });
        Leaps { may_jump, last: None, steepest: Vec::new(), largest: 0.0 }
    }

    /// Whether those of another run of `model` may be gone on with.
    pub(super) fn fit(&self, model: &Model) -> bool {
        let fits = |end: &End| {
            end.state.u.len() == model.problem.displacements() && end.state.p_n.len() == model.problem.contacts()
        };
        let forces = |steep: &Steep| steep.to.state.p_n.len() == model.problem.contacts();
        self.last.iter().chain(self.steepest.iter().map(|steep| &steep.from)).all(fits)
            && self.steepest.iter().all(forces)
    }

    /// Looks at the end of an increment.
    pub(super) fn see(&mut self, model: &Model, step: &Step<'_>) {
        if step.record.status != Status::Converged || !self.may_jump {
            return;
        }
        let (problem, state) = (&model.problem, step.state);
        self.largest = self.largest.max(size(problem, state, None));
        let end = End::of(step);
        let to = End { state: contact_forces(state), ..end };
        let Some(from) = self.last.replace(end) else { return };
        let change = size(problem, state, Some(&from.state));
        let share = model.loading.change(from.time, to.time);
        if change <= LARGE * self.largest || change <= STEEP * share * self.largest {
            return;
        }
        let place = self.steepest.partition_point(|other| other.change * share > change * other.share);
        self.steepest.insert(place, Steep { from, to, change, share });
        self.steepest.truncate(MOST);
    }

    /// The increments that have to be solved again to tell whether contact forces jump in them.
    fn suspects(&self) -> impl Iterator<Item = &Steep> {
        self.steepest.iter().filter(|steep| steep.change > LARGE.max(STEEP * steep.share) * self.largest)
    }

    /// Whether there are some.
    pub(super) fn are_suspected(&self) -> bool {
        self.suspects().next().is_some()
    }

    /// The first of these increments in which contact forces jump; `observer` sees the iterations that tell it.
    ///
    /// # Errors
    /// When the linear algebra cannot go on.
    pub(super) fn first(
        &self,
        model: &Model,
        settings: &HistorySettings,
        scales: KktScales,
        means: &mut Means<'_>,
        observer: &mut dyn Observer,
    ) -> Result<Option<Leap>, Error> {
        let mut first: Option<Leap> = None;
        for steep in self.suspects() {
            let leap = steep.leap(model, settings, scales, means, observer)?;
            let leap = leap.map(|(from, to, change)| Leap { from, to, share: change / self.largest });
            first = [first, leap].into_iter().flatten().min_by(|a, b| a.from.total_cmp(&b.from));
        }
        Ok(first)
    }
}

impl Steep {
    /// Between which times (s) contact forces jump, and by how much, if they do.
    fn leap(
        &self,
        model: &Model,
        settings: &HistorySettings,
        scales: KktScales,
        means: &mut Means<'_>,
        observer: &mut dyn Observer,
    ) -> Result<Option<(f64, f64, f64)>, Error> {
        let (problem, loading) = (&model.problem, &model.loading);
        let (mut from, mut to, mut change) = (self.from.clone(), self.to.clone(), self.change);
        for _ in 0..ROUNDS {
            let part = (to.time - from.time) / PARTS as f64;
            let times: Vec<f64> = (1..PARTS).map(|k| from.time + k as f64 * part).chain([to.time]).collect();
            if times[0] <= from.time || times.windows(2).any(|pair| pair[1] <= pair[0]) {
                break;
            }
            let edge = Edge { problem, loading, settings, time: from.time, state: from.state.clone(), scales };
            let mut parts = Parts { observer, ends: vec![from] };
            let status = edge.go_on(&times, &mut parts, means)?;
            let mut ends = parts.ends;
            match status {
                Status::Converged => {}
                Status::Interrupted | Status::OutOfMemory => return Ok(None),
                // As a whole it has a solution.
                _ => ends.push(to.clone()),
            }
            let changes = ends.windows(2).map(|pair| size(problem, &pair[1].state, Some(&pair[0].state)));
            let Some((k, largest)) = changes.enumerate().max_by(|a, b| a.1.total_cmp(&b.1)) else { return Ok(None) };
            if largest < STAYS * self.change {
                return Ok(None);
            }
            let has_no_parts = status != Status::Converged && k + 2 == ends.len();
            (to, change) = (ends.swap_remove(k + 1), largest);
            from = ends.swap_remove(k);
            if has_no_parts {
                break;
            }
        }
        Ok(Some((from.time, to.time, change)))
    }
}

impl End {
    fn of(step: &Step<'_>) -> Self {
        End { time: step.record.time, state: step.state.clone() }
    }
}

/// Keeps the ends of increments, and of parts of them.
struct Parts<'a> {
    observer: &'a mut dyn Observer,
    ends: Vec<End>,
}

impl Observer for Parts<'_> {
    fn waits_for(&mut self, _index: usize) -> bool {
        false
    }

    fn iteration(&mut self, index: usize, record: &IterationRecord) -> Flow {
        self.observer.iteration(index, record)
    }

    fn part(&mut self, part: &Step<'_>) {
        self.ends.push(End::of(part));
    }

    fn increment(&mut self, step: &Step<'_>) -> Flow {
        if step.record.status == Status::Converged {
            self.ends.push(End::of(step));
        }
        Flow::Continue
    }
}

/// The contact forces of a state, or by how much they differ from those of another: the root of `Σ |p|² / l`.
fn size(problem: &ContactProblem, state: &State, other: Option<&State>) -> f64 {
    let weight = problem.weight();
    let forces = |state: &State, i: usize| [state.p_n[i], state.p_t[i], state.p_o[i]];
    let of_node = |i: usize| {
        let before = other.map_or([0.0; 3], |other| forces(other, i));
        let change = forces(state, i).into_iter().zip(before).map(|(p, before)| (p - before).powi(2));
        change.sum::<f64>() / weight.map_or(1.0, |l| l[i])
    };
    (0..problem.contacts()).map(of_node).sum::<f64>().sqrt()
}

/// What [`size`] needs of a state.
fn contact_forces(State { p_n, p_t, p_o, .. }: &State) -> State {
    State { p_n: p_n.clone(), p_t: p_t.clone(), p_o: p_o.clone(), ..State::default() }
}
