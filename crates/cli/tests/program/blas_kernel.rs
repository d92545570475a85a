//! The kernel of OpenBLAS: the program uses and reports the right one, however it was chosen.

#![cfg(feature = "blas")]
#![allow(clippy::unwrap_used)]

use std::ffi::{OsStr, OsString};
use std::fs;
use std::io::Write;
use std::os::unix::ffi::OsStringExt;
use std::os::unix::process::CommandExt;
use std::path::{Path, PathBuf};
use std::process::{Command, Output, Stdio};

use serde_json::Value;
use stickslip::algebra::linear::blas::{Blas, Vectors, better_kernel, kernel_names, may_run_here};

use crate::common::skipped;
use crate::program::{Folder, assert_exit, json, send, small, stderr, stdout};

/// Returns the program without kernel variables in its environment.
fn stickslip() -> Command {
    let mut command = Command::new(env!("CARGO_BIN_EXE_stickslip"));
    command.env_remove("OPENBLAS_CORETYPE").env_remove("STICKSLIP_BLAS_KERNEL");
    command
}

/// Returns `true` if kernels can be selected. Otherwise the tests print that they are skipped.
fn selectable() -> bool {
    let selectable = Blas::loaded().unwrap().selectable && Vectors::of_processor() >= Some(Vectors::Avx2);
    if !selectable {
        skipped("there are no kernels to choose among");
    }
    selectable
}

fn run(scene: &str, environment: &[(&str, &str)], args: &[&str]) -> Output {
    stickslip().args(["run", scene]).args(args).envs(environment.iter().copied()).output().unwrap()
}

/// Returns the entry of `run.json` for the BLAS.
fn blas(scene: &str, environment: &[(&str, &str)], args: &[&str]) -> Value {
    let output = run(scene, environment, &[&["--json"], args].concat());
    assert_exit(&output, 0);
    json(&output)["blas"].clone()
}

/// Returns the report of a run that restarted for a kernel that is still not the best; `None` if kernels cannot be
/// selected.
pub fn started_again() -> Option<Value> {
    let (_folder, scene) = Folder::with_scene(&small());
    let environment = [("OPENBLAS_CORETYPE", "Prescott")];
    selectable().then(|| json(&run(&scene, &environment, &["--json", "--blas-kernel", "Nehalem"])))
}

fn warns(report: &Value) -> bool {
    report["warnings"].as_array().unwrap().iter().any(|warning| warning["kind"] == "slow-blas")
}

#[test]
fn a_kernel_that_the_user_chose_stays_and_is_told() {
    if !selectable() {
        return;
    }
    let (_folder, scene) = Folder::with_scene(&small());
    let better = better_kernel("Prescott", Vectors::of_processor()).unwrap();
    for (asked, args) in
        [("Prescott", &[][..]), ("PRESCOTT", &["--blas-kernel", "auto"]), ("prescott", &["--blas-kernel", "keep"])]
    {
        let output = run(&scene, &[("OPENBLAS_CORETYPE", asked)], &[&["--json"], args].concat());
        assert_exit(&output, 0);
        let report = json(&output);
        let blas = &report["blas"];
        assert_eq!(
            (&blas["library"], &blas["kernel"], &blas["kernel_asked"]),
            (&"OpenBLAS".into(), &"Prescott".into(), &asked.into())
        );
        assert_eq!(blas["better_kernel"], better);
        assert!(blas.get("kernel_before").is_none() && warns(&report), "{blas}");
        let output = run(&scene, &[("OPENBLAS_CORETYPE", asked)], args);
        let cure = format!("select the kernel {better}");
        assert!(
            stdout(&output).contains("with the kernel Prescott") && stdout(&output).contains(&cure),
            "{}",
            stdout(&output)
        );
        assert!(!stdout(&output).contains("restarted itself"));
    }
}

#[test]
fn the_program_starts_again_for_a_kernel_that_is_named() {
    if !selectable() {
        return;
    }
    let (_folder, scene) = Folder::with_scene(&small());
    let prescott = ("OPENBLAS_CORETYPE", "Prescott");
    let ours = |name| ("STICKSLIP_BLAS_KERNEL", name);
    // The option takes precedence over our variable, and both over that of OpenBLAS.
    for (environment, args) in [
        (&[prescott][..], &["--blas-kernel", "HASWELL"][..]),
        (&[prescott, ours("haswell")], &[]),
        (&[prescott, ours("Nehalem")], &["--blas-kernel", "Haswell"]),
    ] {
        let blas = blas(&scene, environment, args);
        assert_eq!((&blas["kernel"], &blas["kernel_before"]), (&"Haswell".into(), &"Prescott".into()), "{blas}");
    }
    for (environment, args) in
        [(&[prescott, ours("")][..], &[][..]), (&[prescott, ours("Haswell")], &["--blas-kernel", "keep"])]
    {
        assert_eq!(blas(&scene, environment, args)["kernel"], "Prescott");
    }
    let output = run(&scene, &[prescott], &["--blas-kernel", "HASWELL"]);
    let told = "with the kernel Haswell, for which the program restarted itself: the library had chosen Prescott";
    assert!(stdout(&output).contains(told), "{}", stdout(&output));
    // The running kernel needs no restart.
    assert!(
        blas(&scene, &[("OPENBLAS_CORETYPE", "Haswell")], &["--blas-kernel", "HASWELL"]).get("kernel_before").is_none()
    );
}

#[test]
fn a_kernel_that_there_is_none_of_is_status_2() {
    if !selectable() {
        return;
    }
    let (_folder, scene) = Folder::with_scene(&small());
    for args in [&["--blas-kernel", "Pentium9"][..], &["--blas-kernel", "Pentium9", "--json"]] {
        let output = run(&scene, &[], args);
        assert_exit(&output, 2);
        assert!(stderr(&output).contains("Pentium9") && stderr(&output).contains("Haswell"), "{}", stderr(&output));
        if args.contains(&"--json") {
            assert_eq!(json(&output)["status"], "bad-input");
        }
    }
    // A kernel that would crash the program is never requested.
    for kernel in kernel_names().filter(|kernel| !may_run_here(kernel)) {
        let output = run(&scene, &[], &["--blas-kernel", kernel]);
        assert_exit(&output, 2);
        assert!(stderr(&output).contains("this processor cannot run it"), "{}", stderr(&output));
    }
    assert_exit(&run(&scene, &[], &["--blas-kernel", "KEEP"]), 0);
    // Commands that solve nothing need no kernel.
    let checked = stickslip().args(["check", &scene, "--blas-kernel", "Pentium9"]).output().unwrap();
    assert_exit(&checked, 0);
}

/// Builds a library that reports kernels like an OpenBLAS that does not know this processor: `first`, until another one
/// is requested. It knows only the kernels `known`, and falls back to Prescott for others.
fn old_openblas(folder: &Folder, first: &str, known: &str) -> PathBuf {
    let source = r#"
use std::ffi::{c_char, CString};
#[no_mangle]
pub extern "C" fn openblas_get_corename() -> *const c_char {
    let name = match std::env::var("OPENBLAS_CORETYPE") {
        Err(_) => "FIRST".to_string(),
        Ok(name) if name == "KNOWN" => name,
        Ok(_) => "Prescott".to_string(),
    };
    CString::new(name).unwrap().into_raw()
}
"#;
    let (source_file, library) = (folder.join("old.rs"), folder.join("libold.so"));
    fs::write(&source_file, source.replace("FIRST", first).replace("KNOWN", known)).unwrap();
    let rustc = std::env::var_os("RUSTC").unwrap_or_else(|| "rustc".into());
    let built = Command::new(rustc).args(["--crate-type", "cdylib", "-o", &library, &source_file]).output().unwrap();
    assert!(built.status.success(), "{}", stderr(&built));
    library.into()
}

#[test]
fn an_openblas_that_does_not_know_the_processor_is_put_right_once() {
    if !selectable() {
        return;
    }
    let (folder, scene) = Folder::with_scene(&small());
    let better = better_kernel("Prescott", Vectors::of_processor()).unwrap();
    let old = old_openblas(&folder, "Prescott", better);
    let with_old = |args: &[&str]| stickslip().env("LD_PRELOAD", &old).args(args).output().unwrap();
    let report = |args: &[&str]| json(&with_old(&[&["run", &scene, "--json"], args].concat()));

    let put_right = report(&[]);
    assert_eq!(
        (&put_right["blas"]["kernel"], &put_right["blas"]["kernel_before"]),
        (&better.into(), &"Prescott".into())
    );
    assert!(!warns(&put_right));
    let kept = report(&["--blas-kernel", "keep"]);
    assert_eq!((&kept["blas"]["kernel"], &kept["blas"]["better_kernel"]), (&"Prescott".into(), &better.into()));
    assert!(warns(&kept) && kept["blas"].get("kernel_asked").is_none());
    // Each kernel rounds differently, and results agree to rounding. Exit statuses are those of the run.
    for sum in ["sum_p_n", "sum_p_t"] {
        let [kept, put_right] = [&kept, &put_right].map(|report| report["final"][sum].as_f64().unwrap());
        assert!((kept - put_right).abs() <= 1e-12 * kept.abs(), "{sum}: {kept} {put_right}");
    }
    assert_exit(&with_old(&["run", &folder.join("none.toml")]), 2);
    assert_exit(&with_old(&["run", &scene, "--set", "solver.max_iterations=1"]), 1);

    // A library that falls back further for an unknown name is restarted without a name, only once.
    let old = old_openblas(&folder, "Sandybridge", "none");
    let output = stickslip().env("LD_PRELOAD", &old).args(["run", &scene, "--json"]).output().unwrap();
    assert_exit(&output, 0);
    let (left, report) = (json(&output)["blas"].clone(), json(&output));
    assert_eq!(left["kernel"], "Sandybridge");
    assert!(left.get("kernel_asked").is_none() && left.get("kernel_before").is_none() && warns(&report), "{left}");
}

/// The scene comes from standard input, and the name of the result folder is not UTF-8. Both survive the restart.
#[test]
fn everything_is_passed_on() {
    if !selectable() {
        return;
    }
    let folder = Folder::new();
    let out = Path::new(&folder.join("")).join(OsString::from_vec(b"r\xff".to_vec()));
    let mut child = stickslip()
        .env("OPENBLAS_CORETYPE", "Prescott")
        .args(["run", "/dev/stdin", "--json", "--blas-kernel", "HASWELL", "--out"].map(OsStr::new))
        .arg(&out)
        .stdin(Stdio::piped())
        .stdout(Stdio::piped())
        .spawn()
        .unwrap();
    child.stdin.take().unwrap().write_all(small().as_bytes()).unwrap();
    let output = child.wait_with_output().unwrap();
    assert_exit(&output, 0);
    assert_eq!(json(&output)["blas"]["kernel"], "Haswell");
    assert!(out.join("run.json").is_file());
}

/// The process keeps its number and its name, so that Ctrl-C reaches it.
#[test]
fn ctrl_c_reaches_the_program_that_started_again() {
    if !selectable() {
        return;
    }
    let (folder, scene) = Folder::with_scene(&small());
    let child = stickslip()
        .arg0("block-at-work")
        .env("OPENBLAS_CORETYPE", "Prescott")
        .args(["run", &scene, "--out", &folder.join("results"), "--blas-kernel", "HASWELL"])
        .args(["--setting", "default", "--set", "mesh.elements=[60,60]", "--set", "time.increments=4000"])
        .stdout(Stdio::piped())
        .spawn()
        .unwrap();
    let lines = || fs::read_to_string(folder.join("results/increments.csv")).map_or(0, |text| text.lines().count());
    while lines() < 4 {
        std::thread::sleep(std::time::Duration::from_millis(10));
    }
    if let Ok(command) = fs::read_to_string(format!("/proc/{}/cmdline", child.id())) {
        assert!(command.starts_with("block-at-work\0run\0"), "{command:?}");
    }
    send("INT", child.id());
    let output = child.wait_with_output().unwrap();
    assert_exit(&output, 1);
    assert!(stdout(&output).contains("verdict      interrupted"), "{}", stdout(&output));
    let report: Value = serde_json::from_str(&fs::read_to_string(folder.join("results/run.json")).unwrap()).unwrap();
    assert_eq!((&report["blas"]["kernel"], &report["blas"]["kernel_before"]), (&"Haswell".into(), &"Prescott".into()));
}

/// A sweep restarts once. Its processes find the kernel in their environment.
#[test]
fn the_processes_of_a_sweep_have_its_kernel() {
    if !selectable() {
        return;
    }
    let (folder, scene) = Folder::with_scene(&small());
    let out = folder.join("out");
    let output = stickslip()
        .env("OPENBLAS_CORETYPE", "Prescott")
        .args(["sweep", &scene, "--vary", "contact.friction=0.2,0.4", "--out", &out, "--blas-kernel", "HASWELL"])
        .output()
        .unwrap();
    assert_exit(&output, 0);
    let variants = folder.names("out/variants");
    assert_eq!(variants.len(), 2);
    for variant in variants {
        let text = fs::read_to_string(folder.join(&format!("out/variants/{variant}/run.json"))).unwrap();
        let blas = serde_json::from_str::<Value>(&text).unwrap()["blas"].clone();
        assert_eq!((&blas["kernel"], &blas["kernel_asked"]), (&"Haswell".into(), &"HASWELL".into()), "{blas}");
        assert!(blas.get("kernel_before").is_none(), "{blas}");
    }
}

/// A comparison reports the kernel for its times.
#[test]
fn a_comparison_names_the_kernel() {
    let (folder, scene) = Folder::with_scene(&small());
    let out = folder.join("out");
    let more = ["--methods", "bn", "--solvers", "condensed", "--meshes", "4", "--increments", "1", "--reference", "2"];
    // Compares with the kernel of this process.
    let mut program = Command::new(env!("CARGO_BIN_EXE_stickslip"));
    let output = program.args(["compare", &scene, "--blas-kernel", "keep", "--out", &out]).args(more).output().unwrap();
    assert_exit(&output, 0);
    let blas = Blas::loaded().unwrap();
    let named =
        |text: &str| text.contains(blas.library) && blas.kernel.as_ref().is_none_or(|kernel| text.contains(kernel));
    assert!(named(stdout(&output)), "{}", stdout(&output));
    for file in ["compare.md", "compare.csv"] {
        let text = fs::read_to_string(folder.join(&format!("out/{file}"))).unwrap();
        assert!(named(&text), "{file}: {text}");
    }
}
