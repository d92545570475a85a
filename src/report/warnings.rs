//! What may make an answer wrong although every law holds: assumptions that a scene does not meet.

use serde::Serialize;

use crate::description::Action;
use crate::fem::Element;
use crate::mesh::CellKind;
use crate::model::Model;
use crate::units::Quantity;

/// A warning.
#[derive(Debug, Clone, PartialEq, Serialize)]
#[cfg_attr(feature = "cli", derive(schemars::JsonSchema))]
pub struct Warning {
    /// The kind of the warning.
    pub kind: WarningKind,
    /// The warning in words, with what to do.
    pub message: String,
}

/// What a warning is about.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
#[cfg_attr(feature = "cli", derive(schemars::JsonSchema))]
#[serde(rename_all = "kebab-case")]
pub enum WarningKind {
    /// Elements that lock, because a material hardly changes its volume.
    Locking,
    /// A border of layers that runs through elements.
    LayersThroughElements,
    /// A load that acts on nothing but supports.
    IdleLoad,
    /// A boundary that never touches its obstacle.
    NoContact,
    /// Displacements that are not small.
    LargeDisplacements,
    /// An obstacle that leans against the normal along which it presses.
    LeaningObstacle,
    /// A contact that leaves the range of its linearised gaps.
    GapsOutOfRange,
    /// An equilibrium that is one of many: contact leaves a motion of the body open.
    NotUnique,
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
    /// A zone that sticks, known to one element.
    StickZoneCoarse,
    /// Forces that are so small beside the stiffness and the displacements that rounding counts.
    Unbalanced,
}

impl WarningKind {
    /// Whether it is known only once the scene is solved.
    pub fn needs_the_solution(self) -> bool {
        match self {
            WarningKind::Locking | WarningKind::LayersThroughElements | WarningKind::IdleLoad => false,
            WarningKind::NoContact
            | WarningKind::LargeDisplacements
            | WarningKind::LeaningObstacle
            | WarningKind::GapsOutOfRange
            | WarningKind::NotUnique
            | WarningKind::ContactUnresolved
            | WarningKind::ContactCoarse
            | WarningKind::PeakScatter
            | WarningKind::SingularEdge
            | WarningKind::UnevenElements
            | WarningKind::StickZoneCoarse
            | WarningKind::Unbalanced => true,
        }
    }
}

/// Poisson's ratio from which elements may lock: K is 50 times as stiff against a change of volume as against shear.
const LOCKING: f64 = 0.49;

/// The same of elements of second order, which at 0.499 are as good as B-bar elements.
const QUADRATIC_LOCKING: f64 = 0.499;

/// Relative to the size of the body, what rounding leaves of the corners of an element.
const ROUNDING: f64 = 1e-9;

impl Warning {
    /// The warnings that a model deserves before it is solved.
    pub fn of_model(model: &Model) -> Vec<Self> {
        let messages = [
            (WarningKind::Locking, locking(model)),
            (WarningKind::LayersThroughElements, layers_through_elements(model)),
            (WarningKind::IdleLoad, idle_load(model)),
        ];
        messages.into_iter().filter_map(|(kind, message)| Some(Warning { kind, message: message? })).collect()
    }
}

fn locking(model: &Model) -> Option<String> {
    if model.element() == Element::BBar || model.is_thin() {
        return None;
    }
    let poisson = model.materials().iter().map(|law| 0.5 * law.lambda / (law.lambda + law.mu)).fold(0.0, f64::max);
    let has = |what: fn(CellKind) -> bool| model.mesh.cells.iter().any(|cell| what(cell.kind));
    let quadratic = has(CellKind::is_quadratic);
    let cells = match (has(CellKind::is_simplex), quadratic, model.mesh.dimension) {
        (false, ..) => "",
        (true, true, 2) => " with quadrilaterals",
        (true, true, _) => " with hexahedra",
        (true, false, 2) => " with quadrilaterals, or triangles of six nodes",
        (true, false, _) => " with hexahedra, or tetrahedra of ten nodes",
    };
    let limit = if quadratic { QUADRATIC_LOCKING } else { LOCKING };
    // What is computed back from Lamé's constants may miss the ratio by rounding.
    (poisson > limit + ROUNDING).then(|| {
        format!(
            "elements lock near nu = 0.5, and nu is {poisson:.6}: the body may be far too stiff; \
             use mesh.element = \"b-bar\"{cells}"
        )
    })
}

fn layers_through_elements(model: &Model) -> Option<String> {
    let mesh = &model.mesh;
    let up = mesh.dimension - 1;
    let cut = |height: f64| {
        let within = |e: usize| {
            let heights = || mesh.cells[e].nodes.iter().map(|&node| mesh.nodes[node][up]);
            let (low, high) = (heights().fold(f64::INFINITY, f64::min), heights().fold(f64::NEG_INFINITY, f64::max));
            let slack = ROUNDING * mesh.size();
            low + slack < height && height < high - slack
        };
        (0..mesh.cells.len()).filter(|&e| within(e)).count()
    };
    let tops = model.description().material.tops();
    let (height, count) = tops.into_iter().map(|top| (top, cut(top))).find(|cut| cut.1 > 0)?;
    let axis = ["x", "y", "z"][up];
    // A height is a sum of thicknesses; seven digits hide its rounding.
    let height = model.units().of_si(Quantity::Length, height);
    let height: f64 = format!("{height:.6e}").parse().unwrap_or(height);
    let unit = model.units().name(Quantity::Length);
    Some(format!(
        "the border between layers at {axis} = {height} {unit} goes through {count} elements, each of which is of one layer; \
         let elements end there"
    ))
}

fn idle_load(model: &Model) -> Option<String> {
    let idle = |force: &[f64]| force.iter().all(|f| *f == 0.0);
    let mut loads = model.description().loads.iter().zip(model.loading.cases());
    let acts = |action: &Action| match action {
        Action::Traction { traction, .. } => traction.iter().any(|t| t.uniform() != Some(0.0)),
        Action::Pressure { pressure, .. } => pressure.uniform() != Some(0.0),
        Action::Force { force, .. } | Action::Acceleration(force) => force.iter().any(|f| *f != 0.0),
        Action::Spin { speed, .. } => *speed != 0.0,
        Action::Temperature(temperature) => temperature.uniform() != Some(0.0),
    };
    let (load, _) = loads.find(|(load, case)| acts(&load.action) && idle(case.force()))?;
    Some(format!(
        "the load on `{}` does nothing: supports hold the boundary in its direction",
        load.action.place(&model.units())
    ))
}
