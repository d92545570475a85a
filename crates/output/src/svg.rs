//! SVG pictures: lines, polygons, markers and text. Coordinates and lengths are in pixels, y downwards.

mod path;

use std::fmt::Write;

/// Radius of a marker.
const RADIUS: f64 = 3.4;
/// The width of the outline of a hollow marker.
const OUTLINE: f64 = 1.4;
/// The largest visible seam between two neighbours.
const SEAM: f64 = 0.7;
/// Half the size of the cross at a marked point.
const CROSS: f64 = 4.5;
/// The width of every picture, px.
pub(super) const WIDTH: f64 = 960.0;
/// The sizes of letters.
const TITLE_SIZE: f64 = 18.0;
pub(super) const LABEL_SIZE: f64 = 15.0;
pub(super) const NUMBER_SIZE: f64 = 13.5;
pub(super) const BLACK: Colour = [0, 0, 0];
pub(super) const GREY: Colour = [120, 120, 120];
pub(super) const WHITE: Colour = [255, 255, 255];
pub(super) const THIN: Line = Line { dash: Dash::Solid, width: 1.0 };
/// The distance of the baseline below the middle of the letters, in font sizes.
const HALF_A_LETTER: f64 = 0.35;

/// A colour: red, green and blue.
pub(super) type Colour = [u8; 3];

/// The reason why a picture could not be drawn.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
#[error("the plot could not be drawn: a number is not finite")]
pub struct PlotError;

/// Returns an error unless all `values` can be drawn.
pub(super) fn expect_finite(mut values: impl Iterator<Item = f64>) -> Result<(), PlotError> {
    if values.all(f64::is_finite) { Ok(()) } else { Err(PlotError) }
}

/// A line style.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Line {
    /// The dashes of the line.
    pub dash: Dash,
    /// The width of the line, px.
    pub width: f64,
}

/// The dash pattern of a line.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Dash {
    /// Unbroken.
    Solid,
    /// Dots.
    Dotted,
    /// Dashes.
    Dashed,
    /// Alternating dashes and dots.
    DashDotted,
}

/// A marker at a point.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Marker {
    /// A filled circle.
    Disc,
    /// A hollow circle.
    Circle,
    /// A hollow square.
    Square,
    /// A hollow triangle.
    Triangle,
}

/// The position of a text relative to its point, which is half-way up its letters.
#[derive(Clone, Copy, PartialEq)]
pub(super) enum Anchor {
    /// The text begins at the point.
    Start,
    /// The middle of the text is at the point.
    Middle,
    /// The middle of the text, in bold letters, is at the point.
    Bold,
    /// The text ends at the point.
    End,
    /// The middle of the text is at the point, and it reads upwards.
    Upwards,
}

/// A picture. Later elements cover earlier ones.
pub(super) struct Svg {
    text: String,
}

impl Svg {
    /// Creates a white picture of this height, with a title and a second line that names the case.
    pub(super) fn headed(height: f64, title: &str, subtitle: &str) -> Self {
        let mut svg = Svg::new([WIDTH, height]);
        svg.text([0.5 * WIDTH, 24.0], title, TITLE_SIZE, Anchor::Bold);
        svg.text([0.5 * WIDTH, 48.0], subtitle, LABEL_SIZE, Anchor::Middle);
        svg
    }

    /// Creates a white picture.
    pub(super) fn new(size: [f64; 2]) -> Self {
        let [width, height] = size.map(f64::ceil);
        Svg {
            text: format!(
                "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"{width}\" height=\"{height}\" \
                 viewBox=\"0 0 {width} {height}\" font-family=\"sans-serif\" fill=\"none\">\n\
                 <rect width=\"{width}\" height=\"{height}\" fill=\"white\"/>\n"
            ),
        }
    }

    /// Returns the text of the whole picture.
    pub(super) fn finish(mut self) -> String {
        self.text.push_str("</svg>\n");
        self.text
    }

    /// Appends an element.
    fn put(&mut self, element: std::fmt::Arguments<'_>) {
        // Writing to a string cannot fail.
        let _ = writeln!(self.text, "{element}");
    }

    /// Draws the part of `draw` that is within a rectangle.
    pub(super) fn within(&mut self, [left, top]: [f64; 2], size: [f64; 2], draw: impl FnOnce(&mut Svg)) {
        // A nested picture with the coordinates of the outer one clips its content.
        let ([x, y], [width, height]) = ([left, top].map(tenths), size.map(tenths));
        self.put(format_args!(
            "<svg x=\"{x}\" y=\"{y}\" width=\"{width}\" height=\"{height}\" viewBox=\"{x} {y} {width} {height}\">"
        ));
        draw(self);
        self.put(format_args!("</svg>"));
    }

    /// Draws a line through points.
    pub(super) fn line(&mut self, points: &[[f64; 2]], line: Line, colour: Colour) {
        let (points, style) = (coordinates(points), stroke(line, colour));
        self.put(format_args!("<polyline points=\"{points}\" {style}/>"));
    }

    /// Draws a filled polygon.
    fn polygon(&mut self, corners: &[[f64; 2]], colour: Colour) {
        let (corners, colour) = (coordinates(corners), hex(colour));
        self.put(format_args!("<polygon points=\"{corners}\" fill=\"{colour}\"/>"));
    }

    /// Fills the rectangle between two opposite corners.
    pub(super) fn rectangle(&mut self, from: [f64; 2], to: [f64; 2], colour: Colour) {
        self.polygon(&rectangle(from, to), colour);
    }

    /// Draws the sides of the rectangle between two opposite corners.
    pub(super) fn frame(&mut self, from: [f64; 2], to: [f64; 2], colour: Colour) {
        let [a, b, c, d] = rectangle(from, to);
        self.line(&[a, b, c, d, a], THIN, colour);
    }

    /// Draws a filled polygon with a white edge.
    pub(super) fn edged(&mut self, corners: &[[f64; 2]], colour: Colour) {
        let (path, colour) = (path::union([corners]), hex(colour));
        self.put(format_args!("<path d=\"{path}\" fill=\"{colour}\" stroke=\"white\" stroke-width=\"0.6\"/>"));
    }

    /// Fills the union of polygons, without a seam to its neighbours.
    pub(super) fn region<'a>(&mut self, polygons: impl IntoIterator<Item = &'a [[f64; 2]]>, colour: Colour) {
        let (path, colour) = (path::union(polygons), hex(colour));
        if !path.is_empty() {
            self.put(format_args!(
                "<path d=\"{path}\" fill=\"{colour}\" stroke=\"{colour}\" stroke-width=\"{SEAM}\"/>"
            ));
        }
    }

    /// Draws line segments.
    pub(super) fn segments(&mut self, segments: impl IntoIterator<Item = [[f64; 2]; 2]>, line: Line, colour: Colour) {
        let (path, style) = (path::lines(segments), stroke(line, colour));
        if !path.is_empty() {
            self.put(format_args!("<path d=\"{path}\" {style}/>"));
        }
    }

    /// Draws a small cross.
    pub(super) fn cross(&mut self, [x, y]: [f64; 2]) {
        let arm = |sign: f64| [[x - CROSS, y - sign * CROSS], [x + CROSS, y + sign * CROSS]];
        for (width, colour) in [(4.0, WHITE), (1.6, BLACK)] {
            self.segments([arm(1.0), arm(-1.0)], Line { width, ..THIN }, colour);
        }
    }

    /// Marks a point by a cross with a text beside it, on its left if the point is beyond `turn`.
    pub(super) fn mark(&mut self, [x, y]: [f64; 2], text: &str, size: f64, turn: f64) {
        self.cross([x, y]);
        let (aside, width) = (CROSS + 5.0, text_width(text, size));
        let (left, anchor, at) =
            if x > turn { (x - aside - width, Anchor::End, x - aside) } else { (x + aside, Anchor::Start, x + aside) };
        let ([left, top], [width, height]) =
            ([left - 2.0, y - 0.7 * size].map(tenths), [width + 4.0, 1.4 * size].map(tenths));
        self.put(format_args!(
            "<rect x=\"{left}\" y=\"{top}\" width=\"{width}\" height=\"{height}\" fill=\"white\" fill-opacity=\"0.8\"/>"
        ));
        self.text([at, y], text, size, anchor);
    }

    /// Draws a marker. A hollow one covers the line behind it.
    pub(super) fn marker(&mut self, at: [f64; 2], marker: Marker, colour: Colour) {
        let ([x, y], colour) = (at.map(tenths), hex(colour));
        let outline = format!("fill=\"white\" stroke=\"{colour}\" stroke-width=\"{OUTLINE}\"");
        let mut polygon = |corners: &[[f64; 2]]| {
            let corners: Vec<_> = corners.iter().map(|[a, b]| [at[0] + RADIUS * a, at[1] + RADIUS * b]).collect();
            self.put(format_args!("<polygon points=\"{}\" {outline}/>", coordinates(&corners)));
        };
        match marker {
            Marker::Square => polygon(&[[-0.95, -0.95], [0.95, -0.95], [0.95, 0.95], [-0.95, 0.95]]),
            Marker::Triangle => polygon(&[[0.0, -1.3], [1.2, 0.85], [-1.2, 0.85]]),
            Marker::Circle => self.put(format_args!("<circle cx=\"{x}\" cy=\"{y}\" r=\"{RADIUS}\" {outline}/>")),
            Marker::Disc => {
                self.put(format_args!("<circle cx=\"{x}\" cy=\"{y}\" r=\"{RADIUS}\" fill=\"{colour}\"/>"));
            }
        }
    }

    /// Draws a filled circle with a white edge, which can be seen on any colour.
    pub(super) fn disc(&mut self, at: [f64; 2], colour: Colour) {
        let ([x, y], colour) = (at.map(tenths), hex(colour));
        self.put(format_args!(
            "<circle cx=\"{x}\" cy=\"{y}\" r=\"{RADIUS}\" fill=\"{colour}\" stroke=\"white\" stroke-width=\"0.9\"/>"
        ));
    }

    /// Draws a text in letters of `size`, in black. An empty text draws nothing.
    pub(super) fn text(&mut self, [x, y]: [f64; 2], text: &str, size: f64, anchor: Anchor) {
        if text.is_empty() {
            return;
        }
        let [x, y, base] = [x, y, y + HALF_A_LETTER * size].map(tenths);
        let style = match anchor {
            Anchor::Start => String::new(),
            Anchor::Middle => " text-anchor=\"middle\"".into(),
            Anchor::Bold => " text-anchor=\"middle\" font-weight=\"bold\"".into(),
            Anchor::End => " text-anchor=\"end\"".into(),
            Anchor::Upwards => format!(" text-anchor=\"middle\" transform=\"rotate(-90 {x} {y})\""),
        };
        let text = escaped(text);
        self.put(format_args!(
            "<text x=\"{x}\" y=\"{base}\" font-size=\"{size}\" fill=\"black\"{style}>\n{text}\n</text>"
        ));
    }
}

fn rectangle([left, top]: [f64; 2], [right, bottom]: [f64; 2]) -> [[f64; 2]; 4] {
    [[left, top], [right, top], [right, bottom], [left, bottom]]
}

/// Returns the attributes of a line.
fn stroke(line: Line, colour: Colour) -> String {
    let (colour, width, dashes) = (hex(colour), line.width, line.dash.lengths(line.width));
    let dashes = if dashes.is_empty() { String::new() } else { format!(" stroke-dasharray=\"{dashes}\"") };
    format!("stroke=\"{colour}\" stroke-width=\"{width}\"{dashes}")
}

/// Returns the approximate width of a text in letters of `size`.
pub(super) fn text_width(text: &str, size: f64) -> f64 {
    let width = |c: char| match c {
        ' ' | '.' | ',' | ':' | '\'' | 'i' | 'j' | 'l' | 't' | 'f' | 'r' | 'I' | '(' | ')' => 0.36,
        '₀'..='ₜ' | '⁰'..='⁻' | '¹' | '²' | '³' => 0.42,
        'm' | 'w' | 'M' | 'W' | '=' | '±' | '−' => 0.85,
        c if c.is_uppercase() => 0.72,
        _ => 0.61,
    };
    size * text.chars().map(width).sum::<f64>()
}

impl Dash {
    /// Returns the alternating lengths of marks and gaps; empty for an unbroken line.
    fn lengths(self, width: f64) -> &'static str {
        match self {
            Dash::Solid => "",
            Dash::Dotted if width < 1.5 => "1.2 2.4",
            Dash::Dotted => "2 3",
            Dash::Dashed => "7 4",
            Dash::DashDotted => "9 3.5 2 3.5",
        }
    }
}

/// Rounds a length to the visible digits.
fn tenths(x: f64) -> f64 {
    // + 0.0 turns -0 into 0.
    (10.0 * x).round() / 10.0 + 0.0
}

fn coordinates(points: &[[f64; 2]]) -> String {
    let coordinates = |point: &[f64; 2]| point.map(tenths).map(|x| x.to_string()).join(",");
    points.iter().map(coordinates).collect::<Vec<_>>().join(" ")
}

fn hex([red, green, blue]: Colour) -> String {
    format!("#{red:02x}{green:02x}{blue:02x}")
}

/// Escapes a text for XML, without control characters.
fn escaped(text: &str) -> String {
    let mut escaped = String::with_capacity(text.len());
    for c in text.chars() {
        match c {
            '&' => escaped.push_str("&amp;"),
            '<' => escaped.push_str("&lt;"),
            '>' => escaped.push_str("&gt;"),
            '\u{fffe}' | '\u{ffff}' => escaped.push(char::REPLACEMENT_CHARACTER),
            c if c.is_control() => escaped.push(char::REPLACEMENT_CHARACTER),
            c => escaped.push(c),
        }
    }
    escaped
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn elements_carry_what_they_show() {
        let mut svg = Svg::new([99.5, 40.0]);
        svg.line(&[[0.0, -0.01], [10.0 / 3.0, 20.0]], Line { dash: Dash::Dashed, width: 1.8 }, [31, 90, 160]);
        svg.polygon(&[[0.0, 0.0], [1.0, 0.0], [1.0, 1.0]], [255, 255, 255]);
        svg.within([1.0, 2.0], [30.0, 20.0], |svg| svg.marker([5.0, 6.25], Marker::Disc, BLACK));
        svg.text([50.0, 20.0], "σₙ, MPa", 10.0, Anchor::Upwards);
        let picture = svg.finish();
        let lines: Vec<&str> = picture.lines().collect();
        assert!(lines[0].starts_with(
            "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"100\" height=\"40\" viewBox=\"0 0 100 40\""
        ));
        assert_eq!(
            lines[2..],
            [
                "<polyline points=\"0,0 3.3,20\" stroke=\"#1f5aa0\" stroke-width=\"1.8\" stroke-dasharray=\"7 4\"/>",
                "<polygon points=\"0,0 1,0 1,1\" fill=\"#ffffff\"/>",
                "<svg x=\"1\" y=\"2\" width=\"30\" height=\"20\" viewBox=\"1 2 30 20\">",
                "<circle cx=\"5\" cy=\"6.3\" r=\"3.4\" fill=\"#000000\"/>",
                "</svg>",
                "<text x=\"50\" y=\"23.5\" font-size=\"10\" fill=\"black\" text-anchor=\"middle\" transform=\"rotate(-90 50 20)\">",
                "σₙ, MPa",
                "</text>",
                "</svg>",
            ]
        );
    }

    #[test]
    fn any_text_is_well_formed() {
        assert_eq!(escaped("a < b & \"c\" > d"), "a &lt; b &amp; \"c\" &gt; d");
        assert_eq!(escaped("\u{0}a\tb\u{1b}\u{ffff}"), "\u{fffd}a\u{fffd}b\u{fffd}\u{fffd}");
        let mut svg = Svg::new([1.0, 1.0]);
        svg.text([0.0, 0.0], "", 10.0, Anchor::Start);
        assert!(!svg.finish().contains("<text"));
    }

    #[test]
    fn only_finite_numbers_are_drawn() {
        assert_eq!(expect_finite([1.0, f64::NAN].into_iter()), Err(PlotError));
        assert_eq!(expect_finite([1.0, f64::MAX].into_iter()), Ok(()));
    }
}
