//! Estimates of the errors by mesh and increments, as reported.

use serde::{Deserialize, Serialize};

use super::largest::is_as_large;
use super::peak::{LargestPressure, Peak};
use crate::body::estimate::{ContactEstimate, ContactGraph, ElementEstimate, PeakZone, SlipZones, StickZone};
use crate::body::model::Model;
use crate::solver::history::{IncrementError, IncrementView, Status};
use crate::solver::laws::ContactStatus;
use crate::solver::problem::State;

/// Estimates of the errors by mesh and increments.
#[derive(Debug, Clone, PartialEq, Serialize, schemars::JsonSchema)]
#[non_exhaustive]
pub struct Estimates {
    /// The estimates of each contact surface that ever touched, when its force was largest.
    pub contact: Vec<ContactEstimate>,
    /// The estimate of the surface with the largest contact pressure of all increments, at the time of that pressure.
    #[serde(skip)]
    pub peak: Option<ContactEstimate>,
    /// The upper estimate of the error of that pressure, as a share; none if the strains are unknown and the whole surface is
    /// in contact.
    pub peak_error: Option<f64>,
    /// The approximate share by which locking makes the body too stiff, when its strain energy was largest, within a
    /// factor of two for values below 1; none if no cell can lock.
    pub locking: Option<f64>,
    /// The error of the mesh in the energy norm at that time, as a share of the solution; none if it cannot be
    /// estimated.
    pub discretisation: Option<f64>,
    /// The root mean square of the magnitude of the strains at that time, weighted by the strain energy. Linear elasticity
    /// neglects effects of this size.
    pub strain: Option<f64>,
    /// The error of the stresses at that time, as a share; none for Poisson's ratios below 0.45, where it is about that
    /// of the mesh.
    pub stresses: Option<f64>,
    /// The error of the largest tangential force by the mesh, as a share, see doc/method/estimates.md; none if it is unknown
    /// or if loads alone determine the force.
    pub tangential: Option<f64>,
    /// Friction work below this counts as none, J: a small share of the largest strain energy.
    #[serde(skip)]
    pub negligible_work: f64,
    /// The time-step error, with friction and BN only.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub increments: Option<IncrementError>,
    /// The error of the friction forces by loads or interference at t = 0, as a share of the largest possible friction, if there
    /// are such actions.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub start: Option<f64>,
}

/// Collects data of converged increments. The estimates of each contact surface refer to the time of its largest force.
#[derive(Debug, Clone, PartialEq, Default, Serialize, Deserialize)]
pub struct EstimateWatch {
    /// The graph of the model; it is not stored.
    #[serde(skip)]
    graph: ContactGraph,
    /// The state of each contact surface at its largest force.
    heaviest: Vec<Heaviest>,
    /// The state of each contact surface at its largest tangential force.
    dragged: Vec<Heaviest>,
    peak: Option<Peak>,
    strained: Option<Strained>,
    /// The largest strain energy so far of the parts with friction, J.
    energy_with_friction: f64,
    /// The slip zones of each contact surface.
    slip: Vec<SlipZones>,
}

/// The largest strain energy so far, J, with the displacements and normal contact forces (N) at that time.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
struct Strained {
    energy: f64,
    time: f64,
    u: Vec<f64>,
    p_n: Vec<f64>,
}

/// The largest normal or tangential force on a contact surface so far, N, with its time and state; 0 before anything
/// touches.
#[derive(Debug, Clone, PartialEq, Default, Serialize, Deserialize)]
struct Heaviest {
    force: f64,
    time: f64,
    /// The contact forces; displacements are omitted.
    state: State,
}

impl Heaviest {
    /// Replaces the state if this `force` is as large. `p_n` are the normal forces without those of open nodes.
    fn observe(&mut self, force: f64, p_n: &[f64], step: &IncrementView<'_>) {
        if force > 0.0 && is_as_large(force, self.force) {
            (self.force, self.time) = (force.max(self.force), step.record.time);
            self.state.p_n.clear();
            self.state.p_n.extend_from_slice(p_n);
            self.state.p_t.clone_from(&step.state.p_t);
            self.state.p_o.clone_from(&step.state.p_o);
        }
    }
}

/// Friction work below this share of the largest strain energy of the parts with friction counts as zero.
const NO_WORK: f64 = 1e-4;

/// A larger share of the force on isolated nodes, or on narrow zones, causes a warning, however wide other zones are.
pub(in crate::run) const ISOLATED: f64 = 0.1;

impl EstimateWatch {
    /// Begins with the first increment of `model`.
    pub fn new(model: &Model) -> Self {
        let graph = ContactGraph::new(model);
        let of_surfaces = vec![Heaviest::default(); graph.surfaces.len()];
        let (heaviest, dragged, slip) =
            (of_surfaces.clone(), of_surfaces, vec![SlipZones::default(); graph.surfaces.len()]);
        EstimateWatch { graph, heaviest, dragged, slip, ..EstimateWatch::default() }
    }

    /// Resumes with data that were stored; `None` if they are not of `model`.
    pub fn of(self, model: &Model) -> Option<Self> {
        let EstimateWatch { graph, heaviest: begun, .. } = EstimateWatch::new(model);
        let contacts = model.contact.nodes.len();
        let heaviest = |of: &Heaviest| [0, contacts].contains(&of.state.p_n.len());
        let strained = |of: &Strained| of.u.len() == model.problem.displacements() && of.p_n.len() == contacts;
        let fits = [self.heaviest.len(), self.dragged.len(), self.slip.len()] == [begun.len(); 3]
            && self.heaviest.iter().chain(&self.dragged).all(heaviest)
            && self.peak.as_ref().is_none_or(|peak| peak.fits(model))
            && self.strained.as_ref().is_none_or(strained);
        fits.then_some(EstimateWatch { graph, ..self })
    }

    /// Returns `true` if zones of up to three nodes across bear more of a state than forces can be estimated for.
    pub(crate) fn is_narrow(&self, model: &Model, state: &State) -> bool {
        let zones = PeakZone::all(model, &self.graph, state).into_iter().filter(PeakZone::is_narrow);
        let narrow: f64 = zones.flat_map(|zone| zone.nodes).map(|i| state.p_n[i]).sum();
        narrow > ISOLATED * state.p_n.iter().sum::<f64>()
    }

    /// Examines the end of an increment. Increments that did not converge are ignored.
    pub fn observe(&mut self, model: &Model, step: &IncrementView<'_>) {
        if step.record.status != Status::Converged {
            return;
        }
        // Forces at open nodes are rounding errors.
        let is_open = |status: &ContactStatus| *status == ContactStatus::Open;
        let of_closed =
            step.state.p_n.iter().zip(step.statuses).map(|(p, status)| if is_open(status) { 0.0 } else { *p });
        let p_n: Vec<f64> = of_closed.collect();
        for (heaviest, force) in self.heaviest.iter_mut().zip(self.graph.forces(&p_n)) {
            heaviest.observe(force, &p_n, step);
        }
        let p_of: Vec<f64> = step.state.p_t.iter().zip(&step.state.p_o).map(|(t, o)| t.hypot(*o)).collect();
        for (dragged, force) in self.dragged.iter_mut().zip(self.graph.forces(&p_of)) {
            dragged.observe(force, &p_n, step);
        }
        for (k, slip) in self.slip.iter_mut().enumerate() {
            slip.observe(model, &self.graph, k, step);
        }
        Peak::see(&mut self.peak, model, &self.graph, step);
        let with_friction = model.problem.energy_with_friction(step.increment.force, step.state);
        self.energy_with_friction = self.energy_with_friction.max(with_friction);
        let (energy, time) = (step.record.strain_energy, step.record.time);
        match &mut self.strained {
            Some(strained) if !is_as_large(energy, strained.energy) => {}
            Some(strained) => {
                (strained.energy, strained.time) = (energy.max(strained.energy), time);
                strained.u.copy_from_slice(&step.state.u);
                strained.p_n.copy_from_slice(&step.state.p_n);
            }
            None => {
                let (u, p_n) = (step.state.u.clone(), step.state.p_n.clone());
                self.strained = Some(Strained { energy, time, u, p_n });
            }
        }
    }

    /// Returns the largest contact pressure, with its errors from the `estimates`, if there was any.
    pub fn largest_pressure(&self, model: &Model, estimates: &Estimates) -> Option<LargestPressure> {
        let singular = estimates.peak.as_ref().is_some_and(|peak| peak.singular_edge);
        self.peak.as_ref().map(|peak| peak.record(model, &self.graph, estimates.peak_error, singular))
    }

    /// Returns the estimates of the mesh errors.
    pub fn estimates(&self, model: &Model) -> Estimates {
        let elements = self.strained.as_ref().map(|Strained { time, u, p_n, .. }| {
            let pressed: Vec<usize> = self.graph.isolated(p_n).map(|i| model.contact.nodes[i].node).collect();
            ElementEstimate::new(model, &model.thermal_factors(*time), &model.displaced(*time, u), &pressed)
        });
        let contact = |(k, heaviest): (usize, &Heaviest)| {
            let Heaviest { force, time, state, .. } = heaviest;
            let estimate =
                (*force > 0.0).then(|| ContactEstimate::new(model, &self.graph, k, *time, state)).flatten()?;
            let Heaviest { force, time, state } = &self.dragged[k];
            let stick = (*force > 0.0).then(|| StickZone::new(model, &self.graph, k, *time, state));
            let slip = self.slip[k].found().filter(|(work, _)| *work > self.negligible_work());
            Some(ContactEstimate { stick: stick.flatten(), slip_across: slip.map(|of| of.1), ..estimate })
        };
        let peak = self.peak.as_ref().and_then(|peak| peak.estimate(model, &self.graph));
        let discretisation =
            elements.as_ref().and_then(|elements| elements.discretisation.as_ref()).map(|error| error.whole);
        Estimates {
            peak_error: self
                .peak
                .as_ref()
                .zip(peak.as_ref())
                .and_then(|(peak, surface)| peak.error(model, &self.graph, surface, discretisation)),
            peak,
            contact: self.heaviest.iter().enumerate().filter_map(contact).collect(),
            locking: elements.as_ref().and_then(|elements| elements.locking),
            discretisation,
            strain: elements.as_ref().map(|elements| elements.strain),
            stresses: elements.and_then(|elements| elements.discretisation?.stresses),
            tangential: None,
            negligible_work: self.negligible_work(),
            increments: None,
            start: None,
        }
    }

    fn negligible_work(&self) -> f64 {
        NO_WORK * self.energy_with_friction
    }
}

impl Estimates {
    /// Returns the estimate of the contact surface with the largest force.
    pub fn heaviest(&self) -> Option<&ContactEstimate> {
        heaviest(self.contact.iter())
    }

    /// Returns the stick zone of the surface with the largest force that has one.
    pub fn stick_zone(&self) -> Option<&StickZone> {
        heaviest(self.contact.iter().filter(|contact| contact.stick.is_some()))?.stick.as_ref()
    }
}

/// Returns the surface with the largest force, the first of several equal ones.
fn heaviest<'a>(all: impl Iterator<Item = &'a ContactEstimate>) -> Option<&'a ContactEstimate> {
    all.reduce(|so_far, next| if is_as_large(so_far.force, next.force) { so_far } else { next })
}
