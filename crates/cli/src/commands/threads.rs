//! The number of threads of the program.

use rayon::ThreadPoolBuilder;
use std::thread;
use stickslip::body::Model;

/// The largest number of threads allowed.
pub(super) const MOST: u32 = 1024;

/// Returns the number of threads from the option, from `OMP_NUM_THREADS`, or one for each processor available to this
/// process.
pub(super) fn count(wanted: Option<u32>) -> usize {
    let asked = || of_openmp(&std::env::var("OMP_NUM_THREADS").ok()?);
    match wanted.or_else(asked) {
        Some(count) => count as usize,
        None => processors(),
    }
}

/// Returns the number of processors available to this process.
pub(super) fn processors() -> usize {
    thread::available_parallelism().map_or(1, Into::into)
}

/// Returns the first number of `OMP_NUM_THREADS`; the others are for nested regions. `None` if it is no number of
/// threads.
fn of_openmp(text: &str) -> Option<u32> {
    let count = text.split(',').next()?.trim().parse().ok()?;
    (count > 0).then_some(MOST.min(count))
}

/// Starts `count` threads for this process, including the current one.
pub(super) fn start(count: usize) {
    let_the_blas_have(1);
    // Fails only if the threads have been started before, in which case they remain.
    let _ = ThreadPoolBuilder::new().num_threads(count).use_current_thread().build_global();
}

/// The number of displacements of a solid body above which dense products in the factorisation are large enough for
/// several threads.
const LARGE: usize = 30_000;

/// Sets the number of BLAS threads for a run of `model`: `count` for large bodies in space, 1 for all others. Their
/// dense products are small, and a second thread of OpenBLAS would mostly wait in a loop.
pub(super) fn share_with_the_blas(model: &Model, count: usize) {
    let large = model.mesh.dimension == 3 && model.problem.displacements() >= LARGE;
    let_the_blas_have(if large { of_this_rank(count) } else { 1 });
}

/// Returns how many of the `count` threads of this machine each of its MPI processes gets while all of them factor.
/// Work done on rank 0 alone uses all threads.
pub(super) fn of_this_rank(count: usize) -> usize {
    (count / ranks_here()).max(1)
}

/// Returns the number of MPI processes on this machine, from the variables of the launchers (Open MPI's mpirun,
/// MPICH's, Slurm's); otherwise the number of all processes.
fn ranks_here() -> usize {
    let count_of = |name: &&str| std::env::var(name).ok()?.parse().ok().filter(|count| *count > 0);
    let all = stickslip::algebra::linear::rank_count();
    if all == 1 {
        return 1;
    }
    ["OMPI_COMM_WORLD_LOCAL_SIZE", "MPI_LOCALNRANKS", "SLURM_NTASKS_PER_NODE"].iter().find_map(count_of).unwrap_or(all)
}

#[cfg(feature = "blas")]
pub(super) fn let_the_blas_have(count: usize) {
    // A library without this setting has one thread.
    let _ = stickslip::algebra::linear::process::set_blas_threads(count);
}

#[cfg(not(feature = "blas"))]
pub(super) fn let_the_blas_have(_: usize) {}

#[cfg(test)]
mod tests {
    use super::{MOST, of_openmp};

    #[test]
    fn openmp_names_threads_or_nothing() {
        for (text, count) in [
            ("4", Some(4)),
            (" 2 ", Some(2)),
            ("3,2,1", Some(3)),
            ("100000", Some(MOST)),
            ("0", None),
            ("-1", None),
            ("", None),
            ("many", None),
            (",2", None),
            ("2.5", None),
        ] {
            assert_eq!(of_openmp(text), count, "{text:?}");
        }
    }
}
