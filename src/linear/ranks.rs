//! The processes that a launcher of MPI has started side by side. Rank 0 does all that the program does; the others sleep until it
//! calls them to a factorisation, and end when it does.

#![allow(unsafe_code)]

use std::collections::HashMap;
use std::ffi::{c_int, c_long};
use std::mem::{self, ManuallyDrop};
use std::sync::{Mutex, MutexGuard, PoisonError};

use super::instance::{Instance, Job};
use super::sys;
use crate::linear::blas::room;
use crate::linear::{LinearError, RankUse, process};

/// How long a rank that has not been needed for a while sleeps before it looks again, ns.
const NAP: c_long = 5_000_000;

/// What rank 0 tells the others: what to do, with which instance, and which job that is.
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
    Ended,
}

/// All ranks, seen by one.
struct World {
    rank: usize,
    size: usize,
    /// The instances that there have been.
    instances: i64,
}

fn state() -> MutexGuard<'static, State> {
    MPI.lock().unwrap_or_else(PoisonError::into_inner)
}

impl State {
    /// The ranks, MPI being started if it was not.
    fn running(&mut self) -> Result<&mut World, LinearError> {
        let failed = |status: c_int| LinearError::Backend { backend: "MPI", step: "its start", status: status.into() };
        if let State::Before = self {
            // SAFETY: may be called at any time by one thread, which the lock of `MPI` sees to; rank and size come after.
            let (status, rank, size) =
                unsafe { (sys::mpi_shim_start(), sys::mpi_shim_rank() as usize, sys::mpi_shim_size() as usize) };
            if status != 0 {
                return Err(failed(status));
            }
            *self = State::Running(World { rank, size, instances: 0 });
        }
        match self {
            State::Running(world) => Ok(world),
            State::Before | State::Ended => Err(failed(-1)),
        }
    }
}

/// Hands out a command, on rank 0; what it is, on the others.
fn command(_running: &World, mut command: Command) -> Command {
    // SAFETY: MPI runs, and there are as many words on every rank.
    unsafe { sys::mpi_shim_hand_out(command.as_mut_ptr(), command.len() as c_int, NAP) };
    command
}

impl World {
    /// The numbers of each rank, on rank 0.
    fn collect<const N: usize>(&self, mine: [f64; N]) -> Vec<[f64; N]> {
        let mut all = vec![[0.0; N]; self.size];
        // SAFETY: as many numbers from every rank, and room for those of all.
        unsafe { sys::mpi_shim_collect(mine.as_ptr(), N as c_int, all.as_mut_ptr().cast()) };
        all
    }

    /// What each rank has taken, on rank 0.
    fn used(&self) -> Vec<RankUse> {
        let RankUse { cpu_seconds, peak_rss_bytes } = process::used();
        let of = |[cpu_seconds, bytes]: [f64; 2]| RankUse { cpu_seconds, peak_rss_bytes: bytes as u64 };
        self.collect([cpu_seconds, peak_rss_bytes as f64]).into_iter().map(of).collect()
    }

    /// Whether the BLAS of every rank has the memory that it takes for itself, on rank 0.
    fn prepare(&self) -> bool {
        let has_room = f64::from(room::prepare().is_ok());
        self.collect([has_room]).into_iter().all(|[has_room]| has_room == 1.0)
    }
}

/// Starts MPI, unless it runs: this process' rank, and how many there are. Without a launcher that is rank 0 of 1. Who is not rank 0
/// has to [`serve`].
///
/// # Errors
/// Where MPI does not bear calls of several threads, one at a time, or has ended.
pub fn start() -> Result<(usize, usize), LinearError> {
    state().running().map(|world| (world.rank, world.size))
}

/// What a rank other than 0 does from its start on: it helps rank 0, and comes back when that ends MPI.
///
/// # Errors
/// As [`start`]. On rank 0 it returns at once.
pub fn serve() -> Result<(), LinearError> {
    let mut state = state();
    let world = state.running()?;
    if world.rank == 0 {
        return Ok(());
    }
    let mut instances = HashMap::new();
    loop {
        let [word, id, job] = command(world, [END; 3]);
        let instance = |instances: &mut HashMap<i64, Instance>, job| {
            if let Some(instance) = instances.get_mut(&id) {
                instance.serve(job);
            }
        };
        match word {
            NEW => {
                instances.insert(id, Instance::new());
            }
            RUN if job == Job::Analyze as i64 => instance(&mut instances, Job::Analyze),
            RUN if job == Job::Factorize as i64 => instance(&mut instances, Job::Factorize),
            RUN => instance(&mut instances, Job::Solve),
            DROP => drop(instances.remove(&id)),
            REPORT => drop(world.used()),
            PREPARE => drop(world.prepare()),
            _ => break,
        }
    }
    // Rank 0 has not dropped those that are left, and both would have to.
    instances.into_values().for_each(mem::forget);
    finish(&mut state);
    Ok(())
}

/// Ends MPI, if it runs, and the other ranks with it; the last thing that rank 0 does.
pub fn end() {
    let mut state = state();
    if let State::Running(world) = &*state {
        command(world, [END; 3]);
        finish(&mut state);
    }
}

fn finish(state: &mut State) {
    // SAFETY: nothing of MPI is called from now on, which `Ended` sees to.
    unsafe { sys::mpi_shim_end() };
    *state = State::Ended;
}

/// What each of several ranks has taken so far. For rank 0.
pub fn used() -> Vec<RankUse> {
    match &*state() {
        State::Running(world) if world.size > 1 => {
            command(world, [REPORT, 0, 0]);
            world.used()
        }
        _ => Vec::new(),
    }
}

/// How many ranks there are; 1 unless MPI runs.
pub fn count() -> usize {
    match &*state() {
        State::Running(world) => world.size,
        State::Before | State::Ended => 1,
    }
}

/// An instance of MUMPS with its parts on all ranks, for rank 0.
pub(super) struct Shared {
    id: i64,
    instance: ManuallyDrop<Instance>,
}

impl Shared {
    /// # Errors
    /// As [`start`], where memory is short, and where MUMPS does not begin.
    pub fn new() -> Result<Self, LinearError> {
        let mut state = state();
        let world = state.running()?;
        command(world, [PREPARE, 0, 0]);
        if !world.prepare() {
            return Err(LinearError::OutOfMemory { step: "the BLAS of a rank, which takes 128 MiB for itself" });
        }
        world.instances += 1;
        let id = world.instances;
        command(world, [NEW, id, 0]);
        let shared = Shared { id, instance: ManuallyDrop::new(Instance::new()) };
        drop(state);
        shared.instance.check("its start")?;
        Ok(shared)
    }

    /// Rank 0's part of it.
    pub fn instance(&mut self) -> &mut Instance {
        &mut self.instance
    }

    /// Does a `job` on all ranks, of which rank 0 does its part by `own`.
    ///
    /// # Errors
    /// Where MPI has ended. How the job went, the instance knows.
    pub fn run(&mut self, job: Job, own: impl FnOnce(&mut Instance)) -> Result<(), LinearError> {
        let mut state = state();
        command(state.running()?, [RUN, self.id, job as i64]);
        own(&mut self.instance);
        Ok(())
    }
}

impl Drop for Shared {
    fn drop(&mut self) {
        let state = state();
        // Where MPI has ended before, nothing can be ended that takes it.
        if let State::Running(world) = &*state {
            command(world, [DROP, self.id, 0]);
            // SAFETY: nobody sees it afterwards.
            unsafe { ManuallyDrop::drop(&mut self.instance) };
        }
    }
}
