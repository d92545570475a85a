//! `stickslip solve`, `judge`, `collection` and `export`, as called by a user.

#![allow(clippy::unwrap_used)]

use std::fs;
use std::path::Path;
use std::process::Command;

use crate::common::skipped;
use crate::program::{Folder, assert_exit, csv, json, small, stderr, stdout, stickslip};

fn problem(name: &str) -> String {
    Path::new(concat!(env!("CARGO_MANIFEST_DIR"), "/../..")).join("data/problems").join(name).display().to_string()
}

/// A name that refers to another name, which is not there.
#[test]
fn a_link_that_leads_nowhere_is_refused() {
    let folder = Folder::new();
    let linked = folder.join("linked.hdf5");
    let mut bytes = fs::read(problem("local.hdf5")).unwrap();
    let lists: Vec<usize> = (0..bytes.len()).filter(|at| bytes[*at..].starts_with(b"SNOD")).collect();
    assert!(!lists.is_empty());
    for list in lists {
        // Each entry of a list of names has 40 bytes; its type follows two addresses.
        (0..usize::from(bytes[list + 6])).for_each(|entry| bytes[list + 8 + 40 * entry + 16] = 2);
    }
    fs::write(&linked, bytes).unwrap();
    let refused = stickslip(&["solve", &linked]);
    assert_exit(&refused, 2);
    let message = stderr(&refused).split_whitespace().filter(|word| *word != "│").collect::<Vec<_>>().join(" ");
    assert!(
        message.contains("dataset fclib_") && message.contains("out of bounds help: fetch or write the file again"),
        "{message}"
    );
}

#[test]
fn a_problem_is_solved_and_its_file_judged() {
    let folder = Folder::new();
    let out = folder.join("solved.hdf5");
    let solved = stickslip(&["solve", &problem("global.hdf5"), "--out", &out]);
    assert_exit(&solved, 0);
    let text = stdout(&solved);
    assert!(text.contains("Two masses\nproblem      global, 2 contacts in space, 6 unknowns of bodies"), "{text}");
    assert!(text.contains("verdict      solved: residual") && text.contains("stage "), "{text}");
    let judged = stickslip(&["judge", &out]);
    assert_exit(&judged, 0);
    assert!(!stdout(&judged).contains("stage "), "{}", stdout(&judged));
    assert_exit(&stickslip(&["judge", &problem("global.hdf5"), &out]), 0);

    // The solution of another problem is no solution of this one.
    let wrong = stickslip(&["judge", &problem("blocks.dat"), &out]);
    assert_exit(&wrong, 1);
    let text = stdout(&wrong);
    assert!(text.contains("verdict      not solved") && text.contains("the worst contact has number"), "{text}");
    let other = stickslip(&["judge", &problem("printed.dat"), &out]);
    assert_exit(&other, 2);
    assert!(stderr(&other).replace("\n  │ ", " ").contains("it has 6 entries"), "{}", stderr(&other));
}

#[test]
fn what_cannot_be_read_has_one_message() {
    let folder = Folder::new();
    let bad = folder.join("bad.dat");
    fs::write(&bad, "2 1 0 2 2\n2 2 1 x").unwrap();
    let link = folder.join("link.hdf5");
    std::os::unix::fs::symlink(&bad, &link).unwrap();
    for (args, words) in [
        (
            vec!["solve", &problem("local.hdf5"), "--out", &folder.join("bad.dat/x.hdf5")],
            "its folder cannot be created",
        ),
        (vec!["solve", &problem("local.hdf5"), "--out", &link], "it exists and is no regular file"),
        (vec!["solve", &bad], "line 2: expected the entries of a matrix"),
        (vec!["judge", &problem("sliding.dat")], "the file contains no solution"),
        (vec!["judge", &problem("sliding.dat"), &bad], "it is neither HDF5 nor a text"),
        (vec!["solve", &folder.join("none.dat")], "the problem cannot be read"),
        (vec!["solve", &problem("local.hdf5"), "--guess", "2"], "there is no guess 2, but only 1"),
        (vec!["collection", &folder.join("none")], "the folder cannot be read"),
    ] {
        let output = stickslip(&args);
        assert_exit(&output, 2);
        assert!(stderr(&output).replace("\n  │ ", " ").contains(words), "{args:?}: {}", stderr(&output));
        let output = stickslip(&[&args[..], &["--json"]].concat());
        assert_exit(&output, 2);
        assert_eq!(json(&output)["status"], "bad-input");
    }
}

#[test]
fn a_folder_is_told_row_by_row() {
    let (folder, out) = (Folder::new(), Folder::new());
    for name in ["sliding.dat", "global.hdf5"] {
        fs::copy(problem(name), folder.join(name)).unwrap();
    }
    let args = ["collection", &folder.join(""), "--out", &out.join(""), "--compare", "--threads", "2"];
    let output = stickslip(&args);
    assert_exit(&output, 0);
    assert!(stdout(&output).contains("verdict      2 of 2 problems solved"), "{}", stdout(&output));
    let (header, rows) = csv(&out.0.join("collection.csv"));
    assert!(header.starts_with("file,way,form"));
    // The uncondensed system has no local problem.
    let ways = ["default", "whole", "contacts", "newton", "sweeps", "default", "contacts", "newton", "sweeps"];
    assert_eq!(rows.iter().map(|row| row[1].as_str()).collect::<Vec<_>>(), ways);
    assert!(fs::read_to_string(out.0.join("profile.svg")).unwrap().starts_with("<svg"));
    assert!(fs::read_to_string(out.0.join("profile.csv")).unwrap().starts_with("solver,ratio,share\n"));

    fs::write(folder.join("bad.dat"), "5").unwrap();
    fs::write(folder.join("README"), "not a problem").unwrap();
    let output = stickslip(&["collection", &folder.join("")]);
    assert_exit(&output, 2);
    let text = stdout(&output);
    assert!(
        text.contains("bad-input") && text.contains("line 1: the dimension is 5") && text.contains("1 other files"),
        "{text}"
    );
}

/// The last increment of a scene is exported, read and solved.
#[test]
fn an_increment_is_exported() {
    let (folder, scene) = Folder::with_scene(&small());
    let [global, local] = ["global.hdf5", "local.hdf5"].map(|name| folder.join(name));
    assert_exit(&stickslip(&["export", &scene, "--increment", "3", "--out", &global]), 0);
    let output = stickslip(&["export", &scene, "--form", "local", "--out", &local]);
    assert_exit(&output, 0);
    assert!(stdout(&output).contains("increment 4 of 4\nproblem      local, 4 contacts"), "{}", stdout(&output));
    for file in [&global, &local] {
        assert_exit(&stickslip(&["judge", file]), 0);
        assert_exit(&stickslip(&["solve", file, "--guess", "1"]), 0);
    }
    let output = stickslip(&["export", &scene, "--increment", "9", "--out", &global]);
    assert_exit(&output, 2);
    assert!(stderr(&output).contains("increment 9 is asked for, but the scene has 4"), "{}", stderr(&output));
    let output = stickslip(&["export", &scene, "--set", "solver.max_iterations=1", "--out", &folder.join("no.hdf5")]);
    assert!([1, 2].contains(&output.status.code().unwrap()), "{}", stderr(&output));
}

/// h5dump shows the documented content of FCLIB.
#[test]
fn hdf5_tools_read_what_is_written() {
    let (folder, scene) = Folder::with_scene(&small());
    let file = folder.join("exported.hdf5");
    assert_exit(&stickslip(&["export", &scene, "--out", &file]), 0);
    let Ok(dump) = Command::new("h5dump").args(["-n", "1", &file]).output() else {
        skipped("there is no h5dump");
        return;
    };
    assert!(dump.status.success(), "{}", stderr(&dump));
    let of = |kind: &str| -> Vec<String> {
        let lines = stdout(&dump).lines().filter_map(|line| line.trim().strip_prefix(kind));
        lines.map(|path| path.trim().to_string()).collect()
    };
    let groups = ["", "fclib_global", "fclib_global/H", "fclib_global/M", "fclib_global/info", "fclib_global/vectors"];
    let groups = groups.iter().chain(&["guesses", "guesses/1", "solution"]).map(|name| format!("/{name}"));
    assert_eq!(of("group"), groups.collect::<Vec<_>>());
    let datasets = of("dataset");
    for name in [
        "H/i",
        "H/m",
        "H/n",
        "H/nz",
        "H/nzmax",
        "H/p",
        "H/x",
        "M/x",
        "spacedim",
        "vectors/f",
        "vectors/mu",
        "vectors/w",
    ] {
        assert!(datasets.contains(&format!("/fclib_global/{name}")), "{name}: {datasets:?}");
    }
    for name in ["guesses/number_of_guesses", "guesses/1/v", "solution/r", "solution/u", "solution/v"] {
        assert!(datasets.contains(&format!("/{name}")), "{name}: {datasets:?}");
    }
    let dump = Command::new("h5dump").args(["-d", "/fclib_global/vectors/mu", &file]).output().unwrap();
    assert!(
        stdout(&dump).contains("H5T_IEEE_F64LE") && stdout(&dump).contains("0.4, 0.4, 0.4, 0.4"),
        "{}",
        stdout(&dump)
    );
}

const READER: &str = r#"
#include <stdio.h>
#include <fclib.h>
int main(int n, char **path) {
    struct fclib_global *p = fclib_read_global(path[1]);
    struct fclib_solution *s = fclib_read_solution(path[1]);
    int guesses = 0;
    struct fclib_solution *g = fclib_read_guesses(path[1], &guesses);
    if (n != 2 || !p || !s || !g) return 1;
    /* M v - f - H r, all in compressed columns. */
    double left[1000] = {0}, most = 0;
    for (int j = 0; j < p->M->n; j++)
        for (int k = p->M->p[j]; k < p->M->p[j + 1]; k++) left[p->M->i[k]] += p->M->x[k] * s->v[j];
    for (int j = 0; j < p->H->n; j++)
        for (int k = p->H->p[j]; k < p->H->p[j + 1]; k++) left[p->H->i[k]] -= p->H->x[k] * s->r[j];
    for (int i = 0; i < p->M->m; i++) {
        double d = left[i] - p->f[i];
        if (d < 0) d = -d;
        if (d > most) most = d;
    }
    printf("%d %d %d %d %s|%.17g\n", p->spacedim, p->M->m, p->H->n, guesses, p->info->title, most);
    return 0;
}
"#;

/// FCLIB's own reader accepts the file, and its solution is in equilibrium.
#[test]
fn fclib_reads_what_is_written() {
    let (folder, scene) = Folder::with_scene(&small());
    let file = folder.join("exported.hdf5");
    assert_exit(&stickslip(&["export", &scene, "--out", &file]), 0);
    let [source, program] = ["reader.c", "reader"].map(|name| folder.join(name));
    fs::write(&source, READER).unwrap();
    let built = Command::new("cc").args([&source, "-o", &program, "-lfclib"]).output();
    if !built.is_ok_and(|built| built.status.success()) {
        skipped("there is no FCLIB to build with");
        return;
    }
    let read = Command::new(&program).arg(&file).output().unwrap();
    assert!(read.status.success(), "{}{}", stdout(&read), stderr(&read));
    let (head, left) = stdout(&read).trim().rsplit_once('|').unwrap();
    assert!(head.starts_with("2 40 8 1 ") && head.ends_with("increment 4 of 4"), "{head}");
    // The loads are of the order of 1e6 N.
    assert!(left.parse::<f64>().unwrap() < 1e-3, "{left}");
}
