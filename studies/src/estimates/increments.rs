//! What increments leave in the work of friction and in the tangential forces, beside the exact path in time; in space beside very many.

use std::sync::Arc;

use stickslip::body::mesh::CellKind;
use stickslip::run::report::{RunReport, WarningKind};
use stickslip::run::{Recording, Run};
use stickslip::scene::Scene;
use stickslip::solver::history::Status;

use super::{EstimateError, Row, Subject, Task};

/// A history, its name, the stretches between the corners of its loads, all as long, and what is changed in its scene.
struct History {
    name: String,
    text: &'static str,
    stretches: usize,
    set: Vec<String>,
}

/// The name, the scene with its stretches, and what is changed in it.
type Given = (&'static str, (&'static str, usize), &'static [&'static str]);

const PUNCH: (&str, usize) = (include_str!("../../../data/scenes/punch.toml"), 1);
const LINE: (&str, usize) = (include_str!("../../../data/scenes/hertz_line.toml"), 1);
const BLOCK: (&str, usize) = (include_str!("../../../data/scenes/block.toml"), 2);
const CONFINED: (&str, usize) = (include_str!("../../../data/scenes/confined.toml"), 2);
const SEAL: (&str, usize) = (include_str!("../../../data/scenes/seal.toml"), 2);
const STRIP: (&str, usize) = (include_str!("../../../data/scenes/strip.toml"), 3);
const CATTANEO: (&str, usize) = (include_str!("../../../data/scenes/cattaneo_mindlin.toml"), 3);
const TURNING: (&str, usize) = (include_str!("../../../data/scenes/turning_load.toml"), 32);
const CUBE: (&str, usize) = (include_str!("../../../data/scenes/cube.toml"), 2);
const DISK: (&str, usize) = (include_str!("../../../data/scenes/disk.toml"), 4);
const SPHERE: (&str, usize) = (include_str!("../../../data/scenes/hertz_sphere.toml"), 1);

/// The cylinder and the spheres that are pressed in with friction are Spence's. Interference that is there from the start comes with the first
/// increment, so that more increments are another history: no scene has any.
const HISTORIES: [Given; 17] = [
    ("punch 0.2", PUNCH, &["contact.friction=0.2"]),
    ("punch 0.4", PUNCH, &[]),
    ("punch 0.8", PUNCH, &["contact.friction=0.8"]),
    ("cylinder 0.2", LINE, &["contact.friction=0.2", "mesh.contact_elements=32", "mesh.layers=16"]),
    ("cylinder 0.3", LINE, &["contact.friction=0.3", "mesh.contact_elements=32", "mesh.layers=16"]),
    (
        "sphere 0.3",
        LINE,
        &[
            "contact.friction=0.3",
            "contact.obstacle.kind=\"sphere\"",
            "material.plane=\"axisymmetric\"",
            "mesh.contact_elements=32",
            "mesh.contact_width=0.09",
            "mesh.layers=16",
        ],
    ),
    ("block 0.1", BLOCK, &["contact.friction=0.1", "mesh.elements=[20,20]", "solver.setting=\"default\""]),
    ("block 0.4", BLOCK, &["contact.friction=0.4", "mesh.elements=[20,20]", "solver.setting=\"default\""]),
    ("block 0.8", BLOCK, &["contact.friction=0.8", "mesh.elements=[20,20]", "solver.setting=\"default\""]),
    ("strip", STRIP, &["mesh.elements=[100,2]"]),
    ("confined", CONFINED, &[]),
    ("seal", SEAL, &[]),
    ("cattaneo", CATTANEO, &["mesh.elements=[[24,24,24],32]"]),
    ("turning load", TURNING, &[]),
    ("cube in space", CUBE, &["mesh.elements=[6,6,6]"]),
    ("disk in space", DISK, &["mesh.elements=[6,6,3]"]),
    ("sphere in space", SPHERE, &["contact.friction=0.3", "mesh.elements=[[8,4],[8,4],8]"]),
];

/// Blocks under loads that turn as they like, in so many histories.
const WANDERING: usize = 12;

/// The histories above, and blocks whose loads come and go between three corners, one in this way and the other in that: multiples of irrational
/// numbers give the friction and the factors.
fn histories() -> Vec<History> {
    let given = HISTORIES.iter().map(|&(name, (text, stretches), set)| History {
        name: format!("increments, {name}"),
        text,
        stretches,
        set: set.iter().map(ToString::to_string).collect(),
    });
    let wandering = (1..=WANDERING).map(|k| {
        let share = |j: i32| (k as f64 * 1.324_717_957_f64.powi(-j)).fract();
        let points =
            |of: &dyn Fn(i32) -> f64| (1..=3).map(|j| format!(", [{j}, {:.3}]", of(j))).collect::<Vec<_>>().concat();
        let [pressed, pushed] = [points(&|j| 0.2 + 0.8 * share(j)), points(&|j| 2.0 * share(j + 3) - 1.0)];
        let set = [
            "mesh.elements=[10,10]".to_string(),
            "solver.setting=\"default\"".to_string(),
            "time.end=3".to_string(),
            "output.times=[3]".to_string(),
            format!("contact.friction={:.3}", 0.1 + 0.9 * share(7)),
            format!("load[0].history=[[0, 0]{pressed}]"),
            format!("load[1].history=[[0, 0]{pushed}]"),
        ];
        History { name: format!("wandering loads, {k}"), text: BLOCK.0, stretches: 3, set: set.to_vec() }
    });
    given.chain(wandering).collect()
}

/// One task for each history: with so many `increments` a stretch, beside the exact path, or where there is none beside a run with `reference`
/// of them a stretch, a multiple of each.
pub fn increments(increments: &[usize], reference: usize) -> Vec<Task> {
    let counts: Arc<[usize]> = increments.into();
    let of = |history: History| {
        let counts = Arc::clone(&counts);
        Task {
            name: history.name.clone(),
            work: Box::new(move || {
                let truth = Truth::new(&history, &counts, reference)?;
                let rows = counts.iter().map(|&n| truth.rows(&Solved::new(&history, n)?));
                Ok(rows.collect::<Result<Vec<_>, EstimateError>>()?.concat())
            }),
        }
    };
    histories().into_iter().map(of).collect()
}

impl History {
    fn scene(&self, a_stretch: usize, method: &str) -> Result<Scene, EstimateError> {
        let increments = format!("time.increments={}", a_stretch * self.stretches);
        let method = format!("solver.method=\"{method}\"");
        let all = [increments.as_str(), method.as_str(), "solver.linear=\"condensed\""];
        let set = self.set.iter().map(String::as_str).chain(all).map(str::parse).collect::<Result<Vec<_>, _>>()?;
        Ok(Scene::parse(&self.name, self.text, &set)?)
    }
}

/// What a run found.
struct Solved {
    report: RunReport,
    /// Increments a stretch.
    a_stretch: usize,
    /// The tangential forces at the end of each increment, N, over the root of the node's weight.
    friction: Vec<Vec<f64>>,
    cells: CellKind,
    poisson: f64,
}

impl Solved {
    /// Solves the history with `a_stretch` increments in each stretch.
    fn new(history: &History, a_stretch: usize) -> Result<Self, EstimateError> {
        let scene = history.scene(a_stretch, "bn")?;
        Solved::of(&scene, &Run::new(&scene)?, a_stretch)
    }

    fn of(scene: &Scene, run: &Run<'_>, a_stretch: usize) -> Result<Self, EstimateError> {
        let mut recording = Recording::all();
        let report = run.solve(&mut recording)?;
        if report.status != Status::Converged {
            return Err(EstimateError::Verdict(report.status.to_string()));
        }
        let model = run.model();
        let weight = model.problem.weight().unwrap_or_default();
        let over_root = |forces: &[f64]| forces.iter().zip(weight).map(|(p, l)| p / l.sqrt()).collect::<Vec<_>>();
        let friction = recording.states().map(|state| [&state.p_t, &state.p_o].map(|p| over_root(p)).concat());
        let cells = if model.mesh.dimension == 2 { CellKind::Quadrilateral } else { CellKind::Hexahedron };
        Ok(Solved {
            report,
            a_stretch,
            friction: friction.collect(),
            cells,
            poisson: scene.description.material.poisson,
        })
    }
}

/// What is true at the ends of so many increments a stretch.
struct Truth {
    a_stretch: usize,
    friction_work: f64,
    friction: Vec<Vec<f64>>,
}

impl Truth {
    /// By the exact path at the ends of all of so many increments a stretch; in space by a run with `reference`.
    fn new(history: &History, counts: &[usize], reference: usize) -> Result<Self, EstimateError> {
        let scene = history.scene(reference, "bn")?;
        let run = Run::new(&scene)?;
        if run.model().mesh.dimension == 3 {
            let Solved { report, friction, .. } = Solved::of(&scene, &run, reference)?;
            let found = report.estimates.increments.ok_or_else(no_estimate)?;
            return Ok(Truth { a_stretch: reference, friction_work: found.friction_work_corrected, friction });
        }
        let most = counts.iter().copied().max().unwrap_or(1);
        let scene = history.scene(most, "events")?;
        let Solved { report, friction, .. } = Solved::of(&scene, &Run::new(&scene)?, most)?;
        let friction_work = report.increments.iter().map(|record| record.friction_work).sum();
        Ok(Truth { a_stretch: most, friction_work, friction })
    }

    /// What a run says of its increments, beside this.
    fn rows(&self, solved: &Solved) -> Result<Vec<Row>, EstimateError> {
        let Solved { report, a_stretch, friction, cells, poisson } = solved;
        let found = report.estimates.increments.ok_or_else(no_estimate)?;
        let warned = |kind: WarningKind| Some(report.warnings.iter().any(|warning| warning.kind == kind));
        let row = |subject, error, estimate, warned| Row {
            subject,
            kind: *cells,
            poisson: *poisson,
            across: *a_stretch,
            error,
            estimate,
            warned,
        };
        let work = (found.friction_work - self.friction_work) / found.friction_work;
        let mut rows = vec![row(Subject::Work, work, found.work_error, warned(WarningKind::INCREMENTS_WORK))];
        let everywhere = self.error(friction, self.a_stretch / a_stretch);
        let warned = warned(WarningKind::INCREMENTS_FORCE);
        rows.extend(found.force_error.map(|estimate| row(Subject::Friction, everywhere, estimate, warned)));
        Ok(rows)
    }

    /// The largest error of tangential forces at the end of each increment, by the largest there; the truth has `finer` times as many.
    fn error(&self, friction: &[Vec<f64>], finer: usize) -> f64 {
        let ends = || 1..=friction.len();
        let size = |p: &mut dyn Iterator<Item = f64>| p.map(|p| p * p).sum::<f64>().sqrt();
        let exact = |k: usize| &self.friction[k * finer - 1];
        let apart = |k: usize| size(&mut friction[k - 1].iter().zip(exact(k)).map(|(p, exact)| p - exact));
        let largest = ends().map(|k| size(&mut exact(k).iter().copied())).fold(0.0, f64::max);
        ends().map(apart).fold(0.0, f64::max) / largest
    }
}

fn no_estimate() -> EstimateError {
    EstimateError::Verdict("no estimate".to_string())
}
