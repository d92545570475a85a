//! Multigrid is another way to the same answer: every scene of the project, reduced, against the direct solver of this build.
#![cfg(feature = "petsc")]
#![allow(clippy::unwrap_used, clippy::print_stdout)]

use serde_json::Value;
use stickslip::run::Run;
use stickslip::scene::{Override, Scene};

fn report(name: &str, overrides: &[&str]) -> Value {
    let path = format!("{}/data/scenes/{name}.toml", env!("CARGO_MANIFEST_DIR"));
    let overrides: Vec<Override> = overrides.iter().map(|o| o.parse().unwrap()).collect();
    let scene = Scene::read(path.as_ref(), &overrides).unwrap();
    let report = Run::new(&scene).unwrap().solve(&mut ()).unwrap();
    serde_json::from_str(&report.to_json().unwrap()).unwrap()
}

/// Iterations of each increment.
fn iterations(report: &Value) -> Vec<u64> {
    report["increments"].as_array().unwrap().iter().map(|record| record["iterations"].as_u64().unwrap()).collect()
}

fn number(value: &Value) -> f64 {
    value.as_f64().unwrap_or(0.0)
}

/// Solved by both: equal forces, and iterations within two, an increment. The Krylov iterations, and whether multigrid gave way.
fn agree(name: &str, overrides: &[&str]) -> (u64, bool) {
    let with = |linear: &str| report(name, &[overrides, &["time.increments=4", linear]].concat());
    let direct = with("solver.linear=\"umfpack\"");
    let multigrid = with("solver.linear=\"multigrid\"");
    let words = |value: &Value| value["status"].as_str().unwrap().to_string();
    let (by, expected) = (iterations(&multigrid), iterations(&direct));
    let krylov = multigrid["totals"]["krylov_iterations"].as_u64().unwrap_or(0);
    let warnings = multigrid["warnings"].as_array().unwrap();
    let gave_way = warnings.iter().any(|warning| warning["kind"] == "multigrid-gave-way");
    println!(
        "{name}: {} {by:?}, direct {expected:?}; {krylov} Krylov{}",
        words(&multigrid),
        if gave_way { ", gave way" } else { "" }
    );
    assert_eq!(words(&multigrid), words(&direct), "{name}");
    let scale = number(&direct["final"]["sum_p_n"]).abs().max(number(&direct["final"]["sum_p_t"]).abs());
    for key in ["sum_p_n", "sum_p_t"] {
        let (found, expected) = (number(&multigrid["final"][key]), number(&direct["final"][key]));
        assert!((found - expected).abs() <= 1e-10 * scale, "{name}: {key} {found:e} {expected:e}");
    }
    for (found, expected) in by.iter().zip(&expected) {
        assert!(found.abs_diff(*expected) <= 2, "{name}: {by:?}, direct {expected:?}");
    }
    (krylov, gave_way)
}

#[test]
fn every_scene_is_what_the_direct_solver_says() {
    let scenes: [(&str, &[&str]); 20] = [
        ("block", &["mesh.elements=[20,20]"]),
        ("boxed", &[]),
        ("cattaneo_mindlin", &["mesh.elements=[[6,8,6],8]"]),
        ("confined", &[]),
        ("cube", &["mesh.elements=[6,6,6]"]),
        ("cycles", &[]),
        ("disk", &["mesh.elements=[6,6,3]"]),
        ("frictionless", &["mesh.elements=[10,10]"]),
        ("held_by_contact", &[]),
        ("hertz_line", &["mesh.contact_elements=8", "mesh.outer_elements=8", "mesh.layers=6"]),
        ("hertz_sphere", &["mesh.elements=[[4,3],[4,3],5]"]),
        ("mindlin_sphere", &["mesh.elements=[[2,4,2],[2,2],3]"]),
        ("punch", &["mesh.contact_elements=8", "mesh.outer_elements=8", "mesh.layers=4"]),
        ("seal", &["mesh.elements=[8,8]"]),
        ("ssnv128", &[]),
        ("strip", &["mesh.elements=[40,4]"]),
        ("tip", &["mesh.elements=[8,5,3]"]),
        ("turning_load", &["mesh.elements=[8,8]"]),
        ("two_blocks", &[]),
        ("wedge", &[]),
    ];
    for (name, overrides) in scenes {
        agree(name, overrides);
    }
}
