//! The numbers along an axis.

use crate::svg::{NUMBER_SIZE, text_width};

/// The scale of an axis.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Scale {
    /// Linear.
    Linear,
    /// Linear, with whole numbers only.
    Integers,
    /// Logarithmic, with powers of ten.
    Decades,
}

/// The range of an axis and its ticks, in the values of [`Scale::map`].
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Ticks {
    pub from: f64,
    pub to: f64,
    pub all: Vec<Tick>,
}

#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Tick {
    pub value: f64,
    /// The number at the tick; `None` at a minor tick.
    pub label: Option<String>,
}

impl Tick {
    /// Returns the length to draw, px.
    pub(crate) fn length(&self) -> f64 {
        if self.label.is_some() { 6.0 } else { 3.0 }
    }
}

impl Ticks {
    /// Returns the position of a value between the ends of the axis, from 0 to 1.
    pub(crate) fn share(&self, value: f64) -> f64 {
        (value - self.from) / (self.to - self.from)
    }

    /// Returns the width of the longest number, px.
    pub(crate) fn widest(&self) -> f64 {
        let labels = self.all.iter().filter_map(|tick| tick.label.as_ref());
        labels.map(|label| text_width(label, NUMBER_SIZE)).fold(0.0, f64::max)
    }
}

impl Scale {
    /// Returns the value transformed to the linear coordinate of the axis; `None` if it has none.
    pub(crate) fn map(self, value: f64) -> Option<f64> {
        match self {
            Scale::Linear | Scale::Integers => Some(value),
            Scale::Decades => (value > 0.0).then(|| value.log10()),
        }
    }

    /// Returns the ticks for `values`, with about `most` labels and at least the share `margin` free at either end
    /// (half a step between whole numbers). A margin does not extend the axis across zero.
    pub(crate) fn ticks(self, values: impl Iterator<Item = f64>, margin: f64, most: f64) -> Ticks {
        let places = values.filter_map(|value| self.map(value)).filter(|place| place.is_finite());
        let places = places.map(|place| if place.abs() < 1.0 / FAR { 0.0 } else { place.clamp(-FAR, FAR) });
        let (low, high) = places.fold((f64::INFINITY, f64::NEG_INFINITY), |(a, b), v| (a.min(v), b.max(v)));
        let size = low.abs().max(high.abs());
        let least = match (self, low <= high) {
            (_, false) => return self.ticks([0.0, 1.0].into_iter(), margin, most),
            (Scale::Decades, _) => 0.02,
            _ if size == 0.0 => 2.0,
            _ if high - low <= NOISE * size => size,
            _ => FINEST * most.max(1.0) * size,
        };
        let room = (0.5 * (least - (high - low))).max(0.0);
        let (low, high) = (low - room, high + room);
        match self {
            Scale::Linear => linear(low, high, margin, most),
            Scale::Integers => integers(low, high, most),
            Scale::Decades => decades(low, high, margin, most),
        }
    }
}

/// The ends of an axis are at most this far from zero, and its steps at least the reciprocal apart, so that their
/// quotients are finite.
const FAR: f64 = 1e280;

/// Values whose range is a smaller share of them differ by rounding only: they are drawn as a constant.
const NOISE: f64 = 1e-9;

/// The distance of labels is at least this share of the values, so that labels have at most six digits.
const FINEST: f64 = 1e-5;

/// An end of the axis moves to a labelled tick if the distance is less than this share of the axis.
const NEAR: f64 = 0.05;

fn linear(low: f64, high: f64, margin: f64, most: f64) -> Ticks {
    let room = margin * (high - low);
    let from = if low >= 0.0 { (low - room).max(0.0) } else { low - room };
    let to = if high <= 0.0 { (high + room).min(0.0) } else { high + room };
    let (step, parts) = step(to - from, most);
    let minor = step / parts as f64;
    // An end that coincides with a tick up to rounding stays. An end close to a labelled tick moves there.
    let (first, last) = ((from / minor + 1e-6).floor() as i64, (to / minor - 1e-6).ceil() as i64);
    let near = |ticks: i64| ticks as f64 * minor <= NEAR * (to - from);
    let (below, above) = (first.rem_euclid(parts), (-last).rem_euclid(parts));
    let first = if near(below) { first - below } else { first };
    let last = if near(above) { last + above } else { last };
    let tick = |k: i64| Tick { value: k as f64 * minor, label: (k % parts == 0).then(|| number(k / parts, step)) };
    Ticks { from: first as f64 * minor, to: last as f64 * minor, all: (first..=last).map(tick).collect() }
}

/// Whole numbers have a tick each as long as there are at most so many for a label.
const TICKS_OF_LABEL: f64 = 8.0;

fn integers(low: f64, high: f64, most: f64) -> Ticks {
    let (low, high) = (low.floor(), high.ceil());
    if high - low > TICKS_OF_LABEL * most {
        return linear(low, high, 0.0, most);
    }
    whole(low, high, 0.5, most, |k| number(k, 1.0))
}

fn decades(low: f64, high: f64, margin: f64, most: f64) -> Ticks {
    let room = margin * (high - low);
    let power = |k: i64| format!("10{}", k.to_string().chars().map(superscript).collect::<String>());
    whole((low - room).floor(), (high + room).ceil(), 0.0, most, power)
}

/// Returns ticks at whole numbers, and the ends of the axis `beside` the first and the last.
fn whole(low: f64, high: f64, beside: f64, most: f64, label: impl Fn(i64) -> String) -> Ticks {
    let step = step(high - low, most).0.max(1.0) as i64;
    let tick = |k: i64| Tick { value: k as f64, label: (k % step == 0).then(|| label(k)) };
    Ticks { from: low - beside, to: high + beside, all: (low as i64..=high as i64).map(tick).collect() }
}

/// Returns the step (1, 2 or 5 times a power of ten) that divides `span` into at most about `most` parts, and the
/// number of parts into which minor ticks divide the step.
fn step(span: f64, most: f64) -> (f64, i64) {
    let least = span / most.max(1.0);
    let power = 10.0_f64.powf(least.log10().floor());
    match least / power {
        ratio if ratio <= 1.0 + 1e-9 => (power, 5),
        ratio if ratio <= 2.0 => (2.0 * power, 4),
        ratio if ratio <= 5.0 => (5.0 * power, 5),
        _ => (10.0 * power, 5),
    }
}

/// Formats `k` steps with as many digits as the step requires.
fn number(k: i64, step: f64) -> String {
    number_to(k as f64 * step, step)
}

/// Formats a number whose last digit has the value `unit`, a power of ten or a multiple of it.
pub(crate) fn number_to(value: f64, unit: f64) -> String {
    if value == 0.0 {
        return "0".into();
    }
    // The slack absorbs the rounding of numbers such as 0.001.
    let exponent = |x: f64| (x.abs().log10() + 1e-9).floor() as i32;
    let text = if exponent(unit) < -4 || exponent(value) > 4 {
        format!("{value:.*e}", (exponent(value) - exponent(unit)).max(0) as usize)
    } else {
        format!("{value:.*}", (-exponent(unit)).max(0) as usize)
    };
    text.replace('-', "−")
}

fn superscript(c: char) -> char {
    match c {
        '1' => '¹',
        '2' => '²',
        '3' => '³',
        '-' => '⁻',
        digit => digit.to_digit(10).and_then(|digit| char::from_u32(0x2070 + digit)).unwrap_or(digit),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn labels(scale: Scale, values: &[f64], most: f64) -> Vec<String> {
        scale.ticks(values.iter().copied(), 0.0, most).all.into_iter().filter_map(|tick| tick.label).collect()
    }

    #[test]
    fn labels_are_round_numbers() {
        assert_eq!(labels(Scale::Linear, &[0.0, 0.1], 6.0), ["0", "0.02", "0.04", "0.06", "0.08", "0.10"]);
        assert_eq!(labels(Scale::Linear, &[-37.0, 83.0], 7.0), ["−40", "−20", "0", "20", "40", "60", "80"]);
        assert_eq!(labels(Scale::Linear, &[1e-6, 5e-6], 5.0), ["1e−6", "2e−6", "3e−6", "4e−6", "5e−6"]);
        assert_eq!(labels(Scale::Integers, &[1.0, 40.0], 10.0), ["5", "10", "15", "20", "25", "30", "35", "40"]);
        assert_eq!(labels(Scale::Integers, &[0.0, 2.0], 10.0), ["0", "1", "2"]);
        assert_eq!(labels(Scale::Decades, &[3e-16, 2e13], 8.0), ["10⁻¹⁵", "10⁻¹⁰", "10⁻⁵", "10⁰", "10⁵", "10¹⁰"]);
    }

    #[test]
    fn the_range_holds_the_values() {
        for (low, high) in [(0.0, 0.1), (0.02, 1.0), (-3.7, -3.6), (-1e-9, 2e7), (5.0, 5.0), (0.0, 0.0)] {
            for scale in [Scale::Linear, Scale::Integers] {
                let ticks = scale.ticks([low, high].into_iter(), 0.03, 7.0);
                let slack = 1e-6 * (ticks.to - ticks.from);
                assert!(ticks.from <= low + slack && high <= ticks.to + slack, "{low} {high}: {ticks:?}");
                assert!(ticks.all.iter().all(|tick| (-1e-9..=1.0 + 1e-9).contains(&ticks.share(tick.value))));
            }
        }
    }

    #[test]
    fn rounding_is_not_drawn() {
        let ends = |low: f64, high: f64| {
            let ticks = Scale::Linear.ticks([low, high].into_iter(), 0.0, 12.0);
            (ticks.from, ticks.to)
        };
        assert_eq!(ends(3.999_999_999_999_906e3, 3.999_999_999_999_92e3), (2000.0, 6000.0));
        assert_eq!(ends(-4.0, -4.0 + 1e-12), (-6.0, -2.0));
        for (low, high) in [(1.0, 1.0 + 1e-8), (123_456.0, 123_456.1), (-9.87e-7, -9.869_999e-7)] {
            for label in labels(Scale::Linear, &[low, high], 12.0) {
                let digits = label.split('e').next().unwrap_or_default().chars().filter(char::is_ascii_digit);
                assert!(digits.count() <= 7, "{low} {high}: {label}");
            }
        }
    }

    #[test]
    fn any_values_have_few_ticks() {
        let ends = [0.0, 5e-324, 1e-310, 1.0, 1.0 + f64::EPSILON, 9.007_199_254_740_993e15, 1e19, 1e308, f64::MAX];
        let ends: Vec<f64> = ends.into_iter().chain([f64::INFINITY, f64::NAN]).flat_map(|x| [x, -x]).collect();
        for (low, high) in ends.iter().flat_map(|low| ends.iter().map(move |high| (*low, *high))) {
            for scale in [Scale::Linear, Scale::Integers, Scale::Decades] {
                let ticks = scale.ticks([low, high].into_iter(), 0.03, 7.0);
                assert!(ticks.all.len() < 800 && ticks.from < ticks.to, "{scale:?} {low} {high}: {}", ticks.all.len());
            }
        }
    }

    #[test]
    fn a_margin_does_not_cross_zero() {
        let ticks = Scale::Linear.ticks([1.0, 48.0].into_iter(), 0.05, 6.0);
        assert_eq!((ticks.from, ticks.to), (0.0, 52.0));
    }
}
