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
mod fault;
mod formula;
mod mesh;
mod obstacle;
mod overrides;
mod solver;

use std::fmt;
use std::ops::Range;
use std::path::Path;

use serde::{Deserialize, Serialize};

pub use error::{Located, SceneError};
pub use formula::{Formula, FormulaError};
pub use mesh::{CellShape, Element, HalfPlane, Mesh, Segment};
pub use obstacle::{GapDirection, Obstacle, Rotation, Shape};
pub use overrides::{Override, OverrideSyntax};

use crate::history::Solver;
use error::Source;

/// The JSON Schema (draft 2020-12) of a scene, for editors that complete and check TOML. What depends on several keys at
/// once only the reader of scenes checks.
pub const SCHEMA: &str = include_str!("scene/schema.json");

/// A checked scene.
#[derive(Debug, Clone, PartialEq)]
pub struct Scene {
    /// A line for headings.
    pub title: String,
    /// The body's mesh.
    pub mesh: Mesh,
    /// The elements of the mesh.
    pub element: Element,
    /// Where the scene says which, if it does.
    pub element_span: Option<Range<usize>>,
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
    /// Where the scene asks for a method that knows one tangent a node only, if it does: ip in the setting
    /// `paper`, or with `newton = "extended"`.
    pub one_tangent_span: Option<Range<usize>>,
    /// What to write.
    pub output: Output,
    source: Source,
}

/// The isotropic linear elastic materials of the body; in two dimensions it is of unit thickness.
#[derive(Debug, Clone, PartialEq)]
pub struct Material {
    /// Young's modulus, Pa.
    pub young: f64,
    /// Poisson's ratio, in (-1, 0.5).
    pub poisson: f64,
    /// Plane strain or plane stress, in two dimensions.
    pub plane: Plane,
    /// Where the scene says which, if it does.
    pub plane_span: Option<Range<usize>>,
    /// Horizontal layers of other materials, from the bottom of the body up; above the last, the
    /// material itself.
    pub layers: Vec<Layer>,
    /// Other materials of groups of elements; the other groups are of the material itself.
    pub groups: Vec<MaterialGroup>,
}

/// The material of a group of elements.
#[derive(Debug, Clone, PartialEq)]
pub struct MaterialGroup {
    /// The group of the mesh.
    pub name: Name,
    /// Young's modulus, Pa.
    pub young: f64,
    /// Poisson's ratio, in (-1, 0.5).
    pub poisson: f64,
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
    /// Whether x, y and z are held.
    pub fix: [bool; 3],
    /// Where the scene says it.
    pub span: Range<usize>,
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

/// A uniform traction on a boundary, times a factor that changes in time.
#[derive(Debug, Clone, PartialEq)]
pub struct Load {
    /// The boundary.
    pub boundary: Name,
    /// Traction at factor 1, N/m²: two components or three.
    pub traction: Vec<f64>,
    /// Where the scene says it.
    pub traction_span: Range<usize>,
    /// Points `[time (s), factor]` with increasing times from 0 to the end of the scene; linear between, constant outside.
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
    /// Whether the fields of the body are written for the same times.
    pub fields: bool,
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
        Self::parse(self.file(), self.text(), overrides)
    }

    /// The file it was read from, or what stood for that.
    pub fn file(&self) -> &str {
        self.source.name.trim_end_matches(overrides::MARK)
    }

    /// Its text in TOML, with all overrides in place.
    pub fn text(&self) -> &str {
        &self.source.text
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
