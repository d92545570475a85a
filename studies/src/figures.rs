//! The paper's Figures 4 to 7, computed again: the histories behind them. [`FigureData`] turns them
//! into pictures and tables.

mod picture;

use crate::tables::{PaperError, PaperMethod, PaperTable};
use std::ops::ControlFlow;
use stickslip::body::Model;
use stickslip::run::discretise;
use stickslip::run::report::ContactLine;
use stickslip::solver::IterationRecord;
use stickslip::solver::history::{HistoryOutcome, IncrementRecord, IncrementView, Observer, Status};

/// The friction coefficient of all figures.
pub const MU: f64 = 0.4;

/// A figure of the paper.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum PaperFigure {
    /// Figure 4: contact stresses of the punch for several numbers of increments.
    PunchStresses,
    /// Figure 5: `Theta` over the iterations, punch.
    PunchTheta,
    /// Figure 6: contact stresses of the block at the ends of both paths.
    BlockStresses,
    /// Figure 7: iterations of every increment of the block.
    BlockIterations,
}

/// Contact stresses at the end of an increment.
#[derive(Debug, Clone, PartialEq)]
pub struct Stresses {
    /// Increments: of each of the two paths of the block, of the whole history of the punch.
    pub increments: usize,
    /// The verdict of the history.
    pub status: Status,
    /// The contact nodes.
    pub line: ContactLine,
}

/// The iterations of an increment.
#[derive(Debug, Clone, PartialEq)]
pub struct Descent {
    /// The method.
    pub method: PaperMethod,
    /// The verdict of the history.
    pub status: Status,
    /// Its iterations, the start before them.
    pub iterations: Vec<IterationRecord>,
}

/// The increments of a history.
#[derive(Debug, Clone, PartialEq)]
pub struct Effort {
    /// The method.
    pub method: PaperMethod,
    /// The verdict of the history.
    pub status: Status,
    /// Its increments.
    pub increments: Vec<IncrementRecord>,
}

/// What a figure shows.
#[derive(Debug, Clone, PartialEq)]
pub enum FigureData {
    /// Figure 4: one entry for each number of increments.
    PunchStresses(Vec<Stresses>),
    /// Figure 5: the only increment, one entry for each method.
    PunchTheta(Vec<Descent>),
    /// Figure 6: the end of each path.
    BlockStresses(Vec<Stresses>),
    /// Figure 7: one entry for each method.
    BlockIterations(Vec<Effort>),
}

impl PaperFigure {
    /// All of them, in order.
    pub const ALL: [PaperFigure; 4] =
        [PaperFigure::PunchStresses, PaperFigure::PunchTheta, PaperFigure::BlockStresses, PaperFigure::BlockIterations];

    /// Its number in the paper.
    pub fn number(self) -> u8 {
        match self {
            PaperFigure::PunchStresses => 4,
            PaperFigure::PunchTheta => 5,
            PaperFigure::BlockStresses => 6,
            PaperFigure::BlockIterations => 7,
        }
    }

    /// How many increments have to be solved for it.
    pub fn increments(self) -> usize {
        match self {
            PaperFigure::PunchStresses => 1 + 5 + 20 + 100,
            PaperFigure::PunchTheta => 3,
            PaperFigure::BlockStresses => 2 * 50,
            PaperFigure::BlockIterations => 3 * 2 * 20,
        }
    }

    /// Computes it for the case of the paper; `progress` is called after every increment.
    ///
    /// # Errors
    /// When memory is short; the scenes themselves are sound.
    pub fn compute(self, progress: &mut dyn FnMut()) -> Result<FigureData, PaperError> {
        Ok(match self {
            PaperFigure::PunchStresses => FigureData::PunchStresses(punch_stresses(&[1, 5, 20, 100], progress)?),
            PaperFigure::PunchTheta => FigureData::PunchTheta(punch_theta(progress)?),
            PaperFigure::BlockStresses => FigureData::BlockStresses(block_stresses(50, 50, progress)?),
            PaperFigure::BlockIterations => FigureData::BlockIterations(block_iterations(50, 20, progress)?),
        })
    }
}

/// The final contact stresses of the punch, BN, for each of several numbers of increments.
///
/// # Errors
/// As [`PaperFigure::compute`].
pub fn punch_stresses(increments: &[usize], progress: &mut dyn FnMut()) -> Result<Vec<Stresses>, PaperError> {
    let mut stresses = Vec::new();
    for &increments in increments {
        let run = run(PaperTable::Punch, 0, increments, PaperMethod::Bn, &[increments], progress)?;
        stresses.extend(run.stresses(increments));
    }
    Ok(stresses)
}

/// The iterations of the punch in one increment, where all starts of IP are its first.
///
/// # Errors
/// As [`PaperFigure::compute`].
pub fn punch_theta(progress: &mut dyn FnMut()) -> Result<Vec<Descent>, PaperError> {
    let descent = |method| {
        let Run { outcome, iterations, .. } = run(PaperTable::Punch, 0, 1, method, &[], progress)?;
        Ok(Descent { method, status: outcome.status, iterations })
    };
    [PaperMethod::Bn, PaperMethod::IpSafe, PaperMethod::Ip].into_iter().map(descent).collect()
}

/// The contact stresses of the block with `n` × `n` elements, BN, at the ends of its two paths of
/// `increments` each.
///
/// # Errors
/// As [`PaperFigure::compute`].
pub fn block_stresses(n: usize, increments: usize, progress: &mut dyn FnMut()) -> Result<Vec<Stresses>, PaperError> {
    let run = run(PaperTable::Block, n, increments, PaperMethod::Bn, &[increments, 2 * increments], progress)?;
    Ok(run.stresses(increments))
}

/// The increments of the block with `n` × `n` elements and two paths of `increments` each.
///
/// # Errors
/// As [`PaperFigure::compute`].
pub fn block_iterations(n: usize, increments: usize, progress: &mut dyn FnMut()) -> Result<Vec<Effort>, PaperError> {
    let effort = |method| {
        let outcome = run(PaperTable::Block, n, increments, method, &[], progress)?.outcome;
        Ok(Effort { method, status: outcome.status, increments: outcome.records })
    };
    [PaperMethod::Bn, PaperMethod::IpSafe, PaperMethod::IpPrev].into_iter().map(effort).collect()
}

/// A history and what was kept of it.
struct Run {
    outcome: HistoryOutcome,
    lines: Vec<ContactLine>,
    /// Those of the last increment.
    iterations: Vec<IterationRecord>,
}

impl Run {
    fn stresses(self, increments: usize) -> Vec<Stresses> {
        let status = self.outcome.status;
        self.lines.into_iter().map(|line| Stresses { increments, status, line }).collect()
    }
}

/// Runs a problem and keeps the contact lines of the increments `wanted`.
fn run(
    table: PaperTable,
    contact_nodes: usize,
    increments: usize,
    method: PaperMethod,
    wanted: &[usize],
    progress: &mut dyn FnMut(),
) -> Result<Run, PaperError> {
    let scene = table.scene(contact_nodes, MU, increments)?;
    let model = discretise(&scene)?;
    let solver = table.solver(method, scene.solver.linear.unwrap_or_default());
    let mut keep = Keep { model: &model, wanted, progress, lines: Vec::new(), iterations: Vec::new() };
    let times = scene.time.all();
    let outcome = stickslip::run::Run::of(&model, times, solver)?.history(&mut keep)?;
    let Keep { lines, iterations, .. } = keep;
    Ok(Run { outcome, lines, iterations })
}

struct Keep<'a> {
    model: &'a Model,
    wanted: &'a [usize],
    progress: &'a mut dyn FnMut(),
    lines: Vec<ContactLine>,
    iterations: Vec<IterationRecord>,
}

impl Observer for Keep<'_> {
    fn iteration(&mut self, _index: usize, record: &IterationRecord) -> ControlFlow<()> {
        if record.iteration == 0 {
            self.iterations.clear();
        }
        self.iterations.push(*record);
        ControlFlow::Continue(())
    }

    fn increment(&mut self, step: &IncrementView<'_>) -> ControlFlow<()> {
        (self.progress)();
        // What a failed increment reached is worth a look, too.
        if self.wanted.contains(&step.record.index) || step.record.status != Status::Converged {
            self.lines.extend(ContactLine::all(self.model, step));
        }
        ControlFlow::Continue(())
    }
}
