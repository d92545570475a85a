//! Sparse matrices as FCLIB stores them: triplets, compressed columns, compressed rows.

use super::vectors::{finite, length, need};
use crate::exchange::error::of_dataset;
use crate::exchange::hdf5::File;
use crate::fault::Fault;
use crate::sparse::Csc;

/// The integer at `path`.
fn size(file: &File<'_>, path: &str) -> Result<i64, Fault> {
    let values = need(path, file.integers(path))?;
    match values[..] {
        [value] => Ok(value),
        _ => Err(length(path, 1, values.len(), "it is one number")),
    }
}

/// Whether the matrix at `path` is not there, or has no entry.
pub(super) fn is_empty(file: &File<'_>, path: &str) -> Result<bool, Fault> {
    let nzmax = format!("{path}/nzmax");
    Ok(!file.has(&nzmax).map_err(|error| of_dataset(path, &error))? || size(file, &nzmax)? == 0)
}

/// The `rows` × `columns` matrix at `path`: these sizes are those of the vectors that it stands between.
pub(super) fn matrix(file: &File<'_>, path: &str, rows: usize, columns: usize) -> Result<Csc, Fault> {
    let at = |name: &str| format!("{path}/{name}");
    let fault = |name: &str, message: String, help: &str| Fault::new(format!("dataset {}", at(name)), message, help);
    for (name, expected) in [("m", rows), ("n", columns)] {
        let found = size(file, &at(name))?;
        if usize::try_from(found) != Ok(expected) {
            let message = format!("it is {found}, but must be {expected} to fit the vectors");
            return Err(fault(name, message, "mend the sizes, which contradict each other"));
        }
    }
    let storage = size(file, &at("nz"))?;
    let whole = |name: &str| -> Result<Vec<usize>, Fault> {
        let values = need(&at(name), file.integers(&at(name)))?;
        let checked = |(place, value): (usize, i64)| {
            let message = || format!("value {place} is {value}, but must be 0 or more");
            usize::try_from(value).map_err(|_| fault(name, message(), "count from 0, as FCLIB does"))
        };
        values.into_iter().enumerate().map(checked).collect()
    };
    let (p, i) = (whole("p")?, whole("i")?);
    let x = need(&at("x"), file.numbers(&at("x")))?;
    let entries: Vec<(usize, usize, f64)> = if let Ok(count) = usize::try_from(storage) {
        for (name, found) in [("p", p.len()), ("i", i.len()), ("x", x.len())] {
            if found < count {
                return Err(length(&at(name), count, found, "so many entries are announced by nz"));
            }
        }
        (0..count).map(|k| (i[k], p[k], x[k])).collect()
    } else {
        let outer = match storage {
            -1 => columns,
            -2 => rows,
            other => {
                let message = format!("it is {other}");
                return Err(fault("nz", message, "-1 says compressed columns, -2 compressed rows, 0 or more triplets"));
            }
        };
        if p.len() != outer + 1 {
            return Err(length(&at("p"), outer + 1, p.len(), "one start for each column (row), and the end"));
        }
        let count = p[outer];
        for (name, found) in [("i", i.len()), ("x", x.len())] {
            if found < count {
                return Err(length(&at(name), count, found, "the last number of p"));
            }
        }
        if p[0] != 0 || p.windows(2).any(|pair| pair[0] > pair[1]) {
            return Err(fault("p", "it does not begin at 0, or falls".to_string(), "give starts that never fall"));
        }
        let line = |k: usize| (p[k]..p[k + 1]).map(move |at| (k, at));
        let place = |(k, at): (usize, usize)| if storage == -1 { (i[at], k, x[at]) } else { (k, i[at], x[at]) };
        (0..outer).flat_map(line).map(place).collect()
    };
    drop(finite(&at("x"), x)?);
    let wrong = |error: crate::sparse::MatrixError| {
        Fault::new(format!("group {path}"), error.to_string(), "count rows and columns from 0, and below m and n")
    };
    Csc::from_triplets(rows, columns, &entries).map_err(wrong)
}
