//! Formats a comparison as text tables.

use super::{Told, fields, resultants, told};
use crate::compare::{Comparison, MeshChoice, MeshErrors, MeshResult, Phases};
use std::fmt::Write;
use stickslip::base::Quantity;
use stickslip::solver::history::Status;
use stickslip_output::Table;

/// Formats all tables except the answers, for runs on the given `meshes` only.
pub(super) fn tables(comparison: &Comparison, meshes: &[MeshResult]) -> String {
    let mut text = String::new();
    for result in meshes {
        let MeshResult { mesh, displacements, contacts, increments, status, seconds, .. } = result;
        let reference = match increments {
            0 => "the exact path".to_string(),
            increments => format!("{increments} increments"),
        };
        // Writing to a string cannot fail.
        let _ = writeln!(
            text,
            "{mesh}: {displacements} displacements, {contacts} contact nodes; reference: {reference}, \
             {status}, {seconds:.2} s\n{}",
            runs_table(comparison, mesh)
        );
    }
    text + "* no other run is better in time and in the error of the forces; times but CPU are wall times, s\n\n"
        + &format!("{}\n{}", meshes_table(comparison), estimates_table(comparison))
}

const RUN_HEADS: [&str; 18] = [
    "path", "inc", "iter", "fact", "CPU, s", "wall", "set-up", "assembly", "factor", "solve", "rest", "entries", "MB",
    "p_n", "p_t", "forces", "work", "",
];

fn runs_table(comparison: &Comparison, mesh: &MeshChoice) -> Table {
    let mut table = Table::new(&RUN_HEADS);
    let front = comparison.front(mesh);
    for run in comparison.on(mesh) {
        let Phases { model, analysis, assembly, factorization, solve, rest, wall, cpu } = run.seconds;
        let mut row = vec![run.path.to_string(), run.increments.to_string(), run.iterations.to_string()];
        row.push(run.factorizations.to_string());
        row.extend([cpu, wall, model + analysis, assembly, factorization, solve, rest].map(|s| format!("{s:.3}")));
        row.push(run.factor_entries.to_string());
        let megabytes = run.factor_peak_bytes * 1e-6;
        row.push(if megabytes > 0.0 { format!("{megabytes:.1}") } else { "-".into() });
        let errors = run.errors.map(|errors| [errors.p_n, errors.p_t, errors.forces, errors.work]);
        row.extend(errors.unwrap_or([f64::NAN; 4]).map(|error| shown(error, comparison.tolerance)));
        row.push(match run.status {
            Status::Converged if front.contains(&run) => "*".into(),
            Status::Converged => String::new(),
            status => format!("{status} in increment {}", run.converged + 1),
        });
        table.push(row);
    }
    table
}

/// Formats an error with two digits, or as below the tolerance.
fn shown(error: f64, tolerance: f64) -> String {
    match error {
        _ if error.is_nan() => "-".into(),
        _ if error < tolerance => format!("<{tolerance:.0e}"),
        _ => format!("{error:.1e}"),
    }
}

fn meshes_table(comparison: &Comparison) -> Table {
    // Plane problems have no p_o.
    let in_space = comparison.meshes.iter().any(|result| result.end.p_o.iter().any(|p_o| *p_o != 0.0));
    let sums = ["sum p_n", "sum p_t", "sum p_o"].map(|sum| (sum, Quantity::Force));
    let energies = ["energy", "friction work"].map(|energy| (energy, Quantity::Energy));
    let resultants_told = sums.into_iter().take(if in_space { 3 } else { 2 }).chain(energies);
    let with_units = resultants_told.map(|(head, quantity)| format!("{head}, {}", comparison.units.name(quantity)));
    let counts = heads_of_mesh(comparison).into_iter().chain(["n_u", "n_c"]).map(String::from);
    let errors = ["d sum p_n", "d sum p_t", "d energy", "d tractions"].map(String::from);
    let heads: Vec<String> = counts.chain(with_units).chain(errors).collect();
    let mut table = Table::new(&heads.iter().map(String::as_str).collect::<Vec<_>>());
    for result in &comparison.meshes {
        let [p_n, p_t, p_o, energy, work] = resultants(result, &comparison.units);
        let mut row = fields_of_mesh(comparison, &result.mesh);
        row.extend([result.displacements, result.contacts].map(|count| count.to_string()));
        let numbers = [p_n, p_t].into_iter().chain(in_space.then_some(p_o)).chain([energy, work]);
        row.extend(numbers.map(|number| format!("{number:.6e}")));
        let errors = result.errors.map(|errors| [errors.sum_p_n, errors.sum_p_t, errors.energy, errors.tractions]);
        row.extend(errors.unwrap_or([f64::NAN; 4]).map(|error| shown(error, comparison.tolerance)));
        table.push(row);
    }
    table
}

/// Returns the errors of the meshes beside the estimates of each mesh alone.
fn estimates_table(comparison: &Comparison) -> Table {
    let heads = ["n_u", "CPU, s", "d peak", "estimated", "across", "d norm", "estimated", "d sum p_n", "locking"];
    let mut table = Table::new(&heads_of_mesh(comparison).into_iter().chain(heads).collect::<Vec<_>>());
    for result in &comparison.meshes {
        let Told { seconds, across, peak, norm, locking } = told(comparison, result);
        let error =
            |of: fn(&MeshErrors) -> f64| shown(result.errors.as_ref().map_or(f64::NAN, of), comparison.tolerance);
        let estimate = |share| shown(share, comparison.tolerance);
        let mut row = fields_of_mesh(comparison, &result.mesh);
        row.push(result.displacements.to_string());
        row.push(seconds.map_or("-".into(), |seconds| format!("{seconds:.3}")));
        row.extend([error(|errors| errors.peak), estimate(peak)]);
        row.push(across.map_or("-".into(), |across| across.to_string()));
        row.extend([error(MeshErrors::norm), estimate(norm), error(|errors| errors.sum_p_n), estimate(locking)]);
        table.push(row);
    }
    table
}

/// Returns the headings of the mesh columns, with one for elements if these were chosen.
fn heads_of_mesh(comparison: &Comparison) -> Vec<&'static str> {
    if comparison.elements() == [None] { vec!["mesh"] } else { vec!["elements", "mesh"] }
}

fn fields_of_mesh(comparison: &Comparison, mesh: &MeshChoice) -> Vec<String> {
    let [elements, size] = fields(mesh);
    if comparison.elements() == [None] { vec![size] } else { vec![elements, size] }
}
