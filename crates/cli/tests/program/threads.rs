//! Threads: their number, and results that do not depend on it.

#![allow(clippy::unwrap_used)]

use std::fs;
use std::process::Command;
use std::thread::available_parallelism;

use serde_json::Value;
use stickslip::scene::Scene;
use stickslip::solver::history::{LinearAlgebra, Method};
use stickslip_cli::compare::{self, Comparison, MeshSize, Phases, Plan, SolverPath};

use crate::program::{Folder, assert_exit, count, json, number, small};

fn stickslip(openmp: Option<&str>, args: &[&str]) -> Value {
    let mut command = Command::new(env!("CARGO_BIN_EXE_stickslip"));
    command.env_remove("OMP_NUM_THREADS").envs(openmp.map(|threads| ("OMP_NUM_THREADS", threads)));
    let output = command.args(args).output().unwrap();
    assert_exit(&output, 0);
    json(&output)
}

fn threads(report: &Value) -> u64 {
    count(&report["totals"]["threads"])
}

fn processors() -> u64 {
    available_parallelism().unwrap().get() as u64
}

#[test]
fn the_threads_are_those_asked_for_or_the_processors() {
    let (_folder, scene) = Folder::with_scene(&small());
    let of = |openmp, more: &[&str]| threads(&stickslip(openmp, &[&["run", &scene, "--json"], more].concat()));
    assert_eq!(of(None, &[]), processors());
    assert_eq!(of(None, &["--threads", "3"]), 3);
    assert_eq!(of(Some("5"), &["--threads", "3"]), 3);
    for (openmp, count) in [("5", 5), ("4,2", 4), ("0", processors()), ("some", processors()), ("", processors())] {
        assert_eq!(of(Some(openmp), &[]), count, "{openmp:?}");
    }
}

/// The processes of a sweep share the processors.
#[test]
fn a_sweep_shares_the_processors() {
    let (folder, scene) = Folder::with_scene(&small());
    let shared = |more: &[&str], out: &str| {
        let args = ["sweep", &scene, "--json", "--vary", "contact.friction=0.2,0.4", "--out", &folder.join(out)];
        stickslip(None, &[&args, more].concat());
        let reports = folder.names(&format!("{out}/variants"));
        let texts =
            reports.iter().map(|name| fs::read_to_string(folder.join(&format!("{out}/variants/{name}/run.json"))));
        texts.map(|text| threads(&serde_json::from_str(&text.unwrap()).unwrap())).collect::<Vec<_>>()
    };
    let at_a_time = processors().min(2);
    assert_eq!(shared(&[], "own"), [processors() / at_a_time; 2]);
    assert_eq!(shared(&["--jobs", "1"], "one"), [processors(); 2]);
    assert_eq!(shared(&["--threads", "3"], "three"), [3; 2]);
}

/// Collects the numbers of both values, in order. Everything else must be equal.
fn numbers(a: &Value, b: &Value, into: &mut Vec<[f64; 2]>) {
    match (a, b) {
        (Value::Object(a), Value::Object(b)) => a.iter().zip(b).for_each(|((key, a), (other, b))| {
            assert_eq!(key, other);
            numbers(a, b, into);
        }),
        (Value::Array(a), Value::Array(b)) => {
            assert_eq!(a.len(), b.len());
            a.iter().zip(b).for_each(|(a, b)| numbers(a, b, into));
        }
        (Value::Number(_), Value::Number(_)) => into.push([number(a), number(b)]),
        _ => assert_eq!(a, b),
    }
}

/// In the plane and in space, with each linear solver: equal iterations, and equal forces up to rounding.
#[test]
fn results_are_the_same_on_any_number_of_threads() {
    let block = include_str!("../../../../data/scenes/block.toml");
    let cube = include_str!("../../../../data/scenes/cube.toml");
    let plane = ["mesh.elements=[60,60]", "time.increments=8", "solver.setting=\"default\""];
    let solid = ["mesh.elements=[8,8,8]", "time.increments=2", "output.fields=false"];
    let whole = LinearAlgebra::default().to_string();
    for (scene, overrides) in [(block, plane), (cube, solid)] {
        for solver in [whole.as_str(), "condensed"] {
            let (_folder, scene) = Folder::with_scene(scene);
            let changes = overrides.iter().flat_map(|change| ["--set", change]);
            let args: Vec<&str> = ["run", &scene, "--json", "--solver", solver].into_iter().chain(changes).collect();
            let on = |threads| stickslip(None, &[&args[..], &["--threads", threads]].concat());
            let one = on("1");
            for many in ["2", "3"] {
                let many = on(many);
                let iterations = |report: &Value| -> Vec<u64> {
                    report["increments"].as_array().unwrap().iter().map(|record| count(&record["iterations"])).collect()
                };
                assert_eq!(iterations(&one), iterations(&many), "{solver}");
                let mut both = Vec::new();
                numbers(&one["forces"], &many["forces"], &mut both);
                let largest = both.iter().map(|[one, _]| one.abs()).fold(0.0, f64::max);
                assert!(both.len() > 10 && largest > 0.0);
                let worst = both.iter().map(|[one, many]| (one - many).abs()).fold(0.0, f64::max);
                assert!(worst <= 1e-12 * largest, "{solver}: {worst:e} of {largest:e}");
            }
        }
    }
}

/// Returns a comparison without its times.
fn untimed(mut comparison: Comparison) -> Comparison {
    for run in &mut comparison.runs {
        run.course.seconds = Phases::default();
        run.course.iterates.iter_mut().for_each(|iterate| iterate.seconds = 0.0);
    }
    comparison.meshes.iter_mut().for_each(|mesh| mesh.seconds = 0.0);
    comparison
}

#[test]
fn a_comparison_does_not_depend_on_how_many_run_at_a_time() {
    let scene = Scene::parse("scene.toml", &small(), &[]).unwrap();
    let paths = [LinearAlgebra::default(), LinearAlgebra::condensed()]
        .map(|linear| SolverPath { method: Method::BN.into(), linear: Some(linear) });
    let meshes = [6, 2, 4].map(|n| MeshSize::Elements(n).into()).to_vec();
    let at_a_time = |jobs| {
        let plan = Plan { paths: paths.to_vec(), meshes: meshes.clone(), increments: vec![4, 2], reference: 2, jobs };
        let comparison = compare::compute(&scene, &plan, &(), &mut |_| (), || false).unwrap();
        assert!(comparison.runs.iter().all(|run| run.course.seconds.cpu > 0.0));
        untimed(comparison)
    };
    let one = at_a_time(1);
    assert_eq!(one.runs.len(), 12);
    assert_eq!(at_a_time(2), one);
    assert_eq!(at_a_time(5), one);
}
