//! The chart of a study: the value against the element size, with the extrapolated value and its band.

use super::Convergence;
use super::steps::Step;
use stickslip_output::{Axis, Chart, Curve, Dash, Line, Panel, Scale, told_apart};

const GREY: [u8; 3] = [120, 120, 120];

impl Convergence {
    /// Returns the chart.
    pub fn chart(&self) -> Chart {
        let quantity = self.sought.quantity();
        let units = self.units_for_people();
        let value = |x: f64| units.of_si(quantity, x);
        let unit = units.name(quantity);
        let finest = self.steps.iter().map(size).fold(f64::INFINITY, f64::min);
        let coarsest = self.steps.iter().map(size).fold(0.0, f64::max);
        let mut levels: Vec<usize> = self.steps.iter().map(|step| step.run.increments).collect();
        levels.sort_unstable();
        levels.dedup();
        let follows_path = levels.len() > 1;
        let mut curves: Vec<Curve> = Vec::new();
        for (k, increments) in levels.into_iter().enumerate() {
            let of_level = self.steps.iter().filter(|step| step.run.increments == increments);
            let points = of_level.filter_map(|step| Some([size(step) / finest, value(step.run.value?)])).collect();
            let (colour, marker) = told_apart(k);
            let label = if follows_path { format!("{increments} increments") } else { "runs".to_string() };
            let line = Some(Line { dash: Dash::Solid, width: 1.8 });
            curves.push(Curve { label, points, line, marker: Some(marker), colour });
        }
        if let (Some(errors), true) = (&self.errors, self.has_limit()) {
            let across = |y: f64| vec![[0.0, value(y)], [coarsest / finest, value(y)]];
            let level = |label: &str, y: f64, dash| Curve {
                label: label.to_string(),
                points: across(y),
                line: Some(Line { dash, width: 1.4 }),
                marker: None,
                colour: GREY,
            };
            curves.push(level("extrapolated", errors.extrapolated(), Dash::Dashed));
            if let Some(total) = errors.total() {
                for sign in [-1.0, 1.0] {
                    let bound = errors.value * (1.0 + sign * total);
                    curves.push(level("last run ± its uncertainty", bound, Dash::Dotted));
                }
            }
        }
        let label = if unit.is_empty() { self.sought.to_string() } else { format!("{}, {unit}", self.sought) };
        Chart {
            title: self.title.clone(),
            subtitle: self.in_short(),
            x: Axis { label: "element size, relative to the finest mesh".into(), scale: Scale::Linear },
            y: Axis { label, scale: Scale::Linear },
            columns: 1,
            panels: vec![Panel { curves, ..Panel::default() }],
        }
    }
}

fn size(step: &Step) -> f64 {
    (step.run.elements as f64).powf(-1.0 / step.run.dimension.max(1) as f64)
}
