//! Faults of a scene are told with file, line, reason and remedy, and no fault gets through.

use crate::common::faults::line_at;
use crate::common::prelude::*;

const REMOVE: &str = "remove the key or correct its spelling";
const ADD: &str = "add the key; `stickslip init block` shows a complete scene";
const LISTED: &str = "use one of the values it lists";
const FORM: &str = "`stickslip init block` shows the form of every value";
const MEND: &str = "mend the TOML here";

const KEYS_AND_TYPES: &str = include_str!("tables/keys.txt");

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
