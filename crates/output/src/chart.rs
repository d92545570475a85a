//! Line charts as SVG: panels with common axes, and curves that can be distinguished without colour.

pub(super) mod axis;

pub use axis::Scale;

use super::svg::{Anchor, Colour, Line, Marker, PlotError, Svg, expect_finite, text_width};
use super::svg::{BLACK, GREY, LABEL_SIZE, NUMBER_SIZE, THIN, WIDTH};
use axis::Ticks;

/// A chart of one or more panels with the same horizontal axis and, unless a panel has its own, the same vertical one.
#[derive(Debug, Clone, PartialEq)]
pub struct Chart {
    /// The heading.
    pub title: String,
    /// The second line of the heading, which names the case.
    pub subtitle: String,
    /// The horizontal axis.
    pub x: Axis,
    /// The vertical axis.
    pub y: Axis,
    /// The number of panels in a row.
    pub columns: usize,
    /// The panels, row by row.
    pub panels: Vec<Panel>,
}

/// An axis.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Axis {
    /// The quantity and its unit.
    pub label: String,
    /// The layout of the numbers along the axis.
    pub scale: Scale,
}

/// A panel of a chart.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Panel {
    /// The heading; empty for none.
    pub title: String,
    /// The curves in the order of the legend; the first is in front.
    pub curves: Vec<Curve>,
    /// Points marked by a cross, each with a text above it.
    pub notes: Vec<Note>,
    /// The panel's own vertical axis; the panel is then lower than the others.
    pub y: Option<Axis>,
}

/// A marked point of a panel.
#[derive(Debug, Clone, PartialEq)]
pub struct Note {
    /// The point.
    pub at: [f64; 2],
    /// The text.
    pub text: String,
}

/// A curve: a line, markers, or both.
#[derive(Debug, Clone, PartialEq)]
pub struct Curve {
    /// The name of the curve in the legend. Curves of the same name share an entry; curves without a name have none.
    pub label: String,
    /// The points in order. A logarithmic axis omits numbers that are not positive.
    pub points: Vec<[f64; 2]>,
    /// The line through the points.
    pub line: Option<Line>,
    /// The marker at each point.
    pub marker: Option<Marker>,
    /// The colour: red, green, blue.
    pub colour: [u8; 3],
}

/// Colours that colour-blind people can distinguish (Okabe and Ito).
const COLOURS: [Colour; 7] =
    [[0, 0, 0], [0, 114, 178], [213, 94, 0], [0, 158, 115], [204, 121, 167], [230, 159, 0], [86, 180, 233]];
const MARKERS: [Marker; 4] = [Marker::Disc, Marker::Square, Marker::Triangle, Marker::Circle];

/// Returns a colour and a marker for curve `k` of many. The first 28 combinations are different.
pub fn curve_style(k: usize) -> ([u8; 3], Marker) {
    (COLOURS[k % COLOURS.len()], MARKERS[k % MARKERS.len()])
}

/// The space left of the first panel, for the axis label and the numbers.
const LEFT: f64 = 92.0;
/// The space left of the other panels, for the numbers.
const BETWEEN: f64 = 66.0;
const RIGHT: f64 = 26.0;
/// The space below a panel, for the numbers.
const BELOW: f64 = 30.0;
/// The height of a panel with an axis of its own, relative to the others.
const LOW: f64 = 0.55;
/// The room for a text above a marked point.
const ABOVE: f64 = 22.0;
const HEADING: f64 = 26.0;
const LEGEND_ROW: f64 = 24.0;
/// The length of the sample line of a legend entry, and the gap after an entry.
const SAMPLE: f64 = 38.0;
const GAP: f64 = 22.0;

const GRID: Colour = [228, 228, 228];

/// The position of a panel, px.
#[derive(Clone, Copy)]
struct Frame {
    left: f64,
    top: f64,
    width: f64,
    height: f64,
}

impl Chart {
    /// Draws the chart as an SVG picture.
    ///
    /// # Errors
    /// When a number is not finite.
    pub fn to_svg(&self) -> Result<String, PlotError> {
        let points = || self.panels.iter().flat_map(Panel::points);
        expect_finite(points().flatten().copied())?;
        let columns = self.columns.max(1);
        let rows = self.panels.len().div_ceil(columns);
        let common = |panel: &&Panel| panel.y.is_none();
        let noted = self.panels.iter().filter(common).any(|panel| !panel.notes.is_empty());
        let layout = |[left, between]: [f64; 2]| {
            let width = (WIDTH - left - RIGHT - (columns - 1) as f64 * (between + RIGHT)) / columns as f64;
            let height = width
                * match (columns, rows) {
                    (1, _) => 0.45,
                    (_, 1) => 0.8,
                    _ => 0.64,
                };
            let all = upwards(&self.y, self.panels.iter().filter(common).flat_map(Panel::points), noted, height);
            let of = |panel: &Panel| match &panel.y {
                Some(axis) => (LOW * height, upwards(axis, panel.points(), !panel.notes.is_empty(), LOW * height)),
                None => (height, all.clone()),
            };
            (width, self.panels.iter().map(of).collect::<Vec<_>>())
        };
        // Long numbers need more room beside their panels.
        let longest = layout([LEFT, BETWEEN]).1.iter().map(|(_, ticks)| ticks.widest()).fold(0.0, f64::max);
        let [first, between] = [LEFT.max(longest + 40.0), BETWEEN.max(longest + 12.0)];
        let (width, panels) = layout([first, between]);
        let along = |room: f64| self.x.scale.ticks(points().map(|p| p[0]), 0.0, width / room);
        let x = along(60.0_f64.max(along(60.0).widest() + 14.0));

        let legend = self.legend();
        let headings = if self.panels.iter().all(|panel| panel.title.is_empty()) { 8.0 } else { HEADING };
        let top = 66.0 + LEGEND_ROW * legend.len() as f64;
        let of_row =
            |row: &[(f64, Ticks)]| headings + row.iter().map(|(height, _)| *height).fold(0.0, f64::max) + BELOW;
        let pitches: Vec<f64> = panels.chunks(columns).map(of_row).collect();
        let mut svg = Svg::headed(top + pitches.iter().sum::<f64>() + 34.0, &self.title, &self.subtitle);
        for (row, entries) in legend.iter().enumerate() {
            draw_legend(&mut svg, 74.0 + LEGEND_ROW * row as f64, entries);
        }
        for (k, (panel, (height, y))) in self.panels.iter().zip(&panels).enumerate() {
            let (row, column) = (k / columns, k % columns);
            let left = first + column as f64 * (width + between + RIGHT);
            let top = top + pitches[..row].iter().sum::<f64>() + headings;
            let axis = panel.y.as_ref().unwrap_or(&self.y);
            self.draw_panel(&mut svg, Frame { left, top, width, height: *height }, panel, &x, (axis.scale, y));
            if column == 0 || panel.y.is_some() {
                svg.text([left - first + 22.0, top + 0.5 * height], &axis.label, LABEL_SIZE, Anchor::Upwards);
            }
            if k + columns >= self.panels.len() {
                let below = [left + 0.5 * width, top + height + BELOW + 14.0];
                svg.text(below, &self.x.label, LABEL_SIZE, Anchor::Middle);
            }
        }
        Ok(svg.finish())
    }

    fn draw_panel(&self, svg: &mut Svg, frame: Frame, panel: &Panel, x: &Ticks, (scale, y): (Scale, &Ticks)) {
        let Frame { left, top, width, height } = frame;
        let (right, bottom) = (left + width, top + height);
        let (across, up) = (|t: f64| left + t * width, |t: f64| bottom - t * height);
        svg.text([left + 0.5 * width, top - 13.0], &panel.title, LABEL_SIZE, Anchor::Middle);

        for tick in &x.all {
            let at = across(x.share(tick.value));
            let length = tick.length();
            if let Some(label) = &tick.label {
                svg.line(&[[at, top], [at, bottom]], THIN, GRID);
                let inside = at.min(WIDTH - 0.5 * text_width(label, NUMBER_SIZE) - 4.0);
                svg.text([inside, bottom + 14.0], label, NUMBER_SIZE, Anchor::Middle);
            }
            svg.line(&[[at, bottom], [at, bottom - length]], THIN, BLACK);
            svg.line(&[[at, top], [at, top + length]], THIN, BLACK);
        }
        for tick in &y.all {
            let at = up(y.share(tick.value));
            let length = tick.length();
            if let Some(label) = &tick.label {
                svg.line(&[[left, at], [right, at]], THIN, GRID);
                svg.text([left - 8.0, at], label, NUMBER_SIZE, Anchor::End);
            }
            svg.line(&[[left, at], [left + length, at]], THIN, BLACK);
            svg.line(&[[right, at], [right - length, at]], THIN, BLACK);
        }
        if scale == Scale::Linear && y.from < 0.0 && y.to > 0.0 {
            svg.line(&[[left, up(y.share(0.0))], [right, up(y.share(0.0))]], THIN, GREY);
        }
        svg.frame([left, top], [right, bottom], BLACK);
        let place = |&[a, b]: &[f64; 2]| Some([across(x.share(self.x.scale.map(a)?)), up(y.share(scale.map(b)?))]);
        for curve in panel.curves.iter().rev() {
            let points: Vec<[f64; 2]> = curve.points.iter().filter_map(place).collect();
            curve.draw(svg, &points);
        }
        for note in &panel.notes {
            if let Some(at) = place(&note.at) {
                svg.cross(at);
                // Within the panel.
                let half = 0.5 * text_width(&note.text, NUMBER_SIZE) + 8.0;
                let middle = at[0].min(right - half).max(left + half);
                svg.text([middle, at[1] - 16.0], &note.text, NUMBER_SIZE, Anchor::Middle);
            }
        }
    }

    /// Returns the curves of the legend, row by row.
    fn legend(&self) -> Vec<Vec<&Curve>> {
        let mut rows: Vec<Vec<&Curve>> = Vec::new();
        let mut used = 0.0;
        for curve in self.panels.iter().flat_map(|panel| &panel.curves) {
            let known = rows.iter().flatten().any(|entry| entry.label == curve.label);
            if known || curve.label.is_empty() {
                continue;
            }
            used += entry_width(curve);
            match rows.last_mut() {
                Some(row) if used <= WIDTH => row.push(curve),
                _ => {
                    rows.push(vec![curve]);
                    used = entry_width(curve);
                }
            }
        }
        rows
    }
}

fn entry_width(curve: &Curve) -> f64 {
    SAMPLE + 8.0 + text_width(&curve.label, LABEL_SIZE) + GAP
}

/// Draws a row of the legend, centred in the picture.
fn draw_legend(svg: &mut Svg, y: f64, entries: &[&Curve]) {
    let width: f64 = entries.iter().map(|curve| entry_width(curve)).sum::<f64>() - GAP;
    let mut x = 0.5 * (WIDTH - width);
    for curve in entries {
        let sample = [[x, y], [x + SAMPLE, y]];
        Curve { marker: None, ..(*curve).clone() }.draw(svg, &sample);
        Curve { line: None, ..(*curve).clone() }.draw(svg, &[[x + 0.5 * SAMPLE, y]]);
        svg.text([x + SAMPLE + 8.0, y], &curve.label, LABEL_SIZE, Anchor::Start);
        x += entry_width(curve);
    }
}

/// Returns the ticks of a vertical axis; with room for a text above the highest point if there is one.
fn upwards<'a>(axis: &Axis, points: impl Iterator<Item = &'a [f64; 2]> + Clone, noted: bool, height: f64) -> Ticks {
    let values = points.map(|point| point[1]);
    let (low, high) = values.clone().fold((0.0_f64, f64::NEG_INFINITY), |(a, b), value| (a.min(value), b.max(value)));
    let room = (noted && high > low).then_some(high + ABOVE / height * (high - low));
    axis.scale.ticks(values.chain(room), 0.03, height / 31.0)
}

impl Panel {
    fn points(&self) -> impl Iterator<Item = &[f64; 2]> + Clone {
        self.curves.iter().flat_map(|curve| &curve.points)
    }
}

impl Curve {
    /// Draws the curve through `points` of the picture.
    fn draw(&self, svg: &mut Svg, points: &[[f64; 2]]) {
        if let Some(line) = self.line {
            svg.line(points, line, self.colour);
        }
        if let Some(marker) = self.marker {
            for &point in points {
                svg.marker(point, marker, self.colour);
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::svg::Dash;

    fn chart(scale: Scale, points: &[[f64; 2]]) -> Chart {
        let curve = |label: &str| Curve {
            label: label.into(),
            points: points.to_vec(),
            line: Some(Line { dash: Dash::Dotted, width: 2.0 }),
            marker: Some(Marker::Triangle),
            colour: BLACK,
        };
        let panel = |title: &str| Panel {
            title: title.into(),
            curves: vec![curve("a < b & c"), curve("")],
            ..Panel::default()
        };
        Chart {
            title: "Title".into(),
            subtitle: "Case".into(),
            x: Axis { label: "iteration".into(), scale: Scale::Integers },
            y: Axis { label: "Theta, N²".into(), scale },
            columns: 2,
            panels: vec![panel("(a)"), panel("(b)"), panel("(c)")],
        }
    }

    #[test]
    fn texts_are_there_once_and_escaped() {
        let svg = chart(Scale::Decades, &[[0.0, 1e12], [1.0, 1e-3], [2.0, 0.0]]).to_svg().unwrap();
        // Every label has a line of its own.
        let count = |text: &str| svg.lines().filter(|line| *line == text).count();
        assert_eq!(["Title", "Case", "(a)", "(b)", "(c)", "a &lt; b &amp; c"].map(count), [1; 6]);
        assert_eq!((count("Theta, N²"), count("iteration")), (2, 2));
        assert_eq!(count("10¹⁰"), 3);
        assert!(
            svg.starts_with("<svg ") && svg.contains(" width=\"960\" height=") && svg.ends_with("</svg>\n"),
            "{svg}"
        );
    }

    #[test]
    fn the_smallest_letter_can_be_read() {
        let svg = chart(Scale::Linear, &[[0.0, 1.0], [3.0, 2.0]]).to_svg().unwrap();
        let sizes =
            svg.split("font-size=\"").skip(1).map(|rest| rest.split('"').next().unwrap().parse::<f64>().unwrap());
        let unit: f64 = svg.split("viewBox=\"0 0 ").nth(1).unwrap().split(' ').next().unwrap().parse().unwrap();
        assert!(sizes.clone().count() > 10);
        assert!(sizes.into_iter().all(|size| size * WIDTH / unit >= 12.0));
    }

    #[test]
    fn what_cannot_be_drawn_is_said() {
        let error = chart(Scale::Linear, &[[0.0, f64::NAN]]).to_svg().unwrap_err();
        assert_eq!(error.to_string(), "the plot could not be drawn: a number is not finite");
        for points in [vec![], vec![[1.0, 5.0]], vec![[1.0, 0.0], [1.0, 0.0]]] {
            assert!(!chart(Scale::Linear, &points).to_svg().unwrap().contains("NaN"));
            assert!(!chart(Scale::Decades, &points).to_svg().unwrap().contains("NaN"));
        }
    }

    #[test]
    fn a_long_legend_has_several_rows() {
        let mut chart = chart(Scale::Linear, &[[0.0, 1.0]]);
        for k in 0..9 {
            let curve = Curve { label: format!("a curve with a long name, {k}"), ..chart.panels[0].curves[0].clone() };
            chart.panels[0].curves.push(curve);
        }
        let rows = chart.legend();
        assert!(rows.len() > 1 && rows.iter().flatten().count() == 10);
        assert!(rows.iter().all(|row| row.iter().map(|curve| entry_width(curve)).sum::<f64>() <= WIDTH));
    }
}
