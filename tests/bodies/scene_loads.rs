//! Supports, springs and loads that cannot be, each told with file, line and cure.

use crate::common::prelude::*;

use crate::common::faults::{BLOCK, InputError, line_of, verify, verify_all};

const FIX: &str = "fix = [\"x\", \"y\"]";
const TRACTION: &str = "traction = [0.0, -10e6]";
const FACES: &str = "boundary = \"top\"\ntraction = [0.0, -10e6]";

/// Refused as the scene is read.
const READ: &[InputError] = &[
    (FIX, "fix = []", "fix =", &["fix is empty"], "[\"x\", \"y\"]"),
    (FIX, "fix = [\"n\"]", "fix =", &["unknown variant `n`"], "one of the values"),
    (FIX, "fix = [\"x\"]\ndirection = [1, 1]", "direction", &["both fix and direction"], "keep one"),
    (FIX, "direction = [0, 0]", "direction", &["a vector with a direction"], "give e.g."),
    (FIX, "direction = [nan, 1]", "direction", &["finite"], "not nan"),
    (FIX, "fix = [\"x\"]\ndisplacement = [1, 2]", "displacement", &["2 values", "holds 1"], "in the order of fix"),
    (FIX, "fix = [\"x\"]\ndisplacement = inf", "displacement", &["finite"], "other than nan"),
    (FIX, "fix = [\"x\"]\nhistory = [[0, 1]]", "history = [[0, 1]]", &["moves nothing"], "add a displacement"),
    (
        FIX,
        "fix = [\"x\"]\ndisplacement = 1\nhistory = [[1, 1], [0, 0]]",
        "history = [[1, 1], [0, 0]]",
        &["times must increase"],
        "order the points",
    ),
    (FIX, "fix = [\"x\"]\npoint = [0, 0]", "point", &["both boundary and point"], "keep one"),
    ("boundary = \"left\"\n", "", "[[support]]", &["needs a boundary, a point or a coupling"], "add one"),
    (
        "boundary = \"left\"\nfix = [\"x\", \"y\"]",
        "point = [0, 0]\nfix = [\"normal\"]",
        "fix",
        &["single point"],
        "direction",
    ),
    (TRACTION, "", "# Q2", &["a load does nothing"], "add one of traction"),
    (TRACTION, "traction = [0, \"2 x\"]", "traction", &["the formula", "operator is missing"], "a formula of x"),
    (TRACTION, "traction = [0, 1, 2, 3]", "traction", &["two or three"], "each axis"),
    (TRACTION, "pressure = 1\nforce = [0, 1]", "force", &["both pressure and force"], "two loads"),
    (TRACTION, "pressure = nan", "pressure", &["finite"], "other than nan"),
    (TRACTION, "pressure = true", "pressure", &["a number or a formula"], "shows the form"),
    (TRACTION, "force = [0, nan]", "force", &["finite"], "not nan"),
    (
        TRACTION,
        "acceleration = [0, -9.81]",
        "boundary = \"top\"",
        &["an acceleration has no boundary"],
        "remove the key",
    ),
    (FACES, "acceleration = [1]", "acceleration", &["two or three"], "each axis"),
    (FACES, "rotation = { through = [0, 0], speed = inf }", "rotation", &["speed", "finite"], "other than nan"),
    (FACES, "rotation = { through = [0, 0], speed = 1, axis = [0, 0, 0] }", "rotation", &["a direction"], "give e.g."),
    (FACES, "temperature = \"20 +\"", "temperature", &["the formula"], "a formula of x"),
    ("[time]", "[[spring]]\nboundary = \"top\"\n[time]", "[[spring]]", &["needs a stiffness"], "stiffness per area"),
    ("[time]", "[[spring]]\nnormal = 1\n[time]", "[[spring]]", &["needs a boundary, a point or a coupling"], "add one"),
    ("[time]", "[[spring]]\nboundary = \"top\"\nnormal = -1\n[time]", "normal = -1", &["0 or more"], "stiffness"),
    ("[time]", "[[spring]]\nboundary = \"top\"\nnormal = 0\n[time]", "normal = 0", &["not 0 throughout"], "stiffness"),
    (
        "[time]",
        "[[spring]]\nboundary = \"top\"\nnormal = 1\nstiffness = [1, 1]\n[time]",
        "normal = 1",
        &["has no normal"],
        "remove the key",
    ),
    ("[time]", "[[spring]]\npoint = [0, 0]\nnormal = 1\n[time]", "[[spring]]", &["at a point needs stiffness"], "axes"),
    ("poisson = 0.3", "poisson = 0.3\ndensity = 0", "density", &["positive"], "kg/m"),
    ("poisson = 0.3", "poisson = 0.3\nexpansion = nan", "expansion", &["finite"], "other than nan"),
];

/// Refused when the mesh is known.
const BUILT: &[InputError] = &[
    (FIX, "fix = [\"z\"]", "fix", &["two dimensions"], "leave out"),
    (FIX, "direction = [1, 0, 0]", "direction", &["3 components"], "[x, y]"),
    ("boundary = \"left\"", "point = [0.01, 0.3]", "point", &["no node of the mesh is at (0.01, 0.3)"], "the nearest"),
    (FACES, "rotation = { speed = 1 }", "rotation", &["no point of its axis"], "through = [0, 0]"),
    (FACES, "acceleration = [0, 1]", "[material]", &["a load needs the density"], "7850"),
    (FACES, "temperature = 20", "[material]", &["a load needs the expansion"], "12e-6"),
    (FACES, "acceleration = [0, 0, 1]", "acceleration", &["3 components"], "[x, y]"),
    (TRACTION, "force = [0, 0, 1]", "force", &["3 components"], "[x, y]"),
    (TRACTION, "pressure = \"sqrt(-1 - x)\"", "pressure", &["not a finite number everywhere"], "has a value"),
    (TRACTION, "traction = [0, \"1 / (x - x)\"]", "traction", &["not a finite number"], "has a value"),
    (TRACTION, "traction = [0, \"1e6 * z\"]", "traction", &["`1e6 * z` has z, but the body has two"], "use x and y"),
    (FACES, "point = [0.31, 0.77]\nforce = [0, 1]", "point", &["no node"], "the nearest"),
    (
        "[time]",
        "[[spring]]\nboundary = \"roof\"\nnormal = 1\n[time]",
        "boundary = \"roof\"",
        &["no boundary `roof`"],
        "has the",
    ),
    (
        "[time]",
        "[[support]]\nboundary = \"left\"\nfix = [\"x\"]\ndisplacement = 1e-3\n[time]",
        "displacement",
        &["move the node at", "different places"],
        "agree",
    ),
];

#[test]
fn supports_springs_and_loads_that_cannot_be() {
    verify_all(READ);
    for &(from, to, marker, says, remedy) in BUILT {
        let text = edit(&edit(BLOCK, "[100, 100]", "[4, 4]"), from, to);
        let scene = Scene::parse("scene.toml", &text, &[]).unwrap();
        let Err(stickslip::run::RunError::Scene(error)) = discretise(&scene) else { panic!("{to}") };
        verify(&error, &text, line_of(&text, marker), says, remedy);
    }
}

/// A sweep of a displacement goes through 0.
#[test]
fn a_displacement_of_nothing_may_have_a_history() {
    let moved = BLOCK.replacen(FIX, "fix = [\"x\", \"y\"]\ndisplacement = [0, 0]\nhistory = [[0, 0], [1, 1]]", 1);
    assert_ne!(moved, BLOCK);
    discretise(&Scene::parse("scene.toml", &moved, &[]).unwrap()).unwrap();
}
