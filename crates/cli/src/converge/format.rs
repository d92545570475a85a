//! The words, the table and the JSON object of a study.

use serde_json::{Value, json};

use super::extrapolation::{Behaviour, ROUNDING};
use super::steps::{Series, Step, series};
use super::{Convergence, Errors, Limit, Verdict};
use crate::study::{csv, labelled, number, record};
use stickslip::base::{Quantity, UnitSystem};
use stickslip::run::report::{LargestPressure, SCHEMA_VERSION, Warning};
use stickslip::solver::history::Status;
use stickslip_output::{Table, msh};

/// The digits of values: more than their errors leave, and enough for the changes that are printed.
const DIGITS: usize = 5;

impl Convergence {
    /// Returns the table of the runs.
    pub fn table(&self) -> Table {
        let units = self.units_for_people();
        let quantity = self.sought.quantity();
        let mut table = Table::new(&["mesh", "elements", "inc", &self.head(), "change", "s", ""]);
        for (k, run) in self.result.steps.iter().enumerate() {
            let number = |x: f64| units.rounded(Quantity::Number, units.of_si(quantity, x), DIGITS);
            let remark = match (run.value, run.is_resolved) {
                (None, _) | (_, false) => "too coarse to count",
                _ if run.is_own_mesh && run.increments == self.own_increments => "the scene's own",
                _ => "",
            };
            table.push(vec![
                run.mesh.clone(),
                run.elements.to_string(),
                run.increments.to_string(),
                run.value.map_or("-".to_string(), number),
                self.change(k)
                    .map_or("-".to_string(), |change| format!("{:+.2} %", (1e4 * change).round() / 100.0 + 0.0)),
                format!("{:.2}", run.seconds),
                remark.to_string(),
            ]);
        }
        table
    }

    /// Returns the runs as comma-separated values, in the units of the scene.
    pub fn to_csv(&self) -> String {
        csv(&self.runs(self.sought.word()).into_iter().map(record).collect::<Vec<_>>(), number)
    }

    /// Returns the file of the last mesh in the units of the scene, for Gmsh and `mesh.file`, if meshes refined themselves.
    pub fn to_msh(&self) -> Option<String> {
        let mesh = self.mesh.as_ref()?.build().ok()?;
        msh(&mesh, |x| self.last.units.of_si(Quantity::Length, x))
    }

    /// Returns the runs in the units of the scene, with this name of the value.
    fn runs(&self, value: &str) -> Vec<Value> {
        let of_si = |x: f64| self.last.units.of_si(self.sought.quantity(), x);
        let run = |(k, run): (usize, &Step)| {
            json!({
                "mesh": run.mesh,
                "elements": run.elements,
                "increments": run.increments,
                value: run.value.map(of_si),
                "change": self.change(k),
                "resolved": run.is_resolved,
                "seconds": run.seconds,
            })
        };
        self.result.steps.iter().enumerate().map(run).collect()
    }

    /// Returns the study as one JSON object, in the units of the scene.
    pub fn to_json(&self) -> Value {
        let units = &self.last.units;
        let quantity = self.sought.quantity();
        let value = |x: f64| units.of_si(quantity, x);
        let position = |peak: &LargestPressure| {
            let place = peak.position[..units.dimension].iter().map(|x| units.of_si(Quantity::Length, *x));
            place.collect::<Vec<_>>()
        };
        let errors = self.result.errors.as_ref();
        let limited = errors.filter(|_| self.has_limit());
        json!({
            "schema_version": SCHEMA_VERSION,
            "program_version": env!("CARGO_PKG_VERSION"),
            "title": self.last.title,
            "scene": self.last.scene,
            "quantity": self.sought.word(),
            "unit": self.sought.unit(units),
            "to": self.to,
            "verdict": self.result.verdict,
            "message": self.outcome(),
            "value": errors.map(|errors| value(errors.value)),
            "extrapolated": limited.map(|errors| value(errors.extrapolated())),
            "uncertainty": limited.and_then(Errors::total),
            "uncertainty_mesh": limited.and_then(Errors::of_mesh),
            "uncertainty_increments": limited.and_then(Errors::of_increments),
            "order_mesh": errors.and_then(|errors| errors.mesh?.order),
            "order_increments": errors.and_then(|errors| errors.increments?.order),
            "own_mesh_error": self.own_mesh().map(|(_, error)| error),
            "boundary": self.peak().map(|peak| &peak.boundary),
            "position": self.peak().map(position),
            "predicted_seconds": self.result.predicted,
            "warnings": self.last.warnings,
            "runs": self.runs("value"),
        })
    }

    /// Returns the largest pressure of the last run, if the quantity is the peak.
    fn peak(&self) -> Option<&LargestPressure> {
        self.last.largest_pressure.as_ref().filter(|_| self.sought.is_peak())
    }

    /// Returns `true` if the value has a limit.
    pub(super) fn has_limit(&self) -> bool {
        let measured = self.result.errors.as_ref().is_some_and(|errors| errors.total().is_some());
        let singular = self.peak().is_some_and(|peak| peak.singular) || self.result.verdict == Verdict::Singular;
        measured && !singular
    }

    /// Returns the value with its uncertainty: `the peak pressure is 71.3 MPa ± 1.4 %`; `None` without a limit.
    fn known(&self) -> Option<String> {
        let errors = self.result.errors.as_ref().filter(|_| self.has_limit())?;
        let value = self.units_for_people().rounded(self.sought.quantity(), errors.value, DIGITS);
        Some(format!("the {} is {value} ± {}", self.sought.name(), self.percent(errors.total()?)))
    }

    /// Returns the verdict as a heading.
    pub(super) fn in_short(&self) -> String {
        match (&self.result.verdict, self.known()) {
            (Verdict::Known, Some(known)) => known,
            (Verdict::Singular, _) => format!("the {} is singular", self.sought.name()),
            (_, Some(known)) => format!("{known}, not yet known to {}", self.percent(self.to)),
            (_, None) => format!("the {} is not known", self.sought.name()),
        }
    }

    /// Formats a share in percent.
    fn percent(&self, share: f64) -> String {
        // Smaller shares are rounding errors.
        let share = if share.abs() < ROUNDING { 0.0 } else { share };
        format!("{} %", self.last.units.rounded(Quantity::Number, 100.0 * share, 2))
    }

    /// Returns the verdict in one sentence.
    pub fn outcome(&self) -> String {
        let units = &self.last.units;
        let Some(last) = self.result.steps.last() else { return String::new() };
        let sought = self.sought.name();
        let increments =
            if last.increments == 1 { "1 increment".into() } else { format!("{} increments", last.increments) };
        let here = format!("mesh {} with {increments}", last.mesh);
        let asked = self.percent(self.to);
        let so_far = self.known().unwrap_or_else(|| format!("the error of the {sought} cannot be estimated yet"));
        let total = self.result.errors.as_ref().and_then(Errors::total);
        let short = match total {
            None => String::new(),
            Some(total) if total > self.to => format!(", not {asked}"),
            Some(_) => ", but by too few meshes".to_string(),
        };
        match self.result.verdict {
            Verdict::Known => format!("{so_far}: {here} is fine enough for {asked}"),
            Verdict::Warned => format!(
                "{so_far} on the meshes as they are, but a warning below is never to be ignored: follow it, then repeat the study"
            ),
            Verdict::Singular => {
                let growth = self.change(self.result.steps.len() - 1).unwrap_or_default();
                let place =
                    |peak: &LargestPressure| format!(" at {} on `{}`", units.point(peak.position), peak.boundary);
                let at = self.peak().map_or(String::new(), place);
                format!(
                    "no mesh will do: the pressure is singular{at}, it changed by {} with the last refinement; ask for \
                     the force (--for force), or give the edge its radius",
                    self.percent(growth)
                )
            }
            Verdict::NotConverged => {
                format!("{here} did not converge: {}; see stickslip run with this mesh", self.result.reason)
            }
            Verdict::Interrupted => format!("interrupted: {so_far}; the next study begins anew"),
            Verdict::RunLimit => format!("{so_far}{short}: {} runs are done (--max-runs)", self.result.steps.len()),
            Verdict::TimeLimit => match self.result.predicted {
                Some(next) => format!("{so_far}{short}: the next run would take about {next:.0} s more (--within)"),
                None => format!("{so_far}{short}: the time was over before the end of a run (--within)"),
            },
            Verdict::NoFinerMesh | Verdict::MemoryLimit => format!("{so_far}{short}: {}", self.result.reason),
        }
    }

    /// Returns the lines below the table, each with its label: the limit, the uncertainty, the verdict.
    pub fn lines(&self) -> Vec<(&'static str, String)> {
        let percent = |share: f64| self.percent(share);
        let mut lines = Vec::new();
        if let Some(errors) = self.result.errors.as_ref().filter(|_| self.has_limit())
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
        let own = self.own_mesh();
        lines.extend(own.as_ref().map(|(mesh, error)| {
            let verdict = if *error <= self.to { "fine enough" } else { "too coarse" };
            ("", format!("the scene's own mesh {mesh} is {verdict}: {} off", percent(*error)))
        }));
        let meshes = self.meshes();
        // A coarser mesh may be accurate by chance.
        let enough = meshes.iter().rev().take_while(|(step, error)| step.is_resolved && *error <= self.to).last();
        let last = meshes.last().map(|(step, _)| step.level);
        let other = enough.filter(|(step, _)| Some(step.level) != last && !step.is_own_mesh);
        lines.extend(other.map(|(step, error)| {
            ("", format!("the coarsest mesh that is fine enough is {}: {} off", step.mesh, percent(*error)))
        }));
        let slips = Some(("", format!("the last run ended early: {}", self.last.explanation.reason)));
        lines.extend(slips.filter(|_| self.last.status == Status::Slips));
        let warning = |warning: &Warning| ("warning", format!("{}: {}", warning.kind.name, warning.message));
        lines.extend(self.last.warnings.iter().map(warning));
        lines
    }

    /// Returns the name and the error of the scene's own mesh.
    fn own_mesh(&self) -> Option<(String, f64)> {
        let mut meshes = self.meshes().into_iter();
        meshes.find_map(|(step, error)| (step.is_own_mesh && step.is_resolved).then(|| (step.mesh.clone(), error)))
    }

    /// Returns the meshes with known errors, as shares of the extrapolated value.
    fn meshes(&self) -> Vec<(&Step, f64)> {
        let trusted = self.has_limit() && self.result.verdict != Verdict::Warned;
        let Some(limit) = self.result.errors.as_ref().filter(|_| trusted).and_then(|errors| errors.mesh) else {
            return Vec::new();
        };
        let Series { steps, values, .. } = series(&self.result.steps, true, false);
        let error = |value: &f64| (value / limit.extrapolated - 1.0).abs();
        // Without a limit the value of the last mesh is the extrapolated one, which says nothing of its error.
        let is_estimated =
            |k: &usize| matches!(limit.behaviour, Behaviour::Monotone | Behaviour::Constant) || Some(k) != steps.last();
        let all = steps.iter().zip(&values).filter(|(k, value)| error(value).is_finite() && is_estimated(k));
        all.map(|(k, value)| (&self.result.steps[*k], error(value))).collect()
    }

    /// Returns the name of the quantity with its unit.
    pub(super) fn head(&self) -> String {
        labelled(&self.sought.name(), &self.sought.unit(&self.units_for_people()))
    }

    pub(super) fn units_for_people(&self) -> UnitSystem {
        self.sought.units_for_people(self.last.units)
    }

    /// Returns the change of the value by run `k`, as a share.
    fn change(&self, k: usize) -> Option<f64> {
        let [before, after] =
            [self.result.steps.get(k.checked_sub(1)?)?, self.result.steps.get(k)?].map(|step| step.value);
        Some(after? / before? - 1.0).filter(|change| change.is_finite())
    }
}
