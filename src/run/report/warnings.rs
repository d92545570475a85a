//! Warnings: reasons why a result may be inaccurate although every law holds, and why a run is slow.

use serde::Serialize;

use crate::algebra::linear::Statistics;
use crate::algebra::linear::process::blas::{Blas, KERNEL_VARIABLE};
use crate::base::units::Quantity;
use crate::body::contact::holes_in_front_of;
use crate::body::description::Action;
use crate::body::estimate::expected_locking;
use crate::body::fem::Element;
use crate::body::model::Model;
use crate::solver::history::LinearAlgebra;

/// A warning.
#[derive(Debug, Clone, PartialEq, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[non_exhaustive]
pub struct Warning {
    /// The kind of the warning.
    pub kind: WarningKind,
    /// The warning in words, with the cure.
    pub message: String,
}

/// The kind of a warning.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(rename_all = "kebab-case")]
pub enum WarningKind {
    /// Locking of elements, because a material is nearly incompressible.
    Locking,
    /// A border between layers that cuts elements.
    LayersThroughElements,
    /// A load that acts only on constrained displacements.
    IdleLoad,
    /// A coefficient of friction larger than for real surfaces.
    LargeFriction,
    /// A hole in a triangulated surface in front of a boundary.
    SurfaceHole,
    /// A boundary that never touches its obstacle.
    NoContact,
    /// Displacements that are not small.
    LargeDisplacements,
    /// Strains that are not small.
    LargeStrains,
    /// An obstacle whose surface is inclined against the contact normal.
    LeaningObstacle,
    /// A contact that leaves the range of its linearised gaps.
    GapsOutOfRange,
    /// Contact forces on nodes beyond the end of the other body.
    BeyondTheEnd,
    /// Bodies that penetrate each other where no contact is defined.
    PassedThrough,
    /// Facets that falsify measured gaps if they are of a curved surface.
    FacetedGaps,
    /// Neglected friction of constrained nodes while something slides past them.
    FrictionLeftOut,
    /// Bodies that slide across each other's facets.
    SlidAcrossFacets,
    /// A rigid body that moves along its contact while contact alone holds it against rotation.
    LargeMotion,
    /// A contact node inside an obstacle that it does not meet.
    ObstacleNotMet,
    /// An obstacle with details finer than the elements.
    ObstacleBetweenNodes,
    /// A non-unique equilibrium: contact leaves a motion of the body unconstrained.
    NotUnique,
    /// A mesh that is too coarse for the body itself.
    CoarseMesh,
    /// Stresses of a nearly incompressible body that are much less accurate than its displacements.
    RoughStresses,
    /// A contact zone of a few nodes, or of isolated ones.
    ContactUnresolved,
    /// A contact zone that is fewer than eight nodes across.
    ContactCoarse,
    /// A peak pressure that is far above that of the neighbours.
    PeakScatter,
    /// A pressure that is singular at the edge of the contact.
    SingularEdge,
    /// Elements that differ much in size at the end of the contact.
    UnevenElements,
    /// A stick zone whose size is known to one element.
    StickZoneCoarse,
    /// A mesh that is too coarse for tangential forces much smaller than the normal ones.
    TangentialCoarse,
    /// Narrow slip zones of a few nodes beside stick zones.
    SlipZoneCoarse,
    /// Increments too long for the friction work.
    IncrementsWork,
    /// Increments too long for the tangential forces, or too few for an estimate.
    IncrementsForce,
    /// Gaps curved in time, which the exact path follows along chords.
    CurvedGaps,
    /// A quasi-static motion that ended and was continued by a jump.
    Jump,
    /// Forces so small compared with stiffness times displacements that rounding matters.
    Unbalanced,
    /// A requested additional result that could not be computed. The history itself is complete.
    NotComputed,
    /// A BLAS several times slower than possible on the processor. Costs time and no accuracy.
    SlowBlas,
    /// Multigrid that stagnated, so that a direct solver took over. Costs time and no accuracy.
    MultigridGaveWay,
    /// A process with another body than rank 0, so that the stiffness is not distributed. Costs memory and no accuracy.
    RanksApart,
}

impl WarningKind {
    /// Returns `true` if the warning is known only after the solution. Locking is also predicted before it.
    pub fn needs_the_solution(self) -> bool {
        !matches!(
            self,
            WarningKind::LayersThroughElements
                | WarningKind::IdleLoad
                | WarningKind::LargeFriction
                | WarningKind::SurfaceHole
                | WarningKind::SlowBlas
        )
    }

    /// Returns `true` if the warning is never to be ignored: results may be those of another problem.
    pub fn is_grave(self) -> bool {
        matches!(
            self,
            WarningKind::BeyondTheEnd
                | WarningKind::CurvedGaps
                | WarningKind::FrictionLeftOut
                | WarningKind::GapsOutOfRange
                | WarningKind::Jump
                | WarningKind::LargeDisplacements
                | WarningKind::LeaningObstacle
                | WarningKind::ObstacleBetweenNodes
                | WarningKind::ObstacleNotMet
                | WarningKind::PassedThrough
        )
    }
}

/// Poisson's ratio from which resistance to a change of volume makes elements too stiff, and not bending.
const NEARLY_INCOMPRESSIBLE: f64 = 0.45;

/// A smaller excess of stiffness by locking causes no warning.
const LOCKING: f64 = 0.05;

/// Above this share, the estimate is known to be too small.
const AT_LEAST: f64 = 1.0;

/// The factor by which elements of half the size lock less.
const HALVED: f64 = 2.64;

/// The Poisson's ratio up to which elements of second order are as good as B-bar elements.
const QUADRATIC_LOCKING: f64 = 0.499;

/// The largest plausible coefficient of friction: soft rubber on dry asphalt reaches 1.5.
const PLAUSIBLE: f64 = 2.0;

/// The rounding of the corners of an element, relative to the size of the body.
const CORNER_ROUNDING: f64 = 1e-9;

impl Warning {
    /// Returns the warnings known before the solution of a model.
    pub fn of_model(model: &Model) -> Vec<Self> {
        let messages = [
            (WarningKind::LayersThroughElements, layers_through_elements(model)),
            (WarningKind::IdleLoad, idle_load(model)),
            (WarningKind::LargeFriction, large_friction(model)),
            (WarningKind::SurfaceHole, surface_hole(model)),
        ];
        let found = messages.into_iter().filter_map(|(kind, message)| Some(Warning { kind, message: message? }));
        expected(model).into_iter().chain(found).collect()
    }

    /// Warns that `result` could not be computed, although the history was solved.
    pub fn of_missing(result: &str, why: &dyn std::error::Error) -> Self {
        let message = format!("{result} could not be computed: {why}; all other results are complete");
        Warning { kind: WarningKind::NotComputed, message }
    }

    /// Warns of a slow BLAS and names the cure.
    pub fn of_blas(blas: &Blas) -> Option<Self> {
        let cure = match blas.better_kernel {
            Some(better) if blas.selectable => {
                format!("set {KERNEL_VARIABLE}={better} in the environment")
            }
            Some(_) => "install an OpenBLAS that was built for several processors".to_string(),
            None => "install OpenBLAS, or BLIS or MKL".to_string(),
        };
        let message = format!(
            "the BLAS in use is {blas}, which makes factorisations up to several times slower than necessary: {cure}"
        );
        blas.is_slow().then_some(Warning { kind: WarningKind::SlowBlas, message })
    }

    /// Warns that multigrid was `asked` for and stagnated, for the reason `why` if known, or could not begin, so that
    /// the solver `taken` replaced it.
    pub(super) fn of_multigrid(linear: &Statistics, asked: bool, taken: &str, why: Option<&str>) -> Option<Self> {
        if asked && taken != "multigrid" {
            let message = format!(
                "multigrid cannot treat two obstacles at a node, or contact rows shared by nodes: {taken} was used \
                 instead"
            );
            return Some(Warning { kind: WarningKind::MultigridGaveWay, message });
        }
        let why = why.unwrap_or("it does not suit these matrices");
        linear.instead.map(|instead| Warning {
            kind: WarningKind::MultigridGaveWay,
            message: format!(
                "multigrid did not converge within 60 iterations, so {instead} took over, which needs more memory: \
                 {why}; use solver.linear = \"auto\""
            ),
        })
    }

    /// Warns that rank 0 has the whole stiffness although several processes might share it, because one of them has
    /// another body.
    pub(super) fn of_ranks(model: &Model, linear: LinearAlgebra, ranks: usize) -> Option<Self> {
        let apart = ranks > 1
            && linear == LinearAlgebra::Multigrid
            && model.has_rows()
            && model.problem.stiffness().distributed().is_none();
        let message = "a process has another body than rank 0, or cannot read the scene, so rank 0 has assembled \
         the whole stiffness, which needs more memory there: start all processes with the same scene and options, \
         and keep all files at the same paths";
        apart.then(|| Warning { kind: WarningKind::RanksApart, message: message.to_string() })
    }

    /// Warns of locking if it makes the body too stiff by a significant `share`.
    pub(super) fn of_locking(model: &Model, share: f64) -> Option<Self> {
        let poisson = largest_poisson(model);
        let simplices = model.mesh.cells.iter().any(|cell| cell.kind.is_simplex());
        let (tri, quad) = match model.mesh.dimension {
            2 => ("triangles", "quadrilaterals"),
            _ => ("tetrahedra", "hexahedra"),
        };
        let (why, nodal) = if poisson >= NEARLY_INCOMPRESSIBLE {
            (format!("its elements lock near nu = 0.5, and nu is {poisson:.6}"), "mesh.element = \"nodal-volume\", ")
        } else {
            ("its elements are too stiff in bending".to_string(), "")
        };
        let cells = if simplices {
            format!("use {nodal}{tri} of second order, or {quad} with mesh.element = \"b-bar\"")
        } else {
            "use mesh.element = \"b-bar\"".to_string()
        };
        let about = if share > AT_LEAST { "at least" } else { "about" };
        let [now, halved] = [share, share / HALVED].map(|share| 100.0 * share);
        let message = format!(
            "expect the body to be {about} {now:.0} % too stiff: {why}; {cells}, or halve the elements for about \
             {halved:.0} %"
        );
        (share > LOCKING).then_some(Warning { kind: WarningKind::Locking, message })
    }
}

/// Predicts locking before the solution.
fn expected(model: &Model) -> Option<Warning> {
    if let Some(share) = expected_locking(model) {
        return Warning::of_locking(model, share);
    }
    let poisson = largest_poisson(model);
    let quadratic = model.mesh.cells.iter().any(|cell| cell.kind.is_quadratic());
    let plain = model.element() == Element::Bilinear && !model.is_thin();
    let locks = quadratic && plain && poisson > QUADRATIC_LOCKING + CORNER_ROUNDING;
    let message = format!(
        "nu is {poisson:.6}: elements of second order may be too stiff as well; use mesh.element = \"nodal-volume\""
    );
    locks.then_some(Warning { kind: WarningKind::Locking, message })
}

fn largest_poisson(model: &Model) -> f64 {
    model.materials().iter().map(|law| 0.5 * law.lambda / (law.lambda + law.mu)).fold(0.0, f64::max)
}

fn layers_through_elements(model: &Model) -> Option<String> {
    let mesh = &model.mesh;
    let up = mesh.dimension - 1;
    let cut = |height: f64| {
        let within = |e: usize| {
            let heights = || mesh.cells[e].nodes.iter().map(|&node| mesh.nodes[node][up]);
            let (low, high) = (heights().fold(f64::INFINITY, f64::min), heights().fold(f64::NEG_INFINITY, f64::max));
            let slack = CORNER_ROUNDING * mesh.size();
            low + slack < height && height < high - slack
        };
        (0..mesh.cells.len()).filter(|&e| within(e)).count()
    };
    let tops = model.description().material.tops();
    let (height, count) = tops.into_iter().map(|top| (top, cut(top))).find(|cut| cut.1 > 0)?;
    let axis = ["x", "y", "z"][up];
    // A height is a sum of thicknesses. Seven digits hide its rounding.
    let height = model.units().of_si(Quantity::Length, height);
    let height: f64 = format!("{height:.6e}").parse().unwrap_or(height);
    let unit = model.units().name(Quantity::Length);
    Some(format!(
        "the border between layers at {axis} = {height} {unit} cuts {count} elements, each of which takes the \
         material of one layer; let elements end at the border"
    ))
}

fn large_friction(model: &Model) -> Option<String> {
    let largest = |nodes: &[usize]| nodes.iter().map(|&i| model.problem.mu()[i]).fold(0.0, f64::max);
    let contacts = model.contact_boundaries.iter().map(|boundary| (largest(&boundary.nodes), &boundary.name));
    let (mu, name) = contacts.max_by(|a, b| a.0.total_cmp(&b.0)).filter(|(mu, _)| *mu > PLAUSIBLE)?;
    Some(format!(
        "the friction of `{name}` is up to {mu}, but few surfaces exceed {PLAUSIBLE}: is it in percent? To prevent \
         sliding, connect bodies with glue = true, or hold a body with a [[support]]"
    ))
}

/// Describes the largest hole of the first triangulated surface with holes in front of its boundary.
fn surface_hole(model: &Model) -> Option<String> {
    let units = model.units();
    model.contact_boundaries.iter().find_map(|contact| {
        let boundary = model.mesh.boundary(&contact.name)?;
        contact.obstacles.clone().find_map(|k| {
            let holes = holes_in_front_of(&model.mesh, boundary, &model.obstacles[k], model.times());
            let largest = holes.iter().max_by(|a, b| a.size.total_cmp(&b.size))?;
            let what = match holes.len() {
                1 => "a hole".to_string(),
                count => format!("{count} holes"),
            };
            Some(format!(
                "the surface of {} has {what} in front of `{}`, the largest {} long at {}: nothing presses \
                 there. A triangle may be missing, or triangles on both sides of a crack may have different \
                 corners; close the hole in the file if the part has none",
                model.obstacle_key(k),
                contact.name,
                units.rounded(Quantity::Length, largest.size, 3),
                units.place(largest.box_centre())
            ))
        })
    })
}

fn idle_load(model: &Model) -> Option<String> {
    let idle = |force: &[f64]| force.iter().all(|f| *f == 0.0);
    let mut loads = model.description().loads.iter().zip(model.loading.cases());
    let acts = |action: &Action| match action {
        Action::Traction { traction, .. } => traction.iter().any(|t| t.uniform() != Some(0.0)),
        Action::Pressure { pressure, .. } => pressure.uniform() != Some(0.0),
        Action::Force { force, .. } | Action::Acceleration(force) => force.iter().any(|f| *f != 0.0),
        Action::Moment { moment, .. } => moment.iter().any(|m| *m != 0.0),
        Action::Spin { speed, .. } => *speed != 0.0,
        Action::Temperature(temperature) => temperature.uniform() != Some(0.0),
    };
    let (load, _) = loads.find(|(load, case)| acts(&load.action) && idle(case.force()))?;
    Some(format!(
        "the load on `{}` does nothing: supports hold the boundary in its direction; remove the load, or free that direction in [[support]]",
        load.action.place(&model.units())
    ))
}
