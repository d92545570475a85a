//! Plots of contact stresses along contact lines.

use super::chart::{Axis, Chart, Curve, Panel, Scale};
use super::svg::{Dash, Line, Marker, PlotError};
use stickslip::base::{Quantity, UnitSystem};
use stickslip::run::report::{ContactLine, ContactPoint};
use stickslip::solver::ContactStatus;

const NORMAL: [u8; 3] = [31, 90, 160];
const TANGENTIAL: [u8; 3] = [190, 70, 10];
const BOUND: [u8; 3] = [110, 110, 110];
const BLACK: [u8; 3] = [0, 0, 0];

/// Draws the contact stresses along a contact line as an SVG picture, see [`stress_chart`].
///
/// # Errors
/// When a stress is not finite.
pub fn contact_stresses(line: &ContactLine, title: &str) -> Result<String, PlotError> {
    let boundary = line.boundary.as_ref().map_or(String::new(), |name| format!("boundary {name}, "));
    let subtitle = format!("contact stresses, {boundary}t = {} s", line.time);
    stress_chart(title.into(), subtitle, 1, &[(String::new(), line)]).to_svg()
}

/// Creates a panel for each contact line under its heading: `σ_n` and `σ_t`, the friction bound `±μ σ_n`, and on `σ_t`
/// the status of each node: filled for stick, hollow for slip, no marker for open. If only a small part of a line
/// touches, only that part is shown.
pub fn stress_chart(title: String, subtitle: String, columns: usize, lines: &[(String, &ContactLine)]) -> Chart {
    // Contact lines are mostly level. Then x is clearer than the distance along the line.
    let level = |line: &ContactLine| line.points.windows(2).all(|pair| pair[1].x > pair[0].x && pair[1].y == pair[0].y);
    let (abscissa, label): (fn(&ContactPoint) -> f64, _) = if lines.iter().all(|(_, line)| level(line)) {
        (|p| p.x, "x")
    } else {
        (|p| p.s, "distance along the contact line")
    };
    let units = lines.first().map_or(UnitSystem::si(2), |(_, line)| line.units).of_pictures();
    let axis =
        |label: &str, quantity| Axis { label: format!("{label}, {}", units.name(quantity)), scale: Scale::Linear };
    Chart {
        title,
        subtitle,
        x: axis(label, Quantity::Length),
        y: axis("contact stress", Quantity::Stress),
        columns,
        panels: lines
            .iter()
            .map(|(heading, line)| Panel {
                title: heading.clone(),
                curves: curves(shown(&line.points), abscissa, &units),
            })
            .collect(),
    }
}

/// Returns the points to show: those in contact and half as many around them, at least two on either side, if these are
/// at most half of the line; otherwise all points.
fn shown(points: &[ContactPoint]) -> &[ContactPoint] {
    let touches = |p: &ContactPoint| p.status != ContactStatus::Open;
    let (Some(first), Some(last)) = (points.iter().position(touches), points.iter().rposition(touches)) else {
        return points;
    };
    let (low, high) = (points[first].s, points[last].s);
    let margin = 0.25 * (high - low);
    let from = points.partition_point(|p| p.s < low - margin).min(first.saturating_sub(2));
    let to = points.partition_point(|p| p.s <= high + margin).max(last + 3).min(points.len());
    if 2 * (to - from) <= points.len() { &points[from..to] } else { points }
}

fn curves(points: &[ContactPoint], abscissa: fn(&ContactPoint) -> f64, units: &UnitSystem) -> Vec<Curve> {
    let told = |x: f64, y: f64| [units.of_si(Quantity::Length, x), units.of_si(Quantity::Stress, y)];
    let stress = |label: &str, dash, width, colour, ordinate: fn(&ContactPoint) -> f64| Curve {
        label: label.into(),
        points: points.iter().map(|p| told(abscissa(p), ordinate(p))).collect(),
        line: Some(Line { dash, width }),
        marker: None,
        colour,
    };
    let nodes = |status, marker| Curve {
        label: String::new(),
        points: points.iter().filter(|p| p.status == status).map(|p| told(abscissa(p), p.sigma_t)).collect(),
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
        stress("σₜ, tangential", Dash::Solid, 1.8, TANGENTIAL, |p| p.sigma_t),
        stress("±μ σₙ", Dash::Dashed, 1.0, BOUND, |p| p.mu * p.sigma_n),
        stress("±μ σₙ", Dash::Dashed, 1.0, BOUND, |p| -p.mu * p.sigma_n),
        sample("stick", Marker::Disc),
        sample("slip", Marker::Circle),
    ]
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
        // Nothing touches, or at least half of the line.
        assert_eq!([range(101, 0..0), range(31, 0..23), range(11, 5..7)], [(0.0, 100.0), (0.0, 30.0), (0.0, 10.0)]);
    }
}
