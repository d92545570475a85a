//! Every scene of the project, reduced, and the report of its run.

use serde_json::Value;
use stickslip::run::Run;
use stickslip::scene::{Override, Scene};

/// The scenes, each with the overrides that reduce it.
pub const SCENES: [(&str, &[&str]); 22] = [
    ("block", &["mesh.elements=[20,20]"]),
    ("bolt", &[]),
    ("boxed", &[]),
    ("cattaneo_mindlin", &["mesh.elements=[[6,8,6],8]"]),
    ("confined", &[]),
    ("cube", &["mesh.elements=[6,6,6]"]),
    ("cycles", &["time.end=8", "output.times=[8]"]),
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
    ("tilted_punch", &[]),
    ("tip", &["mesh.elements=[8,5,3]"]),
    ("turning_load", &["mesh.elements=[8,8]"]),
    ("two_blocks", &[]),
    ("wedge", &[]),
];

/// The override for all scenes.
pub const INCREMENTS: &str = "time.increments=4";

pub fn path(name: &str) -> String {
    format!("{}/../../data/scenes/{name}.toml", env!("CARGO_MANIFEST_DIR"))
}

/// Returns the report of a scene with these overrides, solved by `linear`.
pub fn report(name: &str, overrides: &[&str], linear: &str) -> Value {
    stickslip_distributed::add();
    let linear = format!("solver.linear={linear:?}");
    let overrides: Vec<Override> =
        overrides.iter().chain(&[INCREMENTS, &linear]).map(|change| change.parse().unwrap()).collect();
    let scene = Scene::read(path(name).as_ref(), &overrides).unwrap();
    let report = Run::new(&scene).unwrap().solve(&mut ()).unwrap();
    serde_json::from_str(&report.to_json().unwrap()).unwrap()
}

/// Returns the iterations of each increment.
pub fn iterations(report: &Value) -> Vec<u64> {
    report["increments"].as_array().unwrap().iter().map(|record| record["iterations"].as_u64().unwrap()).collect()
}

fn number(value: &Value) -> f64 {
    value.as_f64().unwrap_or(0.0)
}

/// Checks for equal verdicts, and for equal sums of forces to `tolerance` of the larger one.
pub fn assert_same_forces(name: &str, report: &Value, expected: &Value, tolerance: f64) {
    assert_eq!(report["status"], expected["status"], "{name}");
    let end = |report: &Value, key: &str| number(&report["final"][key]);
    let scale = end(expected, "sum_p_n").abs().max(end(expected, "sum_p_t").abs());
    for key in ["sum_p_n", "sum_p_t"] {
        let [found, expected] = [report, expected].map(|report| end(report, key));
        assert!((found - expected).abs() <= tolerance * scale, "{name}: {key} {found:e} {expected:e}");
    }
}
