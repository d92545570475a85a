//! `stickslip report`: makes the page of a result folder again.

use std::path::PathBuf;

use clap::Args;
use stickslip_output::{PageError, write_page};

use super::Failure;

#[derive(Args)]
pub(super) struct ReportArgs {
    /// The folder that run --out has filled
    folder: PathBuf,
}

pub(super) fn report(args: &ReportArgs) -> Result<(), Failure> {
    write_page(&args.folder).map_err(|error| match &error {
        PageError::Disk(_) => Failure::machine(&error, error.help()),
        _ => Failure::input(&error, error.help()),
    })?;
    let page = args.folder.join("report.html");
    if !args.folder.join("run.json").exists() {
        say!("unfinished   run.json is missing: the page has the tables of the increments that were written");
    }
    say!("results      {}", page.display());
    Ok(())
}
