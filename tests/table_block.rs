//! The paper's block: Table II as far as it is quick, and the check values of the reconstruction.
#![allow(clippy::unwrap_used)]

mod common;

use stickslip::history::Status;
use stickslip::model::Model;
use stickslip::tables::{PaperTable, ROUNDING};

/// Iteration counts equal the published ones to rounding. The cells with 100 contact nodes take
/// minutes: `stickslip tables block` computes those.
#[test]
fn table_ii_up_to_20_contact_nodes() {
    for case in PaperTable::Block.cases().iter().filter(|case| case.contact_nodes <= 20) {
        let cell = PaperTable::Block.cell(case).unwrap();
        assert_eq!(cell.status, Status::Converged, "{cell:?}");
        assert!(cell.nle_difference().abs() <= ROUNDING + 1e-9, "{cell:?}");
        assert!(cell.nls_difference().abs() <= ROUNDING + 1e-9, "{cell:?}");
    }
}

#[test]
fn table_ii_with_50_contact_nodes_and_5_increments() {
    for case in PaperTable::Block.cases().iter().filter(|case| case.contact_nodes == 50 && case.increments == 5) {
        let cell = PaperTable::Block.cell(case).unwrap();
        assert!(cell.nle_difference().abs() <= ROUNDING + 1e-9, "{cell:?}");
        assert!(cell.nls_difference().abs() <= ROUNDING + 1e-9, "{cell:?}");
    }
}

/// Compares forces with six-decimal values in MN.
fn assert_forces(computed: &[f64], expected: &[f64]) {
    assert_eq!(computed.len(), expected.len());
    for (p, e) in computed.iter().zip(expected) {
        assert!((p * 1e-6 - e).abs() <= 0.51e-6, "{computed:?} {expected:?}");
    }
}

/// n = 5, mu = 0.4: contact forces at the maximum of Q1 and at the end, iterations and backtracks.
#[test]
fn check_values() {
    let p_n_max = [0.184_048, 1.135_931, 1.560_943, 1.662_502, 0.574_223];
    let p_n_end = [0.0, 0.582_627, 1.218_624, 1.860_807, 1.640_039];
    let p_t_end = [0.0, -0.020_448, 0.007_464, 0.625_733, 0.656_016];
    for (inc, iterations, backtracks) in
        [(1, vec![5, 3], vec![42, 23]), (5, vec![5, 3, 1, 1, 3, 2, 2, 2, 1, 1], vec![20, 1, 0, 0, 5, 22, 0, 7, 0, 0])]
    {
        let scene = common::block(&["mesh.elements=[5,5]", &format!("time.increments={}", 2 * inc)]);
        let model = Model::new(&scene).unwrap();
        let mut keep = common::Keep::default();
        let outcome = common::run(&scene, &model, &mut keep);
        assert_eq!(outcome.records.iter().map(|r| r.iterations).collect::<Vec<_>>(), iterations);
        assert_eq!(outcome.records.iter().map(|r| r.backtracks).collect::<Vec<_>>(), backtracks);
        let at_max = &keep.states[inc - 1];
        assert_forces(&at_max.p_n, &p_n_max);
        assert_forces(&at_max.p_t, &p_n_max.map(|p| -0.4 * p));
        if inc == 5 {
            assert_forces(&outcome.state.p_n, &p_n_end);
            assert_forces(&outcome.state.p_t, &p_t_end);
        }
    }
}

/// Exact resultants at the end of the history, where backward Euler has no error (mu = 0.4, n = 5).
#[test]
fn resultants_equal_the_exact_ones() {
    let scene = common::block(&["mesh.elements=[5,5]", "time.increments=10"]);
    let model = Model::new(&scene).unwrap();
    let outcome = common::run(&scene, &model, &mut ());
    assert!((outcome.state.p_n.iter().sum::<f64>() * 1e-6 - 5.302_096).abs() < 1e-6);
    assert!((outcome.state.p_t.iter().sum::<f64>() * 1e-6 - 1.268_765).abs() < 1e-6);
}
