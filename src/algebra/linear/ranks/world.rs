//! All ranks, seen by one: what is handed from rank 0 to the others, and back.

#![allow(unsafe_code)]

use std::ffi::{c_int, c_long};

use super::{Command, sys};
use crate::algebra::linear::blas::room;
use crate::algebra::linear::error::expect_length;
use crate::algebra::linear::{LinearError, RankUse, process};

/// How long a rank that has not been needed for a while sleeps before it looks again, ns.
const NAP: c_long = 5_000_000;

/// All ranks, seen by one, while MPI runs.
pub(in crate::algebra::linear) struct World {
    rank: usize,
    size: usize,
    /// The shared objects that there have been.
    objects: i64,
}

/// How many of something each rank has, and from where on, as MPI wants it.
struct Shares {
    counts: Vec<c_int>,
    starts: Vec<c_int>,
}

impl Shares {
    /// Those between the `bounds`, one more than there are ranks, of something that rank 0 has `all` of, and this rank `mine`.
    ///
    /// # Errors
    /// When these lengths do not fit.
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
    /// Starts MPI; nobody else may do so at the same time.
    ///
    /// # Errors
    /// The level of threads that it bears, plus 1, where that is not one call at a time.
    pub(super) fn start() -> Result<Self, c_int> {
        // SAFETY: called by one thread at a time; rank and size come after.
        let (status, rank, size) =
            unsafe { (sys::mpi_shim_start(), sys::mpi_shim_rank() as usize, sys::mpi_shim_size() as usize) };
        if status == 0 { Ok(World { rank, size, objects: 0 }) } else { Err(status) }
    }

    /// Ends MPI.
    pub(super) fn end(self) {
        // SAFETY: what calls MPI needs a world, and this one is gone.
        unsafe { sys::mpi_shim_end() };
    }

    /// This process.
    pub(in crate::algebra::linear) fn rank(&self) -> usize {
        self.rank
    }

    /// How many processes there are.
    pub(in crate::algebra::linear) fn size(&self) -> usize {
        self.size
    }

    /// The number of one more shared object.
    pub(super) fn next_object(&mut self) -> i64 {
        self.objects += 1;
        self.objects
    }

    /// `MPI_COMM_WORLD`, as Fortran wants it.
    #[cfg(feature = "mumps")]
    pub(in crate::algebra::linear) fn fortran(&self) -> c_int {
        // SAFETY: MPI runs.
        unsafe { sys::mpi_shim_world() }
    }

    /// Hands `words` of rank 0 to all: as many on each.
    pub(in crate::algebra::linear) fn tell(&self, words: &mut [i64]) {
        // SAFETY: MPI runs, and there are as many words on every rank.
        unsafe { sys::mpi_shim_hand_out(words.as_mut_ptr(), words.len() as c_int, NAP) };
    }

    /// Hands out a command, on rank 0.
    pub(super) fn command(&self, command: Command) {
        self.wait_for(command);
    }

    /// What the next command is, on the others.
    pub(super) fn wait_for(&self, mut command: Command) -> Command {
        self.tell(&mut command);
        command
    }

    /// Deals the numbers of rank 0, to each rank what is between its `bounds`; `all` is empty on the others.
    ///
    /// # Errors
    /// When lengths do not fit, before anything is dealt.
    #[cfg(feature = "petsc")]
    pub(in crate::algebra::linear) fn deal(
        &self,
        all: &[f64],
        bounds: &[usize],
        mine: &mut [f64],
    ) -> Result<(), LinearError> {
        let Shares { counts, starts } = Shares::new(self, bounds, all.len(), mine.len())?;
        // SAFETY: `all` and `mine` are as long as counts and starts say, and those are the same on every rank.
        unsafe {
            let (counts, starts) = (counts.as_ptr(), starts.as_ptr());
            sys::mpi_shim_deal_numbers(all.as_ptr(), counts, starts, mine.as_mut_ptr(), mine.len() as c_int);
        }
        Ok(())
    }

    /// The same with integers.
    #[cfg(feature = "petsc")]
    pub(in crate::algebra::linear) fn deal_integers(
        &self,
        all: &[i32],
        bounds: &[usize],
        mine: &mut [i32],
    ) -> Result<(), LinearError> {
        let Shares { counts, starts } = Shares::new(self, bounds, all.len(), mine.len())?;
        // SAFETY: as above.
        unsafe {
            let (counts, starts) = (counts.as_ptr(), starts.as_ptr());
            sys::mpi_shim_deal_integers(all.as_ptr(), counts, starts, mine.as_mut_ptr(), mine.len() as c_int);
        }
        Ok(())
    }

    /// Collects on rank 0 what each rank has between its `bounds`; `all` is empty on the others.
    ///
    /// # Errors
    /// When lengths do not fit, before anything is collected.
    pub(in crate::algebra::linear) fn collect(
        &self,
        mine: &[f64],
        bounds: &[usize],
        all: &mut [f64],
    ) -> Result<(), LinearError> {
        let Shares { counts, starts } = Shares::new(self, bounds, all.len(), mine.len())?;
        // SAFETY: as above.
        unsafe {
            let (counts, starts) = (counts.as_ptr(), starts.as_ptr());
            sys::mpi_shim_collect(mine.as_ptr(), mine.len() as c_int, all.as_mut_ptr(), counts, starts);
        }
        Ok(())
    }

    /// `N` numbers of each rank, on rank 0.
    pub(in crate::algebra::linear) fn of_each<const N: usize>(&self, mine: [f64; N]) -> Vec<[f64; N]> {
        let bounds: Vec<usize> = (0..=self.size).map(|rank| rank * N).collect();
        let mut all = vec![0.0; if self.rank == 0 { self.size * N } else { 0 }];
        // The lengths fit.
        let _ = self.collect(&mine, &bounds, &mut all);
        all.chunks_exact(N).map(|numbers| std::array::from_fn(|k| numbers[k])).collect()
    }

    /// Whether every rank has a `yes`; all hear of it.
    #[cfg(feature = "petsc")]
    pub(in crate::algebra::linear) fn all(&self, yes: bool) -> bool {
        let answers = self.of_each([f64::from(yes)]);
        let mut all = [i64::from(answers.into_iter().all(|[yes]| yes == 1.0))];
        self.tell(&mut all);
        all == [1]
    }

    /// Between which bounds the share of each rank is, where all follow each other and this one has so `many`; all hear of it.
    #[cfg(feature = "petsc")]
    pub(in crate::algebra::linear) fn bounds(&self, many: usize) -> Vec<usize> {
        let mut bounds = vec![0; self.size + 1];
        for (rank, [many]) in self.of_each([many as f64]).into_iter().enumerate() {
            bounds[rank + 1] = bounds[rank] + many as i64;
        }
        self.tell(&mut bounds);
        bounds.into_iter().map(|bound| bound as usize).collect()
    }

    /// What each rank has taken, on rank 0.
    pub(super) fn used(&self) -> Vec<RankUse> {
        let RankUse { cpu_seconds, peak_rss_bytes } = process::used();
        let of = |[cpu_seconds, bytes]: [f64; 2]| RankUse { cpu_seconds, peak_rss_bytes: bytes as u64 };
        self.of_each([cpu_seconds, peak_rss_bytes as f64]).into_iter().map(of).collect()
    }

    /// Whether the BLAS of every rank has the memory that it takes for itself, on rank 0.
    pub(super) fn prepare(&self) -> bool {
        let has_room = f64::from(room::prepare().is_ok());
        self.of_each([has_room]).into_iter().all(|[has_room]| has_room == 1.0)
    }
}
