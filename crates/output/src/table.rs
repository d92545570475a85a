//! Aligned text tables.

use std::fmt;

/// A table of right-aligned columns.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Table {
    widths: Vec<usize>,
    rows: Vec<Vec<String>>,
}

impl Table {
    /// Creates a table with the given column heads.
    pub fn new(heads: &[&str]) -> Self {
        let mut table = Table { widths: vec![0; heads.len()], rows: Vec::new() };
        table.push(heads.iter().map(ToString::to_string).collect());
        table
    }

    /// Returns `true` if there is no row below the heads.
    pub fn is_empty(&self) -> bool {
        self.rows.len() <= 1
    }

    /// Appends a row.
    pub fn push(&mut self, row: Vec<String>) {
        for (width, field) in self.widths.iter_mut().zip(&row) {
            *width = (*width).max(field.chars().count());
        }
        self.rows.push(row);
    }
}

impl fmt::Display for Table {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        for (k, row) in self.rows.iter().enumerate() {
            let fields: Vec<String> = row.iter().zip(&self.widths).map(|(x, &w)| format!("{x:>w$}")).collect();
            writeln!(f, "{}", fields.join("  ").trim_end())?;
            if k == 0 {
                writeln!(f, "{}", self.widths.iter().map(|&w| "-".repeat(w)).collect::<Vec<_>>().join("  "))?;
            }
        }
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    #[test]
    fn columns_are_aligned() {
        let mut table = super::Table::new(&["n", "nle"]);
        table.push(vec!["100".into(), "2.5".into()]);
        assert_eq!(table.to_string(), "  n  nle\n---  ---\n100  2.5\n");
    }
}
