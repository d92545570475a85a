//! The page of a run, `report.html`: one file that holds its data, which a browser shows without a network.
//!
//! The data is an object in the element `data`:
//!
//! | key | contents |
//! | --- | --- |
//! | `report` | `run.json` without its long lists, or `null` if the run did not end |
//! | `units` | the names of the units, empty for SI, `null` if unknown |
//! | `quantities` | the quantity of each column that has a unit |
//! | `files` | tables as text: name of the file, content |
//! | `contacts` | states of the contact: increment, boundary, and the name of a table or of a picture |
//! | `probes` | names of the probes, by their files |
//! | `pictures` | pictures: name of the file, base64 |
//! | `body` | the lines of the body, see `view.rs` |

use std::collections::{BTreeMap, BTreeSet};

use base64::Engine;
use base64::prelude::BASE64_STANDARD;
use serde::de::IgnoredAny;
use serde::{Deserialize, Serialize};
use serde_json::{Map, Value};
use stickslip::base::Quantity;
use stickslip::run::report::column_quantity;

use crate::file_names::file_names;
use crate::view;
use error::PageError;
use tables::{chosen, columns, limited, shown_increments, thinned};

pub(crate) mod error;
mod tables;

/// The page shows no more states of the contact, and of the body.
pub const MAX_STATES: usize = 40;

/// The tables of these states take no more bytes, or there are fewer states.
const MAX_CONTACT: usize = 1_500_000;

/// The mesh and the states of the body take no more bytes, or there are fewer. One is always shown.
const MAX_BODY: usize = 600_000;

/// The body and the pictures take no more bytes. Pictures that do not fit are left out, the first ones before the last.
const MAX_DRAWN: usize = 1_200_000;

/// The table of increments, that of forces, and those of all probes take no more bytes each, or show fewer increments.
const MAX_HISTORY: usize = 700_000;

/// The columns of a contact line that are drawn.
const DRAWN: [&str; 7] = ["x", "y", "sigma_n", "sigma_t", "gap", "slip_t", "status"];

/// The script of the charts of pages, `draw(element, curves, [across, up])`.
pub const CHART_SCRIPT: &str = include_str!("page/chart.js");

/// The parts of the script, in their order.
const SCRIPT: [&str; 9] = [
    include_str!("page/base.js"),
    CHART_SCRIPT,
    include_str!("page/tables.js"),
    include_str!("page/head.js"),
    include_str!("page/contact.js"),
    include_str!("page/history.js"),
    include_str!("page/space.js"),
    include_str!("page/body.js"),
    include_str!("page/cycle.js"),
];

/// The report without the lists that grow with the increments: they are in tables, too, and take most of the time to read.
#[derive(Deserialize)]
struct Report {
    #[serde(default, rename = "increments")]
    _increments: IgnoredAny,
    #[serde(default, rename = "forces")]
    _forces: IgnoredAny,
    #[serde(default, rename = "reactions")]
    _reactions: IgnoredAny,
    #[serde(flatten)]
    rest: Map<String, Value>,
}

/// A state of the contact.
#[derive(Serialize)]
struct Contact {
    increment: usize,
    boundary: String,
    file: String,
}

/// Returns the page of the run in a folder with these files.
///
/// # Errors
/// If a file cannot be read, or `run.json` is not a report.
pub(crate) fn page(names: &[String], read: impl Fn(&str) -> Result<String, PageError>) -> Result<String, PageError> {
    let is_there = |name: &str| names.iter().any(|other| other == name);
    let report = is_there("run.json").then(|| read("run.json")).transpose()?;
    let report = report.map(|text| serde_json::from_str::<Report>(&text).map(|report| report.rest)).transpose();
    let report = report.map_err(PageError::Report)?;
    let kept = if is_there(view::FILE) { read(view::FILE)? } else { String::new() };
    let (head, states) = kept.split_once('\n').unwrap_or_default();
    let head: Option<view::Head> = serde_json::from_str(head).ok();

    let mut files = BTreeMap::new();
    let increments = if is_there("increments.csv") { read("increments.csv")? } else { String::new() };
    let rows = shown_increments(&increments);
    // The state of an increment that did not converge is none of the body.
    let failed = not_converged(&increments);
    let names: Vec<String> = names.iter().filter(|name| !failed.contains(&increment_of(name))).cloned().collect();
    if !increments.is_empty() {
        files.insert("increments.csv".to_string(), thinned(&increments, &rows, MAX_HISTORY));
    }
    if is_there("forces.csv") {
        files.insert("forces.csv".to_string(), thinned(&read("forces.csv")?, &rows, MAX_HISTORY));
    }
    let probes = probes(head.as_ref(), &names);
    for name in probes.keys() {
        files.insert(name.clone(), thinned(&read(name)?, &rows, MAX_HISTORY / probes.len()));
    }
    for name in names.iter().filter(|name| is_table_of_the_whole(name)) {
        files.insert(name.clone(), limited(&read(name)?));
    }

    let mut pictures = Vec::new();
    // In space there are pictures of the contact, in the plane the page draws it.
    let is_solid = files.get("forces.csv").is_some_and(|text| header(text).any(|name| name == "f_z"));
    let peak = report.as_ref().and_then(|report| report.get("largest_pressure")?.get("time")?.as_f64());
    let peak = peak.and_then(|time| increment_at(time, files.get("increments.csv")?));
    let boundaries = boundaries(report.as_ref(), head.as_ref());
    let ending = if is_solid { "svg" } else { "csv" };
    let all: Vec<Contact> = names.iter().filter_map(|name| contact(name, ending, &boundaries)).collect();
    let numbers: Vec<usize> = all.iter().map(|state| state.increment).collect::<BTreeSet<_>>().into_iter().collect();
    let mut most = MAX_STATES;
    if let (false, Some(first)) = (is_solid, all.first()) {
        let each = columns(&read(&first.file)?, &DRAWN).len() * all.len() / numbers.len();
        most = most.min(MAX_CONTACT / each.max(1)).max(2);
    }
    let mut shown = chosen(&numbers, most);
    shown.extend(peak);
    let mut contacts: Vec<Contact> = all.into_iter().filter(|state| shown.contains(&state.increment)).collect();
    for state in &contacts {
        if is_solid {
            pictures.push(state.file.clone());
        } else {
            files.insert(state.file.clone(), columns(&read(&state.file)?, &DRAWN));
        }
    }
    let body = body(head.as_ref(), states, &failed, peak);
    if body.is_empty() {
        pictures.extend(names.iter().filter(|name| name.starts_with("deformed_")).max().cloned());
    }
    pictures.sort_unstable_by(|a, b| b.cmp(a));
    let left = MAX_DRAWN.saturating_sub(body.iter().map(|line| line.to_string().len()).sum());
    let pictures = encoded(&pictures, left, read)?;
    contacts.retain(|state| files.contains_key(&state.file) || pictures.contains_key(&state.file));

    let data = serde_json::json!({
        "units": units(report.as_ref(), head.as_ref()),
        "report": report,
        "quantities": files.values().flat_map(|text| header(text)).filter_map(quantity).collect::<BTreeMap<_, _>>(),
        "probes": probes,
        "contacts": contacts,
        "files": files,
        "pictures": pictures,
        "body": body,
    });
    // Nothing in the data can end its element.
    let data = data.to_string().replace('<', "\\u003c");
    let parts = [("/*STYLE*/", include_str!("page/page.css")), ("/*DATA*/", &data), ("/*SCRIPT*/", &SCRIPT.concat())];
    Ok(filled(include_str!("page/page.html"), &parts))
}

/// Returns a page with contents in place of marks, in their order. A content is never searched for a mark.
pub fn filled(mut page: &str, parts: &[(&str, &str)]) -> String {
    let mut whole = String::new();
    for (mark, content) in parts {
        let (before, after) = page.split_once(mark).unwrap_or((page, ""));
        whole.extend([before, content]);
        page = after;
    }
    whole + page
}

/// Returns `true` for a table that is neither of a state nor of the increments.
fn is_table_of_the_whole(name: &str) -> bool {
    let others = ["increments.csv", "forces.csv", "events.csv"];
    name.strip_suffix(".csv").is_some()
        && !others.contains(&name)
        && !["contact_", "probe_"].iter().any(|of| name.starts_with(of))
}

/// Returns the names in the header of a table.
fn header(text: &str) -> impl Iterator<Item = &str> {
    text.lines().next().unwrap_or_default().split(',')
}

/// Returns a column and the key of its unit in the report.
fn quantity(column: &str) -> Option<(&str, &'static str)> {
    let key = match column_quantity(column)? {
        Quantity::Length => "length",
        Quantity::Stress => "stress",
        Quantity::Force => "force",
        Quantity::Moment => "moment",
        Quantity::Energy => "energy",
        Quantity::Area => "area",
        Quantity::EnergyPerArea => "energy_per_area",
        _ => return None,
    };
    Some((column, key))
}

/// Returns the names of the units: empty for SI, `None` if they are unknown.
fn units(report: Option<&Map<String, Value>>, head: Option<&view::Head>) -> Option<Value> {
    // The former has more units than the report.
    let of_head = head.map(|head| head.units.clone());
    let units = of_head.or_else(|| Some(report?.get("units").cloned()))?;
    Some(units.unwrap_or_else(|| Value::Object(Map::new())))
}

/// Returns the boundaries with contact, each with the ending of its file names.
fn boundaries(report: Option<&Map<String, Value>>, head: Option<&view::Head>) -> Vec<(String, String)> {
    let of_report = report
        .and_then(|report| report.get("boundaries")?.as_array())
        .map(|list| list.iter().filter_map(|of| of.get("boundary")?.as_str().map(String::from)).collect::<Vec<_>>());
    let names = of_report.or_else(|| Some(head?.boundaries.clone())).unwrap_or_default();
    let files = file_names(names.iter().map(String::as_str));
    names.into_iter().zip(files).collect()
}

/// Returns the names of the probes by their files.
fn probes(head: Option<&view::Head>, names: &[String]) -> BTreeMap<String, String> {
    let stem = |file: &str| file.strip_prefix("probe_")?.strip_suffix(".csv").map(String::from);
    let mut probes: BTreeMap<_, _> = names.iter().filter_map(|file| Some((file.clone(), stem(file)?))).collect();
    if let Some(head) = head {
        let files = file_names(head.probes.iter().map(String::as_str));
        for (name, file) in head.probes.iter().zip(files) {
            if let Some(known) = probes.get_mut(&format!("probe_{file}.csv")) {
                known.clone_from(name);
            }
        }
    }
    probes
}

/// Returns the state in `contact_NNNN.csv` or `contact_NNNN_BOUNDARY.csv`, or in such a picture.
fn contact(file: &str, ending: &str, boundaries: &[(String, String)]) -> Option<Contact> {
    let stem = file.strip_prefix("contact_")?.strip_suffix(ending)?.strip_suffix('.')?;
    let (number, suffix) = stem.split_once('_').map_or((stem, None), |(number, suffix)| (number, Some(suffix)));
    let boundary = match suffix {
        None => boundaries.first().map_or("contact", |(name, _)| name),
        Some(suffix) => boundaries.iter().find(|(_, file)| file == suffix).map_or(suffix, |(name, _)| name),
    };
    Some(Contact { increment: number.parse().ok()?, boundary: boundary.to_string(), file: file.to_string() })
}

/// Returns the number of the increment whose state is in a file `contact_NNNN...` or `deformed_NNNN...`.
fn increment_of(file: &str) -> Option<usize> {
    let rest = file.strip_prefix("contact_").or_else(|| file.strip_prefix("deformed_"))?;
    rest.split(['.', '_']).next()?.parse().ok()
}

/// Returns the numbers of the increments that did not converge, each as [`increment_of`] gives it.
fn not_converged(increments: &str) -> BTreeSet<Option<usize>> {
    let Some(place) = header(increments).position(|name| name == "status") else { return BTreeSet::new() };
    let has_failed = |line: &&str| line.split(',').nth(place).is_some_and(|status| status != "converged");
    let rows = increments.lines().skip(1).filter(has_failed);
    rows.filter_map(|line| line.split(',').next()?.parse().ok()).map(Some).collect()
}

/// Returns the number of the increment that ends at this time.
fn increment_at(time: f64, increments: &str) -> Option<usize> {
    increments.lines().find_map(|line| {
        let mut cells = line.split(',');
        let index = cells.next()?.parse().ok()?;
        (cells.next()?.parse() == Ok(time)).then_some(index)
    })
}

/// Returns the mesh and as many states of the body as the page shows, the last and that of the `peak` among them.
fn body(head: Option<&view::Head>, states: &str, failed: &BTreeSet<Option<usize>>, peak: Option<usize>) -> Vec<Value> {
    let Some(mesh) = head.and_then(|head| head.mesh.clone()) else { return Vec::new() };
    // A run that is being killed may leave a part of the last line.
    let of = |line: &str, index: usize| line.starts_with(&format!("{{\"index\":{index},"));
    let is_good = |line: &&str| line.ends_with('\n') && !failed.iter().flatten().any(|index| of(line, *index));
    let lines: Vec<&str> = states.split_inclusive('\n').filter(is_good).collect();
    let each = lines.iter().map(|line| line.len()).max().unwrap_or(1);
    let most = (MAX_BODY.saturating_sub(mesh.to_string().len()) / each).clamp(1, MAX_STATES);
    let mut shown = chosen(&(0..lines.len()).collect::<Vec<_>>(), most);
    let at_peak = lines.iter().position(|line| peak.is_some_and(|peak| of(line, peak)));
    if let (1, Some(_)) = (most, at_peak) {
        shown.clear();
    }
    shown.extend(at_peak);
    let states: Vec<Value> = shown.into_iter().filter_map(|k| serde_json::from_str(lines[k]).ok()).collect();
    if states.is_empty() { Vec::new() } else { [vec![mesh], states].concat() }
}

/// Returns the pictures that fit, the first ones before the others.
fn encoded(
    wanted: &[String],
    mut left: usize,
    read: impl Fn(&str) -> Result<String, PageError>,
) -> Result<BTreeMap<String, String>, PageError> {
    let mut pictures = BTreeMap::new();
    for name in wanted {
        let picture = BASE64_STANDARD.encode(read(name)?);
        let Some(rest) = left.checked_sub(picture.len()) else { continue };
        left = rest;
        pictures.insert(name.clone(), picture);
    }
    Ok(pictures)
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used)]

    use serde_json::Value;

    use super::page;

    /// Returns the page of these files, and its data.
    fn made(files: &[(&str, &str)]) -> (String, Value) {
        let names: Vec<String> = files.iter().map(|(name, _)| (*name).to_string()).collect();
        let read = |name: &str| Ok(files.iter().find(|(other, _)| *other == name).unwrap().1.to_string());
        let page = page(&names, read).unwrap();
        let data = page.split("type=\"application/json\">").nth(1).unwrap().split("</script>").next().unwrap();
        let data = serde_json::from_str(data).unwrap();
        (page, data)
    }

    #[test]
    fn a_page_holds_its_data() {
        let (page, data) = made(&[
            ("run.json", r#"{"title": "</script><b>", "increments": [1, 2], "totals": {}}"#),
            ("increments.csv", "index,time,iterations\n1,0.5,3\n2,1,4\n"),
            ("contact_0002.csv", "x,y,p_n,sigma_n,status\n0,0,1,2,stick\n"),
            ("cycle.csv", "node,x,slip_t\n7,0,0.12345678901\n"),
        ]);
        assert_eq!(page.matches("</script>").count(), 2);
        assert_eq!(data["report"]["title"], "</script><b>");
        assert!(data["report"].get("increments").is_none());
        assert_eq!(data["files"]["contact_0002.csv"], "x,y,sigma_n,status\n0,0,2,stick\n");
        assert_eq!(data["files"]["cycle.csv"], "node,x,slip_t\n7,0,1.23457e-1\n");
        assert_eq!([&data["quantities"]["slip_t"], &data["quantities"]["sigma_n"]], ["length", "stress"]);
        // It asks no network for anything: the only address is the name of SVG.
        assert_eq!(page.matches("http").count(), page.matches("http://www.w3.org/2000/svg").count());
        for outside in ["src=\"", "url(", "@import", "fetch(", "XMLHttpRequest", "import("] {
            assert!(!page.contains(outside), "{outside}");
        }
    }

    /// The verdict, the numbers and the picture are first, tables last.
    #[test]
    fn sections_have_their_order() {
        let (page, _) = made(&[("increments.csv", "index,time\n")]);
        let ids = [
            "verdict",
            "numbers",
            "canvas",
            "warnings",
            "history",
            "per-cycle",
            "contact",
            "results",
            "tables",
            "scene",
        ];
        let main = page.split("<main>").nth(1).unwrap();
        let places = ids.map(|id| main.find(&format!("=\"{id}\"")).unwrap());
        assert!(places.is_sorted(), "{places:?}");
    }

    /// A thin body of 50 000 nodes and 40 output times, with as many nodes on its surface as are drawn.
    #[test]
    fn the_page_of_a_large_surface_is_small() {
        let (nodes, encoded) = (34_000, |bytes: usize| "A".repeat(bytes.div_ceil(3) * 4));
        // Triangles are twice as many as their nodes, half of which are in contact.
        let mesh = serde_json::json!({ "low": [0, 0, 0], "step": 1, "corners": 3, "nodes": encoded(6 * nodes),
            "patches": encoded(12 * nodes), "contact": encoded(nodes) });
        let head = serde_json::json!({ "boundaries": ["bottom"], "probes": [], "mesh": mesh }).to_string() + "\n";
        let state = serde_json::json!({ "u": encoded(6 * nodes), "most": 1, "stress": encoded(2 * nodes),
            "pressure": [1, encoded(nodes)], "slip": [1, encoded(nodes)], "status": "o".repeat(nodes / 2) });
        let line = |k: usize| format!("{{\"index\":{k},{}\n", &state.to_string()[1..]);
        let increments = (1..=40).map(|k| format!("{k},{k},converged\n")).collect::<Vec<_>>().concat();
        let picture = "<svg/>".repeat(50_000);
        let pictures: Vec<String> = (1..=40).map(|k| format!("contact_{k:04}.svg")).collect();
        let (kept, increments) =
            (head + &(1..=40).map(line).collect::<String>(), "index,time,status\n".to_string() + &increments);
        let mut files = vec![
            ("run.json", r#"{"largest_pressure": {"time": 30}}"#),
            (".page.jsonl", &kept),
            ("forces.csv", "index,f_z\n"),
            ("increments.csv", &increments),
        ];
        files.extend(pictures.iter().map(|name| (name.as_str(), picture.as_str())));
        let (page, data) = made(&files);
        assert!(page.len() < 1_500_000, "{}", page.len());
        // The state of the largest pressure.
        let body = data["body"].as_array().unwrap();
        assert!(body.len() == 2 && body[1]["index"] == 30);
    }

    /// A failed iterate may lie anywhere, so the page draws the increments that converged.
    #[test]
    fn the_state_of_a_failed_increment_is_not_drawn() {
        let table = "x,y,status\n0,0,stick\n";
        let (_, data) = made(&[
            (
                ".page.jsonl",
                "{\"boundaries\":[],\"probes\":[],\"mesh\":{}}\n{\"index\":1,\"u\":\"a\"}\n{\"index\":12,\"u\":\"b\"}\n",
            ),
            ("increments.csv", "index,time,status\n1,1,converged\n12,12,singular\n"),
            ("contact_0001.csv", table),
            ("contact_0012.csv", table),
        ]);
        assert_eq!(data["contacts"].as_array().unwrap().len(), 1);
        assert_eq!(data["body"].as_array().unwrap().len(), 2);
        assert_eq!([&data["contacts"][0]["increment"], &data["body"][1]["index"]], [1, 1]);
    }

    /// Their files differ by a number that the rule of file names adds.
    #[test]
    fn boundaries_and_probes_have_their_true_names() {
        let table = "x,y,status\n0,0,stick\n";
        let files = [
            (".page.jsonl", "{\"boundaries\":[\"a/b\",\"a b\"],\"probes\":[\"p/q\",\"p q\"]}\n"),
            ("contact_0001_a_b-2.csv", table),
            ("contact_0001_a_b.csv", table),
            ("increments.csv", "index,time\n1,1\n"),
            ("probe_p_q-2.csv", "index,time\n"),
            ("probe_p_q.csv", "index,time\n"),
        ];
        let report = r#"{"boundaries": [{"boundary": "a/b"}, {"boundary": "a b"}]}"#;
        for files in [files.to_vec(), [&files[..], &[("run.json", report)]].concat()] {
            let (_, data) = made(&files);
            let names = [0, 1].map(|k| data["contacts"][k]["boundary"].as_str().unwrap());
            assert_eq!(names, ["a b", "a/b"]);
            assert_eq!([&data["probes"]["probe_p_q.csv"], &data["probes"]["probe_p_q-2.csv"]], ["p/q", "p q"]);
        }
    }

    #[test]
    fn without_a_report_units_may_be_unknown() {
        let units = |files: &[(&str, &str)]| made(files).1["units"].clone();
        assert_eq!(units(&[("increments.csv", "index,time\n")]), Value::Null);
        assert_eq!(units(&[(".page.jsonl", "{\"boundaries\":[],\"probes\":[]}\n")]), serde_json::json!({}));
        assert_eq!(units(&[("run.json", r#"{"units": {"length": 1}}"#)])["length"], 1);
    }
}
