//! The documented units of the numbers of a run.

#![allow(clippy::unwrap_used)]

use std::collections::BTreeMap;
use std::fs;
use std::path::Path;
use stickslip::base::Quantity;
use stickslip::run::report::{column_quantity, key_quantity};

fn page(name: &str) -> String {
    fs::read_to_string(Path::new(concat!(env!("CARGO_MANIFEST_DIR"), "/../..")).join("doc/reference").join(name))
        .unwrap()
}

/// Returns the rows of a table of a page, from its header on: the quoted words of the first cell, and the cells.
fn rows(page: &str, header: &str) -> Vec<(Vec<String>, Vec<String>)> {
    let table = &page[page.find(header).unwrap_or_else(|| panic!("no table {header}"))..];
    let lines = table.lines().skip(2).take_while(|line| line.starts_with('|'));
    lines
        .map(|line| {
            let cells: Vec<String> = line.trim_matches('|').split('|').map(|cell| cell.trim().to_string()).collect();
            (cells[0].split('`').skip(1).step_by(2).map(String::from).collect(), cells)
        })
        .collect()
}

fn quantity(unit: &str) -> Quantity {
    match unit {
        "m" => Quantity::Length,
        "m²" => Quantity::Area,
        "Pa" => Quantity::Stress,
        "N" => Quantity::Force,
        "N m" => Quantity::Moment,
        "J" => Quantity::Energy,
        "J/m²" => Quantity::EnergyPerArea,
        "Pa J/m²" => Quantity::StressEnergyPerArea,
        "" | "s" | "B" => Quantity::Number,
        other => panic!("what is {other}?"),
    }
}

/// Returns each documented key of a report with its unit.
pub fn documented_keys() -> BTreeMap<String, String> {
    let mut units = BTreeMap::new();
    for (keys, cells) in rows(&page("results.md"), "| key | unit |") {
        // Several keys share one unit, or have one each, where a dash is no unit.
        let of_each: Vec<&str> = cells[1].split(", ").collect();
        for (k, key) in keys.iter().enumerate() {
            units.insert(key.clone(), of_each.get(k).unwrap_or(&of_each[of_each.len() - 1]).replace('–', ""));
        }
    }
    units
}

/// The numbers documented in m, N, N m, J and Pa are converted, and no others.
#[test]
fn every_documented_number_has_its_quantity() {
    let keys = documented_keys();
    assert!(keys.len() > 80, "{}", keys.len());
    for (key, unit) in &keys {
        let name = key.rsplit('.').next().unwrap().trim_end_matches("[]");
        // Names and factors below `units` are not converted.
        if !key.starts_with("units") {
            assert_eq!(key_quantity(name), quantity(unit), "{key}");
        }
    }
    let (results, header) = (page("files.md"), "| column | unit |");
    for (at, _) in results.match_indices(header) {
        for (columns, cells) in rows(&results[at..], header) {
            for column in columns {
                assert_eq!(column_quantity(&column), Some(quantity(&cells[1])), "{column}");
            }
        }
    }
}
