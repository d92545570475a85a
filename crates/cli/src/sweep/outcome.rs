//! The result of a variant, read from the report of its run.

use std::collections::BTreeMap;

use serde_json::value::RawValue;
use serde_json::{Map, Value, json};

use crate::study::TableQuantity;

/// The result of a variant.
#[derive(Debug, Clone, PartialEq)]
pub struct VariantResult {
    /// The verdict, or the reason why there is none: `bad-input`, `machine-failure`, `bug`.
    pub status: String,
    /// The text of the scene that was run; `None` without a report.
    pub scene_text: Option<String>,
    /// The values for tables, an object: `status`, `reason`, `converged`, `iterations`, `seconds`, `error`,
    /// `largest_pressure`, `warnings`, `boundaries`, and the `quantities` of table and chart, as far as the run has them.
    pub values: Value,
    /// The kind and the message of each warning.
    pub warnings: Vec<(String, String)>,
}

impl VariantResult {
    /// Reads a report, or a printed failure, with the values of `quantities`. Returns `None` if the text is neither.
    pub fn read(report: &str, quantities: &[TableQuantity]) -> Option<Self> {
        let mut parts: BTreeMap<String, &RawValue> = serde_json::from_str(report).ok()?;
        // The lists of the increments of a long run take much memory.
        let is_long = |key: &String| ["increments", "forces", "reactions"].contains(&key.as_str());
        parts.retain(|key, _| !is_long(key) || quantities.iter().any(|quantity| quantity.root() == key));
        let report = serde_json::to_value(parts).ok()?;
        Some(Self::of(report["status"].as_str()?, &report, quantities))
    }

    /// Returns the result of a variant without a report.
    pub fn failed(status: &str, reason: &str) -> Self {
        Self::of(status, &json!({ "reason": reason }), &[])
    }

    fn of(status: &str, report: &Value, quantities: &[TableQuantity]) -> Self {
        let text = |key: &str| report[key].as_str();
        let reason = text("reason").or(text("message")).unwrap_or_default();
        let totals = &report["totals"];
        let [converged, iterations] = ["converged", "iterations"].map(|key| totals[key].as_u64().unwrap_or(0));
        let laws = totals["kkt"].as_object().filter(|_| converged + iterations > 0);
        // `None` if one of the errors is no number.
        let errors = laws.and_then(|laws| laws.values().map(Value::as_f64).collect::<Option<Vec<f64>>>());
        let list = |key: &str| report[key].as_array().map_or(&[][..], Vec::as_slice);
        let words = |warning: &Value, key: &str| warning[key].as_str().unwrap_or_default().to_string();
        let warnings = list("warnings").iter().map(|warning| (words(warning, "kind"), words(warning, "message")));
        let warnings: Vec<_> = warnings.collect();
        let values = quantities.iter().map(|quantity| (quantity.text().to_string(), quantity.of(report)));
        let values = json!({
            "status": status,
            "reason": text("help").map_or(reason.to_string(), |help| format!("{reason}; {help}")),
            "converged": converged,
            "iterations": iterations,
            "seconds": totals["wall_seconds"],
            "error": errors.and_then(|all| all.into_iter().reduce(f64::max)),
            "largest_pressure": report["largest_pressure"],
            "warnings": warnings.iter().map(|(kind, _)| kind).collect::<Vec<_>>(),
            "boundaries": list("boundaries"),
            "quantities": values.collect::<Map<_, _>>(),
        });
        VariantResult { status: status.to_string(), scene_text: text("scene_text").map(String::from), values, warnings }
    }

    /// Returns the value of a quantity.
    pub fn value(&self, quantity: &TableQuantity) -> &Value {
        &self.values["quantities"][quantity.text()]
    }

    /// Returns the resultants on the obstacles at the end of the last converged increment.
    pub(super) fn boundaries(&self) -> impl Iterator<Item = &Value> {
        self.values["boundaries"].as_array().into_iter().flatten()
    }

    /// Returns the reason why the run ended early; empty if it did not.
    pub fn reason(&self) -> &str {
        self.values["reason"].as_str().unwrap_or_default()
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
