//! A whole run of the block, a strip, the cube or a plate in a process of its own, so that CPU time and memory are its
//! own.

use super::{Naive, scene};
use serde::{Deserialize, Serialize};
use std::fmt;
use std::process::Command;
use std::str::FromStr;
use stickslip::algebra::linear::{self, LinearSolver};
use stickslip::base::Scaling;
use stickslip::run::report::{cpu_seconds, peak_rss_bytes};
use stickslip::run::{AvailableSolvers, Choice};
use stickslip::solver::InitialWorkingSet;
use stickslip::solver::history::{self, HistorySettings, Method, Observer, Status, SystemSolver};

/// How many elements a body has.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub enum Elements {
    /// Along and across the contact. Squares have the side 1 m, strips elements of 1 m × 1 m.
    Plane([usize; 2]),
    /// Along x, along y and across the contact: equal cubes, 1 m along x.
    Solid([usize; 3]),
}

/// What is run.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct Case {
    pub elements: Elements,
    /// In all.
    pub increments: usize,
}

/// Who does the linear algebra: `umfpack`, `faer`, `condensed`, `auto`, or `naive`, see [`super::Who`].
pub type Who = &'static str;

/// What was measured.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct Measured {
    /// CPU of the process, s: from the scene on, no files written.
    pub cpu: f64,
    /// Of that, in the history: its set-up, factorisations, solves, the error measure.
    pub history: f64,
    pub unknowns: usize,
    pub iterations: usize,
    pub factorizations: usize,
    /// Entries of the factors.
    pub entries: usize,
    /// Operations of the last factorisation; 0 if they are not told.
    pub flops: f64,
    /// Peak resident memory, MB.
    pub megabytes: f64,
    pub backward_error: f64,
    /// Increments that converged.
    pub converged: usize,
    /// Whether the body was condensed.
    pub condensed: bool,
}

impl FromStr for Elements {
    type Err = String;

    /// `100` is a square, `1000x4` a strip, `16x16x4` a plate.
    fn from_str(text: &str) -> Result<Self, String> {
        let counts: Result<Vec<usize>, _> = text.split('x').map(str::parse).collect();
        match counts.as_deref() {
            Ok(&[n]) => Ok(Elements::Plane([n, n])),
            Ok(&[along, across]) => Ok(Elements::Plane([along, across])),
            Ok(&[along, aside, across]) => Ok(Elements::Solid([along, aside, across])),
            _ => Err(format!("{text} is no mesh")),
        }
    }
}

impl fmt::Display for Elements {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Elements::Plane([along, across]) => write!(f, "{along}x{across}"),
            Elements::Solid([along, aside, across]) => write!(f, "{along}x{aside}x{across}"),
        }
    }
}

impl Elements {
    /// The scene that is meshed, and the overrides that mesh it.
    pub fn meshed(self) -> (&'static str, [String; 2]) {
        let (scene, elements, size) = match self {
            Elements::Plane([n, across]) if n == across => ("block.toml", vec![n, n], vec![1.0, 1.0]),
            Elements::Plane(counts) => ("block.toml", counts.to_vec(), counts.map(|count| count as f64).to_vec()),
            Elements::Solid(counts) => {
                ("cube.toml", counts.to_vec(), counts.map(|count| count as f64 / counts[0] as f64).to_vec())
            }
        };
        (scene, [format!("mesh.elements={elements:?}"), format!("mesh.size={size:?}")])
    }
}

/// Runs `case` in a child.
pub fn measure(case: Case, who: Who) -> Measured {
    let exe = std::env::current_exe().unwrap();
    let child = Command::new(exe).args(["child", who, &serde_json::to_string(&case).unwrap()]).output().unwrap();
    assert!(child.status.success(), "{case:?} {who}: {}", String::from_utf8_lossy(&child.stderr));
    serde_json::from_slice(&child.stdout).unwrap()
}

/// If this process is a child: runs what it is told to, prints what it measured, and tells so.
pub fn is_child(method: Method) -> bool {
    let args: Vec<String> = std::env::args().collect();
    let [_, child, who, case] = &args[..] else { return false };
    if child != "child" {
        return false;
    }
    linear::process::set_blas_threads(1);
    let measured = run(serde_json::from_str(case).unwrap(), who, method);
    println!("{}", serde_json::to_string(&measured).unwrap());
    true
}

/// Keeps freed memory once the factors have their size, as the command line does.
struct KeepMemory;

impl Observer for KeepMemory {
    fn ready(&mut self) {
        linear::process::keep_freed_memory();
    }
}

fn run(case: Case, who: &str, method: Method) -> Measured {
    let linear = if who == "naive" { "umfpack" } else { who };
    let (name, [elements, size]) = case.elements.meshed();
    let increments = format!("time.increments={}", case.increments);
    let (scene, model) = scene(name, &[elements, size, increments, format!("solver.linear=\"{linear}\"")]);
    let before = cpu_seconds();
    // In newtons and metres the tolerance of the scene is out of reach at fine meshes: what the naive caller
    // reaches is taken, the comparison is of time.
    let naive = who == "naive";
    let tolerance = if naive { 1e-3 } else { scene.solver.tolerance };
    let problem = &model.problem;
    let choice =
        || Choice::by_size(problem, &InitialWorkingSet::default(), AvailableSolvers::of_process()).unwrap().linear;
    let system = match scene.solver.linear {
        _ if naive => SystemSolver::from(Box::new(Naive::default()) as Box<dyn LinearSolver>),
        linear => SystemSolver::from(linear.unwrap_or_else(choice)),
    };
    let condensed = system.condenses();
    let settings = HistorySettings::new(problem, &model.loading, method).unwrap();
    let mut settings = settings.until(scene.solver.max_iterations, tolerance);
    if naive {
        settings.scaling = Scaling::SI;
    }
    let times = scene.time.all();
    let outcome = history::run(&model.problem, &model.loading, &times, &settings, system, &mut KeepMemory).unwrap();
    let cpu = cpu_seconds();
    // The naive caller may give up on the way.
    assert!(who == "naive" || outcome.status == Status::Converged, "{case:?} {who}: {:?}", outcome.status);
    let factor = outcome.linear.factor;
    Measured {
        cpu,
        history: cpu - before,
        unknowns: outcome.layout.unknowns(),
        iterations: outcome.records.iter().map(|record| record.iterations).sum(),
        factorizations: outcome.linear.factorizations,
        entries: factor.entries,
        flops: factor.flops,
        megabytes: peak_rss_bytes().unwrap_or(0) as f64 * 1e-6,
        backward_error: outcome.linear.worst_backward_error,
        converged: outcome.records.iter().filter(|record| record.status == Status::Converged).count(),
        condensed,
    }
}
