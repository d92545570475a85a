//! The table of all variants.

use super::outcome::VariantResult;
use super::quantity::TableQuantity;
use super::variation::Variation;
use serde::{Serialize, Serializer};
use serde_json::Value;
use stickslip::base::{Quantity, UnitSystem};
use stickslip::run::report::{Resultant, SCHEMA_VERSION, UnitNames, csv_number, csv_table};
use stickslip::scene::Scene;
use stickslip_output::Table;

/// All variants of a scene with their results.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Sweep {
    /// The version of these keys, the same as for reports.
    pub schema_version: u32,
    /// The version of stickslip.
    pub program_version: &'static str,
    /// The title of the scene.
    pub title: String,
    /// The scene file.
    pub scene: String,
    /// The units of the results, as in the reports of the runs.
    #[serde(skip_serializing_if = "UnitSystem::is_si", serialize_with = "by_name")]
    pub units: UnitSystem,
    /// The varied keys.
    pub varied: Vec<Variation>,
    /// The quantities of the table, with their units.
    #[serde(rename = "quantities", serialize_with = "with_units")]
    pub shown: Vec<(TableQuantity, String)>,
    /// The quantity of the chart; `None`: the largest pressure.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub plotted: Option<TableQuantity>,
    /// A row for each combination. The last key changes fastest.
    pub variants: Vec<Row>,
}

/// A variant and its result.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Row {
    /// The values, in the order of [`Sweep::varied`].
    #[serde(serialize_with = "numbers_as_such")]
    pub values: Vec<String>,
    /// The folder of its results, if any.
    pub results: Option<String>,
    /// The result.
    #[serde(flatten)]
    pub outcome: VariantResult,
}

/// The quantities that a table shows.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Shown {
    /// The quantities of the table; `None`: the key results that any variant has.
    pub table: Option<Vec<TableQuantity>>,
    /// The quantity of the chart.
    pub plot: Option<TableQuantity>,
}

/// The key results, with their names in the text table.
const KEY_RESULTS: [(&str, &str); 4] = [
    ("largest_pressure.pressure", "pressure"),
    ("largest_force.magnitude", "force"),
    ("friction.friction_work", "friction work"),
    ("stick_zone.ratio", "stick ratio"),
];

impl Shown {
    /// Returns all quantities of table and chart, each once.
    pub fn all(&self) -> Vec<TableQuantity> {
        let of_table = self
            .table
            .clone()
            .unwrap_or_else(|| KEY_RESULTS.iter().filter_map(|(text, _)| text.parse().ok()).collect());
        let mut all: Vec<TableQuantity> = Vec::new();
        for quantity in of_table.into_iter().chain(self.plot.clone()) {
            if !all.contains(&quantity) {
                all.push(quantity);
            }
        }
        all
    }
}

/// A value in its JSON type.
#[derive(Serialize)]
#[serde(untagged)]
enum Plain<'a> {
    Number(f64),
    Text(&'a str),
}

fn by_name<S: Serializer>(units: &UnitSystem, serializer: S) -> Result<S::Ok, S::Error> {
    UnitNames::of(units).serialize(serializer)
}

#[derive(Serialize)]
struct WithUnit<'a> {
    quantity: &'a TableQuantity,
    unit: &'a str,
}

fn with_units<S: Serializer>(shown: &[(TableQuantity, String)], serializer: S) -> Result<S::Ok, S::Error> {
    serializer.collect_seq(shown.iter().map(|(quantity, unit)| WithUnit { quantity, unit }))
}

fn numbers_as_such<S: Serializer>(values: &[String], serializer: S) -> Result<S::Ok, S::Error> {
    let plain = |value: &'_ String| value.parse().ok().filter(|x: &f64| x.is_finite());
    serializer.collect_seq(values.iter().map(|value| plain(value).map_or(Plain::Text(value), Plain::Number)))
}

const COMPONENTS: [&str; 3] = ["f_x", "f_y", "f_z"];

/// The digits of numbers in the text.
const DIGITS: usize = 6;

impl Sweep {
    /// Creates the table of `scene` over `varied`, with a row for each combination, of the quantities of `shown`.
    pub fn new(scene: &Scene, varied: Vec<Variation>, shown: Shown, variants: Vec<Row>) -> Self {
        // Without any force, no unit depends on the dimension.
        let dimension = variants.iter().flat_map(|row| &row.outcome.boundaries).map(|on| on.force.len()).next();
        let units = scene.description.system(dimension.unwrap_or(3));
        let has_value = |quantity: &TableQuantity| {
            variants.iter().any(|row| row.outcome.quantities.get(quantity.text()).is_some_and(|value| !value.is_null()))
        };
        let mut all = shown.all();
        if shown.table.is_none() {
            all.retain(|quantity| has_value(quantity) || shown.plot.as_ref() == Some(quantity));
        }
        let unit = |quantity: TableQuantity| {
            let unit = format!("{}{}", units.name(quantity.quantity()), quantity.fixed_unit());
            (quantity, unit)
        };
        Sweep {
            schema_version: SCHEMA_VERSION,
            program_version: env!("CARGO_PKG_VERSION"),
            title: scene.title.clone(),
            scene: scene.file().to_string(),
            units,
            varied,
            shown: all.into_iter().map(unit).collect(),
            plotted: shown.plot,
            variants,
        }
    }

    /// Returns the names of the boundaries with contact in any variant, each with the number of components of its
    /// force.
    fn boundaries(&self) -> Vec<(&str, usize)> {
        let mut boundaries: Vec<(&str, usize)> = Vec::new();
        for resultant in self.variants.iter().flat_map(|row| &row.outcome.boundaries) {
            let components = resultant.force.len();
            match boundaries.iter_mut().find(|(name, _)| *name == resultant.boundary) {
                Some((_, most)) => *most = components.max(*most),
                None => boundaries.push((&resultant.boundary, components)),
            }
        }
        boundaries
    }

    /// Formats the table as comma-separated values, in the units of the sweep. The quantities come last.
    pub fn to_csv(&self) -> String {
        let boundaries = self.boundaries();
        let mut header: Vec<String> = self.varied.iter().map(|variation| variation.key.clone()).collect();
        header.extend(["status", "converged", "iterations", "seconds", "largest_pressure"].map(String::from));
        for (name, components) in &boundaries {
            let columns = COMPONENTS[..*components].iter().chain(&["sum_p_n", "sum_p_t", "sum_p_o"][..*components]);
            header.extend(columns.map(|column| format!("{name}.{column}")));
        }
        header.extend(["error", "warnings", "results", "reason"].map(String::from));
        header.extend(self.shown.iter().map(|(quantity, _)| quantity.text().to_string()));
        let number = |x: Option<f64>| x.map_or(String::new(), csv_number);
        let row = |row: &Row| {
            let outcome = &row.outcome;
            let mut fields = row.values.clone();
            fields.extend([outcome.status.clone(), outcome.converged.to_string(), outcome.iterations.to_string()]);
            fields.push(outcome.seconds.map_or(String::new(), |seconds| format!("{seconds:.6}")));
            fields.push(number(outcome.largest_pressure.as_ref().and_then(|largest| largest.pressure)));
            for (name, components) in &boundaries {
                let found = on(outcome, name);
                let sums = found.map(|found| [Some(found.sums.sum_p_n), Some(found.sums.sum_p_t), found.sums.sum_p_o]);
                fields.extend((0..*components).map(|c| number(found.and_then(|found| found.force.get(c).copied()))));
                fields.extend((0..*components).map(|c| number(sums.and_then(|sums| sums[c]))));
            }
            fields.push(number(outcome.error));
            fields.push(outcome.warnings.join(" "));
            fields.extend([row.results.clone().unwrap_or_default(), outcome.reason.clone()]);
            fields.extend(self.shown.iter().map(|(quantity, _)| match outcome.quantities.get(quantity.text()) {
                None | Some(Value::Null) => String::new(),
                Some(Value::String(text)) => text.clone(),
                Some(value) => value.as_f64().map_or_else(|| value.to_string(), csv_number),
            }));
            fields
        };
        let header: Vec<&str> = header.iter().map(String::as_str).collect();
        csv_table(&header, self.variants.iter().map(row))
    }

    /// Formats the table as text, pressures in MPa in place of Pa, followed by the reasons why variants ended early.
    pub fn to_text(&self) -> String {
        let heads = self.heads();
        let heads: Vec<&str> = heads.iter().map(String::as_str).collect();
        let mut table = Table::new(&heads);
        for row in &self.variants {
            table.push(self.cells(row));
        }
        let notes = self.notes();
        if notes.is_empty() { table.to_string() } else { format!("{table}\n{}\n", notes.join("\n")) }
    }

    /// Returns the heads of the table for people.
    pub(super) fn heads(&self) -> Vec<String> {
        let mut heads: Vec<String> = self.varied.iter().map(|variation| variation.key.clone()).collect();
        heads.extend(["verdict", "inc"].map(String::from));
        heads.extend(self.shown.iter().map(|(quantity, _)| self.label(quantity)));
        heads.push("warnings".to_string());
        heads
    }

    /// Returns the cells of a variant for people; a dash for a value that it does not have.
    pub(super) fn cells(&self, row: &Row) -> Vec<String> {
        let Row { values, outcome, .. } = row;
        let mut cells = values.clone();
        cells.extend([outcome.status.clone(), outcome.converged.to_string()]);
        cells.extend(self.shown.iter().map(|(quantity, _)| match outcome.quantities.get(quantity.text()) {
            None | Some(Value::Null) => "-".to_string(),
            Some(Value::String(text)) => text.clone(),
            Some(value) => value.as_f64().map_or_else(
                || value.to_string(),
                |x| self.units.rounded(Quantity::Number, self.in_pictures(quantity, x), DIGITS),
            ),
        }));
        cells.push(if outcome.warnings.is_empty() { "-".to_string() } else { outcome.warnings.join(" ") });
        cells
    }

    /// Returns the reasons why variants ended early, and the quantities that no variant has.
    pub(super) fn notes(&self) -> Vec<String> {
        let early = self.variants.iter().filter(|row| !row.outcome.reason.is_empty());
        let mut notes: Vec<String> = early.map(|row| format!("{}: {}", self.name(row), row.outcome.reason)).collect();
        let reported = || self.variants.iter().filter(|row| row.outcome.scene_text.is_some());
        let is_missing = |quantity: &TableQuantity| {
            reported().all(|row| row.outcome.quantities.get(quantity.text()).is_none_or(Value::is_null))
        };
        let missing = self.shown.iter().filter(|(quantity, _)| reported().next().is_some() && is_missing(quantity));
        notes.extend(missing.map(|(quantity, _)| format!("{}: no variant has a value", quantity.text())));
        notes
    }

    /// Returns the name of a quantity for people, with its unit in the text table.
    pub(super) fn label(&self, quantity: &TableQuantity) -> String {
        let named = KEY_RESULTS.iter().find(|(text, _)| *text == quantity.text());
        let name = named.map_or(quantity.text(), |(_, name)| name);
        let unit = match quantity.quantity() {
            Quantity::Stress => self.units.of_pictures().name(Quantity::Stress),
            other => format!("{}{}", self.units.name(other), quantity.fixed_unit()),
        };
        if unit.is_empty() { name.to_string() } else { format!("{name}, {unit}") }
    }

    /// Converts the value of a quantity to its unit in the text table.
    pub(super) fn in_pictures(&self, quantity: &TableQuantity, told: f64) -> f64 {
        match quantity.quantity() {
            Quantity::Stress => self.pressure(told),
            _ => told,
        }
    }

    /// Converts a pressure of a result to the unit of the text table.
    pub(super) fn pressure(&self, told: f64) -> f64 {
        self.units.of_pictures().of_si(Quantity::Stress, self.units.to_si(Quantity::Stress, told))
    }

    /// Returns the unit of pressures in the text table.
    pub(super) fn pressure_unit(&self) -> String {
        self.units.of_pictures().name(Quantity::Stress)
    }

    /// Names a variant: `contact.friction=0.3, mesh.file=a.msh`.
    fn name(&self, row: &Row) -> String {
        let pairs = self.varied.iter().zip(&row.values).map(|(variation, value)| format!("{}={value}", variation.key));
        pairs.collect::<Vec<_>>().join(", ")
    }
}

/// Returns the resultant on the obstacle of a boundary.
fn on<'a>(outcome: &'a VariantResult, boundary: &str) -> Option<&'a Resultant> {
    outcome.boundaries.iter().find(|resultant| resultant.boundary == boundary)
}
