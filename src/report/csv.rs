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
