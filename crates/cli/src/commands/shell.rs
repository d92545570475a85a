//! Completions and manual pages, generated from the same description as `--help`.

use clap::{Args, Command};
use clap_complete::Shell;

use super::Failure;

#[derive(Args)]
pub(super) struct CompletionsArgs {
    /// Shell for which to complete commands
    shell: Shell,
}

#[derive(Args)]
pub(super) struct ManArgs {
    /// Command to describe [default: the program]
    command: Option<String>,
}

pub(super) fn completions(args: &CompletionsArgs, mut program: Command) {
    let mut script = Vec::new();
    clap_complete::generate(args.shell, &mut program, "stickslip", &mut script);
    say!("{}", String::from_utf8_lossy(&script).trim_end());
}

pub(super) fn man(args: &ManArgs, mut program: Command) -> Result<(), Failure> {
    // Only `build` puts the name of the program before the names of commands in their manual pages.
    program.build();
    let page = match &args.command {
        None => Some(program.clone()),
        Some(name) => program.find_subcommand(name).map(|command| command.clone().name(format!("stickslip-{name}"))),
    };
    let Some(page) = page else {
        let names: Vec<&str> = program.get_subcommands().map(Command::get_name).collect();
        let help = format!("the commands are {}", names.join(", "));
        let name = args.command.as_deref().unwrap_or_default();
        return Err(Failure::input(format!("there is no command `{name}`"), help));
    };
    let mut text = Vec::new();
    let rendered = clap_mangen::Man::new(page).render(&mut text);
    rendered.map_err(|error| Failure::Machine(miette::miette!("the page cannot be written: {error}")))?;
    say!("{}", String::from_utf8_lossy(&text).trim_end());
    Ok(())
}
