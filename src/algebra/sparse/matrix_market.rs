//! The exchange format of the National Institute of Standards and Technology for sparse matrices.
//!
//! R. F. Boisvert, R. Pozo, K. A. Remington: The Matrix Market exchange formats, NISTIR 5935 (1996). Supported are
//! its real coordinate formats: `%%MatrixMarket matrix coordinate real general` or `symmetric`.

use std::fmt::Write;

use super::{Csc, MatrixError};

/// Reads a matrix from a text in the format `matrix coordinate real` (or `integer`), `general` or `symmetric`. For a
/// symmetric matrix both triangles are returned. Entries at the same place are summed.
///
/// # Errors
/// [`MatrixError::Text`] with the invalid line, and as [`Csc::from_triplets`].
pub fn read_matrix_market(text: &str) -> Result<Csc, MatrixError> {
    let fault = |line: usize, message: String| MatrixError::Text { line: line + 1, message };
    let mut lines = text.lines().enumerate();
    let (_, banner) = lines.next().unwrap_or_default();
    let words: Vec<String> = banner.split_whitespace().map(str::to_lowercase).collect();
    let symmetric = match words.iter().map(String::as_str).collect::<Vec<_>>()[..] {
        ["%%matrixmarket", "matrix", "coordinate", "real" | "integer", "general"] => false,
        ["%%matrixmarket", "matrix", "coordinate", "real" | "integer", "symmetric"] => true,
        _ => {
            let message = "expected `%%MatrixMarket matrix coordinate real general` or `symmetric`";
            return Err(fault(0, message.to_string()));
        }
    };
    let mut lines = lines.filter(|(_, line)| !line.trim().is_empty() && !line.starts_with('%'));
    let (k, sizes) =
        lines.next().ok_or_else(|| fault(1, "the line with rows, columns and entries is missing".into()))?;
    let counts: Vec<usize> = sizes.split_whitespace().filter_map(|word| word.parse().ok()).collect();
    let [rows, columns, count] = counts[..] else {
        return Err(fault(k, format!("expected the numbers of rows, columns and entries, found `{sizes}`")));
    };
    let mut entries = Vec::new();
    for (k, line) in lines {
        let words: Vec<&str> = line.split_whitespace().collect();
        let entry = match words[..] {
            [row, column, value] => row.parse().ok().zip(column.parse().ok()).zip(value.parse().ok()),
            _ => None,
        };
        let Some(((row, column), value)) = entry else {
            return Err(fault(k, format!("expected a row, a column and a value, found `{line}`")));
        };
        let (row, column): (usize, usize) = (row, column);
        if !(1..=rows).contains(&row) || !(1..=columns).contains(&column) {
            return Err(fault(k, format!("the entry ({row}, {column}) is outside the {rows} × {columns} matrix")));
        }
        entries.push((row - 1, column - 1, value));
        if symmetric && row != column {
            entries.push((column - 1, row - 1, value));
        }
    }
    let found =
        entries.len() - if symmetric { entries.iter().filter(|(row, column, _)| row < column).count() } else { 0 };
    if found != count {
        return Err(fault(k, format!("{count} entries are announced, but {found} follow")));
    }
    Csc::from_triplets(rows, columns, &entries)
}

/// Writes a matrix in the format `matrix coordinate real general`, without loss of digits.
pub fn write_matrix_market(matrix: &Csc) -> String {
    let pattern = matrix.pattern();
    let mut text = String::from("%%MatrixMarket matrix coordinate real general\n");
    // Writing to a String cannot fail.
    let _ = writeln!(text, "{} {} {}", pattern.rows(), pattern.columns(), pattern.len());
    for (row, column, value) in matrix.entries() {
        let _ = writeln!(text, "{} {} {value:?}", row + 1, column + 1);
    }
    text
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_is_written_is_read_again() {
        let a = Csc::from_triplets(2, 3, &[(1, 0, 0.1), (0, 2, -1e-300), (1, 1, 1.0 / 3.0)]).unwrap();
        let text = write_matrix_market(&a);
        assert_eq!(text.lines().nth(1), Some("2 3 3"));
        let same = read_matrix_market(&text).unwrap();
        assert_eq!((same.pattern(), same.values()), (a.pattern(), a.values()));
    }

    #[test]
    fn one_triangle_stands_for_both() {
        let text = "%%MatrixMarket matrix coordinate real symmetric\n% a comment\n\n2 2 2\n1 1 4\n2 1 -1e0\n";
        let entries: Vec<_> = read_matrix_market(text).unwrap().entries().collect();
        assert_eq!(entries, [(0, 0, 4.0), (1, 0, -1.0), (0, 1, -1.0)]);
    }

    #[test]
    fn every_fault_names_its_line() {
        let line = |text: &str| match read_matrix_market(text) {
            Err(MatrixError::Text { line, .. }) => line,
            other => panic!("{other:?}"),
        };
        let head = "%%MatrixMarket matrix coordinate real general\n";
        assert_eq!(line(""), 1);
        assert_eq!(line("%%MatrixMarket matrix array real general\n2 2\n"), 1);
        assert_eq!(line(head), 2);
        assert_eq!(line(&[head, "2 two 1\n"].concat()), 2);
        assert_eq!(line(&[head, "2 2 1\n1 1\n"].concat()), 3);
        assert_eq!(line(&[head, "2 2 1\n3 1 1.0\n"].concat()), 3);
        assert_eq!(line(&[head, "2 2 1\n0 1 1.0\n"].concat()), 3);
        assert_eq!(line(&[head, "2 2 2\n1 1 1.0\n"].concat()), 2);
        assert!(matches!(read_matrix_market(&[head, "1 1 1\n1 1 nan\n"].concat()), Err(MatrixError::NotFinite { .. })));
    }
}
