//! The paper's figures as charts, tables and words.

use stickslip::run::report::csv_table;
use stickslip::solver::history::Status;
use stickslip_output::{Axis, Chart, Curve, Dash, Line, Marker, Panel, Scale, stress_chart};

use super::{Descent, Effort, FigureData, MU, Stresses};
use crate::tables::PaperMethod;

/// `ε` of the setting `paper`, where BN and its IP end.
const EPSILON: f64 = 1e-2;
/// After so many iterations *prev* begins again from the safe point.
const PATIENCE: f64 = 30.0;

const BLACK: [u8; 3] = [0, 0, 0];
const BLUE: [u8; 3] = [31, 90, 160];
const RED: [u8; 3] = [190, 70, 10];
const GREY: [u8; 3] = [110, 110, 110];

impl FigureData {
    /// Whether every history converged.
    pub fn converged(&self) -> bool {
        let good = |status: Status| status == Status::Converged;
        match self {
            FigureData::PunchStresses(all) | FigureData::BlockStresses(all) => all.iter().all(|s| good(s.status)),
            FigureData::PunchTheta(all) => all.iter().all(|descent| good(descent.status)),
            FigureData::BlockIterations(all) => all.iter().all(|effort| good(effort.status)),
        }
    }

    /// The picture.
    pub fn chart(&self) -> Chart {
        match self {
            FigureData::PunchStresses(all) => punch_stresses(all),
            FigureData::PunchTheta(all) => punch_theta(all),
            FigureData::BlockStresses(all) => block_stresses(all),
            FigureData::BlockIterations(all) => block_iterations(all),
        }
    }

    /// The numbers as comma-separated values, with units in the heads; stresses in Pa.
    pub fn to_csv(&self) -> String {
        match self {
            FigureData::PunchStresses(all) | FigureData::BlockStresses(all) => {
                let head = ["increments", "time [s]", "x [m]", "sigma_n [Pa]", "sigma_t [Pa]"];
                let rows = all.iter().flat_map(|Stresses { increments, line, .. }| {
                    line.points.iter().map(move |p| {
                        let numbers = [line.time, p.x, p.sigma_n, p.sigma_t];
                        [increments.to_string()].into_iter().chain(numbers.map(|x| x.to_string())).collect()
                    })
                });
                csv_table(&head, rows)
            }
            FigureData::PunchTheta(all) => {
                let head = ["method", "iteration", "theta [N^2 and Pa^2]", "step", "backtracks"];
                let rows = all.iter().flat_map(|Descent { method, iterations, .. }| {
                    iterations.iter().map(|i| {
                        let theta = format!("{:e}", i.theta);
                        [
                            method.title().into(),
                            i.iteration.to_string(),
                            theta,
                            i.step.to_string(),
                            i.backtracks.to_string(),
                        ]
                        .to_vec()
                    })
                });
                csv_table(&head, rows)
            }
            FigureData::BlockIterations(all) => {
                let head = ["method", "increment", "time [s]", "iterations", "backtracks"];
                let rows = all.iter().flat_map(|Effort { method, increments, .. }| {
                    increments.iter().map(|r| {
                        let counts = [r.iterations, r.backtracks].map(|count| count.to_string());
                        [[method.title().into(), r.index.to_string(), r.time.to_string()].to_vec(), counts.to_vec()]
                            .concat()
                    })
                });
                csv_table(&head, rows)
            }
        }
    }

    /// What the picture says, a line for each curve or panel.
    pub fn summary(&self) -> Vec<String> {
        let lines: Vec<(String, Status)> = match self {
            FigureData::PunchStresses(all) | FigureData::BlockStresses(all) => {
                all.iter().map(|stresses| (stresses.summary(), stresses.status)).collect()
            }
            FigureData::PunchTheta(all) => all.iter().map(|descent| (descent.summary(), descent.status)).collect(),
            FigureData::BlockIterations(all) => all.iter().map(|effort| (effort.summary(), effort.status)).collect(),
        };
        let line = |(line, status)| if status == Status::Converged { line } else { format!("{line} ({status})") };
        lines.into_iter().map(line).collect()
    }
}

impl Stresses {
    fn summary(&self) -> String {
        let Stresses { increments, line, .. } = self;
        let mega = |value: f64| 1e-6 * value;
        let [n, t]: [f64; 2] = [line.points.iter().map(|p| p.p_n).sum(), line.points.iter().map(|p| p.p_t).sum()];
        let largest = line.points.iter().map(|p| p.sigma_n).fold(0.0, f64::max);
        format!(
            "inc = {increments}, t = {} s: sum p_n = {:.6} MN, sum p_t = {:.6} MN, largest sigma_n = {:.1} MPa",
            line.time,
            mega(n),
            mega(t),
            mega(largest)
        )
    }
}

impl Descent {
    fn summary(&self) -> String {
        let theta = |record: Option<&super::IterationRecord>| record.map_or(f64::NAN, |record| record.theta);
        format!(
            "{}: Theta from {:.1e} to {:.1e} in {} iterations with {} backtracks",
            self.method.title(),
            theta(self.iterations.first()),
            theta(self.iterations.last()),
            self.iterations.last().map_or(0, |record| record.iteration),
            self.iterations.iter().map(|record| record.backtracks).sum::<usize>()
        )
    }
}

impl Effort {
    fn summary(&self) -> String {
        let counts = || self.increments.iter().map(|record| record.iterations);
        format!(
            "{}: {} to {} iterations, {:.2} on average",
            self.method.title(),
            counts().min().unwrap_or(0),
            counts().max().unwrap_or(0),
            counts().sum::<usize>() as f64 / self.increments.len().max(1) as f64
        )
    }
}

fn number_of_increments(increments: usize) -> String {
    format!("{increments} increment{}", if increments == 1 { "" } else { "s" })
}

/// (a), (b) and so on.
fn letter(k: usize) -> char {
    char::from(b'a' + k as u8)
}

fn punch_stresses(all: &[Stresses]) -> Chart {
    let panels: Vec<_> = (all.iter().enumerate())
        .map(|(k, s)| (format!("({}) {}", letter(k), number_of_increments(s.increments)), &s.line))
        .collect();
    let title = "Figure 4. Punch: contact stresses after full indentation";
    stress_chart(title.into(), format!("μ = {MU}, Algorithm BN"), 2, &panels)
}

fn block_stresses(all: &[Stresses]) -> Chart {
    let paths = ["Q₁ = 10 MN/m", "Q₁ = 0"];
    let panels: Vec<_> = (all.iter().zip(paths).enumerate())
        .map(|(k, (s, path))| (format!("({}) {path}, t = {} s", letter(k), s.line.time), &s.line))
        .collect();
    let size = all.first().map_or(String::new(), |s| {
        format!("{} contact nodes, μ = {MU}, {} a path, ", s.line.points.len(), number_of_increments(s.increments))
    });
    let title = "Figure 6. Elastic block: contact stresses at the ends of both load paths";
    stress_chart(title.into(), format!("{size}Algorithm BN"), 2, &panels)
}

/// A curve of a method: BN and the paper's IP with the lines of the paper's figure.
fn curve(method: PaperMethod, dash: Dash, points: Vec<[f64; 2]>) -> Curve {
    let (marker, colour) = match method {
        PaperMethod::Bn | PaperMethod::BnDefault => (Marker::Disc, BLACK),
        PaperMethod::IpSafe => (Marker::Square, BLUE),
        PaperMethod::IpPrev | PaperMethod::Ip => (Marker::Triangle, RED),
    };
    let label = method.title().into();
    Curve { label, points, line: Some(Line { dash, width: 1.8 }), marker: Some(marker), colour }
}

/// A level line across the points of other curves.
fn level(label: &str, value: f64, curves: &[Curve]) -> Curve {
    let x = || curves.iter().flat_map(|curve| &curve.points).map(|point| point[0]);
    let ends = [x().fold(f64::INFINITY, f64::min), x().fold(f64::NEG_INFINITY, f64::max)];
    Curve {
        label: label.into(),
        points: ends.map(|x| [x, value]).into(),
        line: Some(Line { dash: Dash::Dashed, width: 1.0 }),
        marker: None,
        colour: GREY,
    }
}

fn single(mut curves: Vec<Curve>, level: Curve) -> Vec<Panel> {
    curves.push(level);
    vec![Panel { curves, ..Panel::default() }]
}

fn punch_theta(all: &[Descent]) -> Chart {
    let of = |descent: &Descent| {
        let dash = match descent.method {
            PaperMethod::Bn | PaperMethod::BnDefault => Dash::Dotted,
            PaperMethod::IpSafe | PaperMethod::IpPrev => Dash::Solid,
            PaperMethod::Ip => Dash::DashDotted,
        };
        let points = descent.iterations.iter().map(|record| [record.iteration as f64, record.theta]).collect();
        // In the first increment the paper's IP has one starting point only.
        let label = if descent.method == PaperMethod::IpSafe { "IP" } else { descent.method.title() };
        Curve { label: label.into(), ..curve(descent.method, dash, points) }
    };
    let curves: Vec<Curve> = all.iter().map(of).collect();
    let epsilon = level("ε = 10⁻²", EPSILON, &curves);
    Chart {
        title: "Figure 5. Punch: error norm over the iterations".into(),
        subtitle: format!("μ = {MU}, 1 increment"),
        x: Axis { label: "iteration".into(), scale: Scale::Integers },
        y: Axis { label: "error norm Θ (rows in N and Pa)".into(), scale: Scale::Decades },
        columns: 1,
        panels: single(curves, epsilon),
    }
}

fn block_iterations(all: &[Effort]) -> Chart {
    let of = |effort: &Effort| {
        let dash = match effort.method {
            PaperMethod::Bn | PaperMethod::BnDefault => Dash::Solid,
            PaperMethod::IpSafe => Dash::DashDotted,
            PaperMethod::IpPrev | PaperMethod::Ip => Dash::Dotted,
        };
        let points = effort.increments.iter().map(|record| [record.index as f64, record.iterations as f64]).collect();
        curve(effort.method, dash, points)
    };
    let curves: Vec<Curve> = all.iter().map(of).collect();
    let size = all.iter().find_map(|effort| {
        let record = effort.increments.first()?;
        Some((record.contact.open + record.contact.stick + record.contact.slip, effort.increments.len() / 2))
    });
    let (contacts, path) = size.unwrap_or_default();
    let patience = level("30: IP prev begins again", PATIENCE, &curves);
    Chart {
        title: "Figure 7. Elastic block: iterations of each increment".into(),
        subtitle: format!("{contacts} contact nodes, μ = {MU}, {} a path", number_of_increments(path)),
        x: Axis {
            label: format!("increment (1 to {path}: Q₁ grows; {} to {}: Q₁ falls)", path + 1, 2 * path),
            scale: Scale::Integers,
        },
        y: Axis { label: "iterations".into(), scale: Scale::Linear },
        columns: 1,
        panels: single(curves, patience),
    }
}
