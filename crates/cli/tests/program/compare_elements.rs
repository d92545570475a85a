//! Comparisons of elements: errors beside estimates, and the recommended mesh.
#![allow(clippy::unwrap_used)]

use stickslip::scene::Scene;
use stickslip_cli::compare::{self, Comparison, MeshChoice, MeshErrors, MeshResult, MeshSize, Plan, Trial};

use super::compare::{CONDENSED, by_hand, mesh, run};
use crate::program::{Folder, assert_exit, csv, stickslip};

/// A roller pressed into a block of several kinds of elements: the error of each mesh against the finest, beside its
/// own estimate.
#[test]
fn elements_are_compared_with_their_estimates() {
    let text = "mesh = { kind = 'block', size = [[0.3, 0.7], 1], elements = [[6, 4], 8], grading = [[1, 4], 0.1] }
        material = { young = 1e9, poisson = 0.3 }
        support = [{ boundary = 'bottom', fix = ['x', 'y'] }, { boundary = 'left', fix = ['x'] }]
        time = { end = 1, increments = 1 }
        [[contact]]
        boundary = 'top'
        friction = 0
        obstacle = { kind = 'cylinder', apex = [0, 1], radius = 2, approach = [[0, 0], [1, 0.01]] }";
    let scene = Scene::parse("roller.toml", text, &[]).unwrap();
    let kinds = ["triangle", "quadrilateral:b-bar", "triangle6"].map(|name| Some(name.parse().unwrap()));
    let choice = |elements, n| MeshChoice { size: MeshSize::Elements(n), elements };
    let meshes = kinds.iter().flat_map(|kind| [10, 20].map(|n| choice(*kind, n))).collect();
    let plan = Plan { paths: vec![CONDENSED], meshes, increments: vec![1], reference: 2, jobs: 1 };
    let comparison = compare::compute(&scene, &plan, &(), &mut |_| (), || false).unwrap();
    assert_eq!(comparison.elements().len(), 3);
    assert_eq!(comparison.meshes.last().unwrap().mesh, choice(kinds[2], 20));
    for kind in kinds {
        let of: Vec<&MeshResult> =
            comparison.meshes.iter().filter(|result| result.mesh.elements == kind && result.errors.is_some()).collect();
        let errors: Vec<MeshErrors> = of.iter().map(|result| result.errors.unwrap()).collect();
        for pair in errors.windows(2) {
            assert!(pair[1].sum_p_n < pair[0].sum_p_n && pair[1].energy < pair[0].energy, "{kind:?}: {errors:?}");
        }
        for (result, errors) in of.iter().zip(&errors) {
            let estimates = result.estimates.as_ref().unwrap();

            // The estimate is a typical error, told within a factor of 3.
            let peak = estimates.peak_error.unwrap();
            assert!(errors.peak < 3.0 * peak, "{:?}: {errors:?}, {peak}", result.mesh);
            let ratio = estimates.discretisation.unwrap() / errors.norm();
            assert!((0.4..2.5).contains(&ratio), "{:?}: {ratio}", result.mesh);
        }
    }
    let stems: Vec<&str> = compare::charts(&comparison).iter().map(|chart| chart.0).collect();
    assert_eq!(stems, ["forces", "mesh-size", "mesh-time"]);
    let svg = compare::charts(&comparison)[1].2.to_svg().unwrap();
    for label in ["triangle", "quadrilateral:b-bar", "triangle6", "energy norm", "peak pressure"] {
        assert!(svg.lines().any(|line| line == label), "{label}");
    }
    let answers = comparison.answers();
    assert!(answers[0].starts_with("Mesh for an error of 1e-2 in the normal force: the cheapest is "), "{answers:?}");
}

/// A coarse mesh that is accurate by chance is not recommended if finer meshes of its elements are worse.
#[test]
fn a_mesh_is_recommended_where_finer_ones_keep_its_error() {
    let results = [
        ("triangle", 10, 0.1, Some(1e-3)),
        ("triangle", 20, 0.4, Some(3e-2)),
        ("triangle", 40, 1.6, Some(5e-3)),
        ("quadrilateral", 10, 0.2, Some(2e-2)),
        ("quadrilateral", 20, 0.8, Some(8e-3)),
        ("quadrilateral", 40, 3.2, None),
    ]
    .map(|(elements, n, seconds, error)| {
        let choice = MeshChoice { size: MeshSize::Elements(n), elements: Some(elements.parse().unwrap()) };
        let errors = error.map(|sum_p_n| MeshErrors { sum_p_n, sum_p_t: 0.0, energy: 0.0, peak: 0.0, tractions: 0.0 });
        let trial = Trial { mesh: choice.clone(), ..run(CONDENSED, n, 1, seconds, 0.0) };
        (MeshResult { mesh: choice, errors, ..mesh(n) }, trial)
    });
    let (meshes, runs) = results.into_iter().unzip();
    let mut comparison = Comparison { meshes, runs, ..by_hand() };
    let expected = [
        "Mesh for an error of 1e-2 in the normal force: the cheapest is quadrilateral, n = 20, 400 displacements, 8.00e-1 s \
         (error 8.00e-3), and finer ones keep it.",
        "Mesh for an error of 1e-3 in the normal force: none keeps it as it gets finer; the nearest is triangle, n = 10 with \
         1.00e-3.",
    ];
    assert_eq!(comparison.answers(), expected);
    // If the finer meshes are as good, it is the cheapest.
    for result in &mut comparison.meshes[1..3] {
        result.errors.as_mut().unwrap().sum_p_n = 1e-3;
    }
    let answers = comparison.answers();
    assert!(answers.iter().all(|answer| answer.contains("the cheapest is triangle, n = 10, 100")), "{answers:?}");
}

/// Without contact, the error in the energy norm is compared, and forces are not mentioned.
#[test]
fn elements_are_compared_without_contact() {
    let (folder, scene) = Folder::with_scene(
        "mesh = { kind = 'block', size = [4, 1], elements = [8, 2] }
        material = { young = 1e9, poisson = 0.3 }
        support = [{ boundary = 'left', fix = ['x', 'y'] }]
        load = [{ boundary = 'right', traction = [0, 1e3] }]
        time = { end = 1, increments = 1 }",
    );
    let plan = ["--meshes", "4,8,16", "--elements", "triangle,quadrilateral,triangle6", "--increments", "1"];
    let fast = ["--methods", "bn", "--solvers", "condensed", "--out", &folder.join("out")];
    assert_exit(&stickslip(&[&["compare", &scene], &plan[..], &fast[..]].concat()), 0);

    let (header, rows) = csv(&folder.0.join("out/meshes.csv"));
    let column = |name: &str| header.split(',').position(|column| column == name).unwrap();
    let cell = |row: &[String], name: &str| row[column(name)].clone();
    assert!(rows.len() == 9 && rows.iter().all(|row| cell(row, "contacts") == "0"), "{rows:?}");
    assert!(rows.iter().all(|row| cell(row, "estimated_peak_error").is_empty()), "{rows:?}");
    let (finest, coarser) = rows.split_last().unwrap();
    assert_eq!([cell(finest, "elements"), cell(finest, "error_energy")], ["triangle6", ""]);
    for row in coarser {
        let [error, estimate] =
            ["error_energy", "estimated_energy_norm"].map(|name| cell(row, name).parse::<f64>().unwrap());
        let ratio = estimate / error.sqrt();
        assert!((0.6..1.2).contains(&ratio), "{row:?}: {ratio}");
    }

    let page = std::fs::read_to_string(folder.join("out/compare.md")).unwrap();
    let answers: Vec<&str> = page.lines().filter(|line| line.starts_with("- ")).collect();
    assert_eq!(answers.len(), 2, "{answers:?}");
    assert!(answers[0].starts_with("- Mesh for an error of 1e-1 in the energy norm: the cheapest is "), "{answers:?}");
    assert!(answers[1].starts_with("- Mesh for an error of 1e-2 in the energy norm: none keeps it "), "{answers:?}");
    let svg = std::fs::read_to_string(folder.join("out/mesh-size.svg")).unwrap();
    let labelled = |label: &str| svg.lines().any(|line| line == label);
    assert!(labelled("energy norm") && !["normal force", "tractions", "peak pressure"].into_iter().any(labelled));
}
