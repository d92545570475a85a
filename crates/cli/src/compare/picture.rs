//! Charts of a comparison: error against time, growth with the mesh, the error within an increment.

use super::{Comparison, Iterate, MeshChoice, SolverPath, TimeErrors, Trial, convergence, front};
use stickslip::algebra::linear::SparseLu;
use stickslip::solver::history::{HistoryMethod, LinearAlgebra, Method, Status};
use stickslip_output::{Axis, Chart, Curve, Dash, Line, Marker, Panel, Scale};

const BLACK: [u8; 3] = [0, 0, 0];
const ORANGE: [u8; 3] = [200, 120, 0];
const GREEN: [u8; 3] = [0, 120, 60];
const BLUE: [u8; 3] = [0, 90, 181];
const RED: [u8; 3] = [200, 50, 32];
const PURPLE: [u8; 3] = [120, 60, 160];
const GREY: [u8; 3] = [195, 195, 195];

/// Returns the charts of a comparison, each with the stem of its file name and a description.
pub fn charts(comparison: &Comparison) -> Vec<(&'static str, &'static str, Chart)> {
    let forces = precision(comparison, "error of the contact forces", |errors| errors.forces);
    let work = precision(comparison, "error of the friction work", |errors| errors.work);
    let mut charts = vec![
        ("forces", "Error of the contact forces against CPU time", forces),
        ("work", "Error of the friction work against CPU time", work),
        ("growth", "CPU time against the size of the mesh", growth(comparison)),
        ("increment", "Error measure within an increment", increment(comparison)),
    ];
    // Without friction there is no friction work to compare.
    if comparison.meshes.iter().all(|result| result.end.work == 0.0) {
        charts.retain(|(stem, ..)| *stem != "work");
    }
    if comparison.elements().len() > 1 {
        // Times of different elements do not follow one curve.
        charts.retain(|(stem, ..)| *stem != "growth");
    }
    if comparison.meshes.len() > 1 {
        charts.extend(convergence::charts(comparison));
    }
    charts
}

/// Plots an error of time stepping against time, on the coarsest mesh and on the finest.
fn precision(comparison: &Comparison, label: &str, error: fn(&TimeErrors) -> f64) -> Chart {
    let meshes = match &comparison.meshes[..] {
        [coarsest, .., finest] => vec![&coarsest.mesh, &finest.mesh],
        meshes => meshes.iter().map(|result| &result.mesh).collect(),
    };
    let panel = |&mesh: &&MeshChoice| {
        let points = |path: SolverPath| {
            let runs = comparison.on(mesh).filter(move |run| run.path == path);
            runs.filter_map(|run| run.point(error, comparison.tolerance)).collect::<Vec<_>>()
        };
        let mut curves: Vec<Curve> =
            comparison.paths().into_iter().map(|path| curve(path, points(path))).filter(is_drawn).collect();
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
        x: seconds(),
        y: Axis { label: label.into(), scale: Scale::Decades },
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

/// Plots time against displacements, for the most increments.
fn growth(comparison: &Comparison) -> Chart {
    let most = comparison.runs.iter().map(|run| run.increments).max().unwrap_or(0);
    let point = |path: SolverPath, mesh: &MeshChoice, size: usize| {
        let solved = |run: &&Trial| run.path == path && run.increments == most && run.status == Status::Converged;
        Some([size as f64, comparison.on(mesh).find(solved)?.seconds.cpu])
    };
    let points = |path| comparison.meshes.iter().filter_map(|m| point(path, &m.mesh, m.displacements)).collect();
    let curves = comparison.paths().into_iter().map(|path| curve(path, points(path))).filter(is_drawn).collect();
    Chart {
        title: comparison.title.clone(),
        subtitle: format!("a whole history of {most} increments"),
        x: Axis { label: "displacements".into(), scale: Scale::Decades },
        y: seconds(),
        columns: 1,
        panels: vec![Panel { curves, ..Panel::default() }],
    }
}

/// Plots the error measure against the time since the last increment, on the finest mesh with the most increments: for
/// an increment with a typical total number of iterations of all paths, and for the one with the most.
fn increment(comparison: &Comparison) -> Chart {
    let finest = comparison.meshes.last().map(|result| &result.mesh);
    let most = comparison.runs.iter().map(|run| run.increments).max().unwrap_or(0);
    let runs = comparison.runs.iter().filter(|run| Some(&run.mesh) == finest && run.increments == most);
    let runs: Vec<&Trial> = runs.collect();
    let mesh = finest.map_or(String::new(), ToString::to_string);
    let effort =
        |k: usize| runs.iter().map(|run| run.iterates.iter().filter(|i| i.increment == k).count()).sum::<usize>();
    let mut by_effort: Vec<usize> = (1..=most).collect();
    by_effort.sort_by_cached_key(|&k| effort(k));
    let panel = |(what, k): (&str, usize)| {
        let point = |iterate: &Iterate| {
            let error = iterate.error.filter(|error| error.is_finite() && *error > 0.0)?;
            (iterate.increment == k).then_some([iterate.seconds, error])
        };
        let curves = runs.iter().map(|run| curve(run.path, run.iterates.iter().filter_map(point).collect()));
        Panel {
            title: format!("increment {k}, {what} in effort"),
            curves: curves.filter(is_drawn).collect(),
            ..Panel::default()
        }
    };
    let middle = by_effort.get(most / 2).map(|&k| ("the median", k));
    let hardest = by_effort.last().map(|&k| ("the largest", k));
    Chart {
        title: comparison.title.clone(),
        subtitle: format!(
            "the error measure after each iteration, {most} increments, {mesh}; with the setting paper at the end only"
        ),
        x: Axis { label: "CPU time since the last increment, s".into(), ..seconds() },
        y: Axis { label: "largest error of any law".into(), scale: Scale::Decades },
        columns: 2,
        panels: middle.into_iter().chain(hardest).map(panel).collect(),
    }
}

fn seconds() -> Axis {
    Axis { label: "CPU time, s".into(), scale: Scale::Decades }
}

fn is_drawn(curve: &Curve) -> bool {
    !curve.points.is_empty()
}

/// Styles a curve: colours show the linear solver, lines the method, markers the setting or the exact path.
fn curve(path: SolverPath, points: Vec<[f64; 2]>) -> Curve {
    let colour = match path.linear {
        LinearAlgebra::Whole(SparseLu::Umfpack) => BLACK,
        LinearAlgebra::Condensed(_) => BLUE,
        LinearAlgebra::Whole(SparseLu::Faer) => RED,
        LinearAlgebra::Whole(SparseLu::Mumps) => ORANGE,
        LinearAlgebra::Whole(SparseLu::Partial) => PURPLE,
        LinearAlgebra::Multigrid => GREEN,
    };
    let (dash, marker) = match path.method {
        HistoryMethod::Increments(Method::Bn { .. }) => (Dash::Solid, Marker::Disc),
        HistoryMethod::Increments(Method::PaperBn) => (Dash::Solid, Marker::Triangle),
        HistoryMethod::Increments(Method::Ip) => (Dash::Dashed, Marker::Disc),
        HistoryMethod::Increments(Method::PaperIp { .. }) => (Dash::Dashed, Marker::Triangle),
        HistoryMethod::ExactPath { .. } => (Dash::Dotted, Marker::Square),
    };
    let line = Some(Line { dash, width: 1.8 });
    Curve { label: path.to_string(), points, line, marker: Some(marker), colour }
}
