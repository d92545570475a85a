//! The curves of charts.

use stickslip::base::{Quantity, UnitSystem};
use stickslip_output::{Curve, Dash, Line, curve_style};

/// The lines of curves that have no marker.
pub(crate) const DASHES: [Dash; 4] = [Dash::Solid, Dash::Dashed, Dash::Dotted, Dash::DashDotted];

/// Returns curve `k` of many, which has a colour, a marker and a line of its own.
pub(crate) fn curve(k: usize, label: String, points: Vec<[f64; 2]>) -> Curve {
    let (colour, marker) = curve_style(k);
    let line = Some(Line { dash: DASHES[k / 4 % DASHES.len()], width: 1.8 });
    Curve { label, points, line, marker: Some(marker), colour }
}

/// Groups labelled points by their labels, in the order in which these come.
pub(crate) fn grouped(points: impl Iterator<Item = (String, [f64; 2])>) -> Vec<Curve> {
    let mut groups: Vec<(String, Vec<[f64; 2]>)> = Vec::new();
    for (label, point) in points {
        match groups.iter_mut().find(|(other, _)| *other == label) {
            Some((_, points)) => points.push(point),
            None => groups.push((label, vec![point])),
        }
    }
    groups.into_iter().enumerate().map(|(k, (label, points))| curve(k, label, points)).collect()
}

/// Returns a name with its unit, if it has one: `friction work [J]`.
pub(crate) fn labelled(name: &str, unit: &str) -> String {
    if unit.is_empty() { name.to_string() } else { format!("{name} [{unit}]") }
}

/// Returns the key of a value of a scene, or several keys, in words, and the unit if one key tells it:
/// `material young`, `Pa`.
pub(crate) fn scene_words(keys: &str, units: &UnitSystem) -> (String, String) {
    let unit = match keys.rsplit('.').next().unwrap_or_default().split('[').next().unwrap_or_default() {
        _ if keys.contains(',') => String::new(),
        "young" | "traction" | "pressure" => units.name(Quantity::Stress),
        "force" => units.name(Quantity::Force),
        "moment" => units.name(Quantity::Moment),
        "gap" | "radius" => units.name(Quantity::Length),
        "end" => "s".to_string(),
        _ => String::new(),
    };
    (keys.replace(['.', '_'], " "), unit)
}
