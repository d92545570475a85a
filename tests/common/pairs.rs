//! Two blocks, one on the other.

use super::Keep;
use stickslip::algebra::Vector;
use stickslip::algebra::linear::SparseLu;
use stickslip::base::equal_increments;
use stickslip::body::fem::{Material, MaterialGroup};
use stickslip::body::mesh::{Body, MeshSource};
use stickslip::body::{Axis, Description, Load, Model};
use stickslip::run::Run;
use stickslip::solver::State;
use stickslip::solver::history::{HistoryOutcome, LinearAlgebra, Method, SolverChoice, Status};

/// Which of two bodies is the slave.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Side {
    Upper,
    Lower,
}

/// The body `lower` with its material, and `upper` on it.
pub fn bodies(lower: (MeshSource, f64), upper: (MeshSource, f64), at: Option<Vector>, times: Vec<f64>) -> Description {
    let body = |name: &str, mesh: MeshSource, at| Body { name: name.into(), mesh, at };
    let group =
        |name: &str, young| MaterialGroup { name: name.into(), young, poisson: 0.3, ..MaterialGroup::default() };
    let mut material = Material::new(lower.1, 0.3);
    material.groups = vec![group("lower", lower.1), group("upper", upper.1)];
    let mesh = MeshSource::Bodies(vec![body("lower", lower.0, None), body("upper", upper.0, at)]);
    Description::new(mesh, material, times)
}

/// With the lower end of the upper body in front of the upper end of the lower one.
pub fn paired(description: Description, slave: Side, friction: f64) -> Description {
    match slave {
        Side::Upper => description.pair("upper:bottom", friction, "lower:top"),
        Side::Lower => description.pair("lower:top", friction, "upper:bottom"),
    }
}

/// A block on another, held by contact alone, that is pressed, pushed and pushed back.
pub fn stack(lower: [usize; 2], upper: [usize; 2], slave: Side) -> Description {
    let lower = (MeshSource::block([1.0, 0.5], lower), 210e9);
    let upper = (MeshSource::block([1.0, 0.5], upper), 70e9);
    pushed(bodies(lower, upper, Some([0.0, 0.5].into()), equal_increments(20.0, 20)), slave)
}

/// The lower body clamped, the upper one pressed, pushed and pushed back with friction.
pub fn pushed(description: Description, slave: Side) -> Description {
    paired(description, slave, 0.2)
        .support("lower:bottom", &[Axis::X, Axis::Y])
        .load(Load::new("upper:top", &[0.0, -10e6]).over(&[[0.0, 0.0], [5.0, 1.0]]))
        .load(Load::new("upper:top", &[1.8e6, 0.0]).over(&[[5.0, 0.0], [10.0, 1.0], [20.0, -1.0]]))
}

/// BN on the condensed system to the last digits.
pub fn solver(method: Method, linear: LinearAlgebra) -> SolverChoice {
    SolverChoice { linear: Some(linear), tolerance: 1e-12, ..SolverChoice::new(method) }
}

/// The history of `model`, and its end, which is converged.
pub fn solved(
    model: &Model,
    solver: SolverChoice,
    observer: &mut dyn stickslip::solver::history::Observer,
) -> HistoryOutcome {
    let outcome = Run::of(model, model.times().to_vec(), solver).unwrap().history(observer).unwrap();
    assert_eq!(outcome.status, Status::Converged, "{solver:?}");
    outcome
}

/// Both methods, whole and condensed.
pub fn ways() -> [(Method, LinearAlgebra); 4] {
    let [whole, condensed] = [LinearAlgebra::Whole(SparseLu::default()), LinearAlgebra::condensed()];
    [(Method::BN, condensed), (Method::BN, whole), (Method::Ip, whole), (Method::Ip, condensed)]
}

/// The states of all increments, to the last digits.
pub fn states(model: &Model, (method, linear): (Method, LinearAlgebra)) -> Vec<State> {
    let mut keep = Keep::default();
    solved(model, solver(method, linear), &mut keep);
    keep.states
}
