//! The visible part of a contact surface, its position in the picture, and the frame around it.

use super::SurfaceNode;
use crate::ContactSurface;
use crate::chart::axis::{Scale, Tick};
use crate::colours::Bands;
use crate::svg::{Anchor, BLACK, Colour, LABEL_SIZE, NUMBER_SIZE, Svg, THIN, WIDTH};
use stickslip::base::Quantity;

/// The space left of the surface, for the axis label and the numbers.
const LEFT: f64 = 92.0;
/// The space right of the surface, for the colour bar.
const RIGHT: f64 = 150.0;
const TOP: f64 = 104.0;
const BELOW: f64 = 64.0;
const MAX_HEIGHT: f64 = 720.0;

/// The colour outside the surface.
const OUTSIDE: Colour = [236, 236, 236];
/// A contact zone smaller than this share of the surface is shown alone.
const SMALL: f64 = 1.0 / 3.0;
/// The smallest ratio of the sides of the frame.
const NARROWEST: f64 = 0.25;
/// The longest arrow, relative to the distance between nodes.
const ARROW: f64 = 0.9;
/// The smallest useful size of the longest arrow, px. If nodes are closer, some have no arrow.
const SHORTEST: f64 = 24.0;

/// The visible part and its scale.
pub(super) struct View {
    /// The names of the units of lengths and stresses.
    length: String,
    pub(super) stress: String,
    /// The length of one degree to the right, if the surface is unrolled.
    degree: Option<f64>,
    /// The lowest and the highest visible coordinates.
    pub(super) low: [f64; 2],
    pub(super) high: [f64; 2],
    /// The size of the visible part in the picture, px.
    pub(super) size: [f64; 2],
    pub(super) bands: Bands,
    pub(super) most_traction: f64,
    /// `true` if supports hold a visible node along the normal.
    pub(super) held: bool,
    /// `true` if nothing is in front of a visible node.
    pub(super) isolated: bool,
    /// The length of the longest arrow, px.
    pub(super) arrow: f64,
    /// `true` if nodes are far enough apart for markers.
    pub(super) markers: bool,
}

impl View {
    pub(super) fn new(surface: &ContactSurface) -> Self {
        let pressed: Vec<[f64; 2]> =
            surface.patches().filter(|(node, _)| node.pressure > 0.0).flat_map(|(_, corners)| corners).collect();
        let all = || surface.nodes.iter().map(|node| node.position);
        let bounds = |points: &mut dyn Iterator<Item = [f64; 2]>| {
            points.fold([[f64::INFINITY; 2], [f64::NEG_INFINITY; 2]], |[low, high], point| {
                [[0, 1].map(|c| low[c].min(point[c])), [0, 1].map(|c| high[c].max(point[c]))]
            })
        };
        let whole = bounds(&mut all());
        let area = |[low, high]: [[f64; 2]; 2]| (0..2).map(|c| high[c] - low[c]).product::<f64>();
        let zone = bounds(&mut pressed.iter().copied());
        let [low, high] = if !pressed.is_empty() && area(zone) < SMALL * area(whole) { zone } else { whole };
        let shown = all().filter(|p| (0..2).all(|c| (low[c]..=high[c]).contains(&p[c]))).count().max(1);
        let shown_area = (0..2).map(|c| (high[c].min(whole[1][c]) - low[c].max(whole[0][c])).max(0.0)).product::<f64>();
        let spacing = (shown_area / shown as f64).sqrt();
        let most = |value: fn(&SurfaceNode) -> f64| surface.nodes.iter().map(value).fold(0.0, f64::max);
        let most_traction = most(|node| node.traction[0].hypot(node.traction[1]));
        // A margin around the contact, with room for arrows.
        let margin = 0.08 * (high[0] - low[0]).max(high[1] - low[1]);
        let rubbed = surface.nodes.iter().filter(|node| node.pressure > 0.0 && most_traction > 0.0);
        let tip =
            |node: &SurfaceNode| [0, 1].map(|c| node.position[c] + ARROW * spacing * node.traction[c] / most_traction);
        let tips = rubbed.map(tip);
        let [lowest, highest] = bounds(&mut tips.chain([low, high]));
        let low = [0, 1].map(|c| (low[c] - margin).min(lowest[c] - 0.25 * margin));
        let high = [0, 1].map(|c| (high[c] + margin).max(highest[c] + 0.25 * margin));
        // A larger margin beside a narrow contact, for the numbers along its side.
        let narrowest = NARROWEST * (high[0] - low[0]).max(high[1] - low[1]);
        let widened = [0, 1].map(|c| 0.5 * (narrowest - (high[c] - low[c])).max(0.0));
        let low = [0, 1].map(|c| low[c] - widened[c]);
        let high = [0, 1].map(|c| high[c] + widened[c]);
        let [across, upwards] = [0, 1].map(|c| high[c] - low[c]);
        let scale = ((WIDTH - LEFT - RIGHT) / across).min(MAX_HEIGHT / upwards);
        let spacing = scale * spacing;
        let visible =
            || surface.nodes.iter().filter(|node| (0..2).all(|c| (low[c]..=high[c]).contains(&node.position[c])));
        let [length, stress] = [Quantity::Length, Quantity::Stress].map(|quantity| surface.units.name(quantity));
        View {
            length,
            stress,
            degree: surface.degree,
            low,
            high,
            size: [scale * across, scale * upwards],
            bands: Bands::up_to(most(|node| node.pressure)),
            most_traction,
            held: visible().any(|node| node.status.is_none() && node.held),
            isolated: visible().any(|node| node.status.is_none() && !node.held),
            arrow: (ARROW * spacing).max(SHORTEST),
            markers: spacing > 16.0,
        }
    }

    /// Returns the position of a point in the picture.
    pub(super) fn at(&self, place: [f64; 2]) -> [f64; 2] {
        let share = |c: usize| (place[c] - self.low[c]) / (self.high[c] - self.low[c]);
        [self.left() + share(0) * self.size[0], TOP + (1.0 - share(1)) * self.size[1]]
    }

    /// Returns `true` if there are tangential stresses.
    pub(super) fn friction(&self) -> bool {
        self.most_traction > 0.0
    }

    /// Returns the middle of the visible part.
    pub(super) fn middle(&self) -> [f64; 2] {
        [0, 1].map(|c| 0.5 * (self.low[c] + self.high[c]))
    }

    /// Returns the left side of the surface. Surface and colour bar are centred in the picture.
    fn left(&self) -> f64 {
        LEFT + 0.5 * (WIDTH - LEFT - RIGHT - self.size[0])
    }

    /// Returns `true` if any part of the figure with these corners is in the frame.
    pub(super) fn shows(&self, corners: &[[f64; 2]]) -> bool {
        (0..2).all(|c| corners.iter().any(|p| p[c] >= self.low[c]) && corners.iter().any(|p| p[c] <= self.high[c]))
    }

    /// Returns the height of the picture, px.
    pub(super) fn end(&self) -> f64 {
        TOP + self.size[1] + BELOW
    }

    /// Draws the part of `draw` that is inside the frame.
    pub(super) fn draw_inside(&self, svg: &mut Svg, draw: impl FnOnce(&mut Svg)) {
        let ([left, bottom], [right, top]) = (self.at(self.low), self.at(self.high));
        svg.within([left, top], self.size, |svg| {
            svg.rectangle([left, bottom], [right, top], OUTSIDE);
            draw(svg);
        });
    }

    /// Draws the frame with the coordinates along it.
    pub(super) fn draw_frame(&self, svg: &mut Svg, axes: &[[f64; 3]; 2]) {
        let ([left, bottom], [right, top]) = (self.at(self.low), self.at(self.high));
        svg.frame([left, top], [right, bottom], BLACK);
        for tick in self.ticks(0, 80.0) {
            let [x, _] = self.at([tick.value, self.low[1]]);
            svg.line(&[[x, bottom], [x, bottom + tick.length()]], THIN, BLACK);
            svg.text([x, bottom + 17.0], tick.label.as_deref().unwrap_or(""), NUMBER_SIZE, Anchor::Middle);
        }
        for tick in self.ticks(1, 45.0) {
            let [_, y] = self.at([self.low[0], tick.value]);
            svg.line(&[[left, y], [left - tick.length(), y]], THIN, BLACK);
            svg.text([left - 10.0, y], tick.label.as_deref().unwrap_or(""), NUMBER_SIZE, Anchor::End);
        }
        svg.text([0.5 * (left + right), bottom + 44.0], &self.across(axes), LABEL_SIZE, Anchor::Middle);
        svg.text([left - 70.0, 0.5 * (top + bottom)], &self.axis(axes[1]), LABEL_SIZE, Anchor::Upwards);
    }

    /// Describes the axis to the right.
    fn across(&self, [first, second]: &[[f64; 3]; 2]) -> String {
        match self.degree {
            Some(_) => format!("angle about {}, from {}, degrees", name(*second), name(*first)),
            None => self.axis(*first),
        }
    }

    /// Describes an axis.
    fn axis(&self, axis: [f64; 3]) -> String {
        let along = if axis.iter().filter(|c| **c != 0.0).count() > 1 { "along " } else { "" };
        format!("{along}{}, {}", name(axis), self.length)
    }

    /// Returns the ticks along axis `c` within the frame: a label about every `room` px, but at least two.
    fn ticks(&self, c: usize, room: f64) -> Vec<Tick> {
        let range = self.low[c]..=self.high[c];
        let unit = self.degree.filter(|_| c == 0).unwrap_or(1.0);
        let ticks = |most: f64| {
            let all = Scale::Linear.ticks([self.low[c] / unit, self.high[c] / unit].into_iter(), 0.0, most).all;
            let all = all.into_iter().map(|tick| Tick { value: unit * tick.value, ..tick });
            all.filter(|tick| range.contains(&tick.value)).collect::<Vec<_>>()
        };
        let labels = |ticks: &[Tick]| ticks.iter().filter(|tick| tick.label.is_some()).count();
        let most = self.size[c] / room;
        // Steps are 1, 2 or 5 times a power of ten. A step requested to fit five times into a range fits at least
        // twice.
        [2.0, 3.0, 4.0, 5.0]
            .map(|least| ticks(most.max(least)))
            .into_iter()
            .find(|ticks| labels(ticks) >= 2)
            .unwrap_or_default()
    }
}

/// Returns the name of a direction.
fn name(direction: [f64; 3]) -> String {
    match direction {
        [1.0, 0.0, 0.0] => "x".into(),
        [0.0, 1.0, 0.0] => "y".into(),
        [0.0, 0.0, 1.0] => "z".into(),
        [x, y, z] => format!("({x:.3}, {y:.3}, {z:.3})"),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use stickslip::base::UnitSystem;
    use stickslip::solver::ContactStatus;

    /// A strip of facets along y, of which the middle ones are pressed.
    fn strip(left: f64, width: f64, length: f64) -> ContactSurface {
        let node = |k: usize| SurfaceNode {
            position: [left + width * (k % 2) as f64, length * (k / 2) as f64 / 10.0],
            pressure: if (6..16).contains(&k) { 1e6 } else { 0.0 },
            traction: [0.0; 2],
            status: Some(ContactStatus::Stick),
            held: false,
        };
        ContactSurface {
            boundary: None,
            index: 1,
            time: 1.0,
            axes: [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0]],
            degree: None,
            nodes: (0..22).map(node).collect(),
            units: UnitSystem::si(3),
            facets: (0..10).map(|k| vec![2 * k, 2 * k + 1, 2 * k + 3, 2 * k + 2]).collect(),
        }
    }

    #[test]
    fn a_narrow_contact_has_numbers_along_both_sides() {
        for (left, width, length) in [(0.0443, 1e-4, 0.04), (0.0, 2e-3, 0.04), (-0.31, 0.004, 1.7), (12.0, 7.0, 0.02)] {
            let view = View::new(&strip(left, width, length));
            assert!(view.size.iter().all(|&size| size > 150.0), "{:?}", view.size);
            for (c, room) in [(0, 80.0), (1, 45.0)] {
                let ticks = view.ticks(c, room);
                let labels: Vec<_> = ticks.iter().filter_map(|tick| tick.label.as_deref()).collect();
                assert!((2..20).contains(&labels.len()), "{labels:?}");
            }
        }
    }
}
