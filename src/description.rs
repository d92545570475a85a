//! What a model is made of, without text: mesh, materials, supports, contacts, loads and the ends of the increments. A
//! scene file is one way to come by it, plain Rust another.
//!
//! ```
//! use stickslip::contact::Obstacle;
//! use stickslip::description::{Axis, Description, Load};
//! use stickslip::fem::Material;
//! use stickslip::history::{Method, Solver, Status};
//! use stickslip::mesh::MeshSource;
//! use stickslip::model::Model;
//! use stickslip::run::Run;
//! use stickslip::timeline::equal_increments;
//!
//! let steel = Material::new(210e9, 0.3);
//! let description = Description::new(MeshSource::block([1.0, 1.0], [10, 10]), steel, equal_increments(2.0, 4))
//!     .support("left", &[Axis::X, Axis::Y])
//!     .contact("bottom", 0.4, Obstacle::plane(1e-5))
//!     .load(Load::new("top", &[0.0, -10e6]).over(&[[0.0, 0.0], [1.0, 1.0], [2.0, 1.0]]))
//!     .load(Load::new("right", &[-10e6, 0.0]).over(&[[0.0, 0.0], [1.0, 1.0], [2.0, 0.0]]));
//! let model = Model::build(&description)?;
//! let report = Run::of(&model, model.times().to_vec(), Solver::new(Method::BN))?.solve(&mut ())?;
//! assert_eq!(report.status, Status::Converged);
//!
//! // What is wrong is named by its key.
//! let mirror = description.contact("right", -0.4, Obstacle::plane(0.0));
//! assert!(Model::build(&mirror).unwrap_err().to_string().starts_with("contact[1].friction: "));
//! # Ok::<(), stickslip::run::RunError>(())
//! ```

mod check;
mod probe;

pub use probe::{Probe, ProbePlace};

use serde::Deserialize;

use crate::contact::Obstacle;
use crate::fem::{Element, Material};
use crate::mesh::MeshSource;

/// One elastic body, what holds, meets and loads it, and the ends of the increments of its history. Checked when a
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
    /// What loads it; loads add up.
    pub loads: Vec<Load>,
    /// The ends of the increments, s, increasing; the history begins at 0.
    pub times: Vec<f64>,
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

/// Components of the displacement held at zero on a boundary.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Support {
    /// The boundary.
    pub boundary: String,
    /// Whether x, y and z are held.
    pub fix: [bool; 3],
}

/// A boundary that can touch an obstacle.
#[derive(Debug, Clone, PartialEq)]
pub struct Contact {
    /// The boundary.
    pub boundary: String,
    /// Coulomb's coefficient `μ ≥ 0`.
    pub friction: f64,
    /// The obstacle.
    pub obstacle: Obstacle,
}

/// A uniform traction on a boundary, times a factor that changes in time.
#[derive(Debug, Clone, PartialEq)]
pub struct Load {
    /// The boundary.
    pub boundary: String,
    /// Traction at factor 1, N/m²: two components or three.
    pub traction: Vec<f64>,
    /// Points `[time (s), factor]` with increasing times; linear between, constant outside. Without them the factor
    /// grows from 0 at the beginning to 1 at the end.
    pub history: Option<Vec<[f64; 2]>>,
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
            loads: Vec::new(),
            times,
        }
    }

    /// With these elements.
    #[must_use]
    pub fn element(self, element: Element) -> Self {
        Description { element, ..self }
    }

    /// With the displacements of `boundary` along `axes` held at zero.
    #[must_use]
    pub fn support(mut self, boundary: &str, axes: &[Axis]) -> Self {
        self.supports.push(Support::new(boundary, axes));
        self
    }

    /// With an `obstacle` in front of `boundary`; `friction` is Coulomb's coefficient.
    #[must_use]
    pub fn contact(mut self, boundary: &str, friction: f64, obstacle: Obstacle) -> Self {
        self.contacts.push(Contact { boundary: boundary.to_string(), friction, obstacle });
        self
    }

    /// With one more load.
    #[must_use]
    pub fn load(mut self, load: Load) -> Self {
        self.loads.push(load);
        self
    }

    /// The end of the history, s; 0 without increments.
    pub fn end(&self) -> f64 {
        self.times.last().copied().unwrap_or(0.0)
    }
}

impl Support {
    /// The displacements of `boundary` along `axes`.
    pub fn new(boundary: &str, axes: &[Axis]) -> Self {
        let fix = [Axis::X, Axis::Y, Axis::Z].map(|axis| axes.contains(&axis));
        Support { boundary: boundary.to_string(), fix }
    }
}

impl Load {
    /// A `traction` (N/m², two components or three) on `boundary` that grows from 0 at the beginning to the whole of it
    /// at the end.
    pub fn new(boundary: &str, traction: &[f64]) -> Self {
        Load { boundary: boundary.to_string(), traction: traction.to_vec(), history: None }
    }

    /// The same traction times the factor of `history`: points `[time (s), factor]`.
    #[must_use]
    pub fn over(self, history: &[[f64; 2]]) -> Self {
        Load { history: Some(history.to_vec()), ..self }
    }

    /// The points `[time (s), factor]` of its history, which ends at `end` (s) if it does not say when.
    pub fn factors(&self, end: f64) -> Vec<[f64; 2]> {
        self.history.clone().unwrap_or_else(|| vec![[0.0, 0.0], [end, 1.0]])
    }
}
