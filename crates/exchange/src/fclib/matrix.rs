//! Sparse matrices as FCLIB stores them: triplets, compressed columns, compressed rows.

use super::vectors::{finite, has_length, length, need, one, written};
use crate::error::of_dataset;
use crate::hdf5::File;
use stickslip::algebra::Csc;
use stickslip::base::InputError;

/// Memory per entry while a matrix is read, bytes: row and column as stored in the file, as indices, and in columns;
/// its value.
const BYTES_OF_AN_ENTRY: u64 = 80;
/// Memory per column or row while a matrix is read, bytes.
const BYTES_OF_A_LINE: u64 = 32;

/// Returns `true` if the matrix at `path` does not exist, or has no entry.
pub(super) fn is_empty(file: &File, path: &str) -> Result<bool, InputError> {
    let nzmax = format!("{path}/nzmax");
    Ok(written(file, &nzmax)?.is_none() || one(file, &nzmax)? == 0)
}

/// Returns an error unless the matrix at `path` has the size `rows` × `columns`, which follows from the adjacent
/// vectors.
pub(super) fn has_sizes(file: &File, path: &str, rows: usize, columns: usize) -> Result<(), InputError> {
    for (name, expected) in [("m", rows), ("n", columns)] {
        let at = format!("{path}/{name}");
        let found = one(file, &at)?;
        if usize::try_from(found) != Ok(expected) {
            let message = format!("it is {found}, but must be {expected} to fit the vectors");
            return Err(InputError::new(
                format!("dataset {at}"),
                message,
                "correct the sizes, which contradict each other",
            ));
        }
    }
    Ok(())
}

/// Reads the `rows` × `columns` matrix at `path`.
pub(super) fn matrix(file: &File, path: &str, rows: usize, columns: usize) -> Result<Csc, InputError> {
    has_sizes(file, path, rows, columns)?;
    let at = |name: &str| format!("{path}/{name}");
    let fault =
        |name: &str, message: String, help: &str| InputError::new(format!("dataset {}", at(name)), message, help);
    let storage = one(file, &at("nz"))?;
    // Reads the first `count` values.
    let whole = |name: &str, count: usize| -> Result<Vec<usize>, InputError> {
        let values = need(file, &at(name))?.integers(count).map_err(|error| of_dataset(&at(name), &error))?;
        let checked = |(place, value): (usize, i64)| {
            let message = || format!("value {place} is {value}, but must be 0 or more");
            usize::try_from(value).map_err(|_| fault(name, message(), "count from 0, as FCLIB does"))
        };
        values.into_iter().enumerate().map(checked).collect()
    };
    let x_of = |count: usize| need(file, &at("x"))?.numbers(count).map_err(|error| of_dataset(&at("x"), &error));
    // Returns an error unless this number of entries exists and is plausible. Several entries per position are allowed,
    // but only a compressed dataset has more entries than its file has bytes.
    let has_entries = |names: &[&str], count: usize, why: &str| -> Result<(), InputError> {
        for name in names {
            let found = need(file, &at(name))?.count();
            if found < count {
                return Err(length(&at(name), count, found, why));
            }
        }
        let entries = rows.saturating_mul(columns);
        if count > entries.max(file.length()) {
            let message = format!("it has {count} entries, but the matrix has {entries} places");
            return Err(fault("x", message, "correct the sizes, which contradict each other"));
        }
        let bytes = BYTES_OF_AN_ENTRY.saturating_mul(count as u64);
        file.take_room(bytes).map_err(|error| of_dataset(&at("x"), &error))
    };
    let (entries, x): (Vec<(usize, usize, f64)>, Vec<f64>) = if let Ok(count) = usize::try_from(storage) {
        has_entries(&["p", "i", "x"], count, "the number of entries given by nz")?;
        let (p, i, x) = (whole("p", count)?, whole("i", count)?, x_of(count)?);
        ((0..count).map(|k| (i[k], p[k], x[k])).collect(), x)
    } else {
        let outer = match storage {
            -1 => columns,
            -2 => rows,
            other => {
                let message = format!("it is {other}");
                return Err(fault("nz", message, "-1 says compressed columns, -2 compressed rows, 0 or more triplets"));
            }
        };
        let starts = outer.saturating_add(1);
        has_length(&need(file, &at("p"))?, &at("p"), starts, "one start for each column (row), and the end")?;
        let bytes = BYTES_OF_A_LINE.saturating_mul(starts as u64);
        file.take_room(bytes).map_err(|error| of_dataset(&at("p"), &error))?;
        let p = whole("p", starts)?;
        let count = p[outer];
        has_entries(&["i", "x"], count, "the last number of p")?;
        if p[0] != 0 || p.windows(2).any(|pair| pair[0] > pair[1]) {
            return Err(fault(
                "p",
                "it does not begin at 0, or decreases".to_string(),
                "give starts that never decrease",
            ));
        }
        let (i, x) = (whole("i", count)?, x_of(count)?);
        let line = |k: usize| (p[k]..p[k + 1]).map(move |at| (k, at));
        let place = |(k, at): (usize, usize)| if storage == -1 { (i[at], k, x[at]) } else { (k, i[at], x[at]) };
        ((0..outer).flat_map(line).map(place).collect(), x)
    };
    drop(finite(&at("x"), x)?);
    let wrong = |error: stickslip::algebra::MatrixError| {
        InputError::new(format!("group {path}"), error.to_string(), "count rows and columns from 0, and below m and n")
    };
    Csc::from_triplets(rows, columns, &entries).map_err(wrong)
}
