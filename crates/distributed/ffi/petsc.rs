//! Generates the bindings of the PETSc that is installed, and links it.

use super::bindings::{generate, stop};
use super::ranks::includes;
use std::process::Command;

/// The functions that `petsc.rs` calls.
const ALLOWED: [&str; 9] = [
    "Petsc(InitializeNoArguments|Finalize|LogDefaultBegin|Options(SetValue|Clear|InsertString|HasName|Used)|PushErrorHandler)",
    "PETSC_(COMM_WORLD|DETERMINE|DEFAULT)|PetscObject(Destroy|Reference)",
    "Mat(Create|SetSizes|SetBlockSize|SetType|SetOption|SetPreallocationCOO|SetValuesCOO|MatMult|Duplicate|AXPY|ZeroEntries)",
    "Mat(Mult|Restrict|Interpolate|CreateVecs|CreateTranspose|GetDiagonal|GetRowMaxAbs|GetInfo|GetOwnershipRange|GetRow|RestoreRow|SetNearNullSpace|NullSpaceCreate)",
    "Mat(CreateComposite|Composite(SetScalings|Merge)|MumpsGetInfog|MumpsGetRinfog|Partitioning(Create|SetAdjacency|SetFromOptions|Apply))",
    "IS(GetIndices|RestoreIndices)",
    "Vec(Create|Duplicate|SetRandom|Equal|SetSizes|SetType|GetLocalSize|GetArray|RestoreArray|Scatter(CreateToZero|Begin|End))",
    "PC(Create|SetType|SetOperators|Composite(SetType|AddPC)|Galerkin(SetInterpolation|SetRestriction|GetKSP)|FactorGetMatrix)",
    "KSP(Create|SetOptionsPrefix|SetOperators|GetPC|SetPC|SetFromOptions|SetUp|SetTolerances|Solve|GetConvergedReason|GetIterationNumber)",
];

/// Everything this file is for.
pub fn petsc() {
    println!("cargo:rerun-if-changed=ffi/petsc.rs");
    println!("cargo:rerun-if-changed=ffi/petsc.h");
    println!("cargo:rerun-if-env-changed=PKG_CONFIG_PATH");
    let mut arguments = Vec::new();
    for flag in words("pkg-config", &["--cflags", "petsc"]) {
        arguments.push(flag);
    }
    for flag in words("pkg-config", &["--libs", "petsc"]) {
        if let Some(folder) = flag.strip_prefix("-L") {
            println!("cargo:rustc-link-search=native={folder}");
        } else if let Some(library) = flag.strip_prefix("-l") {
            println!("cargo:rustc-link-lib=dylib={library}");
        }
    }
    arguments.extend(includes());
    generate("ffi/petsc.h", "petsc.rs", &arguments, &ALLOWED);
}

/// Returns the output of a program that describes an installation.
fn words(program: &str, arguments: &[&str]) -> Vec<String> {
    match Command::new(program).args(arguments).output() {
        Ok(output) if output.status.success() => {
            String::from_utf8_lossy(&output.stdout).split_whitespace().map(str::to_owned).collect()
        }
        _ => stop(&format!(
            "`{program} {}` tells nothing of PETSc.\n  Debian, Ubuntu: apt-get install petsc-dev libopenmpi-dev pkg-config",
            arguments.join(" ")
        )),
    }
}
