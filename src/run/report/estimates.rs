//! Estimates of the errors by mesh and increments, as reported.

use serde::{Deserialize, Serialize};

use super::companion::CompanionEstimate;
use super::largest::is_as_large;
use super::peak::{LargestPressure, Peak};
use super::validity::Validity;
use super::warnings::{Warning, WarningKind};
use crate::base::units::{Quantity, UnitSystem, six_digits};
use crate::body::estimate::{
    ContactEstimate, ContactGraph, ElementEstimate, HertzContact, PeakOf, PeakZone, SlipZones, StickZone, peak_error,
};
use crate::body::fem::Element;
use crate::body::model::Model;
use crate::solver::history::{IncrementError, IncrementView, Status};
use crate::solver::laws::ContactStatus;
use crate::solver::problem::State;

/// Estimates of the errors by mesh and increments.
#[derive(Debug, Clone, PartialEq, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
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
    /// The number of nodes across slip zones adjacent to stick zones, weighted by the friction work; none if there are
    /// no such zones, or hardly any friction work.
    pub slip_across: Option<f64>,
    /// The error of the friction work by the width of slip zones, as a share.
    #[serde(skip)]
    pub work_by_width: Option<f64>,
    /// Friction work below this counts as none, J: a small share of the largest strain energy.
    #[serde(skip)]
    pub negligible_work: f64,
    /// The time-step error, with friction and BN only.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub increments: Option<IncrementError>,
    /// The time-step error of the tangential forces by a companion run, if it was requested.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub companion: Option<CompanionEstimate>,
    /// The error of the friction forces by loads or interference at t = 0, as a share of the largest possible friction, if there
    /// are such actions.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub start: Option<f64>,
}

/// Collects data of converged increments. The estimates of each contact surface refer to the time of its largest force.
#[derive(Debug, Clone, PartialEq)]
pub struct EstimateWatch {
    graph: ContactGraph,
    peak_of: PeakOf,
    seen: Accumulated,
}

/// The data of the increments so far.
#[derive(Debug, Clone, PartialEq, Default, Serialize, Deserialize)]
pub struct Accumulated {
    /// The state of each contact surface at its largest force.
    heaviest: Vec<Heaviest>,
    /// The state of each contact surface at its largest tangential force.
    dragged: Vec<Heaviest>,
    peak: Option<Peak>,
    strained: Option<Strained>,
    /// The largest strain energy so far of the parts with friction, J.
    energy_with_friction: f64,
    slip: SlipZones,
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
    fn see(&mut self, force: f64, p_n: &[f64], step: &IncrementView<'_>) {
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

/// The error of the largest tangential force by the mesh above which a warning is given, if that of the body is small.
const TANGENTIAL: f64 = 0.05;

/// Slip zones with fewer nodes across cause a warning, because their width is known to half a node or one node. Of 600
/// random scenes, 69 had them although the contact itself was wide enough. The friction work was more than 10 % off in
/// 49 of them, and better than 2 % in 4.
const FINE_FOR_SLIP: f64 = 1.0 / 0.15;

/// The peak pressure of zones with fewer nodes across may be 10 % off.
const FINE: usize = 8;

/// A larger share of the force on isolated nodes, or on narrow zones, causes a warning, however wide other zones are.
const ISOLATED: f64 = 0.1;

/// Elements that differ by a larger factor at the end of a contact disturb the pressure inside.
const UNEVEN: f64 = 3.0;

/// In zones with fewer nodes across, the width of the stick zone is known to 5 % at best.
const FINE_FOR_STICK: usize = 40;

/// The mean strain above which a warning is given: forces are off by about a percent.
const LARGE_STRAIN: f64 = 0.01;

/// The ratio of the estimate to the error in the energy norm if corners make the solution singular.
const OF_SINGULAR: f64 = 0.6;

/// The error in the energy norm above which a warning is given. Of 200 random scenes, those with 0.14 to 0.2 had
/// tangential forces that were 2 to 20 % off.
const COARSE: f64 = 0.15;

/// The error of the stresses above which a warning is given, if it is also [`FAR`] times that of the mesh.
const ROUGH: f64 = 0.1;
const FAR: f64 = 3.0;

/// A smaller scatter of the peak is ignored.
const SMOOTH: f64 = 0.1;

impl EstimateWatch {
    /// Begins with the first increment of `model`.
    pub fn new(model: &Model) -> Self {
        let graph = ContactGraph::new(model);
        let heaviest = vec![Heaviest::default(); graph.surfaces().len()];
        EstimateWatch {
            graph,
            peak_of: PeakOf::of(model),
            seen: Accumulated { dragged: heaviest.clone(), heaviest, ..Accumulated::default() },
        }
    }

    /// Returns `true` if zones of up to three nodes across bear more of a state than forces can be estimated for.
    pub(crate) fn is_narrow(&self, model: &Model, state: &State) -> bool {
        let zones = PeakZone::all(model, &self.graph, state).into_iter().filter(PeakZone::is_narrow);
        let narrow: f64 = zones.flat_map(|zone| zone.nodes).map(|i| state.p_n[i]).sum();
        narrow > ISOLATED * state.p_n.iter().sum::<f64>()
    }

    /// Returns the data of the increments so far, for a checkpoint.
    pub fn seen(&self) -> &Accumulated {
        &self.seen
    }

    /// Resumes from the data of a checkpoint. Returns `false` if they belong to another model.
    pub fn go_on_with(&mut self, model: &Model, seen: Accumulated) -> bool {
        let contacts = model.contacts.len();
        let heaviest = |of: &Heaviest| [0, contacts].contains(&of.state.p_n.len());
        let strained = |of: &Strained| of.u.len() == model.problem.displacements() && of.p_n.len() == contacts;
        let fits = seen.heaviest.len() == self.seen.heaviest.len()
            && seen.dragged.len() == self.seen.dragged.len()
            && seen.heaviest.iter().chain(&seen.dragged).all(heaviest)
            && seen.peak.as_ref().is_none_or(|peak| peak.fits(model))
            && seen.strained.as_ref().is_none_or(strained);
        if fits {
            self.seen = seen;
        }
        fits
    }

    /// Examines the end of an increment. Increments that did not converge are ignored.
    pub fn see(&mut self, model: &Model, step: &IncrementView<'_>) {
        if step.record.status != Status::Converged {
            return;
        }
        // Forces at open nodes are rounding errors.
        let is_open = |status: &ContactStatus| *status == ContactStatus::Open;
        let of_closed =
            step.state.p_n.iter().zip(step.statuses).map(|(p, status)| if is_open(status) { 0.0 } else { *p });
        let p_n: Vec<f64> = of_closed.collect();
        for (heaviest, force) in self.seen.heaviest.iter_mut().zip(self.graph.forces(&p_n)) {
            heaviest.see(force, &p_n, step);
        }
        let p_of: Vec<f64> = step.state.p_t.iter().zip(&step.state.p_o).map(|(t, o)| t.hypot(*o)).collect();
        for (dragged, force) in self.seen.dragged.iter_mut().zip(self.graph.forces(&p_of)) {
            dragged.see(force, &p_n, step);
        }
        self.seen.slip.see(model, &self.graph, step);
        Peak::see(&mut self.seen.peak, model, &self.graph, self.peak_of, step);
        let with_friction = model.problem.energy_with_friction(step.increment.force, step.state);
        self.seen.energy_with_friction = self.seen.energy_with_friction.max(with_friction);
        let (energy, time) = (step.record.strain_energy, step.record.time);
        match &mut self.seen.strained {
            Some(strained) if !is_as_large(energy, strained.energy) => {}
            Some(strained) => {
                (strained.energy, strained.time) = (energy.max(strained.energy), time);
                strained.u.copy_from_slice(&step.state.u);
                strained.p_n.copy_from_slice(&step.state.p_n);
            }
            None => {
                let (u, p_n) = (step.state.u.clone(), step.state.p_n.clone());
                self.seen.strained = Some(Strained { energy, time, u, p_n });
            }
        }
    }

    /// Returns the largest contact pressure, with its errors from the `estimates`, if there was any.
    pub fn largest_pressure(&self, model: &Model, estimates: &Estimates) -> Option<LargestPressure> {
        let singular = estimates.peak.as_ref().is_some_and(|peak| peak.singular_edge);
        self.seen.peak.as_ref().map(|peak| peak.told(model, &self.graph, estimates.peak_error, singular))
    }

    /// Returns the estimates of the mesh errors.
    pub fn estimates(&self, model: &Model) -> Estimates {
        let elements = self.seen.strained.as_ref().map(|Strained { time, u, p_n, .. }| {
            let pressed: Vec<usize> = self.graph.isolated(p_n).map(|i| model.contacts[i].node).collect();
            ElementEstimate::new(model, &model.thermal_factors(*time), &model.displaced(*time, u), &pressed)
        });
        let contact = |(k, heaviest): (usize, &Heaviest)| {
            let Heaviest { force, time, state, .. } = heaviest;
            let estimate =
                (*force > 0.0).then(|| ContactEstimate::new(model, &self.graph, k, *time, state)).flatten()?;
            let Heaviest { force, time, state } = &self.seen.dragged[k];
            let stick = (*force > 0.0).then(|| StickZone::new(model, &self.graph, k, *time, state));
            Some(ContactEstimate { stick: stick.flatten(), ..estimate })
        };
        let peak = self.seen.peak.as_ref().and_then(|peak| peak.estimate(model, &self.graph));
        let discretisation =
            elements.as_ref().and_then(|elements| elements.discretisation.as_ref()).map(|error| error.whole);
        Estimates {
            peak_error: (self.seen.peak.as_ref().zip(peak.as_ref()))
                .and_then(|(seen, surface)| seen.error(model, &self.graph, surface, discretisation)),
            peak,
            contact: self.seen.heaviest.iter().enumerate().filter_map(contact).collect(),
            locking: elements.as_ref().and_then(|elements| elements.locking),
            discretisation,
            strain: elements.as_ref().map(|elements| elements.strain),
            stresses: elements.and_then(|elements| elements.discretisation?.stresses),
            tangential: None,
            slip_across: self.slip_across(),
            work_by_width: self.seen.slip.error(),
            negligible_work: self.negligible_work(),
            increments: None,
            companion: None,
            start: None,
        }
    }

    fn slip_across(&self) -> Option<f64> {
        let negligible = self.negligible_work();
        self.seen.slip.found().filter(|(work, _)| *work > negligible).map(|(_, across)| across)
    }

    fn negligible_work(&self) -> f64 {
        NO_WORK * self.seen.energy_with_friction
    }
}

impl Estimates {
    /// Returns the estimate of the contact surface with the largest force.
    pub fn heaviest(&self) -> Option<&ContactEstimate> {
        self.contact.iter().max_by(|a, b| a.force.total_cmp(&b.force))
    }

    /// Returns the stick zone of the surface with the largest force that has one.
    pub fn stick_zone(&self) -> Option<&StickZone> {
        let sticking = self.contact.iter().filter(|contact| contact.stick.is_some());
        sticking.max_by(|a, b| a.force.total_cmp(&b.force)).and_then(|contact| contact.stick.as_ref())
    }

    /// Returns the time-step error of the tangential forces, as a share. It is the larger of the estimates by the run
    /// and by its companion, because each covers nodes that the other misses.
    pub fn force_error(&self) -> Option<f64> {
        let by_transport = self.increments.and_then(|increments| increments.force_error);
        let by_companion = self.companion.and_then(|companion| companion.error);
        by_transport.into_iter().chain(by_companion).reduce(f64::max)
    }

    /// Returns the resulting warnings.
    pub fn warnings(&self, model: &Model, validity: &Validity) -> Vec<Warning> {
        let units = model.units();
        let simplices = model.mesh.dimension == 3 && model.mesh.cells.iter().any(|cell| cell.kind.is_simplex());
        let sound = self.contact.iter().filter(|contact| !validity.has_faceted_gaps(model, &contact.boundary));
        let contact = sound.flat_map(|contact| {
            // For the reported peak, the estimate at its own time counts.
            let peak = self.peak.as_ref().filter(|peak| peak.boundary == contact.boundary).unwrap_or(contact);
            let zone = Some(of_zone(contact, &units)).filter(|warnings| !warnings.is_empty());
            [zone.unwrap_or_else(|| of_zone(peak, &units)), of_peak(peak, &units, simplices), of_ends(contact)].concat()
        });
        let mut warnings: Vec<Warning> = contact.collect();
        // For a narrow contact, the warning of its width is enough.
        let narrow = [WarningKind::ContactUnresolved, WarningKind::ContactCoarse];
        if !warnings.iter().any(|warning| narrow.contains(&warning.kind)) {
            warnings.extend(self.slip_across.and_then(narrow_slip));
        }
        let locking = self.locking.and_then(|share| Warning::of_locking(model, share));
        let coarse = self.discretisation.and_then(coarse).or_else(|| self.tangential.and_then(coarse_for_friction));
        warnings.extend(locking.into_iter().chain(coarse).chain(self.rough(model)));
        // The cause of large displacements is that of the strains.
        let strain = self.strain.filter(|_| !validity.has_large_displacements(model));
        warnings.extend(strain.and_then(|strain| large_strains(strain, model)));
        warnings
    }
}

impl Estimates {
    /// Warns if stresses in the body are much less accurate than displacements.
    fn rough(&self, model: &Model) -> Option<Warning> {
        let (stresses, whole) = (self.stresses?, self.discretisation?);
        let cure = match model.element() {
            Element::Bilinear
                if model.mesh.cells.iter().all(|cell| !cell.kind.is_simplex() && !cell.kind.is_quadratic()) =>
            {
                "use mesh.element = \"b-bar\""
            }
            Element::Bilinear => "use mesh.element = \"nodal-volume\"",
            Element::BBar | Element::NodalVolume => "refine the mesh",
        };
        let message = format!(
            "stresses in the body (fields and probes) may be off by about {:.0} %, although the error of the mesh \
             is {:.0} % in the energy norm: pressures in nearly incompressible elements vary from one to the \
             next; {cure}, or use only forces and displacements",
            100.0 * stresses,
            100.0 * whole
        );
        (stresses > ROUGH && stresses > FAR * whole).then_some(Warning { kind: WarningKind::RoughStresses, message })
    }
}

/// Names the surface and the time of an estimate.
fn at(contact: &ContactEstimate) -> String {
    format!("`{}` at t = {} s", contact.boundary, six_digits(contact.time))
}

fn percent(share: f64) -> String {
    if share > 0.0 && share < 0.005 { "less than 1 %".to_string() } else { format!("{:.0} %", 100.0 * share) }
}

/// Warns of too narrow contact zones.
fn of_zone(contact: &ContactEstimate, units: &UnitSystem) -> Vec<Warning> {
    let length = |x: f64| units.rounded(Quantity::Length, x, 3);
    let at = at(contact);
    if contact.unresolved_share > ISOLATED || contact.isolated_share > ISOLATED {
        let bears = if contact.isolated_share > ISOLATED {
            format!("{} of the force is on nodes without a closed neighbour", percent(contact.isolated_share))
        } else {
            format!("{} of the force is on zones of up to 3 nodes across", percent(contact.unresolved_share))
        };
        let size = length(contact.element_size);
        let finer = match contact.hertz {
            Some(HertzContact { half_width, peak_pressure }) => format!(
                "; for this force Hertz' half-width is {} and his peak pressure {}; elements there are {size}, make \
                 them {} (8 across)",
                length(half_width),
                units.rounded(Quantity::Stress, peak_pressure, 3),
                length(0.25 * half_width)
            ),
            None => format!("; elements there are {size}, make them smaller until 8 nodes are across"),
        };
        let message = format!("{at}: {bears}, so pressure and contact width are meaningless there{finer}");
        return vec![Warning { kind: WarningKind::ContactUnresolved, message }];
    }
    let Some(n) = contact.nodes_across.filter(|&n| n < FINE) else { return Vec::new() };
    let (peak, width) = (peak_error(n), 2.0 * peak_error(n));
    let message = format!(
        "{at}: the contact zone is only {n} nodes wide: its peak pressure may be off by {}, its width by {}; halve \
         the elements there for {}",
        percent(peak),
        percent(width),
        percent(peak_error(2 * n - 1))
    );
    vec![Warning { kind: WarningKind::ContactCoarse, message }]
}

/// Warns if the largest pressure differs much from those around it.
fn of_peak(contact: &ContactEstimate, units: &UnitSystem, simplices: bool) -> Vec<Warning> {
    let stress = |x: f64| units.rounded(Quantity::Stress, x, 3);
    let at = at(contact);
    if contact.singular_edge {
        let message = format!(
            "{at}: the pressure is singular at the edge ({} of the force on its nodes): its peak depends on the \
             mesh; use only forces, and pressures away from the edge",
            percent(contact.edge_share)
        );
        return vec![Warning { kind: WarningKind::SingularEdge, message }];
    }
    let n = contact.nodes_across;
    if n.is_some_and(|n| n <= 4) || contact.scatter <= SMOOTH.max(n.map_or(0.0, peak_error)) {
        return Vec::new();
    }
    let trust = if simplices { "use the mean" } else { "refine the mesh there" };
    let message = format!(
        "{at}: pressures of neighbouring nodes differ: the peak of {} is {} above the mean over its neighbours, {}; \
         {trust}",
        stress(contact.peak_pressure),
        percent(contact.scatter),
        stress(contact.patch_pressure)
    );
    vec![Warning { kind: WarningKind::PeakScatter, message }]
}

/// Warns of problems at the ends of the contact and of its stick zone.
fn of_ends(contact: &ContactEstimate) -> Vec<Warning> {
    let at = at(contact);
    let mut warnings = Vec::new();
    if let Some(ratio) = contact.edge_ratio.filter(|ratio| *ratio > UNEVEN) {
        let message = format!(
            "{at}: the contact reaches the end of its boundary, where the elements outside are {ratio:.0} times \
             longer or shorter than those inside: pressures inside may be off by several percent; let elements \
             grow gradually there"
        );
        warnings.push(Warning { kind: WarningKind::UnevenElements, message });
    }
    let n = contact.nodes_across.filter(|n| (FINE..FINE_FOR_STICK).contains(n));
    if let (Some(stick), Some(n)) = (&contact.stick, n) {
        let message = format!(
            "`{}` at t = {} s: the size of the stick zone is known only to one element at each end: its width is {:.2} of \
             the contact width ({n} nodes)",
            stick.boundary,
            six_digits(stick.time),
            stick.ratio
        );
        warnings.push(Warning { kind: WarningKind::StickZoneCoarse, message });
    }
    warnings
}

/// Warns if strains are not small.
fn large_strains(strain: f64, model: &Model) -> Option<Warning> {
    let units = model.units();
    let message = format!(
        "strains are assumed to be small, but their mean is {:.1} %: forces and displacements may be off by about as much, \
         because linear elasticity neglects their squares and the change of shape; press less, use a program for large \
         strains, or correct the modulus, which is in {}",
        100.0 * strain,
        units.name(Quantity::Stress)
    );
    (strain > LARGE_STRAIN).then_some(Warning { kind: WarningKind::LargeStrains, message })
}

/// Warns if the mesh is too coarse for the body itself.
fn coarse(error: f64) -> Option<Warning> {
    let message = format!(
        "the mesh is coarse: its error is about {:.0} % in the energy norm, so displacements and forces may be off \
         by about {:.0} % (if stresses at corners or ends of supports are singular, by {:.0} %), and pressures by \
         more; refine it where the field `discretisation_error` is large, or use elements of second order",
        100.0 * error,
        100.0 * error * error,
        100.0 * (error / OF_SINGULAR).powi(2)
    );
    (error > COARSE).then_some(Warning { kind: WarningKind::CoarseMesh, message })
}

/// Warns if the mesh is too coarse for tangential forces much smaller than the normal ones.
fn coarse_for_friction(error: f64) -> Option<Warning> {
    let message = format!(
        "the mesh is coarse for the tangential forces: the error of the largest one is about {:.0} %; refine it where the \
         field `discretisation_error` is large, or use elements of second order",
        100.0 * error
    );
    (error > TANGENTIAL).then_some(Warning { kind: WarningKind::TangentialCoarse, message })
}

/// Warns if slip zones are too narrow for the friction work.
fn narrow_slip(across: f64) -> Option<Warning> {
    let message = format!(
        "slip zones beside stick zones are only {across:.1} nodes wide (mean weighted by friction work): friction \
         work and slip may be off by about {:.0} %; make elements smaller where nodes slip, until 7 are across",
        100.0 / across
    );
    (across < FINE_FOR_SLIP).then_some(Warning { kind: WarningKind::SlipZoneCoarse, message })
}
