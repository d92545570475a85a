//! Iterations of GMRES to 1e-10 for every Newton matrix of a history, by multigrid with contact inside; and what direct directions need.
//!
//! `cargo bench --features petsc --bench multigrid [-- NAME ... --csv]`: one run after the other in one process, two increments each; names
//! choose rows that begin with them. Every direction is solved to 1e-10, whatever Newton's method asks for: `least` and `most` iterations of any. `loose`
//! are the iterations of Newton's method with directions as good as the program makes them, `direct` those with a factorisation. CPU s are
//! those of all linear algebra of the tight run; those of the direct one are beside it.
#![allow(missing_docs, clippy::unwrap_used, clippy::print_stdout)]

mod common;

use std::sync::Arc;
use std::sync::mpsc::{Sender, channel};

use common::Rows;
use stickslip::algebra::Pattern;
use stickslip::algebra::linear::{Engine, FactorInfo, Grid, LinearError, LinearSolver, SparseLu};
use stickslip::run::report::thread_cpu_seconds;
use stickslip::run::{Run, Sink, grid};
use stickslip::scene::Scene;
use stickslip_distributed::Petsc;

/// Multigrid that solves each system to 1e-10, and tells how many iterations that took.
struct Tight {
    solver: Box<dyn LinearSolver>,
    tells: Sender<(usize, bool)>,
    seconds: Sender<f64>,
}

impl Tight {
    fn timed<T>(&mut self, work: impl FnOnce(&mut dyn LinearSolver) -> T) -> T {
        let start = thread_cpu_seconds();
        let result = work(&mut *self.solver);
        let _ = self.seconds.send(thread_cpu_seconds() - start);
        result
    }
}

impl LinearSolver for Tight {
    fn name(&self) -> &'static str {
        self.solver.name()
    }

    fn analyze(&mut self, pattern: &Arc<Pattern>) -> Result<(), LinearError> {
        self.timed(|solver| solver.analyze(pattern))
    }

    fn factorize(&mut self, values: &[f64]) -> Result<FactorInfo, LinearError> {
        self.timed(|solver| solver.factorize(values))
    }

    fn solve(&mut self, b: &[f64], x: &mut [f64]) -> Result<(), LinearError> {
        let result = self.timed(|solver| solver.solve(b, x));
        let iterated = self.solver.iterated();
        // Right-hand sides of 0 take none.
        if iterated.iterations > 0 {
            let _ = self.tells.send((iterated.iterations, iterated.instead.is_some()));
        }
        result
    }
}

/// A cube on another, clamped below, pressed and pushed.
const TWO_CUBES: &str = r#"
title = "Two elastic cubes"
[[body]]
name = "lower"
[body.mesh]
kind = "block"
size = [1.0, 1.0, 1.0]
elements = [LOWER]
[body.material]
young = 210e9
poisson = 0.3
[[body]]
name = "upper"
at = [0.0, 0.0, 1.0]
[body.mesh]
kind = "block"
size = [1.0, 1.0, 1.0]
elements = [UPPER]
[body.material]
young = 70e9
poisson = 0.3
[[support]]
boundary = "lower:bottom"
fix = ["x", "y", "z"]
[[contact]]
boundary = "upper:bottom"
against = "lower:top"
friction = 0.2
[[load]]
boundary = "upper:top"
traction = [0.0, 0.0, -10e6]
history = [[0, 0], [1, 1]]
[[load]]
boundary = "upper:top"
traction = [1.8e6, 0.0, 0.0]
history = [[1, 0], [2, 1]]
[time]
end = 2.0
increments = 2
"#;

/// A name, a scene of the project, and what is changed in it.
const ROWS: &[(&str, &str, &[&str])] = &[
    ("cube 8", "cube", &["mesh.elements=[8,8,8]"]),
    ("cube 16", "cube", &["mesh.elements=[16,16,16]"]),
    ("cube 16, mu .1", "cube", &["mesh.elements=[16,16,16]", "contact.friction=0.1"]),
    ("cube 16, mu .8", "cube", &["mesh.elements=[16,16,16]", "contact.friction=0.8"]),
    ("cube 16, mu 1.5", "cube", &["mesh.elements=[16,16,16]", "contact.friction=1.5"]),
    ("cube 16, mu 2", "cube", &["mesh.elements=[16,16,16]", "contact.friction=2"]),
    ("cube 24", "cube", &["mesh.elements=[24,24,24]"]),
    ("cube 32", "cube", &["mesh.elements=[32,32,32]"]),
    ("tets 14", "cube", &["mesh.elements=[14,14,14]", "mesh.cells=\"tetrahedron\""]),
    ("T10 8", "cube", &["mesh.elements=[8,8,8]", "mesh.cells=\"tetrahedron10\""]),
    ("T10 12", "cube", &["mesh.elements=[12,12,12]", "mesh.cells=\"tetrahedron10\""]),
    ("prisms 14", "cube", &["mesh.elements=[14,14,14]", "mesh.cells=\"prism\""]),
    ("plate 24x24x4", "cube", &["mesh.elements=[24,24,4]", "mesh.size=[1,1,0.16]"]),
    ("bar 60x4x4", "cube", &["mesh.elements=[60,4,4]", "mesh.size=[15,1,1]"]),
    ("aspect 2", "cube", &["mesh.elements=[14,14,14]", "mesh.size=[1,1,0.5]"]),
    ("aspect 4", "cube", &["mesh.elements=[14,14,14]", "mesh.size=[1,1,0.25]"]),
    ("aspect 20", "cube", &["mesh.elements=[14,14,14]", "mesh.size=[1,1,0.05]"]),
    ("aspect 100", "cube", &["mesh.elements=[14,14,14]", "mesh.size=[1,1,0.01]"]),
    ("flat 16x16x8", "cube", &["mesh.elements=[16,16,8]", "mesh.size=[1,1,0.05]"]),
    ("nu .45", "cube", &["mesh.elements=[12,12,12]", "material.poisson=0.45"]),
    ("nu .49", "cube", &["mesh.elements=[12,12,12]", "material.poisson=0.49"]),
    ("nu .499", "cube", &["mesh.elements=[12,12,12]", "material.poisson=0.499"]),
    ("disk", "disk", &["mesh.elements=[20,20,10]"]),
    ("hertz_sphere", "hertz_sphere", &[]),
    ("mindlin_sphere", "mindlin_sphere", &[]),
    ("two cubes 10 on 12", "two", &["10, 10, 10", "12, 12, 12"]),
    ("two cubes 16 on 20", "two", &["16, 16, 16", "20, 20, 20"]),
    ("block 100", "block", &["mesh.elements=[100,100]", "solver.setting=\"default\""]),
    ("block 200", "block", &["mesh.elements=[200,200]", "solver.setting=\"default\""]),
    ("punch", "punch", &["solver.setting=\"default\""]),
    ("wedge", "wedge", &["mesh.elements=[96,48]"]),
    ("held by contact 60", "held_by_contact", &["mesh.elements=[60,60]"]),
    ("confined 60", "confined", &["mesh.elements=[60,60]"]),
    ("cattaneo_mindlin", "cattaneo_mindlin", &[]),
    ("ip cube 12", "cube", &["mesh.elements=[12,12,12]", "solver.method=\"ip\""]),
    ("ip block 60", "block", &["mesh.elements=[60,60]", "solver.method=\"ip\"", "solver.setting=\"default\""]),
];

fn scene(name: &str, changes: &[&str]) -> Scene {
    if let ("two", [upper, lower]) = (name, changes) {
        let text = TWO_CUBES.replace("LOWER", lower).replace("UPPER", upper);
        return Scene::parse("two cubes", &text, &[]).unwrap();
    }
    let path = format!("{}/../data/scenes/{name}.toml", env!("CARGO_MANIFEST_DIR"));
    let changes: Vec<_> = changes.iter().chain(&["time.increments=2"]).map(|text| text.parse().unwrap()).collect();
    Scene::read(path.as_ref(), &changes).unwrap()
}

fn main() {
    let args: Vec<String> = std::env::args().skip(1).filter(|arg| !arg.starts_with("--")).collect();
    let heads = ["scene", "u", "systems", "least", "most", "CPU s", "loose", "direct", "CPU s of direct"];
    let mut rows = Rows::new(&heads);
    let chosen = |name: &str| args.is_empty() || args.iter().any(|arg| name.starts_with(arg.as_str()));
    for &(name, file, changes) in ROWS.iter().filter(|(name, ..)| chosen(name)) {
        let scene = scene(file, changes);
        let run = Run::new(&scene).unwrap();
        let interior = scene.solver.method.increments().is_interior();
        let solver = |multigrid: bool| -> Box<dyn LinearSolver> {
            match grid(run.model()).filter(|_| multigrid) {
                Some(grid) => Petsc.iterative(Grid { interior, ..grid }, None),
                None => SparseLu::default().solver(),
            }
        };
        let measured = |multigrid: bool| {
            let ((tells, told), (seconds, times)) = (channel(), channel());
            let tight = Tight { solver: solver(multigrid), tells, seconds };
            let report =
                run.solve_with((Box::new(tight) as Box<dyn LinearSolver>).into(), Sink::Observer(&mut ())).unwrap();
            let counts: Vec<(usize, bool)> = told.iter().collect();
            (report, counts, times.iter().sum::<f64>())
        };
        let (_, told, seconds) = measured(true);
        let (direct, _, direct_seconds) = measured(false);
        let loose = run.solve_with(solver(true).into(), Sink::Observer(&mut ())).unwrap();
        let gave_way = told.iter().any(|(_, gave_way)| *gave_way);
        let count = |of: fn(_, _) -> usize, from: usize| told.iter().map(|(count, _)| *count).fold(from, of);
        let most = count(usize::max, 0);
        rows.push(vec![
            name.to_string(),
            run.model().problem.displacements().to_string(),
            told.len().to_string(),
            count(usize::min, most).to_string(),
            if gave_way { "gave way".to_string() } else { most.to_string() },
            format!("{seconds:.2}"),
            loose.totals.iterations.to_string(),
            direct.totals.iterations.to_string(),
            format!("{direct_seconds:.2}"),
        ]);
        println!("{name}: {:?}", told.iter().map(|(count, _)| *count).collect::<Vec<_>>());
    }
    rows.print("CPU of one thread, two increments", &std::env::args().collect::<Vec<_>>());
}
