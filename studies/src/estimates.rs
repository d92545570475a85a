//! What the estimates of a run say beside what is true: contact zones of few nodes against Hertz, elements that lock against fine ones, increments against
//! the exact path.

mod hertz;
mod increments;
mod locking;

use std::fmt;
use stickslip::base::InputError;
use stickslip::body::mesh::CellKind;
use stickslip::body::{Description, Model, ModelError};
use stickslip::run::report::RunReport;
use stickslip::run::{Run, RunError};
use stickslip::scene::{OverrideSyntax, SceneError};
use stickslip::solver::history::{Method, SolverChoice, Status};

pub use hertz::{lines, spheres};
pub use increments::increments;
pub use locking::{cantilevers, pressed};

/// Why a state was not computed.
#[derive(Debug, thiserror::Error)]
pub enum EstimateError {
    /// The body cannot be.
    #[error(transparent)]
    Model(#[from] ModelError),
    /// It cannot be solved.
    #[error(transparent)]
    Run(#[from] RunError),
    /// It was not solved.
    #[error("a state of the suite ended with the verdict {0}")]
    Verdict(String),
    /// A scene of the suite cannot be.
    #[error(transparent)]
    Scene(#[from] SceneError),
    /// Nor what is changed in it.
    #[error(transparent)]
    Override(#[from] OverrideSyntax),
    /// A mesh of the suite cannot be.
    #[error(transparent)]
    Mesh(#[from] InputError),
}

/// What is estimated.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Subject {
    /// The peak pressure under a cylinder.
    Line,
    /// The same under a sphere.
    Sphere,
    /// The stiffness of a block that is pressed.
    Pressed,
    /// The stiffness of a beam that is bent.
    Cantilever,
    /// The work of friction.
    Work,
    /// The tangential forces.
    Friction,
}

impl fmt::Display for Subject {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Subject::Line => "line",
            Subject::Sphere => "sphere",
            Subject::Pressed => "pressed",
            Subject::Cantilever => "cantilever",
            Subject::Work => "work of friction",
            Subject::Friction => "tangential forces",
        })
    }
}

/// An estimate beside the truth.
#[derive(Debug, Clone, PartialEq)]
pub struct Row {
    /// What is estimated.
    pub subject: Subject,
    /// The cells.
    pub kind: CellKind,
    /// Poisson's ratio.
    pub poisson: f64,
    /// Nodes across the contact, elements across the body, or increments a stretch of the history.
    pub across: usize,
    /// The true error, as a share: of the peak pressure for the force that was found, by how much the body is too stiff, of the work, or the
    /// largest of the tangential forces by the largest of these.
    pub error: f64,
    /// What the run says of it.
    pub estimate: f64,
    /// Whether it warned, where that depends on more than the estimate.
    pub warned: Option<bool>,
}

/// Many states of one kind.
pub struct Task {
    /// What is computed.
    pub name: String,
    work: Box<dyn Fn() -> Result<Vec<Row>, EstimateError> + Sync + Send>,
}

impl Task {
    /// Computes them.
    ///
    /// # Errors
    /// The first state that was not computed.
    pub fn rows(&self) -> Result<Vec<Row>, EstimateError> {
        (self.work)()
    }
}

/// The report of a body, which has to converge.
fn solved(description: &Description) -> Result<RunReport, EstimateError> {
    let model = Model::build(description)?;
    let report = Run::of(&model, model.times().to_vec(), SolverChoice::new(Method::BN))?.solve(&mut ())?;
    if report.status == Status::Converged { Ok(report) } else { Err(EstimateError::Verdict(report.status.to_string())) }
}
