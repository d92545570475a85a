//! Tables of faults: what is changed in a text that is sound, and what has to be said of it.
//!
//! Each row of a table is a fault, with ` | ` between its cells. A row goes on in the next line behind a `|` at its end, or
//! behind a `¶` before its last cell.
//! `¶` is the end of a line of the text, ` & ` stands between words that the message has to contain, `-` is a cell without words.

use miette::Diagnostic;
use stickslip::run::{RunError, discretise};
use stickslip::scene::{Scene, SceneError};

use super::edit;

/// The rows of a table; lines that begin with `//` are comments.
pub fn rows<const N: usize>(table: &str) -> Vec<[String; N]> {
    let (mut found, mut row) = (Vec::new(), String::new());
    for line in table.lines().filter(|line| !line.is_empty() && !line.starts_with("//")) {
        row += if row.is_empty() { line } else { line.trim_start() };
        if row.ends_with(" |") {
            row.push(' ');
        } else if !row.ends_with('¶') || row.matches(" | ").count() == N - 1 {
            let cells = row.split(" | ").map(|cell| if cell == "-" { String::new() } else { cell.replace('¶', "\n") });
            found.push(cells.collect::<Vec<_>>().try_into().unwrap_or_else(|_| panic!("not {N} cells: {row}")));
            row.clear();
        }
    }
    found
}

/// The line (from 1) of the first `marker` in `text`.
pub fn line_of(text: &str, marker: &str) -> usize {
    let start = text.find(marker).unwrap_or_else(|| panic!("no `{marker}` in\n{text}"));
    line_at(text, start)
}

/// The line (from 1) of a place in `text`.
pub fn line_at(text: &str, offset: usize) -> usize {
    text[..offset].lines().count().max(1) + usize::from(text[..offset].ends_with('\n'))
}

/// Why the scene `text` is refused as it is read.
pub fn located(text: &str) -> SceneError {
    Scene::parse("scene.toml", text, &[]).err().unwrap_or_else(|| panic!("accepted:\n{text}"))
}

/// Why the scene `text`, which can be read, is refused for its mesh.
pub fn built(text: &str) -> SceneError {
    match discretise(&Scene::parse("scene.toml", text, &[]).unwrap()) {
        Err(RunError::Scene(error)) => error,
        Err(error) => panic!("not the scene's fault: {error}"),
        Ok(_) => panic!("accepted:\n{text}"),
    }
}

/// Why the scene `text` is refused, by itself or for its mesh.
pub fn refused(text: &str) -> SceneError {
    Scene::parse("scene.toml", text, &[]).err().unwrap_or_else(|| built(text))
}

/// Message and remedy of an error.
pub fn words(error: &dyn Diagnostic) -> (String, String) {
    (error.to_string(), error.help().map_or(String::new(), |help| help.to_string()))
}

/// Checks words of message and remedy of `error`, ` & ` between those of the message.
pub fn says(error: &dyn Diagnostic, message: &str, remedy: &str) {
    let (said, help) = words(error);
    for words in message.split(" & ") {
        assert!(said.contains(words), "`{words}` is not in: {said}");
    }
    assert!(help.contains(remedy), "`{remedy}` is not in the help of {said}: {help}");
}

/// Checks place, words and remedy of `error`, and that the label stands on the line that the message names.
pub fn verify(error: &SceneError, text: &str, line: usize, message: &str, remedy: &str) {
    says(error, message, remedy);
    assert!(error.to_string().starts_with(&format!("scene.toml:{line}: ")), "not on line {line}: {error}");
    let label = error.labels().unwrap().next().unwrap();
    assert_eq!(line_at(text, label.offset()), line, "the label of: {error}");
}

/// The scene `base` with each fault of a table, refused by `why`: what is replaced, by what, a text on the line that is named (`-`
/// for any), words of the message, words of the help.
pub fn verify_all(base: &str, table: &str, why: fn(&str) -> SceneError) {
    for [from, to, marker, message, remedy] in rows(table) {
        let text = edit(base, &from, &to);
        let error = why(&text);
        if marker.is_empty() {
            assert!(error.to_string().starts_with("scene.toml:"), "{error}");
            says(&error, &message, &remedy);
        } else {
            verify(&error, &text, line_of(&text, &marker), &message, &remedy);
        }
    }
}
