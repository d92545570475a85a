//! Told errors beside the true ones: scenes on their mesh with their increments, on a finer mesh, and with more increments.

use stickslip::run::Run;
use stickslip::run::report::RunReport;
use stickslip::scene::{Override, Scene};
use stickslip::solver::history::Status;
use stickslip_cli::study::{MeshChoice, MeshSize};

use crate::estimates::EstimateError;
use crate::warnings::{Case, Random};

/// The finer mesh has so many times the elements along each axis, in the plane and in space.
const FINER: [f64; 2] = [4.0, 2.0];

/// The finer history has so many times the increments.
const MORE: usize = 8;

/// Errors up to this share count as equal.
const SMALL: f64 = 1e-3;

/// A told error agrees with the true one within this factor, both ways.
const FACTOR: f64 = 3.0;

/// The quantities whose errors are told; `true` if the error is that of the increments.
pub const QUANTITIES: [(&str, bool); 7] = [
    ("force", false),
    ("peak", false),
    ("work", false),
    ("tangential", false),
    ("stick zone", false),
    ("work, increments", true),
    ("tangential, increments", true),
];

/// A scene of the table.
pub struct Subject {
    /// Its name.
    pub name: String,
    text: String,
    set: Vec<String>,
}

/// The told and the true error of a quantity, as shares; a stick zone's are shares of the contact width.
pub type Pair = [Option<f64>; 2];

macro_rules! shipped {
    ($($name:literal: $($set:expr),*;)*) => { [$(($name, include_str!(concat!("../../", $name)), &[$($set),*][..])),*] };
}

/// Shipped scenes, with smaller meshes.
fn shipped() -> Vec<Subject> {
    let of = |(name, text, set): (&str, &str, &[&str])| Subject {
        name: name.to_string(),
        text: text.to_string(),
        set: set.iter().map(ToString::to_string).collect(),
    };
    let given = shipped! {
        "data/scenes/block.toml": "mesh.elements=[16,16]", "time.increments=8", "solver.setting=\"default\"";
        "data/scenes/bolt.toml": "time.increments=8";
        "data/scenes/cattaneo_mindlin.toml": "mesh.elements=[[8,12,8],12]", "time.increments=18";
        "data/scenes/confined.toml": "time.increments=10";
        "data/scenes/cube.toml": "mesh.elements=[5,5,5]", "time.increments=8";
        "data/scenes/disk.toml": "mesh.elements=[6,6,3]", "time.increments=12";
        "data/scenes/frictionless.toml": "mesh.elements=[16,16]", "time.increments=4";
        "data/scenes/held_by_contact.toml": "time.increments=10";
        "data/scenes/hertz_line.toml": "mesh.contact_elements=16", "mesh.outer_elements=16", "mesh.layers=16";
        "data/scenes/punch.toml": "mesh.contact_elements=16", "mesh.outer_elements=16", "mesh.layers=16";
        "data/scenes/seal.toml": "mesh.elements=[16,16]";
        "data/scenes/ssnv128.toml": "mesh.elements=[16,16]";
        "data/scenes/strip.toml": "mesh.elements=[100,2]";
        "data/scenes/turning_load.toml": "mesh.elements=[12,12]";
        "data/scenes/two_blocks.toml": "time.increments=20";
        "data/scenes/wedge.toml": "time.increments=4";
        "data/init/block.toml": "time.increments=10";
        "data/tutorials/press-fit.toml": "body[0].mesh.elements=[4,40]", "body[1].mesh.elements=[4,16]", "time.increments=16";
        "doc/lap.toml": "body[0].mesh.elements=[40,10]", "body[1].mesh.elements=[30,7]";
    };
    given.into_iter().map(of).collect()
}

/// Two bodies: a lower one on its foot, and an upper one, each with `size` and `elements`, and more of the scene.
fn two(lower: [[f64; 2]; 2], upper: [[f64; 2]; 2], at: f64, more: &str) -> String {
    let body = |name: &str, x: f64, y: f64, [size, n]: [[f64; 2]; 2]| {
        format!(
            "[[body]]\nname = \"{name}\"\nat = [{x:?}, {y:?}]\nmesh = {{ kind = \"block\", size = {size:?}, elements = [{}, {}] \
             }}\nmaterial = {{ young = 1e9, poisson = 0.3 }}\n",
            n[0], n[1]
        )
    };
    let [lower, upper] = [body("lower", 0.0, 0.0, lower), body("upper", at, lower[0][1], upper)];
    format!(
        "{lower}{upper}[[support]]\nboundary = \"lower:bottom\"\nfix = [\"x\", \"y\"]\n[[contact]]\nboundary = \
         \"upper:bottom\"\nagainst = \"lower:top\"\nfriction = 0.3\n{more}[time]\nend = 2\nincrements = 8\n"
    )
}

/// One block on an obstacle, and more of the scene.
fn one(size: [f64; 2], elements: [usize; 2], obstacle: &str, more: &str) -> String {
    format!(
        "mesh = {{ kind = \"block\", size = {size:?}, elements = {elements:?} }}\nmaterial = {{ young = 1e9, poisson = 0.3 \
         }}\n[[contact]]\nboundary = \"bottom\"\nfriction = 0.3\nobstacle = {{ {obstacle} }}\n{more}[time]\nend = 2\nincrements \
         = 8\n"
    )
}

/// Loads that determine the force, and loads that share it with supports.
fn kinds() -> Vec<Subject> {
    let pushed = |side: &str, traction: f64| {
        format!("[[load]]\nboundary = \"{side}\"\ntraction = [{traction:?}, 0]\nhistory = [[0, 0], [1, 0], [2, 1]]\n")
    };
    let pressed = |side: &str, pressure: f64| {
        format!("[[load]]\nboundary = \"{side}\"\npressure = {pressure:?}\nhistory = [[0, 0], [1, 1], [2, 1]]\n")
    };
    let held = |side: &str, axes: &str| format!("[[support]]\nboundary = \"{side}\"\nfix = [{axes}]\n");
    let moved = |side: &str, axis: &str, by: f64| {
        format!(
            "[[support]]\nboundary = \"{side}\"\nfix = [\"{axis}\"]\ndisplacement = {by:?}\nhistory = [[0, 0], [1, 1], [2, 1]]\n"
        )
    };
    let pulled = |side: &str, by: f64| {
        format!(
            "[[support]]\nboundary = \"{side}\"\nfix = [\"x\"]\ndisplacement = {by:?}\nhistory = [[0, 0], [1, 0], [2, 1]]\n"
        )
    };
    let cylinder = "kind = \"cylinder\", radius = 4, apex = [0.5, 0]";
    let plane = "kind = \"plane\"";
    let mut all: Vec<(String, String)> = Vec::new();
    let mut add = |name: &str, text: String| all.push((name.to_string(), text));
    for n in [6, 12] {
        let m = n as f64;
        let block = |width: f64| [[width, 0.5], [m, m / 2.0]];
        let wide = [[1.0, 0.5], [m + 2.0, m / 2.0 + 1.0]];
        let both = [pressed("top", 1e6), pushed("right", 2e5)].concat();
        add("loads, plane", one([1.0, 0.5], [2 * n, n], plane, &both));
        add(
            "loads, cylinder",
            one([1.0, 0.5], [3 * n, 2 * n], cylinder, &[held("left", "\"x\""), pressed("top", 1e6)].concat()),
        );
        add(
            "moved, cylinder",
            one([1.0, 0.5], [3 * n, 2 * n], cylinder, &[moved("top", "y", -2e-3), pulled("top", 4e-4)].concat()),
        );
        add(
            "moved, plane",
            one([1.0, 0.5], [2 * n, n], plane, &[moved("top", "y", -2e-3), pulled("top", 4e-4)].concat()),
        );
        add(
            "held side",
            one([1.0, 0.5], [2 * n, n], plane, &[held("left", "\"x\", \"y\""), pressed("top", 1e6)].concat()),
        );
        add("strip", one([1.0, 0.05], [2 * n, 2], plane, &[pressed("top", 1e5), pushed("right", 4e5)].concat()));
        let on_block = [pressed("upper:top", 1e6), pushed("upper:right", 1e5)].concat();
        add("block on block, loads", two(wide, block(1.0), 0.0, &on_block));
        add("narrow block, loads", two(wide, block(0.5), 0.25, &on_block));
        let drawn = [moved("upper:top", "y", -1e-3), pulled("upper:top", 5e-4)].concat();
        add("block on block, moved", two(wide, block(1.0), 0.0, &drawn));
        add("narrow block, moved", two(wide, block(0.5), 0.25, &drawn));
        let beam = [[2.0, 0.2], [3.0 * m, 3.0]];
        let prop = |load: String| [held("upper:left", "\"x\", \"y\""), load].concat();
        add("propped beam", two([[0.3, 0.2], [m / 2.0, 3.0]], beam, -1.7, &prop(pressed("upper:top", 1e5))));
        let shear =
            "[[load]]\nboundary = \"upper:right\"\ntraction = [1e5, -1e5]\nhistory = [[0, 0], [1, 1], [2, 0.4]]\n";
        add("bracket", two([[1.0, 0.5], [m, m / 2.0]], [[1.2, 0.2], [1.5 * m, 3.0]], 0.0, &prop(shear.to_string())));
    }
    all.into_iter().map(|(name, text)| Subject { name, text, set: Vec::new() }).collect()
}

/// A random scene in space, of bricks or tetrahedra: a block on a plane or a sphere that moves, or two blocks, the
/// upper one as wide as the lower one or half as wide, pressed and then moved along a direction of its own.
fn in_space(seed: u64) -> Subject {
    let mut random = Random::new(seed);
    let cells = ["hexahedron", "tetrahedron"][random.below(2)];
    let (n, increments) = (3 + random.below(3), 4 + random.below(9));
    let (friction, poisson) = (random.between(0.1, 0.8), random.between(0.1, 0.45));
    let push = 1e-3 * friction * random.between(0.3, 4.0);
    let turn = random.between(0.0, std::f64::consts::TAU);
    let [along, across] = [push * turn.cos(), push * turn.sin()];
    let back = random.between(-1.0, 1.0);
    let mesh = |size: [f64; 3], elements: [usize; 3]| {
        format!("{{ kind = \"block\", size = {size:?}, elements = {elements:?}, cells = \"{cells}\" }}")
    };
    let material = format!("{{ young = 1e9, poisson = {poisson} }}");
    let time = format!("[time]\nend = 2\nincrements = {increments}\n");
    let lower = mesh([1.0, 1.0, 0.5], [n + 2, n + 2, n / 2 + 1]);
    let one = |obstacle: &str| {
        let [x, y] = [along, across].map(|by| back * by);
        format!(
            "mesh = {lower}\nmaterial = {material}\n[[support]]\nboundary = \"top\"\nfix = [\"x\", \"y\", \"z\"]\n\
             [[contact]]\nboundary = \"bottom\"\nfriction = {friction}\n[contact.obstacle]\n{obstacle}\n\
             approach = [[0, 0], [1, 1e-3]]\n\
             motion.translation = [[0, 0, 0, 0], [1, 0, 0, 0], [1.6, {along}, {across}, 0], [2, {x}, {y}, 0]]\n{time}"
        )
    };
    let two = |at: f64, width: f64, elements: usize| {
        let body = |name: &str, at: [f64; 3], mesh: &str| {
            format!("[[body]]\nname = \"{name}\"\nat = {at:?}\nmesh = {mesh}\nmaterial = {material}\n")
        };
        let upper = mesh([width, width, 0.5], [elements, elements, n / 2 + 1]);
        let bodies = [body("lower", [0.0; 3], &lower), body("upper", [at, at, 0.5], &upper)].concat();
        let moved = |axes: &str, by: &[f64], history: &str| {
            format!(
                "[[support]]\nboundary = \"upper:top\"\nfix = [{axes}]\ndisplacement = {by:?}\nhistory = {history}\n"
            )
        };
        let pressed = moved("\"z\"", &[-1e-3], "[[0, 0], [1, 1], [2, 1]]");
        let pushed = moved("\"x\", \"y\"", &[along, across], &format!("[[0, 0], [1, 0], [1.6, 1], [2, {back}]]"));
        format!(
            "{bodies}[[support]]\nboundary = \"lower:bottom\"\nfix = [\"x\", \"y\", \"z\"]\n{pressed}{pushed}\
             [[contact]]\nboundary = \"upper:bottom\"\nagainst = \"lower:top\"\nfriction = {friction}\n{time}"
        )
    };
    let (kind, text) = match random.below(4) {
        0 => ("plane", one("kind = \"plane\"")),
        1 => ("sphere", one("kind = \"sphere\"\nradius = 60.0\napex = [0.5, 0.5, 0.0]")),
        2 => ("equal", two(0.0, 1.0, n + 3)),
        _ => ("narrow", two(0.25, 0.5, n)),
    };
    Subject { name: format!("space {seed}, {kind}, {cells}"), text, set: Vec::new() }
}

/// All scenes, `count` random ones in the plane and as many in space among them.
pub fn subjects(count: u64) -> Vec<Subject> {
    let random = (0..count).map(|seed| {
        let case = Case::new(seed);
        Subject { name: format!("random {seed}, {:?}", case.kind), text: case.text([1, 1]), set: Vec::new() }
    });
    kinds().into_iter().chain(shipped()).chain(random).chain((0..count).map(in_space)).collect()
}

/// The told errors of a run, in the order of [`QUANTITIES`].
fn told(report: &RunReport) -> [Option<f64>; 7] {
    let peak = report.largest_pressure.as_ref().filter(|peak| !peak.singular && peak.pressure.is_some());
    let (friction, tangential) = (report.friction.as_ref(), report.holding_force.as_ref());
    [
        report.largest_force.as_ref().and_then(|force| force.mesh_error),
        peak.and_then(|peak| peak.mesh_error),
        // Finer runs alone tell the error of the work.
        None,
        tangential.and_then(|force| force.mesh_error),
        // Nothing is told of a zone that sticks or slips as a whole.
        report
            .stick_zone
            .as_ref()
            .filter(|zone| zone.ratio > 0.0 && zone.ratio < 1.0)
            .and_then(|zone| zone.uncertainty),
        friction.and_then(|friction| friction.time_error).map(f64::abs),
        tangential.and_then(|force| force.time_error),
    ]
}

/// The values of a run: force, peak, friction work, tangential force, stick ratio.
fn values(report: &RunReport) -> [Option<f64>; 5] {
    [
        report.largest_force.as_ref().map(|force| force.magnitude),
        report.largest_pressure.as_ref().and_then(|peak| peak.pressure),
        report.friction.as_ref().map(|friction| friction.friction_work),
        report.holding_force.as_ref().map(|force| force.magnitude),
        report.stick_zone.as_ref().map(|zone| zone.ratio),
    ]
}

impl Subject {
    fn solved(&self, more: &[Override]) -> Result<RunReport, EstimateError> {
        let mut set = self.set.iter().map(|set| set.parse()).collect::<Result<Vec<Override>, _>>()?;
        set.extend_from_slice(more);
        let report = Run::new(&Scene::parse(&self.name, &self.text, &set)?)?.solve(&mut ())?;
        let converged = report.status == Status::Converged;
        if converged { Ok(report) } else { Err(EstimateError::Verdict(format!("{}, in {}", report.status, self.name))) }
    }

    /// Returns the told and the true error of each of the [`QUANTITIES`].
    ///
    /// # Errors
    /// When a run does not converge.
    pub fn pairs(&self) -> Result<[Pair; 7], EstimateError> {
        let set = self.set.iter().map(|set| set.parse()).collect::<Result<Vec<Override>, _>>()?;
        let scene = Scene::parse(&self.name, &self.text, &set)?;
        let ratio = FINER[usize::from(Run::new(&scene)?.model().mesh.dimension == 3)];
        let finer = MeshChoice::from(MeshSize::Times(ratio)).overrides(&scene.description.mesh);
        let more = Override::value("time.increments", (MORE * scene.time.increments) as i64);
        let [here, mesh, steps] = [self.solved(&[])?, self.solved(&finer)?, self.solved(&[more])?];
        let (told, [value, finer, later]) = (told(&here), [&here, &mesh, &steps].map(values));
        let truth = |k: usize, other: &[Option<f64>; 5]| {
            let (value, other) = (value[k]?, other[k]?);
            Some((value - other).abs() / if k == 4 { 1.0 } else { value.abs() })
        };
        let truths = [0, 1, 2, 3, 4].map(|k| truth(k, &finer)).into_iter().chain([2, 3].map(|k| truth(k, &later)));
        let mut pairs = [[None; 2]; 7];
        pairs.iter_mut().zip(told.into_iter().zip(truths)).for_each(|(pair, (told, truth))| *pair = [told, truth]);
        Ok(pairs)
    }
}

/// Returns `true` if both errors agree within the factor; `None` where one of them is unknown.
pub fn agrees([told, truth]: Pair) -> Option<bool> {
    let (told, truth) = (told?, truth?);
    let ratio = told / truth;
    Some(told.max(truth) <= SMALL || (1.0 / FACTOR..=FACTOR).contains(&ratio))
}
