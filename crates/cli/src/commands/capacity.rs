//! `stickslip capacity`.

use clap::Args;
use stickslip::algebra::linear;
use stickslip_output::paragraph;

use super::study::{changed, pretty, print_results};
use super::{ExitStatus, Failure, Invocation, SceneArgs, interrupt};
use crate::capacity;

#[derive(Args)]
pub(super) struct CapacityArgs {
    #[command(flatten)]
    scene: SceneArgs,
    /// The load that grows, by its number in the scene from 0, or by its boundary, point or coupling
    #[arg(long, value_name = "LOAD", default_value = "0")]
    load: String,
    /// Print only the results, as one JSON object
    #[arg(long)]
    json: bool,
}

/// Exit status 1: the joint does not hold the load, its capacity is not known, or the search was interrupted.
pub(super) fn capacity(args: &CapacityArgs, invocation: &Invocation) -> Result<ExitStatus, Failure> {
    interrupt::listen();
    let scene = args.scene.read()?;
    linear::process::keep_freed_memory();
    let refused = |message| Failure::input(message, "name a load that is not 0 at the end with --load");
    let load = capacity::load(&scene, &args.load).map_err(refused)?;
    let found = capacity::compute(&scene, load, &mut interrupt::UntilInterrupted)?.map_err(refused)?;
    let mut text = format!("{}\n\n", scene.title);
    let slips = found.between.is_none() || found.report.explanation.slip.is_some();
    let against = if slips { "slip as a whole" } else { "the loss of equilibrium" };
    text.push_str(&paragraph("safety", &format!("{} against {against}", found.safety())));
    text.push_str(&paragraph("capacity", &found.sentence()));
    for warning in &found.report.warnings {
        text += &paragraph("warning", &format!("{}: {}", warning.kind.name, warning.message));
    }
    let mut json = changed(found.to_json(), &args.scene, &invocation.command_line());
    if interrupt::requested() {
        json["status"] = "interrupted".into();
        text += &paragraph("interrupted", "the search ended early");
    }
    let json = pretty(&json)?;
    print_results(None, args.json.then_some(&json), &text, || Ok(Vec::<(&str, String)>::new()))?;
    Ok(if found.holds() && !interrupt::requested() { ExitStatus::Success } else { ExitStatus::NotConverged })
}
