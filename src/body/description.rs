//! The input of a model as Rust values: mesh, materials, supports, contacts, loads and increments. A scene file is read
//! into the same values.

mod check;
mod contact;
mod coupling;
mod kinks;
mod load;
mod opposite;
mod pretension;
mod recorded;
mod support;

pub use contact::{Against, Contact};
pub use coupling::{Coupling, CouplingKind, Part};
pub use kinks::Kinks;
pub use load::{Action, Load, Where};
pub use opposite::{Opposite, Slave};
pub use pretension::{Pretension, Tightening};
pub use recorded::{CycleChoice, CycleRequest, Probe, ProbePlace};
pub use support::{Bed, Direction, Held, Support};

use serde::Deserialize;

use crate::base::formula::Field;
use crate::base::units::{UnitSystem, Units};
use crate::body::contact::Obstacle;
use crate::body::fem::{Element, Material, Plane};
use crate::body::mesh::MeshSource;

/// One or several elastic bodies with supports, contacts, springs, loads and increments.
/// [`Model::build`](crate::body::model::Model::build) and [`Description::check`] check the values.
///
/// ```
/// use stickslip::body::Obstacle;
/// use stickslip::body::{Axis, Description, Load};
/// use stickslip::body::fem::Material;
/// use stickslip::solver::history::{Method, SolverChoice, Status};
/// use stickslip::body::mesh::MeshSource;
/// use stickslip::body::Model;
/// use stickslip::run::Run;
/// use stickslip::base::equal_increments;
///
/// let steel = Material::new(210e9, 0.3);
/// let description = Description::new(MeshSource::block([1.0, 1.0], [10, 10]), steel, equal_increments(2.0, 4))
///     .support("left", &[Axis::X, Axis::Y])
///     .contact("bottom", 0.4, Obstacle::plane(1e-5))
///     .load(Load::new("top", &[0.0, -10e6]).over(&[[0.0, 0.0], [1.0, 1.0], [2.0, 1.0]]))
///     .load(Load::new("right", &[-10e6, 0.0]).over(&[[0.0, 0.0], [1.0, 1.0], [2.0, 0.0]]));
/// let model = Model::build(&description)?;
/// let report = Run::of(&model, model.times().to_vec(), SolverChoice::new(Method::BN))?.solve(&mut ())?;
/// assert_eq!(report.status, Status::Converged);
///
/// // What is wrong is named by its key.
/// let mirror = description.contact("right", -0.4, Obstacle::plane(0.0));
/// assert!(Model::build(&mirror).unwrap_err().to_string().starts_with("contact[1].friction: "));
/// # Ok::<(), stickslip::run::RunError>(())
/// ```
#[derive(Debug, Clone, PartialEq)]
pub struct Description {
    /// The mesh.
    pub mesh: MeshSource,
    /// The element formulation.
    pub element: Element,
    /// The material, with its layers or groups.
    pub material: Material,
    /// The couplings of boundaries and bodies to reference points.
    pub couplings: Vec<Coupling>,
    /// The supports.
    pub supports: Vec<Support>,
    /// The boundaries in contact.
    pub contacts: Vec<Contact>,
    /// The glued contacts that are tightened.
    pub pretensions: Vec<Pretension>,
    /// The springs and elastic foundations.
    pub springs: Vec<Bed>,
    /// The loads; they are superposed.
    pub loads: Vec<Load>,
    /// The ends of the increments in increasing order, s; the history begins at 0. A model adds an end at each kink of
    /// a history, see [`Description::ends_at_kinks`].
    pub times: Vec<f64>,
    /// The units of the results. All numbers here are SI.
    pub units: Units,
}

/// An axis of coordinates.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum Axis {
    /// To the right.
    X,
    /// Upwards in two dimensions.
    Y,
    /// Upwards in three dimensions.
    Z,
}

impl Description {
    /// Creates a description of `mesh` and `material` without supports, contacts or loads; increments end at `times`
    /// (s).
    pub fn new(mesh: impl Into<MeshSource>, material: Material, times: Vec<f64>) -> Self {
        Description {
            mesh: mesh.into(),
            element: Element::default(),
            material,
            couplings: Vec::new(),
            supports: Vec::new(),
            contacts: Vec::new(),
            pretensions: Vec::new(),
            springs: Vec::new(),
            loads: Vec::new(),
            times,
            units: Units::SI,
        }
    }

    /// Sets the element formulation.
    #[must_use]
    pub fn element(self, element: Element) -> Self {
        Description { element, ..self }
    }

    /// Adds a coupling.
    #[must_use]
    pub fn coupling(mut self, coupling: Coupling) -> Self {
        self.couplings.push(coupling);
        self
    }

    /// Adds a support that fixes the displacements of `boundary` along `axes` at zero.
    #[must_use]
    pub fn support(self, boundary: &str, axes: &[Axis]) -> Self {
        self.with_support(Support::new(boundary, axes))
    }

    /// Adds a support.
    #[must_use]
    pub fn with_support(mut self, support: Support) -> Self {
        self.supports.push(support);
        self
    }

    /// Adds a spring or an elastic foundation.
    #[must_use]
    pub fn spring(mut self, spring: Bed) -> Self {
        self.springs.push(spring);
        self
    }

    /// Adds a contact of `boundary` with one or several obstacles; `friction` is Coulomb's coefficient, a number or a
    /// formula.
    #[must_use]
    pub fn contact(mut self, boundary: &str, friction: impl Into<Field>, obstacles: impl Into<Vec<Obstacle>>) -> Self {
        self.contacts.push(Contact::new(boundary, friction, Against::Obstacles(obstacles.into())));
        self
    }

    /// Adds a contact of `boundary` with another boundary; `friction` is Coulomb's coefficient, a number or a formula.
    #[must_use]
    pub fn pair(mut self, boundary: &str, friction: impl Into<Field>, against: impl Into<Opposite>) -> Self {
        self.contacts.push(Contact::new(boundary, friction, Against::Boundary(against.into())));
        self
    }

    /// Glues `boundary` to another.
    #[must_use]
    pub fn glued(self, boundary: &str, against: impl Into<Opposite>) -> Self {
        let opposite = Opposite { glued: true, ..against.into() };
        self.pair(boundary, 0.0, opposite)
    }

    /// Returns `true` if `boundary` is glued to its opposite side over a period.
    pub fn is_periodic(&self, boundary: &str) -> bool {
        let shifted = |contact: &Contact| contact.opposite().is_some_and(|opposite| opposite.shift.is_some());
        self.contacts.iter().any(|contact| contact.boundary == boundary && shifted(contact))
    }

    /// Adds a pretension.
    #[must_use]
    pub fn pretension(mut self, pretension: Pretension) -> Self {
        self.pretensions.push(pretension);
        self
    }

    /// Adds a load.
    #[must_use]
    pub fn load(mut self, load: Load) -> Self {
        self.loads.push(load);
        self
    }

    /// Returns the units of the results of a body with `dimension` dimensions.
    pub fn system(&self, dimension: usize) -> UnitSystem {
        let components = if self.material.plane == Some(Plane::Torsion) { 3 } else { dimension };
        UnitSystem { units: self.units, dimension, components, depth: self.material.depth(dimension) }
    }

    /// Returns the end of the history, s; 0 without increments.
    pub fn end(&self) -> f64 {
        self.times.last().copied().unwrap_or(0.0)
    }
}
