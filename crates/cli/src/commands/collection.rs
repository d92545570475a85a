//! `stickslip collection`: all exchange files of a folder.

use std::convert::Infallible;
use std::fs;
use std::path::{Path, PathBuf};

use crate::problems::{Collection, ProblemReport, Row, Verdict};
use clap::Args;
use stickslip::algebra::parallel_map;
use stickslip::run::report::thread_cpu_seconds;
use stickslip_exchange::{ProblemFile, Strategy, solve_by};

use super::progress::bar;
use super::study::{StudyFolder, pretty, print_results};
use super::{ExitStatus, Failure, interrupt};

/// The name endings of exchange files.
const ENDINGS: [&str; 4] = ["hdf5", "h5", "hdf", "dat"];

/// The files of a collection.
const FILES: [&str; 4] = ["collection.csv", "collection.json", "profile.csv", "profile.svg"];

/// The first columns of every `collection.csv`.
const COLUMNS: &str = "file,way,form,dimension,contacts,unknowns,";

#[derive(Args)]
pub(super) struct CollectionArgs {
    /// Folder whose files ending with hdf5, h5, hdf or dat are solved
    folder: PathBuf,
    /// Solve each problem with every available solver and compare the solvers
    #[arg(long)]
    compare: bool,
    /// Write the table (collection.csv, collection.json) and the performance profile (profile.csv, profile.svg) into
    /// this folder
    #[arg(long, value_name = "DIR")]
    out: Option<PathBuf>,
    /// Print only the table, as one JSON object
    #[arg(long)]
    json: bool,
}

/// Solves `threads` files at a time. Exit status 1: a problem is not solved; 2: a file cannot be read; 3: the machine
/// failed.
pub(super) fn collection(args: &CollectionArgs, threads: usize) -> Result<ExitStatus, Failure> {
    interrupt::listen();
    let (files, others) = files(&args.folder)?;
    let folder = StudyFolder::open(args.out.as_deref(), &FILES, COLUMNS)?;
    let ways: &[Strategy] = if args.compare { &Strategy::ALL } else { &[Strategy::Default] };
    let tasks: Vec<(&PathBuf, Strategy)> =
        files.iter().flat_map(|file| ways.iter().map(move |way| (file, *way))).collect();
    let bar = bar(tasks.len(), "problems");
    let rows = parallel_map(&tasks, threads, |(path, way)| {
        let row = row(path, *way);
        bar.inc(1);
        Ok::<_, Infallible>(row)
    });
    bar.finish_and_clear();
    let rows: Vec<Row> = rows.unwrap_or_default().into_iter().flatten().collect();
    let collection = Collection::new(rows);
    let json = pretty(&collection)?;
    let Collection { files, solved, cpu_seconds, .. } = &collection;
    let others = if others == 0 { String::new() } else { format!(", {others} other files ignored") };
    let verdict = format!("verdict      {solved} of {files} problems solved, {cpu_seconds:.2} s CPU{others}");
    let text = format!("{}\n\n{verdict}", collection.to_text().trim_end());
    let contents = || {
        let profile = collection.profile();
        let chart = profile.chart(&format!("Problems of {}", args.folder.display())).to_svg()?;
        Ok(FILES.into_iter().zip([collection.to_csv(), json.clone(), profile.to_csv(), chart]))
    };
    print_results(folder.as_ref(), args.json.then_some(&json), &text, contents)?;
    let has = |verdict: Verdict| collection.rows.iter().any(|row| row.status == verdict);
    Ok(match () {
        () if has(Verdict::MachineFailure) => ExitStatus::MachineFailure,
        () if has(Verdict::BadInput) => ExitStatus::BadInput,
        () if collection.solved < collection.files => ExitStatus::NotConverged,
        () => ExitStatus::Success,
    })
}

/// Returns the exchange files of a folder by name, and the number of other files.
fn files(folder: &Path) -> Result<(Vec<PathBuf>, usize), Failure> {
    let entries = fs::read_dir(folder).map_err(|error| {
        Failure::input(format!("{}: the folder cannot be read: {error}", folder.display()), "name a folder")
    })?;
    let mut all: Vec<PathBuf> = entries.flatten().map(|entry| entry.path()).filter(|path| path.is_file()).collect();
    all.sort();
    let ours = |path: &PathBuf| path.extension().and_then(|end| end.to_str()).is_some_and(|end| ENDINGS.contains(&end));
    let (files, others): (Vec<_>, Vec<_>) = all.into_iter().partition(ours);
    if files.is_empty() {
        let help = "name a folder with files that end with hdf5, h5, hdf or dat";
        return Err(Failure::input(format!("{}: it contains no exchange file", folder.display()), help));
    }
    Ok((files, others.len()))
}

/// Solves a file. Returns `None` if the solver does not apply to its problem or the command is interrupted.
fn row(path: &Path, way: Strategy) -> Option<Row> {
    if interrupt::requested() {
        return None;
    }
    let name = path.file_name().map(|name| name.to_string_lossy().to_string()).unwrap_or_default();
    let file = match ProblemFile::read(path) {
        Ok(file) => file,
        Err(error) => return Some(Row::failed(&name, way.name(), Verdict::BadInput, error.to_string())),
    };
    let start = thread_cpu_seconds();
    match solve_by(way, &file.problem, None) {
        Ok(None) => None,
        Ok(Some(answer)) => {
            let report = ProblemReport::solved(&name, &file, &answer, thread_cpu_seconds() - start);
            Some(Row::of(&report, way.name()))
        }
        Err(error) => {
            let status = match Failure::from(error.clone()) {
                Failure::Machine(_) => Verdict::MachineFailure,
                Failure::Input(_) => Verdict::NotSolved,
            };
            Some(Row::failed(&name, way.name(), status, format!("{name}: {error}")))
        }
    }
}
