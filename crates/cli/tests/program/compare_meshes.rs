//! Comparisons of meshes from files.

#![allow(clippy::unwrap_used)]

use std::collections::BTreeSet;
use std::fs;

use stickslip::scene::Scene;
use stickslip::solver::history::Method;
use stickslip_cli::compare::{self, MeshChoice, MeshSize, Plan, SolverPath};
use stickslip_cli::study::StudyError;

use crate::program::{Folder, assert_exit, small, stderr, stdout, stickslip};

/// Creates a scene with a mesh from a file, in a folder with three mesh files: 4, 8 and 16 elements per side.
fn from_files() -> (Folder, String) {
    let (folder, scene) = Folder::with_scene(
        "mesh = { kind = 'gmsh', file = '8.msh' }
        material = { young = 1e9, poisson = 0.3 }
        support = [{ boundary = 'top', fix = ['x', 'y'] }]
        time = { end = 1, increments = 2 }
        [[contact]]
        boundary = 'bottom'
        friction = 0.3
        obstacle = { kind = 'plane', approach = [[0, 0], [1, 1e-3]] }",
    );
    for n in [4, 8, 16] {
        fs::write(folder.join(&format!("{n}.msh")), square(n)).unwrap();
    }
    (folder, scene)
}

/// Returns a square of n × n quadrilaterals with the boundaries `bottom` and `top`, in Gmsh's format.
fn square(n: usize) -> String {
    let node = |i: usize, j: usize| j * (n + 1) + i + 1;
    let mut lines = vec!["$MeshFormat\n4.1 0 8\n$EndMeshFormat\n$PhysicalNames\n3".to_string()];
    lines.push("1 1 \"bottom\"\n1 2 \"top\"\n2 3 \"body\"\n$EndPhysicalNames\n$Entities\n0 2 1 0".to_string());
    lines.extend([(1, 0), (2, 1)].map(|(tag, y)| format!("{tag} 0 {y} 0 1 {y} 0 1 {tag} 0")));
    lines.push("1 0 0 0 1 1 0 1 3 0\n$EndEntities".to_string());
    let count = (n + 1) * (n + 1);
    lines.push(format!("$Nodes\n1 {count} 1 {count}\n2 1 0 {count}"));
    lines.extend((1..=count).map(|k| k.to_string()));
    let at = |k: usize| k as f64 / n as f64;
    lines.extend((0..=n).flat_map(|j| (0..=n).map(move |i| format!("{} {} 0", at(i), at(j)))));
    let cells = n * n + 2 * n;
    lines.push(format!("$EndNodes\n$Elements\n3 {cells} 1 {cells}\n1 1 1 {n}"));
    lines.extend((0..n).map(|i| format!("{} {} {}", i + 1, node(i, 0), node(i + 1, 0))));
    lines.push(format!("1 2 1 {n}"));
    lines.extend((0..n).map(|i| format!("{} {} {}", n + i + 1, node(i, n), node(i + 1, n))));
    lines.push(format!("2 1 3 {}", n * n));
    for (j, i) in (0..n).flat_map(|j| (0..n).map(move |i| (j, i))) {
        let corners = [node(i, j), node(i + 1, j), node(i + 1, j + 1), node(i, j + 1)].map(|k| k.to_string());
        lines.push(format!("{} {}", 2 * n + j * n + i + 1, corners.join(" ")));
    }
    lines.push("$EndElements\n".to_string());
    lines.join("\n")
}

/// Meshes from files are named by their files, from coarse to fine, whatever their order.
#[test]
fn meshes_from_files_go_by_their_names() {
    let (folder, file) = from_files();
    let scene = Scene::read(file.as_ref(), &[]).unwrap();
    let path = SolverPath { method: Method::BN.into(), linear: None };
    let own = Plan { increments: vec![1, 2], ..Plan::modest(&scene, vec![path]) };
    assert_eq!((&own.meshes[..], own.histories()), (&[MeshSize::Own.into()][..], 3));
    let comparison = compare::compute(&scene, &own, &(), &mut |_| {}, || false).unwrap();
    assert!(comparison.answers()[1].contains("to 1e-6, the scene's mesh:"), "{:?}", comparison.answers());

    let files = ["16.msh", "4.msh", "8.msh", "4.msh"].map(|name| MeshSize::File(name.to_string()).into());
    let plan = Plan { meshes: files.to_vec(), ..own.clone() };
    let comparison = compare::compute(&scene, &plan, &(), &mut |_| {}, || false).unwrap();
    let sizes: Vec<(String, usize)> =
        comparison.meshes.iter().map(|result| (result.mesh.to_string(), result.contacts)).collect();
    assert_eq!(sizes, [("4.msh", 5), ("8.msh", 9), ("16.msh", 17)].map(|(name, n)| (name.to_string(), n)));
    let errors: Vec<f64> = comparison.meshes[..2].iter().map(|result| result.errors.unwrap().energy).collect();
    assert!(errors[0] > errors[1] && errors[1] > 0.0, "{errors:?}");
    assert_eq!(comparison.meshes[2].errors, None);
    let runs: Vec<String> = comparison.runs.iter().map(|run| run.mesh.to_string()).collect();
    assert_eq!(runs, ["4.msh", "4.msh", "8.msh", "8.msh", "16.msh", "16.msh"]);

    let none = Plan { meshes: Vec::new(), ..own.clone() };
    assert!(matches!(compare::compute(&scene, &none, &(), &mut |_| {}, || false), Err(StudyError::NoMesh)));
    let numbers = Plan { meshes: vec![MeshSize::Elements(4).into()], ..own };
    assert!(matches!(compare::compute(&scene, &numbers, &(), &mut |_| {}, || false), Err(StudyError::FixedMesh)));
    let cells = MeshChoice { size: MeshSize::Own, elements: Some("triangle".parse().unwrap()) };
    let cells = Plan { meshes: vec![cells], ..numbers.clone() };
    assert!(matches!(compare::compute(&scene, &cells, &(), &mut |_| {}, || false), Err(StudyError::FixedCells)));
    let made = Scene::parse("scene.toml", &small(), &[]).unwrap();
    let named = Plan { meshes: files.to_vec(), ..numbers };
    assert!(matches!(compare::compute(&made, &named, &(), &mut |_| {}, || false), Err(StudyError::NoMeshFile)));

    let out = folder.join("out");
    let output =
        stickslip(&["compare", &file, "--meshes", "8.msh,4.msh", "--increments", "1,2", "--csv", "--out", &out]);
    assert_exit(&output, 0);
    let meshes: BTreeSet<&str> = stdout(&output).lines().skip(1).map(|line| line.split(',').nth(4).unwrap()).collect();
    assert_eq!(meshes, BTreeSet::from(["4.msh", "8.msh"]));
    let page = fs::read_to_string(folder.join("out/compare.md")).unwrap();
    assert!(
        page.contains(" (4.msh), ")
            && page.contains(" (8.msh) times")
            && page.contains("\n8.msh: ")
            && !page.contains("n = "),
        "{page}"
    );
    for (meshes, words) in [
        ("8.msh,none.msh", "none.msh"),
        ("8.msh,20", "no numbers of elements to change"),
        ("8.msh,", "give a number of elements, or a mesh file"),
    ] {
        let output = stickslip(&["compare", &file, "--meshes", meshes]);
        assert_exit(&output, 2);
        assert!(stderr(&output).replace("\n  │ ", " ").contains(words), "{meshes}: {}", stderr(&output));
    }
}
