//! The exact path from event to event.

use super::dictionary::Dictionary;
use super::node::{AdmissibleTransition, Given, NodalContact, NodeStatus, largest};
use super::rate::Found;
use super::rate_problem::{Effort, RATE_ROUNDING, RateProblem, RateSearch};
use super::stretch::{PathLoads, Stretch};
use super::tangent::{Refined, Snapshot, SparseTangent, Tangent};
use super::{Equations, Event, PathEnd, PathError, PathSegment, SegmentEnd};
use crate::algebra::linear::{Computed, LinearError, Statistics};
use crate::base::units::Scaling;
use crate::solver::formulation::Layout;
use crate::solver::loading::Loading;
use crate::solver::problem::{ContactProblem, State};
use crate::solver::solvability::{Landing, Load, NEARBY, is_carried_without_strain, landing};
use serde::{Deserialize, Serialize};

/// A distance, pressure or friction reserve below this share of the largest counts as zero.
const NONE: f64 = 1e-13;

/// The number of consecutive steps of zero length after which the statuses are assumed to cycle.
const MAX_ZERO_STEPS: usize = 50;

/// The exact solution of a history up to the time reached.
pub struct ExactPath<'a> {
    loads: PathLoads<'a>,
    mu: &'a [f64],
    has_friction: Vec<bool>,
    equations: Refined<'a>,
    now: Reached,
}

/// The point of a path from which it continues.
#[derive(Clone, Serialize, Deserialize)]
struct Reached {
    #[serde(flatten)]
    stretch: Stretch,
    /// The completed share of the load segment.
    share: f64,
    statuses: Vec<NodeStatus>,
    /// The tangential position of each node at its last sticking, relative to the obstacle.
    w_t_stick: Vec<f64>,
    at: NodalContact,
    rate: NodalContact,
    /// `true` if `rate` remains valid; otherwise some nodes have just reached the border of a law.
    rates_valid: bool,
    at_bound: Vec<bool>,
    /// The largest force and the largest displacement so far.
    largest: [f64; 2],
    zero_steps: usize,
    effort: Effort,
}

/// A snapshot of an exact path between two steps.
#[derive(Clone, Serialize, Deserialize)]
pub(crate) struct SavedExactPath {
    #[serde(flatten)]
    now: Reached,
    equations: Snapshot,
    statistics: Statistics,
}

impl<'a> ExactPath<'a> {
    /// Creates a path from the unloaded body at the start of `loading`, with the `equations` to solve and the
    /// internal units `scaling`.
    ///
    /// # Errors
    /// [`PathError`] if nodes slide in a plane, if friction changes, or if contact rows are linearly dependent.
    pub fn new(
        problem: &'a ContactProblem,
        loading: &'a Loading,
        scaling: Scaling,
        equations: Equations<'a>,
    ) -> Result<Self, PathError> {
        loading.check(problem)?;
        let layout = Layout::new(problem);
        let contacts = problem.contacts();
        if (0..contacts).any(|i| layout.slides_in_a_plane(i)) {
            return Err(PathError::SlidesInAPlane);
        }
        if loading.friction().is_some() {
            return Err(PathError::FrictionChanges);
        }
        let tangents: Vec<Option<usize>> =
            (0..contacts).map(|i| layout.tangential(i).iter().position(Option::is_some)).collect();
        let has_friction: Vec<bool> = tangents.iter().map(Option::is_some).collect();
        let equations: Box<dyn Tangent + 'a> = match equations {
            Equations::Sparse(linear) => Box::new(SparseTangent::new(problem, tangents.clone(), scaling, linear)?),
            Equations::Dense => {
                Box::new(Dictionary::new(problem, &tangents, scaling)?.ok_or(PathError::DependentRows)?)
            }
        };
        let none = || NodalContact::zero(contacts);
        let refined = Refined::new(problem, tangents.clone(), scaling, equations);
        let loads = PathLoads { problem, loading, scaling, tangents };
        let now = Reached {
            stretch: Stretch::first(&loads),
            share: 0.0,
            statuses: vec![NodeStatus::Open; contacts],
            w_t_stick: vec![0.0; contacts],
            at: NodalContact { u: vec![0.0; problem.displacements()], ..none() },
            rate: none(),
            rates_valid: false,
            at_bound: vec![false; contacts],
            largest: [0.0; 2],
            zero_steps: 0,
            effort: Effort::default(),
        };
        let mut path = ExactPath { loads, mu: problem.mu(), has_friction, equations: refined, now };
        path.begin()?;
        Ok(path)
    }

    /// Sets the initial statuses. Nodes that touch start closed: if contact alone holds the body, all other statuses
    /// would be singular. Such a body first moves as a rigid body under the first loads, however small, until it
    /// comes to rest.
    fn begin(&mut self) -> Computed<()> {
        let landing = if is_carried_without_strain(self.loads.problem)? { self.landing() } else { None };
        let gap = &self.now.stretch.at.gap;
        let nodes = match landing {
            None => (0..gap.len()).filter(|&i| gap[i] <= 0.0).collect(),
            Some(Landing { weights, nodes }) => {
                let u = self.loads.problem.rigid_motion(&weights);
                let [w_n, w_t, w_o] = self.loads.problem.contact_motion(&u);
                let w_t = self.along([&w_t, &w_o], 1.0);
                self.now.at = NodalContact { w_n, w_t, u, ..NodalContact::zero(self.now.statuses.len()) };
                nodes
            }
        };
        for i in nodes {
            self.now.statuses[i] = if self.has_friction[i] { NodeStatus::Stick } else { NodeStatus::Forward };
        }
        self.now.w_t_stick =
            self.now.at.w_t.iter().zip(&self.now.stretch.at.slide).map(|(w, slide)| w - slide).collect();
        Ok(())
    }

    /// Finds the rest position of a rigid body under the first loads; `None` if nothing stops it.
    fn landing(&self) -> Option<Landing> {
        let Given { force, .. } = &self.now.stretch.change;
        let sizes: Vec<f64> = force.iter().map(|f| f.abs()).collect();
        let gap = &self.now.stretch.at.gap;
        let tolerance: Vec<f64> = gap.iter().map(|gap| NEARBY * gap.abs()).collect();
        landing(self.loads.problem, self.mu, &Load { force, sizes: &sizes }, gap, &tolerance)
    }

    /// Selects from values along both tangents those along each node's sliding tangent, in this `unit`.
    fn along(&self, values: [&Vec<f64>; 2], unit: f64) -> Vec<f64> {
        self.loads.tangents.iter().enumerate().map(|(i, k)| k.map_or(0.0, |k| values[k][i] / unit)).collect()
    }

    /// Advances to the next load segment.
    fn next_stretch(&mut self) {
        self.now.stretch.next(&self.loads);
        (self.now.share, self.now.rates_valid) = (0.0, false);
    }

    /// Returns the time reached, s.
    pub fn time(&self) -> f64 {
        self.now.stretch.time_at(self.now.share)
    }

    /// Returns `true` while the loads at t = 0 are still being applied, so that the state belongs to no time.
    pub fn is_beginning(&self) -> bool {
        self.now.stretch.times[1] == 0.0
    }

    /// Returns the status of each contact node since the last event.
    pub fn statuses(&self) -> &[NodeStatus] {
        &self.now.statuses
    }

    /// Returns the cost of the rate problems so far.
    pub fn effort(&self) -> Effort {
        self.now.effort
    }

    /// Returns the statistics of the linear solver so far.
    pub fn statistics(&self) -> Statistics {
        self.equations.statistics()
    }

    /// Returns the positions of the nodes along both tangents relative to their obstacles, n_c each, m; 0 along a
    /// tangent that a node does not have.
    pub fn slips(&self) -> [Vec<f64>; 2] {
        let slide = self.now.stretch.given_at(self.now.share).slide;
        let slip = |(w, slide): (&f64, &f64)| (w - slide) * self.loads.scaling.length;
        self.equations.along_both(&self.now.at.w_t.iter().zip(&slide).map(slip).collect::<Vec<_>>())
    }

    /// Returns the external forces (N, n_u), the gaps and the motions of the obstacles along both tangents (m, n_c)
    /// in the state reached. In a segment that is short compared with the time, they cannot be computed from the
    /// time.
    pub(crate) fn given(&self) -> (Vec<f64>, Vec<f64>, [Vec<f64>; 2]) {
        let Given { force, gap, slide } = self.now.stretch.given_at(self.now.share);
        let si = |values: Vec<f64>, unit: f64| values.into_iter().map(|value| value * unit).collect::<Vec<_>>();
        let slide = si(slide, self.loads.scaling.length);
        (si(force, self.loads.scaling.force), si(gap, self.loads.scaling.length), self.equations.along_both(&slide))
    }

    /// Returns the state reached, SI.
    pub fn state(&self) -> State {
        self.equations.state(&self.now.at)
    }

    /// Returns the change of state due to forces (N, n_u) while no node changes its status, SI.
    ///
    /// # Errors
    /// If the linear solver fails.
    pub(crate) fn response(&mut self, forces: &[f64]) -> Computed<State> {
        let zeros = || vec![0.0; self.now.statuses.len()];
        let force = forces.iter().map(|f| f / self.loads.scaling.force).collect();
        let mut change = NodalContact::zero(self.now.statuses.len());
        if !self.equations.solve(&Given { force, gap: zeros(), slide: zeros() }, &mut change)? {
            return Err(LinearError::NotFinite);
        }
        Ok(self.equations.state(&change))
    }

    /// Takes a snapshot of the path, from which it can continue later.
    pub(crate) fn save(&self) -> SavedExactPath {
        SavedExactPath { now: self.now.clone(), equations: self.equations.snapshot(), statistics: self.statistics() }
    }

    /// Restores the path from a snapshot. Returns `false` if the snapshot belongs to another problem.
    ///
    /// # Errors
    /// If the linear solver fails.
    pub(crate) fn resume(&mut self, saved: SavedExactPath) -> Computed<bool> {
        let fits = saved.fits(self.now.at.u.len(), self.now.statuses.len());
        if !fits || !self.equations.restore(&saved.equations)? {
            return Ok(false);
        }
        self.now = saved.now;
        Ok(true)
    }

    /// Advances to the next event, to the next corner of the loads, or to `until` (s), whichever comes first.
    ///
    /// # Errors
    /// If the linear solver fails.
    pub fn step(&mut self, until: f64) -> Result<PathSegment, PathError> {
        let mut events = Vec::new();
        let [start, end] = self.now.stretch.times;
        let wanted = if end.is_infinite() {
            0.0
        } else if until >= end {
            1.0
        } else {
            ((until - start) / (end - start)).max(self.now.share)
        };
        if !self.now.rates_valid {
            let before = self.now.statuses.clone();
            if let Some(lost) = self.decide()? {
                // The requested time is reached nevertheless. A further step will report the end of the path.
                let stop = if wanted - self.now.share <= NONE { SegmentEnd::Until } else { SegmentEnd::PathEnd(lost) };
                return Ok(PathSegment { events, friction_work: 0.0, stop });
            }
            let time = self.time();
            let changed = before.into_iter().zip(&self.now.statuses).enumerate().filter(|(_, (from, to))| from != *to);
            events.extend(changed.map(|(node, (from, to))| Event { time, node, from, to: *to }));
        }
        let (max_step, at_bound) = self.max_step();
        let target = if self.now.rates_valid && end.is_infinite() {
            self.now.share
        } else {
            (self.now.share + max_step).min(wanted)
        };
        let happens = !end.is_infinite() && self.now.share + max_step <= wanted;
        let friction_work = self.go(target);
        self.now.at_bound = if happens { at_bound } else { vec![false; at_bound.len()] };
        if happens && target < 1.0 {
            self.now.zero_steps = if max_step <= NONE { self.now.zero_steps + 1 } else { 0 };
            self.now.rates_valid = false;
            if self.now.zero_steps > MAX_ZERO_STEPS {
                let lost = PathEnd { time: self.time(), certain: false };
                return Ok(PathSegment { events, friction_work, stop: SegmentEnd::PathEnd(lost) });
            }
            return Ok(PathSegment { events, friction_work, stop: SegmentEnd::Event });
        }
        if end.is_infinite() || until < end {
            return Ok(PathSegment { events, friction_work, stop: SegmentEnd::Until });
        }
        let arrived = until == end && start < end;
        self.next_stretch();
        Ok(PathSegment { events, friction_work, stop: if arrived { SegmentEnd::Until } else { SegmentEnd::Corner } })
    }

    /// Finds the next statuses and their rates.
    fn decide(&mut self) -> Result<Option<PathEnd>, PathError> {
        let may: Vec<AdmissibleTransition> = (0..self.now.statuses.len()).map(|i| self.may(i)).collect();
        let mut statuses: Vec<NodeStatus> = (0..self.now.statuses.len()).map(|i| self.guess(i, may[i])).collect();
        let problem = RateProblem {
            problem: self.loads.problem,
            tangents: &self.loads.tangents,
            given: &self.now.stretch.change,
            mu: self.mu,
            has_friction: &self.has_friction,
            may: &may,
        };
        let (tangent, rate, effort) = (&mut self.equations, &mut self.now.rate, &mut self.now.effort);
        match (RateSearch { problem, tangent, rate, effort, best: None }).solve(&mut statuses)? {
            Found::Rates => {}
            found => {
                // Restores the equations of the state reached.
                self.equations.set_statuses(&self.now.statuses)?;
                return Ok(Some(PathEnd { time: self.time(), certain: matches!(found, Found::None) }));
            }
        }
        let mut given = self.now.stretch.given_at(self.now.share);
        for (i, status) in statuses.iter().enumerate() {
            if status.is_sticking() && !self.now.statuses[i].is_sticking() {
                self.now.w_t_stick[i] = self.now.at.w_t[i] - given.slide[i];
            }
        }
        (self.now.statuses, self.now.rates_valid) = (statuses, true);
        // Solving anew, instead of adding the rates, keeps rounding and the touching tolerance from accumulating.
        given.slide.iter_mut().zip(&self.now.w_t_stick).for_each(|(slide, w_t_stick)| *slide += w_t_stick);
        let mut anew = NodalContact::zero(self.now.statuses.len());
        if self.equations.solve(&given, &mut anew)? {
            self.now.at = anew;
        }
        self.measure(&given);
        Ok(None)
    }

    /// Records the largest force and displacement of a state under the `given` data.
    fn measure(&mut self, given: &Given) {
        let interference = given.gap.iter().fold(0.0_f64, |m, gap| m.max(-gap));
        let [force, length] = self.now.largest;
        self.now.largest = [
            force.max(self.now.at.force_scale(given)),
            length.max(self.now.at.largest_displacement()).max(interference),
        ];
    }

    /// Returns the distance of a node from its obstacle. Where displacements have low-order parts, it has them, too: a
    /// rounding of the gap would be a penetration at contact forces that are still small.
    fn distance(&self, i: usize) -> f64 {
        let Reached { stretch, share, at, .. } = &self.now;
        -self.loads.problem.c_n().difference(i, &at.u, &at.u_rest, stretch.at.gap[i] + share * stretch.change.gap[i])
    }

    /// Returns how far the friction of a node is from the border of its cone in the direction of `sign`.
    fn reserve(&self, i: usize, sign: f64) -> f64 {
        self.mu[i] * self.now.at.p_n[i] - sign * self.now.at.p_t[i]
    }

    /// Returns the admissible statuses of node `i` at its present position among the laws.
    fn may(&self, i: usize) -> AdmissibleTransition {
        let [force, length] = self.now.largest;
        match self.now.statuses[i] {
            NodeStatus::Open if self.now.at_bound[i] || self.distance(i) <= NONE * length => {
                AdmissibleTransition::Anything
            }
            NodeStatus::Open => AdmissibleTransition::Stay,
            _ if self.now.at.p_n[i] <= NONE * force => AdmissibleTransition::Anything,
            status if status.sign() != 0.0 && self.has_friction[i] => AdmissibleTransition::Turn(status.sign()),
            NodeStatus::Stick => {
                let sign = if self.now.at.p_t[i] < 0.0 { -1.0 } else { 1.0 };
                if self.now.at_bound[i] || self.reserve(i, sign) <= NONE * force {
                    AdmissibleTransition::Turn(sign)
                } else {
                    AdmissibleTransition::Stay
                }
            }
            _ => AdmissibleTransition::Stay,
        }
    }

    /// Guesses the initial status of node `i` from its last rates.
    fn guess(&self, i: usize, may: AdmissibleTransition) -> NodeStatus {
        let status = self.now.statuses[i];
        let slip = self.now.rate.w_t[i] - self.now.stretch.change.slide[i];
        match (may, status) {
            _ if !self.now.at_bound[i] => status,
            (AdmissibleTransition::Anything, NodeStatus::Open) if self.has_friction[i] => NodeStatus::slip(slip),
            (AdmissibleTransition::Anything, NodeStatus::Open) => NodeStatus::Forward,
            (AdmissibleTransition::Anything, _) => NodeStatus::Open,
            (AdmissibleTransition::Turn(sign), NodeStatus::Stick) => NodeStatus::slip(sign),
            _ => status,
        }
    }

    /// Returns the share of the segment at which a node first reaches the border of a law, and which nodes do.
    fn max_step(&self) -> (f64, Vec<bool>) {
        let Reached { rate, stretch, .. } = &self.now;
        let force = rate.force_scale(&stretch.change);
        let length = rate.largest_displacement().max(largest(&stretch.change.gap));
        let until = |left: f64, pace: f64, scale: f64| {
            if pace > RATE_ROUNDING * scale { left.max(0.0) / pace } else { f64::INFINITY }
        };
        let of_node = |i: usize| match self.now.statuses[i] {
            NodeStatus::Open => until(self.distance(i), rate.w_n[i] - stretch.change.gap[i], length),
            status => {
                let leaves = until(self.now.at.p_n[i], -rate.p_n[i], force);
                if status != NodeStatus::Stick {
                    return leaves;
                }
                let slips =
                    |sign: f64| until(self.reserve(i, sign), sign * rate.p_t[i] - self.mu[i] * rate.p_n[i], force);
                leaves.min(slips(1.0)).min(slips(-1.0))
            }
        };
        let shares: Vec<f64> = (0..self.now.statuses.len()).map(of_node).collect();
        let least = shares.iter().fold(f64::INFINITY, |m, share| m.min(*share));
        (least, shares.iter().map(|share| *share <= least + NONE).collect())
    }

    /// Advances to `share` of the segment. Returns the work that friction dissipates in the step, J.
    fn go(&mut self, share: f64) -> f64 {
        let (before, passed) = (self.now.at.p_t.clone(), share - self.now.share);
        self.now.at.add(passed, &self.now.rate);
        self.now.share = share;
        self.measure(&self.now.stretch.given_at(share));
        let of_node = |i: usize| {
            let slip = passed * (self.now.rate.w_t[i] - self.now.stretch.change.slide[i]);
            0.5 * (before[i] + self.now.at.p_t[i]) * slip
        };
        let slipping = (0..self.now.statuses.len()).filter(|&i| self.now.statuses[i].sign() != 0.0);
        slipping.map(of_node).sum::<f64>() * self.loads.scaling.force * self.loads.scaling.length
    }
}

impl SavedExactPath {
    /// Returns the statistics of the linear solver at the snapshot.
    pub(crate) fn statistics(&self) -> Statistics {
        self.statistics
    }

    /// Returns `true` if the snapshot has these numbers of displacements and contact nodes.
    fn fits(&self, displacements: usize, contacts: usize) -> bool {
        let given = |given: &Given| {
            given.force.len() == displacements && given.gap.len() == contacts && given.slide.len() == contacts
        };
        let contact = |contact: &NodalContact| {
            let NodalContact { w_n, w_t, p_n, p_t, u, u_rest, .. } = contact;
            // Rates that were never computed have no displacements.
            [w_n, w_t, p_n, p_t].iter().all(|values| values.len() == contacts)
                && [u, u_rest].iter().all(|values| [0, displacements].contains(&values.len()))
        };
        given(&self.now.stretch.at)
            && given(&self.now.stretch.change)
            && contact(&self.now.at)
            && self.now.at.u.len() == displacements
            && contact(&self.now.rate)
            && [self.now.statuses.len(), self.now.w_t_stick.len(), self.now.at_bound.len()] == [contacts; 3]
            && [0, contacts].contains(&self.equations.statuses.len())
    }
}
