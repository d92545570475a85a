//! The page of a run, `report.html`: one file that holds its data, which a browser shows without a network.

use std::collections::{BTreeMap, BTreeSet};
use std::io;

use base64::Engine;
use base64::prelude::BASE64_STANDARD;
use serde_json::{Map, Value};

/// The page shows no more states of the contact.
const MOST_STATES: usize = 40;

/// The page shows no more increments. Of others, the sums are shown with the next one.
const MOST_ROWS: usize = 1000;

/// Pictures take no more bytes. Those that do not fit are left out, the first ones before the last.
const MOST_PICTURES: usize = 3_000_000;

/// The lists of the report that grow with the increments, which are in tables, too.
const LISTS: [&str; 3] = ["increments", "forces", "reactions"];

/// The columns of a contact line that are drawn.
const DRAWN: [&str; 7] = ["x", "y", "sigma_n", "sigma_t", "gap", "slip_t", "status"];

/// Columns of `increments.csv` that are sums over the increment.
const SUMS: [&str; 2] = ["iterations", "friction_work"];

/// Returns the page of the run in a folder with these files.
///
/// # Errors
/// If a file cannot be read, or `run.json` is not a report.
pub(crate) fn page(names: &[String], read: impl Fn(&str) -> io::Result<String>) -> io::Result<String> {
    let mut report: Map<String, Value> = serde_json::from_str(&read("run.json")?)?;
    for list in LISTS {
        report.remove(list);
    }
    let mut files = BTreeMap::new();
    let mut rows = None;
    for name in ["increments.csv", "forces.csv"].into_iter().filter(|name| names.iter().any(|other| other == name)) {
        let (text, kept) = thinned(&read(name)?, rows.take());
        rows = Some(kept);
        files.insert(name.to_string(), text);
    }
    for name in names.iter().filter(|name| name.starts_with("probe_")) {
        files.insert(name.clone(), thinned(&read(name)?, rows.clone()).0);
    }
    let mut shown = shown_states(names);
    let peak = report.get("largest_pressure").and_then(|peak| peak.get("time")).and_then(Value::as_f64);
    shown.extend(peak.and_then(|time| increment_at(time, files.get("increments.csv")?)));
    // In space there are pictures of the contact, in the plane the page draws it.
    let is_solid = report.get("final").is_some_and(|sums| sums.get("sum_p_o").is_some());
    let contacts = || names.iter().filter(|name| number(name).is_some_and(|k| shown.contains(&k)));
    let mut wanted: Vec<String> =
        names.iter().filter(|name| name.starts_with("deformed_")).max().cloned().into_iter().collect();
    if is_solid {
        let mut maps: Vec<String> = contacts().map(|name| format!("{}.svg", name.trim_end_matches(".csv"))).collect();
        maps.retain(|name| names.contains(name));
        maps.sort_unstable_by(|a, b| b.cmp(a));
        wanted.extend(maps);
    } else {
        for name in contacts() {
            files.insert(name.clone(), columns(&read(name)?, &DRAWN));
        }
    }
    let (mut pictures, mut left) = (BTreeMap::new(), MOST_PICTURES);
    for name in wanted {
        let picture = read(&name)?;
        let Some(rest) = left.checked_sub(picture.len()) else { continue };
        left = rest;
        pictures.insert(name, BASE64_STANDARD.encode(picture));
    }
    let data = serde_json::json!({ "report": report, "files": files, "pictures": pictures });
    // Nothing in the data can end its element.
    let data = data.to_string().replace('<', "\\u003c");
    let [before, rest] = split(include_str!("page/page.html"), "/*STYLE*/");
    let [middle, rest] = split(rest, "/*DATA*/");
    let [after, end] = split(rest, "/*SCRIPT*/");
    Ok([before, include_str!("page/page.css"), middle, &data, after, include_str!("page/page.js"), end].concat())
}

fn split<'a>(text: &'a str, mark: &str) -> [&'a str; 2] {
    text.split_once(mark).map_or([text, ""], |(before, after)| [before, after])
}

/// Returns the number of the increment in `contact_NNNN.csv` or `contact_NNNN_BOUNDARY.csv`.
fn number(name: &str) -> Option<usize> {
    let stem = name.strip_prefix("contact_")?.strip_suffix(".csv")?;
    stem.split('_').next()?.parse().ok()
}

/// Returns the number of the increment that ends at this time.
fn increment_at(time: f64, increments: &str) -> Option<usize> {
    increments.lines().find_map(|line| {
        let mut cells = line.split(',');
        let index = cells.next()?.parse().ok()?;
        (cells.next()?.parse() == Ok(time)).then_some(index)
    })
}

/// Returns the increments whose contact is shown, the first and the last among them.
fn shown_states(names: &[String]) -> BTreeSet<usize> {
    let all: Vec<usize> = names.iter().filter_map(|name| number(name)).collect::<BTreeSet<_>>().into_iter().collect();
    chosen(&all, MOST_STATES)
}

/// Returns at most `most` of these numbers, evenly, with the first and the last.
fn chosen(all: &[usize], most: usize) -> BTreeSet<usize> {
    if all.len() <= most {
        return all.iter().copied().collect();
    }
    (0..most).map(|k| all[k * (all.len() - 1) / (most - 1)]).collect()
}

/// Returns a table that begins with the number of the increment, and the numbers of its increments: those in `kept`, or as many as
/// the page shows. A sum is that since the row before.
fn thinned(text: &str, kept: Option<BTreeSet<usize>>) -> (String, BTreeSet<usize>) {
    let index = |line: &str| line.split(',').next().and_then(|index| index.parse::<usize>().ok());
    let kept = kept.unwrap_or_else(|| {
        let all: Vec<usize> = text.lines().filter_map(index).collect();
        chosen(&all, MOST_ROWS)
    });
    let head: Vec<&str> = text.lines().next().unwrap_or_default().split(',').collect();
    let sums: Vec<usize> = (0..head.len()).filter(|&k| SUMS.contains(&head[k])).collect();
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
            found += &cells.join(",");
            found.push('\n');
        }
    }
    (found, kept)
}

/// Returns these columns of a table.
fn columns(text: &str, wanted: &[&str]) -> String {
    let head: Vec<&str> = text.lines().next().unwrap_or_default().split(',').collect();
    let places: Vec<usize> = (0..head.len()).filter(|&k| wanted.contains(&head[k])).collect();
    let row = |line: &str| {
        let cells: Vec<&str> = line.split(',').collect();
        places.iter().filter_map(|&k| cells.get(k).copied()).collect::<Vec<_>>().join(",") + "\n"
    };
    text.lines().map(row).collect()
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used)]

    use super::{chosen, columns, page, thinned};

    #[test]
    fn a_page_holds_its_data() {
        let files = [
            ("run.json", r#"{"title": "</script><b>", "increments": [1, 2], "totals": {}}"#),
            ("increments.csv", "index,time,iterations\n1,0.5,3\n2,1,4\n"),
            ("contact_0002.csv", "x,y,p_n,sigma_n,status\n0,0,1,2,stick\n"),
        ];
        let names: Vec<String> = files.iter().map(|(name, _)| (*name).to_string()).collect();
        let read = |name: &str| Ok(files.iter().find(|(other, _)| *other == name).unwrap().1.to_string());
        let page = page(&names, read).unwrap();
        assert_eq!(page.matches("</script>").count(), 2);
        let data = page.split("type=\"application/json\">").nth(1).unwrap().split("</script>").next().unwrap();
        let data: serde_json::Value = serde_json::from_str(data).unwrap();
        assert_eq!(data["report"]["title"], "</script><b>");
        assert!(data["report"].get("increments").is_none());
        assert_eq!(data["files"]["contact_0002.csv"], "x,y,sigma_n,status\n0,0,2,stick\n");
        assert!(
            !page.contains("http://") || page.matches("http").count() == page.matches("http://www.w3.org/").count()
        );
    }

    #[test]
    fn long_tables_keep_their_sums() {
        let text: String =
            ["index,friction_work\n".to_string()].into_iter().chain((1..=2000).map(|k| format!("{k},0.5\n"))).collect();
        let (thin, kept) = thinned(&text, None);
        assert!(kept.len() == 1000 && kept.contains(&1) && kept.contains(&2000));
        let sum: f64 = thin.lines().skip(1).map(|line| line.split(',').nth(1).unwrap().parse::<f64>().unwrap()).sum();
        assert_eq!(sum, 1000.0);
        assert_eq!(chosen(&[3, 5], 40).len(), 2);
        assert_eq!(columns("a,x,y\n1,2,3\n", &["x", "y"]), "x,y\n2,3\n");
    }
}
