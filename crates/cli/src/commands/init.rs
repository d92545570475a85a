//! `stickslip init`: prints example scenes from `data/init`.

use std::fs;
use std::path::{Path, PathBuf};

use clap::{Args, ValueEnum};
use stickslip_output::write_file;

use super::run::write_failure;
use super::{Failure, output};

#[derive(Args)]
pub(super) struct InitArgs {
    /// Kind of body
    kind: Kind,
    /// Write the scene and the files that it reads into this folder
    #[arg(long, value_name = "DIR")]
    out: Option<PathBuf>,
}

#[derive(Clone, Copy, ValueEnum)]
enum Kind {
    /// A rectangle
    Block,
    /// A mesh from Gmsh
    Gmsh,
    /// A box
    Cube,
}

impl Kind {
    /// Returns the names and texts of its files, the scene first.
    fn files(self) -> &'static [(&'static str, &'static str)] {
        match self {
            Kind::Block => &[("block.toml", include_str!("../../../../data/init/block.toml"))],
            Kind::Cube => &[("cube.toml", include_str!("../../../../data/init/cube.toml"))],
            Kind::Gmsh => &[
                ("roller.toml", include_str!("../../../../data/init/roller.toml")),
                ("roller.geo", include_str!("../../../../data/init/roller.geo")),
                ("roller.msh", include_str!("../../../../data/init/roller.msh")),
            ],
        }
    }
}

pub(super) fn init(args: &InitArgs) -> Result<(), Failure> {
    let files = args.kind.files();
    if let Some(folder) = &args.out {
        return write(folder, files);
    }
    let [(name, scene), besides @ ..] = files else { return Ok(()) };
    say!("{}", scene.trim_end());
    if !besides.is_empty() {
        let besides: Vec<&str> = besides.iter().map(|(name, _)| *name).collect();
        output::note(&format!("note: with --out DIR {name} comes with {}", besides.join(" and ")));
    }
    Ok(())
}

fn write(folder: &Path, files: &[(&str, &str)]) -> Result<(), Failure> {
    let paths = || files.iter().map(|(name, _)| folder.join(name));
    if let Some(path) = paths().find(|path| path.exists()) {
        let help = "choose another folder with --out; nothing was written";
        return Err(Failure::input(format!("{} already exists", path.display()), help));
    }
    let written = |result: std::io::Result<()>| result.map_err(|error| write_failure(folder, &error));
    written(fs::create_dir_all(folder))?;
    for (k, (name, text)) in files.iter().enumerate() {
        if let Err(error) = write_file(folder, name, text) {
            // All files are written or none: a later try would refuse to overwrite the files of an incomplete one.
            paths().take(k).for_each(|path| drop(fs::remove_file(path)));
            return written(Err(error));
        }
    }
    paths().for_each(|path| say!("{}", path.display()));
    Ok(())
}
