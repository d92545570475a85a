//! Scenes with a fault each, and what has to be said of it.

use miette::Diagnostic;
use stickslip::scene::{Scene, SceneError};

use super::edit;

pub const BLOCK: &str = include_str!("../../data/scenes/block.toml");

/// What to replace, by what, a text on the line that must be named, words of the message, words of the help.
pub type InputError = (&'static str, &'static str, &'static str, &'static [&'static str], &'static str);

/// The line (from 1) of the first `marker` in `text`.
pub fn line_of(text: &str, marker: &str) -> usize {
    let start = text.find(marker).unwrap_or_else(|| panic!("no `{marker}` in\n{text}"));
    line_at(text, start)
}

/// The line (from 1) of a place in `text`.
pub fn line_at(text: &str, offset: usize) -> usize {
    text[..offset].lines().count().max(1) + usize::from(text[..offset].ends_with('\n'))
}

/// Why the scene `text` is refused.
pub fn located(text: &str) -> SceneError {
    Scene::parse("scene.toml", text, &[]).err().unwrap_or_else(|| panic!("accepted:\n{text}"))
}

/// Checks place, words and remedy of `error`, and that the label stands on the line that the message names.
pub fn verify(error: &SceneError, text: &str, line: usize, says: &[&str], remedy: &str) {
    let message = error.to_string();
    assert!(message.starts_with(&format!("scene.toml:{line}: ")), "not on line {line}: {message}");
    for words in says {
        assert!(message.contains(words), "`{words}` is not in: {message}");
    }
    let help = error.help().unwrap().to_string();
    assert!(help.contains(remedy), "`{remedy}` is not in the help of {message}: {help}");
    let label = error.labels().unwrap().next().unwrap();
    assert_eq!(line_at(text, label.offset()), line, "the label of: {message}");
}

/// The block with each of the faults, refused as it is read.
pub fn verify_all(faults: &[InputError]) {
    for &(from, to, marker, says, remedy) in faults {
        let text = edit(BLOCK, from, to);
        verify(&located(&text), &text, line_of(&text, marker), says, remedy);
    }
}
