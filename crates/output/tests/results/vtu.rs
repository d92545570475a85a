//! VTU files, opened by an independent reader.

#![allow(clippy::unwrap_used)]

use crate::common;
use crate::common::vtu::{HEXAHEDRON, Piece, QUAD, TETRA, WEDGE, values};
use std::fs;
use std::ops::ControlFlow;
use stickslip::body::Model;
use stickslip::run::report::ContactLine;
use stickslip::run::{Recording, Run, discretise};
use stickslip::scene::{Provenance, Scene};
use stickslip::solver::history::{self, HistorySettings, IncrementView, LinearAlgebra, Method, Observer, SystemSolver};
use stickslip_output::{Grid, KeptSolver, LockedOutputDir, ResultFolder, fields};

/// Observer that keeps the fields of every increment.
struct Fields<'a>(&'a Model, Vec<Grid>);

impl Observer for Fields<'_> {
    fn increment(&mut self, step: &IncrementView<'_>) -> ControlFlow<()> {
        self.1.push(fields(self.0, step));
        ControlFlow::Continue(())
    }
}

fn solve(scene: &Scene) -> (Model, Vec<Grid>) {
    let model = discretise(scene).unwrap();
    let settings = HistorySettings::new(&model.problem, &model.loading, Method::BN).unwrap().until(200, 1e-10);
    let linear = SystemSolver::from(LinearAlgebra::default());
    let mut observer = Fields(&model, Vec::new());
    history::run(&model.problem, &model.loading, &scene.time.all(), &settings, linear, &mut observer).unwrap();
    let grids = observer.1;
    (model, grids)
}

/// Returns the von Mises stress of a tensor.
fn equivalent(s: &[f64]) -> f64 {
    let mean = (s[0] + s[4] + s[8]) / 3.0;
    let deviator: f64 = s.iter().enumerate().map(|(k, s)| (s - if k % 4 == 0 { mean } else { 0.0 }).powi(2)).sum();
    (1.5 * deviator).sqrt()
}

#[test]
fn the_block_reads_back_as_it_was_computed() {
    let scene = common::block(&["mesh.elements=[4,3]", "time.increments=2", "contact.obstacle.gap=0"]);
    let (model, grids) = solve(&scene);
    let read = Piece::read(&grids[1].to_string());
    assert_eq!(read.points, model.mesh.nodes.as_flattened());
    assert_eq!(read.offsets, (1..=12).map(|k| 4 * k).collect::<Vec<u64>>());
    assert_eq!(read.connectivity[..4], [0, 1, 6, 5]);
    assert!(read.types.iter().all(|&kind| kind == QUAD));

    let (components, displacement) = values(&read.point, "displacement");
    let (_, gap) = values(&read.point, "opening");
    let (_, pressure) = values(&read.point, "contact_pressure");
    let (vector, traction) = values(&read.point, "tangential_traction");
    let (_, status) = values(&read.point, "contact");
    assert_eq!((components, vector, displacement.len()), (3, 3, 60));
    for (node, x) in model.mesh.nodes.iter().enumerate() {
        let contact = model.contact.nodes.iter().position(|contact| contact.node == node);
        assert_eq!(contact.is_none(), gap[node].is_nan() && pressure[node].is_nan() && traction[3 * node].is_nan());
        assert_eq!(contact.is_none(), status[node] == -1.0, "{x:?}");
        if contact.is_some() {
            assert!(pressure[node] >= -1e-3 && gap[node] > -1e-14);
            assert!((gap[node] - displacement[3 * node + 1]).abs() < 1e-15, "the foundation is below");
            assert!(traction[3 * node].abs() <= 0.4 * pressure[node] + 1e-3 && traction[3 * node + 1] == 0.0);
        }
    }
    let (nine, stress) = values(&read.cell, "stress");
    let (_, mises) = values(&read.cell, "von_mises");
    let (_, material) = values(&read.cell, "material");
    assert_eq!((nine, stress.len(), material), (9, 108, vec![0.0; 12]));
    for (s, mises) in stress.chunks_exact(9).zip(mises) {
        assert!(s[1] == s[3] && s[2] == 0.0 && s[5] == 0.0);
        // Plane strain.
        assert!((s[8] - 0.3 * (s[0] + s[4])).abs() < 1e-6 * mises);
        assert!((mises - equivalent(s)).abs() < 1e-9 * mises);
    }
}

/// A column under uniform pressure has a known stress.
#[test]
fn a_pressed_column_of_triangles() {
    let text = r#"
        [mesh]
        kind = "gmsh"
        file = "../meshes/square_triangles.msh"
        [material]
        young = 1e9
        poisson = 0.3
        plane = "stress"
        [[support]]
        boundary = "left"
        fix = ["x"]
        [[contact]]
        boundary = "bottom"
        friction = 0.0
        obstacle = { kind = "plane" }
        [[load]]
        boundary = "top"
        traction = [0.0, -1e6]
        [time]
        end = 1.0
        increments = 1
    "#;
    let name = concat!(env!("CARGO_MANIFEST_DIR"), "/../../data/scenes/column.toml");
    let scene = Scene::parse(name, text, &[]).unwrap();
    let (_, grids) = solve(&scene);
    let read = Piece::read(&grids[0].to_string());
    let (_, stress) = values(&read.cell, "stress");
    for s in stress.chunks_exact(9) {
        let expected = [0.0, 0.0, 0.0, 0.0, -1e6, 0.0, 0.0, 0.0, 0.0];
        assert!(s.iter().zip(expected).all(|(s, e)| (s - e).abs() < 1.0), "{s:?}");
    }
    let (_, pressure) = values(&read.point, "contact_pressure");
    assert!(pressure.iter().filter(|p| !p.is_nan()).all(|p| (p / 1e6 - 1.0).abs() < 1e-6));
    let (_, material) = values(&read.cell, "material");
    assert_eq!((material[0], material[31]), (0.0, 1.0));
}

/// Returns a cube of 2 × 3 × 2 elements on a plane, pressed and pushed, with cells of the given type.
fn cube(cells: &str) -> Scene {
    let text = format!(
        r#"
        [mesh]
        kind = "block"
        size = [2.0, 3.0, 1.0]
        elements = [2, 3, 2]
        cells = "{cells}"
        [material]
        young = 1e9
        poisson = 0.3
        [[support]]
        boundary = "front"
        fix = ["x", "y", "z"]
        [[contact]]
        boundary = "bottom"
        friction = 0.4
        obstacle = {{ kind = "plane" }}
        [[load]]
        boundary = "top"
        traction = [1e5, 0.0, -1e6]
        [time]
        end = 1.0
        increments = 2
        "#
    );
    Scene::parse("cube.toml", &text, &[]).unwrap()
}

/// Returns six times the volume of the tetrahedron with these `corners`.
fn spanned(corners: [[f64; 3]; 4]) -> f64 {
    let [a, b, c] = [1, 2, 3].map(|k| [0, 1, 2].map(|i| corners[k][i] - corners[0][i]));
    a[0] * (b[1] * c[2] - b[2] * c[1]) + a[1] * (b[2] * c[0] - b[0] * c[2]) + a[2] * (b[0] * c[1] - b[1] * c[0])
}

#[test]
fn bodies_in_space_read_back_as_they_were_computed() {
    for (cells, kind, count, corners) in
        [("hexahedron", HEXAHEDRON, 12, 8), ("prism", WEDGE, 24, 6), ("tetrahedron", TETRA, 72, 4)]
    {
        let (model, grids) = solve(&cube(cells));
        let read = Piece::read(&grids[1].to_string());
        let points = read.points.as_chunks::<3>().0;
        assert_eq!(points.len(), 3 * 4 * 3);
        assert_eq!(points, model.mesh.nodes);
        assert!(read.types.len() == count && read.types.iter().all(|&read| read == kind), "{cells}");
        assert_eq!(read.offsets, (1..=count as u64).map(|k| corners as u64 * k).collect::<Vec<_>>());
        let mut volume = 0.0;
        for cell in read.connectivity.chunks_exact(corners) {
            let at = |k: usize| points[cell[k] as usize];
            if corners == 4 {
                // VTK: the first three corners are counterclockwise seen from the fourth.
                volume += spanned([0, 1, 2, 3].map(at)) / 6.0;
                continue;
            }
            if corners == 6 {
                // VTK (9.7, vtkCellSizeFilter): the lower triangle counterclockwise seen from the upper one.
                volume += 0.5 * spanned([0, 1, 2, 3].map(at));
                continue;
            }
            // VTK: the lower face counterclockwise seen from above, then the upper one in the same order.
            let [x, y, z] = at(0);
            let lower = [[x, y, z], [x + 1.0, y, z], [x + 1.0, y + 1.0, z], [x, y + 1.0, z]];
            assert_eq!([0, 1, 2, 3].map(at), lower);
            assert_eq!([4, 5, 6, 7].map(at), lower.map(|[x, y, _]| [x, y, z + 0.5]));
            volume += spanned([0, 1, 3, 4].map(at));
        }
        assert!((volume - 6.0).abs() < 1e-12, "{cells}: {volume} m³");

        let (components, displacement) = values(&read.point, "displacement");
        assert_eq!((components, displacement.len()), (3, 3 * points.len()));
        let (nine, stress) = values(&read.cell, "stress");
        assert_eq!((nine, stress.len()), (9, 9 * count));
        let (_, mises) = values(&read.cell, "von_mises");
        assert_eq!(mises.len(), count);
        for (s, mises) in stress.chunks_exact(9).zip(mises) {
            assert!(s[1] == s[3] && s[2] == s[6] && s[5] == s[7]);
            assert!((mises - equivalent(s)).abs() < 1e-9 * mises);
        }
        let (three, principal) = values(&read.cell, "principal_stress");
        assert_eq!((three, principal.len()), (3, 3 * count));
        for (s, p) in stress.chunks_exact(9).zip(principal.chunks_exact(3)) {
            let size = s.iter().map(|x| x * x).sum::<f64>();
            assert!(p[0] >= p[1] && p[1] >= p[2]);
            assert!((p.iter().sum::<f64>() - s[0] - s[4] - s[8]).abs() < 1e-12 * size.sqrt());
            assert!((p.iter().map(|x| x * x).sum::<f64>() / size - 1.0).abs() < 1e-12);
        }

        // The contact forces agree with those of the condensed system.
        let mut keep = common::Keep::default();
        common::run_default(&cube(cells), &model, &mut keep);
        let (_, pressure) = values(&read.point, "contact_pressure");
        assert_eq!(pressure.iter().filter(|p| !p.is_nan()).count(), model.contact.nodes.len());
        // The facets are equal, and each gives its corners equal shares of its area.
        let facets = &model.mesh.boundary("bottom").unwrap().facets;
        let share = 6.0 / facets.iter().flatten().count() as f64;
        let mut area = vec![0.0; points.len()];
        facets.iter().flatten().for_each(|&node| area[node] += share);
        let contact = (0..points.len()).filter(|&node| !pressure[node].is_nan());
        let integral: f64 = contact.map(|node| area[node] * pressure[node]).sum();
        let sum: f64 = keep.states[1].p_n.iter().sum();
        assert!(sum > 1e6 && (integral / sum - 1.0).abs() < 1e-9, "{cells}: {integral} N, not {sum} N");
    }
}

/// At any time, every file listed in the series exists and is complete.
#[test]
fn the_series_names_whole_files() {
    let scene = common::block(&["mesh.elements=[4,3]", "time.increments=2"]);
    let (model, grids) = solve(&scene);
    let path = std::env::temp_dir().join(format!("stickslip_series_{}", std::process::id()));
    let linear = KeptSolver { name: String::new(), reason: None };
    let begin = || {
        let origin = Provenance::new(&scene, "a test").unwrap();
        LockedOutputDir::new(&path).unwrap().begin(&model, Vec::new(), origin, linear.clone()).unwrap()
    };
    let undeformed = Run::new(&scene).unwrap().undeformed().record;
    let mut folder: ResultFolder = begin();
    folder.add_increment(&undeformed, &[], None).unwrap();
    for (k, grid) in grids.iter().enumerate() {
        folder.add_fields(k + 1, 0.5 * (k + 1) as f64, grid).unwrap();
        let series = fs::read_to_string(path.join("fields.pvd")).unwrap();
        let files: Vec<&str> = series.split("file=\"").skip(1).map(|rest| rest.split('"').next().unwrap()).collect();
        assert_eq!(files.len(), k + 1);
        for file in files {
            Piece::read(&fs::read_to_string(path.join(file)).unwrap());
        }
        assert!(series.contains(&format!("timestep=\"{}\"", 0.5 * (k + 1) as f64)));
    }
    // A new run removes them once it can replace them. Until then no other run may write there.
    assert_eq!(LockedOutputDir::new(&path).unwrap_err().kind(), std::io::ErrorKind::ResourceBusy);
    drop(folder);
    let mut folder = begin();
    assert!(path.join("fields.pvd").exists());
    folder.add_increment(&undeformed, &[], None).unwrap();
    assert!(!path.join("fields.pvd").exists() && !path.join("fields_0001.vtu").exists());
    fs::remove_dir_all(path).unwrap();
}

/// The state of an increment that failed may hold numbers that are not finite: its contact line is written, without a picture.
#[test]
fn a_state_that_is_not_finite_has_no_picture() {
    let scene = common::block(&["mesh.elements=[4,3]", "time.increments=1"]);
    let run = Run::new(&scene).unwrap();
    let mut last = Recording::last();
    run.solve(&mut last).unwrap();
    let mut increment = last.increments[0].clone();
    increment.state.p_n[1] = f64::NAN;
    let data = increment.data();
    let line = ContactLine::all(run.model(), &increment.step(&data)).remove(0);
    let path = std::env::temp_dir().join(format!("stickslip_nan_{}", std::process::id()));
    let origin = Provenance::new(&scene, "a test").unwrap();
    let linear = KeptSolver { name: String::new(), reason: None };
    let mut folder = LockedOutputDir::new(&path).unwrap().begin(run.model(), Vec::new(), origin, linear).unwrap();
    folder.add_increment(&run.undeformed().record, &[], None).unwrap();
    folder.add_contact_line(&line, "failed").unwrap();
    let name = format!("contact_{:04}", line.index);
    let written = [".csv", ".svg"].map(|end| path.join(format!("{name}{end}")).exists());
    fs::remove_dir_all(path).unwrap();
    assert_eq!(written, [true, false]);
}
