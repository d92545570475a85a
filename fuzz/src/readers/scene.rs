//! Scenes and what is put in place of their values.

use stickslip::run::{RunError, discretise};
use stickslip::scene::{Override, Scene};

use super::{changed, check_diagnostic, said};
use crate::corpus::{Corpus, scenes};
use crate::mutate::mutated;
use crate::pool::Verdict;
use crate::random::Random;
use crate::runs::{Case, TextOptions};

/// Meshes with more nodes are read, and not made.
const MAX_NODES: usize = 300;

/// Histories of more increments are read, and not made: obstacles that move are placed for each.
const MAX_INCREMENTS: usize = 200;

pub(super) fn make(random: &mut Random, corpus: &Corpus) -> Vec<u8> {
    if random.percent(60) {
        return changed(random, &corpus.scenes, &corpus.words);
    }
    let text = Case::random(random).text(&TextOptions::SI);
    let other = &corpus.scenes[random.below(corpus.scenes.len())];
    mutated(random, text.as_bytes(), other, &corpus.words)
}

pub(super) fn check(bytes: &[u8]) -> Verdict {
    let text = String::from_utf8_lossy(bytes);
    // Files that it names are looked for beside the scenes of the tree.
    let name = scenes().join("fuzz.toml").display().to_string();
    match Scene::parse(&name, &text, &[]) {
        Err(error) => check_diagnostic(&error),
        Ok(scene) => {
            again(&scene)?;
            discretised(&scene)
        }
    }
}

/// The text of a scene is the scene.
fn again(scene: &Scene) -> Result<(), String> {
    let again = Scene::parse(scene.file(), scene.text(), &[]).map_err(|error| format!("read again: {error}"))?;
    let same = again.description == scene.description && again.solver == scene.solver && again.output == scene.output;
    if same { Ok(()) } else { Err("read again, its text is another scene".to_string()) }
}

fn discretised(scene: &Scene) -> Verdict {
    let small = scene.description.mesh.nodes().is_none_or(|(nodes, _)| nodes <= MAX_NODES);
    if !small || scene.description.times.len() > MAX_INCREMENTS {
        return Ok("read");
    }
    match discretise(scene) {
        Ok(_) => Ok("discretised"),
        Err(RunError::Scene(error)) => check_diagnostic(&error),
        Err(error) => said(&error),
    }
}

const BASE: &str = "[mesh]\nkind = 'block'\nsize = [1, 1]\nelements = [2, 2] # few\n[material]\nyoung = 1e9\npoisson = 0.3\n\
    [[support]]\nboundary = 'left'\nfix = ['x', 'y']\n[[contact]]\nboundary = 'bottom'\nfriction = 0.3\n\
    obstacle = [{ kind = 'plane', gap = 0 }, { kind = 'cylinder', radius = 1, apex = [0, 0] }]\n\
    [[load]]\nboundary = 'top'\npressure = 1e4\n[time]\nend = 1\nincrements = 2\n";

const OVERRIDES: [&str; 14] = [
    "mesh.elements=[50,50]",
    "contact[0].friction=0.3",
    "contact.friction=0.1 + 0.2 * x",
    "contact[0].obstacle[1].radius=0.5",
    "material.poisson=.25",
    "material.layers=[[0.5, 1e9, 0.3]]",
    "solver.method=ip",
    "load[0].history=[[0,0],[1,1]]",
    "title=a title of words",
    "units.length=mm",
    "time.increments=100000000000000000000",
    "output.probe=[{ name = 'a', point = [0, 0] }]",
    "contact.obstacle.kind=plane",
    "body[1].material.young=70e9",
];

pub(super) fn make_override(random: &mut Random, corpus: &Corpus) -> Vec<u8> {
    let [text, other] = [0, 1].map(|_| random.one(&OVERRIDES).as_bytes());
    mutated(random, text, other, &corpus.words)
}

pub(super) fn check_override(bytes: &[u8]) -> Verdict {
    let text = String::from_utf8_lossy(bytes);
    let change: Override = match text.parse() {
        Ok(change) => change,
        Err(error) => return said(&error),
    };
    if change.to_string() != text {
        return Err(format!("printed as {change}"));
    }
    match Scene::parse("base.toml", BASE, &[change]) {
        Ok(scene) => again(&scene).map(|()| "read"),
        Err(error) => check_diagnostic(&error),
    }
}
