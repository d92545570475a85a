//! The examples of doc/tutorials/examples.md, with fewer increments.

#![allow(clippy::unwrap_used)]

use std::path::Path;

use serde_json::Value;

use crate::program::{assert_exit, json, number, stickslip};

fn report(name: &str, sets: &[&str]) -> Value {
    let scene = Path::new(concat!(env!("CARGO_MANIFEST_DIR"), "/../..")).join("data/examples").join(name);
    let sets: Vec<&str> = sets.iter().flat_map(|set| ["--set", *set]).collect();
    let fixed = ["run", scene.to_str().unwrap(), "--json", "--solver", "condensed"];
    let output = stickslip(&[&fixed[..], &sets].concat());
    assert_exit(&output, 0);
    let report = json(&output);
    for increment in report["reactions"].as_array().unwrap() {
        assert!(number(&increment["balance"]) < 1e-11, "{name}: {increment}");
    }
    report
}

fn close(value: &Value, expected: f64, share: f64) {
    assert!((number(value) / expected - 1.0).abs() < share, "{value} {expected}");
}

#[test]
fn a_ring_shrunk_on_a_shaft() {
    let report = report("shrink.toml", &["time.increments=2"]);
    let pressure =
        210e9 * 20e-6 / 0.03 / ((0.03_f64.powi(2) + 0.05_f64.powi(2)) / (0.05_f64.powi(2) - 0.03_f64.powi(2)) + 0.3);
    close(&report["final"]["sum_p_n"], pressure * 0.03 * std::f64::consts::FRAC_PI_2, 1e-3);
}

#[test]
fn a_roller_in_a_groove() {
    let report = report("groove.toml", &["time.increments=4"]);
    // Only equilibrium is known: pressed down, with full friction.
    let pressed = &report["forces"][1];
    close(&pressed["sum_p_n"], 4e4 * 2.0 / 2.0_f64.sqrt() / (1.0 + 0.2), 1e-4);
    close(&report["forces"][3]["force"][0], 1.6e4, 1e-9);
}

#[test]
fn a_block_of_a_tread() {
    let report = report("tread.toml", &["time.increments=8"]);
    let sums = &report["final"];
    close(&sums["sum_p_t"], 0.8 * number(&sums["sum_p_n"]), 1e-8);
    close(&report["reactions"][7]["supports"][1]["force"][0], number(&sums["sum_p_t"]), 1e-8);
}

#[test]
fn a_bracket_on_a_wall() {
    let report = report("bracket.toml", &["time.increments=2"]);
    let end = &report["reactions"][1];
    close(&end["loads"][0]["force"][2], -3e5 * 0.052 * 0.02, 1e-12);
    close(&report["final"]["sum_p_n"], 15.5e3, 0.01);
    let up = number(&end["supports"][0]["force"][2]);
    let friction = number(&report["boundaries"][0]["force"][2]);
    assert!((up - 312.0 - friction).abs() < 1e-6 * up, "{up} {friction}");
}

#[test]
fn a_blade_in_its_slot() {
    let report = report("dovetail.toml", &["time.increments=3"]);
    let end = &report["boundaries"][0];
    // Everything slips: equilibrium along the pull.
    close(&end["sum_p_n"], 5400.0 / (0.6 + 0.3 * 0.8), 2e-3);
    for c in 0..3 {
        let [disc, blade] = [&end["force"][c], &end["opposite"]["force"][c]].map(number);
        assert!((disc + blade).abs() < 1e-9 * 5400.0, "{disc} {blade}");
    }
    close(&end["force"][1], -5400.0, 1e-10);
    let half = &report["forces"][1];
    close(&half["force"][1], -2700.0, 1e-10);
    // Friction reverses and holds the blade in.
    assert!(number(&half["sum_p_n"]) > 5300.0 && number(&half["sum_p_o"]) > 0.0 && number(&end["sum_p_o"]) < 0.0);
}
