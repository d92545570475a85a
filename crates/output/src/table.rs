//! Aligned text tables.

use std::fmt;

/// The width from which the heads of a table are broken into lines, so that it fits a screen.
const WIDE: usize = 100;

/// The characters after which a head may be broken; the last one only if the table is too wide without.
const BREAKS: [char; 4] = [' ', '.', ':', '_'];

/// A table of right-aligned columns.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Table {
    heads: Vec<String>,
    rows: Vec<Vec<String>>,
}

impl Table {
    /// Creates a table with the given column heads.
    pub fn new(heads: &[&str]) -> Self {
        Table { heads: heads.iter().map(ToString::to_string).collect(), rows: Vec::new() }
    }

    /// Returns `true` if there is no row below the heads.
    pub fn is_empty(&self) -> bool {
        self.rows.is_empty()
    }

    /// Appends a row.
    pub fn push(&mut self, row: Vec<String>) {
        self.rows.push(row);
    }

    /// Returns the widths of the columns, and the lines of their heads.
    fn columns(&self) -> (Vec<usize>, Vec<Vec<String>>) {
        let width = |text: &str| text.chars().count();
        let cells: Vec<usize> =
            (0..self.heads.len()).map(|k| self.rows.iter().map(|row| width(&row[k])).max().unwrap_or(0)).collect();
        let whole: Vec<usize> = cells.iter().zip(&self.heads).map(|(&cells, head)| cells.max(width(head))).collect();
        let is_wide = |widths: &[usize]| widths.iter().map(|width| width + 2).sum::<usize>() > WIDE + 2;
        if !is_wide(&whole) {
            return (whole, self.heads.iter().map(|head| vec![head.clone()]).collect());
        }
        let in_words = self.broken(&cells, &BREAKS[..3]);
        if is_wide(&in_words.0) { self.broken(&cells, &BREAKS) } else { in_words }
    }

    /// Returns the widths of the columns with heads that are broken after these characters, and the lines of the heads.
    fn broken(&self, cells: &[usize], breaks: &[char]) -> (Vec<usize>, Vec<Vec<String>>) {
        let width = |text: &str| text.chars().count();
        let broken = self.heads.iter().zip(cells).map(|(head, &cells)| {
            let pieces = || head.split_inclusive(breaks);
            let most = pieces().map(|piece| width(piece.trim_end())).fold(cells, usize::max);
            let mut lines: Vec<String> = Vec::new();
            for piece in pieces() {
                match lines.last_mut() {
                    Some(line) if width(line) + width(piece.trim_end()) <= most => line.push_str(piece),
                    _ => lines.push(piece.to_string()),
                }
            }
            (most, lines.into_iter().map(|line| line.trim_end().to_string()).collect())
        });
        broken.unzip()
    }
}

impl fmt::Display for Table {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let (widths, heads) = self.columns();
        let mut line = |fields: &[&str]| {
            let fields: Vec<String> = fields.iter().zip(&widths).map(|(x, &w)| format!("{x:>w$}")).collect();
            writeln!(f, "{}", fields.join("  ").trim_end())
        };
        let height = heads.iter().map(Vec::len).max().unwrap_or(0);
        for k in (1..=height).rev() {
            let of = |lines: &Vec<String>| lines.len().checked_sub(k);
            line(&heads.iter().map(|lines| of(lines).map_or("", |at| &lines[at])).collect::<Vec<_>>())?;
        }
        let rules: Vec<String> = widths.iter().map(|&width| "-".repeat(width)).collect();
        line(&rules.iter().map(String::as_str).collect::<Vec<_>>())?;
        self.rows.iter().try_for_each(|row| line(&row.iter().map(String::as_str).collect::<Vec<_>>()))
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

    #[test]
    fn heads_of_a_wide_table_are_broken() {
        let long = "boundaries.cylinder:bottom.friction_work, mJ/mm";
        let mut table = super::Table::new(&["n", long, long]);
        table.push(vec!["100".into(), "2.5".into(), "1234567.5".into()]);
        let expected = "
        boundaries.     boundaries.
          cylinder:       cylinder:
            bottom.         bottom.
     friction_work,  friction_work,
  n           mJ/mm           mJ/mm
---  --------------  --------------
100             2.5       1234567.5
";
        assert_eq!(table.to_string(), expected[1..]);
    }
}
