//! Quantities whose convergence is asked for: what a run tells of how well its mesh resolves them.

use serde_json::Value;
use stickslip::run::report::{RunReport, WarningKind};

use crate::study::{KEY_RESULTS, TableQuantity};

/// Narrower zones have no peak that says anything about finer meshes.
const FINE_FOR_PEAK: usize = 5;

/// The stick ratio does not count if the mesh alone makes a larger uncertainty, as in zones of fewer than nine nodes.
const FINE_FOR_STICK: f64 = 1.0 / (3.0 * 9.0);

impl TableQuantity {
    /// Returns `true` if it is the largest contact pressure of the history.
    pub(super) fn is_peak(&self) -> bool {
        self.word() == "peak"
    }

    /// Returns the error of the value by rounding to whole elements: half an element at each end of the stick zone, three
    /// times the typical error.
    pub(super) fn rounding(&self, report: &RunReport) -> f64 {
        let is_stick = self.word() == "stick_ratio";
        report.stick_zone.as_ref().filter(|_| is_stick).map_or(0.0, |stick| 3.0 * stick.uncertainty)
    }

    /// Returns `true` if the contact has enough nodes across for the value to follow an order.
    pub(super) fn is_resolved(&self, report: &RunReport) -> bool {
        match self.word() {
            "peak" => {
                let across = report.largest_pressure.as_ref().and_then(|largest| largest.nodes_across);
                across.is_none_or(|across| across >= FINE_FOR_PEAK)
            }
            "friction_work" => !report.warnings.iter().any(|warning| warning.kind == WarningKind::SLIP_ZONE_COARSE),
            "stick_ratio" => report.stick_zone.as_ref().is_some_and(|stick| stick.uncertainty <= FINE_FOR_STICK),
            _ => true,
        }
    }
}

/// Returns the words of the key results that a report has.
pub(super) fn words_of(report: &Value) -> Vec<&'static str> {
    let words = KEY_RESULTS.iter().map(|result| result.word);
    words.filter(|word| word.parse().is_ok_and(|result: TableQuantity| !result.of(report).is_null())).collect()
}
