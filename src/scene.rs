//! Scenes: what is to be solved, read from TOML and checked. Everything is SI.
//!
//! ```
//! use stickslip::scene::Scene;
//!
//! let text = r#"
//!     [mesh]
//!     kind = "block"
//!     size = [1.0, 0.5]
//!     elements = [20, 10]
//!     [material]
//!     young = 210e9
//!     poisson = 0.3
//!     [[support]]
//!     boundary = "left"
//!     fix = ["x", "y"]
//!     [time]
//!     end = 1.0
//!     increments = 10
//! "#;
//! let scene = Scene::parse("beam.toml", text, &["material.poisson=0.25".parse()?])?;
//! assert_eq!(scene.material.poisson, 0.25);
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```

mod check;
mod document;
mod error;
mod overrides;
mod solver;

use std::fmt;
use std::ops::Range;
use std::path::Path;

use serde::{Deserialize, Serialize};

pub use error::{Located, SceneError};
pub use overrides::{Override, OverrideSyntax};
pub use solver::{LinearBackend, Method, MethodName, NewtonSystem, Partition, Setting, Solver, Start};

use error::Source;

/// A checked scene.
#[derive(Debug, Clone, PartialEq)]
pub struct Scene {
    /// A line for headings.
    pub title: String,
    /// The body's mesh.
    pub mesh: Mesh,
    /// The elements of the mesh.
    pub element: Element,
    /// The body's material.
    pub material: Material,
    /// Where the body is held.
    pub supports: Vec<Support>,
    /// Where the body can touch an obstacle.
    pub contacts: Vec<Contact>,
    /// What loads the body.
    pub loads: Vec<Load>,
    /// The history's end and increments.
    pub time: Time,
    /// How to solve.
    pub solver: Solver,
    /// What to write.
    pub output: Output,
    source: Source,
}

/// How the mesh is made.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Mesh {
    /// A rectangle with its lower left corner in the origin.
    Block {
        /// Width and height, m.
        size: [f64; 2],
        /// Elements along x and y.
        elements: [usize; 2],
        /// Size of the last element over that of the first along x and y, in geometric progression.
        grading: [f64; 2],
    },
    /// A rectangle that stands for a half-plane pressed at the left end of its top.
    HalfPlane(HalfPlane),
}

/// How the strain of an element follows from its corner displacements.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Element {
    /// As that of bilinear displacements; too stiff (it locks) when Poisson's ratio is close to 0.5 in
    /// plane strain.
    #[default]
    Bilinear,
    /// With the mean dilatation of the element in place of the local one: does not lock. Plane
    /// strain only.
    BBar,
}

/// A rectangle, fine under a contact zone at the left end of its top and coarser away from it:
/// half of a body that is symmetric about its left side.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct HalfPlane {
    /// Width and height, m.
    pub size: [f64; 2],
    /// Width of the contact zone, m.
    pub contact_width: f64,
    /// Equal elements along the contact zone.
    pub contact_elements: usize,
    /// Equal elements along the rest of the top.
    pub outer_elements: usize,
    /// Layers of elements, in geometric progression from the top one, whose elements are square in
    /// the contact zone, to the bottom.
    pub layers: usize,
}

/// An isotropic linear elastic material in the plane, of unit thickness.
#[derive(Debug, Clone, PartialEq)]
pub struct Material {
    /// Young's modulus, Pa.
    pub young: f64,
    /// Poisson's ratio, in (-1, 0.5).
    pub poisson: f64,
    /// Plane strain or plane stress.
    pub plane: Plane,
    /// Horizontal layers of other materials, from the bottom of the body up; above the last, the
    /// material itself.
    pub layers: Vec<Layer>,
}

/// A horizontal layer of the body.
#[derive(Debug, Clone, PartialEq)]
pub struct Layer {
    /// Height of its upper side over the bottom of the body, m.
    pub top: f64,
    /// Young's modulus, Pa.
    pub young: f64,
    /// Poisson's ratio, in (-1, 0.5).
    pub poisson: f64,
    /// Where the scene says it.
    pub span: Range<usize>,
}

/// The plane state of the body.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum Plane {
    /// `ε_zz = 0`: a slice of a long body.
    #[default]
    Strain,
    /// `σ_zz = 0`: a thin plate.
    Stress,
}

/// The name of a boundary, and where the scene says it.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Name {
    text: String,
    span: Range<usize>,
}

/// Components of the displacement held at zero on a boundary.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Support {
    /// The boundary.
    pub boundary: Name,
    /// Whether x and y are held.
    pub fix: [bool; 2],
}

/// A boundary that can touch an obstacle.
#[derive(Debug, Clone, PartialEq)]
pub struct Contact {
    /// The boundary.
    pub boundary: Name,
    /// Coulomb's coefficient `μ ≥ 0`.
    pub friction: f64,
    /// The obstacle.
    pub obstacle: Obstacle,
}

/// A rigid obstacle.
#[derive(Debug, Clone, PartialEq)]
pub struct Obstacle {
    /// Its shape and place.
    pub shape: Shape,
    /// Unit vector out of the body towards the obstacle; without it, the boundary's outward normal.
    pub normal: Option<[f64; 2]>,
    /// Unit vector of positive slip; without it, the normal turned by +90°.
    pub tangent: Option<[f64; 2]>,
    /// How far it has moved towards the body, against the normal: points `[time (s), distance (m)]`
    /// with increasing times; linear between, constant outside. Empty if it does not move.
    pub approach: Vec<[f64; 2]>,
    /// Where the scene says it.
    pub span: Range<usize>,
}

/// The shape of an obstacle.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Shape {
    /// A plane.
    Plane {
        /// Distance to the nearest point of the boundary, m; negative for interference.
        gap: f64,
    },
    /// A cylinder, its axis across the plane of the body.
    Cylinder {
        /// Radius, m.
        radius: f64,
        /// Its point nearest to the body, m.
        apex: [f64; 2],
    },
}

/// A uniform traction on a boundary, times a factor that changes in time.
#[derive(Debug, Clone, PartialEq)]
pub struct Load {
    /// The boundary.
    pub boundary: Name,
    /// Traction at factor 1, N/m².
    pub traction: [f64; 2],
    /// Points `[time (s), factor]` with increasing times; linear between, constant outside.
    pub history: Vec<[f64; 2]>,
}

/// The time of the history, which starts at 0.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Time {
    /// The end, s.
    pub end: f64,
    /// The number of equal increments.
    pub increments: usize,
}

/// What to write.
#[derive(Debug, Clone, PartialEq)]
pub struct Output {
    /// Times (s) whose contact lines are written: each at the first increment that reaches it.
    pub times: Vec<f64>,
}

impl Scene {
    /// Reads the scene file at `path`, with `overrides` in place of what it says.
    ///
    /// # Errors
    /// When the file cannot be read, or the scene is not sound; the message names file and line.
    pub fn read(path: &Path, overrides: &[Override]) -> Result<Self, SceneError> {
        let text = std::fs::read_to_string(path)
            .map_err(|error| SceneError::Io { path: path.display().to_string(), error })?;
        Self::parse(&path.display().to_string(), &text, overrides)
    }

    /// Reads a scene from `text`; `name` stands for the file in messages.
    ///
    /// # Errors
    /// When the scene is not sound; the message names `name` and the line.
    pub fn parse(name: &str, text: &str, overrides: &[Override]) -> Result<Self, SceneError> {
        let source = overrides::apply(name, text, overrides)?;
        let document = document::Document::parse(&source)?;
        check::scene(document, source)
    }

    /// The same scene with further `overrides`.
    ///
    /// # Errors
    /// As [`Scene::parse`].
    pub fn with(&self, overrides: &[Override]) -> Result<Self, SceneError> {
        Self::parse(self.source.name.trim_end_matches(overrides::MARK), &self.source.text, overrides)
    }

    /// An error at `span` of this scene, for what only a later stage can see.
    pub fn error_at(&self, span: Range<usize>, message: impl Into<String>, help: impl Into<String>) -> SceneError {
        self.source.error(span, message, help)
    }

    /// The error for a boundary that the mesh does not have.
    pub fn unknown_boundary(&self, name: &Name, known: &[&str]) -> SceneError {
        let help = format!("the mesh has the boundaries {}", known.join(", "));
        self.error_at(name.span(), format!("the mesh has no boundary `{name}`"), help)
    }
}

impl Mesh {
    /// The number of nodes.
    pub fn nodes(&self) -> usize {
        match *self {
            Mesh::Block { elements: [nx, ny], .. } => (nx + 1) * (ny + 1),
            Mesh::HalfPlane(m) => (m.contact_elements + m.outer_elements + 1) * (m.layers + 1),
        }
    }
}

impl Material {
    /// The number of the layer at `height` (m) over the bottom; `None` in the base material.
    pub fn layer(&self, height: f64) -> Option<usize> {
        self.layers.iter().position(|layer| height < layer.top)
    }
}

impl Name {
    /// The name.
    pub fn as_str(&self) -> &str {
        &self.text
    }

    /// Its place in the scene's text.
    pub fn span(&self) -> Range<usize> {
        self.span.clone()
    }
}

impl fmt::Display for Name {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(&self.text)
    }
}

impl Time {
    /// The end of increment `k` (from 1), s.
    pub fn at(&self, k: usize) -> f64 {
        if k == self.increments { self.end } else { self.end * k as f64 / self.increments as f64 }
    }

    /// The ends of all increments, s.
    pub fn all(&self) -> Vec<f64> {
        (1..=self.increments).map(|k| self.at(k)).collect()
    }
}
