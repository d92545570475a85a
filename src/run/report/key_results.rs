//! The results that a reader asks for first, each with its errors: the largest force, the holding force, the friction
//! work, the stick zone.
//! The largest pressure is in [`super::LargestPressure`].

use std::collections::BTreeMap;

use serde::{Deserialize, Serialize};

use super::estimates::Estimates;
use super::friction_use::FrictionUse;
use super::largest::is_as_large;
use super::resultant::{ForceRecord, NO_RESULTANT};
use crate::algebra::vector::{dot, plus};
use crate::body::fem::{bernstein, facet_weights};
use crate::body::mesh::{Facet, Geometry};
use crate::body::model::Model;
use crate::solver::history::{IncrementView, Status};
use crate::solver::influence::Weighted;
use crate::solver::laws::ContactStatus;
use crate::solver::problem::State;

/// The largest contact force of a history.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, schemars::JsonSchema)]
#[non_exhaustive]
pub struct LargestForce {
    /// The boundary.
    pub boundary: String,
    /// The resultant on the obstacle or the opposing body: x, y and, in three dimensions, z, N; in two dimensions N per
    /// m of depth.
    pub force: Vec<f64>,
    /// Its magnitude, N; for a body of revolution the axial force, because the radial forces balance each other.
    pub magnitude: f64,
    /// The time, s.
    pub time: f64,
    /// The error of the mesh, as a share, see doc/method/estimates.md. `None` if it is unknown, above 1, or if loads alone
    /// determine the force.
    pub mesh_error: Option<f64>,
    /// `true` if loads alone determine the force, which then has no error of the mesh.
    #[serde(default)]
    pub given: bool,
}

/// The largest tangential force of a contact in a history: the force by which it holds, or at which it is drawn out.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, schemars::JsonSchema)]
#[non_exhaustive]
pub struct HoldingForce {
    /// The boundary.
    pub boundary: String,
    /// The magnitude of (Σ p_t, Σ p_o), N; in two dimensions |Σ p_t|, N per m of depth. On a curved boundary it is the sum
    /// along the turning tangents.
    pub magnitude: f64,
    /// The time, s.
    pub time: f64,
    /// The error of the mesh, as a share, as for [`LargestForce`]; also `None` while some nodes stick and others slip.
    pub mesh_error: Option<f64>,
    /// `true` if loads alone determine the force, which then has no error of the mesh.
    #[serde(default)]
    pub given: bool,
    /// The error of the time steps, as a share, if it was estimated and is at most 1.
    pub time_error: Option<f64>,
}

/// The friction work of a history.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize, schemars::JsonSchema)]
#[non_exhaustive]
pub struct FrictionResult {
    /// The friction work of all increments, J; in two dimensions J per m of depth.
    pub friction_work: f64,
    /// The error of the time steps, as a share, if it was estimated; it is positive if the work is too large. That of the mesh
    /// is not estimated.
    pub time_error: Option<f64>,
}

/// Friction work below this share of the negligible one is rounding.
const ROUNDING: f64 = 1e-8;

/// Errors of forces below this share of the forces of the nodes are rounding: loads alone determine such a force.
const GIVEN: f64 = 1e-9;

/// A state in which a force is largest.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub(crate) struct Moment {
    /// The boundary, by its place in the model.
    boundary: usize,
    pub(crate) time: f64,
    pub(crate) state: State,
    /// Slipping nodes.
    slip: Vec<bool>,
    /// `true` for the tangential force.
    tangential: bool,
    /// The unit vector along the force, along the tangents for the tangential one.
    along: [f64; 3],
}

impl Moment {
    fn new(boundary: usize, step: &IncrementView<'_>, tangential: bool, along: [f64; 3]) -> Self {
        let mut state = step.state.clone();
        // Forces at open nodes are rounding errors.
        let open = state.p_n.iter_mut().zip(step.statuses).filter(|(_, status)| **status == ContactStatus::Open);
        open.for_each(|(p_n, _)| *p_n = 0.0);
        let slip = step.statuses.iter().map(|status| *status == ContactStatus::Slip).collect();
        Moment { boundary, time: step.record.time, state, slip, tangential, along }
    }

    /// Returns the weights of all contact nodes in the force along its direction; `None` if the model is another one.
    pub(crate) fn weights(&self, model: &Model) -> Option<Vec<Weighted>> {
        let Moment { state: State { p_n, p_t, p_o, .. }, slip, .. } = self;
        if self.state.check(&model.problem).is_err() || slip.len() != p_n.len() {
            return None;
        }
        let of = |(i, slips): (usize, &bool)| {
            let slips = slips.then(|| [p_t[i] / p_n[i], p_o[i] / p_n[i]]);
            Weighted { closed: p_n[i] > 0.0, slips, ..Weighted::default() }
        };
        let mut nodes: Vec<Weighted> = slip.iter().enumerate().map(of).collect();
        // The force of each component alone, on all nodes.
        let unit = |k: usize| {
            let of = |own: usize| vec![if own == k { 1.0 } else { 0.0 }; p_n.len()];
            State { p_n: of(0), p_t: of(1), p_o: of(2), ..State::default() }
        };
        let units = [0, 1, 2].map(unit);
        for (i, part) in model.contact.boundaries.get(self.boundary)?.shares(&model.contact.nodes) {
            let [n, t, o] = units.each_ref().map(|state| {
                if self.tangential {
                    let [t, o] = model.contact.nodes[i].in_frame([state.p_t[i], state.p_o[i]]);
                    return part * dot([t, o, 0.0], self.along);
                }
                let own = model.forces_of_rows(state, i).filter(|(term, _)| !term.opposite);
                part * own.map(|(_, force)| dot(force, self.along)).sum::<f64>()
            });
            let node = nodes.get_mut(i)?;
            (node.normal, node.tangential) = (n, [t, o]);
        }
        Some(nodes)
    }

    /// Returns `true` if some closed `nodes` slip with friction, and `true` if others stick, which supports do not hold.
    fn slip_and_stick(&self, model: &Model, nodes: impl Iterator<Item = usize> + Clone) -> [bool; 2] {
        let State { p_n, p_t, p_o, .. } = &self.state;
        let mut closed = nodes.filter(|&i| p_n[i] > 0.0 && !model.contact.nodes[i].tangents[0].is_empty());
        let slips = |i: usize| self.slip.get(i) == Some(&true);
        let slides = closed.clone().any(|i| slips(i) && (p_t[i] != 0.0 || p_o[i] != 0.0));
        [slides, closed.any(|i| !slips(i))]
    }

    /// Returns the friction (N) that is missing in the force at nodes that supports hold, as at a plane of symmetry, if
    /// all others of the boundary slip: friction then acts up to these nodes.
    fn at_held_nodes(&self, model: &Model) -> Option<f64> {
        let nodes = &model.contact.boundaries.get(self.boundary)?.nodes;
        let held = |i: &&usize| model.contact.nodes[**i].tangents[0].is_empty();
        let friction = nodes.iter().filter(held).map(|&i| {
            let across = if self.tangential { 0.0 } else { dot(model.contact.nodes[i].facing.normal, self.along) };
            model.problem.mu()[i] * self.state.p_n[i] * (1.0 - across * across).max(0.0).sqrt()
        });
        (self.slip_and_stick(model, nodes.iter().copied()) == [true, false]).then(|| friction.sum())
    }

    /// Returns the error (N) of the force of a pair by the normals of the nodes, which are those of curved facets in the mean:
    /// `2 Σ σ (a - Σ l_a n_a)` over the facets, with their mean pressures σ, area vectors a and weights l_a of the nodes. The
    /// factor stands for the gaps, whose rows are the same: fits of second order are off by 2.9 times the sum.
    fn by_normals(&self, model: &Model) -> Option<f64> {
        let (mesh, nodes) = (&model.mesh, &model.contact.nodes);
        let boundary = model.contact.boundaries.get(self.boundary).filter(|boundary| boundary.pair.is_some())?;
        if self.tangential || mesh.geometry.is_revolved() {
            return None;
        }
        // A direction that is given is not a mean of normals.
        let own = boundary.nodes.iter().filter(|i| model.slope(**i, self.time).is_nan());
        let of_node: BTreeMap<usize, usize> = own.map(|&i| (nodes[i].node, i)).collect();
        let of_facet = |facet: &Facet| {
            let own = facet.iter().map(|node| of_node.get(node).copied()).collect::<Option<Vec<usize>>>()?;
            let pressure = own.iter().map(|&i| self.state.p_n[i] / nodes[i].weight).sum::<f64>() / own.len() as f64;
            let weights = bernstein(mesh, facet, &facet_weights(mesh, facet));
            let normals = own.iter().zip(weights).map(|(&i, weight)| (weight, nodes[i].facing.normal));
            let left = normals.fold(mesh.area_vector(facet), |left, (weight, normal)| plus(left, -weight, normal));
            Some(pressure * dot(left, self.along))
        };
        Some(2.0 * mesh.boundary(&boundary.name)?.facets.iter().filter_map(of_facet).sum::<f64>().abs())
    }

    /// Returns the error of the mesh of a force of this `magnitude` (N) from its `error` (N), and `true` if loads alone
    /// determine it.
    fn judge(&self, model: &Model, magnitude: f64, error: Option<f64>) -> (Option<f64>, bool) {
        let State { p_n, p_t, p_o, .. } = &self.state;
        let all: f64 = p_n.iter().chain(p_t).chain(p_o).map(|p| p.abs()).sum();
        let given = error.is_some_and(|error| error <= GIVEN * all);
        let least = self.by_normals(model).unwrap_or(0.0).max(self.at_held_nodes(model).unwrap_or(0.0));
        (error.map(|error| error.max(least) / magnitude).filter(|share| !given && *share <= 1.0), given)
    }
}

/// Collects the largest force and the friction work during a history.
#[derive(Debug, Clone, PartialEq, Default, Serialize, Deserialize)]
pub struct KeyWatch {
    largest: Option<(LargestForce, Moment)>,
    holding: Option<(HoldingForce, Moment)>,
    friction_use: Vec<FrictionUse>,
    work: f64,
}

impl KeyWatch {
    /// Examines an increment, with the `forces` at its end. Increments that did not converge are ignored.
    pub fn observe(&mut self, geometry: Geometry, step: &IncrementView<'_>, forces: &[ForceRecord]) {
        if step.record.status != Status::Converged {
            return;
        }
        self.work += step.record.friction_work;
        FrictionUse::observe(&mut self.friction_use, forces);
        // Radial and circumferential forces have no resultant.
        let with_resultant = if geometry.is_revolved() { 1..2 } else { 0..3 };
        for (k, ForceRecord { time, resultant, tangential: [t, o], .. }) in forces.iter().enumerate() {
            let (boundary, time) = (resultant.boundary.clone(), *time);
            let rounding = NO_RESULTANT * resultant.sums.sum_p_n.abs();
            let magnitude = t.hypot(*o);
            let so_far = self.holding.as_ref().map_or(0.0, |(holding, _)| holding.magnitude);
            // The first of equally large forces counts.
            if magnitude > rounding && !is_as_large(so_far, magnitude) {
                let holding = HoldingForce {
                    boundary: boundary.clone(),
                    magnitude,
                    time,
                    mesh_error: None,
                    given: false,
                    time_error: None,
                };
                let along = [t / magnitude, o / magnitude, 0.0];
                self.holding = Some((holding, Moment::new(k, step, true, along)));
            }
            let mut along = [0.0; 3];
            let force = resultant.force.iter().zip(&mut along).enumerate();
            force.filter(|(c, _)| with_resultant.contains(c)).for_each(|(_, (f, along))| *along = *f);
            let magnitude = along.iter().map(|f| f * f).sum::<f64>().sqrt();
            let so_far = self.largest.as_ref().map_or(0.0, |(largest, _)| largest.magnitude);
            if magnitude > rounding && !is_as_large(so_far, magnitude) {
                let force = resultant.force.clone();
                let along = along.map(|f| f / magnitude);
                let largest = LargestForce { boundary, force, magnitude, time, mesh_error: None, given: false };
                self.largest = Some((largest, Moment::new(k, step, false, along)));
            }
        }
    }

    /// Returns the states in which the force and the tangential force are largest.
    pub(crate) fn moments(&self) -> [Option<&Moment>; 2] {
        [self.largest.as_ref().map(|(_, moment)| moment), self.holding.as_ref().map(|(_, moment)| moment)]
    }

    /// Takes the errors (N) of the force and of the tangential force by the mesh. Returns that of the latter, as a share.
    pub(crate) fn learn(&mut self, model: &Model, [of_force, of_tangential]: [Option<f64>; 2]) -> Option<f64> {
        if let Some((largest, moment)) = &mut self.largest {
            (largest.mesh_error, largest.given) = moment.judge(model, largest.magnitude, of_force);
        }
        let (holding, moment) = self.holding.as_mut()?;
        let (share, given) = moment.judge(model, holding.magnitude, of_tangential);
        // Where stick and slip meet depends on the mesh and on the history.
        let slips_in_part = moment.slip_and_stick(model, 0..moment.state.p_n.len()) == [true; 2];
        (holding.mesh_error, holding.given) = (share.filter(|_| !slips_in_part), given);
        share
    }

    /// Returns the largest tangential force with its errors; `None` without any.
    pub(in crate::run) fn holding_force(&self, estimates: &Estimates) -> Option<HoldingForce> {
        let time_error = estimates.increments.and_then(|found| found.resultant_error).filter(|error| *error <= 1.0);
        self.holding.as_ref().map(|(holding, _)| HoldingForce { time_error, ..holding.clone() })
    }

    /// Returns the largest force with its errors; `None` without contact.
    pub(in crate::run) fn largest_force(&self) -> Option<LargestForce> {
        self.largest.as_ref().map(|(largest, _)| largest.clone())
    }

    /// Returns the friction of each contact that is in use, where there is friction.
    pub(in crate::run) fn friction_use(&self, model: &Model) -> Vec<FrictionUse> {
        self.friction_use.iter().map(|used| used.with_factors(model)).collect()
    }

    /// Returns the friction work with its errors; `None` if nothing slipped.
    pub(in crate::run) fn friction(&self, estimates: &Estimates) -> Option<FrictionResult> {
        (self.work > ROUNDING * estimates.negligible_work).then_some(FrictionResult {
            friction_work: self.work,
            time_error: estimates.increments.map(|increments| increments.work_error).filter(|error| error.abs() <= 1.0),
        })
    }
}
