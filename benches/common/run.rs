//! A whole run of the block or of a strip in a process of its own, so that CPU time and memory are its own.

use std::process::Command;

use stickslip::auto::Choice;
use stickslip::history::{self, HistorySettings, Observer, Status};
use stickslip::linear::{self, Direct};
use stickslip::report::{available_bytes, cpu_seconds, peak_rss_bytes};
use stickslip::scene::LinearBackend;
use stickslip::units::Scaling;

use super::{Naive, scene};

/// What is run.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Case {
    /// Elements along and across the contact. Squares have the side 1 m, strips elements of 1 m × 1 m.
    pub elements: [usize; 2],
    /// In all.
    pub increments: usize,
}

/// Who does the linear algebra: `umfpack`, `faer`, `condensed`, `auto`, or `naive`, see [`super::Who`].
pub type Who = &'static str;

/// What was measured.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Measured {
    /// CPU of the process, s: from the scene on, no files written.
    pub cpu: f64,
    /// Of that, in the history: its set-up, factorisations, solves, the error measure.
    pub history: f64,
    pub unknowns: f64,
    pub iterations: f64,
    pub factorizations: f64,
    /// Entries of the factors.
    pub entries: f64,
    /// Operations of the last factorisation; 0 if they are not told.
    pub flops: f64,
    /// Peak resident memory, MB.
    pub megabytes: f64,
    pub backward_error: f64,
    /// Increments that converged.
    pub converged: f64,
    /// 1 if the body was condensed.
    pub condensed: f64,
}

/// Runs `case` in a child.
pub fn measure(case: Case, who: Who) -> Measured {
    let exe = std::env::current_exe().unwrap();
    let [along, across] = case.elements;
    let args = ["child", who, &format!("{along}x{across}"), &case.increments.to_string()];
    let child = Command::new(exe).args(args).output().unwrap();
    assert!(child.status.success(), "{case:?} {who}: {}", String::from_utf8_lossy(&child.stderr));
    let numbers = String::from_utf8(child.stdout).unwrap();
    let numbers: Vec<f64> = numbers.split_whitespace().map(|number| number.parse().unwrap()).collect();
    let numbers: [f64; 11] = numbers.try_into().unwrap();
    let [
        cpu,
        history,
        unknowns,
        iterations,
        factorizations,
        entries,
        flops,
        megabytes,
        backward_error,
        converged,
        condensed,
    ] = numbers;
    Measured {
        cpu,
        history,
        unknowns,
        iterations,
        factorizations,
        entries,
        flops,
        megabytes,
        backward_error,
        converged,
        condensed,
    }
}

/// If this process is a child: runs what it is told to, prints the numbers, and tells so.
pub fn is_child(setting: fn(&stickslip::problem::ContactProblem, Scaling, usize, f64) -> HistorySettings) -> bool {
    let args: Vec<String> = std::env::args().collect();
    let [_, child, who, mesh, increments, ..] = &args[..] else { return false };
    if child != "child" {
        return false;
    }
    linear::process::set_blas_threads(1);
    let case = Case { elements: elements(mesh).unwrap(), increments: increments.parse().unwrap() };
    let numbers = run(case, who, setting).map(|number| number.to_string());
    println!("{}", numbers.join(" "));
    true
}

/// `100x100`, or `100` for a square.
pub fn elements(text: &str) -> Option<[usize; 2]> {
    let (along, across) = text.split_once('x').unwrap_or((text, text));
    Some([along.parse().ok()?, across.parse().ok()?])
}

/// Keeps freed memory once the factors have their size, as the command line does.
struct KeepMemory;

impl Observer for KeepMemory {
    fn ready(&mut self) {
        linear::process::keep_freed_memory();
    }
}

fn run(
    case: Case,
    who: &str,
    setting: fn(&stickslip::problem::ContactProblem, Scaling, usize, f64) -> HistorySettings,
) -> [f64; 11] {
    let [along, across] = case.elements;
    let size = if along == across { [1, 1] } else { [along, across] };
    let linear = if who == "naive" { "umfpack" } else { who };
    let (scene, model) = scene(&[
        format!("mesh.elements=[{along},{across}]"),
        format!("mesh.size=[{},{}]", size[0], size[1]),
        format!("time.increments={}", case.increments),
        format!("solver.linear=\"{linear}\""),
    ]);
    let before = cpu_seconds();
    // In newtons and metres the tolerance of the scene is out of reach at fine meshes: what the naive caller
    // reaches is taken, the comparison is of time.
    let (scaling, mut linear, tolerance, condensed) = if who == "naive" {
        (Scaling::SI, Direct::new(Box::new(Naive::default())), 1e-3, false)
    } else {
        let backend = Choice::new(&scene, &model, available_bytes()).unwrap().backend;
        let condensed = backend == LinearBackend::Condensed;
        (model.scaling(), model.linear(backend), scene.solver.tolerance, condensed)
    };
    let settings = setting(&model.problem, scaling, scene.solver.max_iterations, tolerance);
    let times = scene.time.all();
    let outcome =
        history::run(&model.problem, &model.loading, &times, &settings, &mut linear, &mut KeepMemory).unwrap();
    let cpu = cpu_seconds();
    // The naive caller may give up on the way.
    assert!(who == "naive" || outcome.status == Status::Converged, "{case:?} {who}: {:?}", outcome.status);
    let factor = outcome.linear.factor;
    [
        cpu,
        cpu - before,
        outcome.layout.unknowns() as f64,
        outcome.records.iter().map(|record| record.iterations).sum::<usize>() as f64,
        outcome.linear.factorizations as f64,
        factor.entries as f64,
        factor.flops,
        peak_rss_bytes().unwrap_or(0) as f64 * 1e-6,
        outcome.linear.worst_backward_error,
        outcome.records.iter().filter(|record| record.status == Status::Converged).count() as f64,
        f64::from(u8::from(condensed)),
    ]
}
