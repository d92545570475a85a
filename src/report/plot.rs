//! Plots as SVG.

use plotters::coord::Shift;
use plotters::prelude::*;

use super::contact_line::{ContactLine, ContactPoint};
use crate::contact::ContactStatus;

const SIZE: (u32, u32) = (860, 480);
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
    let heading = format!("{title}, t = {} s", line.time);
    let mut chart = ChartBuilder::on(root)
        .caption(heading, ("sans-serif", 18))
        .margin(14)
        .margin_right(28)
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

    for (sign, named) in [(1.0, true), (-1.0, false)] {
        let bound = points.iter().map(|p| (abscissa(p), mpa(sign * p.mu * p.sigma_n)));
        let series = chart.draw_series(DashedLineSeries::new(bound, 5, 4, BOUND.stroke_width(1)))?;
        if named {
            series.label("±μ σ_n").legend(|(x, y)| PathElement::new([(x, y), (x + 18, y)], BOUND));
        }
    }
    for (value, colour, name) in [
        ((|p| p.sigma_n) as fn(&ContactPoint) -> f64, NORMAL, "σ_n (pressure)"),
        (|p| p.sigma_t, TANGENTIAL, "σ_t (friction)"),
    ] {
        let series = points.iter().map(|p| (abscissa(p), mpa(value(p))));
        chart
            .draw_series(LineSeries::new(series, colour.stroke_width(2)))?
            .label(name)
            .legend(move |(x, y)| PathElement::new([(x, y), (x + 18, y)], colour.stroke_width(2)));
        let nodes = |status| points.iter().filter(move |p| p.status == status);
        let at = |p: &ContactPoint| (abscissa(p), mpa(value(p)));
        chart.draw_series(nodes(ContactStatus::Stick).map(|p| Circle::new(at(p), 3, colour.filled())))?;
        chart.draw_series(nodes(ContactStatus::Slip).map(|p| Circle::new(at(p), 3, WHITE.filled())))?;
        chart.draw_series(nodes(ContactStatus::Slip).map(|p| Circle::new(at(p), 3, colour.stroke_width(1))))?;
    }
    // Two entries without a line explain the markers.
    chart
        .draw_series(std::iter::empty::<Circle<(f64, f64), i32>>())?
        .label("stick")
        .legend(|(x, y)| Circle::new((x + 9, y), 3, BLACK.filled()));
    chart
        .draw_series(std::iter::empty::<Circle<(f64, f64), i32>>())?
        .label("slip")
        .legend(|(x, y)| Circle::new((x + 9, y), 3, BLACK.stroke_width(1)));
    chart
        .configure_series_labels()
        .position(SeriesLabelPosition::UpperLeft)
        .background_style(WHITE.mix(0.85))
        .border_style(BLACK.mix(0.2))
        .label_font(("sans-serif", 13))
        .draw()?;
    root.present()?;
    Ok(())
}
