//! Displays and writes results during a run.

use super::super::interrupt;
use super::super::progress::Progress;
use std::io;
use std::ops::ControlFlow;
use stickslip::algebra::linear;
use stickslip::body::Model;
use stickslip::run::report::{BalanceRecord, ContactLine, ForceRecord};
use stickslip::run::{RecordWriter, RecordedIncrement};
use stickslip::scene::Output;
use stickslip::solver::Event;
use stickslip::solver::history::{IncrementRecord, IncrementView, Observer, Status};
use stickslip::solver::{Checkpoint, IterationRecord};
use stickslip_output::{ContactSurface, DeformedBody, MAX_STATES, Pace, ResultFolder, fields};

/// Observer that updates the display and the result folder.
pub(super) struct Watcher<'a> {
    pub model: &'a Model,
    pub title: &'a str,
    pub output: &'a Output,
    /// The increments whose contact lines are written, ascending.
    pub wanted: Vec<usize>,
    pub folder: Option<ResultFolder>,
    pub progress: Progress,
    /// The interval between checkpoints.
    pub pace: Pace,
    pub failed_write: Option<io::Error>,
}

impl Watcher<'_> {
    /// Writes the body before the first increment.
    pub(super) fn start(&mut self, undeformed: &RecordedIncrement) {
        if self.wanted.first() == Some(&0) {
            let data = undeformed.data();
            let written = self.write(&undeformed.step(&data)).and_then(|()| self.probe(&undeformed.step(&data)));
            self.failed_write = written.err();
        }
    }

    /// Writes the files that exist for selected increments only.
    fn write(&mut self, step: &IncrementView<'_>) -> io::Result<()> {
        let is_shown = self.is_shown(step);
        let Some(folder) = &mut self.folder else { return Ok(()) };
        for line in ContactLine::all(self.model, step) {
            folder.add_contact_line(&line, self.title)?;
        }
        for surface in ContactSurface::all(self.model, step) {
            folder.add_contact_surface(&surface, self.title)?;
        }
        if is_shown {
            folder.add_state(self.model, step)?;
        }
        if self.output.fields {
            folder.add_fields(step.record.index, step.record.time, &fields(self.model, step))?;
        }
        if self.output.deformed {
            folder.add_deformed(&DeformedBody::new(self.model, step, self.output.magnification), self.title)?;
        }
        Ok(())
    }

    /// Returns `true` if the page may show the body at the end of this increment: it shows few of many, evenly, with the
    /// last one, and one that failed.
    fn is_shown(&self, step: &IncrementView<'_>) -> bool {
        let stride = self.wanted.len().div_ceil(MAX_STATES);
        let index = self.wanted.binary_search(&step.record.index);
        step.record.status != Status::Converged
            || index.is_ok_and(|place| (self.wanted.len() - 1 - place).is_multiple_of(stride))
    }

    fn probe(&mut self, step: &IncrementView<'_>) -> io::Result<()> {
        self.folder.as_mut().map_or(Ok(()), |folder| folder.add_probes(self.model, step))
    }

    fn add(&mut self, step: &IncrementView<'_>) -> io::Result<()> {
        let converged = step.record.status == Status::Converged;
        if converged {
            self.probe(step)?;
        }
        // The state reached by a failed increment helps to find the cause. An interrupted increment has reached
        // nothing.
        let is_failure = !converged && step.record.status != Status::Interrupted;
        if is_failure || converged && self.is_wanted(step) { self.write(step) } else { Ok(()) }
    }

    /// Asks the run to stop if the user has asked, or if a result cannot be written.
    fn flow(&self) -> ControlFlow<()> {
        let stop = interrupt::requested() || self.failed_write.is_some();
        if stop { ControlFlow::Break(()) } else { ControlFlow::Continue(()) }
    }

    fn is_wanted(&self, step: &IncrementView<'_>) -> bool {
        self.wanted.binary_search(&step.record.index).is_ok()
    }
}

impl Observer for Watcher<'_> {
    /// Only now, so that memory freed by the analysis returns to the system.
    fn ready(&mut self) {
        linear::process::keep_freed_memory();
    }

    fn iteration(&mut self, _index: usize, record: &IterationRecord) -> ControlFlow<()> {
        self.progress.iteration(record.iteration, record.theta);
        self.flow()
    }

    fn event(&mut self, index: usize, event: &Event) {
        if let (Some(folder), None) = (&mut self.folder, &self.failed_write) {
            self.failed_write = folder.add_event(self.model, index, event).err();
        }
    }

    fn substep(&mut self, part: &IncrementView<'_>) {
        let is_wanted = self.is_wanted(part);
        if let (Some(folder), true) = (&mut self.folder, is_wanted && self.failed_write.is_none()) {
            let mut lines = ContactLine::all(self.model, part).into_iter();
            self.failed_write = lines.try_for_each(|line| folder.add_part(&line, part.record.parts)).err();
        }
    }

    fn increment(&mut self, step: &IncrementView<'_>) -> ControlFlow<()> {
        if self.failed_write.is_none() {
            self.failed_write = self.add(step).err();
        }
        self.progress.increment(step.record);
        self.flow()
    }

    fn checkpoint_offered(&mut self, here: &dyn Fn() -> Checkpoint) {
        if let (Some(folder), None) = (&mut self.folder, &self.failed_write)
            && self.pace.is_due()
        {
            self.failed_write = self.pace.keep(|| folder.keep(here())).err();
        }
    }
}

impl RecordWriter for Watcher<'_> {
    fn add(&mut self, record: &IncrementRecord, forces: &[ForceRecord], reactions: Option<&BalanceRecord>) {
        if let (Some(folder), None) = (&mut self.folder, &self.failed_write) {
            self.failed_write = folder.add_increment(record, forces, reactions).err();
        }
    }
}
