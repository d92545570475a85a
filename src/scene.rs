//! Scenes: what is to be solved, read from TOML and checked. Texts may be in units of their own;
//! what is read from them is SI.
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
//! assert_eq!(scene.description.material.poisson, 0.25);
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```

mod error;
mod from_abaqus;
mod overrides;
mod provenance;
mod read;
mod schema;
mod syntax;
mod values;

use std::path::{Path, PathBuf};

use serde::Deserialize;

pub use crate::base::input::{Contents, with_contents};
pub use error::{Located, SceneError};
pub use overrides::{Override, OverrideSyntax};
pub use provenance::Provenance;
pub use schema::schema;

use crate::base::input_error::InputError;
use crate::base::timeline::{equal_increments, with_further_ends};
use crate::body::description::{CycleRequest, Description, Probe};
use crate::solver::history::SolverChoice;
use error::Source;

/// A checked scene.
#[derive(Debug, Clone, PartialEq)]
pub struct Scene {
    /// A line for headings.
    pub title: String,
    /// The model to solve.
    pub description: Description,
    /// The error of the mesh in the energy norm, relative, up to which it refines itself; `None` to leave it as it is.
    pub refine: Option<f64>,
    /// The history's end and increments, whose ends the description has.
    pub time: Time,
    /// The method, its constants and the linear algebra.
    pub solver: SolverChoice,
    /// The options of PETSc, as on its command line.
    pub petsc: String,
    /// What to write.
    pub output: Output,
    source: Source,
}

/// The history, which starts at 0.
#[derive(Debug, Clone, PartialEq, Deserialize, schemars::JsonSchema)]
#[serde(deny_unknown_fields, rename = "time")]
pub struct Time {
    /// End of the history, which begins at 0.
    /// Example: `end = 2.0`. Value: number, s.
    #[schemars(extend("exclusiveMinimum" = 0))]
    pub end: f64,
    /// Number of equal increments.
    /// Example: `increments = 20`. Value: integer.
    #[schemars(extend("minimum" = 1))]
    pub increments: usize,
    /// Where increments end besides, s: kinks of histories at which none of the equal ones ends.
    #[serde(skip)]
    pub kinks: Vec<f64>,
}

/// What to write.
#[derive(Debug, Clone, PartialEq)]
pub struct Output {
    /// Times (s) whose contact lines are written: each at the first increment that reaches it, 0 before the first.
    pub times: Vec<f64>,
    /// Besides, those of every so many increments and of the last one are written.
    pub every: Option<usize>,
    /// `true` if the fields of the body are written for the same times.
    pub fields: bool,
    /// `true` if pictures of the deformed body are drawn for the same times.
    pub deformed: bool,
    /// The magnification of displacements in these pictures; `None` chooses one that shows them well.
    pub magnification: Option<f64>,
    /// The load cycle whose results are written.
    pub cycle: Option<CycleRequest>,
    /// Points whose displacements and stresses are written in every increment.
    pub probes: Vec<Probe>,
}

impl Output {
    /// The numbers of the increments that are written, of those that end at `ends` (s), ascending; 0 stands for the body
    /// before the first.
    pub fn increments(&self, ends: &[f64]) -> Vec<usize> {
        // A time computed as end · k / increments may miss the one asked for by a rounding error.
        let slack = ends.last().map_or(0.0, |end| 1e-9 * end);
        let reaching =
            |t: &f64| if *t <= 0.0 { Some(0) } else { Some(1 + ends.iter().position(|end| *end >= t - slack)?) };
        let mut numbers: Vec<usize> = self.times.iter().filter_map(reaching).collect();
        if let Some(every) = self.every {
            numbers.extend((1..=ends.len()).filter(|k| k % every == 0 || *k == ends.len()));
        }
        numbers.sort_unstable();
        numbers.dedup();
        numbers
    }
}

impl Scene {
    /// Reads the scene file at `path`, with `overrides` in place of what it says.
    ///
    /// # Errors
    /// When the file cannot be read, or the scene is not sound; the message names file and line.
    pub fn read(path: &Path, overrides: &[Override]) -> Result<Self, SceneError> {
        let text = crate::base::input::text_or_pipe(path).map_err(|error| {
            let io = SceneError::Io { path: path.display().to_string(), error };
            let bytes = crate::base::input::read_bytes(path).unwrap_or_default();
            SceneError::other(&path.display().to_string(), &bytes).unwrap_or(io)
        })?;
        Self::parse(&path.display().to_string(), &text, overrides)
    }

    /// Reads a scene from `text`; `name` stands for the file in messages.
    ///
    /// # Errors
    /// When the scene is not sound; the message names `name` and the line.
    pub fn parse(name: &str, text: &str, overrides: &[Override]) -> Result<Self, SceneError> {
        let scene = overrides::apply(name, text, overrides).and_then(|source| read::scene(&source));
        scene.map_err(|error| SceneError::other(name, text.as_bytes()).unwrap_or(error))
    }

    /// Returns the scene with further `overrides`.
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

    /// The files that it names, meshes and tables of gaps, and those that its meshes include.
    pub fn files(&self) -> Vec<PathBuf> {
        let named = self.source.files().into_iter().map(|(_, file)| self.source.beside(&file));
        named.chain(self.description.mesh.includes()).collect()
    }

    /// The files that it names with their contents, without the mark that some editors put before UTF-8; see [`with_contents`].
    ///
    /// # Errors
    /// The file that cannot be read, and why.
    pub fn contents(&self) -> Result<Contents, SceneError> {
        let read = |path: PathBuf| match crate::base::input::read_bytes(&path) {
            Ok(bytes) => Ok((path, bytes)),
            Err(error) => Err(SceneError::Io { path: path.display().to_string(), error }),
        };
        self.files().into_iter().map(read).collect()
    }

    /// The error of the value at `key`, for what only a later stage can see.
    pub fn error_at(&self, key: &str, message: impl Into<String>, help: impl Into<String>) -> SceneError {
        self.located(InputError::new(key, message, help))
    }

    /// The error of a `file` that the scene names, at the key that names it; of a file that the mesh includes at the mesh.
    pub fn error_of_file(&self, file: &Path, message: impl Into<String>, help: impl Into<String>) -> SceneError {
        let named = self.source.files().into_iter().find(|(_, name)| self.source.beside(name) == file);
        self.error_at(&named.map_or("mesh.file".to_string(), |(key, _)| key), message, help)
    }

    /// `fault` at its place in this scene.
    pub fn located(&self, fault: InputError) -> SceneError {
        self.source.located(fault)
    }
}

impl Time {
    /// The ends of all increments, s.
    pub fn all(&self) -> Vec<f64> {
        with_further_ends(&equal_increments(self.end, self.increments), self.kinks.iter().copied())
    }
}
