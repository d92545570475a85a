//! Tables of a page: fewer rows, columns and digits than in the files.

use std::collections::BTreeSet;

/// The page shows no more increments. Of others, the sums are shown with the next one.
const MAX_ROWS: usize = 1000;

/// The page shows no more rows of a table of the whole run.
const MAX_NODES: usize = 2000;

/// Columns of `increments.csv` that are sums over the increment.
const SUMS: [&str; 2] = ["iterations", "friction_work"];

/// Longer numbers are rounded to six digits, except times, by which states are found.
const LONG: usize = 9;

/// Returns at most `most` of these numbers, evenly, with the last and, from two on, the first.
pub(super) fn chosen(all: &[usize], most: usize) -> BTreeSet<usize> {
    if all.len() <= most {
        return all.iter().copied().collect();
    }
    if most < 2 {
        return all.last().copied().into_iter().collect();
    }
    (0..most).map(|k| all[k * (all.len() - 1) / (most - 1)]).collect()
}

/// Returns the number of the increment at the beginning of a line.
fn index(line: &str) -> Option<usize> {
    line.split(',').next()?.parse().ok()
}

/// Returns the increments of a table that begins with their numbers, as many as the page shows.
pub(super) fn shown_increments(text: &str) -> BTreeSet<usize> {
    chosen(&text.lines().filter_map(index).collect::<Vec<_>>(), MAX_ROWS)
}

/// Returns the `kept` increments of such a table, or fewer if they take more than about `most` bytes. A sum is that since the row
/// before.
pub(super) fn thinned(text: &str, kept: &BTreeSet<usize>, most: usize) -> String {
    let all = rows_of(text, kept);
    if all.len() <= most {
        return all;
    }
    let fewer = (kept.len() as f64 * most as f64 / all.len() as f64) as usize;
    rows_of(text, &chosen(&kept.iter().copied().collect::<Vec<_>>(), fewer.max(2)))
}

fn rows_of(text: &str, kept: &BTreeSet<usize>) -> String {
    let head: Vec<&str> = text.lines().next().unwrap_or_default().split(',').collect();
    let sums: Vec<usize> = (0..head.len()).filter(|&k| SUMS.contains(&head[k])).collect();
    let time = head.iter().position(|name| *name == "time");
    let mut found = head.join(",") + "\n";
    let mut so_far = vec![0.0; sums.len()];
    for line in text.lines().skip(1) {
        let mut cells: Vec<String> = line.split(',').map(String::from).collect();
        for (&k, sum) in sums.iter().zip(&mut so_far) {
            *sum += cells.get(k).and_then(|cell| cell.parse::<f64>().ok()).unwrap_or(0.0);
        }
        if index(line).is_some_and(|index| kept.contains(&index)) {
            for (&k, sum) in sums.iter().zip(&mut so_far) {
                if let Some(cell) = cells.get_mut(k) {
                    *cell = std::mem::take(sum).to_string();
                }
            }
            let cells = cells.iter().enumerate();
            let cells: Vec<String> =
                cells.map(|(k, cell)| if Some(k) == time { cell.clone() } else { short(cell) }).collect();
            found += &cells.join(",");
            found.push('\n');
        }
    }
    found
}

/// Returns these columns of a table.
pub(super) fn columns(text: &str, wanted: &[&str]) -> String {
    let head: Vec<&str> = text.lines().next().unwrap_or_default().split(',').collect();
    let places: Vec<usize> = (0..head.len()).filter(|&k| wanted.contains(&head[k])).collect();
    let row = |line: &str| {
        let cells: Vec<&str> = line.split(',').collect();
        places.iter().filter_map(|&k| cells.get(k).map(|cell| short(cell))).collect::<Vec<_>>().join(",") + "\n"
    };
    text.lines().map(row).collect()
}

/// Returns as many rows of a table as the page shows, evenly.
pub(super) fn limited(text: &str) -> String {
    let rows = chosen(&(1..text.lines().count()).collect::<Vec<_>>(), MAX_NODES);
    let row = |line: &str| line.split(',').map(short).collect::<Vec<_>>().join(",") + "\n";
    text.lines().enumerate().filter(|(k, _)| *k == 0 || rows.contains(k)).map(|(_, line)| row(line)).collect()
}

/// Rounds a long number to six digits. A part of a name in quotes remains.
fn short(cell: &str) -> String {
    match cell.parse::<f64>() {
        Ok(x) if cell.len() > LONG && x.is_finite() => {
            let rounded: f64 = format!("{x:.5e}").parse().unwrap_or(x);
            format!("{rounded:e}")
        }
        _ => cell.to_string(),
    }
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used)]

    use super::{chosen, columns, limited, short, shown_increments, thinned};

    #[test]
    fn long_tables_keep_their_sums() {
        let text: String =
            ["index,friction_work\n".to_string()].into_iter().chain((1..=2000).map(|k| format!("{k},0.5\n"))).collect();
        let kept = shown_increments(&text);
        assert!(kept.len() == 1000 && kept.contains(&1) && kept.contains(&2000));
        for most in [1_000_000, 2000] {
            let thin = thinned(&text, &kept, most);
            assert!(thin.len() <= most + most / 5 && thin.lines().count() > 100, "{}", thin.len());
            let works = thin.lines().skip(1).map(|line| line.split(',').nth(1).unwrap().parse::<f64>().unwrap());
            assert_eq!(works.sum::<f64>(), 1000.0);
        }
        assert_eq!(limited(&text).lines().count(), 2001);
        assert_eq!(limited(&text.replace('\n', "\n1,2\n")).lines().count(), 2001);
    }

    #[test]
    fn rows_columns_and_digits_are_chosen() {
        assert_eq!(chosen(&[3, 5], 40).len(), 2);
        assert_eq!(chosen(&[3, 5, 7], 1).into_iter().collect::<Vec<_>>(), [7]);
        assert_eq!(columns("a,x,y\n1,2,3\n", &["x", "y"]), "x,y\n2,3\n");
        assert_eq!(
            ["-0.123456789", "1e-5", "strap:bottom", "12345678.25"].map(short),
            ["-1.23457e-1", "1e-5", "strap:bottom", "1.23457e7"]
        );
    }
}
