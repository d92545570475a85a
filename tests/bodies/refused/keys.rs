//! What is wrong with a scene is said with file, line, reason and remedy, and nothing wrong gets through.

use crate::common::faults::line_at;
use crate::common::prelude::*;

const REMOVE: &str = "remove the key or correct its spelling";
const ADD: &str = "add the key; `stickslip init block` shows a complete scene";
const LISTED: &str = "use one of the values it lists";
const FORM: &str = "`stickslip init block` shows the form of every value";
const MEND: &str = "mend the TOML here";

const KEYS_AND_TYPES: &str = r#"
title = | titel = | titel | unknown field `titel` & `title` | REMOVE
[solver] | [slover] | [slover] | unknown field `slover` & `solver` | REMOVE
poisson = | poison = | poison = | unknown field `poison` & `poisson` | REMOVE
gap = | gpa = | gpa = | unknown field `gpa` & `gap` | REMOVE
end = | ende = | ende = | unknown field `ende` & `end` | REMOVE
history = | hystory = | hystory = | unknown field `hystory` & `history` | REMOVE
210e9 | "steel" | young = | string "steel" & a number & in `material.young` | FORM
210e9 | "210e9" | young = | string "210e9" & a number & in `material.young` | without quotes
[1.0, 1.0] | [1.0, '1.0'] | size = | string "1.0" & a number & in `mesh.size` | without quotes
[100, 100] | 100 | elements = | `100` & a list & in `mesh.elements` | in brackets
size = [1.0, 1.0] | size = 1.0 | size = | `1.0` & a list | FORM
[100, 100] | [10.5, 10] | elements = | `10.5` & a whole number | FORM
[2, 1]] | [2]] | [2]] | invalid length 1 & 2 values | FORM
increments = 40 | increments = 4.5 | increments = | `4.5` & a whole number | FORM
times = [1.0, 2.0] | times = 1.0 | times = | `1.0` & a list of times or "all" | FORM
times = [1.0, 2.0] | times = "each" | times = | "each" & a list of times or "all" | FORM
times = [1.0, 2.0] | every = 2.5 | every = | `2.5` & a whole number | FORM
times = [1.0, 2.0] | deformed = 100 | deformed = | `100` & boolean | FORM
times = [1.0, 2.0] | probes = [] | probes = | unknown field `probes` & `probe` | REMOVE
times = [1.0, 2.0] | probe = [{ point = [1, 1] }] | probe = | missing field `name` | ADD
times = [1.0, 2.0] | [output.probe]¶name = 'a' | [output.probe] | a list | write `[[output.probe]]`
[[support]] | [support] | [support] | table & a list & in `support` | write `[[support]]`
[[contact]] | [contact] | [contact] | table & a list | write `[[contact]]`
[[load]]                        # Q1 | [load] | [load]¶boundary | duplicate key | as `[[load]]`
[time] | [[time]] | [[time]] | in `time` | write `[time]`
[output] | [[output]] | [[output]] | in `output` | write `[output]`
{ kind = "plane", gap = 1e-5 } | "plane" | obstacle = | string "plane" & a table | FORM
poisson = 0.3¶ | - | [material] | missing field `poisson`, in `material` | ADD
kind = "block"¶ | - | [mesh] | missing field `kind` | ADD
fix = ["x", "y"]¶ | - | [[support]] | a support needs fix or direction | fix = ["x", "y"]
friction = 0.4¶ | - | [[contact]] | a contact needs its friction | add friction = 0.3
kind = "plane",  | - | obstacle = | missing field `kind` | ADD
boundary = "top"¶ | - | # Q2¶ | a traction needs a boundary | add the key
end = 2.0¶ | - | [time] | missing field `end` | ADD
young = 210e9 | young =  | young = | expected | MEND
[mesh] | [mesh | [mesh | unclosed table | MEND
["x", "y"] | ["x" "y"] | fix = | comma | MEND
poisson = 0.3 | poisson = 0.3¶poisson = 0.2 | poisson = 0.2 | duplicate key | MEND
210e9 | 1e999 | young = | overflowed | MEND
poisson = 0.3 | poisson = 0,3 | poisson = | expected | write 0.3, with a point
210e9 | 210,5e9  # Pa | young = | expected | write 210.5e9, with a point
gap = 1e-5 | gap = -0,001 | obstacle = | expected | write -0.001, with a point
210e9 | "2,1e11" | young = | string "2,1e11" & a number | write 2.1e11, with a point
[1.0, 1.0] | [1,0 | elements = | expected | MEND
"block" | "ball" | "ball" | unknown variant `ball` & `block` | LISTED
"strain" | "strian" | "strian" | unknown variant `strian` & `strain`, `stress`, `axisymmetric` | LISTED
elements = | element = "bbar"¶elements = | element = | unknown variant `bbar` & `b-bar` & `nodal-volume` | LISTED
elements = | cells = "triangle7"¶elements = | cells = | unknown variant `triangle7` & `triangle6` | LISTED
elements = | element = 4¶elements = | element = | expected a word in quotes | FORM
poisson = | layers = [[0.1, 1e9]]¶poisson = | layers = | invalid length 2 & 3 values | FORM
poisson = | layers = [0.1, 1e9, 0.3]¶poisson = | layers = | `0.1` & a list | FORM
"y"] | "w"] | "w"] | unknown variant `w` & `x` | LISTED
"plane" | "prism" | "prism" | unknown variant `prism` & `plane` | LISTED
"bn" | "newton" | "newton" | unknown variant `newton` & `bn` | LISTED
"paper" | "mine" | "mine" | unknown variant `mine` & `paper` | LISTED
"paper" | "paper"¶linear = "cg" | "cg" | unknown variant `cg` & `umfpack` | LISTED
"#;

/// Every number of a scene that gives all there is to give.
const FULL: &[(&str, &str)] = &[
    ("elements =", "grading = [1, 2.0]\nelements ="),
    ("poisson =", "layers = [[0.1, 1e9, 0.2]]\npoisson ="),
    ("gap = 1e-5", "gap = 1e-5, normal = [0.0, -1.0], tangent = [1.0, 0.0]"),
    ("\"paper\"", "\"paper\"\nmax_iterations = 200\ntolerance = 1e-10"),
    (
        "[output]",
        "[output]\nevery = 2\ndeformed = true\nmagnification = 50\n\
         probe = [{ name = 'a', point = [1, 0.5] }, { name = 'b', from = [0, 0], to = [1, 1], points = 5 }]",
    ),
];

#[test]
fn unknown_missing_and_mistyped_keys() {
    let remedies = [("REMOVE", REMOVE), ("ADD", ADD), ("LISTED", LISTED), ("FORM", FORM), ("MEND", MEND)];
    let table = remedies.iter().fold(KEYS_AND_TYPES.to_string(), |table, (name, words)| table.replace(name, words));
    verify_all(BLOCK, &table, located);
}

#[test]
fn a_missing_table_is_named() {
    for (table, next) in [("mesh", "[material]"), ("material", "[[support]]"), ("time", "[solver]")] {
        let start = BLOCK.find(&format!("[{table}]")).unwrap();
        let text = [&BLOCK[..start], &BLOCK[BLOCK.find(next).unwrap()..]].concat();
        verify(&located(&text), &text, 1, &format!("missing field `{table}`"), ADD);
    }
    verify(&located(""), "", 1, "missing field `time`", ADD);
}

#[test]
fn lines_count_from_one() {
    let text = "title = \"first\"\n[mesh]\nkind = \"ball\"\n";
    assert!(located(text).to_string().starts_with("scene.toml:3: "));
    assert!(located("titel = 1\n").to_string().starts_with("scene.toml:1: "));
    // Neither a byte order mark nor the line ends of other systems move them.
    let other = format!("\u{feff}{text}").replace('\n', "\r\n");
    assert!(located(&other).to_string().starts_with("scene.toml:3: "));
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
    assert!(Scene::parse("scene.toml", &full, &[]).is_ok());
    let places = numbers(&full);
    // Mesh 6, material 5, friction and obstacle 6, loads 2 × (2 + 6), time 2, solver 2, output 2 + 2 + 2 + 5.
    assert_eq!(places.len(), 48);
    for place in places {
        for value in ["nan", "-nan", "inf", "+inf", "-inf"] {
            let text = [&full[..place.start], value, &full[place.end..]].concat();
            let line = line_at(&text, place.start);
            let error = located(&text);
            let word = value.trim_start_matches(['+', '-']);
            assert!(error.to_string().to_lowercase().contains(word), "{value}: {error}");
            verify(&error, &text, line, "", "");
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
    // Files of other kinds are known, whether they are text or not.
    let other = folder.join("other.toml");
    for (bytes, what, help) in [
        (&b"$MeshFormat\n4.1 0 8\n"[..], "a mesh of Gmsh", "names this mesh under [mesh]"),
        (b"** part\n*HEADING\n*NODE\n1, 0, 0, 0\n", "an input of Abaqus or CalculiX", "kind = \"abaqus\""),
        (b"    -1\n  2411\n", "a mesh in the format UNV", "kind = \"unv\""),
        (b"solid part\n facet normal 0 0 1\n", "a surface in the format STL", "an obstacle of the kind \"surface\""),
        (b"<?xml version=\"1.0\"?>\n<VTKFile type=\"PolyData\">\n", "a file of VTK", "mesh of Gmsh"),
        (b"{\n  \"status\": \"converged\"\n}\n", "a file in the format JSON", "TOML file"),
        (b"\x89HDF\r\n\x1a\n\x00\xff", "a file in the format HDF5", "stickslip solve"),
    ] {
        fs::write(&other, bytes).unwrap();
        let error = Scene::read(&other, &["material.poisson=0.2".parse().unwrap()]).unwrap_err();
        assert_eq!(error.to_string(), format!("{}: it is {what}, not a scene", other.display()));
        assert!(error.help().unwrap().to_string().contains(help), "{what}");
    }
    let missing = refusal(&folder.join("missing.toml"));
    let directory = refusal(&folder);
    let not_text = refusal(&binary);
    fs::remove_dir_all(&folder).unwrap();
    assert!(not_text.contains("UTF-8"), "{not_text}");
    assert_ne!(missing.rsplit(": ").next(), directory.rsplit(": ").next());
}
