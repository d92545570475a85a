//! Errors of the TOML reader in the terms of a scene's author.

use std::ops::Range;

use super::SceneError;
use super::error::Source;
use super::overrides::LISTS;

/// The TOML reader's names of types, and plain words for them.
const JARGON: [(&str, &str); 9] = [
    ("wanted string or table", "invalid type: expected a word in quotes"),
    ("type: map", "type: table"),
    ("type: sequence", "type: list"),
    ("expected a sequence", "expected a list"),
    ("expected a string", "expected a text in quotes"),
    ("expected f64", "expected a number"),
    ("expected i64", "expected a whole number"),
    ("expected usize", "expected a whole number from 0 on"),
    ("expected struct ", "expected a table: "),
];

/// Translates `error` to plain words and locates it.
pub(super) fn error(mut error: toml::de::Error, source: &Source) -> SceneError {
    let span = error.span().unwrap_or(0..0);
    // Without the text, the reader adds the key to its message instead of the line. The line is named anyway.
    error.set_input(None);
    let mut message = error.to_string().trim().replace('\n', ", ");
    for (jargon, plain) in JARGON {
        message = message.replace(jargon, plain);
    }
    let help = help(&message, source, &span);
    source.at(span, message, help)
}

fn help(message: &str, source: &Source, span: &Range<usize>) -> String {
    let form = "`stickslip init block` shows the form of every value";
    match message.split(' ').take(2).collect::<Vec<_>>()[..] {
        ["unknown", "field"] => return "remove the key or correct its spelling".to_string(),
        ["missing", "field"] => return "add the key; `stickslip init block` shows a complete scene".to_string(),
        ["unknown", "variant"] => return "use one of the values it lists".to_string(),
        ["invalid", "length" | "value:"] => return form.to_string(),
        _ => {}
    }
    let given = source.text.get(span.clone()).unwrap_or_default();
    let name = given.strip_prefix("[[").and_then(|rest| rest.strip_suffix("]]"));
    // A list of lists is a value, not a table.
    if let Some(name) = name.filter(|name| !name.contains([',', '['])) {
        return format!("write `[{name}]`: there is one only");
    }
    let list_expected = message.contains("expected a list");
    if list_expected && given.starts_with('[') {
        return format!("write `[{given}]`: there may be several of them");
    }
    if message.starts_with("duplicate key") && LISTS.contains(&given) {
        return format!("write each of them as `[[{given}]]`");
    }
    let unquoted = given.trim_matches(['"', '\'']);
    let quoted = given.starts_with(['"', '\'']) && unquoted.parse::<f64>().is_ok();
    let of_a_number = message.contains("number").then(|| with_a_point(unquoted)).flatten();
    if let Some(number) = of_a_number.or_else(|| number_with_a_comma(&source.text, span.start)) {
        return format!("write {number}, with a point");
    }
    match message.starts_with("invalid type:") {
        true if quoted && message.contains("number") => "write the number without quotes".to_string(),
        true if given.starts_with('[') && message.contains("whole number") => {
            "give one whole number, as 10".to_string()
        }
        true if list_expected => format!("a list stands in brackets, [ ]; {form}"),
        true => form.to_string(),
        false => "mend the TOML here".to_string(),
    }
}

/// Returns `text` with a decimal point if it is a number with a decimal comma.
fn with_a_point(text: &str) -> Option<String> {
    let (whole, rest) = text.split_once(',')?;
    let number = format!("{whole}.{rest}");
    let is_number = whole.ends_with(|c: char| c.is_ascii_digit()) && rest.starts_with(|c: char| c.is_ascii_digit());
    (is_number && number.parse::<f64>().is_ok()).then_some(number)
}

/// Returns the number with a decimal comma at the byte `place` of `text`, where the reader failed, with a decimal
/// point.
fn number_with_a_comma(text: &str, place: usize) -> Option<String> {
    let of_a_number = |c: char| c.is_ascii_digit() || matches!(c, ',' | '.' | '+' | '-' | 'e' | 'E');
    // The reader stops at the comma or after it; in an inline table it stops after the following space.
    let place = text.get(..place)?.trim_end().len();
    let (before, after) = text.split_at(place);
    let key = before.trim_end_matches(of_a_number);
    let end = place + (after.len() - after.trim_start_matches(of_a_number).len());
    // In a list, the comma separates two numbers.
    if key.trim_end().ends_with('=') { with_a_point(&text[key.len()..end]) } else { None }
}
