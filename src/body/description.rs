//! What a model is made of, without text: mesh, materials, supports, contacts, loads and the ends of the increments. A
//! scene file is one way to come by it, plain Rust another.
//!
//! ```
//! use stickslip::body::contact::Obstacle;
//! use stickslip::body::description::{Axis, Description, Load};
//! use stickslip::body::fem::Material;
//! use stickslip::solver::history::{Method, SolverChoice, Status};
//! use stickslip::body::mesh::MeshSource;
//! use stickslip::body::model::Model;
//! use stickslip::run::Run;
//! use stickslip::base::timeline::equal_increments;
//!
//! let steel = Material::new(210e9, 0.3);
//! let description = Description::new(MeshSource::block([1.0, 1.0], [10, 10]), steel, equal_increments(2.0, 4))
//!     .support("left", &[Axis::X, Axis::Y])
//!     .contact("bottom", 0.4, Obstacle::plane(1e-5))
//!     .load(Load::new("top", &[0.0, -10e6]).over(&[[0.0, 0.0], [1.0, 1.0], [2.0, 1.0]]))
//!     .load(Load::new("right", &[-10e6, 0.0]).over(&[[0.0, 0.0], [1.0, 1.0], [2.0, 0.0]]));
//! let model = Model::build(&description)?;
//! let report = Run::of(&model, model.times().to_vec(), SolverChoice::new(Method::BN))?.solve(&mut ())?;
//! assert_eq!(report.status, Status::Converged);
//!
//! // What is wrong is named by its key.
//! let mirror = description.contact("right", -0.4, Obstacle::plane(0.0));
//! assert!(Model::build(&mirror).unwrap_err().to_string().starts_with("contact[1].friction: "));
//! # Ok::<(), stickslip::run::RunError>(())
//! ```

mod check;
mod field;
mod formulas;
mod kinks;
mod load;
mod opposite;
mod probe;
mod spring;
mod support;
mod units;

pub use field::Field;
pub use kinks::Kinks;
pub use load::{Action, Load, Where};
pub use opposite::{FirstGap, Opposite, Slave};
pub use probe::{Probe, ProbePlace};
pub use spring::Bed;
pub use support::{Direction, Held, Support};

use serde::Deserialize;

use crate::base::units::{UnitSystem, Units};
use crate::body::contact::{Friction, Obstacle};
use crate::body::fem::{Element, Material};
use crate::body::mesh::MeshSource;

/// One elastic body or several, what holds, meets and loads them, and the ends of the increments of its history. Checked when a
/// model is made of it, or by [`Description::check`].
#[derive(Debug, Clone, PartialEq)]
pub struct Description {
    /// The mesh.
    pub mesh: MeshSource,
    /// Its elements.
    pub element: Element,
    /// The material, with its layers or groups.
    pub material: Material,
    /// Where the body is held.
    pub supports: Vec<Support>,
    /// Where it can touch an obstacle.
    pub contacts: Vec<Contact>,
    /// Springs and foundations that it stands on.
    pub springs: Vec<Bed>,
    /// What loads it; loads add up.
    pub loads: Vec<Load>,
    /// The ends of the increments, s, increasing; the history begins at 0. A model has further ends where histories have
    /// kinks, see [`Description::ends_at_kinks`].
    pub times: Vec<f64>,
    /// The units in which results are told. All numbers here are SI; see [`Description::given_in`].
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

/// A boundary that can touch an obstacle.
#[derive(Debug, Clone, PartialEq)]
pub struct Contact {
    /// The boundary.
    pub boundary: String,
    /// Coulomb's coefficient. A node that two contacts share, in front of the same normal, has the mean of both, weighted by the
    /// node's area in each.
    pub friction: Friction,
    /// Points `[time (s), factor]` with increasing times, by which the coefficient is multiplied: linear between, constant outside, and
    /// above 0. Without them the friction stays as it is.
    pub friction_history: Option<Vec<[f64; 2]>>,
    /// What is in front of it.
    pub against: Against,
}

/// What is in front of a boundary.
#[derive(Debug, Clone, PartialEq)]
pub enum Against {
    /// Rigid obstacles, at least one. A node meets the one that is nearest when the history begins, of those that its outside
    /// faces; of those with the same normal the one that is nearest at the time.
    Obstacles(Vec<Obstacle>),
    /// Another boundary, of another body as a rule.
    Boundary(Opposite),
}

impl<T: Into<Vec<Obstacle>>> From<T> for Against {
    fn from(obstacles: T) -> Self {
        Against::Obstacles(obstacles.into())
    }
}

impl Contact {
    /// The obstacles in front of it; none in front of another boundary.
    pub fn obstacles(&self) -> &[Obstacle] {
        match &self.against {
            Against::Obstacles(obstacles) => obstacles,
            Against::Boundary(_) => &[],
        }
    }

    /// The boundary that it is against, if it is.
    pub fn opposite(&self) -> Option<&Opposite> {
        match &self.against {
            Against::Obstacles(_) => None,
            Against::Boundary(opposite) => Some(opposite),
        }
    }

    /// The key of obstacle `j` of this contact, which has the number `k`.
    pub(crate) fn obstacle_key(&self, k: usize, j: usize) -> String {
        match self.obstacles().len() {
            1 => format!("contact[{k}].obstacle"),
            _ => format!("contact[{k}].obstacle[{j}]"),
        }
    }
}

impl Description {
    /// A body of `mesh` and `material` that nothing holds, meets or loads yet, over increments that end at `times` (s).
    pub fn new(mesh: impl Into<MeshSource>, material: Material, times: Vec<f64>) -> Self {
        Description {
            mesh: mesh.into(),
            element: Element::default(),
            material,
            supports: Vec::new(),
            contacts: Vec::new(),
            springs: Vec::new(),
            loads: Vec::new(),
            times,
            units: Units::SI,
        }
    }

    /// With these elements.
    #[must_use]
    pub fn element(self, element: Element) -> Self {
        Description { element, ..self }
    }

    /// With the displacements of `boundary` along `axes` held at zero.
    #[must_use]
    pub fn support(self, boundary: &str, axes: &[Axis]) -> Self {
        self.held(Support::new(boundary, axes))
    }

    /// With one more support.
    #[must_use]
    pub fn held(mut self, support: Support) -> Self {
        self.supports.push(support);
        self
    }

    /// With one more spring or foundation.
    #[must_use]
    pub fn spring(mut self, spring: Bed) -> Self {
        self.springs.push(spring);
        self
    }

    /// With an obstacle or several in front of `boundary`; `friction` is Coulomb's coefficient, a number or a formula.
    #[must_use]
    pub fn contact(
        mut self,
        boundary: &str,
        friction: impl Into<Friction>,
        obstacles: impl Into<Vec<Obstacle>>,
    ) -> Self {
        let (friction, against) = (friction.into(), Against::Obstacles(obstacles.into()));
        let boundary = boundary.to_string();
        self.contacts.push(Contact { boundary, friction, friction_history: None, against });
        self
    }

    /// With `boundary` in front of another; `friction` is Coulomb's coefficient, a number or a formula.
    #[must_use]
    pub fn pair(mut self, boundary: &str, friction: impl Into<Friction>, against: impl Into<Opposite>) -> Self {
        let (boundary, friction) = (boundary.to_string(), friction.into());
        let against = Against::Boundary(against.into());
        self.contacts.push(Contact { boundary, friction, friction_history: None, against });
        self
    }

    /// With `boundary` glued to another.
    #[must_use]
    pub fn glued(self, boundary: &str, against: impl Into<Opposite>) -> Self {
        let opposite = Opposite { glued: true, ..against.into() };
        self.pair(boundary, 0.0, opposite)
    }

    /// With one more load.
    #[must_use]
    pub fn load(mut self, load: Load) -> Self {
        self.loads.push(load);
        self
    }

    /// The units in which results of a body of so many dimensions are told.
    pub fn system(&self, dimension: usize) -> UnitSystem {
        let per_depth = dimension == 2 && !self.material.is_axisymmetric();
        UnitSystem { units: self.units, dimension, per_depth }
    }

    /// The end of the history, s; 0 without increments.
    pub fn end(&self) -> f64 {
        self.times.last().copied().unwrap_or(0.0)
    }
}
