//! The paper's punch: BN's part of Table I.
#![allow(clippy::unwrap_used)]

mod common;

use stickslip::history::Status;
use stickslip::model::Model;
use stickslip::scene::Scene;
use stickslip::tables::{PaperTable, ROUNDING};

/// The reconstructed mesh reproduces nle to rounding in 19 of 21 cells and to 0.1 in all; nls is
/// mostly one too many in the first increment. Cells with up to 20 increments are computed here.
#[test]
fn table_i() {
    let cases: Vec<_> = PaperTable::Punch.cases().into_iter().filter(|case| case.increments <= 20).collect();
    let cells: Vec<_> = cases.iter().map(|case| PaperTable::Punch.cell(case).unwrap()).collect();
    assert!(cells.iter().all(|cell| cell.status == Status::Converged));
    assert!(cells.iter().all(|cell| cell.nle_difference().abs() <= 0.1 + 1e-9), "{cells:?}");
    let equal = cells.iter().filter(|cell| cell.nle_difference().abs() <= ROUNDING + 1e-9).count();
    assert_eq!((equal, cells.len()), (14, 15));
    assert!(cells.iter().all(|cell| cell.nls_difference().abs() <= 1.6 + 1e-9), "{cells:?}");
}

/// At the end 23 of 31 nodes touch; the resultants come close to those of a history without time
/// error, 5.330137 and -1.023347 MN, as the increments get smaller.
#[test]
fn resultants_converge_to_the_exact_ones() {
    let error = |increments: usize| {
        let overrides = [format!("time.increments={increments}").parse().unwrap()];
        let scene = Scene::parse("punch.toml", include_str!("../data/scenes/punch.toml"), &overrides).unwrap();
        let model = Model::new(&scene).unwrap();
        assert_eq!((model.mesh.quads.len(), model.contacts.len()), (880, 31));
        let outcome = common::run(&scene, &model, &mut ());
        assert_eq!(outcome.status, Status::Converged);
        assert_eq!(outcome.records.last().unwrap().contact.open, 8);
        assert!((outcome.state.p_n.iter().sum::<f64>() - 5.330_137e6).abs() < 1e3);
        (outcome.state.p_t.iter().sum::<f64>() + 1.023_347e6).abs()
    };
    let errors = [20, 40, 80].map(error);
    assert!(errors[0] < 1e4 && errors[1] < 0.7 * errors[0] && errors[2] < 0.7 * errors[1], "{errors:?}");
}
