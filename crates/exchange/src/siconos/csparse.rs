//! Sparse matrices as CSparse prints them: triplets, or columns with their rows.

use super::words::Words;
use stickslip::base::InputError;

/// The largest number of words in a head: the name, the version and the date of CSparse.
const HEAD: usize = 40;

/// Reads the entries of a matrix with the `rows` and `columns` stated by Siconos.
pub(super) fn read(words: &mut Words<'_>, rows: usize, columns: usize) -> Result<Vec<(usize, usize, f64)>, InputError> {
    words.count("where a sparse matrix comes from")?;
    let (mut triplets, mut sizes) = (false, String::new());
    let mut left = HEAD;
    loop {
        match words.word("the head of a sparse matrix")? {
            "nnz:" => break,
            "triplet:" => triplets = true,
            word if word.contains("-by-") => sizes = word.trim_end_matches([',', ':']).to_string(),
            _ if left == 0 => {
                return Err(words.fault("the head of a sparse matrix does not end", "write it as CSparse prints it"));
            }
            _ => left -= 1,
        }
    }
    if sizes != format!("{rows}-by-{columns}") {
        let message = format!("the sparse matrix is {sizes} here, and {rows}-by-{columns} above");
        return Err(words.fault(&message, "correct the sizes, which contradict each other"));
    }
    let word = words.word("the number of entries")?;
    let count: usize = word.trim_end_matches(',').parse().map_err(|_| {
        words.fault(&format!("expected the number of entries, found `{word}`"), "give a whole number, 0 or more")
    })?;
    if triplets { self::triplets(words, count) } else { by_columns(words, count, columns) }
}

fn colon(words: &mut Words<'_>) -> Result<(), InputError> {
    match words.word("a colon")? {
        ":" => Ok(()),
        "..." => Err(words.fault("CSparse has printed only part of the matrix", "write the file with all its entries")),
        word => Err(words.fault(&format!("expected a colon, found `{word}`"), "write entries as CSparse prints them")),
    }
}

/// Reads lines of `row column : value`.
fn triplets(words: &mut Words<'_>, count: usize) -> Result<Vec<(usize, usize, f64)>, InputError> {
    let mut entries = Vec::new();
    for _ in 0..count {
        let (row, column) = (words.count("the row of an entry")?, words.count("the column of an entry")?);
        colon(words)?;
        entries.push((row, column, words.number("an entry")?));
    }
    Ok(entries)
}

/// Reads `col j : locations a to b`, and lines of `row : value` below.
fn by_columns(words: &mut Words<'_>, count: usize, columns: usize) -> Result<Vec<(usize, usize, f64)>, InputError> {
    words.word("the norm of a sparse matrix")?;
    words.word("the norm of a sparse matrix")?;
    let mut entries = Vec::new();
    for column in 0..columns {
        let word = words.word("a column of a sparse matrix")?;
        let found = words.count("the number of a column")?;
        if word != "col" || found != column {
            let message = format!("expected `col {column}`, found `{word} {found}`");
            return Err(words.fault(&message, "write all columns, as CSparse does"));
        }
        colon(words)?;
        words.word("`locations`")?;
        let first = words.count("the first entry of a column")?;
        words.word("`to`")?;
        // The last entry of an empty first column is -1.
        let last = words.word("the last entry of a column")?;
        let behind = if last == "-1" { 0 } else { last.parse::<usize>().map_or(0, |last| last.saturating_add(1)) };
        for _ in first..behind {
            let row = words.count("the row of an entry")?;
            colon(words)?;
            entries.push((row, column, words.number("an entry")?));
        }
    }
    if entries.len() != count {
        let message = format!("{count} entries are stated, but {} follow", entries.len());
        return Err(words.fault(&message, "write all entries, as CSparse does"));
    }
    Ok(entries)
}
