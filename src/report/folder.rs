//! The folder of a run's results, filled while the run goes on.

mod directory;
mod table;

use std::io::{self, Read, Write};
use std::path::Path;

use serde::{Deserialize, Serialize};

use super::balance::BalanceRecord;
use super::contact_line::ContactLine;
use super::contact_surface::ContactSurface;
use super::deformed::DeformedBody;
use super::history_chart::history_charts;
use super::probe::ProbeTable;
use super::resultant::ForceRecord;
use super::run::RunReport;
use super::vtu::Grid;
use super::{file_names, increments, lists, plot, pvd};
use crate::checkpoint::{Checkpoint, CheckpointError};
use crate::events::Event;
use crate::history::{IncrementRecord, Status, Step};
use crate::model::Model;
use crate::scene::Origin;
use crate::units::UnitSystem;
pub use directory::write_file;
use directory::{Directory, Locked};
use table::Table;

/// The file from which a run goes on.
const CHECKPOINT: &str = ".checkpoint";

/// A folder that is locked, before anything is written there.
#[derive(Debug)]
pub struct Claim {
    place: Locked,
    kept: Option<(Checkpoint, Kept)>,
}

/// What a folder needs to go on from a checkpoint.
#[derive(Debug, Clone, Serialize, Deserialize)]
struct Kept {
    origin: Origin,
    /// The linear algebra, by its word.
    linear: String,
    /// The tables with what they held, bytes.
    tables: Vec<(String, u64)>,
    /// The files of fields, each with its time, s.
    fields: Vec<(f64, String)>,
    /// The verdict, if the run has come to its end.
    ended: Option<Status>,
}

/// A folder that takes the results of one run: `increments.csv` and `forces.csv` grow line by line, contact lines
/// and plots come as they are reached, `run.json` at the end. What was there of an earlier run stays until the first increment is
/// done.
#[derive(Debug)]
pub struct ResultFolder {
    place: Locked,
    /// The units of what is written.
    units: UnitSystem,
    increments: Table,
    forces: Table,
    /// The table of events, from the first one on.
    events: Option<Table>,
    /// Boundaries with contact, and how the names of their files end.
    boundaries: Vec<(String, String)>,
    /// The probes, each with its table.
    probes: Vec<(ProbeTable, Table)>,
    /// The lists of the report.
    lists: [Table; 3],
    /// The files of fields so far, each with its time, s.
    fields: Vec<(f64, String)>,
    /// What a run must be to go on from here, with its linear algebra by its word.
    of: (Origin, String),
}

impl Claim {
    /// Makes the folder if need be, and locks it: nobody else writes there as long as this lives, or the folder that comes of it.
    ///
    /// # Errors
    /// When the folder cannot be made or written, when another run writes there ([`io::ErrorKind::ResourceBusy`]), and when it holds files
    /// with the names of results that no run wrote.
    pub fn new(path: &Path) -> io::Result<Self> {
        let place = Locked::open(path, may_take)?;
        for (name, is_folder) in place.directory.names()? {
            if is_folder && (is_ours(&name) || name == CHECKPOINT) {
                let message = format!("{} is a folder, where a file of results goes", path.join(name).display());
                return Err(io::Error::new(io::ErrorKind::AlreadyExists, message));
            }
        }
        let kept = place.directory.read(CHECKPOINT).and_then(|mut file| {
            let mut bytes = Vec::new();
            file.read_to_end(&mut bytes).map(|_| bytes)
        });
        let kept = match kept {
            Ok(bytes) => {
                Checkpoint::from_bytes(&bytes).and_then(|checkpoint| Ok((checkpoint.part(2)?, checkpoint))).ok()
            }
            Err(error) if error.kind() == io::ErrorKind::NotFound => None,
            Err(error) => return Err(error),
        };
        Ok(Claim { place, kept: kept.map(|(kept, checkpoint)| (checkpoint, kept)) })
    }

    /// Where the folder is.
    pub fn path(&self) -> &Path {
        self.place.directory.path()
    }

    /// The report that is there.
    ///
    /// # Errors
    /// When there is none.
    pub fn report(&self) -> io::Result<impl Read> {
        self.place.directory.read("run.json")
    }

    /// Where a run was left here, if one was; what it was of; its linear algebra, by its word; and its verdict, if it came to
    /// its end.
    pub fn left(&self) -> Option<(&Checkpoint, &Origin, &str, Option<Status>)> {
        let (checkpoint, kept) = self.kept.as_ref()?;
        Some((checkpoint, &kept.origin, &kept.linear, kept.ended))
    }

    /// The folder of a new run of `model`. How files are called is settled here, before anything is solved. `origin` and `linear` say
    /// what may go on from it.
    ///
    /// # Errors
    /// When the disk refuses.
    pub fn begin(
        self,
        model: &Model,
        probes: Vec<ProbeTable>,
        origin: Origin,
        linear: String,
    ) -> io::Result<ResultFolder> {
        let mut place = self.place;
        let several = model.contact_boundaries.iter().any(|boundary| boundary.obstacles.len() > 1);
        let mut table = |name: &str, header: &str| Table::new(name, place.table(name)?, header);
        let increments = table("increments.csv", &increments::header())?;
        let forces = table("forces.csv", &increments::forces_header(model.mesh.dimension, several))?;
        let names = file_names::file_names(probes.iter().map(|probe| probe.name.as_str()));
        let probes = probes.into_iter().zip(names).map(|(probe, name)| {
            let file = table(&format!("probe_{name}.csv"), &probe.header())?;
            Ok((probe, file))
        });
        let probes = probes.collect::<io::Result<_>>()?;
        let lists = [table(lists::FILES[0], "")?, table(lists::FILES[1], "")?, table(lists::FILES[2], "")?];
        Ok(ResultFolder {
            place,
            units: model.units(),
            increments,
            forces,
            events: None,
            boundaries: names_of_boundaries(model),
            probes,
            lists,
            fields: Vec::new(),
            of: (origin, linear),
        })
    }

    /// The folder of the run of `model` that was left here: its tables as they were at the checkpoint.
    ///
    /// # Errors
    /// When the disk refuses, and [`CheckpointError::Damaged`] when a table is shorter than it was, or not there.
    pub fn resume(self, model: &Model, probes: Vec<ProbeTable>) -> io::Result<ResultFolder> {
        let Claim { mut place, kept } = self;
        let (_, Kept { origin, linear, tables, fields, .. }) = kept.ok_or_else(damaged)?;
        place.go_on();
        let table = |name: &str| {
            let length =
                tables.iter().find(|(known, _)| known == name).map(|(_, length)| *length).ok_or_else(damaged)?;
            Table::cut(name, place.directory.edit(name, false)?, length)?.ok_or_else(damaged)
        };
        let (increments, forces) = (table("increments.csv")?, table("forces.csv")?);
        let events = tables.iter().any(|(name, _)| name == "events.csv").then(|| table("events.csv")).transpose()?;
        let names = file_names::file_names(probes.iter().map(|probe| probe.name.as_str()));
        let probes =
            probes.into_iter().zip(names).map(|(probe, name)| Ok((probe, table(&format!("probe_{name}.csv"))?)));
        let probes = probes.collect::<io::Result<_>>()?;
        let lists = [table(lists::FILES[0])?, table(lists::FILES[1])?, table(lists::FILES[2])?];
        // What it says is no longer true from here on.
        place.directory.remove("run.json")?;
        Ok(ResultFolder {
            place,
            units: model.units(),
            increments,
            forces,
            events,
            boundaries: names_of_boundaries(model),
            probes,
            lists,
            fields,
            of: (origin, linear),
        })
    }
}

impl ResultFolder {
    /// Where the results are.
    pub fn path(&self) -> &Path {
        self.place.directory.path()
    }

    /// Takes the record of an increment, and the forces at its end if it converged: those on the obstacles, and what else acts on
    /// the body. The results of an earlier run go. What else is written of the increment comes before this, so that of what is
    /// listed all is there, whatever ends the program.
    ///
    /// # Errors
    /// When the disk refuses.
    pub fn add_increment(
        &mut self,
        record: &IncrementRecord,
        forces: &[ForceRecord],
        reactions: Option<&BalanceRecord>,
    ) -> io::Result<()> {
        let [of_increments, of_forces, of_reactions] = &mut self.lists;
        forces.iter().try_for_each(|force| of_forces.append(&lists::line(force, &self.units)?))?;
        if let Some(reactions) = reactions {
            of_reactions.append(&lists::line(reactions, &self.units)?)?;
            self.forces.append(&increments::forces_lines(forces, reactions, &self.units))?;
        }
        of_increments.append(&lists::line(record, &self.units)?)?;
        self.increments.append(&increments::line(record, &self.units))?;
        if record.status == Status::Interrupted {
            // It has reached nothing.
            return Ok(());
        }
        self.place.publish(&["run.json", CHECKPOINT], is_ours)
    }

    /// Leaves the place from which the run can be taken up. All that was written so far is brought to the disk before.
    ///
    /// # Errors
    /// When the disk refuses.
    pub fn keep(&mut self, checkpoint: Checkpoint) -> io::Result<()> {
        self.sync()?;
        self.write_checkpoint(checkpoint, None)
    }

    fn write_checkpoint(&mut self, checkpoint: Checkpoint, ended: Option<Status>) -> io::Result<()> {
        let (origin, linear) = self.of.clone();
        let tables = self.tables().map(|table| (table.name().to_string(), table.length())).collect();
        let bytes = checkpoint.with(&Kept { origin, linear, tables, fields: self.fields.clone(), ended }).to_bytes();
        self.place.directory.write(CHECKPOINT, |file| {
            file.write_all(&bytes)?;
            directory::ignore_unsupported(file.sync_data())
        })?;
        self.place.directory.sync()
    }

    /// All tables that grow.
    fn tables(&self) -> impl Iterator<Item = &Table> {
        let probes = self.probes.iter().map(|(_, table)| table);
        [&self.increments, &self.forces].into_iter().chain(&self.events).chain(probes).chain(&self.lists)
    }

    /// Brings all that was written to the disk.
    fn sync(&mut self) -> io::Result<()> {
        self.tables().try_for_each(|table| directory::ignore_unsupported(table.sync()))?;
        self.place.sync_files()?;
        self.place.directory.sync()
    }

    /// Appends a contact node that changes its status in increment `index` to `events.csv`.
    ///
    /// # Errors
    /// When the disk refuses.
    pub fn add_event(&mut self, model: &Model, index: usize, event: &Event) -> io::Result<()> {
        let line = increments::event_line(model, index, event);
        if let Some(events) = &mut self.events {
            return events.append(&line);
        }
        let header = increments::events_header(model.mesh.dimension);
        let file = self.place.table("events.csv")?;
        self.events.insert(Table::new("events.csv", file, &header)?).append(&line)
    }

    /// Writes a contact line as CSV and, in two dimensions, as a plot, `contact_NNNN.csv` and `contact_NNNN.svg`; with
    /// the boundary's name behind the number if there are several, made fit for a file.
    ///
    /// # Errors
    /// When the disk refuses.
    pub fn add_contact_line(&mut self, line: &ContactLine, title: &str) -> io::Result<()> {
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
    pub fn add_part(&mut self, line: &ContactLine, part: usize) -> io::Result<()> {
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
        self.probes.iter_mut().try_for_each(|(probe, table)| table.append(&probe.lines(model, step)))
    }

    /// Writes the picture of the deformed body, `deformed_NNNN.svg`.
    ///
    /// # Errors
    /// When the disk refuses.
    pub fn add_deformed(&mut self, body: &DeformedBody, title: &str) -> io::Result<()> {
        self.write(&format!("deformed_{:04}.svg", body.index), &body.to_svg(title).map_err(io::Error::other)?)
    }

    /// Writes the report, whose lists are here, as `run.json`, after what it shows of the history as `forces.svg` and
    /// `iterations.svg`; and brings all to the disk. A run that has not come to its end can be taken up all the same.
    ///
    /// # Errors
    /// When the disk refuses.
    pub fn add_report(&mut self, report: &RunReport) -> io::Result<()> {
        if !self.place.is_published() && report.status == Status::Interrupted && self.report().is_ok() {
            // Those of an earlier run tell more.
            return Ok(());
        }
        self.place.publish(&["run.json", CHECKPOINT], is_ours)?;
        for (name, chart) in history_charts(report) {
            self.write(&format!("{name}.svg"), &chart.to_svg().map_err(io::Error::other)?)?;
        }
        let lists = lists::FILES.map(|name| self.place.directory.read(name));
        self.place.write("run.json", |file| lists::write(report, lists, file))?;
        self.sync()?;
        if report.status == Status::Converged {
            let end = Checkpoint::new(report.totals.converged, 0.0, &()).with(&());
            self.write_checkpoint(end, Some(report.status))?;
            lists::FILES.iter().try_for_each(|name| self.place.directory.remove(name))?;
        }
        Ok(())
    }

    /// The report as it was written.
    ///
    /// # Errors
    /// When it is not there.
    pub fn report(&self) -> io::Result<impl Read> {
        self.place.directory.read("run.json")
    }

    /// Writes the picture of a contact surface, `contact_NNNN.svg` as for a line.
    ///
    /// # Errors
    /// When the disk refuses.
    pub fn add_contact_surface(&mut self, surface: &ContactSurface, title: &str) -> io::Result<()> {
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
    pub fn write(&mut self, name: &str, text: &str) -> io::Result<()> {
        self.place.write(name, |file| file.write_all(text.as_bytes()))
    }

    /// The name of the files of a contact boundary in an increment; the boundary is named if there are several.
    fn contact_name(&self, index: usize, part: Option<usize>, boundary: Option<&str>) -> String {
        let file = boundary.and_then(|name| self.boundaries.iter().find(|(boundary, _)| boundary == name));
        let boundary = file.map_or(String::new(), |(_, file)| format!("_{file}"));
        let part = part.map_or(String::new(), |part| format!("-{part}"));
        format!("contact_{index:04}{part}{boundary}")
    }
}

fn names_of_boundaries(model: &Model) -> Vec<(String, String)> {
    let boundaries = || model.contact_boundaries.iter().map(|boundary| boundary.name.as_str());
    boundaries().map(String::from).zip(file_names::file_names(boundaries())).collect()
}

fn damaged() -> io::Error {
    io::Error::new(io::ErrorKind::InvalidData, CheckpointError::Damaged)
}

/// An error where files with the names of results are there, and no run wrote them. Runs of earlier versions left no marker, but
/// this table.
fn may_take(directory: &Directory) -> io::Result<()> {
    let names = directory.names()?;
    let Some((first, _)) = names.iter().find(|(name, _)| is_ours(name)) else { return Ok(()) };
    let mut found = vec![0; increments::FIRST_COLUMNS.len()];
    let read = directory.read("increments.csv").and_then(|mut file| file.read_exact(&mut found));
    if read.is_ok() && found == increments::FIRST_COLUMNS.as_bytes() {
        return Ok(());
    }
    let message =
        format!("{} is there already, and no run of stickslip wrote it", directory.path().join(first).display());
    Err(io::Error::new(io::ErrorKind::AlreadyExists, message))
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
