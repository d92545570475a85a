//! The exact path in a report.

use serde::Serialize;

use crate::solver::events::PathEnd;
use crate::solver::history::HistoryOutcome;

/// The course of an exact path.
#[derive(Debug, Clone, PartialEq, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[non_exhaustive]
pub struct ExactPath {
    /// The number of changes of contact status.
    pub events: usize,
    /// The end of the quasi-static motion, if it ended.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub lost: Option<PathEnd>,
}

impl ExactPath {
    pub(in crate::run) fn of(outcome: &HistoryOutcome) -> Self {
        ExactPath { events: outcome.event_count, lost: outcome.lost }
    }
}
