//! What a run writes, and when.

use std::io::{self, Read, Write};
use std::path::{Path, PathBuf};

use super::directory::{self, Locked};
use super::kept::Kept;
use super::names::{CHECKPOINT, is_head, is_ours};
use super::series::Series;
use super::table::Table;
use crate::ContactSurface;
use crate::deformed::DeformedBody;
use crate::history_chart::history_charts;
use crate::vtu::Grid;
use crate::{increments, lists, plot};
use stickslip::base::units::UnitSystem;
use stickslip::body::model::Model;
use stickslip::run::report::BalanceRecord;
use stickslip::run::report::ContactLine;
use stickslip::run::report::ForceRecord;
use stickslip::run::report::ProbeTable;
use stickslip::run::report::RunReport;
use stickslip::scene::Origin;
use stickslip::solver::checkpoint::Checkpoint;
use stickslip::solver::events::Event;
use stickslip::solver::history::{IncrementRecord, IncrementView, Status};

/// A folder that takes the results of one run: `increments.csv` and `forces.csv` grow line by line, contact lines
/// and plots come as they are reached, `run.json` at the end. What was there of an earlier run stays until the first increment is
/// done.
#[derive(Debug)]
pub struct ResultFolder {
    pub(super) place: Locked,
    /// The units of what is written.
    pub(super) units: UnitSystem,
    pub(super) increments: Table,
    pub(super) forces: Table,
    /// The table of events, from the first one on.
    pub(super) events: Option<Table>,
    /// Boundaries with contact, and how the names of their files end.
    pub(super) boundaries: Vec<(String, String)>,
    /// The probes, each with its table.
    pub(super) probes: Vec<(ProbeTable, Table)>,
    /// The lists of the report.
    pub(super) lists: [Table; 3],
    pub(super) fields: Series,
    /// Whether there is a place from which this run can be taken up.
    pub(super) can_be_taken_up: bool,
    /// What a run must be to go on from here, with its linear algebra by its word.
    pub(super) of: (Origin, String),
}

impl ResultFolder {
    /// Where the results are.
    pub fn path(&self) -> &Path {
        self.place.directory.path()
    }

    /// Where they are by now, if somebody has moved the folder in the meantime.
    pub fn moved_to(&self) -> Option<PathBuf> {
        self.place.directory.moved_to()
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
        self.place.publish(is_head, is_ours)
    }

    /// Leaves the place from which the run can be taken up. All that was written so far is brought to the disk before.
    ///
    /// # Errors
    /// When the disk refuses.
    pub fn keep(&mut self, checkpoint: Checkpoint) -> io::Result<()> {
        self.sync()?;
        self.can_be_taken_up = true;
        let tables = self.tables().map(|table| (table.name().to_string(), table.length())).collect();
        self.write_checkpoint(checkpoint, tables, None)
    }

    fn write_checkpoint(
        &mut self,
        checkpoint: Checkpoint,
        files: Vec<(String, u64)>,
        ended: Option<Status>,
    ) -> io::Result<()> {
        let (origin, linear) = self.of.clone();
        let kept = Kept { origin, linear, files, fields: self.fields.files().to_vec(), ended };
        let bytes = checkpoint.with(&kept).to_bytes().map_err(io::Error::other)?;
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
    pub fn add_probes(&mut self, model: &Model, step: &IncrementView<'_>) -> io::Result<()> {
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
    /// `iterations.svg`; and brings all to the disk. A run that has not come to its end can be taken up all the same. Where a run was
    /// interrupted before it had anything, and an earlier one had, nothing is written: tells whether it was.
    ///
    /// # Errors
    /// When the disk refuses.
    pub fn add_report(&mut self, report: &RunReport) -> io::Result<bool> {
        if !self.place.is_published() && report.status == Status::Interrupted && self.report().is_ok() {
            return Ok(false);
        }
        self.place.publish(is_head, is_ours)?;
        for (name, chart) in history_charts(report) {
            self.write(&format!("{name}.svg"), &chart.to_svg().map_err(io::Error::other)?)?;
        }
        let lists = lists::FILES.map(|name| self.place.directory.read(name));
        self.place.write("run.json", |file| lists::write(report, lists, file))?;
        self.sync()?;
        if report.status == Status::Converged {
            let end = Checkpoint::new(report.totals.converged, 0.0, &()).with(&());
            let names = self.place.directory.names()?.into_iter().map(|(name, _)| name).filter(|name| is_ours(name));
            let files = names.map(|name| self.place.directory.length(&name).map(|length| (name, length)));
            let files = files.collect::<io::Result<_>>()?;
            self.write_checkpoint(end, files, Some(report.status))?;
        }
        if report.status == Status::Converged || !self.can_be_taken_up {
            lists::FILES.iter().try_for_each(|name| self.place.directory.remove(name))?;
        }
        Ok(true)
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

    /// Writes the fields at the end of increment `index`, at `time` (s), as `fields_NNNN.vtu`; or where ranks share the body, the part of each as
    /// `fields_NNNN_R.vtu`, and `fields_NNNN.pvtu`, which names these. Then the series of all so far as `fields.pvd`. So none ever names a file
    /// that is not there.
    ///
    /// # Errors
    /// When the disk refuses.
    pub fn add_fields(&mut self, index: usize, time: f64, grid: &Grid) -> io::Result<()> {
        self.fields.add(&mut self.place, index, time, grid)
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
