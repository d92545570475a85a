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
        805151.7220,
        1304763.7720,
        1164776.2691,
        1069746.4843,
        987537.1824,
        918519.9553,
        865443.9645,
        804157.5978,
        729193.3768,
        640599.2858,
        518226.1180,
        191884.2721,
    ];
    let p_t = [
        -161030.34441,
        -194227.30420,
        -232955.25380,
        -213949.29687,
        -197507.43647,
        -183703.99106,
        -173088.79290,
        -160831.51957,
        -145838.67535,
        -128119.85717,
        -3526.23548,
        -5221.29273,
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
        1053722.6767,
        1727464.7745,
        1490806.1295,
        1351907.9913,
        1227197.2279,
        1110004.7537,
        984203.3680,
        766378.5232,
        288314.5552,
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
