//! The paper's tables, computed again.

use serde::Serialize;

use crate::history::{self, HistorySettings, Status};
use crate::linear::{Direct, LinearError, Umfpack};
use crate::model::{Model, ModelError};
use crate::scene::{Override, Scene, SceneError};

const TABLE_II: &str = include_str!("../data/reference/table2_block.csv");
const BLOCK: &str = include_str!("../data/scenes/block.toml");

/// Half a unit of the last digit that the paper prints: a difference up to this is rounding.
pub const ROUNDING: f64 = 0.05;

/// BN's figures of one row of Table II.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct BlockCase {
    /// Contact nodes n_c; the block has n_c × n_c elements.
    pub contact_nodes: usize,
    /// Friction coefficient.
    pub mu: f64,
    /// Increments of each of the two paths.
    pub increments: usize,
    /// The paper's mean number of linear systems per increment.
    pub paper_nle: f64,
    /// The paper's mean number of line search steps per increment.
    pub paper_nls: f64,
}

/// One row of Table II, the paper's figures and ours.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct BlockCell {
    /// The case.
    #[serde(flatten)]
    pub case: BlockCase,
    /// Linear systems per increment here.
    pub nle: f64,
    /// Line search steps per increment here: `Σ (m_k + 1) - 1`.
    pub nls: f64,
    /// The verdict of the whole history.
    pub status: Status,
    /// The largest component of the error measure in any increment.
    pub worst_error: f64,
    /// Wall seconds.
    pub seconds: f64,
}

/// Why a cell could not be computed.
#[derive(Debug, thiserror::Error)]
pub enum TableError {
    /// The scene could not be built.
    #[error(transparent)]
    Model(#[from] ModelError),
    /// The linear algebra failed.
    #[error(transparent)]
    Linear(#[from] LinearError),
}

impl From<SceneError> for TableError {
    fn from(error: SceneError) -> Self {
        TableError::Model(error.into())
    }
}

impl BlockCell {
    /// Here minus paper.
    pub fn nle_difference(&self) -> f64 {
        self.nle - self.case.paper_nle
    }

    /// Here minus paper.
    pub fn nls_difference(&self) -> f64 {
        self.nls - self.case.paper_nls
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
    /// All cells.
    pub cells: usize,
}

impl Agreement {
    /// Summarises differences.
    pub fn of(differences: impl ExactSizeIterator<Item = f64> + Clone) -> Self {
        let cells = differences.len();
        let sizes = differences.map(f64::abs);
        Agreement {
            mean: sizes.clone().sum::<f64>() / cells.max(1) as f64,
            largest: sizes.clone().fold(0.0, f64::max),
            // The slack absorbs that neither 0.05 nor the printed figures are binary numbers.
            equal: sizes.filter(|&size| size <= ROUNDING + 1e-9).count(),
            cells,
        }
    }
}

/// BN's part of Table II as published.
pub fn block_cases() -> Vec<BlockCase> {
    let rows = TABLE_II.lines().skip(1).map(|line| line.split(',').map(str::parse).collect::<Result<Vec<f64>, _>>());
    rows.filter_map(|row| match row.ok()?[..] {
        [contact_nodes, mu, increments, paper_nle, paper_nls, ..] => Some(BlockCase {
            contact_nodes: contact_nodes as usize,
            mu,
            increments: increments as usize,
            paper_nle,
            paper_nls,
        }),
        _ => None,
    })
    .collect()
}

/// Computes one row of Table II with the setting `paper` on the uncondensed system.
///
/// # Errors
/// When memory is short; the scene itself is sound.
pub fn block_cell(case: &BlockCase) -> Result<BlockCell, TableError> {
    let BlockCase { contact_nodes: n, mu, increments, .. } = *case;
    let start = std::time::Instant::now();
    let overrides = [
        Override::value("mesh.elements", toml_edit::Array::from_iter([n as i64, n as i64])),
        Override::value("contact.friction", mu),
        Override::value("time.increments", 2 * increments as i64),
    ];
    let scene = Scene::parse("block.toml", BLOCK, &overrides)?;
    let model = Model::new(&scene)?;
    let solver = &scene.solver;
    let settings = HistorySettings::paper(&model.problem, model.scaling(), solver.max_iterations, solver.tolerance);
    let mut linear = Direct::new(Box::new(Umfpack::default()));
    let outcome = history::run(&model.problem, &model.loading, &scene.time.all(), &settings, &mut linear, &mut ())?;
    let mean = |count: &dyn Fn(&history::IncrementRecord) -> usize| {
        outcome.records.iter().map(count).sum::<usize>() as f64 / outcome.records.len() as f64
    };
    Ok(BlockCell {
        case: *case,
        nle: mean(&|record| record.iterations),
        nls: mean(&|record| record.iterations + record.backtracks) - 1.0,
        status: outcome.status,
        worst_error: outcome.records.iter().map(|record| record.kkt.worst().1).fold(0.0, f64::max),
        seconds: start.elapsed().as_secs_f64(),
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_published_table_is_complete() {
        let cases = block_cases();
        assert_eq!(cases.len(), 75);
        let last = cases[74];
        assert_eq!((last.contact_nodes, last.mu, last.increments), (100, 0.8, 50));
        assert_eq!((last.paper_nle, last.paper_nls), (2.7, 18.5));
    }

    #[test]
    fn agreement_counts_rounding_as_equal() {
        let agreement = Agreement::of([0.05, -0.04, 0.2].into_iter());
        assert_eq!((agreement.equal, agreement.cells, agreement.largest), (2, 3, 0.2));
    }
}
