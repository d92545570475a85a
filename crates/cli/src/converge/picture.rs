//! The chart of a study: the value against the element size, with the extrapolated value and its band.

use super::Convergence;
use super::steps::Step;
use crate::study::curve;
use stickslip_output::{Axis, Chart, Curve, Dash, Line, Panel, Scale};

const GREY: [u8; 3] = [120, 120, 120];

impl Convergence {
    /// Returns the chart.
    pub fn chart(&self) -> Chart {
        let quantity = self.sought.quantity();
        let units = self.units_for_people();
        let value = |x: f64| units.of_si(quantity, x);
        let finest = self.result.steps.iter().map(size).fold(f64::INFINITY, f64::min);
        let coarsest = self.result.steps.iter().map(size).fold(0.0, f64::max);
        let mut levels: Vec<usize> = self.result.steps.iter().map(|step| step.increments).collect();
        levels.sort_unstable();
        levels.dedup();
        let follows_path = levels.len() > 1;
        let of_level = |(k, increments): (usize, usize)| {
            let of_level = self.result.steps.iter().filter(|step| step.increments == increments);
            let points = of_level.filter_map(|step| Some([size(step) / finest, value(step.value?)])).collect();
            curve(k, if follows_path { format!("{increments} increments") } else { "runs".to_string() }, points)
        };
        let mut curves: Vec<Curve> = levels.into_iter().enumerate().map(of_level).collect();
        if let (Some(errors), true) = (&self.result.errors, self.has_limit()) {
            let level = |label: &str, y: f64, dash| Curve {
                label: label.to_string(),
                points: vec![[0.0, value(y)], [coarsest / finest, value(y)]],
                line: Some(Line { dash, width: 1.4 }),
                marker: None,
                colour: GREY,
            };
            curves.push(level("extrapolated", errors.extrapolated(), Dash::Dashed));
            let bounds = errors.total().map(|total| [-total, total].map(|share| errors.value * (1.0 + share)));
            let bounds = bounds.into_iter().flatten();
            curves.extend(bounds.map(|bound| level("last run ± its uncertainty", bound, Dash::Dotted)));
        }
        Chart {
            title: self.last.title.clone(),
            subtitle: self.in_short(),
            x: Axis { label: "element size, relative to the finest mesh".into(), scale: Scale::Linear },
            y: Axis { label: self.head(), scale: Scale::Linear },
            columns: 1,
            panels: vec![Panel { curves, ..Panel::default() }],
        }
    }
}

fn size(step: &Step) -> f64 {
    (step.elements as f64).powf(-1.0 / step.dimension.max(1) as f64)
}
