//! A brick on a larger one, pressed and then pushed round a corner.

#![allow(clippy::unwrap_used)]

use crate::common::pairs::{Side, bodies, paired, solved, solver};
use std::ops::ControlFlow;
use stickslip::algebra::linear::{SparseCholesky, SparseLu};
use stickslip::base::equal_increments;
use stickslip::body::mesh::MeshSource;
use stickslip::body::{Axis, Description, Load, Model};
use stickslip::run::report::ContactLine;
use stickslip::solver::history::{IncrementView, LinearAlgebra, Method, Observer};
use stickslip_output::ContactSurface;

/// Observer that checks the surface shown in pictures.
struct Maps<'a>(&'a Model, usize);

impl Observer for Maps<'_> {
    fn increment(&mut self, step: &IncrementView<'_>) -> ControlFlow<()> {
        let maps = ContactSurface::all(self.0, step);
        let drawn: f64 = maps[0].nodes.iter().map(|node| node.pressure).fold(0.0, f64::max);
        let lines = ContactLine::all(self.0, step);
        let largest = lines[0].points.iter().map(|point| point.sigma_n).fold(0.0, f64::max);
        assert_eq!((maps.len(), drawn), (1, largest));
        // No support is near. Beside the other brick, nothing is in front of a node.
        let beside = maps[0].nodes.iter().any(|node| node.status.is_none());
        let svg = maps[0].to_svg("").unwrap();
        assert_eq!([svg.contains("\nheld by supports\n"), svg.contains("\nnothing in front\n")], [false, beside]);
        self.1 += 1;
        ControlFlow::Continue(())
    }
}

fn bricks(slave: Side) -> Description {
    let lower = (MeshSource::block([1.0, 1.0, 0.5], [3, 3, 2]), 210e9);
    let upper = (MeshSource::block([0.6, 0.6, 0.5], [4, 4, 2]), 70e9);
    let description = bodies(lower, upper, Some([0.2, 0.2, 0.5].into()), equal_increments(10.0, 10));
    paired(description, slave, 0.2)
        .support("lower:bottom", &[Axis::X, Axis::Y, Axis::Z])
        .load(Load::new("upper:top", &[0.0, 0.0, -10e6]).over(&[[0.0, 0.0], [2.0, 1.0]]))
        .load(Load::new("upper:top", &[1.2e6, 0.6e6, 0.0]).over(&[[2.0, 0.0], [6.0, 1.0], [10.0, 0.0]]))
        .load(Load::new("upper:top", &[0.0, 1.4e6, 0.0]).over(&[[6.0, 0.0], [10.0, 1.0]]))
}

#[test]
fn bricks_slide_round_a_corner() {
    let cases = [
        (Side::Upper, [5, 1, 5, 4, 4, 4, 4, 5, 5, 5], [2.463_550_541_0e5, -8.221_924_016_3e2, -4.926_415_032_1e4]),
        (Side::Lower, [5, 1, 5, 4, 4, 4, 4, 4, 5, 4], [8.797_592_165_7e5, -7.331_262_749_8e4, -1.546_375_174_5e5]),
    ];
    for (slave, most_iterations, expected) in cases {
        let model = Model::build(&bricks(slave)).unwrap();
        let weights: f64 = model.contact.nodes.iter().map(|contact| contact.weight).sum();
        assert!((weights - 0.36).abs() < 1e-14);
        for linear in [LinearAlgebra::Condensed(SparseCholesky::default()), LinearAlgebra::Whole(SparseLu::default())] {
            let mut maps = Maps(&model, 0);
            let outcome = solved(&model, solver(Method::BN, linear), &mut maps);
            assert_eq!(maps.1, 10);
            let iterations: Vec<usize> = outcome.records.iter().map(|record| record.iterations).collect();
            // Single increments may take more iterations, but not all of them together.
            let (all, most) = (iterations.iter().sum::<usize>(), most_iterations.iter().sum());
            assert!(all <= most, "{slave:?} {linear:?} {iterations:?}");
            let state = outcome.state;
            let largest =
                (0..model.contact.nodes.len()).max_by(|a, b| state.p_n[*a].total_cmp(&state.p_n[*b])).unwrap();
            let found = [state.p_n[largest], state.p_t[largest], state.p_o[largest]];
            for (found, expected) in found.iter().zip(expected) {
                assert!((found - expected).abs() < 1e-8 * expected.abs(), "{slave:?} {found} {expected}");
            }
            if slave == Side::Upper {
                let sums = [state.p_n.iter().sum::<f64>() / 3.6e6, state.p_o.iter().sum::<f64>() / -5.04e5];
                assert!(sums.iter().all(|sum| (sum - 1.0).abs() < 1e-10), "{sums:?}");
            }
        }
    }
}
