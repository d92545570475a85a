//! A model without text: the same numbers as from a scene, and nothing wrong gets through; what is wrong is named by
//! its key.

use crate::common::prelude::*;
use stickslip::body::fem::Layer;

/// The paper's block as data/scenes/block.toml has it, with fewer elements.
pub fn paper_block() -> Description {
    let steel = Material::new(210e9, 0.3).in_plane(Plane::Strain);
    Description::new(MeshSource::block([1.0, 1.0], [4, 4]), steel, equal_increments(2.0, 40))
        .support("left", &[Axis::X, Axis::Y])
        .contact("bottom", 0.4, Obstacle::plane(1e-5))
        .load(Load::new("top", &[0.0, -10e6]).over(&[[0.0, 0.0], [1.0, 1.0], [2.0, 1.0]]))
        .load(Load::new("right", &[-10e6, 0.0]).over(&[[0.0, 0.0], [1.0, 1.0], [2.0, 0.0]]))
}

fn cube() -> Description {
    Description::new(MeshSource::block([1.0; 3], [2; 3]), Material::new(1e9, 0.3), vec![1.0, 1.5])
        .support("left", &[Axis::X, Axis::Y, Axis::Z])
        .contact("bottom", 0.3, Obstacle::plane(0.0))
        .load(Load::new("top", &[0.0, 0.0, -1e6]))
}

/// Every number of both models is the same to the last bit.
fn assert_equal(a: &Model, b: &Model) {
    assert_eq!(a.description(), b.description());
    assert_eq!(format!("{:?}", a.problem), format!("{:?}", b.problem));
    assert_eq!(a.loading, b.loading);
    assert_eq!(a.mesh, b.mesh);
}

#[test]
fn the_block_from_text_and_from_rust() {
    let of_text = discretise(&common::block(&["mesh.elements=[4, 4]"])).unwrap();
    assert_equal(&of_text, &Model::build(&paper_block()).unwrap());
}

#[test]
fn obstacles_that_move_from_text_and_from_rust() {
    let text = scene! { r#"
[mesh] kind = "block", size = [[0.5, 0.5], 1.0], elements = [[2, 3], 2], grading = [[1.0, 2.0], 1.0]
cells = "triangle"
[material] young = 1e9, poisson = 0.3, layers = [[0.5, 2e9, 0.2]]
[[support]] boundary = "top", fix = ["x", "y"]
[[contact]] boundary = "bottom", friction = 0.3
[contact.obstacle] kind = "cylinder", radius = 5.0, apex = [0.5, -1e-3], direction = "nearest"
approach = [[0, 0], [1, 2e-3]], motion.translation = [[0, 0, 0], [3, 0.1, 0]]
motion.rotation = { through = [0.5, -5.001], history = [[0, 0], [1, 0.1]] }
[time] end = 2, increments = 4
"# };
    let source = MeshSource::Block {
        axes: vec![
            [(2, 1.0), (3, 2.0)].map(|(elements, grading)| Segment { length: 0.5, elements, grading }).to_vec(),
            vec![Segment { length: 1.0, elements: 2, grading: 1.0 }],
        ],
        cells: CellKind::Triangle,
        origin: None,
    };
    let layers = vec![Layer { thickness: 0.5, young: 2e9, poisson: 0.2 }];
    let roller = Obstacle {
        direction: GapDirection::Nearest,
        translation: Some(vec![(0.0, [0.0; 2].into()), (3.0, [0.1, 0.0].into())]),
        rotation: Some(Rotation { axis: None, through: [0.5, -5.001].into(), history: vec![[0.0, 0.0], [1.0, 0.1]] }),
        ..Obstacle::at_rest(Shape::Cylinder { radius: 5.0, place: Place::Apex([0.5, -1e-3].into()), axis: None })
            .approaching(&[[0.0, 0.0], [1.0, 2e-3]])
    };
    let description =
        Description::new(source, Material { layers, ..Material::new(1e9, 0.3) }, equal_increments(2.0, 4))
            .support("top", &[Axis::X, Axis::Y])
            .contact("bottom", 0.3, roller);
    let of_text = model_of(&text);
    assert_equal(&of_text, &Model::build(&description).unwrap());
    assert_eq!(
        (of_text.times(), of_text.loading.gap_corrections()[0].times()),
        (&description.times[..], &[0.0, 0.5, 1.0, 1.5, 2.0][..])
    );
}

#[test]
fn a_model_without_text_is_solved() {
    let model = Model::build(&paper_block()).unwrap();
    let report = Run::of(&model, model.times().to_vec(), bn()).unwrap().solve(&mut ()).unwrap();
    assert_eq!((report.status, report.increments.len()), (Status::Converged, 40));
}

/// A fault that the model of `description` has to have, with the key and words of the message.
pub fn refused(description: &Description, key: &str, says: &str) {
    let error = Model::build(description).err().unwrap_or_else(|| panic!("accepted, with `{says}`: {description:?}"));
    let ModelError::Description(fault) = &error else { panic!("{error}") };
    assert_eq!(fault.key, key, "{error}");
    assert!(fault.message.contains(says), "`{says}` is not in: {error}");
    assert!(error.to_string().starts_with(&format!("{key}: ")), "{error}");
    assert!(!error.help().unwrap().to_string().is_empty());
}

#[test]
#[allow(clippy::too_many_lines)] // A list.
fn nonsense_in_the_plane() {
    let with = |change: &dyn Fn(&mut Description)| {
        let mut description = paper_block();
        change(&mut description);
        description
    };
    let mesh = |source: MeshSource| with(&|d| d.mesh = source.clone());
    let half_plane =
        HalfPlane { size: [1.0, 1.0], contact_width: 0.1, contact_elements: 2, outer_elements: 2, layers: 2 };
    let half = |half_plane| mesh(MeshSource::HalfPlane(half_plane));
    let segment = Segment { length: 1.0, elements: 2, grading: 1.0 };
    let axes = |axes: Vec<Vec<Segment>>| mesh(MeshSource::Block { axes, cells: CellKind::Quadrilateral, origin: None });
    let material = |material: Material| with(&|d| d.material = material.clone());
    let steel = || Material::new(210e9, 0.3);
    let contact = |obstacle: Obstacle| with(&|d| d.contacts[0].against = obstacle.clone().into());
    let round = |radius: f64| Shape::Cylinder { radius, place: Place::Apex([0.5, -1.0].into()), axis: None };
    let plane = || Obstacle::plane(1e-5);
    let layer = Layer { thickness: 0.5, young: 1e9, poisson: 0.3 };
    let group = |name: &str| MaterialGroup { name: name.into(), young: 1e9, poisson: 0.3, ..MaterialGroup::default() };
    let rotation = |history: Vec<[f64; 2]>| Rotation { axis: None, through: [0.0; 2].into(), history };
    for (description, key, says) in vec![
        (mesh(MeshSource::block([1.0], [4])), "mesh.size", "two or three lengths"),
        (mesh(MeshSource::block([1.0, f64::NAN], [4, 4])), "mesh.size", "[1.0, NaN]"),
        (mesh(MeshSource::block([1.0, -1.0], [4, 4])), "mesh.size", "positive"),
        (mesh(MeshSource::block([1.0, 1.0], [4, 0])), "mesh.elements", "[4, 0]"),
        (mesh(MeshSource::block([1.0, 1.0], [usize::MAX, 2])), "mesh.elements", "50 million"),
        (axes(vec![vec![segment], vec![]]), "mesh.size", "[1.0, []]"),
        (axes(vec![vec![segment], vec![Segment { grading: 0.0, ..segment }]]), "mesh.grading", "ratios"),
        (axes(vec![vec![segment]; 3]), "mesh.cells", "2 dimensions, but mesh.size has 3"),
        (half(HalfPlane { contact_width: 1.5, ..half_plane }), "mesh.contact_width", "less than the width"),
        (half(HalfPlane { layers: 0, ..half_plane }), "mesh.layers", "at least 1"),
        (half(HalfPlane { outer_elements: 9_999_999, layers: 99, ..half_plane }), "mesh", "50 million"),
        (
            mesh(MeshSource::File { format: MeshFormat::Gmsh, file: "part.msh".into(), scale: 0.0 }),
            "mesh.scale",
            "positive",
        ),
        (with(&|d| d.element = Element::BBar).in_plane_stress(), "mesh.element", "\"stress\""),
        (paper_block().support("right", &[]), "support[1].fix", "holds nothing"),
        (paper_block().support("right", &[Axis::Z]), "support[1].fix", "holds z"),
        (paper_block().support("rigth", &[Axis::X]), "support[1].boundary", "no boundary `rigth`"),
        (with(&|d| d.contacts[0].friction = (-0.1).into()), "contact[0].friction", "0 or more"),
        (with(&|d| d.contacts[0].friction = f64::NAN.into()), "contact[0].friction", "finite"),
        (paper_block().contact("bottom", 0.1, plane()), "contact[1].boundary", "already"),
        (paper_block().contact("down", 0.1, plane()), "contact[1].boundary", "no boundary `down`"),
        (paper_block().contact("left", 0.1, plane()), "contact[1].boundary", "supports hold every node"),
        (contact(Obstacle::plane(-1e-6)), "contact[0].boundary", "supports hold the body where the obstacle is"),
        (with(&|d| d.loads[1] = Load::new("right", &[1.0])), "load[1].traction", "two or three"),
        (with(&|d| d.loads[1] = Load::new("right", &[1.0, f64::NAN])), "load[1].traction", "two or three finite"),
        (with(&|d| d.loads[1] = Load::new("right", &[1.0; 3])), "load[1].traction", "3 components"),
        (with(&|d| d.loads[0] = Load::new("roof", &[0.0, 1.0])), "load[0].boundary", "no boundary `roof`"),
        (with(&|d| d.loads[0].history = Some(Vec::new())), "load[0].history", "empty"),
        (with(&|d| d.loads[0].history = Some(vec![[0.0, f64::INFINITY]])), "load[0].history", "inf"),
        (with(&|d| d.times.clear()), "times", "empty"),
        (with(&|d| d.times[7] = 0.0), "times", "must increase"),
        (with(&|d| d.times[39] = f64::NAN), "times", "NaN"),
    ] {
        refused(&description, key, says);
    }
    for (found, key, says) in [
        (Material::new(0.0, 0.3), "young", "positive"),
        (Material::new(f64::INFINITY, 0.3), "young", "finite"),
        (Material::new(1e9, 0.5), "poisson", "below 0.5"),
        (Material { layers: vec![layer, Layer { thickness: -0.1, ..layer }], ..steel() }, "layers[1]", "thickness"),
        (Material { layers: vec![Layer { thickness: 5.0, ..layer }, layer], ..steel() }, "layers[1]", "no element"),
        (Material { groups: vec![group("body"), group("body")], ..steel() }, "group[1].name", "already"),
        (Material { groups: vec![group("core")], ..steel() }, "group[0].name", "no material group `core`"),
        (Material { groups: vec![group("body")], layers: vec![layer], ..steel() }, "layers", "layers and groups"),
    ] {
        refused(&material(found), &format!("material.{key}"), says);
    }
    for (obstacle, key, says) in [
        (Obstacle::plane(f64::NAN), ".gap", "finite"),
        (Obstacle::plane(-0.5), "", "inside the body"),
        (Obstacle::at_rest(round(-1.0)), ".radius", "positive"),
        (Obstacle { normal: Some([0.0; 2].into()), ..plane() }, ".normal", "[0.0, 0.0]"),
        (Obstacle { normal: Some([0.0, 1.0].into()), ..plane() }, "", "into the body"),
        (Obstacle { normal: Some([0.0, -1.0, 1.0].into()), ..plane() }, "", "leaves the plane"),
        (Obstacle { tangent: Some([1.0, 0.0].into()), ..plane() }, ".tangent", "right angles"),
        (Obstacle { direction: GapDirection::Nearest, ..plane() }, ".direction", "nearest"),
        (plane().approaching(&[]), ".approach", "empty"),
        (plane().approaching(&[[1.0, 0.0], [0.0, 1.0]]), ".approach", "times must increase"),
        (
            Obstacle { translation: Some(vec![(f64::NAN, [0.0; 2].into())]), ..plane() },
            ".motion.translation",
            "increasing times",
        ),
        (Obstacle { rotation: Some(rotation(Vec::new())), ..plane() }, ".motion.rotation.history", "empty"),
        (Obstacle::at_rest(Shape::Formula(Formula::parse("sqrt(x - 0.5)").unwrap())), "", "no finite value"),
        (Obstacle::at_rest(Shape::Table { file: "none.csv".into(), scale: 1.0 }), "", "cannot be read"),
    ] {
        refused(&contact(obstacle), &format!("contact[0].obstacle{key}"), says);
    }
}

#[test]
fn nonsense_in_space() {
    let contact = |shape: Shape| {
        let mut description = cube();
        description.contacts[0].against = Obstacle::at_rest(shape).into();
        description
    };
    let apex = [0.5, 0.5, -0.1].into();
    let flat = Obstacle { normal: Some([0.0, -1.0].into()), ..Obstacle::plane(0.0) };
    let mut pressed = cube();
    pressed.contacts[0].against = flat.into();
    for (description, key, says) in [
        (
            contact(Shape::Cylinder { radius: 9.0, place: Place::Apex(apex), axis: None }),
            "contact[0].obstacle",
            "needs an axis",
        ),
        (
            contact(Shape::Sphere { radius: 9.0, place: Place::Apex([0.5, -0.1].into()) }),
            "contact[0].obstacle",
            "two components",
        ),
        (contact(Shape::Wedge { apex, angle: 2.0, axis: None }), "contact[0].obstacle.angle", "between 0 and pi/2"),
        (pressed, "contact[0].obstacle", "normal of the obstacle has two components"),
        (cube().in_plane_stress(), "material.plane", "three dimensions"),
        (cube().load(Load::new("top", &[0.0, 1.0])), "load[1].traction", "2 components"),
    ] {
        refused(&description, key, says);
    }
}

trait InPlaneStress {
    fn in_plane_stress(self) -> Self;
}

impl InPlaneStress for Description {
    fn in_plane_stress(mut self) -> Self {
        self.material = self.material.in_plane(Plane::Stress);
        self
    }
}

/// The key stands beside file and line, whoever finds the fault: the TOML reader, the scene or the model.
#[test]
fn errors_of_scenes_have_a_key() {
    for (from, to, key) in [
        ("210e9", "\"steel\"", "material.young"),
        ("friction = 0.4", "frction = 0.4", "contact[0].frction"),
        ("[0.0, -10e6]", "[0.0, true]", "load[0].traction[1]"),
        ("friction = 0.4", "friction = -0.4", "contact[0].friction"),
        ("[100, 100]", "[100, 0]", "mesh.elements"),
        ("gap = 1e-5", "normal = [0, 0]", "contact[0].obstacle.normal"),
        ("gap = 1e-5", "radius = 1", "contact[0].obstacle.radius"),
        ("setting = \"paper\"", "tolerance = 2", "solver.tolerance"),
        ("\"right\"", "\"rigth\"", "load[1].boundary"),
        ("[mesh]", "[mesh", ""),
    ] {
        let text = edit(BLOCK, from, to).replace("[100, 100]", "[2, 2]");
        let error = match Scene::parse("block.toml", &text, &[]) {
            Err(error) => error,
            Ok(scene) => match discretise(&scene).unwrap_err() {
                stickslip::run::RunError::Scene(error) => error,
                other => panic!("{other}"),
            },
        };
        let SceneError::Invalid(located) = &error else { panic!("{error}") };
        assert_eq!(located.key, key, "{error}");
    }
}
