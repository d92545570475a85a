//! The solver of a scene: its table, and the choice that it becomes.

use serde::{Deserializer, de};

use super::{Deserialize, JsonSchema, given, only};
use crate::algebra::linear::SparseLu;
use crate::base::input_error::{InputError, ensure, positive};
use crate::solver::formulation::Partition;
use crate::solver::history::{HistoryMethod, LinearAlgebra, Method, SolverChoice, Start};

/// The solver.
#[derive(Deserialize, JsonSchema, Default)]
#[serde(default, deny_unknown_fields, rename = "solver")]
pub(super) struct SolverTable {
    /// [Which to take](../../howto/choose-a-method.md): the B-differentiable Newton method `bn`, the interior point
    /// method `ip`, or the [exact path in time](../../method/exact-path.md) `events`, in which increments are
    /// output times.
    /// Example: `method = "ip"`. Default: `"bn"`.
    pub method: MethodName,
    /// Linear solver; `"auto"` takes the one that suits the sizes of body and contact.
    /// Example: `linear = "condensed"`. Value: see below. Default: `"auto"`.
    #[serde(deserialize_with = "linear_word")]
    #[schemars(with = "String", extend("enum" = LINEAR))]
    pub linear: Option<LinearAlgebra>,
    /// `linear = "petsc"`: [options of PETSc](../../howto/large-bodies.md#options-of-petsc), as on its command
    /// line.
    /// Example: `petsc = "-ksp_monitor"`. Value: text. Default: none.
    pub petsc: Option<String>,
    /// Limit for each relative error of the error measure.
    /// Example: `tolerance = 1e-8`. Default: 1e-10; `ip` with `paper`: 1e-6.
    #[schemars(extend("exclusiveMinimum" = 0, "exclusiveMaximum" = 1))]
    pub tolerance: Option<f64>,
    /// Limit in an increment, or a substep.
    /// Example: `max_iterations = 500`. Value: integer. Default: 200.
    #[schemars(extend("minimum" = 1, "maximum" = 1_000_000))]
    pub max_iterations: Option<usize>,
    /// Constants that adapt to the scene, or those of the [paper](../../method/theory.md).
    /// Example: `setting = "paper"`. Default: `"default"`.
    pub setting: Option<Setting>,
    /// `bn`, `default`: factor on r, which comes from the problem, for studies.
    /// Example: `r_factor = 10`. Default: 1.
    #[schemars(extend("exclusiveMinimum" = 0))]
    pub r_factor: Option<f64>,
    /// `ip`, `paper`: start of an increment.
    /// Example: `start = "prev"`. Default: `"safe"`.
    #[serde(deserialize_with = "start_word")]
    #[schemars(with = "String", extend("enum" = STARTS))]
    pub start: Option<Start>,
    /// `ip`, `paper`: equations that stay positive, (29)–(31) or (26)–(28).
    /// Example: `partition = "cone"`. Default: `"products"`.
    pub partition: Option<Partition>,
}

#[derive(Clone, Copy, Default, Deserialize, JsonSchema)]
#[serde(rename_all = "lowercase")]
pub(super) enum MethodName {
    #[default]
    Bn,
    Ip,
    Events,
}

#[derive(Clone, Copy, Default, Deserialize, JsonSchema)]
#[serde(rename_all = "lowercase")]
pub(super) enum Setting {
    Paper,
    #[default]
    Default,
}

/// Reads `solver.start`.
fn start_word<'de, D: Deserializer<'de>>(deserializer: D) -> Result<Option<Start>, D::Error> {
    match &*String::deserialize(deserializer)? {
        "safe" => Ok(Some(Start::Safe)),
        "prev" => Ok(Some(Start::PREV)),
        other => Err(de::Error::unknown_variant(other, &STARTS)),
    }
}

/// The words of `solver.start`.
const STARTS: [&str; 2] = ["safe", "prev"];

/// Reads `solver.linear`; `None` for `auto`.
fn linear_word<'de, D: Deserializer<'de>>(deserializer: D) -> Result<Option<LinearAlgebra>, D::Error> {
    let word = String::deserialize(deserializer)?;
    let known = if word == "auto" { Ok(None) } else { word.parse().map(Some) };
    known.map_err(|_| de::Error::unknown_variant(&word, &LINEAR))
}

/// The words of `solver.linear`.
const LINEAR: [&str; 10] = [
    "umfpack",
    "mumps",
    "faer",
    "partial",
    "condensed",
    "condensed-cholmod",
    "condensed-faer",
    "multigrid",
    "petsc",
    "auto",
];

const OR_COMPILE: &str = ", or compile with the feature petsc";
const BUILD_IT: &str = "build it with the cargo feature umfpack or faer";

/// Converts `given` to a choice of the solver.
pub(super) fn solver(given: &SolverTable) -> Result<SolverChoice, InputError> {
    let method = method(given)?;
    let max_iterations = given.max_iterations.unwrap_or(SolverChoice::MAX_ITERATIONS);
    let help = "an increment that needs more iterations has not converged";
    let is_valid = (1..=1_000_000).contains(&max_iterations);
    ensure(is_valid, "solver.max_iterations", &max_iterations, "at least 1 and at most a million", help)?;
    let tolerance = given.tolerance.unwrap_or(method.increments().default_tolerance());
    let help = "the relative error that every law may have, e.g. 1e-10";
    let is_valid = tolerance > 0.0 && tolerance < 1.0;
    ensure(is_valid, "solver.tolerance", &tolerance, "above 0 and below 1", help)?;
    let linear = linear(given.linear)?;
    Ok(SolverChoice { method, linear, max_iterations, tolerance })
}

/// Returns the options of PETSc, which its solver alone takes.
pub(super) fn petsc(given: &SolverTable, solver: &SolverChoice) -> Result<String, InputError> {
    let given = given.petsc.as_deref().map(str::trim).filter(|options| !options.is_empty());
    let Some(options) = given else { return Ok(String::new()) };
    let help = "write each with a dash: petsc = \"-ksp_monitor\"";
    ensure(options.starts_with('-'), "solver.petsc", &options, "options of PETSc", help)?;
    if solver.linear == Some(LinearAlgebra::Petsc) && !options.contains('\0') {
        return Ok(options.to_string());
    }
    let help = "add solver.linear = \"petsc\", or leave the options out";
    Err(InputError::new("solver.petsc", "only solver.linear = \"petsc\" takes options of PETSc", help))
}

fn linear(given: Option<LinearAlgebra>) -> Result<Option<LinearAlgebra>, InputError> {
    let fault = |message: &str, help: &str| InputError::new("solver.linear", message, help);
    let whole = LinearAlgebra::default();
    let (missing, or) = match given {
        None if whole.is_built_in() => return Ok(None),
        None => return Err(fault("this build has no linear algebra", BUILD_IT)),
        Some(linear) if linear.is_built_in() => return Ok(Some(linear)),
        Some(LinearAlgebra::Whole(SparseLu::Umfpack)) => ("UMFPACK", ""),
        Some(LinearAlgebra::Whole(SparseLu::Mumps)) => ("MUMPS", OR_COMPILE),
        Some(LinearAlgebra::Whole(SparseLu::Faer)) => ("faer", ""),
        Some(LinearAlgebra::Multigrid | LinearAlgebra::Petsc) => ("PETSc", OR_COMPILE),
        Some(LinearAlgebra::Whole(SparseLu::Partial) | LinearAlgebra::Condensed(_)) => ("Cholesky factorisation", ""),
    };
    let other = format!("use \"{whole}\" or \"condensed\"{or}");
    Err(fault(&format!("this build has no {missing}"), if whole.is_built_in() { &other } else { BUILD_IT }))
}

fn method(solver: &SolverTable) -> Result<HistoryMethod, InputError> {
    let (method, whose, own): (HistoryMethod, _, &[_]) = match (solver.method, solver.setting.unwrap_or_default()) {
        (MethodName::Ip, Setting::Paper) => {
            let (start, partition) = (solver.start.unwrap_or(Start::Safe), solver.partition.unwrap_or_default());
            (Method::PaperIp { start, partition }.into(), "the method ip", &["start", "partition", "max_iterations"])
        }
        (MethodName::Ip, Setting::Default) => {
            let whose = "the method ip has a start and a partition in the setting paper only; here it";
            (Method::Ip.into(), whose, &["max_iterations"])
        }
        (MethodName::Bn, Setting::Paper) => {
            (Method::PaperBn.into(), "the method bn in the setting paper", &["max_iterations"])
        }
        (MethodName::Bn, Setting::Default) => {
            let r_factor = solver.r_factor.unwrap_or(1.0);
            let help = "r comes from the problem; this multiplies it, for studies of r alone";
            positive("solver.r_factor", r_factor, help)?;
            (Method::Bn { r_factor, rescue: true }.into(), "the method bn", &["r_factor", "max_iterations"])
        }
        (MethodName::Events, Setting::Paper) => {
            let help = "the exact path has no constants of the paper: leave solver.setting out";
            return Err(InputError::new("solver.setting", "the method events has no setting paper", help));
        }
        (MethodName::Events, Setting::Default) => (HistoryMethod::ExactPath, "the method events", &[]),
    };
    let keys = given!(solver; start partition r_factor max_iterations);
    only(whose, own, keys).map_err(|fault| fault.with_key("solver"))?;
    Ok(method)
}
