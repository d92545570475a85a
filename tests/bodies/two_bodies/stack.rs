//! A block on another with friction, pressed, pushed and pushed back.

use crate::common::pairs::{Side, solved, solver, stack};
use crate::common::{Keep, difference};
use stickslip::history::{LinearAlgebra, Method};
use stickslip::linear::{SparseCholesky, SparseLu};
use stickslip::model::Model;

const CONDENSED: LinearAlgebra = LinearAlgebra::Condensed(SparseCholesky::Cholmod);

/// Iterations, statuses after every fifth increment and the forces at the end, from left to right.
#[test]
fn a_finer_block_on_a_coarser_one() {
    let model = Model::build(&stack([8, 4], [11, 5], Side::Upper)).unwrap();
    let mut keep = Keep::default();
    let outcome = solved(&model, solver(Method::BN, CONDENSED), &mut keep);
    let iterations: Vec<usize> = outcome.records.iter().map(|record| record.iterations).collect();
    let expected = [2, 1, 1, 1, 1, 2, 1, 1, 1, 4, 2, 1, 1, 1, 1, 1, 2, 1, 3, 3];
    // Where the load turns round another start takes two iterations more.
    assert!(iterations.iter().zip(expected).all(|(found, expected)| found.abs_diff(expected) <= 2), "{iterations:?}");
    assert!(iterations.iter().sum::<usize>().abs_diff(expected.iter().sum()) <= 1, "{iterations:?}");
    let p_n = [
        805_151.722_0,
        1_304_763.772_0,
        1_164_776.269_1,
        1_069_746.484_3,
        987_537.182_4,
        918_519.955_3,
        865_443.964_5,
        804_157.597_8,
        729_193.376_8,
        640_599.285_8,
        518_226.118_0,
        191_884.272_1,
    ];
    let p_t = [
        -161_030.344_41,
        -194_227.304_20,
        -232_955.253_80,
        -213_949.296_87,
        -197_507.436_47,
        -183_703.991_06,
        -173_088.792_90,
        -160_831.519_57,
        -145_838.675_35,
        -128_119.857_17,
        -3_526.235_48,
        -5_221.292_73,
    ];
    let mut order: Vec<usize> = (0..model.contacts.len()).collect();
    order.sort_by(|a, b| model.contacts[*a].position[0].total_cmp(&model.contacts[*b].position[0]));
    for (k, i) in order.into_iter().enumerate() {
        let (n, t) = (outcome.state.p_n[i], outcome.state.p_t[i]);
        assert!((n / p_n[k] - 1.0).abs() < 1e-9 && (t / p_t[k] - 1.0).abs() < 1e-7, "{k}: {n} {t}");
    }
}

#[test]
fn the_coarser_side_as_the_slave() {
    let model = Model::build(&stack([8, 4], [11, 5], Side::Lower)).unwrap();
    let outcome = solved(&model, solver(Method::BN, CONDENSED), &mut ());
    let mut p_n: Vec<(f64, f64)> =
        model.contacts.iter().zip(&outcome.state.p_n).map(|(contact, p)| (contact.position[0], *p)).collect();
    p_n.sort_by(|a, b| a.0.total_cmp(&b.0));
    let expected = [
        1_053_722.676_7,
        1_727_464.774_5,
        1_490_806.129_5,
        1_351_907.991_3,
        1_227_197.227_9,
        1_110_004.753_7,
        984_203.368_0,
        766_378.523_2,
        288_314.555_2,
    ];
    for ((x, found), expected) in p_n.iter().zip(expected) {
        assert!((found / expected - 1.0).abs() < 1e-9, "{x}: {found}");
    }
}

/// Every linear algebra and every method come to the same.
#[test]
fn all_ways_agree() {
    let model = Model::build(&stack([8, 4], [11, 5], Side::Upper)).unwrap();
    let run = |method, linear| {
        let mut keep = Keep::default();
        solved(&model, solver(method, linear), &mut keep);
        keep.states
    };
    let reference = run(Method::BN, CONDENSED);
    for (method, linear) in [
        (Method::BN, LinearAlgebra::Whole(SparseLu::Umfpack)),
        (Method::BN, LinearAlgebra::Whole(SparseLu::Faer)),
        (Method::BN, LinearAlgebra::Condensed(SparseCholesky::Faer)),
        (Method::IP, LinearAlgebra::Whole(SparseLu::Umfpack)),
        (Method::IP, CONDENSED),
    ] {
        let apart = difference(&reference, &run(method, linear));
        assert!(apart < 1e-8, "{method:?} {linear:?}: {apart:e}");
    }
}
