//! Charts of a comparison: error against time.

use super::{Comparison, MeshChoice, SolverPath, convergence, front};
use crate::study::{curve, distinct};
use stickslip::solver::history::{HistoryMethod, Method};
use stickslip_output::{Axis, Chart, Curve, Dash, Line, Marker, Panel, Scale};

const GREY: [u8; 3] = [195, 195, 195];

/// Returns the charts of a comparison, each with the stem of its file name and a description.
pub fn charts(comparison: &Comparison) -> Vec<(&'static str, &'static str, Chart)> {
    let mut charts = vec![("forces", "Error of the contact forces against CPU time", forces(comparison))];
    if comparison.meshes.len() > 1 {
        charts.extend(convergence::charts(comparison));
    }
    charts
}

/// Plots the error of the contact forces against time, on the coarsest mesh and on the finest.
fn forces(comparison: &Comparison) -> Chart {
    let meshes = match &comparison.meshes[..] {
        [coarsest, .., finest] => vec![&coarsest.mesh, &finest.mesh],
        meshes => meshes.iter().map(|result| &result.mesh).collect(),
    };
    let solvers = distinct(comparison.paths().into_iter().map(|path| path.linear));
    let panel = |&mesh: &&MeshChoice| {
        let of_path = |path: SolverPath| {
            let runs = comparison.on(mesh).filter(|run| run.path == path);
            let points = runs.filter_map(|run| run.point(|errors| errors.forces, comparison.tolerance)).collect();
            let solver = solvers.iter().position(|solver| *solver == path.linear).unwrap_or(0);
            styled(path.method, curve(solver, path.to_string(), points))
        };
        let curves = comparison.paths().into_iter().map(of_path);
        let mut curves: Vec<Curve> = curves.filter(|curve| !curve.points.is_empty()).collect();
        let all: Vec<[f64; 2]> = curves.iter().flat_map(|curve| curve.points.iter().copied()).collect();
        let best: Vec<[f64; 2]> = front(&all).into_iter().map(|k| all[k]).collect();
        let line = Some(Line { dash: Dash::Solid, width: 9.0 });
        curves.push(Curve { label: "Pareto front".into(), points: stroke(best), line, marker: None, colour: GREY });
        Panel { title: mesh.to_string(), curves, ..Panel::default() }
    };
    Chart {
        title: comparison.title.clone(),
        subtitle: format!(
            "errors of time stepping, each line from few increments to many; below the tolerance, {:.0e}, drawn at it",
            comparison.tolerance
        ),
        x: Axis { label: "CPU time, s".into(), scale: Scale::Decades },
        y: Axis { label: "error of the contact forces".into(), scale: Scale::Decades },
        columns: meshes.len(),
        panels: meshes.iter().map(panel).collect(),
    }
}

/// Replaces a single point by a short stroke, because a line needs two points.
fn stroke(points: Vec<[f64; 2]>) -> Vec<[f64; 2]> {
    match points[..] {
        [[time, error]] => vec![[0.75 * time, error], [1.33 * time, error]],
        _ => points,
    }
}

/// Styles a curve: lines show the method, markers the setting or the exact path. The colour shows the linear solver.
fn styled(method: HistoryMethod, curve: Curve) -> Curve {
    let (dash, marker) = match method {
        HistoryMethod::Increments(Method::Bn { .. }) => (Dash::Solid, Marker::Disc),
        HistoryMethod::Increments(Method::PaperBn) => (Dash::Solid, Marker::Triangle),
        HistoryMethod::Increments(Method::Ip) => (Dash::Dashed, Marker::Disc),
        HistoryMethod::Increments(Method::PaperIp { .. }) => (Dash::Dashed, Marker::Triangle),
        HistoryMethod::ExactPath => (Dash::Dotted, Marker::Square),
    };
    Curve { line: Some(Line { dash, width: 1.8 }), marker: Some(marker), ..curve }
}
