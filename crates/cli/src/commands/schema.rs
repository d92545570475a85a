//! `stickslip schema`.

use clap::{Args, ValueEnum};

#[derive(Args)]
pub(super) struct SchemaArgs {
    /// Kind of JSON document
    of: Of,
}

#[derive(Clone, Copy, ValueEnum)]
enum Of {
    /// Output of run --json, and run.json
    Run,
    /// Output of solve --json and judge --json
    Problem,
    /// Output of collection --json, and collection.json
    Collection,
    /// Scene files, for editors that complete and check TOML
    Scene,
}

pub(super) fn schema(args: &SchemaArgs) {
    match args.of {
        Of::Run => say!("{:#}", stickslip_output::run_schema()),
        Of::Problem => say!("{:#}", crate::problems::problem_schema()),
        Of::Collection => say!("{:#}", crate::problems::collection_schema()),
        Of::Scene => say!("{:#}", stickslip::scene::schema()),
    }
}
