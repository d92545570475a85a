//! Gaps from a CSV table with one or two coordinates and the gap.

use std::io;
use std::path::Path;

use crate::base::input_error::not_huge;

/// A table of gaps (m) at the points of a line or of a rectangular grid.
#[derive(Debug, Clone, PartialEq)]
pub struct GapTable {
    /// The file, for messages.
    pub file: String,
    /// The coordinates of the table, one or two: 0 for x, 1 for y, 2 for z.
    coordinates: Vec<usize>,
    /// Increasing values of each coordinate, m.
    knots: Vec<Vec<f64>>,
    /// Gaps, m; the last coordinate varies fastest.
    gaps: Vec<f64>,
}

/// The error of a table that cannot be used.
#[derive(Debug, thiserror::Error)]
pub enum TableError {
    /// The file cannot be read.
    #[error("{file}: the table of gaps cannot be read: {error}")]
    Io {
        /// The file.
        file: String,
        /// The error of the operating system.
        error: io::Error,
    },
    /// The header of the file is invalid.
    #[error("{file}:1: the header is `{header}`, but one or two of x, y, z and then gap are needed, as in `x,gap`")]
    Header {
        /// The file.
        file: String,
        /// The header it has.
        header: String,
    },
    /// The count of numbers in a line differs from that of the names in the header.
    #[error("{file}:{line}: {columns} finite numbers expected, separated by commas, none beyond 1e50")]
    Line {
        /// The file.
        file: String,
        /// The line, from 1.
        line: usize,
        /// The number of columns.
        columns: usize,
    },
    /// Points of the grid are missing or repeated.
    #[error(
        "{file}: {points} points are not every point of a grid of {grid}, each once, with two values of each coordinate at least"
    )]
    Grid {
        /// The file.
        file: String,
        /// The number of points.
        points: usize,
        /// The number of different values of each coordinate.
        grid: String,
    },
}

impl GapTable {
    /// Reads the CSV file at `path`: a header such as `x,gap` or `x,y,gap`, then lines of numbers in a unit of `scale`
    /// m, in any order.
    ///
    /// # Errors
    /// If the file cannot be read, or does not contain every point of a line or grid exactly once.
    pub fn read(path: &Path, scale: f64) -> Result<Self, TableError> {
        let file = path.display().to_string();
        let text = crate::base::input::text(path).map_err(|error| TableError::Io { file: file.clone(), error })?;
        let GapTable { file, coordinates, mut knots, mut gaps } = Self::parse(&file, &text)?;
        knots.iter_mut().flatten().chain(&mut gaps).for_each(|x| *x *= scale);
        Ok(GapTable { file, coordinates, knots, gaps })
    }

    /// Reads a table in m from `text`; messages name it `file`.
    ///
    /// # Errors
    /// As [`GapTable::read`].
    pub fn parse(file: &str, text: &str) -> Result<Self, TableError> {
        let file = file.to_string();
        let mut lines = text.lines().enumerate().filter(|(_, line)| !line.trim().is_empty());
        let header = lines.next().map_or("", |(_, line)| line.trim());
        let names: Vec<&str> = header.split(',').map(str::trim).collect();
        let axis = |name: &&str| ["x", "y", "z"].iter().position(|axis| axis == name);
        let coordinates: Option<Vec<usize>> = names[..names.len() - 1].iter().map(axis).collect();
        let is_valid = |c: &Vec<usize>| matches!(c[..], [_]) || matches!(c[..], [a, b] if a != b);
        let Some(coordinates) = coordinates.filter(|c| is_valid(c) && names.last() == Some(&"gap")) else {
            return Err(TableError::Header { file, header: header.to_string() });
        };
        let mut rows: Vec<Vec<f64>> = Vec::new();
        for (k, line) in lines {
            let row: Option<Vec<f64>> = line.split(',').map(|word| word.trim().parse().ok()).collect();
            // + 0.0 turns -0 into 0, which is the same position.
            let row = row.map(|row| row.into_iter().map(|x| x + 0.0).collect::<Vec<_>>());
            match row.filter(|row| {
                row.len() == names.len()
                    && row.iter().all(|x| x.is_finite())
                    && not_huge("", row.iter().copied()).is_ok()
            }) {
                Some(row) => rows.push(row),
                None => return Err(TableError::Line { file, line: k + 1, columns: names.len() }),
            }
        }
        let order = |a: &Vec<f64>, b: &Vec<f64>| {
            (0..coordinates.len())
                .map(|c| a[c].total_cmp(&b[c]))
                .find(|o| o.is_ne())
                .unwrap_or(std::cmp::Ordering::Equal)
        };
        rows.sort_by(order);
        let knots: Vec<Vec<f64>> = (0..coordinates.len())
            .map(|c| {
                let mut knots: Vec<f64> = rows.iter().map(|row| row[c]).collect();
                knots.sort_by(f64::total_cmp);
                knots.dedup();
                knots
            })
            .collect();
        let once = rows.windows(2).all(|pair| order(&pair[0], &pair[1]).is_lt());
        let whole = knots.iter().map(Vec::len).product::<usize>() == rows.len();
        if !once || !whole || knots.iter().any(|knots| knots.len() < 2) {
            let grid = knots.iter().map(|knots| knots.len().to_string()).collect::<Vec<_>>().join(" x ");
            return Err(TableError::Grid { file, points: rows.len(), grid });
        }
        let gaps = rows.iter().map(|row| row[coordinates.len()]).collect();
        Ok(GapTable { file, coordinates, knots, gaps })
    }

    /// Returns the gap (m) at `x`: linear between the points of a line, bilinear between the points of a grid, NaN
    /// outside.
    pub fn at(&self, x: [f64; 3]) -> f64 {
        let cell = |c: usize| -> Option<(usize, f64)> {
            let (knots, x) = (&self.knots[c], x[self.coordinates[c]]);
            // A node on the rim may lie outside by a rounding error of its coordinates.
            let slack = 1e-9 * (knots[knots.len() - 1] - knots[0]);
            if !(knots[0] - slack..=knots[knots.len() - 1] + slack).contains(&x) {
                return None;
            }
            // The slack may be longer than the first interval, so that extrapolation could give any value.
            let x = x.clamp(knots[0], knots[knots.len() - 1]);
            let k = knots.partition_point(|knot| *knot <= x).clamp(1, knots.len() - 1) - 1;
            Some((k, (x - knots[k]) / (knots[k + 1] - knots[k])))
        };
        // The interpolation is exact at both ends.
        let between = |a: f64, b: f64, s: f64| if s < 1.0 { a + s * (b - a) } else { b };
        let cells: Option<Vec<(usize, f64)>> = (0..self.knots.len()).map(cell).collect();
        match cells.as_deref() {
            Some(&[(k, s)]) => between(self.gaps[k], self.gaps[k + 1], s),
            Some(&[(i, s), (j, t)]) => {
                let row = |i: usize| {
                    let first = i * self.knots[1].len() + j;
                    between(self.gaps[first], self.gaps[first + 1], t)
                };
                between(row(i), row(i + 1), s)
            }
            _ => f64::NAN,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn linear_on_a_line_bilinear_on_a_grid_nothing_outside() {
        let line = GapTable::parse("line", "y, gap\n0,1\n2,5\n1,2\n").unwrap();
        assert_eq!([0.5, 1.5, 2.0].map(|y| line.at([9.0, y, 9.0])), [1.5, 3.5, 5.0]);
        assert!(line.at([1.0, 2.1, 0.0]).is_nan() && line.at([1.0, -0.1, 0.0]).is_nan());
        let grid = GapTable::parse("grid", "x,z,gap\n0,0,0\n0,1,2\n4,0,4\n4,1,10\n").unwrap();
        assert_eq!(grid.at([1.0, 7.0, 0.5]), 2.5);
    }

    /// The first interval is much shorter than the table.
    #[test]
    fn the_rim_has_the_gap_of_its_end() {
        let table = GapTable::parse("line", "x,gap\n0,0.5\n1e-9,0.25\n1,0.125\n").unwrap();
        assert_eq!([table.at([-0.5e-9, 0.0, 0.0]), table.at([1.0 + 0.5e-9, 0.0, 0.0])], [0.5, 0.125]);
        assert!(table.at([-2e-9, 0.0, 0.0]).is_nan());
    }

    #[test]
    fn what_is_no_table_is_refused_with_its_line() {
        for (text, said) in [
            ("", "f:1: the header is ``"),
            ("x,y\n", "f:1: the header is `x,y`"),
            ("x,x,gap\n", "f:1: the header"),
            ("x,gap\n0,1\n1\n", "f:3: 2 finite numbers"),
            ("x,gap\n0,nan\n", "f:2: 2 finite numbers"),
            ("x,gap\n0,-1e308\n1,1e308\n", "f:2: 2 finite numbers expected, separated by commas, none beyond 1e50"),
            ("x,gap\n0,1\n", "f: 1 points"),
            ("x,gap\n0,1\n0,2\n1,1\n", "f: 3 points are not every point of a grid of 2,"),
            ("x,y,gap\n0,0,1\n0,1,1\n1,0,1\n", "f: 3 points are not every point of a grid of 2 x 2,"),
        ] {
            let error = GapTable::parse("f", text).unwrap_err().to_string();
            assert!(error.contains(said), "{error}");
        }
    }
}
