//! `stickslip export`: writes one increment of a scene as a problem for other programs.

use super::solve::{destination, write};
use super::{ExitStatus, Failure, SceneArgs, interrupt};
use clap::{Args, ValueEnum};
use std::ops::ControlFlow;
use std::path::PathBuf;
use stickslip::run::{RecordedIncrement, Run};
use stickslip::solver::State;
use stickslip::solver::history::{IncrementView, Observer, Status};
use stickslip_exchange::{Info, export, export_local};

#[derive(Args)]
pub(super) struct ExportArgs {
    #[command(flatten)]
    scene: SceneArgs,
    /// Number of the increment, from 1 [default: the last]
    #[arg(long, value_name = "K", value_parser = clap::value_parser!(u32).range(1..))]
    increment: Option<u32>,
    /// Unknowns of the problem: the displacements of the bodies too (global) or the contact forces alone (local)
    #[arg(long, value_enum, default_value = "global")]
    form: Form,
    /// FCLIB file to write
    #[arg(long, value_name = "FILE")]
    out: PathBuf,
}

#[derive(Clone, Copy, PartialEq, ValueEnum)]
enum Form {
    /// M v = f + H r, u = H'v + w
    Global,
    /// u = W r + q
    Local,
}

/// Observer that keeps one increment and the state before it, and then stops the run.
struct One {
    number: usize,
    before: Option<State>,
    found: Option<RecordedIncrement>,
}

impl Observer for One {
    fn increment(&mut self, step: &IncrementView<'_>) -> ControlFlow<()> {
        if step.record.index == self.number || step.record.status != Status::Converged {
            self.found = Some(RecordedIncrement::new(step));
            return ControlFlow::Break(());
        }
        self.before = Some(step.state.clone());
        ControlFlow::Continue(())
    }
}

/// Exit status 1: the increment did not converge, and the file contains the problem without a solution.
pub(super) fn export_scene(args: &ExportArgs) -> Result<ExitStatus, Failure> {
    interrupt::listen();
    destination(&args.out)?;
    let scene = args.scene.read()?;
    let run = Run::new(&scene)?;
    let increments = run.times().len();
    let number = args.increment.map_or(increments, |number| number as usize);
    if number > increments {
        let help = "choose one of them, or raise time.increments";
        return Err(Failure::input(format!("increment {number} is asked for, but the scene has {increments}"), help));
    }
    let mut one = One { number, before: None, found: None };
    run.solve(&mut one)?;
    let Some(found) = one.found else {
        return Err(Failure::Machine(miette::miette!("the run ended before increment {number}")));
    };
    let (model, record) = (run.model(), &found.record);
    if record.index < number {
        let help = "export that one, or correct the scene";
        let (index, status) = (record.index, record.status);
        let message = format!("increment {number} was not reached: increment {index} ended {status}");
        return Err(Failure::input(message, help));
    }
    let before = one.before.unwrap_or_else(|| State::zero(&model.problem));
    let info = Info {
        title: Some(format!("{}, increment {number} of {increments}", scene.title)),
        description: Some(format!(
            "Written by stickslip {} at t = {} s, SI units",
            env!("CARGO_PKG_VERSION"),
            record.time
        )),
        math_info: None,
    };
    let help = "export the global form";
    let file = export(&model.problem, model.mesh.components(), &found.data(), &found.state, &before, info);
    let mut file = file.map_err(|fault| Failure::input(&fault, &fault.help))?;
    if record.status != Status::Converged {
        file.solution = None;
    }
    if args.form == Form::Local {
        file = export_local(file).map_err(|error| Failure::input(error, help))?;
    }
    write(&args.out, &file)?;
    let problem = &file.problem;
    say!("{}", file.info.title.as_deref().unwrap_or_default());
    row!(
        "problem      {}, {} contacts, {} unknowns of the body",
        problem.form(),
        problem.contacts(),
        problem.unknowns()
    );
    say!("results      {}", args.out.display());
    if record.status == Status::Converged {
        return Ok(ExitStatus::Success);
    }
    row!("verdict      {}: the file has the problem without a solution", record.status);
    Ok(ExitStatus::NotConverged)
}
