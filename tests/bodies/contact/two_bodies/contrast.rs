//! A stiff body that only contact with a soft one holds.

use crate::common::pairs::pushed;
use crate::common::prelude::*;

/// The block above is so many times as stiff as the one below.
fn stack(contrast: f64, slave: Side) -> Description {
    let lower = (MeshSource::block([1.0, 0.5], [8, 4]), 210e9 / contrast);
    let upper = (MeshSource::block([1.0, 0.5], [11, 5]), 210e9);
    pushed(bodies(lower, upper, Some([0.0, 0.5].into()), equal_increments(20.0, 20)), slave)
}

/// The stiff body is carried by far more than it deforms: one word for its displacements would leave 5e-9 of the forces at a contrast
/// of a million.
#[test]
fn stiff_on_soft() {
    for contrast in [1e4, 1e6] {
        for slave in [Side::Upper, Side::Lower] {
            let model = Model::build(&stack(contrast, slave)).unwrap();
            let mut reference = None;
            for (method, linear) in [
                (Method::BN, LinearAlgebra::Whole(SparseLu::default())),
                (Method::BN, LinearAlgebra::Whole(SparseLu::Faer)),
                (Method::BN, LinearAlgebra::Condensed(SparseCholesky::default())),
                (Method::Ip, LinearAlgebra::Whole(SparseLu::default())),
                (Method::Ip, LinearAlgebra::Condensed(SparseCholesky::default())),
            ] {
                let mut keep = Keep::default();
                let solver = SolverChoice { linear: Some(linear), tolerance: 1e-10, ..SolverChoice::new(method) };
                let run = Run::of(&model, model.times().to_vec(), solver).unwrap();
                let outcome = run.history(&mut keep).unwrap();
                let counts: Vec<usize> = iterations(&outcome);
                let worst = outcome.records.iter().map(|record| record.kkt.worst().1).fold(0.0, f64::max);
                println!(
                    "{contrast:e} {slave:?} {method:?} {linear:?}: {counts:?}, {} in all, error {worst:.1e}",
                    counts.iter().sum::<usize>()
                );
                assert_eq!(outcome.status, Status::Converged, "{contrast:e} {slave:?} {method:?} {linear:?}");
                let reference = reference.get_or_insert_with(|| keep.states.clone());
                let apart = difference(reference, &keep.states);
                assert!(apart < 1e-6, "{contrast:e} {slave:?} {method:?} {linear:?} {apart:e}");
            }
        }
    }
}
