//! The paper's tables, computed again.

use std::time::Instant;

use serde::Serialize;

use crate::history::{self, HistorySettings, IncrementRecord, Status};
use crate::linear::{Direct, LinearError, Umfpack};
use crate::model::{Model, ModelError};
use crate::scene::{Override, Scene, SceneError};

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

/// BN's figures of one row of a table, as published.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct Case {
    /// Contact nodes n_c; the block has n_c × n_c elements, the punch always 31 contact nodes.
    pub contact_nodes: usize,
    /// Friction coefficient.
    pub mu: f64,
    /// Increments: of each of the two paths of the block, of the whole history of the punch.
    pub increments: usize,
    /// The paper's mean number of linear systems per increment.
    pub paper_nle: f64,
    /// The paper's mean number of line search steps per increment.
    pub paper_nls: f64,
}

/// One row of a table, the paper's figures and ours.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct Cell {
    /// The case.
    #[serde(flatten)]
    pub case: Case,
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

impl PaperTable {
    /// The heading.
    pub fn title(self) -> &'static str {
        match self {
            PaperTable::Punch => "Table I, punch, Algorithm BN",
            PaperTable::Block => "Table II, elastic block, Algorithm BN",
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
            [contact_nodes, mu, increments, paper_nle, paper_nls, ..] => Some(Case {
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

    /// The scene of a case.
    ///
    /// # Errors
    /// None: the scenes and the cases are sound.
    pub fn scene(self, case: &Case) -> Result<Scene, SceneError> {
        let friction = Override::value("contact.friction", case.mu);
        let increments = case.increments as i64;
        match self {
            PaperTable::Punch => {
                let text = include_str!("../data/scenes/punch.toml");
                Scene::parse("punch.toml", text, &[friction, Override::value("time.increments", increments)])
            }
            PaperTable::Block => {
                let n = case.contact_nodes as i64;
                let elements = Override::value("mesh.elements", toml_edit::Array::from_iter([n, n]));
                let text = include_str!("../data/scenes/block.toml");
                let increments = Override::value("time.increments", 2 * increments);
                Scene::parse("block.toml", text, &[elements, friction, increments])
            }
        }
    }

    /// Computes one row with the setting `paper` on the uncondensed system.
    ///
    /// # Errors
    /// When memory is short; the scenes themselves are sound.
    pub fn cell(self, case: &Case) -> Result<Cell, TableError> {
        let start = Instant::now();
        let scene = self.scene(case)?;
        let model = Model::new(&scene)?;
        let solver = &scene.solver;
        let settings =
            HistorySettings::paper_bn(&model.problem, model.scaling(), solver.max_iterations, solver.tolerance);
        let mut linear = Direct::new(Box::new(Umfpack::default()));
        let times = scene.time.all();
        let outcome = history::run(&model.problem, &model.loading, &times, &settings, &mut linear, &mut ())?;
        let mean = |count: fn(&IncrementRecord) -> usize| {
            outcome.records.iter().map(count).sum::<usize>() as f64 / outcome.records.len() as f64
        };
        Ok(Cell {
            case: *case,
            nle: mean(|record| record.iterations),
            nls: mean(|record| record.iterations + record.backtracks) - 1.0,
            status: outcome.status,
            worst_error: outcome.records.iter().map(|record| record.kkt.worst().1).fold(0.0, f64::max),
            seconds: start.elapsed().as_secs_f64(),
        })
    }
}

impl Cell {
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

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_published_tables_are_complete() {
        let (punch, block) = (PaperTable::Punch.cases(), PaperTable::Block.cases());
        assert_eq!((punch.len(), block.len()), (21, 75));
        let last = block[74];
        assert_eq!((last.contact_nodes, last.mu, last.increments), (100, 0.8, 50));
        assert_eq!((last.paper_nle, last.paper_nls), (2.7, 18.5));
        assert_eq!((punch[20].mu, punch[20].increments, punch[20].paper_nls), (0.8, 100, 23.3));
    }

    #[test]
    fn agreement_counts_rounding_as_equal() {
        let agreement = Agreement::of([0.05, -0.04, 0.2].into_iter());
        assert_eq!((agreement.equal, agreement.cells, agreement.largest), (2, 3, 0.2));
    }
}
