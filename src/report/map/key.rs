//! What the colours, the markers and the arrows of a map mean.

use super::view::View;
use super::{BLACK, GREY, HELD, LABEL_SIZE, NUMBER_SIZE, THIN, WHITE, WIDTH, arrow};
use crate::report::chart::axis::Scale;
use crate::report::svg::{Anchor, Colour, Marker, Svg, text_width};

/// The width of the bar of colours, px.
const BAR: f64 = 20.0;
/// Between the surface and the bar, px.
const GAP: f64 = 30.0;

/// The shades of the bar.
const STEPS: usize = 100;

/// The colours of the pressure, from none to the highest.
const PRESSURE: [Colour; 4] = [[248, 251, 255], [178, 208, 236], [96, 158, 212], [38, 98, 170]];

impl View {
    /// The bar of colours to the right of the surface.
    pub(super) fn draw_colours(&self, svg: &mut Svg) {
        if self.most_pressure <= 0.0 {
            return;
        }
        let ([_, bottom], [right, top]) = (self.at(self.low), self.at(self.high));
        let (from, to) = (right + GAP, right + GAP + BAR);
        let height = |share: f64| bottom - share * (bottom - top);
        for k in 0..STEPS {
            let [low, high] = [k, k + 1].map(|k| k as f64 / STEPS as f64);
            let corners = [[from, low], [to, low], [to, high], [from, high]].map(|[x, y]| [x, height(y)]);
            svg.tile(&corners, shade((k as f64 + 0.5) / STEPS as f64));
        }
        svg.line(&[[from, top], [to, top], [to, bottom], [from, bottom], [from, top]], THIN, BLACK);
        let most = self.most_pressure;
        for tick in Scale::Linear.ticks([0.0, most].into_iter(), 0.0, (bottom - top) / 40.0).all {
            if let (Some(label), true) = (&tick.label, tick.value <= most) {
                let y = height(tick.value / most);
                svg.line(&[[to, y], [to + 5.0, y]], THIN, BLACK);
                svg.text([to + 9.0, y], label, NUMBER_SIZE, Anchor::Start);
            }
        }
        svg.text(
            [to + 62.0, 0.5 * (top + bottom)],
            &format!("σₙ, normal, {}", self.stress),
            LABEL_SIZE,
            Anchor::Upwards,
        );
    }

    /// A row above the surface: what the colours, the markers and the arrows mean.
    pub(super) fn draw_legend(&self, svg: &mut Svg) {
        let mut entries = vec![(Sample::Patch(WHITE), "open".to_string())];
        if self.held {
            entries.push((Sample::Patch(HELD), "held by supports".into()));
        }
        if self.friction && self.markers {
            entries.push((Sample::Marker(Marker::Disc), "stick".into()));
            entries.push((Sample::Marker(Marker::Circle), "slip".into()));
        }
        if self.friction {
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
                    let corners = [[x, y - 6.0], [x + 12.0, y - 6.0], [x + 12.0, y + 6.0], [x, y + 6.0]];
                    svg.polygon(&corners, colour);
                    let around: Vec<_> = corners.into_iter().chain([corners[0]]).collect();
                    svg.line(&around, THIN, GREY);
                }
                Sample::Marker(marker) => svg.marker([x + 4.0, y], marker, BLACK),
                Sample::Arrow(length) => arrow(svg, [x, y], [length, 0.0]),
            }
            svg.text([x + sample.width() + 8.0, y], text, LABEL_SIZE, Anchor::Start);
            x += width(entry);
        }
    }
}

/// What an entry of the legend shows.
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

/// The largest 1, 2 or 5 times a power of ten up to `most`.
fn round_stress(most: f64) -> f64 {
    let power = 10.0_f64.powf(most.log10().floor());
    [5.0, 2.0].map(|k| k * power).into_iter().find(|&k| k <= most).unwrap_or(power)
}

/// The colour of a share of the highest pressure.
pub(super) fn shade(share: f64) -> Colour {
    let place = share.clamp(0.0, 1.0) * (PRESSURE.len() - 1) as f64;
    let k = (place as usize).min(PRESSURE.len() - 2);
    let t = place - k as f64;
    [0, 1, 2].map(|c| {
        let [a, b] = [PRESSURE[k][c], PRESSURE[k + 1][c]].map(f64::from);
        (a + t * (b - a)).round() as u8
    })
}
