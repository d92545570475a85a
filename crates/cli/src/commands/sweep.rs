//! `stickslip sweep`.

mod processes;

use std::fs;
use std::path::PathBuf;

use crate::study::{Places, TableQuantity, quantities};
use crate::sweep::{Row, Sweep, TableQuantities, Variant, VariantResult, Variation, combinations};
use clap::Args;
use miette::Diagnostic;
use stickslip::algebra::parallel_map;
use stickslip::scene::{Override, Scene, SceneError};

use super::progress::bar;
use super::run::{increments, write_failure};
use super::study::{StudyFolder, changed, pretty, print_results};
use super::{Cli, ExitStatus, Failure, SceneArgs, interrupt, origin, threads};
use processes::Processes;

#[derive(Args)]
pub(super) struct SweepArgs {
    #[command(flatten)]
    scene: SceneArgs,
    /// Vary a key over a list (mesh.file=a.msh,b.msh) or a range from:to:count (contact.friction=0.1:0.8:8), or several
    /// keys together (time.end,time.increments=[1,10],[2,20]); with several --vary, all combinations are run
    #[arg(long = "vary", value_name = "KEY=VALUES", required = true)]
    variations: Vec<Variation>,
    /// Quantities of the table: keys of run.json (friction.friction_work, boundaries[0].force[1]), lengths of vectors
    /// (size:largest_force.force), and columns of forces.csv over the increments (max:top.f_x, min:bottom.f_y,
    /// last:load:top.u_x) [default: the key results]
    #[arg(long, value_name = "QUANTITY,...")]
    table: Option<String>,
    /// Quantity of the chart, as in --table [default: the largest pressure]
    #[arg(long, value_name = "QUANTITY")]
    plot: Option<TableQuantity>,
    /// Number of increments of all variants, replaces time.increments
    #[arg(long, value_name = "N", value_parser = increments)]
    increments: Option<u32>,
    /// Number of variants run at a time [default: the number of processors]
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u16).range(1..=1024))]
    jobs: Option<u16>,
    /// Write the table (sweep.csv, sweep.json, sweep.txt), the chart (sweep.svg), a page with both (sweep.html) and the
    /// results of each variant into this folder; complete results of an earlier try are kept
    #[arg(long, value_name = "DIR")]
    out: Option<PathBuf>,
    /// Print only the table, as one JSON object
    #[arg(long)]
    json: bool,
}

/// Returns the quantities of table and chart, checked against the places of the scenes.
fn shown(args: &SweepArgs, places: &Places) -> Result<TableQuantities, Failure> {
    let all = |text: &String| quantities(text)?.iter().map(|quantity| quantity.at(places, false)).collect();
    let refused = |option: &str, error: String| Failure::Input(miette::miette!("--{option}: {error}"));
    let plot = args.plot.as_ref().map(|quantity| quantity.at(places, true));
    Ok(TableQuantities {
        table: args.table.as_ref().map(all).transpose().map_err(|error| refused("table", error))?,
        plot: plot.transpose().map_err(|error| refused("plot", error))?,
    })
}

/// A variant to run.
struct Task {
    values: Vec<String>,
    /// The changes to the scene, as for `--set`.
    overrides: Vec<Override>,
    fingerprint: String,
    /// The text of the changed scene.
    text: String,
}

/// The folder of the results of all variants. A temporary one is removed when the command ends.
struct Results {
    path: PathBuf,
    passes: bool,
}

impl Drop for Results {
    fn drop(&mut self) {
        if self.passes {
            // If this fails, only a temporary folder remains, which the system removes in time.
            let _ = fs::remove_dir_all(&self.path);
        }
    }
}

/// Exit status 1: a variant did not converge; 3: the machine failed in one.
pub(super) fn sweep(args: &SweepArgs, cli: &Cli) -> Result<ExitStatus, Failure> {
    interrupt::listen();
    let first = args.scene.read()?;
    let (tasks, places) = tasks(args)?;
    let shown = shown(args, &places)?;
    let passing = || std::env::temp_dir().join(format!("stickslip-sweep-{}", std::process::id()));
    let folder = StudyFolder::open(args.out.as_deref(), &TABLES, COLUMNS)?;
    let path = args.out.as_ref().map_or_else(passing, |out| out.join("variants"));
    let results = Results { path, passes: args.out.is_none() };
    let failed = |error| write_failure(&results.path, &error);
    fs::create_dir_all(&results.path).map_err(failed)?;
    let jobs = args.jobs.map_or_else(threads::processors, usize::from).clamp(1, tasks.len().max(1));
    let processes = Processes {
        invocation: &cli.invocation,
        scene: &args.scene.scene,
        folder: &results.path,
        // By default, the variants share the processors.
        threads: cli.threads.map_or_else(|| threads::count(None) / jobs, |count| count as usize).max(1),
        quantities: &shown.all(),
    };
    processes.tidy();
    let stored: Vec<Option<VariantResult>> = tasks.iter().map(|task| processes.stored(task)).collect();
    let done = stored.iter().flatten().count();
    if !args.json {
        let complete = if done == 0 { String::new() } else { format!(", {done} of them already complete") };
        say!("{}\nvariants     {}{complete}", first.title, tasks.len());
    }
    let bar = bar(tasks.len() - done, "variants");
    let row = |(task, stored): &(&Task, Option<VariantResult>)| {
        let outcome = if let Some(kept) = stored {
            Some(kept.clone())
        } else {
            // The scene may have changed during the sweep. Then the result is not of the scene that was asked for.
            let read = || Ok::<_, Failure>(origin(&Scene::read(&args.scene.scene, &task.overrides)?)?.fingerprint());
            let same = || read().is_ok_and(|now| now == task.fingerprint);
            bar.set_message(task.values.join(", "));
            let outcome = processes.run(task, same)?;
            bar.inc(1);
            outcome
        };
        let stays = outcome.is_some() && !results.passes && results.path.join(&task.fingerprint).is_dir();
        Ok(Row {
            values: task.values.clone(),
            results: stays.then(|| format!("variants/{}", task.fingerprint)),
            outcome: outcome.unwrap_or_else(|| VariantResult::failed("interrupted", "")),
        })
    };
    let rows = parallel_map(&tasks.iter().zip(stored).collect::<Vec<_>>(), jobs, row);
    bar.finish_and_clear();
    let rows = rows.map_err(|error: std::io::Error| failed(error))?;
    let sweep =
        Sweep { command: cli.invocation.command_line(), ..Sweep::new(&first, args.variations.clone(), shown, rows) };
    let json = pretty(&changed(sweep.to_json(), &args.scene, &sweep.command))?;
    let mut text = format!("\n{}", sweep.to_text());
    if interrupt::requested() {
        text += "interrupted  repeat the command with the same --out to continue";
    }
    let files = || {
        let chart = sweep.chart();
        let page = sweep.to_html(&chart);
        let table = format!("{}\n\n{}", sweep.command, sweep.to_text());
        Ok(TABLES.into_iter().zip([sweep.to_csv(), json.clone(), table, chart.to_svg()?, page]))
    };
    print_results(folder.as_ref(), args.json.then_some(&json), &text, files)?;
    let outcomes = || sweep.variants.iter().map(|row| &row.outcome);
    Ok(match () {
        () if outcomes().all(VariantResult::is_converged) => ExitStatus::Success,
        () if outcomes().any(VariantResult::is_of_the_machine) => ExitStatus::MachineFailure,
        () => ExitStatus::NotConverged,
    })
}

/// Returns all variants, and the places of their scenes. Each is a valid scene whose files can be read.
fn tasks(args: &SweepArgs) -> Result<(Vec<Task>, Places), Failure> {
    let variants =
        combinations(&args.variations).map_err(|error| Failure::Input(miette::miette!("--vary: {error}")))?;
    if args.increments.is_some()
        && args.variations.iter().flat_map(Variation::keys).any(|key| ["time", "time.increments"].contains(&key))
    {
        return Err(Failure::input("--increments: the increments are varied", "remove --increments"));
    }
    let increments = args.increments.map(|number| Override::value("time.increments", i64::from(number)));
    let mut places = Places::default();
    let mut task = |variant: Variant| {
        let given = variant.overrides.iter().map(ToString::to_string).collect::<Vec<_>>().join(", ");
        let overrides = [args.scene.overrides(), increments.iter().cloned().collect(), variant.overrides].concat();
        let scene = Scene::read(&args.scene.scene, &overrides).map_err(|error| varied(&error, &given))?;
        let (fingerprint, text) = (origin(&scene)?.fingerprint(), scene.text().to_string());
        places.add(&scene.description);
        Ok(Task { values: variant.values, overrides, fingerprint, text })
    };
    let tasks = variants.into_iter().map(&mut task).collect::<Result<_, Failure>>()?;
    Ok((tasks, places))
}

/// Tells why a scene with the `given` changes is impossible. Its lines are not those of the file.
fn varied(error: &SceneError, given: &str) -> Failure {
    let text = error.to_string();
    let message = match text.split_once(" (with --set):").and_then(|(_, rest)| rest.split_once(": ")) {
        Some((_line, message)) => format!("--vary {given}: {message}"),
        None => text.replacen("--set ", "--vary ", 1),
    };
    Failure::input(message, error.help().map_or(String::new(), |help| help.to_string()))
}

/// The tables of a sweep.
const TABLES: [&str; 5] = ["sweep.csv", "sweep.json", "sweep.txt", "sweep.svg", "sweep.html"];

/// The columns of every `sweep.csv`, behind the varied keys.
const COLUMNS: &str = ",status,converged,iterations,seconds,largest_pressure";
