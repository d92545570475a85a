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
    /// A scene, for editors that complete and check TOML
    Scene,
}

pub(super) fn schema(args: &SchemaArgs) {
    match args.of {
        Of::Run => say!("{:#}", stickslip::report::run_schema()),
        Of::Scene => say!("{}", stickslip::scene::SCHEMA.trim_end()),
    }
}
