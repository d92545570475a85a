//! The folder of a run's results, filled while the run goes on.

use std::fs::{self, File, OpenOptions};
use std::io::{self, Read, Seek, Write};
use std::path::{Path, PathBuf};

use super::balance::BalanceRecord;
use super::contact_line::ContactLine;
use super::contact_surface::ContactSurface;
use super::deformed::DeformedBody;
use super::history_chart::history_charts;
use super::probe::ProbeTable;
use super::resultant::ForceRecord;
use super::run::RunReport;
use super::vtu::Grid;
use super::{file_names, increments, plot, pvd};
use crate::events::Event;
use crate::history::{IncrementRecord, Step};
use crate::model::Model;
use crate::units::UnitSystem;

/// A folder that takes the results of one run: `increments.csv` and `forces.csv` grow line by line, contact lines
/// and plots come as they are reached, `run.json` at the end.
#[derive(Debug)]
pub struct ResultFolder {
    path: PathBuf,
    /// The units of what is written.
    units: UnitSystem,
    increments: File,
    forces: File,
    /// The table of events, from the first one on.
    events: Option<File>,
    /// Boundaries with contact, and how the names of their files end.
    boundaries: Vec<(String, String)>,
    /// The probes, each with its table.
    probes: Vec<(ProbeTable, File)>,
    /// The files of fields so far, each with its time, s.
    fields: Vec<(f64, String)>,
}

impl ResultFolder {
    /// Makes the folder if need be, removes what an earlier run left there under the names used
    /// here, and opens the two tables. How files are called is settled here, before anything is solved.
    ///
    /// # Errors
    /// When the folder cannot be made or written, or holds files of these names that no run wrote.
    pub fn create(path: &Path, model: &Model, probes: Vec<ProbeTable>) -> io::Result<Self> {
        if path.exists() && !path.is_dir() {
            return Err(io::ErrorKind::NotADirectory.into());
        }
        fs::create_dir_all(path)?;
        let mut earlier: Vec<_> = fs::read_dir(path)?
            .filter_map(Result::ok)
            .filter(|entry| entry.file_name().to_str().is_some_and(is_ours))
            .map(|entry| entry.path())
            .collect();
        if let Some(folder) = earlier.iter().find(|path| path.is_dir()) {
            let message = format!("{} is a folder, where a file of results goes", folder.display());
            return Err(io::Error::new(io::ErrorKind::AlreadyExists, message));
        }
        earlier.retain(|path| path.is_file());
        let mut found = vec![0; increments::FIRST_COLUMNS.len()];
        let read = File::open(path.join("increments.csv")).and_then(|mut file| file.read_exact(&mut found));
        let ours = read.is_ok() && found == increments::FIRST_COLUMNS.as_bytes();
        if let Some(file) = earlier.first().filter(|_| !ours) {
            let message = format!("{} is there already, and no run of stickslip wrote it", file.display());
            return Err(io::Error::new(io::ErrorKind::AlreadyExists, message));
        }
        let table = |name: &str| OpenOptions::new().create(true).write(true).truncate(true).open(path.join(name));
        let mut increments = table("increments.csv")?;
        for file in earlier.iter().filter(|file| file.file_name() != Some("increments.csv".as_ref())) {
            fs::remove_file(file)?;
        }
        increments.write_all(increments::header().as_bytes())?;
        let several = model.contact_boundaries.iter().any(|boundary| boundary.obstacles.len() > 1);
        let mut forces = table("forces.csv")?;
        forces.write_all(increments::forces_header(model.mesh.dimension, several).as_bytes())?;
        let boundaries = || model.contact_boundaries.iter().map(|boundary| boundary.name.as_str());
        let boundaries = boundaries().map(String::from).zip(file_names::file_names(boundaries())).collect();
        let names = file_names::file_names(probes.iter().map(|probe| probe.name.as_str()));
        let probes = probes.into_iter().zip(names).map(|(probe, name)| {
            let mut file = table(&format!("probe_{name}.csv"))?;
            file.write_all(probe.header().as_bytes())?;
            Ok((probe, file))
        });
        let probes = probes.collect::<io::Result<_>>()?;
        let (path, units) = (path.to_path_buf(), model.units());
        Ok(ResultFolder { path, units, increments, forces, events: None, boundaries, probes, fields: Vec::new() })
    }

    /// Where the results are.
    pub fn path(&self) -> &Path {
        &self.path
    }

    /// Appends the record of an increment.
    ///
    /// # Errors
    /// When the disk refuses.
    pub fn add_increment(&mut self, record: &IncrementRecord) -> io::Result<()> {
        append(&mut self.increments, &increments::line(record, &self.units))
    }

    /// Appends a contact node that changes its status in increment `index` to `events.csv`.
    ///
    /// # Errors
    /// When the disk refuses.
    pub fn add_event(&mut self, model: &Model, index: usize, event: &Event) -> io::Result<()> {
        let line = increments::event_line(model, index, event);
        if let Some(events) = &mut self.events {
            return append(events, &line);
        }
        let path = self.path.join("events.csv");
        let events = self.events.insert(OpenOptions::new().create(true).write(true).truncate(true).open(path)?);
        append(events, &(increments::events_header(model.mesh.dimension) + &line))
    }

    /// Appends the forces of an increment: those on the obstacles, and what else acts on the body.
    ///
    /// # Errors
    /// When the disk refuses.
    pub fn add_forces(&mut self, contact: &[ForceRecord], balance: &BalanceRecord) -> io::Result<()> {
        append(&mut self.forces, &increments::forces_lines(contact, balance, &self.units))
    }

    /// Writes a contact line as CSV and, in two dimensions, as a plot, `contact_NNNN.csv` and `contact_NNNN.svg`; with
    /// the boundary's name behind the number if there are several, made fit for a file.
    ///
    /// # Errors
    /// When the disk refuses.
    pub fn add_contact_line(&self, line: &ContactLine, title: &str) -> io::Result<()> {
        let name = self.contact_name(line.index, None, line.boundary.as_deref());
        self.write(&format!("{name}.csv"), &line.to_csv())?;
        if line.dimension == 2 && line.points.len() > 1 {
            self.write(&format!("{name}.svg"), &plot::contact_stresses(line, title).map_err(io::Error::other)?)?;
        }
        Ok(())
    }

    /// Writes a contact line at the end of part `part` of its increment, `contact_NNNN-P.csv`.
    ///
    /// # Errors
    /// When the disk refuses.
    pub fn add_part(&self, line: &ContactLine, part: usize) -> io::Result<()> {
        self.write(
            &format!("{}.csv", self.contact_name(line.index, Some(part), line.boundary.as_deref())),
            &line.to_csv(),
        )
    }

    /// Appends what the points of a probe have come to at the end of `step` to `probe_NAME.csv`.
    ///
    /// # Errors
    /// When the disk refuses.
    pub fn add_probes(&mut self, model: &Model, step: &Step<'_>) -> io::Result<()> {
        self.probes.iter_mut().try_for_each(|(probe, file)| append(file, &probe.lines(model, step)))
    }

    /// Writes the picture of the deformed body, `deformed_NNNN.svg`.
    ///
    /// # Errors
    /// When the disk refuses.
    pub fn add_deformed(&self, body: &DeformedBody, title: &str) -> io::Result<()> {
        self.write(&format!("deformed_{:04}.svg", body.index), &body.to_svg(title).map_err(io::Error::other)?)
    }

    /// Writes the report as `run.json`, after what it shows of the history as `forces.svg` and `iterations.svg`.
    ///
    /// # Errors
    /// When the disk refuses.
    pub fn add_report(&self, report: &RunReport) -> io::Result<()> {
        for (name, chart) in history_charts(report) {
            self.write(&format!("{name}.svg"), &chart.to_svg().map_err(io::Error::other)?)?;
        }
        self.write("run.json", &report.to_json().map_err(io::Error::other)?)
    }

    /// Writes the picture of a contact surface, `contact_NNNN.svg` as for a line.
    ///
    /// # Errors
    /// When the disk refuses.
    pub fn add_contact_surface(&self, surface: &ContactSurface, title: &str) -> io::Result<()> {
        let name = self.contact_name(surface.index, None, surface.boundary.as_deref());
        self.write(&format!("{name}.svg"), &surface.to_svg(title).map_err(io::Error::other)?)
    }

    /// Writes the fields at the end of increment `index`, at `time` (s), as `fields_NNNN.vtu`, and then the series of
    /// all so far as `fields.pvd`, which so never names a file that is not there.
    ///
    /// # Errors
    /// When the disk refuses.
    pub fn add_fields(&mut self, index: usize, time: f64, grid: &Grid) -> io::Result<()> {
        let name = format!("fields_{index:04}.vtu");
        self.write(&name, &grid.to_vtu())?;
        self.fields.push((time, name));
        self.write("fields.pvd", &pvd::series(&self.fields))
    }

    /// Writes a whole file; a reader never sees half of it.
    ///
    /// # Errors
    /// When the disk refuses.
    pub fn write(&self, name: &str, text: &str) -> io::Result<()> {
        write_file(&self.path, name, text)
    }

    /// The name of the files of a contact boundary in an increment; the boundary is named if there are several.
    fn contact_name(&self, index: usize, part: Option<usize>, boundary: Option<&str>) -> String {
        let file = boundary.and_then(|name| self.boundaries.iter().find(|(boundary, _)| boundary == name));
        let boundary = file.map_or(String::new(), |(_, file)| format!("_{file}"));
        let part = part.map_or(String::new(), |part| format!("-{part}"));
        format!("contact_{index:04}{part}{boundary}")
    }
}

/// Appends whole lines.
fn append(table: &mut File, lines: &str) -> io::Result<()> {
    let complete = table.stream_position()?;
    let written = table.write_all(lines.as_bytes());
    if written.is_err() {
        // A full disk may have taken part of them; what stands before is kept.
        let _ = table.set_len(complete);
    }
    written
}

/// Writes a whole file into a folder; a reader never sees half of it.
///
/// # Errors
/// When the disk refuses.
pub fn write_file(folder: &Path, name: &str, text: &str) -> io::Result<()> {
    let partial = folder.join(format!(".{name}.partial"));
    let written = fs::write(&partial, text).and_then(|()| fs::rename(&partial, folder.join(name)));
    if written.is_err() {
        // What is left of a failed write is of no use; that it stays is no second error.
        let _ = fs::remove_file(&partial);
    }
    written
}

/// Whether a run writes a file of this name.
fn is_ours(name: &str) -> bool {
    let is_number = |text: &str| text.len() >= 4 && text.bytes().all(|b| b.is_ascii_digit());
    let line = |name: &str| {
        let stem = name.strip_suffix(".csv").or_else(|| name.strip_suffix(".svg"))?;
        let (number, _boundary) = stem.split_once('_').unwrap_or((stem, ""));
        let (number, part) = number.split_once('-').unwrap_or((number, "1"));
        Some(is_number(number) && part.bytes().all(|b| b.is_ascii_digit()))
    };
    let numbered = |prefix: &str, suffix: &str| {
        name.strip_prefix(prefix).and_then(|rest| rest.strip_suffix(suffix)).is_some_and(is_number)
    };
    let names =
        ["run.json", "increments.csv", "forces.csv", "events.csv", "fields.pvd", "forces.svg", "iterations.svg"];
    names.contains(&name)
        || name.strip_prefix("contact_").and_then(line).unwrap_or(false)
        || numbered("fields_", ".vtu")
        || numbered("deformed_", ".svg")
        || name.strip_prefix("probe_").and_then(|rest| rest.strip_suffix(".csv")).is_some()
}

#[cfg(test)]
mod tests {
    use super::is_ours;

    #[test]
    fn only_files_of_a_run_are_replaced() {
        assert!(
            ["run.json", "increments.csv", "contact_0001.csv", "contact_12345.svg", "contact_0001_left.csv"]
                .into_iter()
                .all(is_ours)
        );
        assert!(
            ["contact_0007-3.csv", "contact_0007-12_left.csv", "deformed_0000.svg", "probe_a.csv", "forces.svg"]
                .into_iter()
                .all(is_ours)
        );
        assert!(!["contact_0007-a.csv", "deformed_x.svg", "probe_a.txt"].into_iter().any(is_ours));
        assert!(is_ours("fields_0001.vtu") && is_ours("fields.pvd") && !is_ours("fields_mine.vtu"));
        assert!(!["contact_.csv", "contact_0001.txt", "contact_mine.csv", "notes.md"].into_iter().any(is_ours));
    }
}
