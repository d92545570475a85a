//! What a report says of an exact path in time.

use serde::Serialize;

use super::warnings::{Warning, WarningKind};
use crate::base::units::Quantity;
use crate::body::model::Model;
use crate::solver::events::{Jump, PathEnd};
use crate::solver::history::{HistoryOutcome, Method};

/// What became of an exact path in time.
#[derive(Debug, Clone, PartialEq, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct ExactPath {
    /// How often a contact node changed its status.
    pub events: usize,
    /// Where it went on by a jump, because that was asked for.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub jumps: Vec<Jump>,
    /// Where the quasi-static motion ended, if it did.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub lost: Option<PathEnd>,
}

/// A larger share of the displacements by which gaps may be off is told.
const OFF: f64 = 1e-6;

/// That the exact path followed gaps along chords.
pub(super) fn curved_gaps(method: Method, model: &Model, outcome: &HistoryOutcome) -> Option<Warning> {
    let Method::Events { .. } = method else { return None };
    let off = model.loading.off_the_chords();
    if off <= OFF * outcome.scales.length {
        return None;
    }
    let units = model.units();
    let message = format!(
        "gaps in front of a moving obstacle are curved in time: the exact path follows them along chords, off by up to {:.1e} {} ({:.1e} of \
         the largest displacement); four times as many increments as chords make that a sixteenth",
        units.of_si(Quantity::Length, off),
        units.name(Quantity::Length),
        off / outcome.scales.length
    );
    Some(Warning { kind: WarningKind::CurvedGaps, message })
}

/// That a run went on by jumps.
pub(super) fn jumps(jumps: &[Jump]) -> Option<Warning> {
    let first = jumps.first()?;
    let more = match jumps.len() {
        1 => String::new(),
        many => format!(" (the first of {many} jumps)"),
    };
    let message = format!(
        "no quasi-static motion leads on from t = {} s: the states from t = {} s on are one of those that the laws allow after a \
         jump{more}; dynamics says which",
        first.from, first.to
    );
    Some(Warning { kind: WarningKind::Jump, message })
}

impl ExactPath {
    pub(super) fn of(method: Method, outcome: &HistoryOutcome) -> Option<Self> {
        let Method::Events { .. } = method else { return None };
        Some(ExactPath { events: outcome.event_count, jumps: outcome.jumps.clone(), lost: outcome.lost })
    }
}
