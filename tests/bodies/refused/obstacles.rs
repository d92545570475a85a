//! What is wrong with the obstacles and the friction of a scene.

use crate::common::prelude::*;
use crate::contact::surfaces::{Triangle, ascii, binary};

const OF_THE_BLOCK: &str = r#"
friction = 0.4 | friction = "0.4 * r" | friction = | `r` is neither x, y nor z | Coulomb's coefficient
friction = 0.4 | friction = "" | friction = | nothing is given | Coulomb's coefficient
friction = 0.4 | friction = [0.4] | friction = | expected a number or a formula in quotes | form of every
friction = 0.4 | friction = "x - 0.6" | friction = | the friction is -0.35 at the contact node at | max(0
friction = 0.4 | friction = "1 / (x - 0.5)^2" | friction = | the friction is inf at | mend the formula
friction = 0.4 | friction = 0.4¶friction_history = [[0, 1], [1, -1]] | friction_history |
    friction_history is [[0.0, 1.0], [1.0, -1.0]], but must be of factors from 0 on | negative
friction = 0.4 | friction = 0.4¶friction_history = [[1, 1], [0, 2]] | friction_history |
    from time 1 to 0, but times must increase | order the points
{ kind = "plane", gap = 1e-5 } | [] | obstacle = | there is no obstacle in front of `bottom` | remove the contact
{ kind = "plane", gap = 1e-5 } | [{ kind = "plane" },¶{ kind = "plane",¶radius = 1 }] | radius | a plane has no radius |
    remove
{ kind = "plane", gap = 1e-5 } | [{ kind = "plane" },¶{ kind = "cylinder",¶apex = [0, 0] }] | kind = "cyl |
    needs radius | add
{ kind = "plane", gap = 1e-5 } | [{ kind = "plane",¶gap = nan }] | gap = nan | gap is NaN | other than nan
{ kind = "plane", gap = 1e-5 } | [{ kind = "plane" }, "plane"] | obstacle = | string "plane" | form of every value
{ kind = "plane", gap = 1e-5 } | [{ kind = "plane" },¶{ kind = "plane", gap = 1 }] | { kind = "plane", gap = 1 } |
    no node of `bottom` meets this obstacle | boundary of its own
{ kind = "plane", gap = 1e-5 } | { kind = "cylinder", radius = 0.1, apex = [3, 0] } | obstacle = |
    in front of no node of `bottom`, now or later | move the obstacle
{ kind = "plane", gap = 1e-5 } | { kind = "bore", radius = -1.0, apex = [0, 0] } | obstacle = | radius is -1.0 |
    radius in m
{ kind = "plane", gap = 1e-5 } | { kind = "bore", radius = 0.3, apex = [0.5, -0.1] } | obstacle = |
    narrower than the body at the contact node at (0, 0) | larger radius
{ kind = "plane", gap = 1e-5 } |
    { kind = "bore", radius = 0.9, apex = [0.5, -0.6], motion.translation = [[0, 0, 0], [2, 0.6, 0]] } | obstacle = |
    the bore or socket moves over the contact node at (0, 0) | less far aside
{ kind = "plane", gap = 1e-5 } | { kind = "socket", radius = 9.0, apex = [0.5, -0.1] } | obstacle = |
    the obstacle is a socket, but the body has two dimensions | cylinder
{ kind = "plane", gap = 1e-5 } | { kind = "cone", half_angle = 1.0, apex = [0.5, -0.1] } | obstacle = |
    the obstacle is a cone, but | wedge
{ kind = "plane", gap = 1e-5 } | { kind = "surface", file = "die.stl" } | obstacle = | the obstacle is a surface, but |
    table
{ kind = "plane", gap = 1e-5 } | { kind = "cone", apex = [0.5, -0.1] } | obstacle = | a cone needs half_angle |
    add the key
{ kind = "plane", gap = 1e-5 } | { kind = "cylinder", half_angle = 1, radius = 1, apex = [0.5, -0.1] } | obstacle = |
    a cylinder has no half_angle | remove
{ kind = "plane", gap = 1e-5 } | { kind = "surface" } | obstacle = | a surface needs file | add the key
{ kind = "plane", gap = 1e-5 } | { kind = "plane", scale = 2 } | obstacle = | a plane has no scale | remove
{ kind = "plane", gap = 1e-5 } | { kind = "bore", radius = 2 } | obstacle = | a bore needs apex or center |
    add one of them
{ kind = "plane", gap = 1e-5 } | { kind = "cylinder", radius = 2,¶apex = [0.5, 0],¶center = [0.5, -2] } | center = |
    a cylinder has both apex and center | keep one
{ kind = "plane", gap = 1e-5 } | { kind = "wedge", angle = 1, center = [0.5, -2] } | obstacle = |
    a wedge has no center | remove
{ kind = "plane", gap = 1e-5 } | { kind = "bore", radius = 2, center = [0.5, 2, 1] } | obstacle = |
    the place of the obstacle leaves the plane | two components
{ kind = "plane", gap = 1e-5 } | { kind = "bore", radius = 2, center = [0.5, nan] } | obstacle = |
    center is [0.5, NaN], but must be finite numbers | other than nan
friction = 0.4 | friction = 0¶friction_history = [[0, 1], [1, 2]] | friction_history |
    friction_history multiplies a friction that is 0 on the whole of `bottom` | remove the key
friction = 0.4 | friction = "0 * x"¶friction_history = [[0, 1], [1, 2]] | friction_history |
    friction_history multiplies a friction that is 0 on the whole of `bottom` | remove the key
friction = 0.4 | friction = "0.1 * z" | friction = | `0.1 * z` has z, but the body has two | y points up
{ kind = "plane", gap = 1e-5 } | { kind = "formula", formula = "max(0, z)" } | obstacle = |
    `max(0, z)` has z, but the body has two dimensions | use x and y
"#;

#[test]
fn bad_friction_and_obstacles_of_a_block() {
    verify_all(&edit(BLOCK, "[100, 100]", "[4, 4]"), OF_THE_BLOCK, refused);
}

/// Obstacles of a cube, with words of the message and of the help; the names of files are in capitals.
const IN_SPACE: &str = r#"
kind = "cone", apex = [0.5, 0.5, -0.1], half_angle = 1.6 | half_angle is 1.6 | between the axis
kind = "cone", apex = [0.5, 0.5, -0.1], half_angle = 0 | half_angle is 0.0 | in rad
kind = "cone", apex = [0.5, 0.5], half_angle = 1 | apex of the obstacle has two components | [x, y, z]
kind = "cone", apex = [0.5, 0.5, -0.1], half_angle = 1, axis = [0, 0, 1] | the axis of the cone points into the body |
    out of the body
kind = "bore", radius = 2, apex = [0.5, 0.5, -0.1] | needs an axis | [0, 1, 0]
kind = "socket", radius = 0.2, apex = [0.5, 0.5, -0.1] | narrower than the body | larger radius
kind = "surface", file = "nowhere.stl" | the surface cannot be read | counterclockwise seen from the body
kind = "surface", file = "GOOD", scale = 0 | scale is 0.0, but must be positive | the file's unit
kind = "surface", file = "GOOD", scale = -1 | scale is -1.0, but must be positive | the file's unit
kind = "surface", file = "TURNED" | two triangles at (1, 0, -0.1) m are turned to different sides |
    counterclockwise seen from the body
kind = "surface", file = "BELOW" | in front of no node of `bottom`, now or later | counterclockwise seen from the body
kind = "surface", file = "LINE" | no triangle with an area | counterclockwise seen from the body
kind = "surface", file = "NAN" | no finite number | counterclockwise seen from the body
kind = "surface", file = "CUT" | neither STL, ASCII or binary and complete, nor of Gmsh |
    counterclockwise seen from the body
kind = "surface", file = "WORD" | :4: `vortex` is no word of an STL file | counterclockwise seen from the body
"#;

#[test]
fn bad_cones_and_surfaces_in_space() {
    let cube = edit(CUBE, "[10, 10, 10]", "[2, 2, 2]");
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
    let files = [
        ("GOOD", &good),
        ("TURNED", &turned),
        ("BELOW", &below),
        ("LINE", &line),
        ("NAN", &nan),
        ("CUT", &cut),
        ("WORD", &word),
    ];
    let surface = |file: &Scratch, more: &str| format!("kind = \"surface\", file = \"{}\"{more}", file.path());
    for [obstacle, says, help] in rows(IN_SPACE) {
        let obstacle = files.iter().fold(obstacle, |text, (name, file)| text.replace(name, file.path()));
        let text = edit(&cube, "kind = \"plane\", gap = 1e-5", &obstacle);
        verify(&refused(&text), &text, line_of(&text, "obstacle ="), &says, &help);
    }
    // A punch smaller than the face: to the nodes beside it its nearest points are along the face.
    let [a, b, c, d] = [[0.4, 0.4, 0.0], [0.6, 0.4, 0.0], [0.5, 0.6, 0.0], [0.5, 0.5, -0.3]];
    let punch = Scratch::new("punch", &ascii(&[[a, b, c], [b, a, d], [c, b, d], [a, c, d]]).into_bytes());
    let (beside, along) = ("direction = \"nearest\"", "kind = \"sphere\", radius = 0.2, center = [0.5, 0.5, 0.1]");
    for obstacle in [surface(&punch, &format!(", {beside}, scale = 1")), format!("{along}, {beside}")] {
        let text = edit(&cube, "kind = \"plane\", gap = 1e-5", &obstacle);
        let says =
            "the nearest point of the obstacle is beside or behind the contact node at (0, 0, 0) m, from which the way";
        verify(&refused(&text), &text, line_of(&text, "obstacle ="), says, "direction = \"normal\"");
    }
    let text = edit(&cube, "kind = \"plane\", gap = 1e-5", &surface(&good, ""));
    assert!(discretise(&parsed(&text)).is_ok());
}
