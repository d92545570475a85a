//! How many threads the program shares its work among.

use std::thread;

use rayon::ThreadPoolBuilder;
use stickslip::body::model::Model;

/// The most that anybody is given.
pub(super) const MOST: u32 = 1024;

/// Those that were asked for, by an option or by `OMP_NUM_THREADS`, or one for each processor that this process may use.
pub(super) fn count(wanted: Option<u32>) -> usize {
    let asked = || of_openmp(&std::env::var("OMP_NUM_THREADS").ok()?);
    match wanted.or_else(asked) {
        Some(count) => count as usize,
        None => processors(),
    }
}

/// The processors that this process may use.
pub(super) fn processors() -> usize {
    thread::available_parallelism().map_or(1, Into::into)
}

/// The first of OpenMP's numbers, which are for nested regions; none where that is no number of threads.
fn of_openmp(text: &str) -> Option<u32> {
    let count = text.split(',').next()?.trim().parse().ok()?;
    (count > 0).then_some(MOST.min(count))
}

/// Gives the work of this process `count` threads, the present one among them.
pub(super) fn start(count: usize) {
    // First, while there are no others: it can then end those that it does not need.
    let_the_blas_have(1);
    // It can only have been done before, and is then as it was.
    let _ = ThreadPoolBuilder::new().num_threads(count).use_current_thread().build_global();
}

/// Displacements of a solid body from which on the fronts of its factors are so large that products of theirs are worth sharing.
const LARGE: usize = 30_000;

/// Lets the BLAS have its share of `count` threads for a run of `model`: all of them for large bodies in space, one for all others,
/// whose fronts are small. There a second thread of OpenBLAS waits in a loop most of the time.
pub(super) fn share_with_the_blas(model: &Model, count: usize) {
    let large = model.mesh.dimension == 3 && model.problem.displacements() >= LARGE;
    let_the_blas_have(if large { of_this_rank(count) } else { 1 });
}

/// Of `count` threads of this machine those that are left to each of its processes of MPI while all of them factor. What rank 0 does alone
/// has all of them.
pub(super) fn of_this_rank(count: usize) -> usize {
    (count / ranks_here()).max(1)
}

/// How many processes of MPI are on this machine: what launchers tell of it, Open MPI's mpirun, MPICH's and Slurm's, or all there are.
fn ranks_here() -> usize {
    let told = |name: &&str| std::env::var(name).ok()?.parse().ok().filter(|count| *count > 0);
    let all = stickslip::algebra::linear::built_in::ranks();
    if all == 1 {
        return 1;
    }
    ["OMPI_COMM_WORLD_LOCAL_SIZE", "MPI_LOCALNRANKS", "SLURM_NTASKS_PER_NODE"].iter().find_map(told).unwrap_or(all)
}

#[cfg(feature = "blas")]
pub(super) fn let_the_blas_have(count: usize) {
    // A library that has no word for it has one thread.
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
