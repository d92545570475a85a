//! `stickslip-studies elements`.

use std::path::PathBuf;

use clap::Args;
use miette::{IntoDiagnostic, miette};
use stickslip::run::report::csv_table;
use stickslip_output::{Axis, Chart, Curve, Dash, Line, Panel, Scale, Table, curve_style};
use stickslip_studies::elements::{Point, Problem};

use super::{Answer, jobs, write};

#[derive(Args)]
pub(super) struct ElementsArgs {
    /// Write the pictures (SVG) and their numbers (CSV) into this folder
    #[arg(long, value_name = "DIR", default_value = "results/elements")]
    out: PathBuf,
    /// Only these problems
    #[arg(long, value_name = "NAMES", value_delimiter = ',')]
    only: Vec<String>,
    /// Only so many sizes of each kind of elements, from the coarsest on
    #[arg(long, value_name = "NUMBER", default_value_t = usize::MAX, hide_default_value = true)]
    sizes: usize,
}

/// Problems are solved one after the other, so that none takes time from another.
pub(super) fn elements(args: &ElementsArgs) -> miette::Result<Answer> {
    let known = |name: &String| Problem::ALL.iter().any(|problem| problem.name() == name);
    if let Some(name) = args.only.iter().find(|name| !known(name)) {
        let names = Problem::ALL.map(Problem::name).join(", ");
        return Err(miette!(help = format!("there are {names}"), "no problem is called `{name}`"));
    }
    let wanted = |problem: &Problem| args.only.is_empty() || args.only.iter().any(|name| name == problem.name());
    let problems: Vec<Problem> = Problem::ALL.into_iter().filter(wanted).collect();
    // Before the work: a folder that cannot be made should not cost minutes.
    write(&args.out, &[])?;
    let sizes = |problem: Problem, elements| problem.sizes(elements).into_iter().take(args.sizes);
    let all =
        |problem: &Problem| problem.elements().into_iter().map(|kind| sizes(*problem, kind).count()).sum::<usize>();
    let bar = jobs::bar(problems.iter().map(all).sum());
    let mut answer = Answer { lines: Vec::new(), has_passed: true };
    for problem in problems {
        let mut points = Vec::new();
        for elements in problem.elements() {
            for n in sizes(problem, elements) {
                bar.set_message(format!("{}, {elements}, n = {n}", problem.name()));
                points.push(problem.solve(elements, n).map_err(|error| miette!("{}: {error}", problem.name()))?);
                bar.inc(1);
            }
        }
        answer.has_passed &= points.iter().all(|point| point.value.is_finite());
        let chart = |of: Against| chart(problem, &points, of).to_svg().into_diagnostic();
        let name = |end: &str| format!("{}{end}", problem.name());
        let files = [
            (name("-unknowns.svg"), chart(Against::Unknowns)?),
            (name("-time.svg"), chart(Against::Time)?),
            (name(".csv"), csv(&points)),
        ];
        write(&args.out, &files)?;
        answer.lines.push(format!("{}; {} {:e}", problem.title(), problem.quantity(), problem.exact()));
        answer.lines.push(table(&points).to_string());
    }
    bar.finish_and_clear();
    answer.lines.push(format!("written to   {}", args.out.display()));
    Ok(answer)
}

fn table(points: &[Point]) -> Table {
    let mut table = Table::new(&["elements", "n", "unknowns", "CPU, s", "value", "error", "locking", "energy norm"]);
    let share = |share: Option<f64>| share.map_or("-".to_string(), |share| format!("{share:.1e}"));
    for point in points {
        table.push(vec![
            point.elements.to_string(),
            point.n.to_string(),
            point.unknowns.to_string(),
            format!("{:.3}", point.seconds),
            format!("{:.6e}", point.value),
            format!("{:.1e}", point.error),
            share(point.locking),
            share(point.discretisation),
        ]);
    }
    table
}

fn csv(points: &[Point]) -> String {
    let heads =
        ["elements", "n", "unknowns", "cpu_seconds", "value", "error", "estimated_locking", "estimated_energy_norm"];
    let share = |share: Option<f64>| share.map_or(String::new(), |share| format!("{share:.4e}"));
    let row = |point: &Point| {
        vec![
            point.elements.to_string(),
            point.n.to_string(),
            point.unknowns.to_string(),
            format!("{:.6}", point.seconds),
            format!("{:.10e}", point.value),
            format!("{:.4e}", point.error),
            share(point.locking),
            share(point.discretisation),
        ]
    };
    csv_table(&heads, points.iter().map(row))
}

/// What an error is drawn against.
#[derive(Clone, Copy)]
enum Against {
    Unknowns,
    Time,
}

fn chart(problem: Problem, points: &[Point], against: Against) -> Chart {
    let (label, x): (_, fn(&Point) -> f64) = match against {
        Against::Unknowns => ("unknowns", |point| point.unknowns as f64),
        Against::Time => ("CPU time, s", |point| point.seconds),
    };
    let curve = |(k, elements)| {
        let (colour, marker) = curve_style(k);
        Curve {
            label: format!("{elements}"),
            points: points
                .iter()
                .filter(|point| point.elements == elements)
                .map(|point| [x(point), point.error])
                .collect(),
            line: Some(Line { dash: Dash::Solid, width: 1.8 }),
            marker: Some(marker),
            colour,
        }
    };
    Chart {
        title: problem.title().into(),
        subtitle: format!("error of the {}", problem.quantity()),
        x: Axis { label: label.into(), scale: Scale::Decades },
        y: Axis { label: "relative error".into(), scale: Scale::Decades },
        columns: 1,
        panels: vec![Panel {
            curves: problem.elements().into_iter().enumerate().map(curve).collect(),
            ..Panel::default()
        }],
    }
}
