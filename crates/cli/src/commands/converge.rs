//! `stickslip converge`.

use std::fs;
use std::path::{Path, PathBuf};

use crate::converge::{self, Limits, Plan, Verdict};
use crate::study::{MeshSize, TableQuantity};
use clap::Args;
use stickslip::algebra::linear;
use stickslip::body::mesh::MeshSource;
use stickslip_output::paragraph;

use super::study::{StudyFolder, changed, counted, pretty, print_results};
use super::{ExitStatus, Failure, Invocation, SceneArgs, interrupt};

#[derive(Args)]
pub(super) struct ConvergeArgs {
    #[command(flatten)]
    scene: SceneArgs,
    /// The quantity: peak (largest contact pressure), force (largest contact force), tangential (largest tangential
    /// force of a contact), friction_work, stick_ratio, or any number as in sweep --table
    #[arg(long = "for", value_name = "QUANTITY")]
    sought: TableQuantity,
    /// The share to which it is to be known, e.g. 0.02 for 2 %
    #[arg(long, value_name = "SHARE", default_value_t = 0.02, value_parser = share)]
    to: f64,
    /// Meshes from coarse to fine, each by its first number of elements, the other numbers in the proportions of the
    /// scene; for a scene with a mesh file, mesh files, relative to the scene file: a.msh,b.msh [default: triangles and
    /// tetrahedra refine themselves; others a quarter, half, all of the scene's elements along each axis, and so on]
    #[arg(long, value_delimiter = ',')]
    meshes: Vec<MeshSize>,
    /// Factor of the elements along each axis from mesh to mesh
    #[arg(long, value_name = "R", default_value_t = 2.0, value_parser = ratio)]
    ratio: f64,
    /// Largest number of runs
    #[arg(long, value_name = "N", default_value_t = 12, value_parser = clap::value_parser!(u16).range(3..))]
    max_runs: u16,
    /// Largest time of the whole study: a run that is predicted to exceed it is not started, one that exceeds it is stopped
    #[arg(long, value_name = "SECONDS", default_value_t = 600.0, value_parser = seconds)]
    within: f64,
    /// Write the table (converge.csv), all results (converge.json), the chart (converge.svg) and the last mesh that refined
    /// itself (converge.msh, for mesh.file) into this folder
    #[arg(long, value_name = "DIR")]
    out: Option<PathBuf>,
    /// Print only the results, as one JSON object
    #[arg(long)]
    json: bool,
}

fn share(text: &str) -> Result<f64, String> {
    match text.trim_end_matches('%').trim().parse::<f64>() {
        Ok(share) if share > 0.0 && share < 1.0 && !text.ends_with('%') => Ok(share),
        Ok(x) if x > 0.0 && x < 100.0 => Err(format!("not a number between 0 and 1; give {} for {x} %", x / 100.0)),
        _ => Err("not a number between 0 and 1".to_string()),
    }
}

fn seconds(text: &str) -> Result<f64, String> {
    let seconds = text.parse().ok().filter(|seconds: &f64| seconds.is_finite() && *seconds > 0.0);
    seconds.ok_or_else(|| "give a number of seconds above 0".to_string())
}

fn ratio(text: &str) -> Result<f64, String> {
    let ratio = text.parse().ok().filter(|ratio: &f64| (1.2..=4.0).contains(ratio));
    ratio.ok_or_else(|| "give a factor from 1.2 to 4".to_string())
}

/// Returns `true` if the mesh, or that of a body, is read from this file.
fn reads(mesh: &MeshSource, path: &Path) -> bool {
    match mesh {
        MeshSource::File { file, .. } => file.canonicalize().is_ok_and(|file| file == path),
        MeshSource::Bodies(bodies) => bodies.iter().any(|body| reads(&body.mesh, path)),
        _ => false,
    }
}

/// The files of a study. The last one is there if meshes refined themselves.
const FILES: [&str; 4] = ["converge.csv", "converge.json", "converge.svg", "converge.msh"];

/// The first columns of every `converge.csv`.
const COLUMNS: &str = "mesh,elements,increments,";

/// Exit status 1: the quantity is not known to the asked share.
pub(super) fn converge(args: &ConvergeArgs, invocation: &Invocation) -> Result<ExitStatus, Failure> {
    interrupt::listen();
    let scene = args.scene.read()?;
    let folder = StudyFolder::open(args.out.as_deref(), &FILES, COLUMNS)?;
    let written = folder.as_ref().and_then(|folder| folder.path.join(FILES[3]).canonicalize().ok());
    if let Some(file) = written.filter(|file| reads(&scene.description.mesh, file)) {
        let message = format!("{}: the scene reads this mesh, and the study would replace it", file.display());
        return Err(Failure::input(message, "choose another folder with --out"));
    }
    let plan = Plan {
        sought: args.sought.clone(),
        meshes: args.meshes.clone(),
        ratio: args.ratio,
        limits: Limits { to: args.to, most_runs: usize::from(args.max_runs), within: args.within },
    };
    linear::process::keep_freed_memory();
    let (bar, mut progress) = counted(plan.limits.most_runs, "runs at most");
    let study = converge::compute(&scene, &plan, &mut progress, &mut interrupt::UntilInterrupted)?;
    bar.finish_and_clear();
    let json = pretty(&changed(study.to_json(), &args.scene, &invocation.command_line()))?;
    let mut text = format!("{}\n\n{}\n", scene.title, study.table());
    text.extend(study.lines().iter().map(|(label, line)| paragraph(label, line)));
    // A study that was interrupted replaces no other.
    let is_interrupted = study.result.verdict == Verdict::Interrupted;
    let earlier = folder.as_ref().filter(|folder| is_interrupted && folder.path.join(FILES[0]).exists());
    if let Some(StudyFolder { path, .. }) = earlier {
        text.push_str(&paragraph("results", &format!("those of the earlier study remain in {}", path.display())));
    }
    let files = || {
        let mesh = study.to_msh();
        // Another study may have left its mesh.
        if let (Some(folder), None) = (&folder, &mesh) {
            drop(fs::remove_file(folder.path.join(FILES[3])));
        }
        Ok(FILES.into_iter().zip([study.to_csv(), json.clone(), study.chart().to_svg()?].into_iter().chain(mesh)))
    };
    print_results(folder.as_ref().filter(|_| earlier.is_none()), args.json.then_some(&json), &text, files)?;
    Ok(if study.result.verdict == Verdict::Known { ExitStatus::Success } else { ExitStatus::NotConverged })
}
