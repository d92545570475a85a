//! Scenes of bodies in contact: what is refused, where, and with which words.

use crate::common::prelude::*;

use crate::common::faults::{line_of, located, verify};

const TWO_BLOCKS: &str = include_str!("../../data/scenes/two_blocks.toml");
const FRICTION: &str = "friction = 0.2\n";

/// What is put in place of what, the line, words of the message and of the help.
type Case = (&'static str, &'static str, &'static str, &'static str, &'static str);

#[test]
fn what_cannot_be_read_is_told_at_its_place() {
    let cases: &[Case] = &[
        (FRICTION, FRICTION_AND_PLANE, "against =", "both an obstacle and a boundary", "keep one of them"),
        ("against = \"lower:top\"\n", "", "[[contact]]", "a contact needs an obstacle or a boundary", "against ="),
        (FRICTION, "friction = 0.2\nglue = true\n", "friction =", "what is glued has no friction", "remove the key"),
        ("against = \"lower:top\"", "against = \"upper:bottom\"", "against =", "is against itself", "in front of it"),
        (FRICTION, "", "[[contact]]", "a contact needs its friction", "add friction = 0.3"),
        (FRICTION, "friction = 0.2\nsearch = 0\n", "search =", "search is 0.0", "the distance in m"),
        (
            FRICTION,
            "friction = 0.2\nadjust = -1\n",
            "adjust =",
            "adjust is -1.0, but must be 0 or more",
            "a distance in m",
        ),
        (FRICTION, "friction = 0.2\ngap = 0\nadjust = 1e-6\n", "adjust =", "left out where gap says", "remove the key"),
        (FRICTION, "friction = 0.2\ngap = \"1 +\"\n", "gap =", "something is missing", "\"measured\""),
        (FRICTION, "friction = 0.2\ngap = \"curve\"\n", "gap =", "curve", "\"measured\""),
        (FRICTION, "glue = true\ngap = 1e-5\n", "gap =", "left out where bodies are glued", "remove the key"),
        (FRICTION, "friction = 0.2\ngap = \"measured\"\nadjust = -1\n", "adjust =", "0 or more", "a distance in m"),
        (
            "against = \"lower:top\"",
            "obstacle = { kind = \"plane\" }\ngap = \"measured\"",
            "gap =",
            "a contact with an obstacle",
            "remove",
        ),
        (FRICTION, "friction = 0.2\ndirection = [0, 0]\n", "direction =", "a vector with a direction", "[0, -1]"),
    ];
    for &(from, to, marker, says, help) in cases {
        let text = edit(TWO_BLOCKS, from, to);
        verify(&located(&text), &text, line_of(&text, marker), &[says], help);
    }
}

const FRICTION_AND_PLANE: &str = "friction = 0.2\nobstacle = { kind = \"plane\" }\n";

#[test]
fn what_the_meshes_tell_is_told_at_its_place() {
    let cases: &[Case] = &[
        ("against = \"lower:top\"", "against = \"top\"", "against =", "no boundary `top`", "lower:top"),
        ("at = [0.0, 0.5]", "at = [0.0, 0.8]", "[[contact]]", "nothing of `lower:top` is in front", "longer `search`"),
        ("at = [0.0, 0.5]", "at = [0.0, 0.35]", "against =", "inside each other", "move a body out"),
        (
            FRICTION,
            "friction = 0.2\ndirection = [0, 1]\n",
            "direction =",
            "points into the body",
            "turn the direction round",
        ),
        (FRICTION, "friction = 0.2\ngap = \"sqrt(-x - 1)\"\n", "gap =", "the gap is NaN", "mend the formula"),
    ];
    for &(from, to, marker, says, help) in cases {
        let text = edit(TWO_BLOCKS, from, to);
        let text =
            if says == "inside each other" { edit(&text, FRICTION, "friction = 0.2\nsearch = 0.3\n") } else { text };
        let stickslip::run::RunError::Scene(error) =
            discretise(&Scene::parse("scene.toml", &text, &[]).unwrap()).unwrap_err()
        else {
            panic!("{to}")
        };
        verify(&error, &text, line_of(&text, marker), &[says], help);
    }
}
