//! Comma-separated values (RFC 4180): a header line, then numbers in the shortest form that is read back exactly.

use std::borrow::Cow;

/// Formats a table of named columns. Fields are quoted if necessary.
pub fn table(header: &[&str], rows: impl Iterator<Item = Vec<String>>) -> String {
    let mut text = line(header);
    text.extend(rows.map(|row| line(&row)));
    text
}

/// Formats fields as a line. They are quoted if necessary.
pub fn line(fields: &[impl AsRef<str>]) -> String {
    let fields: Vec<Cow<'_, str>> = fields.iter().map(|field| quoted(field.as_ref())).collect();
    fields.join(",") + "\n"
}

/// Quotes a field if necessary. Names of boundaries may contain commas, quotes and line breaks; other control
/// characters, which steer a terminal, are replaced.
fn quoted(text: &str) -> Cow<'_, str> {
    let steers = |c: char| c.is_control() && c != '\n' && c != '\r';
    if text.contains([',', '"', '\n', '\r']) || text.contains(steers) {
        format!("\"{}\"", text.replace('"', "\"\"").replace(steers, "\u{fffd}")).into()
    } else {
        text.into()
    }
}

/// Formats a number, with an exponent if it would otherwise have many zeros.
pub fn number(x: f64) -> String {
    match x {
        // Includes -0.
        0.0 => "0".to_string(),
        _ if (1e-4..1e16).contains(&x.abs()) => x.to_string(),
        _ => format!("{x:e}"),
    }
}

#[cfg(test)]
mod tests {
    use super::{line, number};

    #[test]
    fn numbers_are_short_and_read_back_the_same() {
        let texts = [0.0, -0.0, 1.0, -0.25, 1e-5, 1.25e-37, 2.5e9, 1e300, f64::NAN].map(number);
        assert_eq!(texts, ["0", "0", "1", "-0.25", "1e-5", "1.25e-37", "2500000000", "1e300", "NaN"]);
        for x in [0.1, 1.0 / 3.0, -7e-9 / 3.0, 1e22 / 7.0] {
            assert_eq!(number(x).parse(), Ok(x));
        }
    }

    #[test]
    fn fields_are_quoted_where_they_have_to_be() {
        assert_eq!(line(&["1", "left edge", ""]), "1,left edge,\n");
        assert_eq!(line(&["to\u{1b}[31m\0p"]), "\"to\u{fffd}[31m\u{fffd}p\"\n");
        assert_eq!(line(&["le,ft", "the \"top\"", "a\nb"]), "\"le,ft\",\"the \"\"top\"\"\",\"a\nb\"\n");
    }
}
