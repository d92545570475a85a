//! The text of Siconos: `FrictionContactProblem` (local) and `GlobalFrictionContactProblem` (global), as its
//! `newFromFile` reads them.
//!
//! The text consists of words separated by white space: the dimension, the number of contacts, the matrix `W`, `q`,
//! `μ`; or `M`, `H`, `q` (which is `f`), `b` (which is `w`), `μ`. The two are distinguished by their length: a global
//! problem continues where a local one ends. A matrix begins with the type of its storage, followed by
//!
//! | type | content |
//! | --- | --- |
//! | 0, dense | rows, columns, rows, columns, the entries column by column |
//! | 1, blocks | rows, columns, numbers of blocks, in a column, in a row, last row and column of each, rows of blocks compressed, blocks column by column |
//! | 2, sparse | rows, columns, its origin, and the print of CSparse: triplets, or columns with their rows |

mod blocks;
mod csparse;
mod words;

use super::global::Parts;
use super::{GlobalProblem, Info, Problem, ProblemFile};
use crate::local::LocalProblem;
use stickslip::algebra::Csc;
use stickslip::base::InputError;
use words::Words;

/// A matrix whose size has not been confirmed yet.
struct Unsized {
    line: usize,
    rows: usize,
    columns: usize,
    entries: Vec<(usize, usize, f64)>,
}

impl Unsized {
    /// Returns the matrix if it has this size, which is confirmed by a vector in the text.
    fn sized(self, what: &str, rows: usize, columns: usize) -> Result<Csc, InputError> {
        let Unsized { line, entries, .. } = self;
        let fault = |message: String| InputError::new(format!("line {line}"), message, SIZES);
        if (self.rows, self.columns) != (rows, columns) {
            let found = format!("{} × {}", self.rows, self.columns);
            return Err(fault(format!("the matrix {what} is {found}, but must be {rows} × {columns}")));
        }
        Csc::from_triplets(rows, columns, &entries).map_err(|error| fault(format!("the matrix {what}: {error}")))
    }
}

const SIZES: &str = "correct the sizes, which contradict each other";

/// Reads the problem in `text`.
pub(super) fn read(text: &str) -> Result<ProblemFile, InputError> {
    let mut words = Words::new(text);
    let dimension = words.count("the dimension, 2 or 3")?;
    if !matches!(dimension, 2 | 3) {
        return Err(
            words.fault(&format!("the dimension is {dimension}"), "a problem begins with 2 (plane) or 3 (space)")
        );
    }
    let contacts = words.count("the number of contacts")?;
    let first = matrix(&mut words)?;
    let rows = contacts.saturating_mul(dimension);
    let of_a_local_one = rows.saturating_add(contacts);
    // A local problem may be followed by one more word. A second matrix is longer, unless the text is truncated.
    let second = ["0", "1", "2"].map(|kind| [kind.to_string(), first.rows.to_string(), rows.to_string()]);
    let goes_on = second.iter().any(|head| words.left().take(head.len()).eq(head));
    let at = |line: usize, fault: InputError| InputError { key: format!("line {line}, {}", fault.key), ..fault };
    let problem = if !goes_on && words.are_at_most(of_a_local_one.saturating_add(1)) {
        let q = words.numbers("q", rows)?;
        let mu = words.numbers("mu", contacts)?;
        let line = words.line();
        let delassus = first.sized("W", rows, rows)?;
        Problem::Local(LocalProblem::new(dimension, delassus, q, mu).map_err(|fault| at(line, fault))?)
    } else {
        let second = matrix(&mut words)?;
        let f = words.numbers("q", first.rows)?;
        let w = words.numbers("b", rows)?;
        let mu = words.numbers("mu", contacts)?;
        let line = words.line();
        let (m, h) = (first.sized("M", f.len(), f.len())?, second.sized("H", f.len(), rows)?);
        let parts = Parts { dimension, m, h, f, w, mu, constraints: 0 };
        Problem::Global(GlobalProblem::new(parts).map_err(|fault| at(line, fault))?)
    };
    if !words.are_at_most(1) {
        return Err(words.fault("more follows than the problem has", SIZES));
    }
    Ok(ProblemFile { info: Info::default(), problem, solution: None, guesses: Vec::new() })
}

fn matrix(words: &mut Words<'_>) -> Result<Unsized, InputError> {
    let kind = words.count("how a matrix is stored, 0, 1 or 2")?;
    let line = words.line();
    let (rows, columns) = (words.count("the rows of a matrix")?, words.count("its columns")?);
    let entries = match kind {
        0 => dense(words, rows, columns)?,
        1 => blocks::read(words, rows, columns)?,
        2 => csparse::read(words, rows, columns)?,
        other => {
            let help = "0 stands for a dense matrix, 1 for sparse blocks, 2 for the print of CSparse";
            return Err(InputError::new(format!("line {line}"), format!("the storage of a matrix is {other}"), help));
        }
    };
    Ok(Unsized { line, rows, columns, entries })
}

/// Reads the sizes again and all entries, column by column.
fn dense(words: &mut Words<'_>, rows: usize, columns: usize) -> Result<Vec<(usize, usize, f64)>, InputError> {
    let again = [words.count("the rows of a matrix")?, words.count("its columns")?];
    if again != [rows, columns] {
        return Err(words
            .fault(&format!("the matrix is {} × {} here, and {rows} × {columns} above", again[0], again[1]), SIZES));
    }
    let values = words.numbers("the entries of a matrix", rows.saturating_mul(columns))?;
    let entry = |(k, value): (usize, f64)| (k % rows, k / rows, value);
    Ok(values.into_iter().enumerate().map(entry).filter(|entry| entry.2 != 0.0).collect())
}
