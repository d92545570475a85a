//! Scenes in rows, and what becomes of them.

use stickslip::body::Model;
use stickslip::run::discretise;
use stickslip::scene::Scene;

pub const BLOCK: &str = include_str!("../../data/scenes/block.toml");
pub const CUBE: &str = include_str!("../../data/scenes/cube.toml");
pub const PUNCH: &str = include_str!("../../data/scenes/punch.toml");

/// The text of a scene from rows: the keys of a table stand behind its header, `[time] end = 1, increments = 4`, and may go on in
/// the next row. In the text each has a line of its own; lists may have several rows. Rows with a comment are lines already.
pub fn scene_text(rows: &str) -> String {
    let (mut text, mut depth) = (String::new(), 0);
    for row in rows.lines().map(str::trim) {
        let header = if depth == 0 && row.starts_with('[') { row.find("] ").map_or(0, |end| end + 1) } else { 0 };
        let mut quote = None;
        text.push_str(&row[..header]);
        let mut rest = if header > 0 { format!("\n{}", &row[header + 1..]) } else { row.to_string() };
        if row.contains('#') {
            text.push_str(&std::mem::take(&mut rest));
        }
        for c in rest.chars() {
            match (quote, c) {
                (Some(end), c) if c == end => quote = None,
                (None, '"' | '\'') => quote = Some(c),
                (None, '[' | '{') => depth += 1,
                (None, ']' | '}') => depth -= 1,
                _ => {}
            }
            text.push(if depth == 0 && quote.is_none() && c == ',' { '\n' } else { c });
        }
        text.push('\n');
    }
    text.lines().map(str::trim_start).collect::<Vec<_>>().join("\n") + "\n"
}

/// The text of a scene that is written in rows, also with values in braces, or as a static for several tests.
macro_rules! scene {
    ($rows:literal) => {
        $crate::common::scenes::scene_text($rows)
    };
    (format $rows:literal) => {
        $crate::common::scenes::scene_text(&format!($rows))
    };
    ($(#[$doc:meta])* $access:vis static $name:ident = $rows:literal) => {
        $(#[$doc])*
        $access static $name: std::sync::LazyLock<String> = std::sync::LazyLock::new(|| scene!($rows));
    };
}
pub(crate) use scene;

/// The scene of a text.
pub fn parsed(text: &str) -> Scene {
    parsed_with(text, &[])
}

/// The scene of a text with overrides.
pub fn parsed_with(text: &str, overrides: &[&str]) -> Scene {
    let overrides: Vec<_> = overrides.iter().map(|text| text.parse().unwrap()).collect();
    Scene::parse("scene.toml", text, &overrides).unwrap_or_else(|error| panic!("{error}\n{text}"))
}

/// The model of the scene of a text.
pub fn model_of(text: &str) -> Model {
    discretise(&parsed(text)).unwrap_or_else(|error| panic!("{error}\n{text}"))
}

/// The model of the scene of a text with overrides.
pub fn model_with(text: &str, overrides: &[&str]) -> Model {
    discretise(&parsed_with(text, overrides)).unwrap()
}
