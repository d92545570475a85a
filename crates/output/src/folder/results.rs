//! The files written by a run, and when.

use super::directory::{self, Directory, Locked};
use super::names::{CHECKPOINT, PAGE, is_head, is_ours};
use super::series::Series;
use super::state::{FolderState, KeptSolver};
use super::table::Table;
use crate::deformed::DeformedBody;
use crate::file_names::file_names;
use crate::history_chart::history_charts;
use crate::page::{error::PageError, page};
use crate::svg::PlotError;
use crate::view::{self, View};
use crate::vtu::Grid;
use crate::{ContactSurface, increments, lists, plot};
use std::io::{self, Read, Write};
use std::path::{Path, PathBuf};
use stickslip::base::UnitSystem;
use stickslip::body::Model;
use stickslip::run::report::{BalanceRecord, ContactLine, ForceRecord, ProbeTable, RunReport};
use stickslip::scene::Provenance;
use stickslip::solver::history::{IncrementRecord, IncrementView, Status};
use stickslip::solver::{Checkpoint, Event};

/// The result folder of one run. `increments.csv` and `forces.csv` grow line by line, contact lines and plots are added
/// during the run, and `run.json` is written at the end. Results of an earlier run remain until the first increment is
/// finished.
#[derive(Debug)]
pub struct ResultFolder {
    pub(super) folder: Locked,
    pub(super) tables: Tables,
    pub(super) fields: Series,
    /// `true` if a checkpoint exists from which this run can be resumed.
    pub(super) can_be_taken_up: bool,
    /// The identification of this run, which a resumed run must match, and its linear solver, which it keeps.
    pub(super) of: (Provenance, KeptSolver),
}

/// The tables that grow with the increments, and what their lines are made from.
#[derive(Debug)]
pub(super) struct Tables {
    units: UnitSystem,
    increments: Table,
    forces: Table,
    /// The table of events, created at the first event.
    pub(super) events: Option<Table>,
    /// The boundaries with contact, each with the ending of its file names.
    boundaries: Vec<(String, String)>,
    /// The probes, each with its table.
    probes: Vec<(ProbeTable, Table)>,
    /// The body for the page, and its states.
    view: Option<View>,
    states: Table,
    /// The lists of the report that grow with the increments.
    lists: [Table; 3],
}

impl Tables {
    /// Opens the tables of a run of `model` by their names and headers. File names are fixed here.
    pub(super) fn open(
        model: &Model,
        probes: Vec<ProbeTable>,
        mut open: impl FnMut(&str, &str) -> io::Result<Table>,
    ) -> io::Result<Self> {
        let several = model.contact.boundaries.iter().any(|boundary| boundary.obstacles.len() > 1);
        let coupled = !model.description().couplings.is_empty();
        let boundaries = || model.contact.boundaries.iter().map(|boundary| boundary.name.as_str());
        let view = View::of(model);
        let names: Vec<&str> = probes.iter().map(|probe| probe.name.as_str()).collect();
        let (head, files) = (view::head(model, view.as_ref(), &names), file_names(names.into_iter()));
        let forces_header = increments::forces_header(model.mesh.components(), several, coupled);
        Ok(Tables {
            units: model.units(),
            increments: open("increments.csv", &increments::header())?,
            forces: open("forces.csv", &forces_header)?,
            events: None,
            boundaries: boundaries().map(String::from).zip(file_names(boundaries())).collect(),
            view,
            states: open(view::FILE, &head)?,
            lists: [open(lists::FILES[0], "")?, open(lists::FILES[1], "")?, open(lists::FILES[2], "")?],
            probes: (probes.into_iter().zip(files))
                .map(|(probe, file)| open(&format!("probe_{file}.csv"), &probe.header()).map(|table| (probe, table)))
                .collect::<Result<_, _>>()?,
        })
    }

    /// Returns all tables.
    fn all(&self) -> impl Iterator<Item = &Table> {
        let probes = self.probes.iter().map(|(_, table)| table);
        [&self.increments, &self.forces, &self.states].into_iter().chain(&self.events).chain(probes).chain(&self.lists)
    }
}

impl ResultFolder {
    /// Returns the path of the folder.
    pub fn path(&self) -> &Path {
        &self.folder.directory.path
    }

    /// Returns the present path if the folder has been moved in the meantime.
    pub fn moved_to(&self) -> Option<PathBuf> {
        self.folder.directory.moved_to()
    }

    /// Adds the record of an increment and, if it converged, the forces at its end: contact forces on the obstacles and
    /// other forces on the body. Results of an earlier run are removed. All other files of the increment must be
    /// written before, so that the files of every listed increment exist, however the program ends.
    ///
    /// # Errors
    /// When the disk refuses.
    pub fn add_increment(
        &mut self,
        record: &IncrementRecord,
        forces: &[ForceRecord],
        reactions: Option<&BalanceRecord>,
    ) -> io::Result<()> {
        let [of_increments, of_forces, of_reactions] = &mut self.tables.lists;
        forces.iter().try_for_each(|force| of_forces.append(&lists::line(force, &self.tables.units)?))?;
        if let Some(reactions) = reactions {
            of_reactions.append(&lists::line(reactions, &self.tables.units)?)?;
            self.tables.forces.append(&increments::forces_lines(forces, reactions, &self.tables.units))?;
        }
        of_increments.append(&lists::line(record, &self.tables.units)?)?;
        self.tables.increments.append(&increments::line(record, &self.tables.units))?;
        if record.status == Status::Interrupted {
            // An interrupted increment has reached nothing.
            return Ok(());
        }
        self.folder.publish(is_head, is_ours)
    }

    /// Writes a checkpoint, after synchronising everything written so far with the disk.
    ///
    /// # Errors
    /// When the disk refuses.
    pub fn keep(&mut self, checkpoint: Checkpoint) -> io::Result<()> {
        self.sync()?;
        self.can_be_taken_up = true;
        let tables = self.tables.all().map(|table| (table.name.clone(), table.length)).collect();
        self.write_checkpoint(checkpoint, tables, None)
    }

    fn write_checkpoint(
        &mut self,
        checkpoint: Checkpoint,
        files: Vec<(String, u64)>,
        ended: Option<Status>,
    ) -> io::Result<()> {
        let (origin, linear) = self.of.clone();
        let state = FolderState { origin, linear, files, fields: self.fields.0.clone(), ended };
        let bytes = checkpoint.with(&state).to_bytes().map_err(io::Error::other)?;
        self.folder.directory.write(CHECKPOINT, |file| {
            file.write_all(&bytes)?;
            directory::ignore_unsupported(file.sync_data())
        })?;
        self.folder.directory.sync()
    }

    /// Writes all files to the disk.
    fn sync(&mut self) -> io::Result<()> {
        self.tables.all().try_for_each(|table| directory::ignore_unsupported(table.sync()))?;
        self.folder.sync_files()?;
        self.folder.directory.sync()
    }

    /// Appends the change of status of a contact node in increment `index` to `events.csv`.
    ///
    /// # Errors
    /// When the disk refuses.
    pub fn add_event(&mut self, model: &Model, index: usize, event: &Event) -> io::Result<()> {
        let line = increments::event_line(model, index, event);
        if let Some(events) = &mut self.tables.events {
            return events.append(&line);
        }
        let header = increments::events_header(model.mesh.dimension);
        let file = self.folder.table("events.csv")?;
        self.tables.events.insert(Table::new("events.csv", file, &header)?).append(&line)
    }

    /// Writes a contact line as CSV and, in two dimensions, as a plot, `contact_NNNN.csv` and `contact_NNNN.svg`. With
    /// several boundaries, the name of the boundary, adapted to file names, follows the number.
    ///
    /// # Errors
    /// When the disk refuses.
    pub fn add_contact_line(&mut self, line: &ContactLine, title: &str) -> io::Result<()> {
        let name = self.contact_name(line.index, None, line.boundary.as_deref());
        self.write(&format!("{name}.csv"), &line.to_csv())?;
        if line.dimension == 2 && line.points.len() > 1 {
            self.draw(&format!("{name}.svg"), plot::contact_stresses(line, title))?;
        }
        Ok(())
    }

    /// Writes a contact line at the end of substep `part` of its increment, `contact_NNNN-P.csv`.
    ///
    /// # Errors
    /// When the disk refuses.
    pub fn add_part(&mut self, line: &ContactLine, part: usize) -> io::Result<()> {
        self.write(
            &format!("{}.csv", self.contact_name(line.index, Some(part), line.boundary.as_deref())),
            &line.to_csv(),
        )
    }

    /// Appends the values at the points of a probe at the end of `step` to `probe_NAME.csv`.
    ///
    /// # Errors
    /// When the disk refuses.
    pub fn add_probes(&mut self, model: &Model, step: &IncrementView<'_>) -> io::Result<()> {
        self.tables.probes.iter_mut().try_for_each(|(probe, table)| table.append(&probe.lines(model, step)))
    }

    /// Writes the picture of the deformed body, `deformed_NNNN.svg`.
    ///
    /// # Errors
    /// When the disk refuses.
    pub fn add_deformed(&mut self, body: &DeformedBody, title: &str) -> io::Result<()> {
        self.draw(&format!("deformed_{:04}.svg", body.index), body.to_svg(title))
    }

    /// Adds the state of the body at the end of `step`, for the page.
    ///
    /// # Errors
    /// When the disk refuses.
    pub fn add_state(&mut self, model: &Model, step: &IncrementView<'_>) -> io::Result<()> {
        self.tables.view.as_ref().map_or(Ok(()), |view| self.tables.states.append(&view.line(model, step)))
    }

    /// Writes the charts `forces.svg` and `iterations.svg`, `cycle.csv` if a load cycle was asked for, the report with the stored lists as `run.json`, the page
    /// `report.html`, and writes all to the disk. An interrupted run can still be resumed. Returns `false` and writes nothing if the run
    /// was interrupted before its first results and results of an earlier run exist.
    ///
    /// # Errors
    /// When the disk refuses.
    pub fn add_report(&mut self, report: &RunReport) -> io::Result<bool> {
        if !self.folder.is_published && report.status == Status::Interrupted && self.report().is_ok() {
            return Ok(false);
        }
        self.folder.publish(is_head, is_ours)?;
        for (name, chart) in history_charts(report) {
            self.draw(&format!("{name}.svg"), chart.to_svg())?;
        }
        let lists = lists::FILES.map(|name| self.folder.directory.read(name));
        self.folder.write("run.json", |file| lists::write(report, lists, file))?;
        if let Some(cycle) = &report.cycle {
            self.write("cycle.csv", &cycle.to_csv(&report.units))?;
        }
        let page = page_of(&self.folder.directory).map_err(io::Error::other)?;
        self.write(PAGE, &page)?;
        self.sync()?;
        if report.status == Status::Converged {
            let end = Checkpoint::new(report.totals.converged, 0.0, &()).with(&());
            let names = self.folder.directory.names()?.into_iter().map(|(name, _)| name).filter(|name| is_ours(name));
            let files = names.map(|name| self.folder.directory.length(&name).map(|length| (name, length)));
            let files = files.collect::<io::Result<_>>()?;
            self.write_checkpoint(end, files, Some(report.status))?;
        }
        if report.status == Status::Converged || !self.can_be_taken_up {
            lists::FILES.iter().try_for_each(|name| self.folder.directory.remove(name))?;
        }
        Ok(true)
    }

    /// Writes a `picture`. A state with numbers that are not finite, where an increment failed, has none.
    fn draw(&mut self, name: &str, picture: Result<String, PlotError>) -> io::Result<()> {
        picture.map_or(Ok(()), |picture| self.write(name, &picture))
    }

    /// Opens the written report.
    ///
    /// # Errors
    /// When it does not exist.
    pub fn report(&self) -> io::Result<impl Read> {
        self.folder.directory.read("run.json")
    }

    /// Writes the picture of a contact surface, `contact_NNNN.svg`, named as for a line.
    ///
    /// # Errors
    /// When the disk refuses.
    pub fn add_contact_surface(&mut self, surface: &ContactSurface, title: &str) -> io::Result<()> {
        let name = self.contact_name(surface.index, None, surface.boundary.as_deref());
        self.draw(&format!("{name}.svg"), surface.to_svg(title))
    }

    /// Writes the fields at the end of increment `index`, at `time` (s), as `fields_NNNN.vtu`. If ranks share the body,
    /// it writes the part of each as `fields_NNNN_R.vtu`, and `fields_NNNN.pvtu`, which lists these. The series
    /// `fields.pvd` is written last, so no file lists one that does not exist.
    ///
    /// # Errors
    /// When the disk refuses.
    pub fn add_fields(&mut self, index: usize, time: f64, grid: &Grid) -> io::Result<()> {
        self.fields.add(&mut self.folder, index, time, grid)
    }

    /// Writes a whole file. A reader never sees half of it.
    ///
    /// # Errors
    /// When the disk refuses.
    pub fn write(&mut self, name: &str, text: &str) -> io::Result<()> {
        self.folder.write(name, |file| file.write_all(text.as_bytes()))
    }

    /// Returns the name of the files of a contact boundary in an increment. It contains the boundary if there are
    /// several.
    fn contact_name(&self, index: usize, part: Option<usize>, boundary: Option<&str>) -> String {
        let file = boundary.and_then(|name| self.tables.boundaries.iter().find(|(boundary, _)| boundary == name));
        let boundary = file.map_or(String::new(), |(_, file)| format!("_{file}"));
        let part = part.map_or(String::new(), |part| format!("-{part}"));
        format!("contact_{index:04}{part}{boundary}")
    }
}

/// Writes the page `report.html` of the results in a folder again, also while a run fills it, or after a run that was
/// killed and has left no `run.json`.
///
/// # Errors
/// When the folder has no results, its report cannot be read, or the disk refuses.
pub fn write_page(folder: &Path) -> Result<(), PageError> {
    let failed = |error| PageError::Folder { path: folder.to_path_buf(), error };
    let directory = Directory::open(folder).map_err(failed)?;
    let names = directory.names().map_err(failed)?;
    if !names.iter().any(|(name, is_folder)| !is_folder && ["run.json", "increments.csv"].contains(&name.as_str())) {
        return Err(PageError::NoResults { path: folder.to_path_buf() });
    }
    let page = page_of(&directory)?;
    Ok(directory.write(PAGE, |file| file.write_all(page.as_bytes()))?)
}

/// Returns the page of the results in a folder.
fn page_of(directory: &Directory) -> Result<String, PageError> {
    let names = directory.names()?.into_iter().filter(|(name, is_folder)| !is_folder && is_ours(name));
    let names: Vec<String> = names.map(|(name, _)| name).collect();
    page(&names, |name| text_of(directory, name))
}

/// Reads a result file.
fn text_of(directory: &Directory, name: &str) -> Result<String, PageError> {
    let mut bytes = Vec::new();
    let read = directory.read(name).and_then(|mut file| file.read_to_end(&mut bytes));
    read.map_err(|error| PageError::Unreadable { name: name.to_string(), error })?;
    String::from_utf8(bytes).map_err(|error| {
        let at = error.utf8_error().valid_up_to();
        let line = 1 + String::from_utf8_lossy(&error.as_bytes()[..at]).matches('\n').count();
        PageError::NoText { name: name.to_string(), line, byte: at + 1 }
    })
}
