//! Keeps what happens, and asks Python whether to go on.

use crate::arrays::table;
use crate::foreign::Raised;
use crate::saver::Saver;
use pyo3::prelude::*;
use pyo3::types::PyDict;
use serde::{Deserialize, Serialize};
use std::ops::ControlFlow;
use std::time::{Duration, Instant};
use stickslip::run::RecordWriter;
use stickslip::run::report::{BalanceRecord, ForceRecord};
use stickslip::solver::ContactStatus;
use stickslip::solver::history::{IncrementRecord, IncrementView, Observer};
use stickslip::solver::{Checkpoint, IterationRecord};

/// 0 open, 1 stick, 2 slip, as in the VTU files.
pub(crate) fn codes(statuses: &[ContactStatus]) -> impl Iterator<Item = u8> + '_ {
    statuses.iter().map(|status| match status {
        ContactStatus::Open => 0,
        ContactStatus::Stick => 1,
        ContactStatus::Slip => 2,
    })
}

/// Between two looks at signals. Attaching costs nothing beside this, unless another thread of Python is busy: then each
/// costs its switch interval, 5 ms.
pub(crate) const PATIENCE: Duration = Duration::from_millis(50);

/// The increments whose displacements and forces of size n_u are kept.
#[derive(Clone, PartialEq, Serialize, Deserialize, FromPyObject)]
pub(crate) enum Keep {
    /// `True`: all; `False`: none.
    All(bool),
    /// Those of these numbers, from 1; 0 stands for the last.
    These(Vec<usize>),
}

/// A table that grows by rows.
#[derive(Default, Serialize, Deserialize)]
struct Growing {
    rows: usize,
    values: Vec<f64>,
}

impl Growing {
    fn push(&mut self, row: &[f64]) {
        self.rows += 1;
        self.values.extend_from_slice(row);
    }

    fn replace(&mut self, row: &[f64]) {
        *self = Growing::default();
        self.push(row);
    }

    fn write(self, into: &Bound<'_, PyDict>, name: &str) -> PyResult<()> {
        into.set_item(name, table(into.py(), self.rows, self.values)?)
    }
}

/// The columns of size n_c.
const OF_NODES: [&str; 7] = ["p_n", "p_t", "p_o", "gap", "mu", "w_t_last", "w_o_last"];

/// The arrays and records of the increments up to now.
#[derive(Default, Serialize, Deserialize)]
pub(crate) struct Kept {
    /// The numbers of the increments whose `u` is kept.
    numbers: Vec<usize>,
    of_body: [Growing; 3],
    of_nodes: [Growing; OF_NODES.len()],
    statuses: Vec<u8>,
    iterations: Growing,
    /// A record for each increment.
    pub records: Vec<IncrementRecord>,
    /// The resultants of the contact forces, and the other forces on the body, of a scene.
    pub forces: Vec<ForceRecord>,
    pub reactions: Vec<BalanceRecord>,
}

pub(crate) struct Recorder {
    looked: Instant,
    keep: Keep,
    callback: Option<Py<PyAny>>,
    /// An exception, a `KeyboardInterrupt` for one, that ends the run.
    pub raised: Raised,
    pub kept: Kept,
    /// Where the run is saved, if it is.
    saver: Option<Saver>,
    /// `true` while a run that is to end goes on to the end of its increment, where it is saved.
    ends_saved: bool,
    /// Why the run is no longer saved.
    pub unsaved: Option<String>,
}

impl Recorder {
    pub fn new(keep: Keep, callback: Option<Py<PyAny>>, raised: Raised) -> Self {
        Recorder {
            looked: Instant::now(),
            keep,
            callback,
            raised,
            kept: Kept::default(),
            saver: None,
            ends_saved: false,
            unsaved: None,
        }
    }

    /// Saves the run as `saver` says, from which it goes on if `saver` has found an earlier part of it.
    pub fn saved_by(mut self, saver: Option<Saver>) -> PyResult<(Self, Option<Checkpoint>)> {
        let Some(saver) = saver else { return Ok((self, None)) };
        let left = saver.left()?;
        self.saver = Some(saver);
        Ok(match left {
            Some((checkpoint, kept)) => (Recorder { kept, ..self }, Some(checkpoint)),
            None => (self, None),
        })
    }

    /// Calls Python, if the time has come; whether to go on. A run that is saved goes on to the end of its increment after the
    /// first exception, and ends at once after another.
    fn look(&mut self, call: impl FnOnce(Python<'_>) -> PyResult<()>, now: bool) -> ControlFlow<()> {
        let was_raised = self.raised.is_set();
        if was_raised && !self.ends_saved {
            return ControlFlow::Break(());
        }
        if !now && self.looked.elapsed() < PATIENCE {
            return ControlFlow::Continue(());
        }
        self.looked = Instant::now();
        match Python::attach(|py| py.check_signals().and_then(|()| call(py))) {
            Ok(()) => ControlFlow::Continue(()),
            Err(error) => {
                self.raised.set(error);
                self.ends_saved = self.saver.is_some() && !was_raised;
                if self.ends_saved { ControlFlow::Continue(()) } else { ControlFlow::Break(()) }
            }
        }
    }

    fn keep(&mut self, step: &IncrementView<'_>) {
        let (number, state) = (step.record.index, step.state);
        // Every row has its rest, which is empty where it does not matter.
        let rest = if state.u_rest.is_empty() { vec![0.0; state.u.len()] } else { state.u_rest.clone() };
        let rows = [&state.u[..], &rest, step.increment.force];
        let last = match &self.keep {
            Keep::All(all) if *all => false,
            Keep::These(numbers) if numbers.contains(&number) => false,
            Keep::These(numbers) if numbers.contains(&0) => true,
            _ => return,
        };
        let kept = &mut self.kept;
        if last {
            kept.numbers.clear();
            kept.of_body.iter_mut().zip(rows).for_each(|(kept, row)| kept.replace(row));
        } else {
            kept.of_body.iter_mut().zip(rows).for_each(|(kept, row)| kept.push(row));
        }
        kept.numbers.push(number);
    }

    /// All that was kept, as arrays.
    pub fn write(self, into: &Bound<'_, PyDict>) -> PyResult<()> {
        let Kept { numbers, of_body, of_nodes, statuses, iterations, .. } = self.kept;
        let increments = of_nodes[0].rows;
        into.set_item("kept", numbers)?;
        for (name, kept) in ["u", "u_rest", "force"].into_iter().zip(of_body) {
            kept.write(into, name)?;
        }
        for (name, kept) in OF_NODES.into_iter().zip(of_nodes) {
            kept.write(into, name)?;
        }
        into.set_item("contact", table(into.py(), increments, statuses)?)?;
        iterations.write(into, "iterations")
    }
}

impl Observer for Recorder {
    fn iteration(&mut self, index: usize, record: &IterationRecord) -> ControlFlow<()> {
        let IterationRecord { iteration, theta, step, error, .. } = *record;
        self.kept.iterations.push(&[index as f64, iteration as f64, theta, step, error.unwrap_or(f64::NAN)]);
        self.look(|_| Ok(()), false)
    }

    fn increment(&mut self, step: &IncrementView<'_>) -> ControlFlow<()> {
        self.keep(step);
        let (state, data) = (step.state, step.increment);
        let columns: [&[f64]; OF_NODES.len()] =
            [&state.p_n, &state.p_t, &state.p_o, data.gap, data.mu, data.w_t_last, data.w_o_last];
        self.kept.of_nodes.iter_mut().zip(columns).for_each(|(kept, row)| kept.push(row));
        self.kept.statuses.extend(codes(step.statuses));
        self.kept.records.push(step.record.clone());
        let IncrementRecord { index, time, status, iterations, .. } = *step.record;
        let error = step.record.kkt.worst().1;
        let callback = self.callback.as_ref().map(|callback| Python::attach(|py| callback.clone_ref(py)));
        let now = callback.is_some();
        self.look(
            |py| match callback {
                Some(callback) => callback.call1(py, (index, time, status.to_string(), iterations, error)).map(drop),
                None => Ok(()),
            },
            now,
        )
    }

    fn checkpoint_offered(&mut self, here: &dyn Fn() -> Checkpoint) {
        if let Some(saver) = &mut self.saver
            && (self.ends_saved || saver.is_due())
            && let Err(message) = saver.save(here, &self.kept)
        {
            // The run is worth more than its copy.
            self.unsaved = Some(message);
            self.saver = None;
        }
        self.ends_saved = false;
    }
}

impl RecordWriter for Recorder {
    // The record itself is known from the increment.
    fn add(&mut self, _: &IncrementRecord, forces: &[ForceRecord], reactions: Option<&BalanceRecord>) {
        self.kept.forces.extend_from_slice(forces);
        self.kept.reactions.extend(reactions.cloned());
    }
}
