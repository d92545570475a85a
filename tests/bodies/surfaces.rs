//! Surfaces of triangles as obstacles, from STL and Gmsh files, against the shapes that they stand for; and what is wrong with
//! the obstacles and the friction of a scene.

#![allow(clippy::unwrap_used)]

use std::fmt::Write as _;

use crate::common::edit;
use crate::common::faults::{BLOCK, line_of, verify};
use crate::common::scratch::Scratch;
use crate::common::{Keep, run};
use stickslip::history::Status;
use stickslip::model::{Model, ModelError};
use stickslip::problem::State;
use stickslip::scene::{Scene, SceneError};

type Triangle = [[f64; 3]; 3];

/// The upper part of a cylinder of radius 2 about y, with its apex in the origin, in strips; seen from above.
fn cylinder(strips: usize, from: f64, to: f64) -> Vec<Triangle> {
    let at = |k: usize, y: f64| {
        let angle = 0.6 * (2.0 * k as f64 / strips as f64 - 1.0);
        [2.0 * angle.sin(), y, 2.0 * angle.cos() - 2.0]
    };
    (0..strips)
        .flat_map(|k| {
            let [a, b, c, d] = [at(k, from), at(k + 1, from), at(k + 1, to), at(k, to)];
            [[a, b, c], [a, c, d]]
        })
        .collect()
}

fn ascii(triangles: &[Triangle]) -> String {
    let mut text = "solid cylinder\n".to_string();
    for corners in triangles {
        text += " facet normal 0 0 0\n  outer loop\n";
        for [x, y, z] in corners {
            writeln!(text, "   vertex {x:e} {y:e} {z:e}").unwrap();
        }
        text += "  endloop\n endfacet\n";
    }
    text + "endsolid cylinder\n"
}

fn binary(triangles: &[Triangle]) -> Vec<u8> {
    let mut bytes = vec![0; 80];
    bytes.extend((triangles.len() as u32).to_le_bytes());
    for corners in triangles {
        bytes.extend([0; 12]);
        corners.iter().flatten().for_each(|c| bytes.extend((*c as f32).to_le_bytes()));
        bytes.extend([0; 2]);
    }
    bytes
}

/// Half a block above the origin on an obstacle, pressed down.
fn slab(obstacle: &str) -> String {
    format!(
        r#"
        [mesh]
        kind = "block"
        size = [1.0, 0.2, 0.5]
        elements = [16, 2, 6]
        [material]
        young = 1e9
        poisson = 0.3
        [[support]]
        boundary = "top"
        fix = ["x", "y", "z"]
        [[contact]]
        boundary = "bottom"
        friction = 0.2
        obstacle = {{ {obstacle} }}
        [time]
        end = 2.0
        increments = 2
        "#
    )
}

fn solved(text: &str) -> (Model, Vec<State>) {
    let scene = Scene::parse("slab.toml", text, &[]).unwrap();
    let (model, mut keep) = (Model::new(&scene).unwrap(), Keep::default());
    assert_eq!(run(&scene, &model, &mut keep).status, Status::Converged);
    (model, keep.states)
}

const MOTION: &str = "approach = [[0, 0], [1, 2e-2], [2, 2e-2]], motion.translation = [[1, 0, 0, 0], [2, 0.05, 0, 0]]";

/// A cylinder that presses and passes, exact and of triangles, whose apexes lie on it: as far apart as flat strips are, with
/// either direction of the gaps. The body ends where the sheet does, and nodes stand over edges of it.
#[test]
fn a_cylinder_of_triangles_is_a_cylinder() {
    let exact = |direction: &str| {
        solved(&slab(&format!(
            "kind = \"cylinder\", radius = 2.0, apex = [0, 0, 0], axis = [0, 1, 0], direction = \"{direction}\", {MOTION}"
        )))
    };
    let strips = 400;
    let triangles = cylinder(strips, 0.0, 0.2);
    let text = Scratch::new("cylinder.stl", ascii(&triangles).as_bytes());
    // In mm, and in single precision.
    let thousand: Vec<Triangle> = triangles.iter().map(|t| t.map(|x| x.map(|c| 1e3 * c))).collect();
    let bytes = Scratch::new("binary.stl", &binary(&thousand));
    // The chord of a strip is so far below its arc.
    let sagitta = 2.0 * (1.0 - (0.6 / strips as f64).cos());
    for direction in ["normal", "nearest"] {
        let (round, of_round) = exact(direction);
        for (file, scale, slack) in [(&text, 1.0, 1e-12), (&bytes, 1e-3, 1e-7)] {
            let (model, states) = solved(&slab(&format!(
                "kind = \"surface\", file = \"{}\", scale = {scale}, direction = \"{direction}\", {MOTION}",
                file.path()
            )));
            assert_eq!(model.contacts.len(), round.contacts.len());
            for t in [0.0, 1.0, 2.0] {
                let gaps = model.loading.gaps_at(t).into_iter().zip(round.loading.gaps_at(t));
                for (contact, (gap, exact)) in model.contacts.iter().zip(gaps) {
                    let off = gap - exact;
                    // Nearest normals are those of the strips, and turn by half a strip's angle at most.
                    let leaning = if direction == "nearest" { 0.06 / strips as f64 } else { 0.0 };
                    assert!(
                        -slack - leaning <= off && off <= 1.2 * sagitta + slack + leaning,
                        "{direction} {t} {:?}: {gap} {exact}",
                        contact.position
                    );
                }
            }
            for (state, exact) in states.iter().zip(&of_round) {
                let [force, whole] = [state, exact].map(|state| state.p_n.iter().sum::<f64>());
                assert!(whole > 1e4 && (force / whole - 1.0).abs() < 2e-3, "{direction}: {force} {whole}");
            }
        }
    }
}

/// A sheet that ends under the body leaves the rest open; a die of Gmsh's triangles and quadrilaterals is read, too.
#[test]
fn a_sheet_smaller_than_the_face() {
    let sheet = |from: f64| Scratch::new("sheet.stl", ascii(&cylinder(200, from, 0.2)).as_bytes());
    let nodes = |direction: &str, file: &Scratch| {
        let scene = slab(&format!("kind = \"surface\", file = \"{}\", direction = \"{direction}\"", file.path()));
        Model::new(&Scene::parse("slab.toml", &scene, &[]).unwrap()).unwrap().contacts.len()
    };
    let (whole, part) = (sheet(0.0), 3 * 17);
    assert_eq!([nodes("normal", &whole), nodes("nearest", &whole)], [part; 2]);
    let narrow = sheet(0.06);
    assert_eq!([nodes("normal", &narrow), nodes("nearest", &narrow)], [2 * 17; 2]);
    // A square of two by two metres at z = -0.125, as two triangles and a quadrilateral.
    let square = "$MeshFormat\n4.1 0 8\n$EndMeshFormat\n$Entities\n0 0 1 0\n1 -1 -1 0 1 1 0 0 0\n$EndEntities\n\
        $Nodes\n1 6 1 6\n2 1 0 6\n1\n2\n3\n4\n5\n6\n-1 -1 -.125\n0.3 -1 -.125\n1 -1 -.125\n1 1 -.125\n0.3 1 -.125\n-1 1 -.125\n\
        $EndNodes\n$Elements\n2 3 1 3\n2 1 3 1\n1 1 2 5 6\n2 1 2 2\n2 2 3 4\n3 2 4 5\n$EndElements\n";
    let square = Scratch::new("square.msh", square.as_bytes());
    let scene = slab(&format!("kind = \"surface\", file = \"{}\"", square.path()));
    let model = Model::new(&Scene::parse("slab.toml", &scene, &[]).unwrap()).unwrap();
    assert!(model.contacts.len() == part && model.contacts.iter().all(|contact| contact.facing.gap == 0.125));
}

/// Why the scene `text` is refused, by itself or for its mesh.
fn refused(text: &str) -> SceneError {
    match Scene::parse("scene.toml", text, &[]).map(|scene| Model::new(&scene)) {
        Err(error) | Ok(Err(ModelError::Scene(error))) => error,
        Ok(Err(error)) => panic!("not the scene's fault: {error}"),
        Ok(Ok(_)) => panic!("accepted:\n{text}"),
    }
}

#[test]
#[allow(clippy::too_many_lines)] // A list.
fn bad_friction_and_obstacles_of_a_block() {
    let block = edit(BLOCK, "[100, 100]", "[4, 4]");
    let rests = "{ kind = \"plane\", gap = 1e-5 }";
    for (from, to, marker, says, help) in [
        (
            "friction = 0.4",
            "friction = \"0.4 * r\"",
            "friction =",
            "`r` is neither x, y nor z",
            "Coulomb's coefficient",
        ),
        ("friction = 0.4", "friction = \"\"", "friction =", "nothing is given", "Coulomb's coefficient"),
        (
            "friction = 0.4",
            "friction = [0.4]",
            "friction =",
            "expected a number or a formula in quotes",
            "form of every",
        ),
        (
            "friction = 0.4",
            "friction = \"x - 0.6\"",
            "friction =",
            "the friction is -0.35 at the contact node at",
            "max(0",
        ),
        (
            "friction = 0.4",
            "friction = \"1 / (x - 0.5)^2\"",
            "friction =",
            "the friction is inf at",
            "mend the formula",
        ),
        (
            "friction = 0.4",
            "friction = 0.4\nfriction_history = [[0, 1], [1, 0]]",
            "friction_history",
            "friction_history is [[0.0, 1.0], [1.0, 0.0]], but must be of factors above 0",
            "1e-3",
        ),
        (
            "friction = 0.4",
            "friction = 0.4\nfriction_history = [[1, 1], [0, 2]]",
            "friction_history",
            "from time 1 to 0, but times must increase",
            "order the points",
        ),
        (rests, "[]", "obstacle =", "there is no obstacle in front of `bottom`", "remove the contact"),
        (
            rests,
            "[{ kind = \"plane\" },\n{ kind = \"plane\",\nradius = 1 }]",
            "radius",
            "a plane has no radius",
            "remove",
        ),
        (
            rests,
            "[{ kind = \"plane\" },\n{ kind = \"cylinder\",\napex = [0, 0] }]",
            "kind = \"cyl",
            "needs radius",
            "add",
        ),
        (rests, "[{ kind = \"plane\",\ngap = nan }]", "gap = nan", "gap is NaN", "other than nan"),
        (rests, "[{ kind = \"plane\" }, \"plane\"]", "obstacle =", "string \"plane\"", "form of every value"),
        (
            rests,
            "[{ kind = \"plane\" },\n{ kind = \"plane\", gap = 1 }]",
            "{ kind = \"plane\", gap = 1 }",
            "no node of `bottom` meets this obstacle",
            "boundary of its own",
        ),
        (
            rests,
            "{ kind = \"cylinder\", radius = 0.1, apex = [3, 0] }",
            "obstacle =",
            "in front of no node of `bottom`, now or later",
            "move the obstacle",
        ),
        (rests, "{ kind = \"bore\", radius = -1.0, apex = [0, 0] }", "obstacle =", "radius is -1.0", "radius in m"),
        (
            rests,
            "{ kind = \"bore\", radius = 0.3, apex = [0.5, -0.1] }",
            "obstacle =",
            "narrower than the body at the contact node at (0, 0)",
            "larger radius",
        ),
        (
            rests,
            "{ kind = \"bore\", radius = 0.9, apex = [0.5, -0.6], motion.translation = [[0, 0, 0], [2, 0.6, 0]] }",
            "obstacle =",
            "the bore or socket moves over the contact node at (0, 0)",
            "less far aside",
        ),
        (
            rests,
            "{ kind = \"socket\", radius = 9.0, apex = [0.5, -0.1] }",
            "obstacle =",
            "the obstacle is a socket, but the body has two dimensions",
            "cylinder",
        ),
        (
            rests,
            "{ kind = \"cone\", half_angle = 1.0, apex = [0.5, -0.1] }",
            "obstacle =",
            "the obstacle is a cone, but",
            "wedge",
        ),
        (rests, "{ kind = \"surface\", file = \"die.stl\" }", "obstacle =", "the obstacle is a surface, but", "table"),
        (rests, "{ kind = \"cone\", apex = [0.5, -0.1] }", "obstacle =", "a cone needs half_angle", "add the key"),
        (
            rests,
            "{ kind = \"cylinder\", half_angle = 1, radius = 1, apex = [0.5, -0.1] }",
            "obstacle =",
            "a cylinder has no half_angle",
            "remove",
        ),
        (rests, "{ kind = \"surface\" }", "obstacle =", "a surface needs file", "add the key"),
        (rests, "{ kind = \"plane\", scale = 2 }", "obstacle =", "a plane has no scale", "remove"),
        (rests, "{ kind = \"bore\", radius = 2 }", "obstacle =", "a bore needs apex or center", "add one of them"),
        (
            rests,
            "{ kind = \"cylinder\", radius = 2,\napex = [0.5, 0],\ncenter = [0.5, -2] }",
            "center =",
            "a cylinder has both apex and center",
            "keep one",
        ),
        (rests, "{ kind = \"wedge\", angle = 1, center = [0.5, -2] }", "obstacle =", "a wedge has no center", "remove"),
        (
            rests,
            "{ kind = \"bore\", radius = 2, center = [0.5, 2, 1] }",
            "obstacle =",
            "the place of the obstacle leaves the plane",
            "two components",
        ),
        (
            rests,
            "{ kind = \"bore\", radius = 2, center = [0.5, nan] }",
            "obstacle =",
            "center is [0.5, NaN], but must be finite numbers",
            "other than nan",
        ),
        (
            "friction = 0.4",
            "friction = 0\nfriction_history = [[0, 1], [1, 2]]",
            "friction_history",
            "friction_history multiplies a friction that is 0 on the whole of `bottom`",
            "remove the key",
        ),
        (
            "friction = 0.4",
            "friction = \"0 * x\"\nfriction_history = [[0, 1], [1, 2]]",
            "friction_history",
            "friction_history multiplies a friction that is 0 on the whole of `bottom`",
            "remove the key",
        ),
        (
            "friction = 0.4",
            "friction = \"0.1 * z\"",
            "friction =",
            "`0.1 * z` has z, but the body has two",
            "y points up",
        ),
        (
            rests,
            "{ kind = \"formula\", formula = \"max(0, z)\" }",
            "obstacle =",
            "`max(0, z)` has z, but the body has two dimensions",
            "use x and y",
        ),
    ] {
        let text = edit(&block, from, to);
        verify(&refused(&text), &text, line_of(&text, marker), &[says], help);
    }
}

#[test]
fn bad_cones_and_surfaces_in_space() {
    let cube = edit(include_str!("../../data/scenes/cube.toml"), "[10, 10, 10]", "[2, 2, 2]");
    let flat = vec![[[0.0, 0.0, -0.1], [1.0, 0.0, -0.1], [0.0, 1.0, -0.1]]];
    let turned = vec![flat[0], [[1.0, 0.0, -0.1], [0.0, 1.0, -0.1], [1.0, 1.0, -0.1]]];
    let below: Vec<Triangle> = flat.iter().map(|[a, b, c]| [*a, *c, *b]).collect();
    let line = vec![[[0.0; 3], [1.0, 0.0, 0.0], [2.0, 0.0, 0.0]]];
    let mut cut = binary(&flat);
    cut.pop();
    let [good, turned, below, line, nan, cut, word] = [
        ("good", ascii(&flat).into_bytes()),
        ("turned", ascii(&turned).into_bytes()),
        ("below", ascii(&below).into_bytes()),
        ("line", binary(&line)),
        ("nan", binary(&[[[f64::NAN; 3]; 3]])),
        ("cut", cut),
        ("word", ascii(&flat).replacen("vertex", "vortex", 1).into_bytes()),
    ]
    .map(|(name, bytes)| Scratch::new(name, &bytes));
    let surface = |file: &Scratch, more: &str| format!("kind = \"surface\", file = \"{}\"{more}", file.path());
    let counter = "counterclockwise seen from the body";
    for (obstacle, says, help) in [
        (
            "kind = \"cone\", apex = [0.5, 0.5, -0.1], half_angle = 1.6".to_string(),
            "half_angle is 1.6",
            "between the axis",
        ),
        ("kind = \"cone\", apex = [0.5, 0.5, -0.1], half_angle = 0".to_string(), "half_angle is 0.0", "in rad"),
        (
            "kind = \"cone\", apex = [0.5, 0.5], half_angle = 1".to_string(),
            "apex of the obstacle has two components",
            "[x, y, z]",
        ),
        (
            "kind = \"cone\", apex = [0.5, 0.5, -0.1], half_angle = 1, axis = [0, 0, 1]".to_string(),
            "the axis of the cone points into the body",
            "out of the body",
        ),
        ("kind = \"bore\", radius = 2, apex = [0.5, 0.5, -0.1]".to_string(), "needs an axis", "[0, 1, 0]"),
        (
            "kind = \"socket\", radius = 0.2, apex = [0.5, 0.5, -0.1]".to_string(),
            "narrower than the body",
            "larger radius",
        ),
        ("kind = \"surface\", file = \"nowhere.stl\"".to_string(), "the surface cannot be read", counter),
        (surface(&good, ", scale = 0"), "scale is 0.0, but must be positive", "the file's unit"),
        (surface(&good, ", scale = -1"), "scale is -1.0, but must be positive", "the file's unit"),
        (surface(&turned, ""), "two triangles at (1, 0, -0.1) m are turned to different sides", counter),
        (surface(&below, ""), "in front of no node of `bottom`, now or later", counter),
        (surface(&line, ""), "no triangle with an area", counter),
        (surface(&nan, ""), "no finite number", counter),
        (surface(&cut, ""), "neither STL, ASCII or binary and complete, nor of Gmsh", counter),
        (surface(&word, ""), ":4: `vortex` is no word of an STL file", counter),
    ] {
        let text = edit(&cube, "kind = \"plane\", gap = 1e-5", &obstacle);
        verify(&refused(&text), &text, line_of(&text, "obstacle ="), &[says], help);
    }
    // A punch smaller than the face: to the nodes beside it its nearest points are along the face.
    let [a, b, c, d] = [[0.4, 0.4, 0.0], [0.6, 0.4, 0.0], [0.5, 0.6, 0.0], [0.5, 0.5, -0.3]];
    let punch = Scratch::new("punch", &ascii(&[[a, b, c], [b, a, d], [c, b, d], [a, c, d]]).into_bytes());
    let (beside, along) = ("direction = \"nearest\"", "kind = \"sphere\", radius = 0.2, center = [0.5, 0.5, 0.1]");
    for obstacle in [surface(&punch, &format!(", {beside}, scale = 1")), format!("{along}, {beside}")] {
        let text = edit(&cube, "kind = \"plane\", gap = 1e-5", &obstacle);
        let says =
            "the nearest point of the obstacle is beside or behind the contact node at (0, 0, 0) m, from which the way";
        verify(&refused(&text), &text, line_of(&text, "obstacle ="), &[says], "direction = \"normal\"");
    }
    let text = edit(&cube, "kind = \"plane\", gap = 1e-5", &surface(&good, ""));
    assert!(Model::new(&Scene::parse("scene.toml", &text, &[]).unwrap()).is_ok());
}
