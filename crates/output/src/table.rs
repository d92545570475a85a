//! Aligned text tables, and paragraphs, that fit a screen.

use std::fmt;

/// The columns of a screen.
const SCREEN: usize = 100;

/// The width of the labels before paragraphs.
pub const LABEL: usize = 13;

/// The characters after which a head or a cell may be broken; the last two only if the table is too wide without.
const BREAKS: [char; 5] = [' ', '.', ':', '_', ','];

/// The characters between two columns.
const GAP: &str = "  ";

/// A table of right-aligned columns. If it is wider than a screen, heads are broken into lines, then cells, and columns
/// that still do not fit stand below the others.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Table {
    heads: Vec<String>,
    rows: Vec<Vec<String>>,
    names: usize,
}

/// The lines of a head, of the rule below it, and of each cell.
struct Column {
    cells: Vec<Vec<String>>,
    width: usize,
}

impl Table {
    /// Creates a table with the given column heads.
    pub fn new(heads: &[&str]) -> Self {
        Table { heads: heads.iter().map(ToString::to_string).collect(), rows: Vec::new(), names: 1 }
    }

    /// Sets the number of columns, the first ones, that name a row, and are repeated beside columns that stand below.
    #[must_use]
    pub fn named_by(self, names: usize) -> Self {
        Table { names, ..self }
    }

    /// Returns `true` if there is no row below the heads.
    pub fn is_empty(&self) -> bool {
        self.rows.is_empty()
    }

    /// Appends a row.
    pub fn push(&mut self, row: Vec<String>) {
        self.rows.push(row);
    }

    /// Returns the columns in the first form that fits a screen, otherwise in the last one.
    fn columns(&self) -> Vec<Column> {
        // The columns that name a row and any other fit beside each other.
        let widest = SCREEN / (self.names + 1) - GAP.len();
        let forms = [(24, usize::MAX, 3), (16, usize::MAX, 3), (0, usize::MAX, 3), (0, widest, 3), (0, widest, 5)];
        forms.into_iter().fold(self.broken(0, usize::MAX, 0), |columns, (narrow, widest, breaks)| {
            if width(&columns) > SCREEN { self.broken(narrow, widest, breaks) } else { columns }
        })
    }

    /// Returns the columns with heads wider than `narrow` and their cells broken after the first so many of the
    /// [`BREAKS`], and cells wider than `widest` broken after any.
    fn broken(&self, narrow: usize, widest: usize, breaks: usize) -> Vec<Column> {
        let column = |(k, head): (usize, &String)| {
            let cells = self.rows.iter().map(|row| lines(&row[k], widest, &BREAKS)).collect::<Vec<_>>();
            let of_cells = widest_of(cells.iter().flatten());
            let pieces = head.split_inclusive(&BREAKS[..breaks]).map(|piece| count(piece.trim_end()));
            let head = lines(head, pieces.fold(of_cells.max(narrow), usize::max).min(widest), &BREAKS[..breaks]);
            let width = of_cells.max(widest_of(&head));
            Column { cells: [vec![head, vec!["-".repeat(width)]], cells].concat(), width }
        };
        let mut columns: Vec<Column> = self.heads.iter().enumerate().map(column).collect();
        let height = columns.iter().map(|column| column.cells[0].len()).max().unwrap_or(0);
        for column in &mut columns {
            // Heads stand on the rules.
            column.cells[0] = [vec![String::new(); height - column.cells[0].len()], column.cells[0].clone()].concat();
        }
        columns
    }
}

impl fmt::Display for Table {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let columns = self.columns();
        let (names, mut others) = columns.split_at(self.names.min(columns.len()));
        let fits = |others: &[Column]| width(names) + GAP.len() + width(others) <= SCREEN;
        loop {
            let (beside, below) =
                others.split_at((1..=others.len()).rfind(|&n| fits(&others[..n])).unwrap_or(others.len()));
            write_beside(f, &names.iter().chain(beside).collect::<Vec<_>>())?;
            if below.is_empty() {
                return Ok(());
            }
            writeln!(f)?;
            others = below;
        }
    }
}

/// Writes columns beside each other, without empty lines.
fn write_beside(f: &mut fmt::Formatter<'_>, columns: &[&Column]) -> fmt::Result {
    for row in 0..columns.first().map_or(0, |column| column.cells.len()) {
        for line in 0..columns.iter().map(|column| column.cells[row].len()).max().unwrap_or(0) {
            let field = |column: &&Column| {
                let text = column.cells[row].get(line).map_or("", String::as_str);
                format!("{text:>width$}", width = column.width)
            };
            let fields = columns.iter().map(field).collect::<Vec<_>>().join(GAP);
            if !fields.trim().is_empty() {
                writeln!(f, "{}", fields.trim_end())?;
            }
        }
    }
    Ok(())
}

/// Formats a text as lines that fit a screen, the first one behind a label.
pub fn paragraph(label: &str, text: &str) -> String {
    let lines = lines(text, SCREEN - LABEL, &[' ']).into_iter().enumerate();
    let lines = lines.map(|(k, line)| format!("{:<LABEL$}{line}\n", if k == 0 { label } else { "" }));
    lines.collect()
}

fn count(text: &str) -> usize {
    text.chars().count()
}

fn widest_of<'a>(lines: impl IntoIterator<Item = &'a String>) -> usize {
    lines.into_iter().map(|line| count(line)).max().unwrap_or(0)
}

/// Returns the width of columns beside each other.
fn width(columns: &[Column]) -> usize {
    columns.iter().map(|column| column.width + GAP.len()).sum::<usize>().saturating_sub(GAP.len())
}

/// Breaks a text into lines of at most this width, after one of these characters where there is one.
fn lines(text: &str, widest: usize, breaks: &[char]) -> Vec<String> {
    let mut lines = Vec::new();
    let mut line = String::new();
    for piece in text.split_inclusive(breaks) {
        if !line.is_empty() && count(&line) + count(piece.trim_end()) > widest {
            lines.push(std::mem::take(&mut line));
        }
        for c in piece.chars() {
            if count(&line) >= widest && c != ' ' {
                lines.push(std::mem::take(&mut line));
            }
            line.push(c);
        }
    }
    lines.push(line);
    lines.iter().map(|line| line.trim_end().to_string()).collect()
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
      boundaries.cylinder:   boundaries.cylinder:
     bottom.friction_work,  bottom.friction_work,
  n                  mJ/mm                  mJ/mm
---  ---------------------  ---------------------
100                    2.5              1234567.5
";
        assert_eq!(table.to_string(), expected[1..]);
    }

    #[test]
    fn a_table_is_never_wider_than_a_screen() {
        let long = "a_word_of_more_letters_than_a_column_may_have";
        let row = |columns: usize, cell: &str| (0..columns).map(|k| format!("{cell}{k}")).collect::<Vec<_>>();
        for (columns, names) in [(1, 1), (2, 2), (9, 1), (9, 2), (30, 3)] {
            for cell in ["1", "-0.123456", "[[0, 0], [1, 2.5e-3], [2, -2.5e-3], [3, 2.5e-3], [4, 0]]", long] {
                let heads = row(columns, &[long, " [MPa]"].concat());
                let heads: Vec<&str> = heads.iter().map(String::as_str).collect();
                let mut table = super::Table::new(&heads).named_by(names);
                (0..2).for_each(|_| table.push(row(columns, cell)));
                let text = table.to_string();
                assert!(text.lines().all(|line| line.chars().count() <= 100), "{text}");
                // Nothing is left out.
                let letters = |text: &str| text.matches(|c: char| c.is_alphanumeric()).count();
                let given = 2 * letters(&row(columns, cell).concat()) + letters(&heads.concat());
                assert!(letters(&text) >= given, "{text}");
            }
        }
    }

    #[test]
    fn columns_that_do_not_fit_stand_below() {
        let heads: Vec<String> = (0..4).map(|k| format!("{}{k}", "x".repeat(29))).collect();
        let mut table =
            super::Table::new(&[&["n"], &heads.iter().map(String::as_str).collect::<Vec<_>>()[..]].concat());
        table.push(["1", "2", "3", "4", "5"].map(String::from).to_vec());
        let lines: Vec<String> =
            table.to_string().lines().map(|line| line.split_whitespace().collect::<Vec<_>>().join(" ")).collect();
        assert_eq!((lines.len(), &*lines[2], &*lines[3], &*lines[6]), (7, "1 2 3 4", "", "1 5"), "{table}");
    }

    #[test]
    fn paragraphs_fit_a_screen() {
        let text = super::paragraph("verdict", &"word ".repeat(30));
        assert!(text.starts_with("verdict      word") && text.lines().all(|line| line.len() <= 100), "{text}");
        assert!(text.lines().skip(1).all(|line| line.starts_with("             word")), "{text}");
    }
}
