//! Lines, markers and text on a picture, in pixels with fractions.

use plotters::coord::Shift;
use plotters::drawing::DrawingAreaErrorKind;
use plotters::prelude::*;
use plotters::style::text_anchor::{HPos, Pos, VPos};

use super::{Dash, Line, Marker, PlotError};

/// The drawing library rounds to whole units: with these a pixel has ten.
const UNITS: f64 = 10.0;
/// What the drawing library divides the size of a font by.
const FONT_FACTOR: f64 = 1.24;
/// Radius of a marker, px.
const RADIUS: f64 = 3.4;

impl From<DrawingAreaErrorKind<std::io::Error>> for PlotError {
    fn from(error: DrawingAreaErrorKind<std::io::Error>) -> Self {
        PlotError(error.to_string())
    }
}

/// How a text stands to its point.
#[derive(Clone, Copy, PartialEq)]
pub(in crate::report) enum Anchor {
    /// It begins there.
    Start,
    /// Its middle is there.
    Middle,
    /// The same in bold letters.
    Bold,
    /// It ends there.
    End,
    /// Its middle is there, and it reads upwards.
    Upwards,
}

pub(in crate::report) struct Pen<'a> {
    area: DrawingArea<SVGBackend<'a>, Shift>,
}

/// A picture of `size` px on which `draw` draws.
pub(in crate::report) fn picture(
    size: [f64; 2],
    draw: impl FnOnce(&Pen<'_>) -> Result<(), PlotError>,
) -> Result<String, PlotError> {
    let [width, height] = size.map(f64::ceil);
    let [units_x, units_y] = [width, height].map(units);
    let mut svg = String::new();
    let pen = Pen { area: SVGBackend::with_string(&mut svg, (units_x as u32, units_y as u32)).into_drawing_area() };
    pen.area.fill(&WHITE)?;
    draw(&pen)?;
    pen.area.present()?;
    drop(pen);
    let whole = format!("width=\"{units_x}\" height=\"{units_y}\"");
    Ok(svg.replacen(&whole, &format!("width=\"{width}\" height=\"{height}\""), 1))
}

/// About how wide a text in letters of `size` is.
pub(in crate::report) fn text_width(text: &str, size: f64) -> f64 {
    let width = |c: char| match c {
        ' ' | '.' | ',' | ':' | '\'' | 'i' | 'j' | 'l' | 't' | 'f' | 'r' | 'I' | '(' | ')' => 0.36,
        '₀'..='ₜ' | '⁰'..='⁻' | '¹' | '²' | '³' => 0.42,
        'm' | 'w' | 'M' | 'W' | '=' | '±' | '−' => 0.85,
        c if c.is_uppercase() => 0.72,
        _ => 0.61,
    };
    size * text.chars().map(width).sum::<f64>()
}

impl Pen<'_> {
    pub(in crate::report) fn line(&self, points: &[[f64; 2]], line: Line, colour: [u8; 3]) -> Result<(), PlotError> {
        let style = rgb(colour).stroke_width(units(line.width) as u32);
        let draw = |points: &[[f64; 2]]| self.area.draw(&PathElement::new(whole(points), style));
        match line.dash.lengths(line.width) {
            [] => draw(points)?,
            lengths => pieces(points, lengths).iter().try_for_each(|piece| draw(piece))?,
        }
        Ok(())
    }

    /// A filled polygon.
    pub(in crate::report) fn polygon(&self, corners: &[[f64; 2]], colour: [u8; 3]) -> Result<(), PlotError> {
        self.area.draw(&Polygon::new(whole(corners), rgb(colour)))?;
        Ok(())
    }

    /// A marker; a hollow one hides the line behind it.
    pub(in crate::report) fn marker(&self, [x, y]: [f64; 2], marker: Marker, colour: [u8; 3]) -> Result<(), PlotError> {
        let colour = rgb(colour);
        let outline = colour.stroke_width(units(1.4) as u32);
        let polygon = |corners: &[[f64; 2]]| {
            let corners = whole(&corners.iter().map(|[a, b]| [x + RADIUS * a, y + RADIUS * b]).collect::<Vec<_>>());
            self.area.draw(&Polygon::new(corners.clone(), WHITE))?;
            // Once more along the first side, so that the outline has no open corner.
            let around: Vec<_> = corners.iter().chain(&corners[..2]).copied().collect();
            self.area.draw(&PathElement::new(around, outline))
        };
        let centre = (units(x), units(y));
        match marker {
            Marker::Disc => self.area.draw(&Circle::new(centre, units(RADIUS), colour.filled()))?,
            Marker::Circle => {
                self.area.draw(&Circle::new(centre, units(RADIUS), WHITE.filled()))?;
                self.area.draw(&Circle::new(centre, units(RADIUS), outline))?;
            }
            Marker::Square => polygon(&[[-0.95, -0.95], [0.95, -0.95], [0.95, 0.95], [-0.95, 0.95]])?,
            Marker::Triangle => polygon(&[[0.0, -1.3], [1.2, 0.85], [-1.2, 0.85]])?,
        }
        Ok(())
    }

    pub(in crate::report) fn text(
        &self,
        [x, y]: [f64; 2],
        text: &str,
        size: f64,
        anchor: Anchor,
    ) -> Result<(), PlotError> {
        if text.is_empty() {
            return Ok(());
        }
        let weight = if anchor == Anchor::Bold { FontStyle::Bold } else { FontStyle::Normal };
        let mut font = FontDesc::new(FontFamily::SansSerif, FONT_FACTOR * UNITS * size, weight);
        if anchor == Anchor::Upwards {
            font = font.transform(FontTransform::Rotate270);
        }
        let side = match anchor {
            Anchor::Start => HPos::Left,
            Anchor::Middle | Anchor::Bold | Anchor::Upwards => HPos::Center,
            Anchor::End => HPos::Right,
        };
        let style = TextStyle::from(font).pos(Pos::new(side, VPos::Center));
        self.area.draw(&Text::new(text, (units(x), units(y)), style))?;
        Ok(())
    }
}

impl Dash {
    /// Lengths of marks and gaps in turn, px; none for an unbroken line.
    fn lengths(self, width: f64) -> &'static [f64] {
        match self {
            Dash::Solid => &[],
            Dash::Dotted if width < 1.5 => &[1.2, 2.4],
            Dash::Dotted => &[2.0, 3.0],
            Dash::Dashed => &[7.0, 4.0],
            Dash::DashDotted => &[9.0, 3.5, 2.0, 3.5],
        }
    }
}

/// What is left of a polygonal line when marks and gaps of the given `lengths` follow each other
/// along it.
fn pieces(points: &[[f64; 2]], lengths: &[f64]) -> Vec<Vec<[f64; 2]>> {
    let mut pieces = Vec::new();
    let mut piece: Vec<[f64; 2]> = points.first().copied().into_iter().collect();
    let (mut k, mut left) = (0, lengths[0]);
    for side in points.windows(2) {
        let [from, to] = [side[0], side[1]];
        let length = (to[0] - from[0]).hypot(to[1] - from[1]);
        let mut gone = 0.0;
        while length - gone > left {
            gone += left;
            let t = gone / length;
            let point = [from[0] + t * (to[0] - from[0]), from[1] + t * (to[1] - from[1])];
            if k % 2 == 0 {
                piece.push(point);
                pieces.push(std::mem::take(&mut piece));
            } else {
                piece = vec![point];
            }
            k += 1;
            left = lengths[k % lengths.len()];
        }
        left -= length - gone;
        if k % 2 == 0 {
            piece.push(to);
        }
    }
    if piece.len() > 1 {
        pieces.push(piece);
    }
    pieces
}

fn units(pixels: f64) -> i32 {
    (UNITS * pixels).round() as i32
}

fn whole(points: &[[f64; 2]]) -> Vec<(i32, i32)> {
    points.iter().map(|&[x, y]| (units(x), units(y))).collect()
}

fn rgb([red, green, blue]: [u8; 3]) -> RGBColor {
    RGBColor(red, green, blue)
}

#[cfg(test)]
mod tests {
    use super::pieces;

    #[test]
    fn dashes_go_round_corners() {
        let points = [[0.0, 0.0], [4.0, 0.0], [4.0, 4.0]];
        let dashes = pieces(&points, &[3.0, 0.5, 2.0, 1.0]);
        let expected =
            [vec![[0.0, 0.0], [3.0, 0.0]], vec![[3.5, 0.0], [4.0, 0.0], [4.0, 1.5]], vec![[4.0, 2.5], [4.0, 4.0]]];
        assert_eq!(dashes, expected);
        assert!(pieces(&[], &[1.0, 1.0]).is_empty() && pieces(&[[1.0, 1.0]], &[1.0, 1.0]).is_empty());
    }
}
