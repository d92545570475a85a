//! First steps of a new user: example scenes, completions for a shell, manual pages.

#![allow(clippy::unwrap_used)]

use std::f64::consts::PI;
use std::fs;
use std::path::Path;

use crate::program::{Folder, assert_exit, csv, json, number, stderr, stdout, stickslip, unbroken};

const ABAQUS: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/../../doc/howto/abaqus/two_blocks.inp");

/// Every example scene converges, has warnings only of mesh errors, and uses the default constants.
#[test]
fn starting_scenes_run() {
    for (kind, files) in [
        ("block", &["block.toml"][..]),
        ("cube", &["cube.toml"]),
        ("gmsh", &["roller.geo", "roller.msh", "roller.toml"]),
    ] {
        let folder = Folder::new();
        let into = folder.join("new/start");
        assert_exit(&stickslip(&["init", kind, "--out", &into]), 0);
        assert_eq!(folder.names("new/start"), files);
        let scene = Path::new(&into).join(files[files.len() - 1]);
        let text = fs::read_to_string(&scene).unwrap();
        assert!(!text.contains("setting") && !text.contains("paper"), "{kind}");

        let printed = stickslip(&["init", kind]);
        assert_exit(&printed, 0);
        assert_eq!(stdout(&printed), text);
        assert_eq!(stderr(&printed).contains("roller.geo"), kind == "gmsh", "{}", stderr(&printed));

        let run = stickslip(&["run", scene.to_str().unwrap(), "--set", "time.increments=4"]);
        assert_exit(&run, 0);
        let warned = unbroken(&run).lines().filter(|line| line.starts_with("warning")).all(|line| {
            // The few increments cause warnings too.
            let of_increments = ["because of the increments", "nodes begin to stick", "time-step error"];
            ["singular", "stick zone", "slip zones", "the mesh is coarse", "strains are assumed to be small"]
                .iter()
                .chain(&of_increments)
                .any(|words| line.contains(words))
        });
        assert!(warned, "{}", stdout(&run));

        let again = stickslip(&["init", kind, "--out", &into]);
        assert_exit(&again, 2);
        assert!(stderr(&again).contains("already exists"), "{}", stderr(&again));
    }
}

#[test]
fn scenes_to_start_from_are_listed_and_checked() {
    let listed = stickslip(&["init"]);
    assert_exit(&listed, 0);
    let kinds: Vec<&str> = stdout(&listed).lines().filter_map(|line| line.split_whitespace().next()).collect();
    let joints = ["two-bodies", "bolt", "press-fit", "fretting", "rough", "lap-joint"];
    assert_eq!(kinds, [&["block", "gmsh", "cube"][..], &joints, &["tutorials", "abaqus"]].concat());
    for kind in kinds {
        let folder = Folder::new();
        let out = folder.join("");
        let (out, file) = (["--out", &*out], [ABAQUS]);
        let file = if kind == "abaqus" { &file[..] } else { &[] };
        assert_exit(&stickslip(&[&["init", kind][..], file, &out].concat()), 0);
        let names = folder.names("");
        let scenes =
            names.iter().filter(|name| Path::new(name).extension().is_some_and(|extension| extension == "toml"));
        let checked = scenes.map(|scene| assert_exit(&stickslip(&["check", &folder.join(scene)]), 0)).count();
        assert!(checked > 0);
        if kind == "tutorials" {
            let there = fs::read_dir(concat!(env!("CARGO_MANIFEST_DIR"), "/../../data/tutorials")).unwrap();
            assert_eq!(names.len(), there.count(), "a file of the tutorials is not written: {names:?}");
        }
    }
}

/// The scene of an input file runs as the one that was written by hand; what is not converted is named in it.
#[test]
fn an_input_file_becomes_a_scene() {
    let folder = Folder::new();
    let out = folder.join("new");
    assert_exit(&stickslip(&["init", "abaqus", ABAQUS, "--out", &out]), 0);
    let [found, expected] =
        [Path::new(&out).join("two_blocks.toml"), Path::new(ABAQUS).with_extension("toml")].map(|file| {
            let output = stickslip(&["run", file.to_str().unwrap(), "--json", "--set", "mesh.element=bilinear"]);
            assert_exit(&output, 0);
            number(&json(&output)["largest_force"]["magnitude"])
        });
    assert!((found / expected - 1.0).abs() < 1e-12, "{found} {expected}");
    let folder = Folder::new();
    let file = folder.join("part.inp");
    let text = fs::read_to_string(ABAQUS).unwrap().replace("*STATIC\n", "*CLOAD\nLOAD, 1, 5.\n*STATIC\n");
    fs::write(&file, text).unwrap();
    let printed = stickslip(&["init", "abaqus", &file]);
    assert!(stdout(&printed).ends_with("\n# *CLOAD: LOAD, 1, 5.\n"), "{}", stdout(&printed));
    for wrong in [&["init", "abaqus"][..], &["init", "block", &file], &["init", "abaqus", "missing.inp"]] {
        assert_exit(&stickslip(wrong), 2);
    }
}

/// The roller of doc/howto/gmsh.md agrees with Hertz' line contact on a rigid plane, for its force.
#[test]
fn the_roller_has_hertz_pressure() {
    let folder = Folder::new();
    assert_exit(&stickslip(&["init", "gmsh", "--out", &folder.join("")]), 0);
    let pressure = |friction: &str| {
        let (scene, out) = (folder.join("roller.toml"), folder.join("out"));
        let options = ["--set", "time.increments=4", "--set", friction, "--out", &out];
        assert_exit(&stickslip(&[&["run", &scene][..], &options].concat()), 0);
        let (header, rows) = csv(&Path::new(&out).join("contact_0002.csv"));
        let column = |name: &str| {
            let k = header.split(',').position(|column| column == name).unwrap();
            rows.iter().map(|row| row[k].parse::<f64>().unwrap()).collect::<Vec<_>>()
        };
        let (x, p_n) = (column("x"), column("p_n"));
        let force: f64 = p_n.iter().sum();
        let (radius, stiffness) = (0.02, 3e9 / (1.0 - 0.4_f64 * 0.4));
        let a = (4.0 * force * radius / (PI * stiffness)).sqrt();
        let peak = column("sigma_n").into_iter().fold(0.0, f64::max) / (2.0 * force / (PI * a));
        // The second moment of Hertz' pressure is P a² / 4.
        let second: f64 = x.iter().zip(&p_n).map(|(x, p)| x * x * p).sum();
        [peak - 1.0, 2.0 * (second / force).sqrt() / a - 1.0]
    };
    let [peak, width] = pressure("contact.friction=0");
    assert!(peak.abs() < 0.012 && width.abs() < 0.012, "{peak} {width}");
    // Friction prevents the roller from spreading, which concentrates the pressure.
    let [peak, width] = pressure("contact.friction=0.3");
    assert!((0.015..0.035).contains(&peak) && (-0.035..-0.015).contains(&width), "{peak} {width}");
}

#[test]
fn shells_and_manuals_know_every_command() {
    let commands = ["run", "check", "compare", "solve", "judge", "collection", "export", "init", "completions", "man"];
    for shell in ["bash", "zsh", "fish"] {
        let output = stickslip(&["completions", shell]);
        assert_exit(&output, 0);
        assert!(commands.iter().all(|command| stdout(&output).contains(command)), "{shell}");
        assert!(stdout(&output).contains("uniqueness"), "{shell}");
    }
    let page = stickslip(&["man"]);
    assert_exit(&page, 0);
    assert!(stdout(&page).contains(".TH stickslip 1"));
    for command in commands {
        assert!(stdout(&page).contains(&format!("stickslip\\-{command}")), "{command}");
        let page = stickslip(&["man", command]);
        assert_exit(&page, 0);
        assert!(stdout(&page).contains(&format!(".TH stickslip-{command} 1")), "{}", stdout(&page));
    }
    let run = stickslip(&["man", "run"]);
    assert!(["set", "method", "json", "out"].iter().all(|option| stdout(&run).contains(&format!("\\-\\-{option}"))));
    let unknown = stickslip(&["man", "reckon"]);
    assert_exit(&unknown, 2);
    assert!(stderr(&unknown).contains("the commands are run, check"), "{}", stderr(&unknown));
}
