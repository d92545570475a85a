//! `stickslip-studies told`.

use clap::Args;
use miette::IntoDiagnostic;
use stickslip_output::Table;
use stickslip_studies::estimates::EstimateError;
use stickslip_studies::told::{Pair, QUANTITIES, Subject, agrees, subjects};

use super::{Answer, jobs};

#[derive(Args)]
pub(super) struct ToldArgs {
    /// The number of random scenes in the plane, and of those in space, beside the shipped ones and those of some kinds
    #[arg(long, default_value_t = 30)]
    count: u64,
    /// Only scenes whose name contains this text
    #[arg(long, default_value = "")]
    only: String,
    /// Scenes computed at the same time; as many as there are processors
    #[arg(long, value_parser = clap::value_parser!(u16).range(1..=256))]
    jobs: Option<u16>,
}

fn percent(share: f64) -> String {
    format!("{:.2}", 100.0 * share)
}

fn cell(pair: Pair) -> String {
    let [told, truth] = pair.map(|error| error.map_or("-".to_string(), percent));
    let mark = if agrees(pair) == Some(false) { "!" } else { "" };
    format!("{told}/{truth}{mark}")
}

fn median(mut values: Vec<f64>) -> String {
    values.sort_by(f64::total_cmp);
    values.get(values.len() / 2).map_or("-".to_string(), |value| format!("{value:.2}"))
}

pub(super) fn told(args: &ToldArgs) -> miette::Result<Answer> {
    let subjects: Vec<Subject> = subjects(args.count).into_iter().filter(|one| one.name.contains(&args.only)).collect();
    let describe = |one: &Subject| one.name.clone();
    let all = jobs::run(&subjects, jobs::count(args.jobs), describe, |one| match one.pairs() {
        Err(EstimateError::Verdict(verdict)) => Ok(Err(verdict)),
        other => other.map(Ok),
    });
    let all: Vec<Result<[Pair; 7], String>> = all.into_diagnostic()?;
    let mut table = Table::new(&[&["told/true, %"][..], &QUANTITIES.map(|quantity| quantity.0)].concat());
    let mut failed = Vec::new();
    for (one, pairs) in subjects.iter().zip(&all) {
        match pairs {
            Ok(pairs) => table.push([vec![one.name.clone()], pairs.map(cell).to_vec()].concat()),
            Err(verdict) => failed.push(format!("left out: {verdict}")),
        }
    }
    let mut summary =
        Table::new(&["error of", "told", "within 3", "share", "too large", "median", "not told", "above 5 %"]);
    for (k, (name, by_steps)) in QUANTITIES.into_iter().enumerate() {
        let pairs: Vec<Pair> = all.iter().flatten().map(|pairs| pairs[k]).filter(|pair| pair[1].is_some()).collect();
        let judged: Vec<bool> = pairs.iter().filter_map(|pair| agrees(*pair)).collect();
        let hits = judged.iter().filter(|hit| **hit).count();
        let ratios: Vec<f64> = (pairs.iter())
            .filter(|pair| pair.iter().flatten().any(|error| *error > 1e-3))
            .filter_map(|[told, truth]| Some((*told)? / (*truth)?))
            .collect();
        let larger =
            pairs.iter().filter(|[told, truth]| agrees([*told, *truth]) == Some(false) && told > truth).count();
        let silent: Vec<f64> = pairs.iter().filter(|pair| pair[0].is_none()).filter_map(|pair| pair[1]).collect();
        let name = if by_steps { name.to_string() } else { format!("{name}, mesh") };
        let share = format!("{:.0} %", 100.0 * hits as f64 / judged.len().max(1) as f64);
        let above = silent.iter().filter(|truth| **truth > 0.05).count();
        let counts = [judged.len(), hits].map(|count| count.to_string());
        let more = [share, larger.to_string(), median(ratios), silent.len().to_string(), above.to_string()];
        summary.push([vec![name], counts.to_vec(), more.to_vec()].concat());
    }
    Ok(Answer { lines: [vec![table.to_string(), summary.to_string()], failed].concat(), has_passed: true })
}
