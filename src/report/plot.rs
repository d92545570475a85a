//! Contact stresses along contact lines.

use super::chart::{Axis, Chart, Curve, Panel, Scale};
use super::contact_line::{ContactLine, ContactPoint};
use super::svg::{Dash, Line, Marker, PlotError};
use crate::contact::ContactStatus;

const NORMAL: [u8; 3] = [31, 90, 160];
const TANGENTIAL: [u8; 3] = [190, 70, 10];
const BOUND: [u8; 3] = [110, 110, 110];
const BLACK: [u8; 3] = [0, 0, 0];

/// The contact stresses along a contact line as an SVG picture, see [`stress_chart`].
///
/// # Errors
/// When a stress is not finite.
pub fn contact_stresses(line: &ContactLine, title: &str) -> Result<String, PlotError> {
    let boundary = line.boundary.as_ref().map_or(String::new(), |name| format!("boundary {name}, "));
    let subtitle = format!("contact stresses, {boundary}t = {} s", line.time);
    stress_chart(title.into(), subtitle, 1, &[(String::new(), line)]).to_svg()
}

/// A panel for each contact line under its heading: `σ_n` and `σ_t` in MPa, the friction bound
/// `±μ σ_n`, and on `σ_t` the status of each node: filled for stick, hollow for slip, none for open.
pub fn stress_chart(title: String, subtitle: String, columns: usize, lines: &[(String, &ContactLine)]) -> Chart {
    // Contact lines are mostly level: then x says more than the distance along the line.
    let level = |line: &ContactLine| line.points.windows(2).all(|pair| pair[1].x > pair[0].x && pair[1].y == pair[0].y);
    let (abscissa, label): (fn(&ContactPoint) -> f64, _) = if lines.iter().all(|(_, line)| level(line)) {
        (|p| p.x, "x, m")
    } else {
        (|p| p.s, "distance along the contact line, m")
    };
    Chart {
        title,
        subtitle,
        x: Axis { label: label.into(), scale: Scale::Linear },
        y: Axis { label: "contact stress, MPa".into(), scale: Scale::Linear },
        columns,
        panels: lines
            .iter()
            .map(|(heading, line)| Panel { title: heading.clone(), curves: curves(&line.points, abscissa) })
            .collect(),
    }
}

fn curves(points: &[ContactPoint], abscissa: fn(&ContactPoint) -> f64) -> Vec<Curve> {
    let stress = |label: &str, dash, width, colour, ordinate: fn(&ContactPoint) -> f64| Curve {
        label: label.into(),
        points: points.iter().map(|p| [abscissa(p), 1e-6 * ordinate(p)]).collect(),
        line: Some(Line { dash, width }),
        marker: None,
        colour,
    };
    let nodes = |status, marker| Curve {
        label: String::new(),
        points: points.iter().filter(|p| p.status == status).map(|p| [abscissa(p), 1e-6 * p.sigma_t]).collect(),
        line: None,
        marker: Some(marker),
        colour: TANGENTIAL,
    };
    // Samples for the legend only: what a marker means holds for any colour.
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
