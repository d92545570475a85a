//! The quantities whose convergence can be asked for.

use std::fmt;
use std::str::FromStr;

use serde_json::Value;
use stickslip::body::Description;
use stickslip::run::report::RunReport;

use crate::study::{KEY_RESULTS, KeyResult, Places, TableQuantity};

/// A quantity of a run: a key result by its word, or any number that a sweep can show.
#[derive(Debug, Clone, PartialEq)]
pub struct Sought {
    /// The word, as it was given.
    pub word: String,
    /// The quantity.
    pub of: TableQuantity,
}

/// Narrower zones have no peak that says anything about finer meshes.
const FINE_FOR_PEAK: usize = 5;

/// The stick ratio does not count if the mesh alone makes a larger uncertainty, as in zones of fewer than nine nodes.
const FINE_FOR_STICK: f64 = 1.0 / (3.0 * 9.0);

impl Sought {
    fn known(&self) -> Option<&'static KeyResult> {
        KEY_RESULTS.iter().find(|result| result.key == self.of.text())
    }

    /// Returns it completed with what acts at its place in a scene.
    pub(super) fn at(&self, description: &Description) -> Result<Self, String> {
        let mut places = Places::default();
        places.add(description);
        Ok(Sought { of: self.of.at(&places, true)?, ..self.clone() })
    }

    /// Returns `true` if it is the largest contact pressure of the history.
    pub(super) fn is_peak(&self) -> bool {
        self.known().is_some_and(|result| result.word == "peak")
    }

    /// Returns the value in a report, in the units of the report; `None` if the run has none.
    pub(super) fn value(&self, report: &Value) -> Option<f64> {
        self.of.of(report).as_f64()
    }

    /// Returns the words of the key results that a report has.
    pub(super) fn there(report: &Value) -> Vec<&'static str> {
        let words = KEY_RESULTS.iter().map(|result| result.word);
        words.filter(|word| word.parse().is_ok_and(|sought: Sought| sought.value(report).is_some())).collect()
    }

    /// Returns the error of the value by rounding to whole elements: half an element at each end of the stick zone, three
    /// times the typical error.
    pub(super) fn rounding(&self, report: &RunReport) -> f64 {
        let is_stick = self.known().is_some_and(|result| result.word == "stick_ratio");
        report.stick_zone.as_ref().filter(|_| is_stick).map_or(0.0, |stick| 3.0 * stick.uncertainty)
    }

    /// Returns `true` if the contact has enough nodes across for the value to follow an order.
    pub(super) fn is_resolved(&self, report: &RunReport) -> bool {
        match self.known().map(|result| result.word) {
            Some("peak") => {
                let across = report.largest_pressure.as_ref().and_then(|largest| largest.nodes_across);
                across.is_none_or(|across| across >= FINE_FOR_PEAK)
            }
            Some("stick_ratio") => report.stick_zone.as_ref().is_some_and(|stick| stick.uncertainty <= FINE_FOR_STICK),
            _ => true,
        }
    }
}

impl fmt::Display for Sought {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(self.known().map_or(&self.word, |result| result.name))
    }
}

impl FromStr for Sought {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        let known = KEY_RESULTS.iter().find(|result| result.word == text);
        let of = known.map_or(text, |result| result.key).parse().map_err(|error| {
            let words = KEY_RESULTS.map(|result| result.word).join(", ");
            format!("the quantities are {words}, and those of sweep --table: {error}")
        })?;
        Ok(Sought { word: text.to_string(), of })
    }
}
