//! The words, the table and the JSON object of a study.

use serde::Serialize;

use super::extrapolation::{Behaviour, ROUNDING};
use super::steps::{Own, Step, series};
use super::{Convergence, Errors, Limit, Verdict};
use stickslip::base::{Quantity, UnitSystem};
use stickslip::run::report::{SCHEMA_VERSION, Warning, csv_number, csv_table};
use stickslip_output::Table;

/// The digits of values: more than their errors leave.
const DIGITS: usize = 4;

/// A study as one JSON object, in the units of the scene.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Told {
    /// The version of these keys, the same as for reports.
    pub schema_version: u32,
    /// The version of stickslip.
    pub program_version: &'static str,
    /// The title of the scene.
    pub title: String,
    /// The scene file.
    pub scene: String,
    /// The quantity.
    pub quantity: &'static str,
    /// The unit of the values.
    pub unit: String,
    /// The asked share.
    pub to: f64,
    /// The verdict.
    pub verdict: Verdict,
    /// The verdict in words.
    pub message: String,
    /// The value of the last run.
    pub value: Option<f64>,
    /// The extrapolated value.
    pub extrapolated: Option<f64>,
    /// The uncertainty of the value of the last run, as a share: of mesh and increments together.
    pub uncertainty: Option<f64>,
    /// The part of the mesh.
    pub uncertainty_mesh: Option<f64>,
    /// The part of the increments; 0 if the value does not depend on them.
    pub uncertainty_increments: Option<f64>,
    /// The observed order of the mesh.
    pub order_mesh: Option<f64>,
    /// The observed order of the increments.
    pub order_increments: Option<f64>,
    /// The error of the scene's own mesh, as a share.
    pub own_mesh_error: Option<f64>,
    /// The boundary of the peak.
    pub boundary: Option<String>,
    /// The place of the peak.
    pub position: Option<Vec<f64>>,
    /// The predicted time of the next run, s, if it is the reason for the end.
    pub predicted_seconds: Option<f64>,
    /// The warnings of the last run.
    pub warnings: Vec<Warning>,
    /// The runs.
    pub runs: Vec<ToldRun>,
}

/// A run of a study.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct ToldRun {
    /// The numbers of elements, or the mesh file.
    pub mesh: String,
    /// The number of elements.
    pub elements: usize,
    /// The number of increments.
    pub increments: usize,
    /// The value.
    pub value: Option<f64>,
    /// The change by this run, as a share.
    pub change: Option<f64>,
    /// `true` if the contact has enough nodes across for the value to count.
    pub resolved: bool,
    /// Wall time, s.
    pub seconds: f64,
}

impl Convergence {
    /// Returns the table of the runs.
    pub fn table(&self) -> Table {
        let units = self.units_for_people();
        let quantity = self.sought.quantity();
        let unit = units.name(quantity);
        let head = if unit.is_empty() { self.sought.to_string() } else { format!("{}, {unit}", self.sought) };
        let mut table = Table::new(&["mesh", "elements", "inc", &head, "change", "s", ""]);
        for (k, Step { run, .. }) in self.steps.iter().enumerate() {
            let number = |x: f64| units.rounded(Quantity::Number, units.of_si(quantity, x), DIGITS);
            let remark = match (run.value, run.is_resolved) {
                (None, _) | (_, false) => "too coarse to count",
                _ if run.own == Own::Whole => "the scene's own",
                _ => "",
            };
            table.push(vec![
                run.mesh.clone(),
                run.elements.to_string(),
                run.increments.to_string(),
                run.value.map_or("-".to_string(), number),
                self.change(k).map_or("-".to_string(), |change| format!("{:+.2} %", 100.0 * change)),
                format!("{:.2}", run.seconds),
                remark.to_string(),
            ]);
        }
        table
    }

    /// Returns the runs as comma-separated values, in the units of the scene.
    pub fn to_csv(&self) -> String {
        let head = ["mesh", "elements", "increments", self.sought.key(), "change", "resolved", "seconds"];
        let number = |x: Option<f64>| x.map_or(String::new(), csv_number);
        let row = |run: ToldRun| {
            vec![
                run.mesh,
                run.elements.to_string(),
                run.increments.to_string(),
                number(run.value),
                number(run.change),
                run.resolved.to_string(),
                format!("{:.6}", run.seconds),
            ]
        };
        csv_table(&head, self.told().runs.into_iter().map(row))
    }

    /// Returns the study as plain data in the units of the scene.
    pub fn told(&self) -> Told {
        let value = |x: f64| self.units.number(self.sought.quantity(), x);
        let errors = self.errors.as_ref();
        let run = |(k, Step { run, .. }): (usize, &Step)| ToldRun {
            mesh: run.mesh.clone(),
            elements: run.elements,
            increments: run.increments,
            value: run.value.map(value),
            change: self.change(k),
            resolved: run.is_resolved,
            seconds: run.seconds,
        };
        let position = |x: [f64; 3]| {
            x[..self.units.dimension].iter().map(|x| self.units.number(Quantity::Length, *x)).collect::<Vec<_>>()
        };
        Told {
            schema_version: SCHEMA_VERSION,
            program_version: env!("CARGO_PKG_VERSION"),
            title: self.title.clone(),
            scene: self.scene.clone(),
            quantity: self.sought.key(),
            unit: self.units.name(self.sought.quantity()),
            to: self.to,
            verdict: self.verdict.clone(),
            message: self.outcome(),
            value: errors.map(|errors| value(errors.value)),
            extrapolated: errors.filter(|_| self.has_limit()).map(|errors| value(errors.extrapolated())),
            uncertainty: errors.filter(|_| self.has_limit()).and_then(Errors::total),
            uncertainty_mesh: errors.filter(|_| self.has_limit()).and_then(Errors::of_mesh),
            uncertainty_increments: errors.filter(|_| self.has_limit()).and_then(Errors::of_increments),
            order_mesh: errors.and_then(|errors| errors.mesh?.order),
            order_increments: errors.and_then(|errors| errors.increments?.order),
            own_mesh_error: self.own_mesh().map(|(_, error)| error),
            boundary: self.peak.as_ref().map(|peak| peak.boundary.clone()),
            position: self.peak.as_ref().map(|peak| position(peak.position)),
            predicted_seconds: self.predicted,
            warnings: self.warnings.clone(),
            runs: self.steps.iter().enumerate().map(run).collect(),
        }
    }

    /// Returns `true` if the value has a limit.
    pub(super) fn has_limit(&self) -> bool {
        let measured = self.errors.as_ref().is_some_and(|errors| errors.total().is_some());
        let singular = self.peak.as_ref().is_some_and(|peak| peak.singular) || self.verdict == Verdict::Singular;
        measured && !singular
    }

    /// Returns the value with its uncertainty: `the peak pressure is 71.3 MPa ± 1.4 %`; `None` without a limit.
    fn known(&self) -> Option<String> {
        let errors = self.errors.as_ref().filter(|_| self.has_limit())?;
        let value = self.units_for_people().rounded(self.sought.quantity(), errors.value, DIGITS);
        Some(format!("the {} is {value} ± {}", self.sought, self.percent(errors.total()?)))
    }

    /// Returns the verdict as a heading.
    pub(super) fn in_short(&self) -> String {
        match (&self.verdict, self.known()) {
            (Verdict::Known, Some(known)) => known,
            (Verdict::Singular, _) => format!("the {} is singular", self.sought),
            (_, Some(known)) => format!("{known}, not yet known to {}", self.percent(self.to)),
            (_, None) => format!("the {} is not known", self.sought),
        }
    }

    /// Formats a share in percent.
    fn percent(&self, share: f64) -> String {
        // Smaller shares are rounding errors.
        let share = if share.abs() < ROUNDING { 0.0 } else { share };
        format!("{} %", self.units.rounded(Quantity::Number, 100.0 * share, 2))
    }

    /// Returns the verdict in one sentence.
    pub fn outcome(&self) -> String {
        let units = &self.units;
        let Some(last) = self.steps.last().map(|step| &step.run) else { return String::new() };
        let sought = self.sought;
        let increments =
            if last.increments == 1 { "1 increment".into() } else { format!("{} increments", last.increments) };
        let here = format!("mesh {} with {increments}", last.mesh);
        let asked = self.percent(self.to);
        let so_far = self.known().unwrap_or_else(|| format!("the error of the {sought} cannot be estimated yet"));
        let total = self.errors.as_ref().and_then(Errors::total);
        let by_few = total.is_some_and(|total| total <= self.to);
        let short = if by_few { ", but by too few meshes".to_string() } else { format!(", not {asked}") };
        match self.verdict {
            Verdict::Known => format!("{so_far}: {here} is fine enough for {asked}"),
            Verdict::Warned => format!(
                "{so_far} on the meshes as they are, but a warning below is never to be ignored: follow it, then repeat the study"
            ),
            Verdict::Singular => {
                let growth = self.change(self.steps.len() - 1).unwrap_or_default();
                let at = self
                    .peak
                    .as_ref()
                    .map_or(String::new(), |peak| format!(" at {} on `{}`", units.place(peak.position), peak.boundary));
                format!(
                    "no mesh will do: the pressure is singular{at}, it changed by {} with the last refinement; ask for \
                     the force (--for force), or give the edge its radius",
                    self.percent(growth)
                )
            }
            Verdict::NotConverged => {
                format!("{here} did not converge: {}; see stickslip run with this mesh", self.reason)
            }
            Verdict::RunLimit => format!("{so_far}{short}: {} runs are done (--max-runs)", self.steps.len()),
            Verdict::TimeLimit => {
                let next = self.predicted.unwrap_or_default();
                format!("{so_far}{short}: the next run would take about {next:.0} s more (--within)")
            }
            Verdict::NoFinerMesh => format!("{so_far}{short}: no finer mesh is named (--meshes)"),
            Verdict::MemoryLimit => format!("{so_far}{short}: {}", self.reason),
        }
    }

    /// Returns the lines below the table, each with its label: the limit, the uncertainty, the verdict.
    pub fn lines(&self) -> Vec<(&'static str, String)> {
        let percent = |share: f64| self.percent(share);
        let mut lines = Vec::new();
        if let Some(errors) = self.errors.as_ref().filter(|_| self.has_limit())
            && let (Some(total), Some(of_mesh), Some(of_increments)) =
                (errors.total(), errors.of_mesh(), errors.of_increments())
        {
            let units = self.units_for_people();
            lines.push(("extrapolated", units.rounded(self.sought.quantity(), errors.extrapolated(), DIGITS)));
            let behaviour = |limit: Option<Limit>| limit.map_or(String::new(), |limit| format!(" ({limit})"));
            let of_increments = errors.increments.map_or(String::new(), |limit| {
                format!(", increments {}{}", percent(of_increments), behaviour(Some(limit)))
            });
            let of_mesh = format!("mesh {}{}", percent(of_mesh), behaviour(errors.mesh));
            lines.push(("uncertainty", format!("± {}: {of_mesh}{of_increments}", percent(total))));
        }
        lines.push(("verdict", self.outcome()));
        lines.extend(self.own_mesh().map(|(mesh, error)| {
            let verdict = if error <= self.to { "fine enough" } else { "too coarse" };
            ("", format!("the scene's own mesh {mesh} is {verdict}: {} off", percent(error)))
        }));
        lines.extend(self.warnings.iter().map(|warning| ("warning", warning.message.clone())));
        lines
    }

    /// Returns the name and the error of the scene's own mesh, as a share of the extrapolated value.
    fn own_mesh(&self) -> Option<(String, f64)> {
        let trusted = self.has_limit() && self.verdict != Verdict::Warned;
        let limit = self.errors.as_ref().filter(|_| trusted)?.mesh?;
        let series = series(&self.steps, true, false);
        let found = series.steps.iter().zip(&series.values).find(|(k, _)| self.steps[**k].run.own != Own::No)?;
        let error = (found.1 / limit.extrapolated - 1.0).abs();
        // Without a limit the value of the last mesh is the extrapolated one, which says nothing of its error.
        let is_estimated = matches!(limit.behaviour, Behaviour::Monotone | Behaviour::Constant)
            || Some(found.0) != series.steps.last();
        Some((self.steps[*found.0].run.mesh.clone(), error)).filter(|(_, error)| error.is_finite() && is_estimated)
    }

    /// Returns the units for text and pictures: in SI, MPa for pressures.
    pub(super) fn units_for_people(&self) -> UnitSystem {
        if self.sought.quantity() == Quantity::Stress { self.units.of_pictures() } else { self.units }
    }

    /// Returns the change of the value by run `k`, as a share.
    fn change(&self, k: usize) -> Option<f64> {
        let [before, after] = [self.steps.get(k.checked_sub(1)?)?, self.steps.get(k)?].map(|step| step.run.value);
        Some(after? / before? - 1.0).filter(|change| change.is_finite())
    }
}
