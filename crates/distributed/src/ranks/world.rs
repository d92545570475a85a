//! All ranks from the view of one: communication between rank 0 and the others.

#![allow(unsafe_code)]

use std::ffi::{c_int, c_long};

use super::{Command, sys};
use crate::expect_length;
use stickslip::algebra::linear::process::prepare_blas;
use stickslip::algebra::linear::{LinearError, RankUse};
use stickslip::run::report::{cpu_seconds, peak_rss_bytes};

/// The time that an idle rank sleeps between polls, ns.
const NAP: c_long = 5_000_000;

/// All ranks from the view of one, while MPI runs.
pub(crate) struct World {
    rank: usize,
    size: usize,
    /// The number of shared objects created so far.
    objects: i64,
}

/// The counts and offsets of the ranks' parts in MPI's format.
struct Shares {
    counts: Vec<c_int>,
    starts: Vec<c_int>,
}

impl Shares {
    /// Creates the parts between the `bounds`, one more than there are ranks. Rank 0 has `all` entries, this rank
    /// `mine`.
    /// # Errors
    /// If these lengths do not fit.
    fn new(world: &World, bounds: &[usize], all: usize, mine: usize) -> Result<Self, LinearError> {
        expect_length("bounds of the ranks", world.size + 1, bounds.len())?;
        expect_length("what this rank has", bounds[world.rank + 1].saturating_sub(bounds[world.rank]), mine)?;
        let last = bounds[world.size];
        if world.rank == 0 {
            expect_length("what all ranks have", last, all)?;
        }
        if !bounds.is_sorted() || c_int::try_from(last).is_err() {
            return Err(LinearError::OutOfMemory { step: "what ranks share, whose indices have 32 bits" });
        }
        let counts = bounds.windows(2).map(|pair| (pair[1] - pair[0]) as c_int).collect();
        Ok(Shares { counts, starts: bounds[..world.size].iter().map(|&start| start as c_int).collect() })
    }
}

#[allow(clippy::unused_self, reason = "MPI runs as long as there is a world")]
impl World {
    /// Starts MPI; no other thread may do so at the same time.
    ///
    /// # Errors
    /// The supported thread level, plus 1, if it does not include one call at a time.
    pub(super) fn start() -> Result<Self, c_int> {
        // SAFETY: one thread calls this at a time, and before rank and size.
        let (status, rank, size) =
            unsafe { (sys::mpi_shim_start(), sys::mpi_shim_rank() as usize, sys::mpi_shim_size() as usize) };
        if status == 0 { Ok(World { rank, size, objects: 0 }) } else { Err(status) }
    }

    /// Creates the view of rank 0 on this number of ranks, without MPI.
    #[cfg(test)]
    pub(super) fn of(size: usize) -> Self {
        World { rank: 0, size, objects: 0 }
    }

    /// Ends MPI.
    pub(super) fn end(self) {
        // SAFETY: every MPI call needs a `World`, and this was the only one.
        unsafe { sys::mpi_shim_end() };
    }

    /// Returns the rank of this process.
    pub(crate) fn rank(&self) -> usize {
        self.rank
    }

    /// Returns the number of processes.
    pub(crate) fn size(&self) -> usize {
        self.size
    }

    /// Returns the number of the next shared object.
    pub(super) fn next_object(&mut self) -> i64 {
        self.objects += 1;
        self.objects
    }

    /// Returns `MPI_COMM_WORLD` in Fortran's format.
    pub(crate) fn fortran(&self) -> c_int {
        // SAFETY: MPI runs.
        unsafe { sys::mpi_shim_world() }
    }

    /// Broadcasts the `words` of rank 0. All ranks must have the same number of them.
    pub(crate) fn tell(&self, words: &mut [i64]) {
        // SAFETY: MPI runs, and every rank has the same number of words.
        unsafe { sys::mpi_shim_hand_out(words.as_mut_ptr(), words.len() as c_int, NAP) };
    }

    /// Broadcasts a command, on rank 0.
    pub(super) fn command(&self, command: Command) {
        self.wait_for(command);
    }

    /// Waits for the next command, on the others.
    pub(super) fn wait_for(&self, mut command: Command) -> Command {
        self.tell(&mut command);
        command
    }

    /// Scatters the numbers of rank 0: each rank gets the part between its `bounds`. `all` is empty on the others.
    ///
    /// # Errors
    /// If lengths do not fit, before anything is sent.
    pub(crate) fn deal(&self, all: &[f64], bounds: &[usize], mine: &mut [f64]) -> Result<(), LinearError> {
        let Shares { counts, starts } = Shares::new(self, bounds, all.len(), mine.len())?;
        // SAFETY: `all` and `mine` have the lengths of the counts and starts, which are equal on every rank.
        unsafe {
            let (counts, starts) = (counts.as_ptr(), starts.as_ptr());
            sys::mpi_shim_deal_numbers(all.as_ptr(), counts, starts, mine.as_mut_ptr(), mine.len() as c_int);
        }
        Ok(())
    }

    /// Scatters integers in the same way.
    pub(crate) fn deal_integers(&self, all: &[i32], bounds: &[usize], mine: &mut [i32]) -> Result<(), LinearError> {
        let Shares { counts, starts } = Shares::new(self, bounds, all.len(), mine.len())?;
        // SAFETY: as above.
        unsafe {
            let (counts, starts) = (counts.as_ptr(), starts.as_ptr());
            sys::mpi_shim_deal_integers(all.as_ptr(), counts, starts, mine.as_mut_ptr(), mine.len() as c_int);
        }
        Ok(())
    }

    /// Gathers on rank 0 the parts of all ranks between their `bounds`; `all` is empty on the others.
    ///
    /// # Errors
    /// If lengths do not fit, before anything is sent.
    pub(crate) fn collect(&self, mine: &[f64], bounds: &[usize], all: &mut [f64]) -> Result<(), LinearError> {
        let Shares { counts, starts } = Shares::new(self, bounds, all.len(), mine.len())?;
        // SAFETY: as above.
        unsafe {
            let (counts, starts) = (counts.as_ptr(), starts.as_ptr());
            sys::mpi_shim_collect(mine.as_ptr(), mine.len() as c_int, all.as_mut_ptr(), counts, starts);
        }
        Ok(())
    }

    /// Gathers `N` numbers of each rank on rank 0.
    pub(crate) fn of_each<const N: usize>(&self, mine: [f64; N]) -> Vec<[f64; N]> {
        let bounds: Vec<usize> = (0..=self.size).map(|rank| rank * N).collect();
        let mut all = vec![0.0; if self.rank == 0 { self.size * N } else { 0 }];
        // The lengths fit.
        let _ = self.collect(&mine, &bounds, &mut all);
        all.chunks_exact(N).map(|numbers| std::array::from_fn(|k| numbers[k])).collect()
    }

    /// Returns `true` on all ranks if every rank has a `yes`.
    pub(crate) fn all(&self, yes: bool) -> bool {
        let answers = self.of_each([f64::from(yes)]);
        let mut all = [i64::from(answers.into_iter().all(|[yes]| yes == 1.0))];
        self.tell(&mut all);
        all == [1]
    }

    /// Returns on all ranks the bounds of consecutive parts, of which this rank's has `many` entries.
    pub(crate) fn bounds(&self, many: usize) -> Vec<usize> {
        let mut bounds = vec![0; self.size + 1];
        for (rank, [many]) in self.of_each([many as f64]).into_iter().enumerate() {
            bounds[rank + 1] = bounds[rank] + many as i64;
        }
        self.tell(&mut bounds);
        bounds.into_iter().map(|bound| bound as usize).collect()
    }

    /// Gathers the resources used by each rank on rank 0.
    pub(super) fn used(&self) -> Vec<RankUse> {
        let of = |[cpu_seconds, bytes]: [f64; 2]| RankUse { cpu_seconds, peak_rss_bytes: bytes as u64 };
        self.of_each([cpu_seconds(), peak_rss_bytes().unwrap_or(0) as f64]).into_iter().map(of).collect()
    }

    /// Returns `true` on rank 0 if the BLAS of every rank has memory for its buffers.
    pub(super) fn prepare(&self) -> bool {
        let has_room = f64::from(prepare_blas().is_ok());
        self.of_each([has_room]).into_iter().all(|[has_room]| has_room == 1.0)
    }
}
