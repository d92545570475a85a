//! Performance profiles: the share of problems that a solver solves within a multiple of the best time.
//!
//! E. D. Dolan, J. J. Moré: Benchmarking optimization software with performance profiles, Math. Program. 91 (2002), 201–213. With
//! `t_ps`, the time that solver `s` takes for problem `p`, infinite where it does not solve it,
//!
//! ```text
//! ρ_s(τ) = share of the problems with t_ps ≤ τ min_s t_ps
//! ```
//!
//! A single solver has no competitor. Its profile shows the share of problems against the time itself.

use std::collections::BTreeMap;

use crate::study::{DASHES, curve};
use stickslip::run::report::{csv_number, csv_table};
use stickslip_output::{Axis, Chart, Curve, Line, Panel, Scale};

/// The smallest time that can be measured reliably, s.
const LEAST: f64 = 1e-4;

/// The times of solvers on problems.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Profile {
    solvers: Vec<String>,
    /// The time (s) by problem, then by solver; `None` if not solved.
    times: BTreeMap<String, Vec<Option<f64>>>,
}

impl Profile {
    /// Adds the time of `solver` for `problem`, s; `None` if not solved.
    pub fn add(&mut self, solver: &str, problem: &str, seconds: Option<f64>) {
        let index = self.solvers.iter().position(|known| known == solver).unwrap_or_else(|| {
            self.solvers.push(solver.to_string());
            self.solvers.len() - 1
        });
        let times = self.times.entry(problem.to_string()).or_default();
        times.resize(times.len().max(index + 1), None);
        times[index] = seconds.map(|seconds| seconds.max(LEAST));
    }

    /// Returns for each solver the points `[τ, ρ(τ)]` at which its share increases, from τ = 1 on.
    pub fn curves(&self) -> Vec<(&str, Vec<[f64; 2]>)> {
        let all = self.times.len().max(1) as f64;
        let is_single = self.solvers.len() < 2;
        let points = |index: usize| {
            let ratio = |times: &Vec<Option<f64>>| {
                let own = times.get(index).copied().flatten()?;
                let best = times.iter().flatten().copied().fold(f64::INFINITY, f64::min);
                Some(if is_single { own } else { own / best })
            };
            let mut ratios: Vec<f64> = self.times.values().filter_map(ratio).collect();
            ratios.sort_by(f64::total_cmp);
            ratios.iter().enumerate().map(|(k, ratio)| [*ratio, (k + 1) as f64 / all]).collect()
        };
        self.solvers.iter().enumerate().map(|(place, solver)| (solver.as_str(), points(place))).collect()
    }

    fn abscissa(&self) -> &'static str {
        if self.solvers.len() < 2 { "CPU time, s" } else { "CPU time over that of the fastest" }
    }

    /// Formats the curves as CSV, a line for each step.
    pub fn to_csv(&self) -> String {
        let header = ["solver", if self.solvers.len() < 2 { "cpu_seconds" } else { "ratio" }, "share"];
        let curves = self.curves();
        let rows = curves.iter().flat_map(|(solver, points)| {
            points.iter().map(move |[x, y]| vec![(*solver).to_string(), csv_number(*x), csv_number(*y)])
        });
        csv_table(&header, rows)
    }

    /// Draws the curves as steps in a chart.
    pub fn chart(&self, title: &str) -> Chart {
        let curves = self.curves();
        let ends = curves.iter().flat_map(|(_, points)| points).map(|point| point[0]);
        let (first, last) = ends.fold((f64::INFINITY, 0.0_f64), |(a, b), x| (a.min(x), b.max(x)));
        let drawn = |(k, (solver, points)): (usize, &(&str, Vec<[f64; 2]>))| {
            let mut steps = vec![[first, 0.0]];
            for &[x, y] in points {
                let before = steps[steps.len() - 1][1];
                steps.extend([[x, before], [x, y]]);
            }
            let top = steps[steps.len() - 1][1];
            steps.push([last, top]);
            let steps = steps.into_iter().filter(|point| point.iter().all(|x| x.is_finite())).collect();
            let line = Some(Line { dash: DASHES[k % DASHES.len()], width: 1.8 });
            Curve { line, marker: None, ..curve(k, format!("{solver} ({})", points.len()), steps) }
        };
        Chart {
            title: title.to_string(),
            subtitle: format!("{} problems; in brackets those that are solved", self.times.len()),
            x: Axis { label: self.abscissa().to_string(), scale: Scale::Decades },
            y: Axis { label: "share of problems solved".to_string(), scale: Scale::Linear },
            columns: 1,
            panels: vec![Panel { curves: curves.iter().enumerate().map(drawn).collect(), ..Panel::default() }],
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn shares_grow_with_the_ratio() {
        let mut profile = Profile::default();
        for (solver, problem, seconds) in
            [("a", "p", Some(1.0)), ("b", "p", Some(4.0)), ("a", "q", None), ("b", "q", Some(2.0)), ("b", "r", None)]
        {
            profile.add(solver, problem, seconds);
        }
        let third = 1.0 / 3.0;
        assert_eq!(profile.curves(), [("a", vec![[1.0, third]]), ("b", vec![[1.0, third], [4.0, 2.0 * third]])]);
        assert!(profile.to_csv().starts_with("solver,ratio,share\na,1,0.33"));
        assert!(profile.chart("three").to_svg().is_ok_and(|svg| svg.contains("fastest")));
    }

    #[test]
    fn one_solver_alone_has_times() {
        let mut profile = Profile::default();
        profile.add("a", "p", Some(0.5));
        profile.add("a", "q", None);
        assert_eq!(profile.curves(), [("a", vec![[0.5, 0.5]])]);
        assert!(profile.to_csv().starts_with("solver,cpu_seconds,share\na,0.5,0.5\n"));
    }
}
