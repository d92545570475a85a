//! The colour scale of a stress, and its colour bar.

use super::chart::axis::Scale;
use super::svg::{Anchor, Colour, Dash, Line, Svg};

/// The width of the bar, px.
const BAR: f64 = 20.0;
/// The number of shades of the bar.
const STEPS: usize = 100;
const LABEL_SIZE: f64 = 15.0;
const NUMBER_SIZE: f64 = 13.5;
const BLACK: Colour = [0, 0, 0];
const THIN: Line = Line { dash: Dash::Solid, width: 1.0 };

/// The colours from zero to the highest value.
const SHADES: [Colour; 4] = [[248, 251, 255], [178, 208, 236], [96, 158, 212], [38, 98, 170]];

/// Returns the colour for a share of the highest value.
pub(super) fn shade(share: f64) -> Colour {
    let place = share.clamp(0.0, 1.0) * (SHADES.len() - 1) as f64;
    let k = (place as usize).min(SHADES.len() - 2);
    let t = place - k as f64;
    [0, 1, 2].map(|c| {
        let [a, b] = [SHADES[k][c], SHADES[k + 1][c]].map(f64::from);
        (a + t * (b - a)).round() as u8
    })
}

/// Draws a colour bar up to `most`, in the unit named by `label`, from `top` to `bottom` with its left side at `from`,
/// px. Draws nothing if there is no stress.
pub(super) fn draw_bar(svg: &mut Svg, from: f64, [top, bottom]: [f64; 2], most: f64, label: &str) {
    if most <= 0.0 {
        return;
    }
    let to = from + BAR;
    let height = |share: f64| bottom - share * (bottom - top);
    for k in 0..STEPS {
        let [low, high] = [k, k + 1].map(|k| k as f64 / STEPS as f64);
        let corners = [[from, low], [to, low], [to, high], [from, high]].map(|[x, y]| [x, height(y)]);
        svg.tile(&corners, shade((k as f64 + 0.5) / STEPS as f64));
    }
    svg.line(&[[from, top], [to, top], [to, bottom], [from, bottom], [from, top]], THIN, BLACK);
    for tick in Scale::Linear.ticks([0.0, most].into_iter(), 0.0, (bottom - top) / 40.0).all {
        if let (Some(label), true) = (&tick.label, tick.value <= most) {
            let y = height(tick.value / most);
            svg.line(&[[to, y], [to + 5.0, y]], THIN, BLACK);
            svg.text([to + 9.0, y], label, NUMBER_SIZE, Anchor::Start);
        }
    }
    svg.text([to + 62.0, 0.5 * (top + bottom)], label, LABEL_SIZE, Anchor::Upwards);
}
