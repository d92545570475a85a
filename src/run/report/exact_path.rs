//! The exact path in a report.

use serde::Serialize;

use super::warnings::{Warning, WarningKind};
use crate::base::units::{Quantity, six_digits};
use crate::body::model::Model;
use crate::solver::events::{Jump, PathEnd};
use crate::solver::history::HistoryOutcome;

/// The course of an exact path.
#[derive(Debug, Clone, PartialEq, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[non_exhaustive]
pub struct ExactPath {
    /// The number of changes of contact status.
    pub events: usize,
    /// The jumps with which the path was continued, as requested.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub jumps: Vec<Jump>,
    /// The end of the quasi-static motion, if it ended.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub lost: Option<PathEnd>,
}

/// The error of gaps, relative to the displacements, above which a warning is given.
const OFF: f64 = 1e-6;

/// Warns that the exact path followed curved gaps along chords.
pub(super) fn curved_gaps(model: &Model, outcome: &HistoryOutcome) -> Option<Warning> {
    let off = model.loading.off_the_chords();
    let moved = outcome.state.u.iter().fold(0.0_f64, |m, u| m.max(u.abs()));
    if off <= OFF * moved {
        return None;
    }
    let units = model.units();
    let message = format!(
        "gaps in front of a moving obstacle are curved in time, and the exact path follows them along chords, with \
         errors up to {} ({:.1e} of the largest displacement); four times as many increments as chords \
         reduce them to a sixteenth",
        units.rounded(Quantity::Length, off, 2),
        off / moved
    );
    Some(Warning { kind: WarningKind::CurvedGaps, message })
}

/// Warns that a run was continued by jumps.
pub(super) fn jumps(jumps: &[Jump]) -> Option<Warning> {
    let first = jumps.first()?;
    let more = match jumps.len() {
        1 => String::new(),
        many => format!(" (the first of {many} jumps)"),
    };
    let message = format!(
        "no quasi-static motion continues from t = {} s: the states from t = {} s on are one of several that the \
         laws allow after a jump{more}; only dynamics can decide which",
        six_digits(first.from),
        six_digits(first.to)
    );
    Some(Warning { kind: WarningKind::Jump, message })
}

impl ExactPath {
    pub(super) fn of(outcome: &HistoryOutcome) -> Self {
        ExactPath { events: outcome.event_count, jumps: outcome.jumps.clone(), lost: outcome.lost }
    }
}
