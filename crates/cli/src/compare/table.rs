//! The tables of a comparison.

use super::{Comparison, Course, MeshChoice, MeshErrors, MeshResult, MeshSize, SolverPath, TimeErrors, Trial};
use crate::study::{Record, csv, labelled, record};
use serde::Serialize;
use serde_json::{Value, json};
use stickslip::base::Quantity;
use stickslip::run::report::Estimates;
use stickslip_output::Table;

/// Formats the numbers of the files.
fn number(key: &str, x: f64) -> String {
    match key {
        _ if key.ends_with("seconds") => format!("{x:.6}"),
        "factor_peak_bytes" => format!("{x:.0}"),
        "kkt_error" => format!("{x:.2e}"),
        "sum_p_n" | "sum_p_t" | "sum_p_o" | "energy" | "friction_work" => x.to_string(),
        _ => format!("{x:.4e}"),
    }
}

/// Returns the fields of `values` with their names in `pattern`, in place of the star.
fn named(pattern: &str, values: &impl Serialize) -> impl Iterator<Item = (String, Value)> {
    record(json!(values)).into_iter().map(move |(key, value)| (pattern.replace('*', &key), value))
}

/// Returns the names of a mesh: its elements if they were chosen, and its size.
fn of_mesh(mesh: &MeshChoice) -> Record {
    let size = match &mesh.size {
        MeshSize::Elements(n) => n.to_string(),
        size => MeshChoice::from(size.clone()).to_string(),
    };
    record(json!({ "elements": mesh.elements.map(|elements| elements.to_string()), "mesh": size }))
}

/// Returns what identifies a run.
fn of_run(run: &Trial) -> Record {
    let SolverPath { method, .. } = run.path;
    let path = json!({ "method": method.name(), "setting": method.setting(), "solver": run.path.solver_name() });
    let increments = ("increments".to_string(), run.increments.into());
    record(path).into_iter().chain(of_mesh(&run.mesh)).chain([increments]).collect()
}

/// Formats a cell of a text table: errors with two digits, or as below the tolerance.
fn cell(key: &str, value: &Value, tolerance: f64) -> String {
    match (value, value.as_f64()) {
        (Value::Null, _) => "-".to_string(),
        (Value::Bool(is_in_front), _) => if *is_in_front { "*" } else { "" }.to_string(),
        (Value::Number(number), Some(x)) if number.is_f64() => match key {
            _ if key.ends_with("seconds") => format!("{x:.3}"),
            _ if !key.contains("error_") && !key.contains("estimated_") => format!("{x:.6e}"),
            _ if x < tolerance => format!("<{tolerance:.0e}"),
            _ => format!("{x:.1e}"),
        },
        (Value::String(text), _) => text.clone(),
        (value, _) => value.to_string(),
    }
}

/// The columns of the text table of runs: heads and keys.
const OF_RUNS: [(&str, &str); 11] = [
    ("method", "method"),
    ("setting", "setting"),
    ("solver", "solver"),
    ("inc", "increments"),
    ("verdict", "status"),
    ("done", "converged"),
    ("iter", "iterations"),
    ("CPU, s", "cpu_seconds"),
    ("forces", "error_forces"),
    ("work", "error_work"),
    ("", "front"),
];

impl Comparison {
    /// Returns the runs as comma-separated values.
    pub fn runs_csv(&self) -> String {
        csv(&self.runs.iter().map(|run| self.run(run)).collect::<Vec<_>>(), number)
    }

    fn run(&self, run: &Trial) -> Record {
        let blas = self.blas.as_ref();
        let names = blas.map(|blas| [Some(blas.library), blas.version.as_deref()]);
        let mut row = of_run(run);
        let Course { status, seconds, factor_entries, factor_peak_bytes, kkt, .. } = &run.course;
        row.extend(record(json!({
            "status": status.to_string(),
            "converged": run.course.converged,
            "iterations": run.course.iterations,
            "factorizations": run.course.factorizations,
        })));
        row.extend(named("*_seconds", seconds));
        row.extend(record(json!({
            "factor_entries": factor_entries,
            "factor_peak_bytes": factor_peak_bytes,
            "kkt_error": kkt,
        })));
        row.extend(named("error_*", &run.errors.unwrap_or(TimeErrors::UNKNOWN)));
        row.extend(record(json!({
            // A run of an exact path has no number of the merit, and so is not equal to itself.
            "front": self.front(&run.mesh).iter().any(|other| std::ptr::eq(*other, run)),
            "blas": names.map(|names| names.into_iter().flatten().collect::<Vec<_>>().join(" ")),
            "blas_kernel": blas.and_then(|blas| blas.kernel.as_ref()),
            "blas_threads": blas.and_then(|blas| blas.threads),
        })));
        row
    }

    /// Returns the iterations of the runs as comma-separated values.
    pub fn iterations_csv(&self) -> String {
        let of = |run: &Trial| {
            run.course.iterates.iter().map(|iterate| [of_run(run), record(json!(iterate))].concat()).collect()
        };
        csv(&self.runs.iter().map(of).collect::<Vec<Vec<_>>>().concat(), number)
    }

    /// Returns the meshes as comma-separated values, in the units of the scene.
    pub fn meshes_csv(&self) -> String {
        csv(&self.meshes.iter().map(|result| self.mesh(result)).collect::<Vec<_>>(), number)
    }

    fn mesh(&self, result: &MeshResult) -> Record {
        let (end, estimates) = (&result.end, result.estimates.as_ref());
        // + 0.0 because the sum of no forces is -0.
        let sum = |forces: &[f64]| self.units.of_si(Quantity::Force, forces.iter().sum::<f64>() + 0.0);
        let energy = |energy: f64| self.units.of_si(Quantity::Energy, energy);
        let share = |of: fn(&Estimates) -> Option<f64>| estimates.and_then(of);
        let mut row = of_mesh(&result.mesh);
        row.extend(record(json!({
            "displacements": result.displacements,
            "contacts": result.contacts,
            "increments": result.increments,
            "status": result.status.to_string(),
            "sum_p_n": sum(&end.p_n),
            "sum_p_t": sum(&end.p_t),
            "sum_p_o": sum(&end.p_o),
            "energy": energy(end.energy),
            "friction_work": energy(end.work),
        })));
        row.extend(named("error_*", &result.errors.unwrap_or(MeshErrors::UNKNOWN)));
        row.extend(record(json!({
            "cpu_seconds": self.seconds(&result.mesh),
            "nodes_across": estimates.and_then(|estimates| estimates.heaviest()?.nodes_across),
            "estimated_peak_error": share(|estimates| estimates.peak_error),
            "estimated_energy_norm": share(|estimates| estimates.discretisation),
            "estimated_locking": share(|estimates| estimates.locking),
        })));
        row
    }

    /// Formats columns of `rows` as a text table.
    fn table(&self, columns: &[(&str, &str)], rows: impl Iterator<Item = Record>) -> String {
        let mut table = Table::new(&columns.iter().map(|(head, _)| *head).collect::<Vec<_>>());
        for row in rows {
            let value = |key: &str| row.iter().find(|(other, _)| other == key).map_or(&Value::Null, |(_, value)| value);
            table.push(columns.iter().map(|(_, key)| cell(key, value(key), self.tolerance)).collect());
        }
        table.to_string()
    }

    /// Formats the runs on `meshes`, and what is known of all meshes, as text.
    pub fn to_text(&self, meshes: &[MeshResult]) -> String {
        let of_runs = |result: &MeshResult| {
            let MeshResult { mesh, displacements, contacts, increments, not_exact, status, seconds, .. } = result;
            let reference = match increments {
                0 => "the exact path".to_string(),
                increments => format!("{increments} increments ({not_exact})"),
            };
            format!(
                "{mesh}: {displacements} displacements, {contacts} contact nodes; reference: {reference}, {status}, \
                 {seconds:.2} s\n{}\n",
                self.table(&OF_RUNS, self.on(mesh).map(|run| self.run(run)))
            )
        };
        let names = if self.elements() == [None] {
            &[("mesh", "mesh")][..]
        } else {
            &[("elements", "elements"), ("mesh", "mesh")]
        };
        let with_unit = |(head, quantity)| labelled(head, &self.units.name(quantity));
        let [p_n, p_t, p_o] = ["sum p_n", "sum p_t", "sum p_o"].map(|head| with_unit((head, Quantity::Force)));
        let [energy, work] = ["energy", "friction work"].map(|head| with_unit((head, Quantity::Energy)));
        // Plane problems have no p_o.
        let in_space = self.meshes.iter().any(|result| result.end.p_o.iter().any(|p_o| *p_o != 0.0));
        let sums = [("n_u", "displacements"), ("n_c", "contacts"), (&p_n, "sum_p_n"), (&p_t, "sum_p_t")];
        let sums = sums.into_iter().chain(in_space.then_some((p_o.as_str(), "sum_p_o")));
        let sums: Vec<_> = sums.chain([(energy.as_str(), "energy"), (&work, "friction_work")]).collect();
        let errors = [
            ("CPU, s", "cpu_seconds"),
            ("d sum p_n", "error_sum_p_n"),
            ("d tractions", "error_tractions"),
            ("d norm", "error_norm"),
            ("estimated", "estimated_energy_norm"),
            ("d peak", "error_peak"),
            ("estimated", "estimated_peak_error"),
            ("across", "nodes_across"),
            ("locking", "estimated_locking"),
        ];
        let with_norm = |result: &MeshResult| {
            let norm = ("error_norm".to_string(), json!(result.errors.as_ref().map(MeshErrors::norm)));
            [self.mesh(result), vec![norm]].concat()
        };
        let of_meshes = [&sums[..], &errors]
            .map(|columns| self.table(&[names, columns].concat(), self.meshes.iter().map(with_norm)));
        let of_runs: String = meshes.iter().map(of_runs).collect();
        format!("{of_runs}* no other run is better in time and in the error of the forces\n\n{}", of_meshes.join("\n"))
    }
}
