//! `stickslip sweep`.

mod processes;

use std::fs;
use std::io;
use std::path::{Path, PathBuf};

use crate::sweep::{
    Places, QuantityError, Row, Shown, Sweep, TableQuantity, VariantResult, Variation, check_places, combinations,
    quantities,
};
use clap::Args;
use stickslip::scene::{Override, Scene};
use stickslip_output::{FolderLock, write_file};

use super::progress::bar;
use super::run::{increments, write_failure};
use super::{Cli, ExitStatus, Failure, SceneArgs, interrupt, origin, threads};
use processes::{Ended, Processes};

#[derive(Args)]
pub(super) struct SweepArgs {
    #[command(flatten)]
    scene: SceneArgs,
    /// Vary a key over a list (mesh.file=a.msh,b.msh) or a range from:to:count (contact.friction=0.1:0.8:8), or several
    /// keys together (time.end,time.increments=[1,10],[2,20]); with several --vary, all combinations are run
    #[arg(long = "vary", value_name = "KEY=VALUES", required = true)]
    variations: Vec<Variation>,
    #[command(flatten)]
    shown: ShownArgs,
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

/// Options for what is shown of each variant.
#[derive(Args)]
struct ShownArgs {
    /// Quantities of the table: keys of run.json (friction.friction_work, boundaries[0].force[1]), lengths of vectors
    /// (size:largest_force.force), and columns of forces.csv over the increments (max:top.f_x, min:bottom.f_y,
    /// last:load:top.u_x) [default: the key results]
    #[arg(long, value_name = "QUANTITY,...")]
    table: Option<String>,
    /// Quantity of the chart, as in --table [default: the largest pressure]
    #[arg(long, value_name = "QUANTITY")]
    plot: Option<TableQuantity>,
}

impl ShownArgs {
    /// Returns the quantities, checked against the places of the scenes.
    fn of(&self, places: &Places) -> Result<Shown, Failure> {
        let table = |text: &String| check_places(&quantities(text)?, places);
        let plot = |quantity: &TableQuantity| {
            quantity.check_number()?;
            Ok(check_places(std::slice::from_ref(quantity), places)?.remove(0))
        };
        let refused = |option: &str, error: QuantityError| Failure::Input(miette::miette!("--{option}: {error}"));
        Ok(Shown {
            table: self.table.as_ref().map(table).transpose().map_err(|error| refused("table", error))?,
            plot: self.plot.as_ref().map(plot).transpose().map_err(|error| refused("plot", error))?,
        })
    }
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
    let shown = args.shown.of(&places)?;
    let wanted = shown.all();
    let passing = || std::env::temp_dir().join(format!("stickslip-sweep-{}", std::process::id()));
    let lock =
        |folder: &PathBuf| FolderLock::new(folder, &TABLES, COLUMNS).map_err(|error| write_failure(folder, &error));
    let _alone = args.out.as_ref().map(lock).transpose()?;
    let path = args.out.as_ref().map_or_else(passing, |out| out.join("variants"));
    let results = Results { path, passes: args.out.is_none() };
    fs::create_dir_all(&results.path).map_err(|error| write_failure(&results.path, &error))?;
    let jobs = args.jobs.map_or_else(threads::processors, usize::from).clamp(1, tasks.len().max(1));
    let processes = Processes {
        invocation: &cli.invocation,
        scene: &args.scene.scene,
        folder: &results.path,
        // By default, the variants share the processors.
        threads: cli.threads.map_or_else(|| threads::count(None) / jobs, |count| count as usize).max(1),
        quantities: &wanted,
    };
    if let Some(folder) = &args.out {
        writable(folder)?;
    }
    processes.tidy();

    let mut outcomes: Vec<Option<VariantResult>> = tasks.iter().map(|task| processes.kept(task)).collect();
    let waiting: Vec<usize> = (0..tasks.len()).filter(|&k| outcomes[k].is_none()).collect();
    if !args.json {
        let kept = tasks.len() - waiting.len();
        let kept = if kept == 0 { String::new() } else { format!(", {kept} of them already complete") };
        say!("{}\nvariants     {}{kept}", first.title, tasks.len());
    }
    let bar = bar(waiting.len(), "variants");
    let orders: Vec<&Task> = waiting.iter().map(|&k| &tasks[k]).collect();
    let ended = processes.run(&orders, jobs, &mut |Ended { order, outcome }| {
        let k = waiting[order];
        // The scene may have changed during the sweep. Then the result is not of the scene that was asked for.
        let same = one(args, &tasks[k].overrides).is_ok_and(|(now, _, _)| now == tasks[k].fingerprint);
        outcomes[k] = Some(match outcome {
            _ if !same => {
                VariantResult::failed("bad-input", "the scene, or a file of it, changed during the run".to_string())
            }
            outcome => processes.keep(&tasks[k], outcome),
        });
        bar.inc(1);
    });
    bar.finish_and_clear();
    ended.map_err(|error| write_failure(&results.path, &error))?;

    let rows = tasks.iter().zip(outcomes).map(|(task, outcome)| {
        let stays = |_: &VariantResult| !results.passes && results.path.join(&task.fingerprint).is_dir();
        Row {
            values: task.values.clone(),
            results: outcome
                .as_ref()
                .filter(|outcome| stays(outcome))
                .map(|_| format!("variants/{}", task.fingerprint)),
            outcome: outcome.unwrap_or_else(|| VariantResult::failed("interrupted", String::new())),
        }
    });
    let sweep = Sweep::new(&first, args.variations.clone(), shown, rows.collect());
    let json = serde_json::to_string_pretty(&sweep).map_err(|error| Failure::Machine(miette::miette!("{error}")))?;
    if args.json {
        say!("{json}");
    } else {
        say!("\n{}", sweep.to_text().trim_end());
    }
    if interrupt::requested() && !args.json {
        say!("interrupted  repeat the command with the same --out to continue");
    }
    if let Some(folder) = &args.out {
        write(folder, &sweep, &json)?;
        if !args.json {
            say!("results      {}", folder.display());
        }
    }
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
        let help = "remove --increments";
        return Err(Failure::Input(miette::miette!(help = help, "--increments: the increments are varied")));
    }
    let increments = args.increments.map(|number| Override::value("time.increments", i64::from(number)));
    let mut places = Places::default();
    let mut task = |variant: crate::sweep::Variant| {
        let overrides = [args.scene.overrides(), increments.iter().cloned().collect(), variant.overrides].concat();
        let (fingerprint, text, scene) = one(args, &overrides)?;
        places.add(&scene.description);
        Ok(Task { values: variant.values, overrides, fingerprint, text })
    };
    let tasks = variants.into_iter().map(&mut task).collect::<Result<_, Failure>>()?;
    Ok((tasks, places))
}

/// Returns the fingerprint, the text and the scene with `overrides`.
fn one(args: &SweepArgs, overrides: &[Override]) -> Result<(String, String, Scene), Failure> {
    let scene = Scene::read(&args.scene.scene, overrides)?;
    Ok((origin(&scene)?.fingerprint(), scene.text().to_string(), scene))
}

/// The tables of a sweep.
const TABLES: [&str; 5] = ["sweep.csv", "sweep.json", "sweep.txt", "sweep.svg", "sweep.html"];

/// The columns of every `sweep.csv`, behind the varied keys.
const COLUMNS: &str = ",status,converged,iterations,seconds,largest_pressure";

/// Returns an error, before anything runs, if a table cannot be written.
fn writable(folder: &Path) -> Result<(), Failure> {
    let tables = TABLES.map(|name| folder.join(name));
    match tables.iter().find(|table| table.is_dir()) {
        Some(table) => Err(write_failure(table, &io::Error::from(io::ErrorKind::IsADirectory))),
        None => Ok(()),
    }
}

fn write(folder: &Path, sweep: &Sweep, json: &str) -> Result<(), Failure> {
    let chart = sweep.chart().to_svg().map_err(|error| Failure::Machine(miette::miette!("{error}")))?;
    let (csv, text, page) = (sweep.to_csv(), sweep.to_text(), sweep.to_html(&chart));
    for (name, content) in TABLES.into_iter().zip([&csv, json, &text, &chart, &page]) {
        write_file(folder, name, content).map_err(|error| write_failure(folder, &error))?;
    }
    Ok(())
}
