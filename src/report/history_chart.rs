//! A history as charts: the forces on the obstacles over time, and the iterations that each increment took.

use super::chart::{Axis, Chart, Curve, Panel, Scale};
use super::resultant::ForceRecord;
use super::run::RunReport;
use super::svg::{Dash, Line, Marker};
use crate::history::{IncrementRecord, Status};
use crate::units::Quantity;

const BLACK: [u8; 3] = [0, 0, 0];
const COMPONENTS: [(&str, [u8; 3], Dash); 3] = [
    ("along x", [200, 50, 32], Dash::Solid),
    ("along y", [0, 90, 181], Dash::Dashed),
    ("along z", [20, 130, 60], Dash::DashDotted),
];

/// With more increments than this a marker for each hides the line.
const MOST_MARKERS: usize = 60;

/// Up to this count each number has a tick of its own.
const MOST_TICKS: usize = 300;
const MOST_TICKS_UPWARDS: usize = 60;

/// The charts of a report, each with the stem of a file name: `forces`, if contact forces were found, and `iterations`, if there
/// was any increment.
pub fn history_charts(report: &RunReport) -> Vec<(&'static str, Chart)> {
    // An increment that failed is the last one.
    let failed = report.increments.iter().find(|record| record.status != Status::Converged).map(|record| record.index);
    let found: Vec<&ForceRecord> = report.forces.iter().filter(|record| Some(record.index) != failed).collect();
    let mut charts = Vec::new();
    if !found.is_empty() {
        charts.push(("forces", forces(report, &found)));
    }
    if !report.increments.is_empty() {
        charts.push(("iterations", iterations(report)));
    }
    charts
}

fn few(report: &RunReport, marker: Marker) -> Option<Marker> {
    (report.increments.len() <= MOST_MARKERS).then_some(marker)
}

/// The force of the body on the obstacle in front of each boundary, from the undeformed body on.
fn forces(report: &RunReport, found: &[&ForceRecord]) -> Chart {
    let mut boundaries: Vec<&str> = Vec::new();
    for record in found {
        if !boundaries.contains(&record.resultant.boundary.as_str()) {
            boundaries.push(&record.resultant.boundary);
        }
    }
    let told = |force: f64| report.units.of_si(Quantity::Force, force);
    let panel = |boundary: &&str| {
        let on_this = |record: &&&ForceRecord| record.resultant.boundary == **boundary;
        let records: Vec<&ForceRecord> = found.iter().filter(on_this).copied().collect();
        let dimension = records.first().map_or(0, |record| record.resultant.force.len());
        let curve = |(c, (label, colour, dash)): (usize, (&str, [u8; 3], Dash))| Curve {
            label: label.to_string(),
            points: [[0.0, 0.0]]
                .into_iter()
                .chain(records.iter().map(|record| [record.time, told(record.resultant.force[c])]))
                .collect(),
            line: Some(Line { dash, width: 1.8 }),
            marker: few(report, Marker::Disc),
            colour,
        };
        let curves = COMPONENTS.into_iter().take(dimension).enumerate().map(curve).collect();
        Panel { title: if boundaries.len() > 1 { (*boundary).to_string() } else { String::new() }, curves }
    };
    let unit = match (report.units.per_depth, report.units.is_si()) {
        (true, true) => "N per m of depth".to_string(),
        _ => report.units.name(Quantity::Force),
    };
    Chart {
        title: report.title.clone(),
        subtitle: match &boundaries[..] {
            [one] => match found.iter().find_map(|record| record.resultant.opposite.as_ref()) {
                Some(of) => format!("force of {one} on {}", of.boundary),
                None => format!("force of the body on the obstacle at {one}"),
            },
            _ if found.iter().any(|record| record.resultant.opposite.is_some()) => {
                "force of the body on what is in front of each boundary".to_string()
            }
            _ => "force of the body on the obstacle at each boundary".to_string(),
        },
        x: Axis { label: "time, s".into(), scale: Scale::Linear },
        y: Axis { label: format!("force, {unit}"), scale: Scale::Linear },
        columns: if boundaries.len() > 1 { 2 } else { 1 },
        panels: boundaries.iter().map(panel).collect(),
    }
}

/// The scale of counts up to `highest`.
fn counts(highest: usize, most_ticks: usize) -> Scale {
    if highest > most_ticks { Scale::Linear } else { Scale::Integers }
}

/// Iterations and shortened steps of each increment.
fn iterations(report: &RunReport) -> Chart {
    let points = |count: fn(&IncrementRecord) -> usize, wanted: fn(&IncrementRecord) -> bool| {
        let records = report.increments.iter().filter(|record| wanted(record));
        records.map(|record| [record.index as f64, count(record) as f64]).collect::<Vec<_>>()
    };
    let line = |label: &str, dash, colour, marker, points| Curve {
        label: label.into(),
        points,
        line: Some(Line { dash, width: 1.6 }),
        marker: few(report, marker),
        colour,
    };
    let mark = |label: &str, marker, points| Curve {
        label: label.into(),
        points,
        line: None,
        marker: Some(marker),
        colour: [200, 50, 32],
    };
    let mut curves = vec![
        mark("did not converge", Marker::Circle, points(|r| r.iterations, |r| r.status != Status::Converged)),
        mark("halved", Marker::Square, points(|r| r.iterations, |r| r.parts > 1)),
        mark("solved by ip", Marker::Triangle, points(|r| r.iterations, |r| r.rescued)),
        line("iterations", Dash::Solid, BLACK, Marker::Disc, points(|r| r.iterations, |_| true)),
        line("shortened steps", Dash::Dashed, [0, 90, 181], Marker::Circle, points(|r| r.backtracks, |_| true)),
    ];
    curves.retain(|curve| curve.points.iter().any(|point| point[1] > 0.0));
    let highest = curves.iter().flat_map(|curve| &curve.points).map(|point| point[1]).fold(0.0, f64::max);
    let totals = &report.totals;
    Chart {
        title: report.title.clone(),
        subtitle: format!(
            "{} {}, {}: {} iterations, {} factorisations",
            report.method, report.setting, report.solver, totals.iterations, totals.factorizations
        ),
        x: Axis { label: "increment".into(), scale: counts(report.increments.len(), MOST_TICKS) },
        y: Axis { label: "linear systems, steps".into(), scale: counts(highest as usize, MOST_TICKS_UPWARDS) },
        columns: 1,
        panels: vec![Panel { title: String::new(), curves }],
    }
}
