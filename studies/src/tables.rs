//! The paper's tables, computed again: mean counts of linear systems and line searches per increment.

use clap::ValueEnum;
use serde::Serialize;
use std::time::Instant;
use stickslip::body::ModelError;
use stickslip::run::{RunError, discretise};
use stickslip::scene::{Override, Scene, SceneError};
use stickslip::solver::history::{
    HistorySettings, IncrementRecord, LinearAlgebra, Method, SolverChoice, Start, Status,
};

/// Half a unit of the last digit that the paper prints: a difference up to this is rounding.
pub const ROUNDING: f64 = 0.05;

/// A table of the paper.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
#[serde(rename_all = "lowercase")]
pub enum PaperTable {
    /// Table I: the punch.
    Punch,
    /// Table II: the elastic block.
    Block,
}

/// A method whose figures a table has, or that is worth having beside them.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Serialize, ValueEnum)]
#[serde(rename_all = "kebab-case")]
pub enum PaperMethod {
    /// Algorithm BN.
    Bn,
    /// Algorithm IP from the safe point.
    IpSafe,
    /// Algorithm IP from the last solution.
    IpPrev,
    /// The default interior point method, which the paper does not have.
    Ip,
    /// The default setting of BN, which the paper does not have.
    BnDefault,
}

/// Means over the increments of a history.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct Counts {
    /// Linear systems per increment.
    pub nle: f64,
    /// Line search steps per increment: BN's are `Σ (m_k + 1) - 1`, IP's `Σ m_k`. The paper gives
    /// none for IP from the safe point, because all are 0.
    pub nls: Option<f64>,
}

/// One row of a table as published.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct Case {
    /// Contact nodes n_c; the block has n_c × n_c elements, the punch always 31 contact nodes.
    pub contact_nodes: usize,
    /// Friction coefficient.
    pub mu: f64,
    /// Increments: of each of the two paths of the block, of the whole history of the punch.
    pub increments: usize,
    /// Algorithm BN.
    #[serde(skip)]
    pub bn: Counts,
    /// Algorithm IP from the safe point.
    #[serde(skip)]
    pub ip_safe: Counts,
    /// Algorithm IP from the last solution.
    #[serde(skip)]
    pub ip_prev: Counts,
}

/// What one method does in one case.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct Cell {
    /// The case.
    #[serde(flatten)]
    pub case: Case,
    /// The method.
    pub method: PaperMethod,
    /// The paper's figures, if it has any.
    pub paper: Option<Counts>,
    /// The figures here.
    pub here: Counts,
    /// The verdict of the whole history. If it is not converged, `here` counts what was done until
    /// the failure and says nothing about the table.
    pub status: Status,
    /// The increments that converged, of all.
    pub converged: [usize; 2],
    /// The largest component of the error measure in any increment.
    pub worst_error: f64,
    /// Wall seconds.
    pub seconds: f64,
}

/// Why a cell or a figure could not be computed.
#[derive(Debug, thiserror::Error, miette::Diagnostic)]
pub enum PaperError {
    /// The scene could not be built, or the linear algebra failed.
    #[error(transparent)]
    #[diagnostic(transparent)]
    Run(#[from] RunError),
}

impl From<ModelError> for PaperError {
    fn from(error: ModelError) -> Self {
        PaperError::Run(error.into())
    }
}

impl From<SceneError> for PaperError {
    fn from(error: SceneError) -> Self {
        PaperError::Run(error.into())
    }
}

/// Removes the limits after which the method restarts from the safe point.
fn patient(start: Start) -> Start {
    match start {
        Start::Prev { shortest_step, far, .. } => Start::Prev { shortest_step, far, patience: usize::MAX },
        Start::Safe => Start::Safe,
    }
}

impl PaperTable {
    /// The heading.
    pub fn title(self) -> &'static str {
        match self {
            PaperTable::Punch => "Table I, punch",
            PaperTable::Block => "Table II, elastic block",
        }
    }

    /// All rows as published.
    pub fn cases(self) -> Vec<Case> {
        let csv = match self {
            PaperTable::Punch => include_str!("../data/reference/table1_punch.csv"),
            PaperTable::Block => include_str!("../data/reference/table2_block.csv"),
        };
        let rows = csv.lines().skip(1).map(|line| line.split(',').map(str::parse).collect::<Result<Vec<f64>, _>>());
        let rows = rows.filter_map(|row| {
            let mut row = row.ok()?;
            if self == PaperTable::Punch {
                row.insert(0, 31.0);
            }
            Some(row)
        });
        rows.filter_map(|row| match row[..] {
            [contact_nodes, mu, increments, bn_nle, bn_nls, safe_nle, prev_nle, prev_nls] => Some(Case {
                contact_nodes: contact_nodes as usize,
                mu,
                increments: increments as usize,
                bn: Counts { nle: bn_nle, nls: Some(bn_nls) },
                ip_safe: Counts { nle: safe_nle, nls: None },
                ip_prev: Counts { nle: prev_nle, nls: Some(prev_nls) },
            }),
            _ => None,
        })
        .collect()
    }

    /// The scene with so many contact nodes (of the block; the punch has its own), friction
    /// coefficient and increments (of each path of the block).
    ///
    /// # Errors
    /// None for the numbers of the paper.
    pub fn scene(self, contact_nodes: usize, mu: f64, increments: usize) -> Result<Scene, SceneError> {
        let friction = Override::value("contact.friction", mu);
        let increments = increments as i64;
        match self {
            PaperTable::Punch => {
                let text = include_str!("../../data/scenes/punch.toml");
                Scene::parse("punch.toml", text, &[friction, Override::value("time.increments", increments)])
            }
            PaperTable::Block => {
                let n = contact_nodes as i64;
                let elements = Override::value("mesh.elements", toml_edit::Array::from_iter([n, n]));
                let text = include_str!("../../data/scenes/block.toml");
                let increments = Override::value("time.increments", 2 * increments);
                Scene::parse("block.toml", text, &[elements, friction, increments])
            }
        }
    }

    /// Computes one cell; the linear algebra changes its time and its rounding, nothing else.
    ///
    /// # Errors
    /// When memory is short; the scenes themselves are sound.
    pub fn cell(self, case: &Case, method: PaperMethod, linear: LinearAlgebra) -> Result<Cell, PaperError> {
        let start = Instant::now();
        let scene = self.scene(case.contact_nodes, case.mu, case.increments)?;
        let model = discretise(&scene)?;
        let times = scene.time.all();
        let (solver, problem, loading) = (self.solver(method, linear), &model.problem, &model.loading);
        // The tables count the iterations of whole increments.
        let settings = HistorySettings { halvings: 0, ..solver.settings(problem, loading).map_err(RunError::from)? };
        let outcome = solver.solve(problem, loading, &times, &settings, linear.into(), &mut ());
        let outcome = outcome.map_err(RunError::from)?;
        let mean = |count: fn(&IncrementRecord) -> usize| {
            outcome.records.iter().map(count).sum::<usize>() as f64 / outcome.records.len() as f64
        };
        let nls = match method {
            PaperMethod::Bn | PaperMethod::BnDefault => mean(|record| record.iterations + record.backtracks) - 1.0,
            _ => mean(|record| record.backtracks),
        };
        let converged = outcome.records.iter().filter(|record| record.status == Status::Converged).count();
        Ok(Cell {
            case: *case,
            method,
            paper: case.paper(method),
            here: Counts { nle: mean(|record| record.iterations), nls: Some(nls) },
            status: outcome.status,
            converged: [converged, times.len()],
            worst_error: outcome.records.iter().map(|record| record.kkt.worst().1).fold(0.0, f64::max),
            seconds: start.elapsed().as_secs_f64(),
        })
    }

    /// What solves a cell by `method`.
    pub fn solver(self, method: PaperMethod, linear: LinearAlgebra) -> SolverChoice {
        let method = match method {
            PaperMethod::BnDefault => Method::BN,
            PaperMethod::Bn => Method::PaperBn,
            PaperMethod::IpSafe => Method::paper_ip(Start::Safe),
            PaperMethod::IpPrev if self == PaperTable::Block => Method::paper_ip(Start::PREV),
            // The paper restarts nothing here, and lets σ fall by (36); with that the iteration
            // stalls in the second increment or soon after. With the block's rule it gets through in most cells.
            PaperMethod::IpPrev => Method::paper_ip(patient(Start::PREV)),
            PaperMethod::Ip => Method::Ip,
        };
        SolverChoice { linear: Some(linear), max_iterations: MAX_ITERATIONS, ..SolverChoice::new(method) }
    }
}

/// More than the paper's longest increments, of "over 200 iterations".
const MAX_ITERATIONS: usize = 300;

impl Case {
    /// The published figures of `method`.
    pub fn paper(&self, method: PaperMethod) -> Option<Counts> {
        match method {
            PaperMethod::Bn => Some(self.bn),
            PaperMethod::IpSafe => Some(self.ip_safe),
            PaperMethod::IpPrev => Some(self.ip_prev),
            PaperMethod::Ip | PaperMethod::BnDefault => None,
        }
    }
}

impl PaperMethod {
    /// All of them, in the order of the columns.
    pub const ALL: [PaperMethod; 5] =
        [PaperMethod::Bn, PaperMethod::IpSafe, PaperMethod::IpPrev, PaperMethod::BnDefault, PaperMethod::Ip];

    /// The heading of its columns.
    pub fn title(self) -> &'static str {
        match self {
            PaperMethod::Bn => "BN",
            PaperMethod::IpSafe => "IP safe",
            PaperMethod::IpPrev => "IP prev",
            PaperMethod::Ip => "IP default",
            PaperMethod::BnDefault => "BN default",
        }
    }
}

impl Cell {
    /// Here minus paper; `None` where there is nothing to compare.
    pub fn nle_difference(&self) -> Option<f64> {
        let comparable = self.status == Status::Converged;
        comparable.then_some(self.here.nle - self.paper?.nle)
    }

    /// Here minus paper; `None` where there is nothing to compare.
    pub fn nls_difference(&self) -> Option<f64> {
        let comparable = self.status == Status::Converged;
        comparable.then_some(self.here.nls? - self.paper?.nls?)
    }
}

/// How far a column is from the paper's.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct Agreement {
    /// Mean absolute difference.
    pub mean: f64,
    /// Largest absolute difference.
    pub largest: f64,
    /// Cells equal to within [`ROUNDING`].
    pub equal: usize,
    /// Cells that are compared.
    pub cells: usize,
    /// Cells whose history did not converge here.
    pub failed: usize,
}

impl Agreement {
    /// Summarises differences; `None` stands for a cell that failed.
    pub fn of(differences: impl Iterator<Item = Option<f64>>) -> Self {
        let (mut agreement, mut sum) = (Agreement { mean: 0.0, largest: 0.0, equal: 0, cells: 0, failed: 0 }, 0.0);
        for difference in differences {
            let Some(size) = difference.map(f64::abs) else {
                agreement.failed += 1;
                continue;
            };
            sum += size;
            agreement.largest = agreement.largest.max(size);
            agreement.cells += 1;
            // The slack absorbs that neither 0.05 nor the printed figures are binary numbers.
            agreement.equal += usize::from(size <= ROUNDING + 1e-9);
        }
        agreement.mean = sum / agreement.cells.max(1) as f64;
        agreement
    }
}
