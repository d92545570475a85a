//! The processes that a launcher of MPI has started side by side. Rank 0 does all that the program does; the others sleep until it
//! calls them to what all do together, and end when it does.

#![allow(unsafe_code)]

mod metis;
mod sys;
mod world;

use std::collections::HashMap;
use std::ffi::c_int;
use std::mem::ManuallyDrop;
use std::sync::{Mutex, MutexGuard};

use super::{LinearError, RankUse};
pub(super) use metis::Graph;
#[cfg(feature = "mumps")]
pub(super) use metis::order;
#[cfg(feature = "petsc")]
pub(super) use metis::partition;
pub(super) use world::World;

/// What each rank has of an object that all share. Whatever is called of it, is called on all ranks at a time.
pub(super) trait RankLocal: Send {
    /// What this rank does in a `job`, by the number that rank 0 has for it.
    ///
    /// # Errors
    /// Where this rank cannot go on; the others then wait in vain, so that it has to end all of them.
    fn serve(&mut self, world: &World, job: i64) -> Result<(), LinearError>;
}

/// What can be shared.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Kind {
    #[cfg(feature = "mumps")]
    Mumps,
    #[cfg(feature = "petsc")]
    Amg,
    #[cfg(feature = "petsc")]
    Stiffness,
}

impl Kind {
    const ALL: &[Kind] = &[
        #[cfg(feature = "mumps")]
        Kind::Mumps,
        #[cfg(feature = "petsc")]
        Kind::Amg,
        #[cfg(feature = "petsc")]
        Kind::Stiffness,
    ];
}

/// Makes a rank's part of something that is shared.
type Make<'a> = &'a mut dyn FnMut(Kind, &World) -> Result<Box<dyn RankLocal>, LinearError>;

/// What rank 0 tells the others: what to do, with which object, and which kind or job that is.
type Command = [i64; 3];

const END: i64 = 0;
const NEW: i64 = 1;
const RUN: i64 = 2;
const DROP: i64 = 3;
const REPORT: i64 = 4;
const PREPARE: i64 = 5;

/// MPI bears one call at a time, and all ranks must meet in the same one.
static MPI: Mutex<State> = Mutex::new(State::Before);

enum State {
    Before,
    Running(World),
    /// Rank 0 has left what all do together with an error or a panic, and others may still be waiting in it.
    Broken,
    Ended,
}

fn state() -> MutexGuard<'static, State> {
    MPI.lock().unwrap_or_else(|panicked| {
        // Who panicked in what all ranks do together has left the others in it.
        let mut state = panicked.into_inner();
        state.abandon();
        state
    })
}

impl State {
    /// The ranks, MPI being started if it was not.
    fn running(&mut self) -> Result<&mut World, LinearError> {
        let failed = |status: c_int| LinearError::Backend { backend: "MPI", step: "its start", status: status.into() };
        if let State::Before = self {
            *self = State::Running(World::start().map_err(failed)?);
        }
        match self {
            State::Running(world) => Ok(world),
            State::Before | State::Broken | State::Ended => Err(failed(-1)),
        }
    }

    /// What came out of something that all ranks did together. After an error nothing is done together any more.
    fn after<T>(&mut self, result: Result<T, LinearError>) -> Result<T, LinearError> {
        if result.is_err() {
            self.abandon();
        }
        result
    }

    /// Leaves the other ranks, if there are any, where they are: this process has to end, and the launcher ends them.
    fn abandon(&mut self) {
        if matches!(self, State::Running(world) if world.size() > 1) {
            *self = State::Broken;
        }
    }
}

/// Starts MPI, unless it runs: this process' rank, and how many there are. Without a launcher that is rank 0 of 1. Who is not rank 0
/// has to [`help`](super::help).
///
/// # Errors
/// Where MPI does not bear calls of several threads, one at a time, or has ended.
pub fn start() -> Result<(usize, usize), LinearError> {
    state().running().map(|world| (world.rank(), world.size()))
}

/// Whether `number` is that of rank 0; on all ranks at a time, before any of them helps.
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

/// What a rank other than 0 does from its start on: it helps rank 0 with the parts that it makes, and comes back when that ends MPI.
///
/// # Errors
/// As [`start`], and where this rank cannot do its part: the process has to end then, without a word to MPI, whose launcher ends the
/// others. On rank 0 it returns at once.
pub(super) fn serve(make: Make<'_>) -> Result<(), LinearError> {
    let mut state = state();
    let world = state.running()?;
    if world.rank() == 0 {
        return Ok(());
    }
    // Those that rank 0 has not dropped at the end stay: both would have to.
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

/// Ends MPI, if it runs, and the other ranks with it; the last thing that rank 0 does.
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

/// What each of several ranks has taken so far. For rank 0.
pub fn used() -> Vec<RankUse> {
    match &*state() {
        State::Running(world) if world.size() > 1 => {
            world.command([REPORT, 0, 0]);
            world.used()
        }
        _ => Vec::new(),
    }
}

/// How many ranks there are; 1 unless MPI runs.
pub fn count() -> usize {
    match &*state() {
        State::Running(world) => world.size(),
        State::Before | State::Broken | State::Ended => 1,
    }
}

/// An object with its parts on all ranks, for rank 0.
pub(super) struct Shared<P: RankLocal> {
    id: i64,
    part: ManuallyDrop<P>,
}

impl<P: RankLocal> Shared<P> {
    /// A new one, of which rank 0 makes its part by `own`.
    ///
    /// # Errors
    /// As [`start`], where memory is short for the BLAS of a rank, and as `own`.
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

    /// Rank 0's part of it.
    #[cfg(feature = "mumps")]
    pub fn part(&mut self) -> &mut P {
        &mut self.part
    }

    /// Does a `job` on all ranks, of which rank 0 does its part by `own`.
    ///
    /// # Errors
    /// Where MPI has ended, and as `own`.
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
        // Where MPI has ended before, nothing can be ended that takes it.
        if let State::Running(world) = &*state {
            world.command([DROP, self.id, 0]);
            // SAFETY: nobody sees it afterwards.
            unsafe { ManuallyDrop::drop(&mut self.part) };
        }
    }
}
