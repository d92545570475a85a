//! The parallel processes of an MPI launcher. Rank 0 runs the program; the others sleep until rank 0 calls them for a
//! collective operation, and end when rank 0 does.

#![allow(unsafe_code)]

pub(crate) mod shim;

use std::sync::{Mutex, MutexGuard};

use stickslip::algebra::NodeRows;
use stickslip::algebra::linear::{LinearError, RankUse};

use crate::job::{Job, Objects, Own, Reply};
use crate::petsc;
use shim::World;

/// A function that assembles a rank's rows of the shared stiffness, or returns `None` if it cannot.
pub type RankRows<'a> = &'a mut dyn FnMut() -> Option<Box<dyn NodeRows>>;

/// Only one MPI call may run at a time, and all ranks must take part in the same one.
static MPI: Mutex<State> = Mutex::new(State::Before);

enum State {
    Before,
    Running(World, Objects),
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
    fn running(&mut self) -> Result<(&World, &mut Objects), LinearError> {
        let failed = |status: i32| LinearError::Backend { backend: "MPI", step: "its start", status: status.into() };
        if let State::Before = self {
            *self = State::Running(World::start().map_err(failed)?, Objects::default());
        }
        match self {
            State::Running(world, objects) => Ok((world, objects)),
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

    /// Abandons the other ranks, if there are any: this process has to end, and the launcher ends them. Objects are
    /// leaked, because dropping them would be collective.
    fn abandon(&mut self) {
        if matches!(self, State::Running(world, _) if world.size > 1) {
            std::mem::forget(std::mem::replace(self, State::Broken));
        }
    }

    fn finish(&mut self) {
        if let State::Running(world, objects) = std::mem::replace(self, State::Ended) {
            drop(objects);
            petsc::end();
            world.end();
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
    state().running().map(|(world, _)| (world.rank, world.size))
}

/// Returns `true` if `number` equals that of rank 0. All ranks must call it, before any of them calls [`help`].
///
/// # Errors
/// As [`start`].
pub fn agree(number: u64) -> Result<bool, LinearError> {
    let mut state = state();
    state.running()?;
    let mut agreed = [number];
    shim::broadcast(&mut agreed);
    Ok(agreed == [number])
}

/// Runs the worker loop of a rank other than 0, until rank 0 ends MPI. The `body` must be that of rank 0; without one
/// rank 0 assembles alone.
///
/// # Errors
/// As [`start`], and if this rank cannot do its work: the process then has to end without a call to MPI, whose
/// launcher ends the others. On rank 0 the function returns at once.
pub fn help(body: RankRows<'_>) -> Result<(), LinearError> {
    let mut state = state();
    let (world, objects) = state.running()?;
    if world.rank == 0 {
        return Ok(());
    }
    loop {
        let told = shim::broadcast_job(None)?;
        if let Job::End = told.1 {
            break;
        }
        let body = if let Job::Rows(_) = told.1 { body() } else { None };
        let own = Own { body: body.as_deref(), ..Own::default() };
        if let Err(error) = objects.perform(world, told, own) {
            state.abandon();
            return Err(error);
        }
    }
    state.finish();
    Ok(())
}

/// Runs a `job` on all ranks, on the object of this number; rank 0 has the data. Returns the results that are no
/// vectors.
///
/// # Errors
/// As [`start`], and if the work fails.
pub(crate) fn run(told: (i64, Job), own: Own<'_>) -> Reply {
    let mut state = state();
    let (world, objects) = state.running()?;
    let result = shim::broadcast_job(Some(told)).and_then(|told| objects.perform(world, told, own));
    state.after(result)
}

/// Ends MPI, if it runs, and the other ranks with it. It must be the last call on rank 0.
pub fn end() {
    let mut state = state();
    if let State::Running(..) = &*state {
        // If the other ranks are gone, there is nobody left to end.
        let _ = shim::broadcast_job(Some((0, Job::End)));
        state.finish();
    }
}

/// Returns the resources used by each of several ranks. For rank 0.
pub(crate) fn used() -> Vec<RankUse> {
    let several = (count() > 1).then(|| run((0, Job::Use), Own::default()).unwrap_or_default());
    let of = |[cpu_seconds, bytes, _]: &[f64; 3]| RankUse { cpu_seconds: *cpu_seconds, peak_rss_bytes: *bytes as u64 };
    several.unwrap_or_default().as_chunks().0.iter().map(of).collect()
}

/// Returns the number of ranks; 1 unless MPI runs.
pub(crate) fn count() -> usize {
    if let State::Running(world, _) = &*state() { world.size } else { 1 }
}

/// Returns an error unless PETSc has asked for each of these options.
pub(crate) fn check_options(options: &str) -> Result<(), LinearError> {
    let _alone = state();
    petsc::check_options(options)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn after_a_failure_the_ranks_are_lost() {
        for (size, then) in [(1, None), (2, Some(LinearError::RankFailed))] {
            let mut state = State::Running(World { rank: 0, size }, Objects::default());
            let failure = LinearError::OutOfMemory { step: "a test" };
            assert_eq!(state.after::<()>(Err(failure.clone())), Err(failure));
            assert_eq!(state.running().err(), then);
        }
    }
}
