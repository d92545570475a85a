//! The lists of a report with one or more entries per increment. They are written during the run, so that millions of
//! increments do not fill the memory.

use serde::Serialize;
use std::fs::File;
use std::io::{self, BufRead, BufReader, BufWriter, Write};
use stickslip::base::UnitSystem;
use stickslip::run::report::{RunReport, in_units};

/// The keys of the lists in a report.
const KEYS: [&str; 3] = ["increments", "forces", "reactions"];

/// The files in which the lists grow until the report is written, with a line of JSON per entry.
pub(super) const FILES: [&str; 3] = [".increments.jsonl", ".forces.jsonl", ".reactions.jsonl"];

/// Formats an entry as a line, in these units.
pub(super) fn line(entry: &impl Serialize, units: &UnitSystem) -> io::Result<String> {
    if units.is_si() {
        return Ok(serde_json::to_string(entry)? + "\n");
    }
    let mut entry = serde_json::to_value(entry)?;
    in_units(&mut entry, units);
    Ok(serde_json::to_string(&entry)? + "\n")
}

/// Writes a report whose lists are in such files.
pub(super) fn write(report: &RunReport, lists: [io::Result<File>; 3], to: &mut File) -> io::Result<()> {
    let mut to = BufWriter::new(to);
    let mut lists = KEYS.into_iter().zip(lists).collect::<Vec<_>>();
    let report = report.to_value()?;
    let mut separator = "{";
    for (key, value) in report.as_object().into_iter().flatten() {
        write!(to, "{separator}\n  {}: ", serde_json::to_string(key)?)?;
        separator = ",";
        match lists.iter().position(|(list, _)| list == key) {
            Some(place) => copy(lists.swap_remove(place).1?, &mut to)?,
            None => to.write_all(serde_json::to_string_pretty(value)?.replace('\n', "\n  ").as_bytes())?,
        }
    }
    to.write_all(b"\n}\n")?;
    to.flush()
}

/// Writes the lines of a file as a JSON list.
fn copy(list: File, to: &mut impl Write) -> io::Result<()> {
    let mut separator = "[";
    for line in BufReader::new(list).lines() {
        write!(to, "{separator}\n    {}", line?)?;
        separator = ",";
    }
    to.write_all(if separator == "[" { b"[]" } else { b"\n  ]" })
}
