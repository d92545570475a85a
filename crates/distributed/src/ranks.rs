//! The parallel processes of an MPI launcher. Rank 0 runs the program; the others sleep until rank 0 calls them for a
//! collective operation, and end when rank 0 does.

#![allow(unsafe_code)]

mod metis;
mod sys;
mod world;

use std::collections::HashMap;
use std::ffi::c_int;
use std::mem::ManuallyDrop;
use std::sync::{Mutex, MutexGuard};

pub(super) use metis::Graph;
pub(super) use metis::order;
pub(super) use metis::partition;
use stickslip::algebra::linear::{LinearError, RankUse};
pub(super) use world::World;

/// The local part of a shared object on one rank. Its methods are collective: all ranks call them.
pub(super) trait RankLocal: Send {
    /// Does the work of this rank in a `job`, identified by a number of rank 0.
    ///
    /// # Errors
    /// If this rank cannot continue; the others then wait in vain, so that it has to end all of them.
    fn serve(&mut self, world: &World, job: i64) -> Result<(), LinearError>;
}

/// The kind of a shared object.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Kind {
    Mumps,
    Amg,
    Stiffness,
}

impl Kind {
    const ALL: &[Kind] = &[Kind::Mumps, Kind::Amg, Kind::Stiffness];
}

/// A function that creates a rank's part of a shared object.
type Make<'a> = &'a mut dyn FnMut(Kind, &World) -> Result<Box<dyn RankLocal>, LinearError>;

/// A command that rank 0 broadcasts: the action, the object, and its kind or the job.
type Command = [i64; 3];

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
        let failed = |status: c_int| LinearError::Backend { backend: "MPI", step: "its start", status: status.into() };
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
/// Ranks other than 0 must call [`help`](super::help).
///
/// # Errors
/// If MPI does not allow calls from several threads, one at a time, or has ended; [`LinearError::RankFailed`] after an
/// error in work that ranks share.
pub fn start() -> Result<(usize, usize), LinearError> {
    state().running().map(|world| (world.rank(), world.size()))
}

/// Returns `true` if `number` equals that of rank 0. All ranks must call it, before any of them calls
/// [`help`](super::help).
///
/// # Errors
/// As [`start`].
pub fn agree(number: u64) -> Result<bool, LinearError> {
    let mut state = state();
    let world = state.running()?;
    let mut told = [number as i64];
    world.tell(&mut told);
    Ok(told == [number as i64])
}

/// Runs the worker loop of a rank other than 0 with the parts that it creates, until rank 0 ends MPI.
///
/// # Errors
/// As [`start`], and if this rank cannot do its work: the process then has to end without a call to MPI, whose
/// launcher ends the others. On rank 0 the function returns at once.
pub(super) fn serve(make: Make<'_>) -> Result<(), LinearError> {
    let mut state = state();
    let world = state.running()?;
    if world.rank() == 0 {
        return Ok(());
    }
    // Parts that rank 0 has not dropped are leaked, because dropping them would be collective.
    let mut parts: ManuallyDrop<HashMap<i64, Box<dyn RankLocal>>> = ManuallyDrop::default();
    loop {
        let [word, id, what] = world.wait_for([END; 3]);
        match word {
            NEW => {
                let kind = Kind::ALL.iter().find(|kind| **kind as i64 == what);
                if let Some(kind) = kind {
                    parts.insert(id, make(*kind, world)?);
                }
            }
            RUN => {
                if let Some(part) = parts.get_mut(&id) {
                    part.serve(world, what)?;
                }
            }
            DROP => drop(parts.remove(&id)),
            REPORT => drop(world.used()),
            PREPARE => drop(world.prepare()),
            _ => break,
        }
    }
    finish(&mut state);
    Ok(())
}

/// Ends MPI, if it runs, and the other ranks with it. It must be the last call on rank 0.
pub fn end() {
    let mut state = state();
    if let State::Running(world) = &*state {
        world.command([END; 3]);
        finish(&mut state);
    }
}

fn finish(state: &mut State) {
    if let State::Running(world) = std::mem::replace(state, State::Ended) {
        world.end();
    }
}

/// Returns the resources used by each of several ranks. For rank 0.
pub(crate) fn used() -> Vec<RankUse> {
    match &*state() {
        State::Running(world) if world.size() > 1 => {
            world.command([REPORT, 0, 0]);
            world.used()
        }
        _ => Vec::new(),
    }
}

/// Returns the number of ranks; 1 unless MPI runs.
pub fn count() -> usize {
    match &*state() {
        State::Running(world) => world.size(),
        State::Before | State::Broken | State::Ended => 1,
    }
}

/// A shared object with parts on all ranks, for rank 0.
pub(super) struct Shared<P: RankLocal> {
    id: i64,
    part: ManuallyDrop<P>,
}

impl<P: RankLocal> Shared<P> {
    /// Creates a shared object; `own` creates the part of rank 0.
    ///
    /// # Errors
    /// As [`start`], if memory is short for the BLAS of a rank, and as `own`.
    pub fn new(kind: Kind, own: impl FnOnce(&World) -> Result<P, LinearError>) -> Result<Self, LinearError> {
        let mut state = state();
        let world = state.running()?;
        world.command([PREPARE, 0, 0]);
        if !world.prepare() {
            return Err(LinearError::OutOfMemory { step: "the BLAS of a rank, which takes 128 MiB for itself" });
        }
        let id = world.next_object();
        world.command([NEW, id, kind as i64]);
        let part = own(world);
        Ok(Shared { id, part: ManuallyDrop::new(state.after(part)?) })
    }

    /// Returns the part of rank 0.
    pub fn part(&mut self) -> &mut P {
        &mut self.part
    }

    /// Runs a `job` on all ranks; `own` does the work of rank 0.
    ///
    /// # Errors
    /// If MPI has ended, and as `own`.
    pub fn run<T>(
        &mut self,
        job: i64,
        own: impl FnOnce(&World, &mut P) -> Result<T, LinearError>,
    ) -> Result<T, LinearError> {
        let mut state = state();
        let world = state.running()?;
        world.command([RUN, self.id, job]);
        let result = own(world, &mut self.part);
        state.after(result)
    }
}

impl<P: RankLocal> Drop for Shared<P> {
    fn drop(&mut self) {
        let state = state();
        // If MPI has ended before, the part cannot be dropped.
        if let State::Running(world) = &*state {
            world.command([DROP, self.id, 0]);
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
