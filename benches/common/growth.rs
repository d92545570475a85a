//! How a run grows with the mesh: a row for each size and the exponents of the growth, path by path.

use stickslip::solver::history::Method;

use super::run::{Case, Elements, Measured, is_child, measure};
use super::{Rows, option};

/// What grows, and how it is written.
type Column = (&'static str, fn(&Measured) -> f64, fn(f64) -> String);

const COLUMNS: [Column; 6] = [
    ("CPU s", |run| run.cpu, |value| format!("{value:.3}")),
    ("history s", |run| run.history, |value| format!("{value:.3}")),
    ("ms/iteration", |run| 1e3 * run.history / run.iterations as f64, |value| format!("{value:.2}")),
    ("entries", |run| run.entries as f64, |value| format!("{value:.2e}")),
    ("flops", |run| run.flops, |value| if value == 0.0 { "-".to_string() } else { format!("{value:.2e}") }),
    ("MB", |run| run.megabytes, |value| format!("{value:.0}")),
];

/// A family of meshes.
pub struct Growth {
    /// Its member of size n.
    pub mesh: fn(usize) -> Elements,
    /// The sizes, unless the command line names some.
    pub sizes: &'static [usize],
    /// The increments, unless the command line tells.
    pub increments: usize,
    /// Who does the linear algebra.
    pub paths: &'static [&'static str],
    /// The exponents to expect.
    pub theory: &'static str,
}

impl Growth {
    /// Runs BN in the default setting on every path and every size, and prints the table.
    pub fn print(&self) {
        if is_child(Method::BN) {
            return;
        }
        let args: Vec<String> = std::env::args().skip(1).collect();
        let increments = option(&args, "--increments").map_or(self.increments, |n| n.parse().unwrap());
        let given = args.iter().take_while(|arg| *arg != "--increments").filter_map(|arg| arg.parse().ok());
        let mut sizes: Vec<usize> = given.collect();
        if sizes.is_empty() {
            sizes = self.sizes.to_vec();
        }
        let heads =
            ["path", "n", "unknowns", "iterations", "factored"].into_iter().chain(COLUMNS.map(|(head, ..)| head));
        let mut rows = Rows::new(&heads.chain(["backward error"]).collect::<Vec<_>>());
        for &path in self.paths {
            let case = |&n: &usize| Case { elements: (self.mesh)(n), increments };
            let runs: Vec<Measured> = sizes.iter().map(|n| measure(case(n), path)).collect();
            for (n, run) in sizes.iter().zip(&runs) {
                let mut row = vec![path.to_string(), n.to_string()];
                row.extend([run.unknowns, run.iterations, run.factorizations].map(|count| count.to_string()));
                row.extend(COLUMNS.map(|(_, value, write)| write(value(run))));
                row.push(format!("{:.1e}", run.backward_error));
                rows.push(row);
            }
            let fitted = COLUMNS.map(|(_, value, _)| exponent(&sizes, &runs.iter().map(value).collect::<Vec<_>>()));
            let mut row = [path, "exponent", "-", "-", "-"].map(str::to_string).to_vec();
            row.extend(fitted.map(|slope| slope.map_or("-".to_string(), |slope| format!("{slope:.2}"))));
            row.push("-".to_string());
            rows.push(row);
        }
        let caption = format!(
            "CPU, process by process, {increments} increments; flops: of the last factorisation; {}",
            self.theory
        );
        rows.print(&caption, &args);
    }
}

/// The least-squares slope of log `values` over log `sizes`.
fn exponent(sizes: &[usize], values: &[f64]) -> Option<f64> {
    if sizes.len() < 2 || values.iter().any(|&value| value <= 0.0) {
        return None;
    }
    let points: Vec<(f64, f64)> = sizes.iter().zip(values).map(|(&n, value)| ((n as f64).ln(), value.ln())).collect();
    let count = points.len() as f64;
    let (x, y) = points.iter().fold((0.0, 0.0), |(x, y), point| (x + point.0 / count, y + point.1 / count));
    let covariance: f64 = points.iter().map(|point| (point.0 - x) * (point.1 - y)).sum();
    Some(covariance / points.iter().map(|point| (point.0 - x).powi(2)).sum::<f64>())
}
