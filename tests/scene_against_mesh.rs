//! What a scene says that its mesh contradicts.

#![allow(clippy::unwrap_used)]

mod common;

use common::edit;
use common::faults::{BLOCK, Fault, line_of, verify};
use stickslip::model::{Model, ModelError};
use stickslip::scene::Scene;

const AGAINST_THE_MESH: &[Fault] = &[
    ("poisson =", "layers = [[0.1, 1e9, 0.3]]\npoisson =", "layers =", &["in material.layers[0]"], "more elements"),
    (
        "poisson =",
        "layers = [[1.0, 1e9, 0.3],\n[10.0, 1e9, 0.2]]\npoisson =",
        "[10.0, 1e9",
        &["no element", "in material.layers[1]"],
        "thicknesses are in m",
    ),
    ("\"left\"", "\"lft\"", "\"lft\"", &["no boundary `lft`"], "bottom, right, top, left"),
    ("\"bottom\"", "\"Bottom\"", "\"Bottom\"", &["no boundary `Bottom`"], "bottom, right, top, left"),
    ("\"top\"", "\"roof\"", "\"roof\"", &["no boundary `roof`"], "bottom, right, top, left"),
    (
        "gap = 1e-5",
        "gap = -1e-6",
        "\"bottom\"",
        &["hold the body where the obstacle is", "(0, 0) m"],
        "gap of at least 0",
    ),
    (
        "[[support]]",
        "[[support]]\nboundary = \"right\"\nfix = [\"x\", \"y\"]\n[[support]]",
        "\"right\"\nfix",
        &["fix every node"],
        "fewer boundaries",
    ),
    ("\"y\"]", "\"y\", \"z\"]", "fix =", &["the support of `left` holds z", "two dimensions"], "leave out \"z\""),
    (
        "[0.0, -10e6]",
        "[0.0, -10e6, 0.0]",
        "traction = [0.0",
        &["the traction on `top` has 3 components", "2 dimensions"],
        "[x, y]",
    ),
    (
        "[1.0, 1.0]               # m\nelements = [1, 1]",
        "[1.0, 1.0, 1.0]\nelements = [1, 1, 1]",
        "plane = \"strain\"",
        &["plane state", "three dimensions"],
        "remove material.plane",
    ),
    (
        "elements =",
        "cells = \"triangle\"\nelement = \"b-bar\"\nelements =",
        "element = \"b-bar\"",
        &["mesh.element is \"b-bar\"", "triangles"],
        "use quadrilaterals",
    ),
    (
        "poisson = 0.3\n",
        "poisson = 0.3\ngroup = [{ name = \"core\", young = 1e9, poisson = 0.3 }]\n",
        "group =",
        &["no material group `core`"],
        "the groups body",
    ),
];

#[test]
fn what_contradicts_the_mesh() {
    for &(from, to, marker, says, remedy) in AGAINST_THE_MESH {
        let small = edit(BLOCK, "[100, 100]", "[1, 1]");
        let text = edit(&small, from, to);
        let scene = Scene::parse("scene.toml", &text, &[]).unwrap();
        match Model::new(&scene) {
            Err(ModelError::Scene(error)) => verify(&error, &text, line_of(&text, marker), says, remedy),
            Err(error) => panic!("not the scene's fault: {error}"),
            Ok(_) => panic!("accepted:\n{text}"),
        }
    }
}
