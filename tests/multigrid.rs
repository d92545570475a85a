//! Multigrid against the direct solver.
#![cfg(feature = "petsc")]
#![allow(clippy::unwrap_used, clippy::print_stdout)]

use stickslip::run::Run;
use stickslip::scene::{Override, Scene};

fn report(scene: &str, overrides: &[String]) -> stickslip::report::RunReport {
    let path = format!("{}/data/scenes/{scene}.toml", env!("CARGO_MANIFEST_DIR"));
    let overrides: Vec<Override> = overrides.iter().map(|o| o.parse().unwrap()).collect();
    let scene = Scene::read(path.as_ref(), &overrides).unwrap();
    Run::new(&scene).unwrap().solve(&mut ()).unwrap()
}

#[test]
fn the_cube() {
    let n: usize = std::env::var("N").map_or(6, |n| n.parse().unwrap());
    let set = |linear: &str| {
        vec![
            format!("mesh.elements=[{n},{n},{n}]"),
            "time.increments=4".to_string(),
            format!("solver.linear=\"{linear}\""),
        ]
    };
    for linear in ["umfpack", "multigrid"] {
        let report = report("cube", &set(linear));
        let iterations: Vec<usize> = report.increments.iter().map(|r| r.iterations).collect();
        println!("{linear} {:?} {iterations:?} {:?}", report.status, report.totals);
    }
}
