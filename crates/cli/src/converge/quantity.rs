//! Quantities whose convergence is asked for: what a run tells of how well its mesh resolves them.

use serde_json::Value;
use stickslip::run::report::{RunReport, WarningKind};

use crate::study::{KEY_RESULTS, TableQuantity};

/// Narrower zones have no peak that says anything about finer meshes.
const FINE_FOR_PEAK: usize = 5;

/// Narrower zones have no stick ratio that counts.
const FINE_FOR_STICK: usize = 9;

impl TableQuantity {
    /// Returns `true` if it is the largest contact pressure of the history.
    pub(super) fn is_peak(&self) -> bool {
        self.word() == "peak"
    }

    /// Returns the errors of a `value` by rounding to whole elements, and to whole increments: half an element at each end of
    /// the stick zone; the increment that ends at a time, or in which the joint slips.
    pub(super) fn rounding(&self, value: f64, report: &RunReport, json: &Value) -> [f64; 2] {
        let elements = report.stick_zone.as_ref().filter(|_| self.word() == "stick_ratio");
        let elements = elements.map_or(0.0, |stick| 1.0 / stick.nodes_across as f64);
        let text = self.text();
        let (parent, key) = text.rsplit_once('.').unwrap_or(("", text));
        let end = |k: usize| format!("{parent}.between[{k}]").parse::<TableQuantity>().ok()?.of(json).as_f64();
        let increments = match (key, &report.explanation.slip) {
            ("force" | "moment", Some(slip)) if parent == "slip" => Some(value * (1.0 - slip.friction_used)),
            ("time" | "slips_from" | "slips_wholly_from", _) => {
                let before = report.increments.iter().map(|one| one.time).filter(|time| *time < value);
                Some(value - before.fold(0.0, f64::max))
            }
            _ if key.starts_with("between") => end(1).zip(end(0)).map(|(by, from)| by - from),
            _ => None,
        };
        [elements, increments.map_or(0.0, f64::abs)]
    }

    /// Returns `true` if the contact has enough nodes across for the value to follow an order.
    pub(super) fn is_resolved(&self, report: &RunReport) -> bool {
        let warned = |kind| report.warnings.iter().any(|warning| warning.kind == kind);
        let is_resolved = match self.word() {
            "peak" => {
                let across = report.largest_pressure.as_ref().and_then(|largest| largest.nodes_across);
                across.is_none_or(|across| across >= FINE_FOR_PEAK)
            }
            "friction_work" => !warned(WarningKind::SLIP_ZONE_COARSE),
            "stick_ratio" => report.stick_zone.as_ref().is_some_and(|stick| stick.nodes_across >= FINE_FOR_STICK),
            _ => true,
        };
        is_resolved && !warned(WarningKind::CONTACT_UNRESOLVED)
    }
}

/// Returns the words of the key results that a report has.
pub(super) fn words_of(report: &Value) -> Vec<&'static str> {
    let words = KEY_RESULTS.iter().map(|result| result.word);
    words.filter(|word| word.parse().is_ok_and(|result: TableQuantity| !result.of(report).is_null())).collect()
}
