//! Plots of contact stresses along contact lines.

use super::chart::{Axis, Chart, Curve, Note, Panel, Scale};
use super::largest::first_largest;
use super::svg::{BLACK, Dash, Line, Marker, PlotError};
use stickslip::base::{Quantity, UnitSystem, six_digits};
use stickslip::run::report::{ContactLine, ContactPoint};
use stickslip::solver::ContactStatus;

const NORMAL: [u8; 3] = [31, 90, 160];
const TANGENTIAL: [u8; 3] = [190, 70, 10];
const BOUND: [u8; 3] = [110, 110, 110];
const SLIP: [u8; 3] = [20, 130, 60];
const GAP: [u8; 3] = [130, 60, 150];

/// Draws the contact stresses along a contact line as an SVG picture, see [`stress_chart`], with the largest pressure
/// marked, and below them slip and gap.
///
/// # Errors
/// When a stress is not finite.
pub fn contact_stresses(line: &ContactLine, title: &str) -> Result<String, PlotError> {
    let boundary = line.boundary.as_ref().map_or(String::new(), |name| format!("boundary {name}, "));
    let subtitle = format!("contact stresses, {boundary}t = {} s", six_digits(line.time));
    let mut chart = stress_chart(title.into(), subtitle, 1, &[(String::new(), line)]);
    let (points, along) = (shown(&line.points), Abscissa::of(&[(String::new(), line)]));
    if let Some(stresses) = chart.panels.first_mut() {
        stresses.notes = largest_pressure(points, &along, &line.units.of_pictures()).into_iter().collect();
    }
    chart.panels.push(motion(points, &along, &line.units));
    chart.to_svg()
}

/// Creates a panel for each contact line under its heading: `σ_n` and `σ_t`, the friction bound `±μ σ_n`, and on `σ_t`
/// the status of each node: filled for stick, hollow for slip, no marker for open. Only what touches is shown, and a
/// little around it.
pub fn stress_chart(title: String, subtitle: String, columns: usize, lines: &[(String, &ContactLine)]) -> Chart {
    let along = Abscissa::of(lines);
    let units = lines.first().map_or(UnitSystem::si(2), |(_, line)| line.units).of_pictures();
    let axis =
        |label: &str, quantity| Axis { label: format!("{label}, {}", units.name(quantity)), scale: Scale::Linear };
    Chart {
        title,
        subtitle,
        x: axis(along.label, Quantity::Length),
        y: axis("contact stress", Quantity::Stress),
        columns,
        panels: lines
            .iter()
            .map(|(heading, line)| Panel {
                title: heading.clone(),
                curves: curves(shown(&line.points), &along, &units),
                ..Panel::default()
            })
            .collect(),
    }
}

/// The horizontal axis.
struct Abscissa {
    of: fn(&ContactPoint) -> f64,
    label: &'static str,
    /// The name of a position in a text.
    short: &'static str,
}

impl Abscissa {
    /// Contact lines are mostly level. Then x is clearer than the distance along the line.
    fn of(lines: &[(String, &ContactLine)]) -> Self {
        let level =
            |line: &ContactLine| line.points.windows(2).all(|pair| pair[1].x > pair[0].x && pair[1].y == pair[0].y);
        if lines.iter().all(|(_, line)| level(line)) {
            Abscissa { of: |p| p.x, label: "x", short: "x =" }
        } else {
            Abscissa { of: |p| p.s, label: "distance along the contact line", short: "the distance" }
        }
    }
}

fn touches(point: &ContactPoint) -> bool {
    point.status != ContactStatus::Open
}

/// Returns the points to show: those in contact and half as many around them, at least two on either side; all points
/// if nothing touches.
fn shown(points: &[ContactPoint]) -> &[ContactPoint] {
    let (Some(first), Some(last)) = (points.iter().position(touches), points.iter().rposition(touches)) else {
        return points;
    };
    let (low, high) = (points[first].s, points[last].s);
    let margin = 0.25 * (high - low);
    let from = points.partition_point(|p| p.s < low - margin).min(first.saturating_sub(2));
    let to = points.partition_point(|p| p.s <= high + margin).max(last + 3).min(points.len());
    &points[from..to]
}

fn curves(points: &[ContactPoint], along: &Abscissa, units: &UnitSystem) -> Vec<Curve> {
    let in_units = |x: f64, y: f64| [units.of_si(Quantity::Length, x), units.of_si(Quantity::Stress, y)];
    let stress = |label: &str, dash, width, colour, ordinate: fn(&ContactPoint) -> f64| Curve {
        label: label.into(),
        points: points.iter().map(|p| in_units((along.of)(p), ordinate(p))).collect(),
        line: Some(Line { dash, width }),
        marker: None,
        colour,
    };
    // The friction bound is one for the magnitude of both tangential components.
    let tangential: fn(&ContactPoint) -> f64 =
        if units.components == 3 { |p| p.sigma_t.hypot(p.sigma_o) } else { |p| p.sigma_t };
    let marked = marked(points);
    let nodes = |status, marker| Curve {
        label: String::new(),
        points: marked.iter().filter(|p| p.status == status).map(|p| in_units((along.of)(p), tangential(p))).collect(),
        line: None,
        marker: Some(marker),
        colour: TANGENTIAL,
    };
    // Samples for the legend only: a marker has the same meaning in any colour.
    let sample = |label: &str, marker| Curve {
        label: label.into(),
        points: vec![],
        line: None,
        marker: Some(marker),
        colour: BLACK,
    };
    vec![
        nodes(ContactStatus::Stick, Marker::Disc),
        nodes(ContactStatus::Slip, Marker::Circle),
        stress("σₙ, normal", Dash::Dotted, 2.2, NORMAL, |p| p.sigma_n),
        stress("σₜ, tangential", Dash::Solid, 1.8, TANGENTIAL, tangential),
        stress("±μ σₙ", Dash::Dashed, 1.0, BOUND, |p| p.mu * p.sigma_n),
        stress("±μ σₙ", Dash::Dashed, 1.0, BOUND, |p| -p.mu * p.sigma_n),
        sample("stick", Marker::Disc),
        sample("slip", Marker::Circle),
    ]
}

/// Returns the nodes that have a marker: the ends of each zone, and between them as many as can be told apart.
fn marked(points: &[ContactPoint]) -> Vec<&ContactPoint> {
    let apart = points.last().zip(points.first()).map_or(0.0, |(last, first)| (last.s - first.s) / MAX_MARKERS);
    let mut marked: Vec<&ContactPoint> = Vec::new();
    for (k, point) in points.iter().enumerate() {
        let is_inside = [k.checked_sub(1), Some(k + 1)]
            .into_iter()
            .all(|k| k.and_then(|k| points.get(k)).is_some_and(|other| other.status == point.status));
        if !is_inside || marked.last().is_none_or(|last| point.s - last.s >= apart) {
            marked.push(point);
        }
    }
    marked
}

/// The largest number of markers along a line; more would hide each other.
const MAX_MARKERS: f64 = 200.0;

/// Marks the node with the largest pressure, if there is pressure: the first one if several have it within rounding.
fn largest_pressure(points: &[ContactPoint], along: &Abscissa, units: &UnitSystem) -> Option<Note> {
    let node = &points[first_largest(points.iter().map(|p| p.sigma_n))?];
    let (x, stress) = ((along.of)(node), node.sigma_n);
    let [value, place] =
        [(Quantity::Stress, stress), (Quantity::Length, x)].map(|(quantity, value)| units.rounded(quantity, value, 4));
    Some(Note {
        at: [units.of_si(Quantity::Length, x), units.of_si(Quantity::Stress, stress)],
        text: format!("largest σₙ {value} at {} {place}", along.short),
    })
}

/// Creates the panel of slip and gap. A gap far larger than the slip leaves the panel.
fn motion(points: &[ContactPoint], along: &Abscissa, units: &UnitSystem) -> Panel {
    let most = |value: fn(&ContactPoint) -> f64| points.iter().map(value).fold(0.0, f64::max);
    let slipped: fn(&ContactPoint) -> f64 =
        if units.components == 3 { |p| p.slip_t.hypot(p.slip_o) } else { |p| p.slip_t };
    let (slip, gap) = (points.iter().map(|p| slipped(p).abs()).fold(0.0, f64::max), most(|p| p.gap));
    let top = if slip > NO_SLIP * gap { gap.min(HIGHEST_GAP * slip) } else { gap };
    let rounding = ROUNDING * points.last().zip(points.first()).map_or(0.0, |(last, first)| last.s - first.s);
    let shown = |value: f64| if value.abs() <= rounding { 0.0 } else { value };
    let (unit, name) = small_lengths(shown(slip.max(top)), units);
    let in_units = |[x, y]: [f64; 2]| [units.of_si(Quantity::Length, x), y / unit];
    let curve = |label: &str, dash, colour, points: Vec<[f64; 2]>| Curve {
        label: label.into(),
        points: points.into_iter().map(in_units).collect(),
        line: Some(Line { dash, width: 1.8 }),
        marker: None,
        colour,
    };
    let of =
        |value: fn(&ContactPoint) -> f64| points.iter().map(|p| [(along.of)(p), shown(value(p))]).collect::<Vec<_>>();
    let slip = curve("slip distance", Dash::Solid, SLIP, of(slipped));
    let gaps = below(&of(|p| p.gap), top).into_iter().map(|part| curve("gap", Dash::DashDotted, GAP, part));
    Panel {
        curves: [slip].into_iter().chain(gaps).collect(),
        y: Some(Axis { label: format!("slip and gap, {name}"), scale: Scale::Linear }),
        ..Panel::default()
    }
}

/// Lengths below this share of the line are rounding, and drawn as zero.
const ROUNDING: f64 = 1e-10;

/// A slip below this share of the gap is rounding.
const NO_SLIP: f64 = 1e-6;

/// The highest gap that is shown, relative to the largest slip.
const HIGHEST_GAP: f64 = 4.0;

/// Returns the size (m) and the name of the unit in which a length, such as a slip, is at least 1: nm, µm, mm or m; the
/// unit of a scene in inches or feet.
fn small_lengths(length: f64, units: &UnitSystem) -> (f64, String) {
    let own = units.name(Quantity::Length);
    if ["in", "ft"].contains(&own.as_str()) {
        return (units.to_si(Quantity::Length, 1.0), own);
    }
    let prefixed = [(1.0, "m"), (1e-3, "mm"), (1e-6, "µm")].into_iter().find(|(unit, _)| length >= *unit);
    let (unit, name) = if length == 0.0 { (1e-6, "µm") } else { prefixed.unwrap_or((1e-9, "nm")) };
    (unit, name.to_string())
}

/// Returns the parts of a line through `points` that are not above `top`.
fn below(points: &[[f64; 2]], top: f64) -> Vec<Vec<[f64; 2]>> {
    let mut parts: Vec<Vec<[f64; 2]>> = vec![Vec::new()];
    let mut last: Option<[f64; 2]> = None;
    for &point in points {
        if let Some(last) = last.filter(|last| (last[1] > top) != (point[1] > top)) {
            let share = (top - last[1]) / (point[1] - last[1]);
            let crossing = [last[0] + share * (point[0] - last[0]), top];
            match parts.last_mut() {
                Some(part) if last[1] <= top => part.push(crossing),
                _ => parts.push(vec![crossing]),
            }
        }
        if let Some(part) = parts.last_mut().filter(|_| point[1] <= top) {
            part.push(point);
        }
        last = Some(point);
    }
    parts.retain(|part| part.len() > 1);
    parts
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A straight line of `n` nodes, of which those `closed` stick.
    fn points(n: usize, closed: std::ops::Range<usize>) -> Vec<ContactPoint> {
        let point = |k: usize| ContactPoint {
            node: k,
            frame: [[0.0; 3]; 3],
            x: k as f64,
            y: 0.0,
            z: 0.0,
            s: k as f64,
            p_n: 1.0,
            p_t: 0.0,
            p_o: 0.0,
            sigma_n: 1.0,
            sigma_t: 0.0,
            sigma_o: 0.0,
            sigma_patch: None,
            w_n: 0.0,
            w_t: 0.0,
            w_o: 0.0,
            gap: 0.0,
            slip_t: 0.0,
            slip_o: 0.0,
            force: [0.0; 3],
            mu: 0.3,
            status: if closed.contains(&k) { ContactStatus::Stick } else { ContactStatus::Open },
            sigma_along: 0.0,
            sigma_across: 0.0,
            sigma_shear: 0.0,
            stress: [0.0; 6],
        };
        (0..n).map(point).collect()
    }

    #[test]
    fn a_narrow_contact_fills_the_plot() {
        let range = |n, closed| {
            let points = points(n, closed);
            let shown = shown(&points);
            (shown[0].x, shown[shown.len() - 1].x)
        };
        assert_eq!(range(101, 40..61), (35.0, 65.0));
        assert_eq!(range(101, 50..51), (48.0, 52.0));
        assert_eq!(range(101, 0..9), (0.0, 10.0));
        assert_eq!([range(101, 92..101), range(12, 5..7)], [(90.0, 100.0), (3.0, 8.0)]);
        assert_eq!([range(31, 0..23), range(11, 5..7)], [(0.0, 27.0), (3.0, 8.0)]);
        // Nothing touches, or everything.
        assert_eq!([range(101, 0..0), range(31, 0..31)], [(0.0, 100.0), (0.0, 30.0)]);
    }

    /// However fine the mesh, the ends of each zone are marked.
    #[test]
    fn markers_do_not_hide_each_other() {
        let places = |n, closed| marked(&points(n, closed)).iter().map(|p| p.node).collect::<Vec<_>>();
        assert_eq!(places(101, 40..61).len(), 101);
        let many = places(10_001, 3_333..6_667);
        assert!((200..210).contains(&many.len()), "{}", many.len());
        assert!([0, 3_332, 3_333, 6_666, 6_667, 10_000].iter().all(|end| many.contains(end)));
    }

    #[test]
    fn a_large_gap_leaves_the_panel() {
        let line = [[0.0, 4.0], [1.0, 2.0], [2.0, 0.0], [3.0, 0.0], [4.0, 6.0]];
        assert_eq!(below(&line, 3.0), [vec![[0.5, 3.0], [1.0, 2.0], [2.0, 0.0], [3.0, 0.0], [3.5, 3.0]]]);
        assert_eq!(below(&line, 6.0), [line.to_vec()]);
        assert_eq!(below(&line[..2], 3.0), [vec![[0.5, 3.0], [1.0, 2.0]]]);
    }

    #[test]
    fn lengths_have_a_prefix_that_suits_them() {
        let si = UnitSystem::si(2);
        let named = |length| small_lengths(length, &si).1;
        assert_eq!([2.0, 0.5, 3e-5, 1e-8, 0.0].map(named), ["m", "mm", "µm", "nm", "µm"]);
    }
}
