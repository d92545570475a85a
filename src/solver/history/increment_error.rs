//! The time-step error of backward Euler, estimated while a history is solved.
//!
//! Backward Euler errs in two ways. A node that begins to stick within an increment does so at a slightly wrong
//! position, and remains there. The friction work is computed with the final force for all of the slip. Let
//! `(u', p')` be the initial rate of the solution along the contact cases at the start of an increment.
//!
//! - A node that was open touches after the share `τ = gap / (w_n' - g')` of the increment and has slid `δ = τ w_T'`
//!   by then. A node that slips and would continue to do so sticks half way through, `δ = ½ w_T'`. A node that
//!   touches, and slips in the increment by less than `τ w_T'`, did all of that before it touched and sticks
//!   `δ = τ w_T' - Δw_T` farther on: its friction error is the force that holds it there, at most twice its friction.
//! - This gives an error `e = (e_u, e_p)` of the solution, `K e_u + Cᵀ e_p = 0` along the cases at its end: `w_T(e)`
//!   grows by `δ` at nodes that begin to stick, is constant at sticking nodes, and vanishes by slip.
//! - The work is `Σ ½ (μ_0 p_n0 + μ_1 p_n1) |Δw_T|`, or nearer to the end for nodes that stick at the start
//!   ([`Node::mean_over_slip`]), with both forces and the slip corrected by `e`, and with `|δ|` of
//!   the nodes that began to stick. If nodes slide in a plane, only this is done, with `e = 0`, and nodes that begin
//!   to stick are counted.
//!
//! An increment therefore costs one solve for the rate, with the factors at its start, and one for `e`, with those at
//! its end. An increment in which the first nodes touch and slide costs another factorisation.

use super::body::Body;
use crate::algebra::linear::{Computed, LinearError, RefinedSolver};
use crate::base::units::Scaling;
use crate::solver::formulation::Bdiff;
use crate::solver::laws::coulomb::{TangentialCase, length, positive};
use crate::solver::newton::Bn;
use crate::solver::problem::{ContactProblem, Increment};
use serde::{Deserialize, Serialize};

/// Load changes count as having different directions if the cosine between them is smaller.
const CORNER: f64 = 0.9;

/// A smaller share of the slip in the motion of the nodes, or of a time in the increment, counts as rounding.
const NEGLIGIBLE: f64 = 1e-9;

/// A node that slides in an increment although it should stick counts if its friction error may exceed this share of
/// the largest friction of all nodes so far. Smaller errors give no warning.
const NOTABLE: f64 = 0.05;

/// Tangential forces below this share of the possible friction are rounding, and have no error.
const NO_FRICTION: f64 = 1e-8;

/// The estimated time-step error of a history's friction work and tangential forces.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize, schemars::JsonSchema)]
pub struct IncrementError {
    /// The computed work that friction dissipated, J; in two dimensions J per m of depth.
    pub friction_work: f64,
    /// The corrected work, J; in two dimensions J per m of depth.
    pub friction_work_corrected: f64,
    /// The relative time-step error of the work; negative if the computed work is too small.
    pub work_error: f64,
    /// The part of `work_error` from the first increment, which more increments leave if loads exist at t = 0.
    pub first_work_error: f64,
    /// The largest error of the tangential forces relative to their largest values; `None` if nodes slide in a plane.
    pub force_error: Option<f64>,
    /// The error of the sum of the tangential forces where it is largest, relative to it; `None` if nodes slide in a plane.
    pub resultant_error: Option<f64>,
    /// The number of increments or substeps in which nodes began to stick that were open or slipping at the start.
    pub sticking_begins: usize,
    /// The smallest number of increments in a load segment (loads change in one direction) in which nodes begin to
    /// stick.
    pub fewest: Option<usize>,
}

/// The accumulated time-step error, and the end of the last increment.
#[derive(Debug, Clone, Serialize, Deserialize)]
pub struct IncrementErrors {
    scaling: Scaling,
    /// `true` if no node slides in a plane.
    is_straight: bool,
    force: Vec<f64>,
    gap: Vec<f64>,
    nodes: Vec<Node>,
    /// The change of the loads in the last increment.
    change: Vec<f64>,
    /// The number of increments since the loads changed direction, and `true` if nodes began to stick in them.
    stretch: (usize, bool),
    fewest: Option<usize>,
    sticking_begins: usize,
    work: f64,
    corrected: f64,
    /// `work - corrected` after the first increment.
    first: Option<f64>,
    /// The largest norms of `e_p`, of `p_T` and of `μ p_n`.
    largest: [f64; 3],
    /// The largest sums of `p_T`, each with that of `e_p` at the same time.
    sums: [f64; 2],
}

/// A contact node at the end of an increment, in the units of the scaling.
#[derive(Debug, Clone, Copy, Serialize, Deserialize)]
struct Node {
    closed: bool,
    case: TangentialCase,
    /// `g - w_n`, nonnegative.
    distance: f64,
    p_n: f64,
    p: [f64; 2],
    mu: f64,
    w: [f64; 2],
    /// The error `e` of `w_T`; `error_p_n` is the error of `p_n`.
    error_w: [f64; 2],
    error_p_n: f64,
}

impl Node {
    /// Creates a node that is open, or closed with unknown tangential case.
    fn at(distance: f64, w: [f64; 2]) -> Self {
        let closed = distance <= 0.0;
        let case = if closed { TangentialCase::Stick } else { TangentialCase::NoPressure };
        let (p_n, mu, nothing) = (0.0, 0.0, [0.0; 2]);
        Node { closed, case, distance: positive(distance), p_n, p: nothing, mu, w, error_w: nothing, error_p_n: 0.0 }
    }

    /// Returns `true` if the node was open, or slipped while the loads kept their direction, and sticks now. The
    /// farthest node sets the size of rounding.
    fn begins_to_stick(&self, now: TangentialCase, farthest: f64, turned: bool) -> bool {
        let slipped = matches!(self.case, TangentialCase::Slip { .. }) && !turned;
        now == TangentialCase::Stick && (slipped || self.distance > NEGLIGIBLE * farthest)
    }

    /// Returns the mean of a quantity over the slip of an increment, as a share between its values at the start and at
    /// the end, where the coefficient of friction is `mu`. A node that sticks at the start begins to slip after the share
    /// `τ` of the increment, by its `rate`; its slip then grows with the square of time, so that the share is `(2 + τ) / 3`.
    fn mean_over_slip(&self, rate: Option<&NodeRate>, mu: f64) -> f64 {
        if !(self.closed && self.case == TangentialCase::Stick && self.p_n > 0.0) {
            return 0.5;
        }
        let excess = |rate: &NodeRate, share: f64| {
            let bound = (self.mu + share * (mu - self.mu)) * positive(self.p_n + share * rate.p_n);
            length([0, 1].map(|d| self.p[d] + share * rate.p[d])) - bound
        };
        (2.0 + rate.map_or(0.0, |rate| bisected(|share| excess(rate, share)))) / 3.0
    }

    /// Returns `true` if the node is at a distance from the obstacle.
    fn is_open(&self) -> bool {
        self.distance > 0.0
    }
}

/// The changes at a node in an increment in which no node changes its case: its approach, slip and forces.
#[derive(Debug, Clone, Copy)]
pub(super) struct NodeRate {
    approach: f64,
    slip: [f64; 2],
    p_n: f64,
    p: [f64; 2],
}

/// The initial rate of an increment.
pub(super) type Rate = Vec<NodeRate>;

/// BN's equations, with the solver of their linearisation.
pub(super) struct ErrorEquations<'a> {
    pub formulation: &'a mut Bdiff,
    pub bn: &'a mut Bn,
    pub linear: &'a mut RefinedSolver,
}

impl ErrorEquations<'_> {
    /// Linearises and factors for these cases, unless the last linearisation has them. Returns `true` if the matrix is
    /// regular.
    fn linearize_for(&mut self, cases: &[(bool, TangentialCase)]) -> Computed<bool> {
        if self.bn.has_factors(self.linear) && self.formulation.is_linearized_for(cases) {
            return Ok(true);
        }
        self.formulation.linearize_for(cases);
        self.bn.factor(self.formulation, self.linear)
    }

    /// Returns the change of the solution when the forces change by `force`, the gaps by `gap`, and the origins of slip by
    /// `origin`, or `None` if it is not finite.
    fn change(
        &mut self,
        force: impl IntoIterator<Item = f64>,
        gap: &[f64],
        origin: &[[f64; 2]],
    ) -> Computed<Option<Vec<f64>>> {
        let b = self.formulation.change(force, gap, origin);
        let mut x = vec![0.0; b.len()];
        match self.linear.solve_roughly(&b, &mut x) {
            Ok(()) => Ok(x.iter().all(|x| x.is_finite()).then_some(x)),
            Err(LinearError::NotFinite) => Ok(None),
            Err(error) => Err(error),
        }
    }
}

impl IncrementErrors {
    /// Creates the estimate before the first increment, with these gaps (m) of the unloaded body. Returns `None` if
    /// no node has friction.
    pub(super) fn new(problem: &ContactProblem, formulation: &Bdiff, gap: &[f64]) -> Option<Self> {
        let (layout, scaling) = (formulation.layout(), *formulation.scaling());
        let contacts = 0..layout.contacts();
        if !contacts.clone().any(|i| layout.has_friction(i)) || gap.len() != layout.contacts() {
            return None;
        }
        let gap: Vec<f64> = gap.iter().map(|gap| gap / scaling.length).collect();
        Some(IncrementErrors {
            scaling,
            is_straight: !contacts.into_iter().any(|i| layout.slides_in_a_plane(i)),
            force: vec![0.0; problem.displacements()],
            nodes: gap.iter().map(|gap| Node::at(*gap, [0.0; 2])).collect(),
            gap,
            change: Vec::new(),
            stretch: (0, false),
            fewest: None,
            sticking_begins: 0,
            work: 0.0,
            corrected: 0.0,
            first: None,
            largest: [0.0; 3],
            sums: [0.0; 2],
        })
    }

    /// Continues with another working set at `time` (s), given all displacements (m). The errors of the `nodes` in
    /// the old working set are kept; nodes that join were open.
    pub(super) fn continue_from(
        &mut self,
        before: &IncrementErrors,
        nodes: &[usize],
        body: Body<'_>,
        time: f64,
        [w_n, w_t, w_o]: [&[f64]; 3],
    ) {
        let Scaling { force, length } = self.scaling;
        let (problem, loading) = body.solved();
        let mut forces = vec![0.0; problem.displacements()];
        loading.force(time, &mut forces);
        for f in &mut forces {
            *f /= force;
        }
        let gap: Vec<f64> = body.loading.gaps_at(time).iter().map(|gap| gap / length).collect();
        let mut all: Vec<Node> = gap
            .iter()
            .enumerate()
            .map(|(i, gap)| Node::at(gap - w_n[i] / length, [w_t[i] / length, w_o[i] / length]))
            .collect();
        nodes.iter().zip(&before.nodes).for_each(|(&i, node)| all[i] = *node);
        let now = |i: usize| (all[i], gap[i]);
        let (nodes, gap) = match body.nodes() {
            Some(nodes) => nodes.iter().map(|&i| now(i)).unzip(),
            None => (0..all.len()).map(now).unzip(),
        };
        *self = IncrementErrors { force: forces, gap, nodes, change: Vec::new(), ..*before };
    }

    /// Returns `true` if the snapshot `saved` has the sizes of this problem.
    pub(super) fn fit(&self, saved: &IncrementErrors) -> bool {
        let sizes = |of: &IncrementErrors| [of.force.len(), of.gap.len(), of.nodes.len()];
        let known = sizes(saved)[0] + 3 * sizes(saved)[1];
        sizes(self) == sizes(saved) && [0, known].contains(&saved.change.len())
    }

    /// Returns the estimate so far.
    pub(super) fn found(&self) -> IncrementError {
        let joule = self.scaling.force * self.scaling.length;
        let [error, force, bears] = self.largest;
        let is_none = force <= NO_FRICTION * bears;
        let relative = |error: f64, of: f64| if error == 0.0 { 0.0 } else { error / of };
        IncrementError {
            friction_work: self.work * joule,
            friction_work_corrected: self.corrected * joule,
            work_error: relative(self.work - self.corrected, self.work),
            first_work_error: relative(self.first.unwrap_or(0.0), self.work),
            force_error: self.is_straight.then(|| if is_none { 0.0 } else { relative(error, force) }),
            resultant_error: self.is_straight.then(|| if is_none { 0.0 } else { relative(self.sums[0], self.sums[1]) }),
            sticking_begins: if is_none { 0 } else { self.sticking_begins },
            fewest: self.fewest_so_far().filter(|_| !is_none),
        }
    }

    /// Returns the smallest number of increments, including the load segment in progress.
    fn fewest_so_far(&self) -> Option<usize> {
        let (increments, sticks) = self.stretch;
        let now = sticks.then_some(increments);
        self.fewest.into_iter().chain(now).min()
    }

    /// Returns the initial rate of the next increment, if it is needed and can be computed.
    pub(super) fn rate(&self, increment: &Increment<'_>, at: &mut ErrorEquations<'_>) -> Computed<Option<Rate>> {
        if !self.is_straight {
            return Ok(None);
        }
        let cases: Vec<_> = self.nodes.iter().map(|node| (node.closed, node.case)).collect();
        // Pinning springs of an unconstrained mode would carry the loads.
        if !at.linearize_for(&cases)? || at.formulation.is_pinned() {
            return Ok(None);
        }
        let unit = self.scaling;
        let force = increment.force.iter().zip(&self.force).map(|(now, before)| now / unit.force - before);
        let (gap, origin) = self.moved(increment);
        let change = at.change(force, &gap, &origin)?;
        Ok(change.map(|change| self.rate_of(&change, increment, at.formulation)))
    }

    /// Returns the changes of the gaps and of the origins of slip in an increment.
    fn moved(&self, increment: &Increment<'_>) -> (Vec<f64>, Vec<[f64; 2]>) {
        let length = self.scaling.length;
        let gap = increment.gap.iter().zip(&self.gap).map(|(now, before)| now / length - before).collect();
        let origins = increment.w_t_last.iter().zip(increment.w_o_last).zip(&self.nodes);
        (gap, origins.map(|((t, o), node)| [t / length - node.w[0], o / length - node.w[1]]).collect())
    }

    /// Returns the rate of an increment in which the solution changes by `change` if no node changes its case.
    pub(super) fn rate_of(&self, change: &[f64], increment: &Increment<'_>, formulation: &Bdiff) -> Rate {
        let (gap, origin) = self.moved(increment);
        let of_node = |i: usize| {
            let (w, origin) = (formulation.w_t(i, change), origin[i]);
            NodeRate {
                approach: formulation.w_n(i, change) - gap[i],
                slip: [w[0] - origin[0], w[1] - origin[1]],
                p_n: change[formulation.layout().p_n(i)],
                p: formulation.p_t(i, change),
            }
        };
        let mut rate: Rate = (0..self.nodes.len()).map(of_node).collect();
        let largest = rate.iter().fold(0.0_f64, |m, rate| m.max(rate.approach.abs()).max(length(rate.slip)));
        for rate in &mut rate {
            if length(rate.slip) <= NEGLIGIBLE * largest {
                rate.slip = [0.0; 2];
            }
        }
        rate
    }

    /// Adds the increment that ends at `z`, which had this initial `rate`.
    pub(super) fn follow(
        &mut self,
        rate: Option<&Rate>,
        weight: Option<&[f64]>,
        at: &mut ErrorEquations<'_>,
        z: &[f64],
    ) -> Computed<()> {
        let formulation = &*at.formulation;
        let layout = formulation.layout().clone();
        let turned = self.turn(formulation);
        let cases: Vec<(bool, TangentialCase)> =
            (0..self.nodes.len()).map(|i| (formulation.is_closed(i, z), formulation.friction_case(i, z))).collect();
        let farthest = self.nodes.iter().map(|node| node.distance).fold(0.0, f64::max);
        let begin = |i: usize| {
            let rate = rate.filter(|_| self.is_straight && layout.has_friction(i)).map(|rate| &rate[i]);
            Begin::of(&self.nodes[i], cases[i].1, formulation.slip(i, z), rate)
        };
        let mut begins: Vec<Begin> = (0..self.nodes.len()).map(begin).collect();
        let clamped_error = self.held_at_first_touch(&cases, &mut begins, turned, weight, at, z)?;
        let mut sticks = false;
        for (i, begin) in begins.iter_mut().enumerate().filter(|(i, _)| layout.has_friction(*i)) {
            let node = &self.nodes[i];
            sticks |= if self.is_straight { begin.sticks } else { node.begins_to_stick(cases[i].1, farthest, turned) };
            if turned && !node.is_open() {
                // The rate follows the old cases, along which it may have the wrong direction.
                begin.delta = [0.0; 2];
            }
        }
        self.sticking_begins += usize::from(sticks);
        self.stretch.1 |= sticks;
        let error = self.transport(&cases, &begins, at)?;
        let formulation = &*at.formulation;

        for (i, begin) in begins.iter().enumerate() {
            let (gap, mu, _) = formulation.at_node(i);
            let (p_n, slip, w) = (z[layout.p_n(i)], formulation.slip(i, z), formulation.w_t(i, z));
            let (error_w, error_p_n) =
                error.as_ref().map_or(([0.0; 2], 0.0), |error| (formulation.w_t(i, error), error[layout.p_n(i)]));
            let before = self.nodes[i];
            let (closed, case) = cases[i];
            let [first, last] = [before.mu * positive(before.p_n + before.error_p_n), mu * positive(p_n + error_p_n)];
            let friction = first + before.mean_over_slip(rate.map(|rate| &rate[i]), mu) * (last - first);
            if let (TangentialCase::Slip { direction, .. }, true) = (case, layout.has_friction(i)) {
                let p = formulation.p_t(i, z);
                let corrected = |d: usize| slip[d] + error_w[d] - before.error_w[d] - begin.before_touch[d];
                self.work += p[0] * slip[0] + p[1] * slip[1];
                self.corrected += friction * positive(direction[0] * corrected(0) + direction[1] * corrected(1));
            } else if begin.slipped {
                self.corrected += friction * length(begin.delta);
            }
            let distance = if closed { 0.0 } else { positive(gap - formulation.w_n(i, z)) };
            let p = formulation.p_t(i, z);
            self.nodes[i] = Node { closed, case, distance, p_n, p, mu, w, error_w, error_p_n };
        }
        self.first.get_or_insert(self.work - self.corrected);
        let sizes = [error.as_deref(), Some(z)].map(|z| z.map_or(0.0, |z| friction_of_all(formulation, weight, z)));
        let bounds = (0..layout.contacts()).map(|i| {
            let (_, mu, _) = formulation.at_node(i);
            (mu * z[layout.p_n(i)]).powi(2) / weight.map_or(1.0, |l| l[i])
        });
        let sizes = [sizes[0], sizes[1], bounds.sum::<f64>().sqrt()];
        self.largest = [0, 1, 2].map(|k| self.largest[k].max(sizes[k]));
        let sums = [error.as_deref(), Some(z)].map(|z| z.map_or(0.0, |z| resultant(formulation, z)));
        if sums[1] > self.sums[1] {
            self.sums = sums;
        }
        self.largest[0] = self.largest[0].max(clamped_error);
        self.force.copy_from_slice(formulation.force());
        self.gap = (0..layout.contacts()).map(|i| formulation.at_node(i).0).collect();
        Ok(())
    }

    /// Returns the largest friction error of nodes that should stick where they touch, although the increment lets
    /// them slide.
    ///
    /// These are the nodes of the first touch: the rate is valid for them, and may not be for later ones. Their error
    /// is solved for with the nodes clamped where they touch. It is not carried on, since later increments have other
    /// cases.
    fn held_at_first_touch(
        &self,
        cases: &[(bool, TangentialCase)],
        begins: &mut [Begin],
        turned: bool,
        weight: Option<&[f64]>,
        at: &mut ErrorEquations<'_>,
        z: &[f64],
    ) -> Computed<f64> {
        let slips = |node: &Node| matches!(node.case, TangentialCase::Slip { .. });
        // Slipping nodes may stick when loads change direction; then the rate along their cases is wrong.
        let is_led = !(turned && self.nodes.iter().any(slips));
        let first = begins.iter().filter_map(|begin| begin.touches).fold(f64::INFINITY, f64::min);
        let notable = NOTABLE * self.largest[1].max(friction_of_all(at.formulation, weight, z));
        // Friction stays within the cone, so its error is at most the width of the cone, twice its size.
        let widths: Vec<f64> = (0..begins.len()).map(|i| 2.0 * friction_at(at.formulation, weight, i, z)).collect();
        let mut clamped_cases = cases.to_vec();
        let mut clamped = Vec::new();
        for (i, begin) in begins.iter_mut().enumerate() {
            if begin.sticks && matches!(cases[i].1, TangentialCase::Slip { .. }) {
                // A touch that the rate did not predict counts as one at the end.
                let is_first = begin.touches == Some(first) && first < 1.0;
                if is_first && is_led && widths[i] > notable {
                    clamped_cases[i].1 = TangentialCase::Stick;
                    clamped.push(i);
                } else {
                    *begin = Begin { sticks: false, delta: [0.0; 2], ..*begin };
                }
            }
        }
        let error = if clamped.is_empty() { None } else { self.transport(&clamped_cases, begins, at)? };
        let mut largest = 0.0_f64;
        for i in clamped {
            let by_place = error.as_ref().map_or(0.0, |error| friction_at(at.formulation, weight, i, error));
            let most = by_place.min(widths[i]);
            let sticks = most > notable;
            begins[i] = Begin { sticks, delta: [0.0; 2], ..begins[i] };
            largest = largest.max(if sticks { most } else { 0.0 });
        }
        Ok(largest)
    }

    /// Returns `true` if the loads change in another direction than in the increment before.
    fn turn(&mut self, formulation: &Bdiff) -> bool {
        let nodes = self.nodes.iter().enumerate().map(|(i, node)| (node, formulation.at_node(i)));
        let forces = formulation.force().iter().zip(&self.force).map(|(now, before)| now - before);
        let moved = nodes.zip(&self.gap).flat_map(|((node, (gap, _, origin)), before)| {
            [gap - before, origin[0] - node.w[0], origin[1] - node.w[1]]
        });
        let change: Vec<f64> = forces.chain(moved).collect();
        let dot = |a: &[f64], b: &[f64]| a.iter().zip(b).map(|(a, b)| a * b).sum::<f64>();
        let sizes = dot(&change, &change).sqrt() * dot(&self.change, &self.change).sqrt();
        let turned = sizes > 0.0 && dot(&change, &self.change) < CORNER * sizes;
        if turned {
            self.fewest = self.fewest_so_far();
            self.stretch = (0, false);
        }
        if change.iter().any(|change| *change != 0.0) {
            self.change = change;
            self.stretch.0 += 1;
        }
        turned
    }

    /// Returns `e` at the end of an increment with these cases, or `None` if it is 0 or cannot be computed.
    fn transport(
        &self,
        cases: &[(bool, TangentialCase)],
        begins: &[Begin],
        at: &mut ErrorEquations<'_>,
    ) -> Computed<Option<Vec<f64>>> {
        let moved = |((node, (_, case)), begin): ((&Node, &(bool, TangentialCase)), &Begin)| match case {
            TangentialCase::Stick => [0, 1].map(|d| node.error_w[d] + begin.delta[d]),
            _ => [0.0; 2],
        };
        let origin: Vec<[f64; 2]> = self.nodes.iter().zip(cases).zip(begins).map(moved).collect();
        if !self.is_straight || origin.iter().all(|w| *w == [0.0; 2]) || !at.linearize_for(cases)? {
            return Ok(None);
        }
        at.change([], &vec![0.0; origin.len()], &origin)
    }
}

/// Returns the tangential force of node `i` at `z`, divided by the square root of its weight.
fn friction_at(formulation: &Bdiff, weight: Option<&[f64]>, i: usize, z: &[f64]) -> f64 {
    length(formulation.p_t(i, z)) / weight.map_or(1.0, |l| l[i]).sqrt()
}

/// Returns the magnitude of the sum of the tangential forces at `z`.
fn resultant(formulation: &Bdiff, z: &[f64]) -> f64 {
    let nodes = (0..formulation.layout().contacts()).map(|i| formulation.p_t(i, z));
    length(nodes.fold([0.0; 2], |sum, p| [sum[0] + p[0], sum[1] + p[1]]))
}

/// Returns the root of the sum of squares of [`friction_at`] over all nodes.
fn friction_of_all(formulation: &Bdiff, weight: Option<&[f64]>, z: &[f64]) -> f64 {
    let nodes = 0..formulation.layout().contacts();
    nodes.map(|i| friction_at(formulation, weight, i, z).powi(2)).sum::<f64>().sqrt()
}

/// Returns the share of an increment after which `function` is 0, from below, or 1 if it is not.
fn bisected(function: impl Fn(f64) -> f64) -> f64 {
    let [mut low, mut high] = [0.0, 1.0];
    if function(low) >= 0.0 {
        return low;
    }
    if function(high) <= 0.0 {
        return high;
    }
    for _ in 0..f64::MANTISSA_DIGITS {
        let middle = 0.5 * (low + high);
        if function(middle) < 0.0 { low = middle } else { high = middle }
    }
    high
}

/// The way in which a node touches or begins to stick within an increment.
#[derive(Debug, Clone, Copy, Default)]
struct Begin {
    /// `true` if it begins to stick within the increment.
    pub sticks: bool,
    /// `true` if it slipped before that.
    pub slipped: bool,
    /// The share of the increment after which the node touches.
    pub touches: Option<f64>,
    /// The distance of the sticking position from that in the increment.
    pub delta: [f64; 2],
    /// The motion before the touch, for a node that slips at the end.
    pub before_touch: [f64; 2],
}

impl Begin {
    /// Computes this for a node that was `before` at the start, had this `rate`, moved by `slip` and ends in this
    /// `case`.
    fn of(before: &Node, case: TangentialCase, slip: [f64; 2], rate: Option<&NodeRate>) -> Self {
        let Some(&NodeRate { approach, slip: pace, .. }) = rate else { return Begin::default() };
        let ahead = |share: f64| pace.map(|w| share * w);
        match (before.case, case) {
            _ if before.is_open() && case != TangentialCase::NoPressure => {
                // A node that closes without being predicted closes at the end.
                let share = if approach > 0.0 { (before.distance / approach).min(1.0) } else { 1.0 };
                let share = if share > NEGLIGIBLE { share } else { 0.0 };
                let moved = ahead(share);
                let (farther, before_touch, falls_short) = match case {
                    TangentialCase::Slip { direction, .. } => {
                        let farther = [moved[0] - slip[0], moved[1] - slip[1]];
                        // The increment counts the motion before the touch as slip.
                        let short = direction[0] * farther[0] + direction[1] * farther[1];
                        (farther, moved, short > NEGLIGIBLE * length(moved))
                    }
                    _ => (moved, [0.0; 2], true),
                };
                let sticks = falls_short && share > 0.0;
                let delta = if sticks { farther } else { [0.0; 2] };
                Begin { sticks, slipped: false, touches: Some(share), delta, before_touch }
            }
            (TangentialCase::Slip { direction, .. }, TangentialCase::Stick)
                if direction[0] * pace[0] + direction[1] * pace[1] > 0.0 =>
            {
                Begin { sticks: true, slipped: true, delta: ahead(0.5), ..Begin::default() }
            }
            _ => Begin::default(),
        }
    }
}
