//! Charts of a sweep: a quantity, usually the largest contact pressure, over the key that varies first.

use super::table::{PEAK, Row, Sweep};
use crate::study::{curve, grouped, scene_words};
use stickslip_output::{Axis, Chart, Curve, Marker, Panel, Scale};

/// More curves than this cannot be distinguished. Beyond it, only points are drawn.
const MAX_CURVES: usize = 16;

impl Sweep {
    /// Plots [`Sweep::plotted`] of each variant that converged, or slips and is marked; without it the largest contact
    /// pressure, or the iterations if nothing touches. The abscissa is the first key whose values are all numbers, with
    /// a curve for each combination of the other keys. Without such a key, it is the position in the list of the first
    /// key's values.
    pub fn chart(&self) -> Chart {
        // A list of one number is a number.
        let number = |value: &String| {
            let inside = value.strip_prefix('[').and_then(|rest| rest.strip_suffix(']'));
            inside.unwrap_or(value).trim().parse().ok().filter(|x: &f64| x.is_finite())
        };
        let numeric =
            self.varied.iter().position(|variation| variation.values.iter().all(|value| number(value).is_some()));
        let along = numeric.unwrap_or(0);
        let key = self.varied.get(along).map_or(String::new(), |variation| self.label(&variation.key));
        let x = match numeric {
            Some(_) => Axis { label: key, scale: Scale::Linear },
            None => Axis { label: format!("{key}, by the place in the list"), scale: Scale::Integers },
        };
        let in_list = |value: &String| self.varied.get(along)?.values.iter().position(|other| other == value);
        let position = |row: &Row| {
            let value = row.values.get(along)?;
            if numeric.is_some() { number(value) } else { Some((in_list(value)? + 1) as f64) }
        };
        let pressed = self.variants.iter().any(|row| !row.outcome.values["largest_pressure"].is_null());
        let quantity = self.plotted.clone().or_else(|| PEAK.parse().ok().filter(|_| pressed));
        let height = |row: &Row| match &quantity {
            Some(plotted) if self.plotted.is_some() => self.in_pictures(plotted, row.outcome.value(plotted)),
            Some(peak) => self.in_pictures(peak, &row.outcome.values["largest_pressure"]["pressure"]).or(Some(0.0)),
            None => row.outcome.values["iterations"].as_f64(),
        };
        let label = quantity.as_ref().map_or("iterations".to_string(), |quantity| {
            let of = if self.plotted.is_some() { "" } else { "largest contact " };
            format!("{of}{}", quantity.head(self.units))
        });
        // Values are those of the scene also if the body slips as a whole.
        let usable: Vec<&Row> =
            self.variants.iter().filter(|row| row.outcome.is_converged() || row.outcome.status == "slips").collect();
        let point = |row: &&Row| {
            let others = self.varied.iter().zip(&row.values).enumerate().filter(|(k, _)| *k != along);
            let of = others.map(|(_, (variation, value))| {
                let (words, unit) = scene_words(&variation.key, &self.units);
                format!("{words} = {value} {unit}").trim_end().to_string()
            });
            Some((of.collect::<Vec<_>>().join(", "), [position(row)?, height(row)?]))
        };
        let mut curves = grouped(usable.iter().filter_map(point));
        let tell_apart = curves.len() <= MAX_CURVES;
        for curve in &mut curves {
            curve.points.sort_by(|a, b| a[0].total_cmp(&b[0]));
            if !tell_apart {
                (curve.label, curve.line, curve.marker) = (String::new(), None, Some(Marker::Circle));
            }
        }
        let slips = |row: &&&Row| !row.outcome.is_converged();
        let slipped: Vec<_> = usable.iter().filter(slips).filter_map(point).map(|(_, point)| point).collect();
        let drawn: usize = curves.iter().map(|curve| curve.points.len()).sum();
        let left_out =
            [(self.variants.len(), usable.len(), "that did not converge"), (usable.len(), drawn, "without a value")];
        let left_out = left_out.into_iter().filter(|(of, kept, _)| of > kept);
        let left_out = left_out.map(|(of, kept, why)| format!(", {} {why} left out", of - kept));
        let left_out = left_out.collect::<Vec<_>>().concat();
        if !slipped.is_empty() {
            let curve = curve(0, "slips: the run ended early".to_string(), slipped);
            curves.insert(0, Curve { line: None, marker: Some(Marker::Square), ..curve });
        }
        Chart {
            title: self.title.clone(),
            subtitle: format!("{drawn} variants{left_out}"),
            x,
            y: Axis { label, scale: Scale::Linear },
            columns: 1,
            panels: vec![Panel { curves, ..Panel::default() }],
        }
    }
}
