//! A result folder before a run writes to it: its lock and the state left by an earlier run.

use super::directory::{Directory, Locked};
use super::names::{CHECKPOINT, PAGE, is_ours};
use super::results::{ResultFolder, Tables};
use super::series::Series;
use super::state::{FolderState, KeptSolver};
use super::table::Table;
use crate::{increments, lists};
use std::io::{self, Read};
use std::path::Path;
use stickslip::body::Model;
use stickslip::run::report::ProbeTable;
use stickslip::scene::Provenance;
use stickslip::solver::history::Status;
use stickslip::solver::{Checkpoint, CheckpointError};

/// A locked folder to which nothing has been written yet.
#[derive(Debug)]
pub struct LockedOutputDir {
    folder: Locked,
    earlier: Option<(Checkpoint, FolderState)>,
    is_damaged: bool,
}

impl LockedOutputDir {
    /// Creates the folder if necessary, and locks it against other runs as long as this value, or the result folder
    /// made from it, exists.
    ///
    /// # Errors
    /// When the folder cannot be created or written, when another run writes there ([`io::ErrorKind::ResourceBusy`]),
    /// and when it contains files with the names of results that no run wrote.
    pub fn new(path: &Path) -> io::Result<Self> {
        let folder = Locked::open(path, may_take)?;
        refuse_folders(&folder.directory)?;
        let stored = folder.directory.read(CHECKPOINT).and_then(|mut file| {
            let mut bytes = Vec::new();
            file.read_to_end(&mut bytes).map(|_| bytes)
        });
        let (earlier, is_damaged) = match stored {
            Ok(bytes) => {
                let read = Checkpoint::from_bytes(&bytes).and_then(|checkpoint| Ok((checkpoint.part(2)?, checkpoint)));
                let is_damaged = read.is_err();
                (read.ok(), is_damaged)
            }
            Err(error) if error.kind() == io::ErrorKind::NotFound => (None, false),
            Err(error) => return Err(error),
        };
        // The run may have been killed before it could remove them.
        if earlier.as_ref().is_some_and(|(earlier, _): &(FolderState, _)| earlier.ended.is_some()) {
            lists::FILES.iter().try_for_each(|name| folder.directory.remove(name))?;
        }
        Ok(LockedOutputDir { folder, earlier: earlier.map(|(kept, checkpoint)| (checkpoint, kept)), is_damaged })
    }

    /// Returns `true` if an earlier run has left a checkpoint that cannot be read: it is damaged, or of another build.
    pub fn is_damaged(&self) -> bool {
        self.is_damaged
    }

    /// Returns the path of the folder.
    pub fn path(&self) -> &Path {
        &self.folder.directory.path
    }

    /// Opens the report in the folder.
    ///
    /// # Errors
    /// When there is none.
    pub fn report(&self) -> io::Result<impl Read> {
        self.folder.directory.read("run.json")
    }

    /// Returns the checkpoint of an earlier run, if any, with the identification of the run, its linear solver, and its verdict if it has finished.
    pub fn earlier_run(&self) -> Option<(&Checkpoint, &Provenance, &KeptSolver, Option<Status>)> {
        let (checkpoint, earlier) = self.earlier.as_ref()?;
        Some((checkpoint, &earlier.origin, &earlier.linear, earlier.ended))
    }

    /// Returns the first file of a finished run that is missing, or shorter than the run has left it.
    pub fn missing_file(&self) -> Option<&str> {
        let (_, earlier) = self.earlier.as_ref().filter(|(_, kept)| kept.ended.is_some())?;
        let is_short = |name: &str, length| self.folder.directory.length(name).map_or(true, |now| now < length);
        // The page can be made again, by other versions too.
        let needed = earlier.files.iter().filter(|(name, _)| name != PAGE);
        needed.into_iter().find(|(name, length)| is_short(name, *length)).map(|(name, _)| name.as_str())
    }

    /// Creates the result folder of a new run of `model`. File names are fixed here, before anything is solved.
    /// `origin` and `linear` identify the runs that may resume it.
    ///
    /// # Errors
    /// When the disk refuses.
    pub fn begin(
        self,
        model: &Model,
        probes: Vec<ProbeTable>,
        origin: Provenance,
        linear: KeptSolver,
    ) -> io::Result<ResultFolder> {
        let mut folder = self.folder;
        let tables = Tables::open(model, probes, |name, header| Table::new(name, folder.table(name)?, header))?;
        let (fields, of) = (Series::default(), (origin, linear));
        Ok(ResultFolder { folder, tables, fields, can_be_taken_up: false, of })
    }

    /// Reopens the result folder of the interrupted run of `model`, with its tables truncated to the checkpoint.
    ///
    /// # Errors
    /// When the disk refuses, and [`CheckpointError::Damaged`] when a table is missing or shorter than at the
    /// checkpoint.
    pub fn resume(self, model: &Model, probes: Vec<ProbeTable>) -> io::Result<ResultFolder> {
        let LockedOutputDir { mut folder, earlier, .. } = self;
        let (_, FolderState { origin, linear, files, fields, .. }) = earlier.ok_or_else(damaged)?;
        folder.is_published = true;
        let table = |name: &str| {
            let length =
                files.iter().find(|(known, _)| known == name).map(|(_, length)| *length).ok_or_else(damaged)?;
            let table = folder.directory.edit(name, false).and_then(|file| Table::cut(name, file, length));
            table.map_err(|error| io::Error::new(error.kind(), format!("{name}: {error}")))
        };
        let mut tables = Tables::open(model, probes, |name, _| table(name))?;
        tables.events = files.iter().any(|(name, _)| name == "events.csv").then(|| table("events.csv")).transpose()?;
        // From here on the report is out of date.
        folder.directory.remove("run.json")?;
        let fields = Series::resumed(fields, &mut folder)?;
        Ok(ResultFolder { folder, tables, fields, can_be_taken_up: true, of: (origin, linear) })
    }
}

fn damaged() -> io::Error {
    io::Error::new(io::ErrorKind::InvalidData, CheckpointError::Damaged)
}

/// Returns an error if files with the names of results exist that no run wrote. Runs of earlier versions left no
/// marker, but are recognised by this table.
fn may_take(directory: &Directory) -> io::Result<()> {
    refuse_folders(directory)?;
    let names = directory.names()?;
    let Some((first, _)) = names.iter().find(|(name, _)| is_ours(name)) else { return Ok(()) };
    let mut found = vec![0; increments::FIRST_COLUMNS.len()];
    let read = directory.read("increments.csv").and_then(|mut file| file.read_exact(&mut found));
    if read.is_ok() && found == increments::FIRST_COLUMNS.as_bytes() {
        return Ok(());
    }
    Err(directory.not_written_here(first))
}

/// Returns an error if a folder has the name of a result file.
fn refuse_folders(directory: &Directory) -> io::Result<()> {
    let names = directory.names()?;
    let Some((name, _)) = names.iter().find(|(name, is_folder)| *is_folder && (is_ours(name) || name == CHECKPOINT))
    else {
        return Ok(());
    };
    let message = format!("{} is a folder with the name of a result file", directory.path.join(name).display());
    Err(io::Error::new(io::ErrorKind::AlreadyExists, message))
}
