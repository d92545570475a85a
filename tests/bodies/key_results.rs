//! The key results of a run against forces and pressures that are known.

#![allow(clippy::unwrap_used)]

use stickslip::body::fem::{Material, Plane};
use stickslip::body::mesh::block;
use stickslip::body::{Axis, Description, Model, Obstacle, Support};
use stickslip::run::Run;
use stickslip::run::report::RunReport;
use stickslip::solver::history::{Method, SolverChoice, Status};

const FRICTION: f64 = 0.3;

/// A block of 2 m by 1 m, pressed on a plane by 1 mm in the first half of the history, and drawn along it by `drawn`
/// (m) in the second half.
fn drawn(drawn: f64, friction: f64) -> RunReport {
    let material = Material::new(1e9, 0.0).in_plane(Plane::Stress);
    let times = (1..=20).map(|k| 0.1 * f64::from(k)).collect();
    let along = Support::new("top", &[Axis::X]).moved(&[drawn]).over(&[[1.0, 0.0], [2.0, 1.0]]);
    let down = Support::new("top", &[Axis::Y]).moved(&[-1e-3]).over(&[[0.0, 0.0], [1.0, 1.0]]);
    let body = Description::new(block(&[2.0, 1.0], &[8, 4]), material, times).held(along).held(down).contact(
        "bottom",
        friction,
        [Obstacle::plane(0.0)],
    );
    let model = Model::build(&body).unwrap();
    let report = Run::of(&model, model.times().to_vec(), SolverChoice::new(Method::BN)).unwrap();
    let report = report.solve(&mut ()).unwrap();
    assert_eq!(report.status, Status::Converged);
    report
}

/// Without transverse strain and friction, the pressure is uniform: E times 1 mm per m.
#[test]
fn the_mean_of_a_uniform_pressure_is_the_pressure() {
    let report = drawn(0.0, 0.0);
    let largest = report.largest_pressure.unwrap();
    for pressure in [largest.pressure, largest.mean_pressure] {
        assert!((pressure.unwrap() / 1e6 - 1.0).abs() < 1e-9, "{pressure:?}");
    }
    assert!(report.holding_force.is_none());
}

/// When all nodes slip, the block is held by the friction of its whole normal force.
#[test]
fn a_block_that_is_drawn_holds_by_its_friction() {
    let report = drawn(5e-3, FRICTION);
    let holding = report.holding_force.unwrap();
    let largest = FRICTION * report.boundaries[0].sums.sum_p_n;
    assert!((holding.magnitude / largest - 1.0).abs() < 1e-6, "{holding:?} {largest}");
    assert_eq!(holding.boundary, "bottom");
    assert!(holding.time > 1.0);
    // Before all nodes slip, it is less.
    let sticking = drawn(1e-4, FRICTION).holding_force.unwrap();
    assert!(sticking.magnitude < 0.5 * holding.magnitude, "{sticking:?}");
}
