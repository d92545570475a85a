//! Plots as SVG.

use plotters::coord::Shift;
use plotters::prelude::*;

use super::contact_line::{ContactLine, ContactPoint};
use crate::contact::ContactStatus;

const SIZE: (u32, u32) = (980, 480);
/// Where the legend begins: beside the plot, where it hides nothing.
const LEGEND: u32 = 840;
const NORMAL: RGBColor = RGBColor(31, 90, 160);
const TANGENTIAL: RGBColor = RGBColor(200, 80, 20);
const BOUND: RGBColor = RGBColor(130, 130, 130);

/// Why a plot could not be drawn.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
#[error("the plot could not be drawn: {0}")]
pub struct PlotError(String);

/// The contact stresses along the contact line as an SVG picture: `σ_n` and `σ_t` in MPa, the
/// friction bound `±μ σ_n`, and the status of each node: filled for stick, hollow for slip, none
/// for open.
///
/// # Errors
/// When the drawing library refuses, as for numbers that are not finite.
pub fn contact_stresses(line: &ContactLine, title: &str) -> Result<String, PlotError> {
    let mut svg = String::new();
    let root = SVGBackend::with_string(&mut svg, SIZE).into_drawing_area();
    draw(&root, line, title).map_err(|error| PlotError(error.to_string()))?;
    drop(root);
    Ok(svg)
}

type Area<'a> = DrawingArea<SVGBackend<'a>, Shift>;

fn draw(root: &Area<'_>, line: &ContactLine, title: &str) -> Result<(), Box<dyn std::error::Error>> {
    let points = &line.points;
    let mpa = |stress: f64| stress * 1e-6;
    // Contact lines are mostly level: then x says more than the distance along the line.
    let level = points.windows(2).all(|pair| pair[1].x > pair[0].x && pair[1].y == pair[0].y);
    let (abscissa, label): (fn(&ContactPoint) -> f64, _) =
        if level { (|p| p.x, "x, m") } else { (|p| p.s, "distance along the contact line, m") };
    let from = points.iter().map(abscissa).fold(f64::INFINITY, f64::min);
    let to = points.iter().map(abscissa).fold(f64::NEG_INFINITY, f64::max);
    let stresses = || points.iter().flat_map(|p| [p.sigma_n, p.sigma_t, p.mu * p.sigma_n, -p.mu * p.sigma_n]);
    let low = stresses().map(mpa).fold(0.0, f64::min);
    let high = stresses().map(mpa).fold(0.0, f64::max);
    let margin = 0.06 * if high > low { high - low } else { 1.0 };

    root.fill(&WHITE)?;
    let boundary = line.boundary.as_ref().map_or(String::new(), |name| format!(", {name}"));
    let heading = format!("{title}{boundary}, t = {} s", line.time);
    let (left, right) = root.split_horizontally(LEGEND);
    legend(&right)?;
    let mut chart = ChartBuilder::on(&left)
        .caption(heading, ("sans-serif", 18))
        .margin(14)
        .margin_right(24)
        .x_label_area_size(46)
        .y_label_area_size(70)
        .build_cartesian_2d(from..to, low - margin..high + margin)?;
    chart
        .configure_mesh()
        .x_desc(label)
        .y_desc("contact stress, MPa")
        .light_line_style(WHITE)
        .bold_line_style(BLACK.mix(0.1))
        .label_style(("sans-serif", 13))
        .axis_desc_style(("sans-serif", 15))
        .draw()?;
    chart.draw_series(LineSeries::new([(from, 0.0), (to, 0.0)], BLACK.mix(0.5)))?;

    for sign in [1.0, -1.0] {
        let bound = points.iter().map(|p| (abscissa(p), mpa(sign * p.mu * p.sigma_n)));
        chart.draw_series(DashedLineSeries::new(bound, 5, 4, BOUND.stroke_width(1)))?;
    }
    for (normal, colour) in [(true, NORMAL), (false, TANGENTIAL)] {
        let at = |p: &ContactPoint| (abscissa(p), mpa(if normal { p.sigma_n } else { p.sigma_t }));
        chart.draw_series(LineSeries::new(points.iter().map(at), colour.stroke_width(2)))?;
        let nodes = |status| points.iter().filter(move |p| p.status == status);
        chart.draw_series(nodes(ContactStatus::Stick).map(|p| Circle::new(at(p), 3, colour.filled())))?;
        chart.draw_series(nodes(ContactStatus::Slip).map(|p| Circle::new(at(p), 3, WHITE.filled())))?;
        chart.draw_series(nodes(ContactStatus::Slip).map(|p| Circle::new(at(p), 3, colour.stroke_width(1))))?;
    }
    root.present()?;
    Ok(())
}

fn legend(area: &Area<'_>) -> Result<(), Box<dyn std::error::Error>> {
    let y = |row: i32| 60 + 22 * row;
    let line = |row, style: ShapeStyle| PathElement::new([(0, y(row)), (22, y(row))], style);
    area.draw(&line(0, NORMAL.stroke_width(2)))?;
    area.draw(&line(1, TANGENTIAL.stroke_width(2)))?;
    for dash in [0, 9, 18] {
        area.draw(&PathElement::new([(dash, y(2)), (dash + 5, y(2))], BOUND))?;
    }
    area.draw(&Circle::new((11, y(3)), 3, BLACK.filled()))?;
    area.draw(&Circle::new((11, y(4)), 3, BLACK.stroke_width(1)))?;
    let names = ["σ_n (pressure)", "σ_t (friction)", "±μ σ_n", "stick", "slip"];
    for (row, name) in names.into_iter().enumerate() {
        area.draw(&Text::new(name, (32, y(row as i32) - 6), ("sans-serif", 13)))?;
    }
    Ok(())
}
