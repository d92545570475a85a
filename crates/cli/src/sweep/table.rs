//! The table of all variants.

use super::outcome::VariantResult;
use super::variation::Variation;
use serde::{Serialize, Serializer};
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

fn numbers_as_such<S: Serializer>(values: &[String], serializer: S) -> Result<S::Ok, S::Error> {
    let plain = |value: &'_ String| value.parse().ok().filter(|x: &f64| x.is_finite());
    serializer.collect_seq(values.iter().map(|value| plain(value).map_or(Plain::Text(value), Plain::Number)))
}

const COMPONENTS: [&str; 3] = ["f_x", "f_y", "f_z"];

/// The digits of pressures and forces in the text.
const DIGITS: usize = 6;

impl Sweep {
    /// Creates the table of `scene` over `varied`, with a row for each combination.
    pub fn new(scene: &Scene, varied: Vec<Variation>, variants: Vec<Row>) -> Self {
        // Without any force, no unit depends on the dimension.
        let dimension = variants.iter().flat_map(|row| &row.outcome.boundaries).map(|on| on.force.len()).next();
        Sweep {
            schema_version: SCHEMA_VERSION,
            program_version: env!("CARGO_PKG_VERSION"),
            title: scene.title.clone(),
            scene: scene.file().to_string(),
            units: scene.description.system(dimension.unwrap_or(3)),
            varied,
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

    /// Formats the table as comma-separated values, in the units of the sweep.
    pub fn to_csv(&self) -> String {
        let boundaries = self.boundaries();
        let mut header: Vec<String> = self.varied.iter().map(|variation| variation.key.clone()).collect();
        header.extend(["status", "converged", "iterations", "seconds", "largest_pressure"].map(String::from));
        for (name, components) in &boundaries {
            let columns = COMPONENTS[..*components].iter().chain(&["sum_p_n", "sum_p_t", "sum_p_o"][..*components]);
            header.extend(columns.map(|column| format!("{name}.{column}")));
        }
        header.extend(["error", "warnings", "results", "reason"].map(String::from));
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
            fields
        };
        let header: Vec<&str> = header.iter().map(String::as_str).collect();
        csv_table(&header, self.variants.iter().map(row))
    }

    /// Formats the table as text, pressures in MPa in place of Pa, followed by the reasons why variants ended early.
    pub fn to_text(&self) -> String {
        let boundaries = self.boundaries();
        let mut heads: Vec<String> = self.varied.iter().map(|variation| variation.key.clone()).collect();
        heads.extend(["verdict", "inc", "iter", "s"].map(String::from));
        heads.push(format!("pressure, {}", self.pressure_unit()));
        let force = self.units.name(Quantity::Force);
        for (name, components) in &boundaries {
            heads.extend(COMPONENTS[..*components].iter().map(|component| format!("{name} {component}, {force}")));
        }
        heads.extend(["error", "warnings"].map(String::from));
        let heads: Vec<&str> = heads.iter().map(String::as_str).collect();
        let mut table = Table::new(&heads);
        let number = |x: f64| self.units.rounded(Quantity::Number, x, DIGITS);
        let shown = |x: Option<f64>, show: &dyn Fn(f64) -> String| x.map_or("-".to_string(), show);
        for Row { values, outcome, .. } in &self.variants {
            let mut row = values.clone();
            row.extend([outcome.status.clone(), outcome.converged.to_string(), outcome.iterations.to_string()]);
            row.push(shown(outcome.seconds, &|seconds| format!("{seconds:.2}")));
            let pressure = outcome.largest_pressure.as_ref().and_then(|largest| largest.pressure);
            let pressure = pressure.map(|pressure| self.pressure(pressure));
            row.push(shown(pressure, &number));
            for (name, components) in &boundaries {
                let force = |c: usize| on(outcome, name).and_then(|found| found.force.get(c).copied());
                row.extend((0..*components).map(|c| shown(force(c), &number)));
            }
            row.push(shown(outcome.error, &|error| format!("{error:.1e}")));
            row.push(if outcome.warnings.is_empty() { "-".to_string() } else { outcome.warnings.join(" ") });
            table.push(row);
        }
        let early = self.variants.iter().filter(|row| !row.outcome.reason.is_empty());
        let reasons = early.map(|row| format!("{}: {}\n", self.name(row), row.outcome.reason));
        let reasons: String = reasons.collect();
        if reasons.is_empty() { table.to_string() } else { format!("{table}\n{reasons}") }
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
