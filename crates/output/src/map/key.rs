//! The key of a map: its colours, markers and arrows.

use super::view::View;
use super::{ALONE, HELD, arrow};
use crate::svg::{Anchor, BLACK, Colour, GREY, LABEL_SIZE, Marker, Svg, WHITE, WIDTH, text_width};

/// The distance between the surface and the bar, px.
const GAP: f64 = 30.0;

impl View {
    /// Draws the colour bar to the right of the surface.
    pub(super) fn draw_colours(&self, svg: &mut Svg) {
        let ([_, bottom], [right, top]) = (self.at(self.low), self.at(self.high));
        let label = format!("σₙ, normal, {}", self.stress);
        self.bands.draw_bar(svg, right + GAP, [top, bottom], &label);
    }

    /// Draws a row above the surface that explains the colours, the markers and the arrows.
    pub(super) fn draw_legend(&self, svg: &mut Svg) {
        let mut entries = vec![(Sample::Patch(WHITE), "open".to_string())];
        if self.held {
            entries.push((Sample::Patch(HELD), "held by supports".into()));
        }
        if self.isolated {
            entries.push((Sample::Patch(ALONE), "nothing in front".into()));
        }
        if self.friction() && self.markers {
            entries.push((Sample::Marker(Marker::Disc), "stick".into()));
            entries.push((Sample::Marker(Marker::Circle), "slip".into()));
        }
        if self.friction() {
            let stress = round_stress(self.most_traction);
            let length = stress / self.most_traction * self.arrow;
            entries.push((Sample::Arrow(length), format!("σₜ, tangential, {stress} {}", self.stress)));
        }
        let width = |(sample, text): &(Sample, String)| sample.width() + 8.0 + text_width(text, LABEL_SIZE) + 24.0;
        let mut x = 0.5 * (WIDTH - entries.iter().map(width).sum::<f64>() + 24.0);
        let y = 78.0;
        for entry in &entries {
            let (sample, text) = entry;
            match *sample {
                Sample::Patch(colour) => {
                    let (from, to) = ([x, y - 6.0], [x + 12.0, y + 6.0]);
                    svg.rectangle(from, to, colour);
                    svg.frame(from, to, GREY);
                }
                Sample::Marker(marker) => svg.marker([x + 4.0, y], marker, BLACK),
                Sample::Arrow(length) => arrow(svg, [x, y], [length, 0.0]),
            }
            svg.text([x + sample.width() + 8.0, y], text, LABEL_SIZE, Anchor::Start);
            x += width(entry);
        }
    }
}

/// The sample of a legend entry.
enum Sample {
    Patch(Colour),
    Marker(Marker),
    Arrow(f64),
}

impl Sample {
    fn width(&self) -> f64 {
        match self {
            Sample::Patch(_) => 12.0,
            Sample::Marker(_) => 8.0,
            Sample::Arrow(length) => *length,
        }
    }
}

/// Returns the largest 1, 2 or 5 times a power of ten up to `most`.
fn round_stress(most: f64) -> f64 {
    let power = 10.0_f64.powf(most.log10().floor());
    [5.0, 2.0].map(|k| k * power).into_iter().find(|&k| k <= most).unwrap_or(power)
}
