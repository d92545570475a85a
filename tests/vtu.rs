//! VTU files, opened by a reader that is not ours.

#![allow(clippy::unwrap_used)]

mod common;

use std::fs;

use stickslip::history::{self, HistorySettings, Observer, Step};
use stickslip::model::Model;
use stickslip::nonlinear::Flow;
use stickslip::report::{Grid, ResultFolder, fields};
use stickslip::scene::{LinearBackend, Scene};
use vtkio::Vtk;
use vtkio::model::{Attribute, DataSet, Piece, UnstructuredGridPiece, VertexNumbers};

/// The fields of every increment.
struct Fields<'a>(&'a Model, Vec<Grid>);

impl Observer for Fields<'_> {
    fn increment(&mut self, step: &Step<'_>) -> Flow {
        self.1.push(fields(self.0, step));
        Flow::Continue
    }
}

fn solve(scene: &Scene) -> (Model, Vec<Grid>) {
    let model = Model::new(scene).unwrap();
    let settings = HistorySettings::bn(&model.problem, model.scaling(), 200, 1e-10);
    let mut linear = model.linear(LinearBackend::default());
    let mut observer = Fields(&model, Vec::new());
    history::run(&model.problem, &model.loading, &scene.time.all(), &settings, &mut linear, &mut observer).unwrap();
    let grids = observer.1;
    (model, grids)
}

fn piece(vtk: Vtk) -> UnstructuredGridPiece {
    match vtk.data {
        DataSet::UnstructuredGrid { mut pieces, .. } => match pieces.pop().unwrap() {
            Piece::Inline(piece) => *piece,
            other => panic!("{other:?}"),
        },
        other => panic!("{other:?}"),
    }
}

fn values(attributes: &[Attribute], name: &str) -> (usize, Vec<f64>) {
    let array = attributes.iter().find_map(|attribute| match attribute {
        Attribute::DataArray(array) if array.name == name => Some(array),
        _ => None,
    });
    let array = array.unwrap_or_else(|| panic!("{name} is missing"));
    (array.num_comp(), array.data.cast_into().unwrap())
}

#[test]
fn the_block_reads_back_as_it_was_computed() {
    let scene = common::block(&["mesh.elements=[4,3]", "time.increments=2", "contact.obstacle.gap=0"]);
    let (model, grids) = solve(&scene);
    let read = piece(Vtk::parse_xml(grids[1].to_vtu().as_bytes()).unwrap());
    let points: Vec<f64> = read.points.cast_into().unwrap();
    assert_eq!(points, model.mesh.nodes.as_flattened());
    let VertexNumbers::XML { connectivity, offsets } = read.cells.cell_verts else { panic!() };
    assert_eq!(offsets, (1..=12).map(|k| 4 * k).collect::<Vec<u64>>());
    assert_eq!(connectivity[..4], [0, 1, 6, 5]);
    assert!(read.cells.types.iter().all(|&kind| kind == vtkio::model::CellType::Quad));

    let (components, displacement) = values(&read.data.point, "displacement");
    let (_, gap) = values(&read.data.point, "gap");
    let (_, pressure) = values(&read.data.point, "contact_pressure");
    let (vector, traction) = values(&read.data.point, "tangential_traction");
    let (_, status) = values(&read.data.point, "status");
    assert_eq!((components, vector, displacement.len()), (3, 3, 60));
    for (node, x) in model.mesh.nodes.iter().enumerate() {
        let contact = model.contacts.iter().position(|contact| contact.node == node);
        assert_eq!(contact.is_none(), gap[node].is_nan() && pressure[node].is_nan() && traction[3 * node].is_nan());
        assert_eq!(contact.is_none(), status[node] == -1.0, "{x:?}");
        if contact.is_some() {
            assert!(pressure[node] >= -1e-3 && gap[node] > -1e-14);
            assert!((gap[node] - displacement[3 * node + 1]).abs() < 1e-15, "the foundation is below");
            assert!(traction[3 * node].abs() <= 0.4 * pressure[node] + 1e-3 && traction[3 * node + 1] == 0.0);
        }
    }
    let (nine, stress) = values(&read.data.cell, "stress");
    let (_, mises) = values(&read.data.cell, "von_mises");
    let (_, material) = values(&read.data.cell, "material");
    assert_eq!((nine, stress.len(), material), (9, 108, vec![0.0; 12]));
    for (s, mises) in stress.chunks_exact(9).zip(mises) {
        assert!(s[1] == s[3] && s[2] == 0.0 && s[5] == 0.0);
        // Plane strain.
        assert!((s[8] - 0.3 * (s[0] + s[4])).abs() < 1e-6 * mises);
        let mean = (s[0] + s[4] + s[8]) / 3.0;
        let deviator: f64 = s.iter().enumerate().map(|(k, s)| (s - if k % 4 == 0 { mean } else { 0.0 }).powi(2)).sum();
        assert!((mises - (1.5 * deviator).sqrt()).abs() < 1e-9 * mises);
    }
}

/// A column under uniform pressure: the stress is known.
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
    let name = concat!(env!("CARGO_MANIFEST_DIR"), "/data/scenes/column.toml");
    let scene = Scene::parse(name, text, &[]).unwrap();
    let (_, grids) = solve(&scene);
    let read = piece(Vtk::parse_xml(grids[0].to_vtu().as_bytes()).unwrap());
    let (_, stress) = values(&read.data.cell, "stress");
    for s in stress.chunks_exact(9) {
        let expected = [0.0, 0.0, 0.0, 0.0, -1e6, 0.0, 0.0, 0.0, 0.0];
        assert!(s.iter().zip(expected).all(|(s, e)| (s - e).abs() < 1.0), "{s:?}");
    }
    let (_, pressure) = values(&read.data.point, "contact_pressure");
    assert!(pressure.iter().filter(|p| !p.is_nan()).all(|p| (p / 1e6 - 1.0).abs() < 1e-6));
    let (_, material) = values(&read.data.cell, "material");
    assert_eq!((material[0], material[31]), (0.0, 1.0));
}

/// Every file the series names is there at any time, and is whole.
#[test]
fn the_series_names_whole_files() {
    let scene = common::block(&["mesh.elements=[4,3]", "time.increments=2"]);
    let (_, grids) = solve(&scene);
    let path = std::env::temp_dir().join(format!("stickslip_series_{}", std::process::id()));
    let mut folder = ResultFolder::create(&path, 2).unwrap();
    for (k, grid) in grids.iter().enumerate() {
        folder.add_fields(k + 1, 0.5 * (k + 1) as f64, grid).unwrap();
        let series = fs::read_to_string(path.join("fields.pvd")).unwrap();
        let files: Vec<&str> = series.split("file=\"").skip(1).map(|rest| rest.split('"').next().unwrap()).collect();
        assert_eq!(files.len(), k + 1);
        for file in files {
            piece(Vtk::import(path.join(file)).unwrap());
        }
        assert!(series.contains(&format!("timestep=\"{}\"", 0.5 * (k + 1) as f64)));
    }
    // A new run removes them.
    ResultFolder::create(&path, 2).unwrap();
    assert!(!path.join("fields.pvd").exists() && !path.join("fields_0001.vtu").exists());
    fs::remove_dir_all(path).unwrap();
}
