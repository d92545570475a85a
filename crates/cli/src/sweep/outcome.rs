//! The result of a variant, read from the report of its run.

use std::collections::BTreeMap;
use std::fmt;

use serde::de::{DeserializeSeed, IgnoredAny, MapAccess, Visitor};
use serde::{Deserialize, Deserializer, Serialize};
use serde_json::{Map, Value};

use super::quantity::TableQuantity;
use stickslip::run::report::{LargestPressure, Resultant};

/// The result of a variant.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(from = "Report")]
pub struct VariantResult {
    /// The verdict, or the reason why there is none: `bad-input`, `machine-failure`, `bug`.
    pub status: String,
    /// The text of the scene that was run; `None` without a report.
    #[serde(skip_serializing)]
    pub scene_text: Option<String>,
    /// The reason why the run ended early; empty if it did not.
    pub reason: String,
    /// The number of increments that converged.
    pub converged: usize,
    /// The number of linear systems solved by the method.
    pub iterations: usize,
    /// Wall time, s; `None` without a report.
    pub seconds: Option<f64>,
    /// The largest error of any law in any increment; `None` if it is not finite, or without increments.
    pub error: Option<f64>,
    /// The largest contact pressure of all increments.
    pub largest_pressure: Option<LargestPressure>,
    /// The kinds of the warnings of the run.
    pub warnings: Vec<String>,
    /// The resultant on each obstacle at the end of the last converged increment.
    pub boundaries: Vec<Resultant>,
    /// The quantities of the table and the chart: numbers in the units of the report, texts, or null.
    pub quantities: Map<String, Value>,
}

/// The part of `run.json` that is needed, or of the printed failure if there is no report.
#[derive(Deserialize)]
struct Report {
    status: String,
    scene_text: Option<String>,
    #[serde(default, alias = "message")]
    reason: String,
    help: Option<String>,
    #[serde(default)]
    increments: Vec<Increment>,
    totals: Option<Totals>,
    largest_pressure: Option<LargestPressure>,
    #[serde(default)]
    warnings: Vec<Told>,
    #[serde(default)]
    boundaries: Vec<Resultant>,
}

#[derive(Deserialize)]
struct Told {
    kind: String,
}

#[derive(Deserialize)]
struct Increment {
    status: String,
    kkt: BTreeMap<String, Option<f64>>,
}

#[derive(Deserialize)]
struct Totals {
    iterations: usize,
    wall_seconds: Option<f64>,
}

impl From<Report> for VariantResult {
    fn from(report: Report) -> Self {
        let Report { status, scene_text, reason, help, increments, totals, largest_pressure, warnings, boundaries } =
            report;
        let errors = increments.iter().flat_map(|increment| increment.kkt.values());
        // `None` if there is no error, or one of them is no number.
        let error = errors.copied().collect::<Option<Vec<f64>>>().and_then(|all| all.into_iter().reduce(f64::max));
        VariantResult {
            reason: help.map_or(reason.clone(), |help| format!("{reason}; {help}")),
            converged: increments.iter().filter(|increment| increment.status == "converged").count(),
            iterations: totals.as_ref().map_or(0, |totals| totals.iterations),
            seconds: totals.and_then(|totals| totals.wall_seconds),
            error,
            status,
            scene_text,
            largest_pressure,
            warnings: warnings.into_iter().map(|warning| warning.kind).collect(),
            boundaries,
            quantities: Map::new(),
        }
    }
}

/// Reads only these keys of an object: the lists of the increments of a long run take much memory.
struct Parts<'a>(&'a [&'a str]);

impl<'de> DeserializeSeed<'de> for Parts<'_> {
    type Value = Map<String, Value>;

    fn deserialize<D: Deserializer<'de>>(self, deserializer: D) -> Result<Self::Value, D::Error> {
        deserializer.deserialize_map(self)
    }
}

impl<'de> Visitor<'de> for Parts<'_> {
    type Value = Map<String, Value>;

    fn expecting(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str("an object")
    }

    fn visit_map<A: MapAccess<'de>>(self, mut map: A) -> Result<Self::Value, A::Error> {
        let mut parts = Map::new();
        while let Some(key) = map.next_key::<String>()? {
            if self.0.contains(&key.as_str()) {
                parts.insert(key, map.next_value()?);
            } else {
                map.next_value::<IgnoredAny>()?;
            }
        }
        Ok(parts)
    }
}

impl VariantResult {
    /// Reads a report, or a printed failure, with the values of `quantities`. Returns `None` if the text is neither.
    pub fn read(report: &str, quantities: &[TableQuantity]) -> Option<Self> {
        let mut reader = serde_json::Deserializer::from_str(report);
        let roots: Vec<&str> = quantities.iter().map(TableQuantity::root).collect();
        let parts = Value::Object(Parts(&roots).deserialize(&mut reader).ok()?);
        let values = quantities.iter().map(|quantity| (quantity.text().to_string(), quantity.of(&parts))).collect();
        Some(VariantResult { quantities: values, ..serde_json::from_str(report).ok()? })
    }

    /// Returns the value of a quantity if it is a number.
    pub fn number(&self, quantity: &TableQuantity) -> Option<f64> {
        self.quantities.get(quantity.text())?.as_f64()
    }

    /// Returns the result of a variant without a report.
    pub fn failed(status: &str, reason: String) -> Self {
        VariantResult {
            status: status.to_string(),
            scene_text: None,
            reason,
            converged: 0,
            iterations: 0,
            seconds: None,
            error: None,
            largest_pressure: None,
            warnings: Vec::new(),
            boundaries: Vec::new(),
            quantities: Map::new(),
        }
    }

    /// Returns `true` if all increments converged.
    pub fn is_converged(&self) -> bool {
        self.status == "converged"
    }

    /// Returns `true` if the machine or the program failed, so that another try may succeed.
    pub fn is_of_the_machine(&self) -> bool {
        ["machine-failure", "out-of-memory", "bug"].contains(&self.status.as_str())
    }

    /// Returns `true` if another run of the same scene would end the same way.
    pub fn is_final(&self) -> bool {
        self.status != "interrupted" && !self.is_of_the_machine()
    }
}
