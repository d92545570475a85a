//! What the benchmarks share: the scenes, the naive caller to compare with, and children.
#![allow(dead_code, clippy::unwrap_used, clippy::print_stdout)]

pub mod growth;
pub mod run;

use std::fmt::Display;
use std::path::Path;
use std::process::Command;
use std::str::FromStr;
use std::sync::Arc;
use stickslip::algebra::linear::process::{Blas, KERNEL_VARIABLE};
use stickslip::algebra::linear::{self, FactorInfo, LinearError, LinearSolver, Strategy, Umfpack};
use stickslip::algebra::{Csc, Pattern};
use stickslip::body::Model;
use stickslip::run::discretise;
use stickslip::scene::Scene;
use stickslip_output::Table;

/// The paper's block with n × n elements, mu = 0.4.
pub fn block(n: usize, increments: usize) -> (Scene, Model) {
    scene("block.toml", &[format!("mesh.elements=[{n},{n}]"), format!("time.increments={increments}")])
}

/// A scene of this project with overrides.
pub fn scene(name: &str, overrides: &[String]) -> (Scene, Model) {
    let path = Path::new(concat!(env!("CARGO_MANIFEST_DIR"), "/..")).join("data/scenes").join(name);
    let overrides: Vec<_> = overrides.iter().map(|text| text.parse().unwrap()).collect();
    let scene = Scene::read(&path, &overrides).unwrap();
    let model = discretise(&scene).unwrap();
    (scene, model)
}

/// The value after `name` on the command line.
pub fn option(args: &[String], name: &str) -> Option<String> {
    args.iter().skip_while(|arg| *arg != name).nth(1).cloned()
}

/// Rows of a table that is printed for people, or with `--csv` for a script.
pub struct Rows {
    heads: Vec<String>,
    rows: Vec<Vec<String>>,
}

impl Rows {
    pub fn new(heads: &[&str]) -> Self {
        Rows { heads: heads.iter().map(|head| (*head).to_string()).collect(), rows: Vec::new() }
    }

    pub fn push(&mut self, row: Vec<String>) {
        self.rows.push(row);
    }

    pub fn print(self, caption: &str, args: &[String]) {
        if args.iter().any(|arg| arg == "--csv") {
            [self.heads].iter().chain(&self.rows).for_each(|row| println!("{}", row.join(",")));
            return;
        }
        let mut table = Table::new(&self.heads.iter().map(String::as_str).collect::<Vec<_>>());
        self.rows.into_iter().for_each(|row| table.push(row));
        println!("\n{caption}; {}\n\n{table}", blas());
    }
}

/// The BLAS behind every number. All is measured with one thread of it.
pub fn blas() -> String {
    linear::process::set_blas_threads(1);
    let blas = Blas::loaded().unwrap();
    let better = blas.better_kernel.map_or(String::new(), |name| format!(" (slow: set {KERNEL_VARIABLE}={name})"));
    blas.with_threads() + &better
}

/// Who is measured.
#[derive(Clone, Copy, PartialEq, Eq)]
pub enum Who {
    /// The library as it is.
    Ours,
    /// Somebody who has only read UMFPACK's quick start: newtons and metres, a pattern without
    /// zeros, every default, a symbolic analysis for each matrix.
    Naive,
}

/// Runs `measure` for each size after `--` on the command line (or `all`) and each of the two, every
/// one in a process of its own, so that memory and allocator settings are its own, too; hands the
/// numbers to `report`. One BLAS thread.
pub fn compare<Size: Copy + Display + FromStr, const N: usize>(
    all: &[Size],
    measure: impl Fn(Size, Who) -> [f64; N],
    mut report: impl FnMut(Size, [f64; N], [f64; N]),
) {
    let name = |who| if who == Who::Ours { "ours" } else { "naive" };
    let args: Vec<String> = std::env::args().collect();
    let sizes: Vec<Size> = args.iter().filter_map(|arg| arg.parse().ok()).collect();
    for who in [Who::Ours, Who::Naive] {
        if args.iter().any(|arg| arg == name(who)) {
            linear::process::set_blas_threads(1);
            let numbers = measure(sizes[0], who).map(|number| number.to_string());
            println!("{}", numbers.join(" "));
            return;
        }
    }
    for &n in if sizes.is_empty() { all } else { &sizes } {
        let [ours, naive] = [Who::Ours, Who::Naive].map(|who| {
            let child = Command::new(&args[0]).args([name(who), &n.to_string()]).output().unwrap();
            assert!(child.status.success(), "{}", String::from_utf8_lossy(&child.stderr));
            let numbers = String::from_utf8(child.stdout).unwrap();
            let numbers: Vec<f64> = numbers.split_whitespace().map(|number| number.parse().unwrap()).collect();
            numbers.try_into().unwrap()
        });
        report(n, ours, naive);
    }
}

/// The naive caller's linear algebra.
#[derive(Default)]
pub struct Naive {
    pattern: Option<Arc<Pattern>>,
    umfpack: Option<Umfpack>,
}

impl LinearSolver for Naive {
    fn name(&self) -> &'static str {
        "naive"
    }

    fn analyze(&mut self, pattern: &Arc<Pattern>) -> Result<(), LinearError> {
        self.pattern = Some(Arc::clone(pattern));
        Ok(())
    }

    fn factorize(&mut self, values: &[f64]) -> Result<FactorInfo, LinearError> {
        let pattern = self.pattern.clone().ok_or(LinearError::Order { missing: "analyze" })?;
        let (pruned, values) = prune(&Csc::new(pattern, values.to_vec()).map_err(|_| LinearError::PatternChanged)?);
        self.umfpack = None;
        let mut umfpack = Umfpack::new(Strategy::Automatic);
        umfpack.analyze_with(&pruned, Some(&values))?;
        let info = umfpack.factorize(&values)?;
        self.umfpack = Some(umfpack);
        Ok(info)
    }

    fn solve(&mut self, b: &[f64], x: &mut [f64]) -> Result<(), LinearError> {
        self.umfpack.as_mut().ok_or(LinearError::Order { missing: "factorize" })?.solve(b, x)
    }
}

/// The matrix without its explicit zeros.
pub fn prune(a: &Csc) -> (Arc<Pattern>, Vec<f64>) {
    let pattern = Pattern::from_entries(a.pattern().rows(), a.pattern().columns(), |take| {
        a.entries().filter(|&(_, _, value)| value != 0.0).for_each(|(i, j, _)| take(i, j));
    })
    .unwrap();
    let values = a.values().iter().copied().filter(|&value| value != 0.0).collect();
    (Arc::new(pattern), values)
}
