//! A suite of scenes at the limits of stiffness, shape, friction, load and discretisation, and what
//! each method makes of them. The table of the scenes is `studies/data/extremes.toml`.

mod picture;
mod vary;

pub use picture::charts;

use clap::ValueEnum;
use serde::{Deserialize, Serialize};
use std::time::Instant;
use stickslip::algebra::linear::LinearError;
use stickslip::body::{Model, ModelError};
use stickslip::run::{Run, RunError, discretise};
use stickslip::scene::{Override, OverrideSyntax, Scene, SceneError};
use stickslip::solver::KktErrors;
use stickslip::solver::history::{self, HistoryOutcome, LinearAlgebra, Method, SolverChoice, Status};
use vary::Vary;

/// How the suite solves a scene.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Serialize, Deserialize, ValueEnum)]
#[serde(rename_all = "kebab-case")]
pub enum SuiteMethod {
    /// BN, setting `paper`.
    BnPaper,
    /// BN, setting `default`.
    Bn,
    /// IP, setting `default`.
    Ip,
}

/// What is known of a scene.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Expect {
    /// There is an equilibrium in every increment.
    #[default]
    Solved,
    /// There is none in some increment.
    None,
    /// Nobody knows.
    Unknown,
}

/// What a sweep is drawn against.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Deserialize)]
#[serde(rename_all = "kebab-case")]
enum SweepAxis {
    Value,
    ToHalf,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct Table {
    sweep: Vec<Sweep>,
}

/// A line of the table: one quantity through its values.
#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct Sweep {
    name: String,
    scene: Option<String>,
    #[serde(default)]
    set: Vec<String>,
    values: Vec<toml::Value>,
    vary: Option<Vary>,
    #[serde(default = "one")]
    samples: u64,
    #[serde(default)]
    expect: Expect,
    axis: Option<SweepAxis>,
    only: Option<Vec<SuiteMethod>>,
    #[serde(default)]
    long: bool,
}

fn one() -> u64 {
    1
}

/// A scene of the suite.
#[derive(Debug, Clone)]
pub struct Case {
    /// The name of its sweep.
    pub sweep: String,
    /// The value of the quantity that is swept, and the sample.
    pub value: String,
    /// Where it is drawn, if it is.
    pub x: Option<f64>,
    /// What is known of it.
    pub expect: Expect,
    /// Whether it takes long.
    pub long: bool,
    /// The methods it makes sense for.
    pub methods: Vec<SuiteMethod>,
    scene: String,
    overrides: Vec<String>,
    vary: Option<(Vary, f64)>,
    seed: u64,
}

/// What a method makes of a scene.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Row {
    /// The name of the sweep.
    pub sweep: String,
    /// The value of the quantity that is swept, and the sample.
    pub value: String,
    /// The method.
    pub method: SuiteMethod,
    /// What is known of the scene.
    pub expect: Expect,
    /// The verdict.
    pub verdict: Status,
    /// The increments that converged, of all.
    pub converged: [usize; 2],
    /// Linear systems an increment, on average.
    pub iterations: f64,
    /// Increments that were halved.
    pub halved: usize,
    /// Increments that BN left to the interior point method.
    pub rescued: usize,
    /// The largest errors over all increments.
    pub errors: KktErrors,
    /// The equilibrium error that rounding the displacements makes at the end.
    pub rounding: f64,
    /// The largest backward error of any solve.
    pub backward_error: f64,
    /// An estimate of the condition number of the stiffness of the body with its contact nodes held.
    pub condition: f64,
    /// Wall seconds.
    pub seconds: f64,
    /// Where the sweep is drawn, if it is.
    #[serde(skip)]
    pub x: Option<f64>,
}

/// Why a scene of the suite could not be run.
#[derive(Debug, thiserror::Error, miette::Diagnostic)]
pub enum ExtremeError {
    /// The table cannot be read.
    #[error("studies/data/extremes.toml: {0}")]
    Table(#[from] toml::de::Error),
    /// The table names a scene that there is not.
    #[error("studies/data/extremes.toml: there is no scene `{0}`")]
    NoScene(String),
    /// An override of the table is no override.
    #[error("studies/data/extremes.toml: {0}")]
    Override(#[from] OverrideSyntax),
    /// The scene could not be built, or the linear algebra failed.
    #[error(transparent)]
    #[diagnostic(transparent)]
    Run(#[from] RunError),
}

impl From<ModelError> for ExtremeError {
    fn from(error: ModelError) -> Self {
        ExtremeError::Run(error.into())
    }
}

impl From<LinearError> for ExtremeError {
    fn from(error: LinearError) -> Self {
        ExtremeError::Run(error.into())
    }
}

impl From<SceneError> for ExtremeError {
    fn from(error: SceneError) -> Self {
        ExtremeError::Run(error.into())
    }
}

impl SuiteMethod {
    /// All of them.
    pub const ALL: [SuiteMethod; 3] = [SuiteMethod::BnPaper, SuiteMethod::Bn, SuiteMethod::Ip];

    /// Its name in reports.
    pub fn title(self) -> &'static str {
        match self {
            SuiteMethod::BnPaper => "BN paper",
            SuiteMethod::Bn => "BN",
            SuiteMethod::Ip => "IP",
        }
    }
}

/// More than any increment of the suite takes that is solved at all.
const MAX_ITERATIONS: usize = 200;

/// The scenes of the suite.
///
/// # Errors
/// When the table is not sound.
pub fn cases() -> Result<Vec<Case>, ExtremeError> {
    let table: Table = toml::from_str(include_str!("../data/extremes.toml"))?;
    Ok(table.sweep.iter().flat_map(Sweep::cases).collect())
}

impl Sweep {
    fn cases(&self) -> Vec<Case> {
        let case = |value: &toml::Value, sample: u64| {
            let number = value.as_float().or(value.as_integer().map(|integer| integer as f64));
            let written = number.map_or_else(|| value.to_string(), |number| format!("{number:e}"));
            // Whole numbers have to stay whole in the scene.
            let text = if value.is_integer() { value.to_string() } else { written.clone() };
            Case {
                sweep: self.name.clone(),
                value: if self.samples > 1 { format!("{written} #{sample}") } else { written },
                x: self.axis.and_then(|axis| match axis {
                    SweepAxis::Value => number,
                    SweepAxis::ToHalf => number.map(|number| 0.5 - number),
                }),
                expect: self.expect,
                long: self.long,
                methods: self.only.clone().unwrap_or_else(|| SuiteMethod::ALL.to_vec()),
                scene: self.scene.clone().unwrap_or_else(|| "block".into()),
                overrides: self.set.iter().map(|set| set.replace("{}", &text)).collect(),
                vary: self.vary.zip(number),
                seed: sample,
            }
        };
        let samples = self.values.iter().flat_map(|value| (1..=self.samples).map(move |sample| (value, sample)));
        samples.map(|(value, sample)| case(value, sample)).collect()
    }
}

impl Case {
    /// The scene, for the default setting of BN unless the case says otherwise.
    ///
    /// # Errors
    /// When the table is not sound.
    pub fn scene(&self) -> Result<Scene, ExtremeError> {
        let text = match self.scene.as_str() {
            "block" => include_str!("../../data/scenes/block.toml"),
            "boxed" => include_str!("../../data/scenes/boxed.toml"),
            "confined" => include_str!("../../data/scenes/confined.toml"),
            "cycles" => include_str!("../../data/scenes/cycles.toml"),
            "held_by_contact" => include_str!("../../data/scenes/held_by_contact.toml"),
            "punch" => include_str!("../../data/scenes/punch.toml"),
            "turning_load" => include_str!("../../data/scenes/turning_load.toml"),
            other => return Err(ExtremeError::NoScene(other.to_string())),
        };
        let small: &[&str] = if self.scene == "block" { &["mesh.elements=[20,20]", "time.increments=10"] } else { &[] };
        let all = small.iter().copied().chain(["solver.setting=default"]);
        let overrides = all.chain(self.overrides.iter().map(String::as_str)).map(str::parse::<Override>);
        Ok(Scene::parse(&self.scene, text, &overrides.collect::<Result<Vec<_>, _>>()?)?)
    }

    /// The discretised scene, with what varies from element to element or node to node.
    ///
    /// # Errors
    /// When the table is not sound.
    pub fn model(&self, scene: &Scene) -> Result<Model, ExtremeError> {
        let mut model = discretise(scene)?;
        if let Some((vary, by)) = self.vary {
            vary.apply(scene, &mut model, by, self.seed)?;
        }
        Ok(model)
    }

    /// What solves it by `method`: the whole system, whatever the scene says.
    pub fn solver(&self, scene: &Scene, method: SuiteMethod) -> SolverChoice {
        let method = match (method, scene.solver.method.increments()) {
            (SuiteMethod::BnPaper, _) => Method::PaperBn,
            (SuiteMethod::Ip, _) => Method::Ip,
            (SuiteMethod::Bn, Method::Bn { r_factor, .. }) => Method::Bn { r_factor, rescue: true },
            (SuiteMethod::Bn, _) => Method::BN,
        };
        SolverChoice { max_iterations: MAX_ITERATIONS, tolerance: TOLERANCE, ..SolverChoice::new(method) }
    }

    /// Runs it.
    ///
    /// # Errors
    /// When the table is not sound, or memory is short before the first increment.
    pub fn run(&self, method: SuiteMethod, linear: LinearAlgebra) -> Result<Row, ExtremeError> {
        let start = Instant::now();
        let scene = self.scene()?;
        let model = self.model(&scene)?;
        let times = scene.time.all();
        let solver = SolverChoice { linear: Some(linear), ..self.solver(&scene, method) };
        let outcome = Run::of(&model, times.clone(), solver)?.history(&mut ())?;
        let seconds = start.elapsed().as_secs_f64();
        let condition = vary::condition(&model)?;
        Ok(self.row(method, &outcome, times.len(), condition, seconds))
    }

    fn row(&self, method: SuiteMethod, outcome: &HistoryOutcome, all: usize, condition: f64, seconds: f64) -> Row {
        let records = &outcome.records;
        let count = |which: &dyn Fn(&history::IncrementRecord) -> bool| records.iter().filter(|r| which(r)).count();
        Row {
            sweep: self.sweep.clone(),
            value: self.value.clone(),
            method,
            expect: self.expect,
            verdict: outcome.status,
            converged: [count(&|record| record.status == Status::Converged), all],
            iterations: records.iter().map(|record| record.iterations).sum::<usize>() as f64
                / records.len().max(1) as f64,
            halved: count(&|record| record.parts > 1),
            rescued: count(&|record| record.rescued),
            errors: records.iter().fold(KktErrors::default(), |errors, record| errors.max(&record.kkt)),
            rounding: outcome.rounding,
            backward_error: outcome.linear.worst_backward_error,
            condition,
            seconds,
            x: self.x,
        }
    }
}

/// The error that every law may have.
const TOLERANCE: f64 = 1e-10;

impl Row {
    /// Returns `true` if the verdict is the right one; `None` if that is unknown.
    pub fn right(&self) -> Option<bool> {
        match self.expect {
            Expect::Solved => Some(self.verdict == Status::Converged),
            Expect::None => Some(matches!(self.verdict, Status::NoEquilibrium | Status::Slips)),
            Expect::Unknown => None,
        }
    }
}
