//! The parallel processes of an MPI launcher. Rank 0 runs the program; the others sleep until rank 0 calls them for a
//! collective operation, and end when rank 0 does.

#![allow(unsafe_code)]

pub(crate) mod shim;

use std::collections::HashMap;
use std::mem::ManuallyDrop;
use std::sync::{Mutex, MutexGuard};

use stickslip::algebra::NodeRows;
use stickslip::algebra::linear::process::prepare_blas;
use stickslip::algebra::linear::{LinearError, RankUse};
use stickslip::run::report::{cpu_seconds, peak_rss_bytes};

use crate::part::{Job, Part};
use crate::petsc;
use shim::World;

/// A function that assembles a rank's rows of the shared stiffness, or returns `None` if it cannot.
pub type RankRows<'a> = &'a mut dyn FnMut() -> Option<Box<dyn NodeRows>>;

/// A command that rank 0 broadcasts: the action, the part, the job or what the part is for, and the system.
type Command = [i64; 4];

const END: i64 = 0;
const NEW: i64 = 1;
const RUN: i64 = 2;
const DROP: i64 = 3;
const REPORT: i64 = 4;
const PREPARE: i64 = 5;

/// Only one MPI call may run at a time, and all ranks must take part in the same one.
static MPI: Mutex<State> = Mutex::new(State::Before);

enum State {
    Before,
    Running(World),
    /// Rank 0 has left a collective operation by an error or a panic, and others may still be waiting in it.
    Broken,
    Ended,
}

fn state() -> MutexGuard<'static, State> {
    MPI.lock().unwrap_or_else(|panicked| {
        // A panic in a collective operation has left the other ranks in it.
        let mut state = panicked.into_inner();
        state.abandon();
        state
    })
}

impl State {
    /// Returns the ranks, and starts MPI if needed.
    fn running(&mut self) -> Result<&mut World, LinearError> {
        let failed = |status: i32| LinearError::Backend { backend: "MPI", step: "its start", status: status.into() };
        if let State::Before = self {
            *self = State::Running(World::start().map_err(failed)?);
        }
        match self {
            State::Running(world) => Ok(world),
            State::Broken => Err(LinearError::RankFailed),
            State::Before | State::Ended => Err(failed(-1)),
        }
    }

    /// Passes on the result of a collective operation. After an error no further one is possible.
    fn after<T>(&mut self, result: Result<T, LinearError>) -> Result<T, LinearError> {
        if result.is_err() {
            self.abandon();
        }
        result
    }

    /// Abandons the other ranks, if there are any: this process has to end, and the launcher ends them.
    fn abandon(&mut self) {
        if matches!(self, State::Running(world) if world.size() > 1) {
            *self = State::Broken;
        }
    }
}

/// Starts MPI, unless it runs. Returns the rank of this process and the number of ranks; without a launcher 0 and 1.
/// Ranks other than 0 must call [`help`].
///
/// # Errors
/// If MPI does not allow calls from several threads, one at a time, or has ended; [`LinearError::RankFailed`] after an
/// error in work that ranks share.
pub fn start() -> Result<(usize, usize), LinearError> {
    state().running().map(|world| (world.rank(), world.size()))
}

/// Returns `true` if `number` equals that of rank 0. All ranks must call it, before any of them calls [`help`].
///
/// # Errors
/// As [`start`].
pub fn agree(number: u64) -> Result<bool, LinearError> {
    let mut state = state();
    state.running()?;
    let mut told = [number as i64];
    shim::tell(&mut told);
    Ok(told == [number as i64])
}

/// Runs the worker loop of a rank other than 0, until rank 0 ends MPI. The `body` must be that of rank 0; without one
/// rank 0 assembles alone.
///
/// # Errors
/// As [`start`], and if this rank cannot do its work: the process then has to end without a call to MPI, whose
/// launcher ends the others. On rank 0 the function returns at once.
pub fn help(body: RankRows<'_>) -> Result<(), LinearError> {
    let mut state = state();
    let world = state.running()?;
    if world.rank() == 0 {
        return Ok(());
    }
    // Parts that rank 0 has not dropped are leaked, because dropping them would be collective.
    let mut parts: ManuallyDrop<HashMap<i64, Part>> = ManuallyDrop::default();
    loop {
        let mut command: Command = [END; 4];
        shim::tell(&mut command);
        let [word, id, what, of] = command;
        match word {
            NEW => {
                let body = if what == 0 { None } else { body() };
                parts.insert(id, Part::helping(world, body.as_deref(), what != 0)?);
            }
            RUN => {
                if let (Some(part), Some(job)) = (parts.get_mut(&id), Job::of(what)) {
                    part.serve(world, job, of)?;
                }
            }
            DROP => drop(parts.remove(&id)),
            REPORT => drop(use_of_each(world)),
            PREPARE => drop(has_room(world)),
            _ => break,
        }
    }
    finish(&mut state);
    Ok(())
}

/// Ends MPI, if it runs, and the other ranks with it. It must be the last call on rank 0.
pub fn end() {
    let mut state = state();
    if let State::Running(_) = &*state {
        shim::tell(&mut [END; 4]);
        finish(&mut state);
    }
}

fn finish(state: &mut State) {
    if let State::Running(world) = std::mem::replace(state, State::Ended) {
        petsc::end();
        world.end();
    }
}

/// Returns the resources used by each of several ranks. For rank 0.
pub(crate) fn used() -> Vec<RankUse> {
    match &*state() {
        State::Running(world) if world.size() > 1 => {
            shim::tell(&mut [REPORT, 0, 0, 0]);
            use_of_each(world)
        }
        _ => Vec::new(),
    }
}

/// Returns the number of ranks; 1 unless MPI runs.
pub(crate) fn count() -> usize {
    match &*state() {
        State::Running(world) => world.size(),
        State::Before | State::Broken | State::Ended => 1,
    }
}

fn use_of_each(world: &World) -> Vec<RankUse> {
    let of = |[cpu_seconds, bytes]: [f64; 2]| RankUse { cpu_seconds, peak_rss_bytes: bytes as u64 };
    world.of_each([cpu_seconds(), peak_rss_bytes().unwrap_or(0) as f64]).into_iter().map(of).collect()
}

/// Returns `true` on rank 0 if the BLAS of every rank has memory for its buffers.
fn has_room(world: &World) -> bool {
    let has_room = f64::from(prepare_blas().is_ok());
    world.of_each([has_room]).into_iter().all(|[has_room]| has_room == 1.0)
}

/// A part on each rank, from the view of rank 0.
pub(crate) struct Shared {
    id: i64,
    part: ManuallyDrop<Part>,
}

impl Shared {
    /// Creates the parts, with the rows of `body` if there is one.
    ///
    /// # Errors
    /// As [`start`], and if memory is short.
    pub(crate) fn new(body: Option<&dyn NodeRows>) -> Result<Self, LinearError> {
        let mut state = state();
        let world = state.running()?;
        shim::tell(&mut [PREPARE, 0, 0, 0]);
        if !has_room(world) {
            return Err(LinearError::OutOfMemory { step: "the BLAS of a rank, which takes 128 MiB for itself" });
        }
        let id = world.next();
        shim::tell(&mut [NEW, id, body.is_some().into(), 0]);
        let part = Part::leading(world, body);
        Ok(Shared { id, part: ManuallyDrop::new(state.after(part)?) })
    }

    /// Runs a `job` on all ranks, for the system of this number; `own` does the work of rank 0.
    ///
    /// # Errors
    /// If MPI has ended, and as `own`.
    pub(crate) fn run<T>(
        &mut self,
        job: Job,
        of: i64,
        own: impl FnOnce(&World, &mut Part) -> Result<T, LinearError>,
    ) -> Result<T, LinearError> {
        let mut state = state();
        let world = state.running()?;
        shim::tell(&mut [RUN, self.id, job as i64, of]);
        let result = own(world, &mut self.part);
        state.after(result)
    }

    /// Returns the part of rank 0.
    pub(crate) fn part(&self) -> &Part {
        &self.part
    }
}

impl Drop for Shared {
    fn drop(&mut self) {
        let state = state();
        // If MPI has ended before, the part cannot be dropped.
        if let State::Running(_) = &*state {
            shim::tell(&mut [DROP, self.id, 0, 0]);
            // SAFETY: the part is not used afterwards.
            unsafe { ManuallyDrop::drop(&mut self.part) };
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn after_a_failure_the_ranks_are_lost() {
        for (size, then) in [(1, None), (2, Some(LinearError::RankFailed))] {
            let mut state = State::Running(World::of(size));
            let failure = LinearError::OutOfMemory { step: "a test" };
            assert_eq!(state.after::<()>(Err(failure.clone())), Err(failure));
            assert_eq!(state.running().err(), then);
        }
    }
}
