//! The same bodies in other numbers.

use crate::common::prelude::*;

/// The stack of `common::pairs` with lengths and stresses in units of which so many make a metre and a pascal.
fn stack(length: f64, stress: f64, slave: Side) -> Description {
    let block = |elements| MeshSource::block([length, 0.5 * length], elements);
    let (lower, upper) = ((block([8, 4]), 210e9 * stress), (block([11, 5]), 70e9 * stress));
    let body = crate::common::pairs::bodies(lower, upper, Some([0.0, 0.5 * length].into()), equal_increments(20.0, 20));
    crate::common::pairs::paired(body, slave, 0.2)
        .support("lower:bottom", &[Axis::X, Axis::Y])
        .load(Load::new("upper:top", &[0.0, -10e6 * stress]).over(&[[0.0, 0.0], [5.0, 1.0]]))
        .load(Load::new("upper:top", &[1.8e6 * stress, 0.0]).over(&[[5.0, 0.0], [10.0, 1.0], [20.0, -1.0]]))
}

/// Metres and pascals, millimetres and megapascals, micrometres and gigapascals.
const SYSTEMS: [[f64; 2]; 3] = [[1.0, 1.0], [1e3, 1e-6], [1e6, 1e-9]];

#[test]
fn units_do_not_matter() {
    for slave in [Side::Upper, Side::Lower] {
        for (method, linear) in [
            (Method::BN, LinearAlgebra::default()),
            (Method::BN, LinearAlgebra::condensed()),
            (Method::Ip, LinearAlgebra::default()),
        ] {
            let all = SYSTEMS.map(|[length, stress]| {
                let model = Model::build(&stack(length, stress, slave)).unwrap();
                let run = Run::of(&model, model.times().to_vec(), solver(method, linear)).unwrap();
                let outcome = run.history(&mut ()).unwrap();
                assert_eq!(outcome.status, Status::Converged);
                let counts: Vec<usize> = iterations(&outcome);
                let forces = [outcome.state.p_n, outcome.state.p_t].concat();
                (counts, forces.iter().map(|p| p / (length * stress)).collect::<Vec<f64>>())
            });
            let (counts, forces) = &all[0];
            for (others, found) in &all[1..] {
                assert_eq!(others, counts, "{method:?} {linear:?} {slave:?}");
                let apart = apart(found, forces);
                assert!(apart < 1e-11, "{method:?} {linear:?} {slave:?} {apart:e}");
            }
        }
    }
}
