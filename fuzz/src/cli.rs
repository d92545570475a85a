//! `stickslip-fuzz readers|runs`: so many inputs, or so many seconds of them; status 1 if one of them failed.

use std::io::{self, Write};
use std::process::ExitCode;
use std::time::{Duration, Instant};

use clap::builder::PossibleValuesParser;
use clap::{Parser, ValueEnum};
use stickslip_fuzz::pool::{self, Plan, Tally};
use stickslip_fuzz::{readers, runs};

/// Random and broken input for stickslip. Every input follows from target and seed: `--seed S --count 1` repeats and shows one.
#[derive(Debug, Parser)]
#[command(version)]
struct Arguments {
    /// What is tried.
    target: Target,
    /// The only reader that is tried, by its name; all in turn without it.
    #[arg(long, value_parser = PossibleValuesParser::new(readers::ALL.map(|reader| reader.name)))]
    reader: Option<String>,
    /// How many inputs.
    #[arg(long)]
    count: Option<u64>,
    /// How many seconds; ten, unless a count is given.
    #[arg(long)]
    seconds: Option<u64>,
    /// The first seed.
    #[arg(long, default_value_t = 0)]
    seed: u64,
    /// How many side by side.
    #[arg(long, default_value_t = 1)]
    jobs: usize,
}

#[derive(Debug, Clone, Copy, ValueEnum)]
enum Target {
    /// Scenes, overrides, formulas, meshes, tables, surfaces, exchange files, results.
    Readers,
    /// Scenes that are run, and told otherwise.
    Runs,
}

fn line(text: &str) {
    // A closed pipe is no reason to stop.
    let _ = writeln!(io::stdout().lock(), "{text}");
}

fn show(target: Target, reader: Option<&str>, seed: u64) {
    match target {
        Target::Readers => {
            let (reader, bytes) = readers::input_of(reader, seed);
            line(&format!("# {}\n{}", reader.name, String::from_utf8_lossy(&bytes)));
        }
        Target::Runs => line(&runs::text(seed)),
    }
}

/// The tally in a line.
fn summary(tally: &Tally, begun: Instant) -> String {
    let mut kinds: Vec<_> = tally.kinds.iter().collect();
    kinds.sort();
    let kinds: Vec<String> = kinds.into_iter().map(|(kind, count)| format!("{count} {kind}")).collect();
    let (longest, seed) = tally.longest;
    format!(
        "{} inputs in {:.0} s: {}; {} failures; the longest took {:.3} s, seed {seed}",
        tally.done,
        begun.elapsed().as_secs_f64(),
        kinds.join(", "),
        tally.failures.len(),
        longest.as_secs_f64()
    )
}

/// The program.
pub fn run() -> ExitCode {
    let Arguments { target, reader, count, seconds, seed, jobs } = Arguments::parse();
    let time = match (count, seconds) {
        (_, Some(seconds)) => Duration::from_secs(seconds),
        (Some(_), None) => Duration::MAX,
        (None, None) => Duration::from_secs(10),
    };
    let begun = Instant::now();
    pool::keep_panics();
    if count == Some(1) {
        show(target, reader.as_deref(), seed);
    }
    let only = reader.as_deref().map(|name| format!(" --reader {name}")).unwrap_or_default();
    let name = format!("{}{only}", format!("{target:?}").to_lowercase());
    let check = move |seed| match target {
        Target::Readers => readers::check_of(reader.as_deref(), seed),
        Target::Runs => runs::check(seed),
    };
    let plan = Plan { seed, count: count.unwrap_or(u64::MAX), time, jobs: jobs.max(1) };
    let tally = pool::run(plan, check, |tally, failure| match failure {
        Some((seed, wrong)) => line(&format!("{name} --seed {seed} --count 1: {wrong}")),
        None => line(&summary(tally, begun)),
    });
    line(&summary(&tally, begun));
    ExitCode::from(u8::from(!tally.failures.is_empty()))
}
