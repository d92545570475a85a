//! The table of all variants.

use std::collections::{BTreeMap, BTreeSet};

use serde_json::{Value, json};
use stickslip::base::{Quantity, UnitSystem};
use stickslip::run::report::{SCHEMA_VERSION, UnitNames};
use stickslip::scene::Scene;
use stickslip_output::{Table, paragraph};

use super::outcome::VariantResult;
use super::variation::Variation;
use crate::study::{IN_TABLES, KEY_RESULTS, Record, TableQuantity, csv, distinct, labelled, number, scene_words};

/// All variants of a scene with their results.
#[derive(Debug, Clone, PartialEq)]
pub struct Sweep {
    /// The title of the scene.
    pub title: String,
    /// The scene file.
    pub scene: String,
    /// The command that made it.
    pub command: String,
    /// The units of the results, as in the reports of the runs.
    pub units: UnitSystem,
    /// The varied keys.
    pub varied: Vec<Variation>,
    /// The quantities of the table.
    pub shown: Vec<TableQuantity>,
    /// The quantity of the chart; `None`: the largest pressure.
    pub plotted: Option<TableQuantity>,
    /// A row for each combination. The last key changes fastest.
    pub variants: Vec<Row>,
}

/// A variant and its result.
#[derive(Debug, Clone, PartialEq)]
pub struct Row {
    /// The values, in the order of [`Sweep::varied`].
    pub values: Vec<String>,
    /// The folder of its results, if any.
    pub results: Option<String>,
    /// The result.
    pub outcome: VariantResult,
}

/// The quantities that a table shows.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct TableQuantities {
    /// The quantities of the table; `None`: the key results that any variant has.
    pub table: Option<Vec<TableQuantity>>,
    /// The quantity of the chart.
    pub plot: Option<TableQuantity>,
}

impl TableQuantities {
    /// Returns all quantities of table and chart, each once.
    pub fn all(&self) -> Vec<TableQuantity> {
        let key_results = || KEY_RESULTS[..IN_TABLES].iter().filter_map(|result| result.key.parse().ok()).collect();
        distinct(self.table.clone().unwrap_or_else(key_results).into_iter().chain(self.plot.clone()))
    }
}

/// The columns of the force on an obstacle, and of its sums over the nodes.
const COMPONENTS: [[&str; 2]; 3] = [["f_x", "sum_p_n"], ["f_y", "sum_p_t"], ["f_z", "sum_p_o"]];

/// The key of the column `largest_pressure`.
pub(super) const PEAK: &str = "largest_pressure.pressure";

/// The letters of the kinds of warnings.
const LETTERS: &str = "abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ";

/// The digits of numbers in the text.
const DIGITS: usize = 6;

impl Sweep {
    /// Creates the table of `scene` over `varied`, with a row for each combination, of the quantities of `shown`.
    pub fn new(scene: &Scene, varied: Vec<Variation>, shown: TableQuantities, variants: Vec<Row>) -> Self {
        // Without any force, no unit depends on the dimension.
        let forces = || variants.iter().flat_map(|row| row.outcome.boundaries());
        let dimension = forces().find_map(|on| Some(on["force"].as_array()?.len()));
        let has_value = |quantity: &TableQuantity| variants.iter().any(|row| !row.outcome.value(quantity).is_null());
        let mut all = shown.all();
        if shown.table.is_none() {
            all.retain(|quantity| has_value(quantity) || shown.plot.as_ref() == Some(quantity));
        }
        Sweep {
            title: scene.title.clone(),
            scene: scene.file().to_string(),
            command: String::new(),
            units: scene.description.system(dimension.unwrap_or(3)),
            varied,
            shown: all,
            plotted: shown.plot,
            variants,
        }
    }

    /// Returns the table as one JSON object, in the units of the reports.
    pub fn to_json(&self) -> Value {
        let mut json = json!({
            "schema_version": SCHEMA_VERSION,
            "program_version": env!("CARGO_PKG_VERSION"),
            "title": self.title,
            "scene": self.scene,
        });
        if !self.units.is_si() {
            json["units"] = json!(UnitNames::of(&self.units));
        }
        let with_unit =
            |quantity: &TableQuantity| json!({ "quantity": quantity.text(), "unit": quantity.unit(&self.units) });
        json["varied"] = json!(self.varied);
        json["quantities"] = self.shown.iter().map(with_unit).collect();
        if let Some(plotted) = &self.plotted {
            json["plotted"] = plotted.text().into();
        }
        let plain = |value: &String| match value.parse() {
            Ok(x) if f64::is_finite(x) => x.into(),
            _ => Value::from(value.as_str()),
        };
        let row = |row: &Row| {
            let values: Value = row.values.iter().map(plain).collect();
            let mut object = json!({ "values": values, "results": row.results });
            if let (Some(object), Some(values)) = (object.as_object_mut(), row.outcome.values.as_object()) {
                object.extend(values.clone());
            }
            object
        };
        json["variants"] = self.variants.iter().map(row).collect();
        json
    }

    /// Formats the table as comma-separated values, in the units of the sweep. The quantities come last.
    pub fn to_csv(&self) -> String {
        // The names of the boundaries with contact in any variant, each with the number of components of its force.
        let all = || self.variants.iter().flat_map(|row| row.outcome.boundaries());
        let components = |name: &str| {
            let forces = all().filter(|on| on["boundary"] == name).filter_map(|on| on["force"].as_array());
            forces.map(Vec::len).max().unwrap_or(0).min(COMPONENTS.len())
        };
        let names = distinct(all().filter_map(|on| on["boundary"].as_str()));
        let boundaries: Vec<_> = names.into_iter().map(|name| (name, components(name))).collect();
        let record = |row: &Row| {
            let Row { values, outcome, results } = row;
            let of = |key: &str| (key.to_string(), outcome.values[key].clone());
            let values =
                self.varied.iter().zip(values).map(|(varied, value)| (varied.key.clone(), value.as_str().into()));
            let mut record: Record = values.chain(["status", "converged", "iterations", "seconds"].map(of)).collect();
            record.push(("largest_pressure".to_string(), outcome.values["largest_pressure"]["pressure"].clone()));
            for (name, components) in &boundaries {
                let on = outcome.boundaries().find(|on| on["boundary"] == *name).unwrap_or(&Value::Null);
                let columns = || COMPONENTS[..*components].iter().enumerate();
                let force = |(axis, [f, _]): (usize, &[&str; 2])| (format!("{name}.{f}"), on["force"][axis].clone());
                record.extend(columns().map(force));
                record.extend(columns().map(|(_, [_, sum])| (format!("{name}.{sum}"), on[*sum].clone())));
            }
            let warnings = outcome.warnings.iter().map(|(kind, _)| kind.as_str()).collect::<Vec<_>>().join(" ");
            record.extend([of("error"), ("warnings".to_string(), warnings.into())]);
            record.extend([("results".to_string(), json!(results)), of("reason")]);
            // The largest pressure has its column already.
            let shown = self.shown.iter().filter(|quantity| quantity.text() != PEAK);
            record.extend(shown.map(|quantity| (quantity.text().to_string(), outcome.value(quantity).clone())));
            record
        };
        csv(&self.variants.iter().map(record).collect::<Vec<_>>(), number)
    }

    /// Formats the table as text, pressures in MPa in place of Pa, followed by the notes.
    pub fn to_text(&self) -> String {
        let heads = self.heads();
        let mut table = Table::new(&heads.iter().map(String::as_str).collect::<Vec<_>>()).named_by(self.varied.len());
        self.variants.iter().for_each(|row| table.push(self.cells(row)));
        let notes: String = self.notes().iter().map(|(label, note)| paragraph(label, note)).collect();
        if notes.is_empty() { table.to_string() } else { format!("{table}\n{notes}") }
    }

    /// Returns a varied key in words, with its unit.
    pub(super) fn label(&self, key: &str) -> String {
        let (words, unit) = scene_words(key, &self.units);
        labelled(&words, &unit)
    }

    /// Returns the heads of the table for people.
    pub(super) fn heads(&self) -> Vec<String> {
        let varied = self.varied.iter().map(|variation| self.label(&variation.key));
        let shown = self.shown.iter().map(|quantity| quantity.head(self.units));
        let run = ["verdict", "inc"].map(String::from);
        varied.chain(run).chain(shown).chain(["warnings".to_string()]).collect()
    }

    /// Returns the cells of a variant for people; a dash for a value that it does not have, and a letter for each kind
    /// of warning.
    pub(super) fn cells(&self, row: &Row) -> Vec<String> {
        let Row { values, outcome, .. } = row;
        let shown = self.shown.iter().map(|quantity| match outcome.value(quantity) {
            Value::Null => "-".to_string(),
            Value::String(text) => text.clone(),
            value => match self.in_pictures(quantity, value).filter(|_| value.is_f64()) {
                Some(x) => self.units.rounded(Quantity::Number, x, DIGITS),
                None => value.to_string(),
            },
        });
        let has = |kind: &str| outcome.warnings.iter().any(|(other, _)| other == kind);
        let letters = self.warned().into_iter().zip(LETTERS.chars()).filter(|((kind, _), _)| has(kind));
        let warnings: String = letters.map(|(_, letter)| letter).collect();
        let run = [outcome.status.clone(), outcome.values["converged"].to_string()];
        let warnings = if warnings.is_empty() { "-".to_string() } else { warnings };
        values.iter().cloned().chain(run).chain(shown).chain([warnings]).collect()
    }

    /// Returns each kind of warning with the variants that have it.
    fn warned(&self) -> BTreeMap<&str, Vec<&Row>> {
        self.by_kind(|row| row.outcome.warnings.iter().map(|(kind, _)| kind.as_str()).collect())
    }

    /// Returns the variants of each of the kinds that `of` a variant.
    fn by_kind<'a>(&'a self, of: impl Fn(&'a Row) -> BTreeSet<&'a str>) -> BTreeMap<&'a str, Vec<&'a Row>> {
        let mut rows: BTreeMap<&str, Vec<&Row>> = BTreeMap::new();
        for row in &self.variants {
            for kind in of(row) {
                rows.entry(kind).or_default().push(row);
            }
        }
        rows
    }

    /// Returns, each with a label, the reasons why variants ended early, the first warning of each kind with its cure,
    /// and the quantities that no variant has.
    pub(super) fn notes(&self) -> Vec<(String, String)> {
        let name = |row: &Row| {
            let pairs = self.varied.iter().zip(&row.values).map(|(varied, value)| format!("{}={value}", varied.key));
            pairs.collect::<Vec<_>>().join(", ")
        };
        let of = |kind: &str, rows: &[&Row]| format!("{kind}, {} of {} variants", rows.len(), self.variants.len());
        let early = self.by_kind(|Row { outcome, .. }| {
            Some(outcome.status.as_str()).filter(|_| !outcome.reason().is_empty()).into_iter().collect()
        });
        let early = early.into_iter().map(|(status, rows)| {
            let first = format!("{}: {}", name(rows[0]), rows[0].outcome.reason());
            ("ended early".to_string(), format!("{}, the first {first}", of(status, &rows)))
        });
        let warned = self.warned().into_iter().zip(LETTERS.chars()).map(|((kind, rows), letter)| {
            let first = rows[0].outcome.warnings.iter().find(|(other, _)| other == kind);
            let message = first.map_or("", |(_, message)| message);
            (format!("warning {letter}"), format!("{}, in the first: {message}", of(kind, &rows)))
        });
        let reported: Vec<&Row> = self.variants.iter().filter(|row| row.outcome.scene_text.is_some()).collect();
        let is_missing = |quantity: &&TableQuantity| {
            !reported.is_empty() && reported.iter().all(|row| row.outcome.value(quantity).is_null())
        };
        let missing = self.shown.iter().filter(is_missing);
        let missing =
            missing.map(|quantity| ("no value".to_string(), format!("{}: no variant has a value", quantity.text())));
        let chart = self.chart();
        let is_empty = chart.panels.iter().flat_map(|panel| &panel.curves).all(|curve| curve.points.is_empty());
        let empty =
            is_empty.then(|| ("chart".to_string(), format!("no point of {}: {}", chart.y.label, chart.subtitle)));
        early.chain(warned).chain(missing).chain(empty).collect()
    }

    /// Returns the value of a quantity in its unit in the text table; `None` if it is no number.
    pub(super) fn in_pictures(&self, quantity: &TableQuantity, value: &Value) -> Option<f64> {
        let (value, of) = (value.as_f64()?, quantity.quantity());
        let units = quantity.units_for_people(self.units);
        Some(if of == Quantity::Stress { units.of_si(of, self.units.to_si(of, value)) } else { value })
    }
}
