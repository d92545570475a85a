//! The sweeps of the suite as charts: errors and iterations against the quantity that is swept.

use stickslip::solver::history::Status;
use stickslip_output::{Axis, Chart, Curve, Dash, Line, Marker, Panel, Scale};

use super::{Row, SuiteMethod};

const BLACK: [u8; 3] = [0, 0, 0];
const BLUE: [u8; 3] = [0, 90, 181];
const RED: [u8; 3] = [200, 50, 32];
const GREY: [u8; 3] = [120, 120, 120];

/// The charts of every sweep among `rows` that is drawn, each with the stem of a file name.
pub fn charts(rows: &[Row]) -> Vec<(String, Chart)> {
    let mut sweeps: Vec<&str> = rows.iter().filter(|row| row.x.is_some()).map(|row| row.sweep.as_str()).collect();
    sweeps.dedup();
    let draw = |sweep: &str| {
        let rows: Vec<&Row> = rows.iter().filter(|row| row.sweep == sweep && row.x.is_some()).collect();
        [("error", errors(sweep, &rows)), ("iterations", iterations(sweep, &rows))]
            .map(|(what, chart)| (format!("{}_{what}", slug(sweep)), chart))
    };
    sweeps.into_iter().flat_map(draw).collect()
}

fn errors(sweep: &str, rows: &[&Row]) -> Chart {
    let mut curves = curves(rows, |row| row.errors.worst().1);
    let rounding = rows.iter().filter(|row| row.method == SuiteMethod::Bn);
    let points = rounding.filter_map(|row| Some([row.x?, row.rounding])).filter(|point| point[1].is_finite()).collect();
    let line = Some(Line { dash: Dash::Dotted, width: 1.4 });
    curves.push(Curve { label: "rounding of u".into(), points, line, marker: None, colour: GREY });
    let y = Axis { label: "largest error of any law".into(), scale: Scale::Decades };
    chart(sweep, "what the error measure says at the end, converged or not", y, rows, curves)
}

fn iterations(sweep: &str, rows: &[&Row]) -> Chart {
    let curves = curves(rows, |row| row.iterations);
    let y = Axis { label: "iterations per increment".into(), scale: Scale::Decades };
    chart(sweep, "linear systems solved, on average", y, rows, curves)
}

fn chart(sweep: &str, subtitle: &str, y: Axis, rows: &[&Row], curves: Vec<Curve>) -> Chart {
    let xs = || rows.iter().filter_map(|row| row.x);
    let wide = xs().all(|x| x > 0.0) && xs().fold(0.0, f64::max) > 50.0 * xs().fold(f64::INFINITY, f64::min);
    let mut label = sweep.to_string();
    if sweep.starts_with("Poisson") {
        label = format!("1/2 - {sweep}");
    }
    Chart {
        title: sweep.to_string(),
        subtitle: subtitle.to_string(),
        x: Axis { label, scale: if wide || sweep.starts_with("friction") { Scale::Decades } else { Scale::Linear } },
        y,
        columns: 1,
        panels: vec![Panel { curves, ..Panel::default() }],
    }
}

/// A curve for each method: a line through the scenes that converged, and hollow marks for the others.
fn curves(rows: &[&Row], of: impl Fn(&Row) -> f64) -> Vec<Curve> {
    let style = |method| match method {
        SuiteMethod::Bn => (Dash::Solid, BLACK),
        SuiteMethod::Ip => (Dash::DashDotted, BLUE),
        SuiteMethod::BnPaper => (Dash::Dashed, RED),
    };
    let points = |method: SuiteMethod, good: bool| -> Vec<[f64; 2]> {
        let rows = rows.iter().filter(|row| row.method == method && (row.verdict == Status::Converged) == good);
        rows.filter_map(|row| Some([row.x?, of(row)])).filter(|point| point[1].is_finite() && point[1] > 0.0).collect()
    };
    let mut curves = Vec::new();
    for method in [SuiteMethod::Bn, SuiteMethod::Ip, SuiteMethod::BnPaper] {
        let (dash, colour) = style(method);
        let (converged, failed) = (points(method, true), points(method, false));
        if !converged.is_empty() {
            let line = Some(Line { dash, width: 1.8 });
            let marker = Some(Marker::Disc);
            curves.push(Curve { label: method.title().into(), points: converged, line, marker, colour });
        }
        if !failed.is_empty() {
            let label = format!("{}, not converged", method.title());
            curves.push(Curve { label, points: failed, line: None, marker: Some(Marker::Square), colour });
        }
    }
    curves
}

fn slug(name: &str) -> String {
    let words = name.split(|c: char| !c.is_alphanumeric()).filter(|word| !word.is_empty());
    words.map(str::to_lowercase).collect::<Vec<_>>().join("-")
}
