//! Charts of a sweep: a quantity, usually the largest contact pressure, over the key that varies first.

use super::table::{Row, Sweep};
use stickslip_output::{Axis, Chart, Curve, Dash, Line, Marker, Panel, Scale, told_apart};

const DASHES: [Dash; 4] = [Dash::Solid, Dash::Dashed, Dash::Dotted, Dash::DashDotted];

/// More curves than this cannot be distinguished. Beyond it, only points are drawn.
const MAX_CURVES: usize = 16;

impl Sweep {
    /// Plots [`Sweep::plotted`] of each converged variant; without it the largest contact pressure, or the iterations if
    /// nothing touches. The abscissa is the first key whose values are all numbers, with a curve for each combination of
    /// the other keys. Without such a key, it is the position in the list of the first key's values.
    pub fn chart(&self) -> Chart {
        let is_number = |value: &String| value.parse().is_ok_and(f64::is_finite);
        let numeric = self.varied.iter().position(|variation| variation.values.iter().all(is_number));
        let along = numeric.unwrap_or(0);
        let key = self.varied.get(along).map_or("", |variation| &variation.key);
        let x = match numeric {
            Some(_) => Axis { label: key.to_string(), scale: Scale::Linear },
            None => Axis { label: format!("{key}, by the place in the list"), scale: Scale::Integers },
        };
        let in_list = |value: &String| self.varied.get(along)?.values.iter().position(|other| other == value);
        let place = |row: &Row| {
            let value = row.values.get(along)?;
            if numeric.is_some() { value.parse().ok() } else { Some((in_list(value)? + 1) as f64) }
        };
        let pressed = self.variants.iter().any(|row| row.outcome.largest_pressure.is_some());
        let height = |row: &Row| match (&self.plotted, &row.outcome.largest_pressure) {
            (Some(quantity), _) => row.outcome.number(quantity).map(|x| self.in_pictures(quantity, x)),
            (None, Some(largest)) => largest.pressure.map(|pressure| self.pressure(pressure)),
            (None, None) if pressed => Some(0.0),
            (None, None) => Some(row.outcome.iterations as f64),
        };
        let label = match &self.plotted {
            Some(quantity) => self.label(quantity),
            None if pressed => format!("largest contact pressure, {}", self.pressure_unit()),
            None => "iterations".to_string(),
        };
        let mut curves: Vec<(String, Vec<[f64; 2]>)> = Vec::new();
        let converged = || self.variants.iter().filter(|row| row.outcome.is_converged());
        for row in converged() {
            let (Some(x), Some(y)) = (place(row), height(row)) else { continue };
            let others = self.varied.iter().zip(&row.values).enumerate().filter(|(k, _)| *k != along);
            let label: Vec<String> =
                others.map(|(_, (variation, value))| format!("{} = {value}", variation.key)).collect();
            let (label, point) = (label.join(", "), [x, y]);
            match curves.iter_mut().find(|(other, _)| *other == label) {
                Some((_, points)) => points.push(point),
                None => curves.push((label, vec![point])),
            }
        }
        let drawn: usize = curves.iter().map(|(_, points)| points.len()).sum();
        let tell_apart = curves.len() <= MAX_CURVES;
        let curve = |(k, (label, mut points)): (usize, (String, Vec<[f64; 2]>))| {
            points.sort_by(|a, b| a[0].total_cmp(&b[0]));
            let line = Line { dash: DASHES[k / 4 % 4], width: 1.8 };
            let (colour, marker) = told_apart(k);
            Curve {
                label: if tell_apart { label } else { String::new() },
                points,
                line: tell_apart.then_some(line),
                marker: Some(if tell_apart { marker } else { Marker::Circle }),
                colour,
            }
        };
        let left_out = |missing: usize, why: &str| match missing {
            0 => String::new(),
            missing => format!(", {missing} {why} left out"),
        };
        let left_out = [
            left_out(self.variants.len() - converged().count(), "that did not converge"),
            left_out(converged().count() - drawn, "without a value"),
        ];
        Chart {
            title: self.title.clone(),
            subtitle: format!("{drawn} variants{}", left_out.concat()),
            x,
            y: Axis { label, scale: Scale::Linear },
            columns: 1,
            panels: vec![Panel { curves: curves.into_iter().enumerate().map(curve).collect(), ..Panel::default() }],
        }
    }
}
