//! Comma-separated values: a header line, then numbers in the shortest form that reads back the same.

/// A whole table. Fields must hold neither commas nor quotes.
pub fn table(header: &[&str], rows: impl Iterator<Item = Vec<String>>) -> String {
    let mut text = header.join(",");
    text.push('\n');
    for row in rows {
        text.push_str(&row.join(","));
        text.push('\n');
    }
    text
}

/// A number as a field: with an exponent where it would be a row of zeros otherwise.
pub(super) fn number(x: f64) -> String {
    match x {
        // -0 too.
        0.0 => "0".to_string(),
        _ if (1e-4..1e16).contains(&x.abs()) => x.to_string(),
        _ => format!("{x:e}"),
    }
}

#[cfg(test)]
mod tests {
    use super::number;

    #[test]
    fn numbers_are_short_and_read_back_the_same() {
        let texts = [0.0, -0.0, 1.0, -0.25, 1e-5, 1.25e-37, 2.5e9, 1e300, f64::NAN].map(number);
        assert_eq!(texts, ["0", "0", "1", "-0.25", "1e-5", "1.25e-37", "2500000000", "1e300", "NaN"]);
        for x in [0.1, 1.0 / 3.0, -7e-9 / 3.0, 1e22 / 7.0] {
            assert_eq!(number(x).parse(), Ok(x));
        }
    }
}
