//! Options of PETSc in a scene: what they print, and how a wrong one ends.

use std::process::Command;

use crate::job::{Job, PROGRAM, without_ours};
use crate::scenes::path;

/// Runs a small cube with these options. Returns the status, the output, and the error without its line breaks.
fn run(linear: &str, options: &str) -> (Option<i32>, String, String) {
    let mut command = Command::new(PROGRAM);
    without_ours(&mut command);
    command.args(["run", &path("cube"), "--solver", linear, "--set", "mesh.elements=[4,4,4]"]);
    command.args(["--set", "time.increments=1", "--set", &format!("solver.petsc={options:?}")]);
    let output = command.output().unwrap();
    let [text, error] = [output.stdout, output.stderr].map(|text| String::from_utf8_lossy(&text).into_owned());
    (output.status.code(), text, error.split_whitespace().filter(|word| *word != "│").collect::<Vec<_>>().join(" "))
}

#[test]
fn petsc_prints_what_it_is_asked_for() {
    let (status, text, error) = run("petsc", "-ksp_monitor -ksp_view -log_view");
    assert_eq!(status, Some(0), "{error}");
    for words in ["KSP Residual norm", "type: composite", "type: gamg", "\nKSPSolve ", "verdict      converged"] {
        assert!(text.contains(words), "{words}: {text}");
    }
    // Without the elimination of contact, by a factorisation.
    let (status, text, error) = run("petsc", "-pc_type lu -pc_factor_mat_solver_type mumps -ksp_view");
    assert_eq!(status, Some(0), "{error}");
    assert!(text.contains("type: mumps") && !text.contains("type: composite"), "{text}");
}

#[test]
fn wrong_options_have_their_cure() {
    for (options, expected, words) in [
        ("-ksp_type nonsense", 2, ["nonsense", "solver.petsc"]),
        ("-contact_pc_type nonsense", 2, ["nonsense", "solver.petsc"]),
        ("-ksp_rtoll 1e-3", 2, ["does not know -ksp_rtoll", "solver.petsc"]),
        ("-ksp_max_it many", 2, ["many has no integer value", "solver.petsc"]),
        ("-ksp_max_it 2", 3, ["did not converge in 2 iterations", "-ksp_max_it"]),
    ] {
        let (status, _, error) = run("petsc", options);
        assert_eq!(status, Some(expected), "{error}");
        assert!(words.iter().all(|words| error.contains(words)), "{error}");
    }
    // The launcher returns the status of the process that ends first.
    let wrong = ["--set", "mesh.elements=[4,4,4]", "--set", "solver.petsc='-ksp_max_it many'"];
    let ended = Job::start(2, &[&["run", &path("cube"), "--solver", "petsc"][..], &wrong].concat()).end();
    assert_eq!(ended.status, Some(2), "{}", ended.error);
    let (status, _, error) = run("mumps", "-ksp_monitor");
    assert_eq!(status, Some(2), "{error}");
    assert!(error.contains("add solver.linear = \"petsc\""), "{error}");
}
