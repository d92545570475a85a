//! The lines of a mesh in a picture: fainter where they are close, none where they would hide the colours.

use super::svg::{Colour, Dash, Line, Svg};
use std::collections::BTreeMap;

const MESH: Colour = [40, 40, 40];

/// Lines closer than this are not drawn, px.
const CLOSEST: f64 = 4.0;
/// Lines closer than this are faint, px.
const CLOSE: f64 = 9.0;
const LINE: Line = Line { dash: Dash::Solid, width: 0.5 };
const FAINT: Line = Line { dash: Dash::Solid, width: 0.25 };

/// The sides of polygons of a picture.
pub(super) struct MeshLines {
    sides: BTreeMap<[[i64; 2]; 2], Side>,
}

struct Side {
    ends: [[f64; 2]; 2],
    /// The distance to the opposite side of the thinnest polygon here, px.
    apart: f64,
    /// The number of polygons here.
    polygons: usize,
}

impl MeshLines {
    pub(super) fn of<'a>(polygons: impl IntoIterator<Item = &'a [[f64; 2]]>) -> Self {
        let mut sides = BTreeMap::new();
        for polygon in polygons {
            let around = || polygon.iter().zip(polygon.iter().cycle().skip(1));
            let area = 0.5 * around().map(|(a, b)| a[0] * b[1] - a[1] * b[0]).sum::<f64>().abs();
            for (&a, &b) in around() {
                let apart = area / (b[0] - a[0]).hypot(b[1] - a[1]);
                let new = Side { ends: [a, b], apart, polygons: 0 };
                let side = sides.entry(key([a, b])).or_insert(new);
                side.apart = side.apart.min(apart);
                side.polygons += 1;
            }
        }
        MeshLines { sides }
    }

    /// Draws all sides. The outline, sides of one polygon only, is not faint.
    pub(super) fn draw(&self, svg: &mut Svg) {
        for line in [FAINT, LINE] {
            let own = self.sides.values().filter(|side| side.style() == Some(line));
            svg.segments(own.map(|side| side.ends), line, MESH);
        }
    }

    /// Draws the sides of one of the polygons.
    pub(super) fn draw_around(&self, svg: &mut Svg, polygon: &[[f64; 2]]) {
        let ends = polygon.iter().zip(polygon.iter().cycle().skip(1)).map(|(a, b)| [*a, *b]);
        let known = |ends: [[f64; 2]; 2]| Some((ends, self.sides.get(&key(ends))?.style()?));
        let drawn: Vec<_> = ends.filter_map(known).collect();
        for line in [FAINT, LINE] {
            svg.segments(drawn.iter().filter(|(_, of)| *of == line).map(|(ends, _)| *ends), line, MESH);
        }
    }
}

impl Side {
    /// Returns the style of the side; `None` if it is not drawn.
    fn style(&self) -> Option<Line> {
        match self.apart {
            _ if self.polygons == 1 => Some(LINE),
            apart if apart < CLOSEST => None,
            apart if apart < CLOSE => Some(FAINT),
            _ => Some(LINE),
        }
    }
}

/// Returns the ends of a side in tenths of a pixel, as they are drawn, in an order that both polygons agree on.
fn key(ends: [[f64; 2]; 2]) -> [[i64; 2]; 2] {
    let mut ends = ends.map(|end| end.map(|x| (10.0 * x).round() as i64));
    ends.sort_unstable();
    ends
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Returns the lines of a grid of `n` by `n` squares, 100 px wide.
    fn lines(n: usize) -> String {
        let h = 100.0 / n as f64;
        let square = |k: usize| {
            let (x, y) = ((k % n) as f64 * h, (k / n) as f64 * h);
            vec![[x, y], [x + h, y], [x + h, y + h], [x, y + h]]
        };
        let squares: Vec<_> = (0..n * n).map(square).collect();
        let mut svg = Svg::new([100.0, 100.0]);
        MeshLines::of(squares.iter().map(Vec::as_slice)).draw(&mut svg);
        svg.finish()
    }

    #[test]
    fn lines_fade_and_vanish_as_they_come_close() {
        let widths = |n: usize| {
            let lines = lines(n);
            [LINE, FAINT].map(|line| lines.contains(&format!("stroke-width=\"{}\"", line.width)))
        };
        assert_eq!([5, 20, 50].map(widths), [[true, false], [true, true], [true, false]]);
        // Only the outline is left.
        assert!(lines(50).contains("\"M0 0l") && lines(50).len() < 500, "{}", lines(50));
    }
}
