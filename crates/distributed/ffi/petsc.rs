//! Generates the bindings of the PETSc that is installed, and links it.

use super::bindings::{generate, stop};
use super::ranks::includes;
use std::process::Command;

/// What `petsc.rs` calls.
const ALLOWED: [&str; 8] = [
    "Petsc(InitializeNoArguments|OptionsSetValue|PushErrorHandler|ReturnErrorHandler|PopSignalHandler|GetVersionNumber)",
    "PETSC_(COMM_WORLD|DETERMINE|VERSION_.*)",
    "Mat(CreateSeqAIJWithArrays|CreateMPIAIJWithArrays|SetBlockSize|SetOption|SetNearNullSpace|NullSpaceCreate|NullSpaceDestroy|Destroy)",
    "Vec(CreateSeqWithArray|CreateMPIWithArray|PlaceArray|ResetArray|Destroy)",
    "PC(Create|SetType|SetOperators|SetOptionsPrefix|SetFromOptions|SetUp|Apply|Destroy|GetFailedReason)",
    "MatOption",
    "PCFailedReason",
    "PetscErrorCode",
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

/// What a program that tells about an installation says.
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
