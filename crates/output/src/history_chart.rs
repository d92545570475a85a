//! Charts of a history: the forces on the obstacles over time, and the iterations of each increment.

use super::chart::{Axis, Chart, Curve, Panel, Scale};
use super::svg::{BLACK, Dash, Line, Marker};
use stickslip::base::Quantity;
use stickslip::run::report::{ForceCurves, HistoryCurves, RunReport, Thinned};

const COMPONENTS: [(&str, [u8; 3], Dash); 3] = [
    ("along x", [200, 50, 32], Dash::Solid),
    ("along y", [0, 90, 181], Dash::Dashed),
    ("along z", [20, 130, 60], Dash::DashDotted),
];

/// With more increments than this, markers would hide the line and are not drawn.
const MAX_MARKERS: usize = 60;

/// Returns the charts of a report, each with the stem of a file name: `forces`, if there were contact forces, and
/// `iterations`, if there was any increment.
pub fn history_charts(report: &RunReport) -> Vec<(&'static str, Chart)> {
    let mut charts = Vec::new();
    if !report.curves.boundaries.is_empty() {
        charts.push(("forces", forces(report)));
    }
    if report.curves.increments > 0 {
        charts.push(("iterations", iterations(report)));
    }
    charts
}

fn few(report: &RunReport, marker: Marker) -> Option<Marker> {
    (report.curves.increments <= MAX_MARKERS).then_some(marker)
}

/// Plots the force of the body on the obstacle in front of each boundary, from the undeformed body on.
fn forces(report: &RunReport) -> Chart {
    let boundaries = &report.curves.boundaries;
    let in_units = |[time, force]: [f64; 2]| [time, report.units.of_si(Quantity::Force, force)];
    let panel = |of: &ForceCurves| {
        let curve = |((label, colour, dash), component): ((&str, [u8; 3], Dash), &Thinned)| Curve {
            label: label.to_string(),
            points: [[0.0, 0.0]].into_iter().chain(component.points().into_iter().map(in_units)).collect(),
            line: Some(Line { dash, width: 1.8 }),
            marker: few(report, Marker::Disc),
            colour,
        };
        let curves = COMPONENTS.into_iter().zip(&of.components).map(curve).collect();
        Panel {
            title: if boundaries.len() > 1 { of.boundary.clone() } else { String::new() },
            curves,
            ..Panel::default()
        }
    };
    let unit = report.units.name(Quantity::Force);
    Chart {
        title: report.title.clone(),
        subtitle: match &boundaries[..] {
            [ForceCurves { boundary, opposite: Some(of), .. }] => format!("force of {boundary} on {of}"),
            [ForceCurves { boundary, .. }] => format!("force of the body on the obstacle at {boundary}"),
            _ if boundaries.iter().any(|of| of.opposite.is_some()) => {
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

/// Plots the iterations and shortened steps of each increment.
fn iterations(report: &RunReport) -> Chart {
    let line = |label: &str, dash, colour, marker, of: &Thinned| Curve {
        label: label.into(),
        points: of.points(),
        line: Some(Line { dash, width: 1.6 }),
        marker: few(report, marker),
        colour,
    };
    let mark = |label: &str, marker, of: &Thinned| Curve {
        label: label.into(),
        points: of.points(),
        line: None,
        marker: Some(marker),
        colour: [200, 50, 32],
    };
    let HistoryCurves { iterations, backtracks, failed, halved, rescued, .. } = &report.curves;
    let mut curves = vec![
        mark("did not converge", Marker::Circle, failed),
        mark("halved", Marker::Square, halved),
        mark("solved by ip", Marker::Triangle, rescued),
        line("iterations", Dash::Solid, BLACK, Marker::Disc, iterations),
        line("shortened steps", Dash::Dashed, [0, 90, 181], Marker::Circle, backtracks),
    ];
    curves.retain(|curve| curve.points.iter().any(|point| point[1] > 0.0));
    let totals = &report.totals;
    Chart {
        title: report.title.clone(),
        // Factorisations are others after a resumption.
        subtitle: format!("{} {}, {}: {} iterations", report.method, report.setting, report.solver, totals.iterations),
        x: Axis { label: "increment".into(), scale: Scale::Integers },
        y: Axis { label: "linear systems, steps".into(), scale: Scale::Integers },
        columns: 1,
        panels: vec![Panel { curves, ..Panel::default() }],
    }
}
