//! Boundary names of a mesh file, in the names of result files.

#![allow(clippy::unwrap_used)]

use std::fs;

use crate::program::{Folder, assert_exit, stickslip};

/// Runs a square whose left side is called `name`. Returns the names of its results and the table of forces.
fn results(name: &str) -> (Vec<String>, String) {
    let mesh = include_str!("../../../../data/meshes/square_triangles.msh").replace("\"left\"", &format!("\"{name}\""));
    let scene = format!(
        "mesh = {{ kind = 'gmsh', file = 'square.msh' }}
        material = {{ young = 1e9, poisson = 0.3 }}
        support = [{{ boundary = 'top', fix = ['x', 'y'] }}]
        contact = [
          {{ boundary = 'bottom', friction = 0.3, obstacle = {{ kind = 'plane', approach = [[0, 0], [1, 1e-3]] }} }},
          {{ boundary = '{name}', friction = 0.3, obstacle = {{ kind = 'plane', gap = 1 }} }},
        ]
        time = {{ end = 1, increments = 1 }}"
    );
    let (folder, scene) = Folder::with_scene(&scene);
    fs::write(folder.join("square.msh"), mesh).unwrap();
    assert_exit(&stickslip(&["run", &scene, "--out", &folder.join("out")]), 0);
    (folder.names("out"), fs::read_to_string(folder.join("out/forces.csv")).unwrap())
}

#[test]
fn a_comma_stays_within_its_field() {
    let (names, forces) = results("le,ft");
    assert!(names.contains(&"contact_0001_le_ft.csv".to_string()), "{names:?}");
    let line = forces.lines().find(|line| line.contains("le,ft")).unwrap();
    assert!(line.starts_with("1,1,\"le,ft\",0,0,"), "{line}");
}

/// No name leaves the folder, is too long for it, or replaces another.
#[test]
fn files_are_called_what_a_folder_takes() {
    let long = "l".repeat(300);
    for (name, file) in [("a/b", "a_b"), ("../left", "___left"), (&long, &long[..100]), ("Bottom", "Bottom-2")] {
        let (names, forces) = results(name);
        for suffix in ["csv", "svg"] {
            let file = format!("contact_0001_{file}.{suffix}");
            assert!(names.contains(&file), "{file}: {names:?}");
        }
        assert_eq!(names.len(), 2 * 2 + 6, "{names:?}");
        assert!(forces.contains(&format!("1,1,{name},")), "{forces}");
    }
}
