//! `stickslip init`: prints example scenes from `data`.

use std::fs;
use std::path::{Path, PathBuf};

use clap::{Args, ValueEnum};
use stickslip::scene::Scene;
use stickslip_output::write_file;

use super::run::write_failure;
use super::{Failure, output};

#[derive(Args)]
pub(super) struct InitArgs {
    /// Kind of body or joint; without one the kinds are listed
    kind: Option<Kind>,
    /// The input file, for `abaqus`
    file: Option<PathBuf>,
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
    /// Two bodies, pressed together and pushed to and fro
    TwoBodies,
    /// A bolted joint of revolution, tightened and pulled
    Bolt,
    /// A shaft that is pressed into a hub and drawn out
    PressFit,
    /// A cylinder that rubs on a block in cycles
    Fretting,
    /// Half a wave of a rough surface, pressed on a rigid plane
    Rough,
    /// Two plates under a clamp, pulled apart, on a mesh from Gmsh
    LapJoint,
    /// The files of all tutorials: `stickslip init tutorials --out data/tutorials`
    Tutorials,
    /// The scene of an input file: `stickslip init abaqus part.inp`
    Abaqus,
}

/// The names and contents of files in a folder of `data`, the scene first.
macro_rules! files {
    ($folder:literal: $($name:literal)*) => {
        &[$(($name, include_bytes!(concat!("../../../../data/", $folder, "/", $name)))),*]
    };
}

impl Kind {
    fn files(self) -> &'static [(&'static str, &'static [u8])] {
        match self {
            Kind::Block => files!("init": "block.toml"),
            Kind::Cube => files!("init": "cube.toml"),
            Kind::Gmsh => files!("init": "roller.toml" "roller.geo" "roller.msh"),
            Kind::TwoBodies => files!("scenes": "two_blocks.toml"),
            Kind::Bolt => files!("scenes": "bolt.toml"),
            Kind::PressFit => files!("tutorials": "press-fit.toml" "press-fit-torque.toml"),
            Kind::Fretting => files!("tutorials": "fretting.toml"),
            Kind::Abaqus => &[],
            Kind::Rough => files!("init": "rough.toml"),
            Kind::LapJoint => files!("tutorials": "lap-joint.toml" "lap-joint.geo" "lap-joint.msh"),
            Kind::Tutorials => files!(
                "tutorials": "fretting.toml" "press-fit.toml" "press-fit-torque.toml" "press-fit-3d.toml"
                "press-fit-3d.geo" "press-fit-3d.msh" "lap-joint.toml" "lap-joint.geo" "lap-joint.msh"
                "lap-joint-coarse.msh" "lap_joint.py" "punch.toml" "rigid-floor.toml" "rigid-floor-sphere.toml"
                "die.geo" "die.stl" "own_matrices.py" "chain.dat"
            ),
        }
    }
}

pub(super) fn init(args: &InitArgs) -> Result<(), Failure> {
    let Some(kind) = args.kind else {
        for kind in Kind::value_variants().iter().filter_map(ValueEnum::to_possible_value) {
            row!("{:<13}{}", kind.get_name(), kind.get_help().map(ToString::to_string).unwrap_or_default());
        }
        return Ok(());
    };
    if let (Kind::Abaqus, file) | (_, file @ Some(_)) = (kind, &args.file) {
        return of_file(kind, file.as_deref(), args.out.as_deref());
    }
    let files = kind.files();
    if let Some(folder) = &args.out {
        return write(folder, files);
    }
    let [(name, scene), besides @ ..] = files else { return Ok(()) };
    say!("{}", String::from_utf8_lossy(scene).trim_end());
    if !besides.is_empty() {
        let besides: Vec<&str> = besides.iter().map(|(name, _)| *name).collect();
        output::note(&format!("note: with --out DIR {name} comes with {}", besides.join(" and ")));
    }
    Ok(())
}

/// Prints the scene of an input file, to be saved beside it, or writes it into the folder `out`.
fn of_file(kind: Kind, file: Option<&Path>, out: Option<&Path>) -> Result<(), Failure> {
    let Some(file) = file.filter(|_| matches!(kind, Kind::Abaqus)) else {
        let help = "write `stickslip init abaqus part.inp`; all other kinds stand alone";
        return Err(Failure::input("init takes an input file with the kind `abaqus`, and only with it", help));
    };
    let beside = PathBuf::from(file.file_name().unwrap_or_default());
    let mesh = if out.is_some() { std::path::absolute(file).unwrap_or(beside) } else { beside };
    let scene =
        Scene::text_from_abaqus(file, &mesh.display().to_string()).map_err(|error| Failure::Input(error.into()))?;
    if let Some(folder) = out {
        let name = Path::new(file.file_stem().unwrap_or_default()).with_extension("toml");
        return write(folder, &[(&name.display().to_string(), scene.as_bytes())]);
    }
    say!("{}", scene.trim_end());
    Ok(())
}

fn write(folder: &Path, files: &[(&str, &[u8])]) -> Result<(), Failure> {
    let paths = || files.iter().map(|(name, _)| folder.join(name));
    if let Some(path) = paths().find(|path| path.exists()) {
        let help = "choose another folder with --out; nothing was written";
        return Err(Failure::input(format!("{} already exists", path.display()), help));
    }
    let written = |result: std::io::Result<()>| result.map_err(|error| write_failure(folder, &error));
    written(fs::create_dir_all(folder))?;
    for (k, (name, content)) in files.iter().enumerate() {
        if let Err(error) = write_file(folder, name, content) {
            // All files are written or none: a later try would refuse to overwrite the files of an incomplete one.
            paths().take(k).for_each(|path| drop(fs::remove_file(path)));
            return written(Err(error));
        }
    }
    paths().for_each(|path| say!("{}", path.display()));
    Ok(())
}
