//! The kernel of OpenBLAS: the program uses and reports the right one, however it was chosen.

#![cfg(feature = "blas")]
#![allow(clippy::unwrap_used)]

use std::fs;
use std::process::Command;

use serde_json::Value;
use stickslip::algebra::linear::process::Blas;

use crate::common::skipped;
use crate::program::{Folder, assert_exit, json, small, stdout, unbroken};

/// Returns the kernel that OpenBLAS should use here. `None`, and the test prints that it is skipped, if there are no
/// kernels to choose among.
fn best() -> Option<&'static str> {
    let best = match () {
        () if !Blas::loaded().unwrap().selectable => None,
        () if has("avx512vl") => Some("SkylakeX"),
        () if has("avx2") && has("fma") => Some("Haswell"),
        () => None,
    };
    if best.is_none() {
        skipped("there are no kernels to choose among");
    }
    best
}

/// Returns `true` if this processor has these instructions.
fn has(instructions: &str) -> bool {
    let processor = fs::read_to_string("/proc/cpuinfo").unwrap_or_default();
    processor.split_whitespace().any(|word| word == instructions)
}

/// Returns the program on an OpenBLAS that has chosen its oldest kernel, as for a processor that it does not know: a
/// library takes the variable away after OpenBLAS has read it.
fn on_an_old_kernel(folder: &Folder) -> Command {
    let (source, library) = (folder.join("old.c"), folder.join("old.so"));
    fs::write(
        &source,
        "#include <stdlib.h>\n__attribute__((constructor)) static void forget(void) { unsetenv(\"OPENBLAS_CORETYPE\"); \
         unsetenv(\"LD_PRELOAD\"); }\n",
    )
    .unwrap();
    let built = Command::new("cc").args(["-shared", "-fPIC", "-o", &library, &source]).status().unwrap();
    assert!(built.success());
    let mut command = Command::new(env!("CARGO_BIN_EXE_stickslip"));
    command.env("OPENBLAS_CORETYPE", "Prescott").env("LD_PRELOAD", library);
    command
}

/// Returns the report of a run on a kernel that the user has chosen and that is not the best; `None` if kernels cannot
/// be selected.
pub fn on_a_slow_kernel() -> Option<Value> {
    best()?;
    let (_folder, scene) = Folder::with_scene(&small());
    let mut command = Command::new(env!("CARGO_BIN_EXE_stickslip"));
    let output = command.args(["run", &scene, "--json"]).env("OPENBLAS_CORETYPE", "Prescott").output().unwrap();
    assert_exit(&output, 0);
    Some(json(&output))
}

fn warns(report: &Value) -> bool {
    report["warnings"].as_array().unwrap().iter().any(|warning| warning["kind"] == "slow-blas")
}

#[test]
fn a_kernel_that_the_user_chose_stays_and_is_told() {
    let (Some(best), Some(report)) = (best(), on_a_slow_kernel()) else { return };
    let blas = &report["blas"];
    let reported = ["library", "kernel", "kernel_asked"].map(|key| blas[key].as_str().unwrap());
    assert_eq!(reported, ["OpenBLAS", "Prescott", "Prescott"]);
    assert_eq!(blas["better_kernel"], best.to_ascii_uppercase());
    assert!(warns(&report), "{report}");
    let (_folder, scene) = Folder::with_scene(&small());
    let mut command = Command::new(env!("CARGO_BIN_EXE_stickslip"));
    let output = command.args(["run", &scene]).env("OPENBLAS_CORETYPE", "prescott").output().unwrap();
    let cure = format!("set OPENBLAS_CORETYPE={} in", best.to_ascii_uppercase());
    let words = unbroken(&output);
    assert!(words.contains("with the kernel Prescott") && words.contains(&cure), "{words}");
}

/// The program of an OpenBLAS that does not know the processor computes what it computes on the right kernel from the
/// start, to the last bit. So do the processes of a sweep.
#[test]
fn an_openblas_that_does_not_know_the_processor_is_put_right() {
    let Some(best) = best() else { return };
    let (folder, scene) = Folder::with_scene(&small());
    let output = on_an_old_kernel(&folder).args(["run", &scene, "--json"]).output().unwrap();
    assert_exit(&output, 0);
    let put_right = json(&output);
    assert_eq!(put_right["blas"]["kernel"], best, "{}", put_right["blas"]);
    assert!(!warns(&put_right) && put_right["blas"].get("better_kernel").is_none());
    let mut command = Command::new(env!("CARGO_BIN_EXE_stickslip"));
    let from_the_start = command.args(["run", &scene, "--json"]).env("OPENBLAS_CORETYPE", best).output().unwrap();
    assert_eq!(put_right["forces"], json(&from_the_start)["forces"]);

    let out = folder.join("out");
    let sweep = ["sweep", &scene, "--vary", "contact.friction=0.2,0.4", "--out", &out];
    assert_exit(&on_an_old_kernel(&folder).args(sweep).output().unwrap(), 0);
    let variants = folder.names("out/variants");
    assert_eq!(variants.len(), 2);
    for variant in variants {
        let text = fs::read_to_string(folder.join(&format!("out/variants/{variant}/run.json"))).unwrap();
        assert_eq!(serde_json::from_str::<Value>(&text).unwrap()["blas"]["kernel"], best);
    }
}

/// A comparison reports the kernel for its times.
#[test]
fn a_comparison_names_the_kernel() {
    let (folder, scene) = Folder::with_scene(&small());
    let out = folder.join("out");
    let more = ["--methods", "bn", "--solvers", "condensed", "--meshes", "4", "--increments", "1", "--reference", "2"];
    let blas = Blas::loaded().unwrap();
    let mut program = Command::new(env!("CARGO_BIN_EXE_stickslip"));
    program.args(["compare", &scene, "--out", &out]).args(more);
    let output = program.envs(blas.kernel.as_ref().map(|kernel| ("OPENBLAS_CORETYPE", kernel))).output().unwrap();
    assert_exit(&output, 0);
    let named =
        |text: &str| text.contains(blas.library) && blas.kernel.as_ref().is_none_or(|kernel| text.contains(kernel));
    assert!(named(stdout(&output)), "{}", stdout(&output));
    for file in ["compare.md", "compare.csv"] {
        let text = fs::read_to_string(folder.join(&format!("out/{file}"))).unwrap();
        assert!(named(&text), "{file}: {text}");
    }
}
