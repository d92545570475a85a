//! Condensed equations that do not hold all contact nodes: the answer is that of all of them, whichever they begin with.
#![allow(clippy::unwrap_used)]

use crate::common::random::Random;
use crate::common::{Keep, difference};
use stickslip::history::{self, HistoryOutcome, HistorySettings, LinearAlgebra, Method, Status, System};
use stickslip::model::Model;
use stickslip::scene::Scene;

/// Runs `method` on condensed equations that hold the nodes `first`, or all.
fn condensed(scene: &Scene, model: &Model, method: Method, first: Option<Vec<usize>>) -> (HistoryOutcome, Keep) {
    solve(scene, model, method, first, LinearAlgebra::condensed())
}

fn solve(
    scene: &Scene,
    model: &Model,
    method: Method,
    first: Option<Vec<usize>>,
    linear: LinearAlgebra,
) -> (HistoryOutcome, Keep) {
    let settings = HistorySettings::new(&model.problem, &model.loading, method).unwrap();
    let settings = HistorySettings { working_set: first, ..settings };
    let (problem, loading, times, mut keep) = (&model.problem, &model.loading, scene.time.all(), Keep::default());
    let outcome = history::run(problem, loading, &times, &settings, System::from(linear), &mut keep).unwrap();
    (outcome, keep)
}

/// Some of `n` nodes, one at least, each with this probability.
fn some(random: &mut Random, n: usize, share: f64) -> Vec<usize> {
    let one = (random.next() * n as f64) as usize;
    (0..n).filter(|&i| random.next() < share || i == one).collect()
}

/// A block that lies on its bottom, its top under `obstacle`, with `more` at its end.
fn block(size: &str, elements: &str, friction: f64, obstacle: &str, more: &str) -> String {
    let fix = if size.matches(',').count() == 1 { "[\"x\", \"y\"]" } else { "[\"x\", \"y\", \"z\"]" };
    format!(
        "[material]\nyoung = 1e9\npoisson = 0.3\n[mesh]\nkind = \"block\"\nsize = {size}\nelements = {elements}\n\
         [[support]]\nboundary = \"bottom\"\nfix = {fix}\n\
         [[contact]]\nboundary = \"top\"\nfriction = {friction}\nobstacle = {obstacle}\n{more}"
    )
}

/// Presses, moves along, and comes back until nothing touches.
const ROUND: &str = "approach = [[0, 0], [1, 2e-2], [2, 2e-2], [4, -5e-3]]";

/// Round obstacles and planes that move, friction and none, second order, nodes in front of two obstacles, two bodies, loads that
/// open what they have closed.
fn scenes() -> Vec<(&'static str, String)> {
    let cylinder = format!(
        "{{ kind = \"cylinder\", radius = 2.0, apex = [0.6, 1.0], {ROUND}, \
         motion = {{ translation = [[1, 0, 0], [2, 3e-3, 0]] }} }}"
    );
    let sphere = format!(
        "{{ kind = \"sphere\", radius = 2.0, apex = [0.6, 0.5, 0.6], {ROUND}, \
         motion = {{ translation = [[1, 0, 0, 0], [2, 3e-3, 1e-3, 0]] }} }}"
    );
    let time = "[time]\nend = 4.0\nincrements = 8\n";
    let (plane, space) = ("[1.0, 1.0]", "[1.0, 1.0, 0.6]");
    let corner = "[[contact]]\nboundary = \"right\"\nfriction = 0.2\nobstacle = { kind = \"plane\", gap = 1e-3 }\n\
         [[load]]\nboundary = \"left\"\ntraction = [4e6, 2e6]\nhistory = [[0, 0], [1, 1], [2, 1], [3, -0.2], [4, 0.5]]\n";
    let bodies = "[[body]]\nname = \"lower\"\n[body.mesh]\nkind = \"block\"\nsize = [1.0, 0.5]\nelements = [10, 4]\n\
         [body.material]\nyoung = 1e9\npoisson = 0.3\n\
         [[body]]\nname = \"upper\"\nat = [0.0, 0.5]\n[body.mesh]\nkind = \"block\"\nsize = [1.0, 0.5]\nelements = [13, 5]\n\
         [body.material]\nyoung = 2e9\npoisson = 0.3\n\
         [[support]]\nboundary = \"lower:bottom\"\nfix = [\"x\", \"y\"]\n[[support]]\nboundary = \"upper:left\"\nfix = [\"x\", \"y\"]\n\
         [[contact]]\nboundary = \"upper:bottom\"\nagainst = \"lower:top\"\nfriction = 0.3\n\
         [[load]]\nboundary = \"upper:top\"\ntraction = [5e5, -1e6]\nhistory = [[0, 0], [1, 1], [3, -0.5], [4, 1]]\n";
    let plane_obstacle = "{ kind = \"plane\", gap = 1e-3 }";
    vec![
        ("a cylinder", block(plane, "[30, 6]", 0.3, &cylinder, time)),
        ("a cylinder without friction", block(plane, "[30, 6]", 0.0, &cylinder, time)),
        (
            "second order",
            block(plane, "[16, 4]", 0.3, &cylinder, time).replacen("[mesh]", "[mesh]\ncells = \"triangle6\"", 1),
        ),
        ("a sphere", block(space, "[6, 6, 3]", 0.3, &sphere, time)),
        ("a sphere without friction", block(space, "[6, 6, 3]", 0.0, &sphere, time)),
        (
            "a sphere, second order",
            block(space, "[3, 3, 2]", 0.3, &sphere, time).replacen("[mesh]", "[mesh]\ncells = \"tetrahedron10\"", 1),
        ),
        ("a corner", block(plane, "[10, 10]", 0.3, plane_obstacle, &format!("{corner}{time}"))),
        ("two bodies", format!("{bodies}{time}")),
    ]
}

#[test]
fn any_set_leads_to_the_same_answer() {
    let mut random = Random(18);
    let mut grown = 0;
    for (name, text) in scenes() {
        let scene = Scene::parse("scene.toml", &text, &[]).unwrap();
        let model = Model::new(&scene).unwrap();
        let (whole, expected) = solve(&scene, &model, Method::BN, None, LinearAlgebra::default());
        assert_eq!(whole.status, Status::Converged, "{name}");
        for (method, share) in [(Method::BN, 0.0), (Method::BN, 0.3), (Method::IP, 0.1)] {
            let first = some(&mut random, model.problem.contacts(), share);
            let (outcome, keep) = condensed(&scene, &model, method, Some(first.clone()));
            assert_eq!(outcome.status, whole.status, "{name} {method} {first:?}");
            let worst = difference(&expected.states, &keep.states);
            assert!(worst <= 1e-9, "{name} {method} {first:?}: {worst:e}");
            let set = outcome.working_set.unwrap();
            assert!(set.first == first.len() && set.last >= set.first && set.all == model.problem.contacts());
            let joined: usize = outcome.records.iter().map(|record| record.joined).sum();
            assert_eq!(set.last - set.first, joined, "{name} {method}");
            grown += set.grown;
        }
    }
    assert!(grown > 20, "{grown}");
}
