//! `stickslip schema`.

use clap::{Args, ValueEnum};

#[derive(Args)]
pub(super) struct SchemaArgs {
    /// Of what
    of: Of,
}

#[derive(Clone, Copy, ValueEnum)]
enum Of {
    /// What `run --json` prints and run.json holds
    Run,
    /// What `solve --json` and `judge --json` print
    Problem,
    /// What `collection --json` prints and collection.json holds
    Collection,
    /// A scene, for editors that complete and check TOML
    Scene,
}

pub(super) fn schema(args: &SchemaArgs) {
    match args.of {
        Of::Run => say!("{:#}", stickslip_output::run_schema()),
        Of::Problem => say!("{:#}", stickslip_cli::problems::problem_schema()),
        Of::Collection => say!("{:#}", stickslip_cli::problems::collection_schema()),
        Of::Scene => say!("{}", stickslip::scene::SCHEMA.trim_end()),
    }
}
