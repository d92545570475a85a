//! Scenes of several bodies: what is read of them, what is refused, and with which words.

use crate::common::prelude::*;

scene! {
/// Two blocks, one above the other, each held by its own top and pressed on its own floor. A blank line is between tables.
pub static TWO = r#"
[[body]] name = "lower"
[body.mesh] kind = "block", size = [1.0, 0.5]
elements = [8, 4]  # lower
[body.material]
young = 210e9  # steel
poisson = 0.3

[[body]] name = "upper", at = [0.1, 0.7]
[body.mesh] kind = "block", size = [0.6, 0.4]
elements = [5, 4]  # upper
[body.material]
young = 70e9  # aluminium
poisson = 0.25  # aluminium, too
density = 2700

[[contact]] boundary = "lower:bottom", friction = 0.3, obstacle = { kind = "plane" }

[[contact]] boundary = "upper:bottom", friction = 0.2, obstacle = { kind = "plane", gap = 1e-6 }

[[support]] boundary = "lower:left", fix = ["x"]

[[support]] boundary = "upper:left", fix = ["x"]

[[load]] boundary = "lower:top", traction = [0, -1e7]

[[load]] boundary = "upper:top", traction = [1e6, -2e7]

[time] end = 1, increments = 4
"# }

fn with(overrides: &[&str]) -> Scene {
    parsed_with(&TWO, overrides)
}

#[test]
fn bodies_become_one_mesh_and_their_materials_groups() {
    let scene = parsed(&TWO);
    let description = &scene.description;
    let upper = Body::new("upper", MeshSource::block([0.6, 0.4], [5, 4])).at([0.1, 0.7]);
    let lower = Body::new("lower", MeshSource::block([1.0, 0.5], [8, 4]));
    assert_eq!(description.mesh, MeshSource::Bodies(vec![lower, upper]));
    let group = |name: &str, young, poisson, density| MaterialGroup {
        name: name.to_string(),
        young,
        poisson,
        density,
        expansion: None,
    };
    let groups = [group("lower", 210e9, 0.3, None), group("upper", 70e9, 0.25, Some(2700.0))];
    assert_eq!(description.material.groups, groups);
    assert_eq!((description.material.density, description.element), (None, Element::Bilinear));
    let model = discretise(&scene).unwrap();
    let bodies = model.mesh.bodies();
    let stiff = model.materials()[0];
    for (law, body) in model.materials().iter().zip(bodies.of_cells()) {
        assert_eq!(*law == stiff, *body == 0);
    }
}

#[test]
fn overrides_reach_bodies() {
    let axes = |scene: &Scene| {
        let MeshSource::Bodies(bodies) = &scene.description.mesh else { panic!() };
        let elements = |body: &Body| match &body.mesh {
            MeshSource::Block { axes, .. } => axes.concat().iter().map(|segment| segment.elements).collect::<Vec<_>>(),
            _ => panic!(),
        };
        bodies.iter().map(elements).collect::<Vec<_>>()
    };
    assert_eq!(axes(&with(&["body[1].mesh.elements=[3,2]"])), [[8, 4], [3, 2]]);
    assert_eq!(axes(&with(&["body.mesh.elements=[3,2]"])), [[3, 2], [3, 2]]);
    let both = with(&["body.mesh.element=b-bar", "body.material.plane=stress", "body.mesh.element=bilinear"]);
    assert_eq!(both.description.material.plane, Some(Plane::Stress));
    assert_eq!(with(&["body[0].material.young=1e9"]).description.material.groups[0].young, 1e9);
    for (text, words, help) in [
        ("mesh.elements=[2,2]", "the scene has no [mesh], but [[body]]", "body[0].mesh"),
        ("material.young=1e9", "the scene has no [material], but [[body]]", "body[0].material"),
        ("body[2].material.young=1e9", "the scene has 2 [[body]]", "count from 0"),
    ] {
        let error = Scene::parse("scene.toml", &TWO, &[text.parse().unwrap()]).unwrap_err();
        says(&error, words, help);
    }
}

#[test]
fn numbers_of_bodies_are_in_the_units_of_the_scene() {
    let text = edit(
        &TWO,
        "\n[[body]]\nname = \"lower\"",
        "\n[units]\nlength = \"mm\"\nstress = \"MPa\"\n[[body]]\nname = \"lower\"",
    );
    let scene = parsed(&text);
    let MeshSource::Bodies(bodies) = &scene.description.mesh else { panic!() };
    assert_eq!(
        (bodies[1].at, &bodies[1].mesh),
        (Some([0.1e-3, 0.7e-3].into()), &MeshSource::block([0.6e-3, 0.4e-3], [5, 4]))
    );
    assert_eq!(scene.description.material.groups[1].young, 70e15);
}

const READ: &str = include_str!("tables/bodies_as_read.txt");

/// Each fault is told on the line of the body that it is of.
#[test]
fn what_is_wrong_with_a_body_is_told_at_its_place() {
    verify_all(&TWO, READ, located);
}

const BUILT: &str = include_str!("tables/bodies_as_built.txt");

/// Faults that only the mesh shows.
#[test]
fn what_the_model_refuses_is_told_at_its_place() {
    verify_all(&TWO, BUILT, built);
    let triangles = edit(&TWO, "elements = [5, 4]  # upper", "elements = [5, 4]\ncells = \"triangle\"");
    assert!(discretise(&parsed(&triangles)).is_ok());
    // A point that two bodies have is of neither.
    let apart = edit(&TWO, "at = [0.1, 0.7]", "at = [0.125, 0.50000001]");
    verify_all(
        &apart,
        "[time] | [[load]]¶point = [0.125, 0.5]¶force = [0, 1]¶[time] | point = | `lower` and `upper` both have a node at | boundary",
        built,
    );
}
