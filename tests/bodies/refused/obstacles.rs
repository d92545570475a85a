//! Faults of the obstacles and the friction of a scene.

use crate::common::prelude::*;
use crate::contact::surfaces::{Triangle, ascii, binary};

const OF_THE_BLOCK: &str = include_str!("tables/obstacles_in_plane.txt");

#[test]
fn bad_friction_and_obstacles_of_a_block() {
    verify_all(&edit(BLOCK, "[100, 100]", "[4, 4]"), OF_THE_BLOCK, refused);
}

/// Obstacles of a cube, with words of the message and of the help; the names of files are in capitals.
const IN_SPACE: &str = include_str!("tables/obstacles_in_space.txt");

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
