//! Writes a comparison as comma-separated values.

use crate::compare::{Comparison, MeshResult, Phases, SolverPath, Trial};
use stickslip::run::report::csv_table;

use super::{Told, fields, resultants, told};

/// The columns that identify a run: [`named_path`].
pub(super) const OF_RUN: [&str; 6] = ["method", "setting", "solver", "elements", "mesh", "increments"];

/// The columns of the results of a run.
const RUN_COLUMNS: [&str; 23] = [
    "status",
    "converged",
    "iterations",
    "factorizations",
    "cpu_seconds",
    "wall_seconds",
    "model_seconds",
    "analysis_seconds",
    "assembly_seconds",
    "factor_seconds",
    "solve_seconds",
    "rest_seconds",
    "factor_entries",
    "factor_peak_bytes",
    "kkt_error",
    "error_p_n",
    "error_p_t",
    "error_forces",
    "error_work",
    "front",
    "blas",
    "blas_kernel",
    "blas_threads",
];

pub(super) fn runs(comparison: &Comparison) -> String {
    let blas = comparison.blas.as_ref().map_or_else(Default::default, |blas| {
        let version = blas.version.iter().map(|version| format!(" {version}"));
        let threads = blas.threads.map_or(String::new(), |threads| threads.to_string());
        [
            version.fold(blas.library.to_string(), |name, version| name + &version),
            blas.kernel.clone().unwrap_or_default(),
            threads,
        ]
    });
    let row = |run: &Trial| {
        let mut row = named_path(run);
        row.extend([run.status.to_string(), run.converged.to_string()]);
        row.extend([run.iterations, run.factorizations].map(|count| count.to_string()));
        let Phases { model, analysis, assembly, factorization, solve, rest, wall, cpu } = run.seconds;
        row.extend([cpu, wall, model, analysis, assembly, factorization, solve, rest].map(|s| format!("{s:.6}")));
        row.extend([
            run.factor_entries.to_string(),
            format!("{:.0}", run.factor_peak_bytes),
            format!("{:.2e}", run.kkt),
        ]);
        let errors = run.errors.map(|errors| [errors.p_n, errors.p_t, errors.forces, errors.work]);
        row.extend(numbers(errors));
        row.push(comparison.front(&run.mesh).contains(&run).to_string());
        row.extend(blas.clone());
        row
    };
    csv_table(&[&OF_RUN[..], &RUN_COLUMNS].concat(), comparison.runs.iter().map(row))
}

fn named_path(run: &Trial) -> Vec<String> {
    let SolverPath { method, linear } = run.path;
    let names = [method.name().to_string(), method.setting().to_string(), linear.to_string()];
    names.into_iter().chain(fields(&run.mesh)).chain([run.increments.to_string()]).collect()
}

/// Returns the fields of `numbers`, empty if unknown.
fn numbers<const N: usize>(numbers: Option<[f64; N]>) -> [String; N] {
    numbers.unwrap_or([f64::NAN; N]).map(|number| if number.is_nan() { String::new() } else { format!("{number:.4e}") })
}

pub(super) fn iterations(comparison: &Comparison) -> String {
    let header = [&OF_RUN[..], &["increment", "iteration", "seconds", "theta", "error"]].concat();
    let rows = comparison.runs.iter().flat_map(|run| {
        run.iterates.iter().map(|iterate| {
            let mut row = named_path(run);
            row.extend([iterate.increment, iterate.iteration].map(|number| number.to_string()));
            row.extend([format!("{:.6}", iterate.seconds), format!("{:.4e}", iterate.theta)]);
            row.extend(numbers(iterate.error.map(|error| [error])));
            row
        })
    });
    csv_table(&header, rows)
}

pub(super) fn meshes(comparison: &Comparison) -> String {
    let header = [
        "elements",
        "mesh",
        "displacements",
        "contacts",
        "increments",
        "status",
        "sum_p_n",
        "sum_p_t",
        "sum_p_o",
        "energy",
        "friction_work",
        "error_sum_p_n",
        "error_sum_p_t",
        "error_energy",
        "error_tractions",
        "error_peak",
        "cpu_seconds",
        "nodes_across",
        "estimated_peak_error",
        "estimated_energy_norm",
        "estimated_locking",
    ];
    let row = |result: &MeshResult| {
        let counts = [result.displacements, result.contacts, result.increments];
        let mut row = fields(&result.mesh).to_vec();
        row.extend(counts.map(|count| count.to_string()));
        row.push(result.status.to_string());
        row.extend(resultants(result, &comparison.units).map(|number| number.to_string()));
        let errors =
            result.errors.map(|errors| [errors.sum_p_n, errors.sum_p_t, errors.energy, errors.tractions, errors.peak]);
        row.extend(numbers(errors));
        let Told { seconds, across, peak, norm, locking } = told(comparison, result);
        row.push(seconds.map_or(String::new(), |seconds| format!("{seconds:.6}")));
        row.push(across.map_or(String::new(), |across| across.to_string()));
        row.extend(numbers(Some([peak, norm, locking])));
        row
    };
    csv_table(&header, comparison.meshes.iter().map(row))
}
