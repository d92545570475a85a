//! What is wrong with a scene is said with file, line, reason and remedy, and nothing wrong gets through.

#![allow(clippy::unwrap_used)]

use std::fs;
use std::ops::Range;
use std::path::Path;

use miette::Diagnostic;
use stickslip::model::{Model, ModelError};
use stickslip::scene::{Scene, SceneError};

const BLOCK: &str = include_str!("../data/scenes/block.toml");

/// What to replace, by what, a text on the line that must be named, words of the message, words of the help.
type Fault = (&'static str, &'static str, &'static str, &'static [&'static str], &'static str);

const REMOVE: &str = "remove the key or correct its spelling";
const ADD: &str = "add the key";
const LISTED: &str = "use one of the values it lists";
const FORM: &str = "shows the form of every value";
const MEND: &str = "mend the TOML here";

const KEYS_AND_TYPES: &[Fault] = &[
    ("title =", "titel =", "titel", &["unknown field `titel`", "`title`"], REMOVE),
    ("[solver]", "[slover]", "[slover]", &["unknown field `slover`", "`solver`"], REMOVE),
    ("poisson =", "poison =", "poison =", &["unknown field `poison`", "`poisson`"], REMOVE),
    ("gap =", "gpa =", "gpa =", &["unknown field `gpa`", "`gap`"], REMOVE),
    ("end =", "ende =", "ende =", &["unknown field `ende`", "`end`"], REMOVE),
    ("history =", "hystory =", "hystory =", &["unknown field `hystory`", "`history`"], REMOVE),
    ("210e9", "\"steel\"", "young =", &["string \"steel\"", "a number"], FORM),
    ("size = [1.0, 1.0]", "size = 1.0", "size =", &["`1.0`", "a list"], FORM),
    ("[100, 100]", "[10.5, 10]", "elements =", &["`10.5`", "a whole number"], FORM),
    ("[2, 1]]", "[2]]", "[2]]", &["invalid length 1", "2 values"], FORM),
    ("increments = 40", "increments = 4.5", "increments =", &["`4.5`", "a whole number"], FORM),
    ("times = [1.0, 2.0]", "times = 1.0", "times =", &["`1.0`", "a list"], FORM),
    ("[[support]]", "[support]", "[support]", &["table", "a list"], FORM),
    ("{ kind = \"plane\", gap = 1e-5 }", "\"plane\"", "obstacle =", &["string \"plane\"", "a table"], FORM),
    ("poisson = 0.3\n", "", "[material]", &["missing field `poisson`"], ADD),
    ("kind = \"block\"\n", "", "[mesh]", &["missing field `kind`"], ADD),
    ("fix = [\"x\", \"y\"]\n", "", "[[support]]", &["missing field `fix`"], ADD),
    ("friction = 0.4\n", "", "[[contact]]", &["missing field `friction`"], ADD),
    ("kind = \"plane\", ", "", "obstacle =", &["missing field `kind`"], ADD),
    ("boundary = \"top\"\n", "", "# Q2\n", &["missing field `boundary`"], ADD),
    ("end = 2.0\n", "", "[time]", &["missing field `end`"], ADD),
    ("young = 210e9", "young = ", "young =", &["expected"], MEND),
    ("[mesh]", "[mesh", "[mesh", &["unclosed table"], MEND),
    ("[\"x\", \"y\"]", "[\"x\" \"y\"]", "fix =", &["comma"], MEND),
    ("poisson = 0.3", "poisson = 0.3\npoisson = 0.2", "poisson = 0.2", &["duplicate key"], MEND),
    ("210e9", "1e999", "young =", &["overflowed"], MEND),
    ("\"block\"", "\"ball\"", "\"ball\"", &["unknown variant `ball`", "`block`"], LISTED),
    ("\"strain\"", "\"strian\"", "\"strian\"", &["unknown variant `strian`", "`strain` or `stress`"], LISTED),
    ("elements =", "element = \"bbar\"\nelements =", "element =", &["unknown variant `bbar`", "`b-bar`"], LISTED),
    ("elements =", "element = 4\nelements =", "element =", &["expected a word in quotes"], FORM),
    ("poisson =", "layers = [[0.1, 1e9]]\npoisson =", "layers =", &["invalid length 2", "3 values"], FORM),
    ("poisson =", "layers = [0.1, 1e9, 0.3]\npoisson =", "layers =", &["`0.1`", "a list"], FORM),
    ("\"y\"]", "\"w\"]", "\"w\"]", &["unknown variant `w`", "`x`"], LISTED),
    ("\"plane\"", "\"cone\"", "\"cone\"", &["unknown variant `cone`", "`plane`"], LISTED),
    ("\"bn\"", "\"newton\"", "\"newton\"", &["unknown variant `newton`", "`bn`"], LISTED),
    ("\"paper\"", "\"mine\"", "\"mine\"", &["unknown variant `mine`", "`paper`"], LISTED),
    ("\"paper\"", "\"paper\"\nlinear = \"cg\"", "\"cg\"", &["unknown variant `cg`", "`umfpack`"], LISTED),
];

const VALUES: &[Fault] = &[
    (
        "\"bn\"",
        "\"bn\"\nr_factor = 2",
        "r_factor",
        &["the method bn in the setting paper has no r_factor"],
        "remove the key",
    ),
    (
        "\"bn\"",
        "\"bn\"\nstart = \"safe\"",
        "start",
        &["the method bn in the setting paper has no start"],
        "remove the key",
    ),
    ("\"bn\"", "\"ip\"\nr_factor = 2", "r_factor", &["the method ip has no r_factor"], "remove the key"),
    (
        "\"bn\"\nsetting = \"paper\"",
        "\"bn\"\nnewton = \"reduced\"",
        "newton",
        &["the method bn has no newton"],
        "remove the key",
    ),
    ("setting = \"paper\"", "r_factor = 0", "r_factor", &["solver.r_factor is 0.0", "positive"], "studies of r"),
    ("setting = \"paper\"", "r_factor = -1.0", "r_factor", &["solver.r_factor is -1.0", "positive"], "studies of r"),
    (
        "method = \"bn\"\nsetting = \"paper\"",
        "method = \"ip\"\npartition = \"cone\"",
        "partition",
        &["the method ip has a start and a partition in the setting paper only"],
        "remove the key",
    ),
    ("friction = 0.4", "friction = -0.1", "friction =", &["friction is -0.1", "0 or more"], "0 for a frictionless"),
    ("0.3", "0.5", "poisson =", &["material.poisson is 0.5", "below 0.5"], "incompressible"),
    ("0.3", "0.7", "poisson =", &["material.poisson is 0.7", "below 0.5"], "0.49"),
    ("0.3", "-1.0", "poisson =", &["material.poisson is -1.0", "above -1"], "0.49"),
    ("210e9", "0.0", "young =", &["material.young is 0.0", "positive"], "Young's modulus in Pa"),
    ("210e9", "-210e9", "young =", &["material.young is -2", "positive"], "Young's modulus in Pa"),
    ("[100, 100]", "[10, 10, 3]", "elements =", &["[10, 10, 3]", "2 numbers of at least 1"], "along each axis"),
    ("[100, 100]", "[10]", "elements =", &["[10]", "2 numbers of at least 1"], "along each axis"),
    (
        "elements =",
        "grading = [1, 2, 3]\nelements =",
        "grading =",
        &["[1.0, 2.0, 3.0]", "2 ratios"],
        "size of the last",
    ),
    (
        "elements =",
        "cells = \"tetrahedron\"\nelements =",
        "cells =",
        &["mesh.cells have 3 dimensions, but mesh.size has 2"],
        "\"triangle\"",
    ),
    ("[0.0, -10e6]", "[0.0]", "traction = [0.0", &["traction is [0.0]", "two or three"], "for each axis"),
    ("[1.0, 1.0]", "[1.0]", "size =", &["mesh.size is [1.0]", "two or three"], "for each axis"),
    (
        "poisson = 0.3\n",
        "poisson = 0.3\nlayers = [[0.1, 1e9, 0.3]]\ngroup = [{ name = \"a\", young = 1e9, poisson = 0.3 }]\n",
        "layers =",
        &["layers and groups"],
        "keep material.layers or",
    ),
    ("[100, 100]", "[0, 100]", "elements =", &["[0, 100]", "at least 1"], "numbers of elements"),
    ("[100, 100]", "[100, -2]", "elements =", &["[100, -2]", "at least 1"], "numbers of elements"),
    ("[100, 100]", "[10000, 10000]", "elements =", &["[10000, 10000]", "at most 50 million"], "coarser mesh"),
    ("[100, 100]", "[4000000000, 5000000000]", "elements =", &["at most 50 million"], "coarser mesh"),
    ("[1.0, 1.0]", "[0.0, 1.0]", "size =", &["mesh.size is [0.0, 1.0]", "positive"], "width and height in m"),
    ("[1.0, 1.0]", "[1.0, -1.0]", "size =", &["mesh.size is [1.0, -1.0]", "positive"], "width and height in m"),
    ("[2, 1]]", "[0.5, 1]]", "[0.5, 1]]", &["from time 1 to 0.5", "increase"], "order the points"),
    ("[2, 1]]", "[1, 0]]", "[1, 0]]", &["from time 1 to 1", "increase"], "each time once"),
    ("[[0, 0], [1, 1], [2, 0]]", "[]", "history = []", &["history is empty"], "[time, factor]"),
    ("[\"x\", \"y\"]", "[]", "fix = []", &["fix is empty"], "[\"x\", \"y\"]"),
    ("gap = 1e-5", "normal = [0, 0]", "normal", &["normal is [0.0, 0.0]", "direction"], "[0, -1]"),
    ("gap = 1e-5", "normal = [0, -1], tangent = [0, 0]", "tangent", &["tangent is [0.0, 0.0]"], "[0, -1]"),
    ("gap = 1e-5", "normal = [0, -1], tangent = [1, 0.1]", "tangent", &["right angles"], "leave the tangent out"),
    ("gap = 1e-5", "tangent = [1, 0]", "tangent", &["right angles to a given normal"], "give both"),
    ("end = 2.0", "end = 0.0", "end =", &["time.end is 0.0", "positive"], "from 0 to this time"),
    ("end = 2.0", "end = -1.0", "end =", &["time.end is -1.0", "positive"], "from 0 to this time"),
    ("\"block\"", "\"half-plane\"", "elements =", &["a half-plane has no mesh.elements"], "remove the key"),
    ("elements =", "layers = 3\nelements =", "layers =", &["a block has no mesh.layers"], "remove the key"),
    ("elements = [100, 100]\n", "", "kind = \"block\"", &["a block needs mesh.elements"], "add the key"),
    (
        "elements = [100, 100]\n\n[material]\nyoung = 210e9                   # Pa\npoisson = 0.3\nplane = \"strain\"",
        "elements = [100, 100]\nelement = \"b-bar\"\n[material]\nyoung = 210e9\npoisson = 0.3\nplane = \"stress\"",
        "element =",
        &["mesh.element is \"b-bar\"", "material.plane is \"stress\""],
        "use \"bilinear\"",
    ),
    ("elements =", "grading = [0, 1]\nelements =", "grading =", &["[0.0, 1.0]", "1e-6 to 1e6"], "size of the last"),
    ("elements =", "grading = [1, -2]\nelements =", "grading =", &["[1.0, -2.0]", "1e-6 to 1e6"], "size of the last"),
    ("elements =", "grading = [1, 1e7]\nelements =", "grading =", &["1e-6 to 1e6"], "size of the last"),
    (
        "\"block\"\nsize = [1.0, 1.0]               # m\nelements = [100, 100]",
        "\"half-plane\"\nsize = [1.0, 1.0]\ngrading = [1, 2]",
        "grading =",
        &["a half-plane has no mesh.grading"],
        "remove the key",
    ),
    (
        "poisson =",
        "layers = [[0.1, 1e9, 0.3],\n[0.0, 1e9, 0.3]]\npoisson =",
        "[0.0, 1e9",
        &["the thickness in material.layers[1] is 0.0", "positive"],
        "thickness of the layer in m",
    ),
    (
        "poisson =",
        "layers = [[0.1, -1.0, 0.3]]\npoisson =",
        "layers =",
        &["Young's modulus in material.layers[0] is -1.0", "positive"],
        "in Pa",
    ),
    (
        "poisson =",
        "layers = [[0.1, 1e9, 0.5]]\npoisson =",
        "layers =",
        &["Poisson's ratio in material.layers[0] is 0.5", "below 0.5"],
        "0.49",
    ),
    ("gap = 1e-5", "radius = 1.0", "radius", &["a plane has no radius"], "remove the key"),
    ("\"plane\", gap = 1e-5", "\"cylinder\"", "cylinder", &["a cylinder needs radius"], "add the key"),
    ("\"plane\", gap = 1e-5", "\"cylinder\", radius = -1.0", "cylinder", &["radius is -1.0", "positive"], "in m"),
    ("\"plane\", gap", "\"cylinder\", gap", "cylinder", &["a cylinder has no gap"], "remove the key"),
    ("gap = 1e-5", "approach = []", "approach", &["approach is empty"], "[time, distance]"),
    ("gap = 1e-5", "approach = [[1, 0], [0, 1]]", "approach", &["from time 1 to 0"], "[time, distance]"),
    ("increments = 40", "increments = 0", "increments =", &["time.increments is 0", "at least 1"], "equal increments"),
    ("increments = 40", "increments = 10000001", "increments =", &["at most 10 million"], "equal increments"),
    ("[1.0, 2.0]", "[0.0, 2.0]", "times =", &["holds 0,", "from 0 to 2"], "after 0 and up to time.end"),
    ("[1.0, 2.0]", "[1.0, 2.5]", "times =", &["holds 2.5,", "from 0 to 2"], "after 0 and up to time.end"),
    ("[1.0, 2.0]", "[-1.0]", "times =", &["holds -1,", "from 0 to 2"], "after 0 and up to time.end"),
    ("\"paper\"", "\"paper\"\nmax_iterations = 0", "max_it", &["max_iterations is 0"], "has not converged"),
    ("\"paper\"", "\"paper\"\ntolerance = 0.0", "tolerance", &["tolerance is 0.0", "above 0"], "e.g. 1e-10"),
    ("\"paper\"", "\"paper\"\ntolerance = 1", "tolerance", &["tolerance is 1.0", "below 1"], "e.g. 1e-10"),
    (
        "[[contact]]",
        "[[contact]]\nboundary = \"bottom\" # again\nfriction = 0\nobstacle = { kind = \"plane\" }\n[[contact]]",
        "boundary = \"bottom\"\n",
        &["`bottom` has a [[contact]] already"],
        "one [[contact]] for each boundary",
    ),
];

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

/// Every number of a scene that gives all there is to give.
const FULL: &[(&str, &str)] = &[
    ("elements =", "grading = [1, 2.0]\nelements ="),
    ("poisson =", "layers = [[0.1, 1e9, 0.2]]\npoisson ="),
    ("gap = 1e-5", "gap = 1e-5, normal = [0.0, -1.0], tangent = [1.0, 0.0]"),
    ("\"paper\"", "\"paper\"\nmax_iterations = 200\ntolerance = 1e-10"),
];

fn edit(text: &str, from: &str, to: &str) -> String {
    assert!(text.contains(from), "the scene has no `{from}` to edit");
    text.replacen(from, to, 1)
}

/// The line (from 1) of the first `marker` in `text`.
fn line_of(text: &str, marker: &str) -> usize {
    let start = text.find(marker).unwrap_or_else(|| panic!("no `{marker}` in\n{text}"));
    line_at(text, start)
}

fn line_at(text: &str, offset: usize) -> usize {
    text[..offset].lines().count().max(1) + usize::from(text[..offset].ends_with('\n'))
}

fn located(text: &str) -> SceneError {
    Scene::parse("block.toml", text, &[]).err().unwrap_or_else(|| panic!("accepted:\n{text}"))
}

/// Checks place, words and remedy of `error`, and that the label stands on the line that the message names.
fn verify(error: &SceneError, text: &str, line: usize, says: &[&str], remedy: &str) {
    let message = error.to_string();
    assert!(message.starts_with(&format!("block.toml:{line}: ")), "not on line {line}: {message}");
    for words in says {
        assert!(message.contains(words), "`{words}` is not in: {message}");
    }
    let help = error.help().unwrap().to_string();
    assert!(help.contains(remedy), "`{remedy}` is not in the help of {message}: {help}");
    let label = error.labels().unwrap().next().unwrap();
    assert_eq!(line_at(text, label.offset()), line, "the label of: {message}");
}

fn verify_all(faults: &[Fault]) {
    for &(from, to, marker, says, remedy) in faults {
        let text = edit(BLOCK, from, to);
        verify(&located(&text), &text, line_of(&text, marker), says, remedy);
    }
}

#[test]
fn unknown_missing_and_mistyped_keys() {
    verify_all(KEYS_AND_TYPES);
}

#[test]
fn values_out_of_range() {
    verify_all(VALUES);
}

/// What the cargo features leave out is named, with what there is in its place.
#[cfg(not(feature = "umfpack"))]
#[test]
fn a_backend_that_is_not_built_in() {
    let help = "use \"faer\" or \"condensed\"";
    verify_all(&[("\"paper\"", "\"paper\"\nlinear = \"umfpack\"", "linear", &["this build has no UMFPACK"], help)]);
}

#[test]
fn a_missing_table_is_named() {
    for (table, next) in [("mesh", "[material]"), ("material", "[[support]]"), ("time", "[solver]")] {
        let start = BLOCK.find(&format!("[{table}]")).unwrap();
        let text = [&BLOCK[..start], &BLOCK[BLOCK.find(next).unwrap()..]].concat();
        verify(&located(&text), &text, 1, &[&format!("missing field `{table}`")], ADD);
    }
    verify(&located(""), "", 1, &["missing field `mesh`"], ADD);
}

#[test]
fn lines_count_from_one() {
    let text = "title = \"first\"\n[mesh]\nkind = \"ball\"\n";
    assert!(located(text).to_string().starts_with("block.toml:3: "));
    assert!(located("titel = 1\n").to_string().starts_with("block.toml:1: "));
    // Neither a byte order mark nor the line ends of other systems move them.
    let other = format!("\u{feff}{text}").replace('\n', "\r\n");
    assert!(located(&other).to_string().starts_with("block.toml:3: "));
}

#[test]
fn what_contradicts_the_mesh() {
    for &(from, to, marker, says, remedy) in AGAINST_THE_MESH {
        let small = edit(BLOCK, "[100, 100]", "[1, 1]");
        let text = edit(&small, from, to);
        let scene = Scene::parse("block.toml", &text, &[]).unwrap();
        match Model::new(&scene) {
            Err(ModelError::Scene(error)) => verify(&error, &text, line_of(&text, marker), says, remedy),
            Err(error) => panic!("not the scene's fault: {error}"),
            Ok(_) => panic!("accepted:\n{text}"),
        }
    }
}

/// Where the numbers of a TOML text are, those in comments and strings left out.
fn numbers(text: &str) -> Vec<Range<usize>> {
    let (mut found, mut quoted, mut comment) = (Vec::new(), false, false);
    let mut last = ' ';
    for (at, c) in text.char_indices() {
        match c {
            '\n' => comment = false,
            '"' if !comment => quoted = !quoted,
            '#' if !quoted => comment = true,
            '0'..='9' | '-' if !quoted && !comment && matches!(last, ' ' | '[') => {
                let length = text[at..].find(|c: char| !(c.is_ascii_alphanumeric() || "+-.".contains(c))).unwrap();
                found.push(at..at + length);
            }
            _ => {}
        }
        last = c;
    }
    found
}

#[test]
fn no_number_may_be_nan_or_infinite() {
    let full = FULL.iter().fold(BLOCK.to_string(), |text, (from, to)| edit(&text, from, to));
    assert!(Scene::parse("block.toml", &full, &[]).is_ok());
    let places = numbers(&full);
    // Mesh 6, material 5, friction and obstacle 6, loads 2 × (2 + 6), time 2, solver 2, output 2.
    assert_eq!(places.len(), 39);
    for place in places {
        for value in ["nan", "-nan", "inf", "+inf", "-inf"] {
            let text = [&full[..place.start], value, &full[place.end..]].concat();
            let line = line_at(&text, place.start);
            let error = located(&text);
            let word = value.trim_start_matches(['+', '-']);
            assert!(error.to_string().to_lowercase().contains(word), "{value}: {error}");
            verify(&error, &text, line, &[], "");
            assert!(!error.help().unwrap().to_string().is_empty());
        }
    }
}

#[test]
fn files_that_cannot_be_read() {
    let folder = std::env::temp_dir().join(format!("stickslip-scene-errors-{}", std::process::id()));
    fs::create_dir_all(&folder).unwrap();
    let binary = folder.join("binary.toml");
    fs::write(&binary, b"title = \"\xff\xfe\"\n").unwrap();
    let refusal = |path: &Path| {
        let error = Scene::read(path, &[]).unwrap_err();
        assert!(matches!(error, SceneError::Io { .. }), "{error}");
        assert!(error.help().unwrap().to_string().contains("TOML file"));
        // The message has the reason, so a cause beneath it would say it twice.
        assert!(std::error::Error::source(&error).is_none());
        let message = error.to_string();
        assert!(message.starts_with(&format!("{}: the scene cannot be read: ", path.display())), "{message}");
        message
    };
    let missing = refusal(&folder.join("missing.toml"));
    let directory = refusal(&folder);
    let not_text = refusal(&binary);
    fs::remove_dir_all(&folder).unwrap();
    assert!(not_text.contains("UTF-8"), "{not_text}");
    assert_ne!(missing.rsplit(": ").next(), directory.rsplit(": ").next());
}
