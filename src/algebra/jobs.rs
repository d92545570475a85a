//! Independent computations in parallel, each entirely in a thread of its own.

use std::panic::resume_unwind;
use std::sync::atomic::{AtomicUsize, Ordering};
use std::thread;

use rayon::ThreadPoolBuilder;

use crate::algebra::linear::process::keep_openmp_in_this_thread;

/// Runs `work` on every task, `jobs` at a time in the order of `tasks`, and returns the results in that order. Work
/// that is otherwise shared among threads stays in the thread that calls `work`. The CPU time of that thread is
/// therefore that of the work, if the BLAS also uses one thread.
///
/// # Errors
/// The first error of `work` in the order of `tasks`. No task begins after an error.
pub fn parallel_map<T: Sync, R: Send, E: Send>(
    tasks: &[T],
    jobs: usize,
    work: impl Fn(&T) -> Result<R, E> + Sync,
) -> Result<Vec<R>, E> {
    let next = AtomicUsize::new(0);
    let job = || {
        keep_in_this_thread();
        let mut done = Vec::new();
        loop {
            let index = next.fetch_add(1, Ordering::Relaxed);
            let Some(task) = tasks.get(index) else { break done };
            let result = work(task);
            if result.is_err() {
                next.store(tasks.len(), Ordering::Relaxed);
            }
            done.push((index, result));
        }
    };
    let mut done: Vec<_> = thread::scope(|scope| {
        let jobs: Vec<_> = (0..jobs.clamp(1, tasks.len().max(1))).map(|_| scope.spawn(job)).collect();
        // A panic is passed on unchanged.
        jobs.into_iter().flat_map(|job| job.join().unwrap_or_else(|panic| resume_unwind(panic))).collect()
    });
    done.sort_by_key(|(index, _)| *index);
    done.into_iter().map(|(_, result)| result).collect()
}

/// Keeps work that is otherwise shared among threads in the calling thread, for the lifetime of that thread.
pub fn keep_in_this_thread() {
    // A pool with this thread alone. An error means that the thread is already in a pool.
    let _pool = ThreadPoolBuilder::new().num_threads(1).use_current_thread().build();
    keep_openmp_in_this_thread();
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used)]

    use std::convert::Infallible;
    use std::time::Duration;

    use super::*;

    #[test]
    fn results_stand_in_the_order_of_the_tasks() {
        let tasks: Vec<u64> = (0..20).collect();
        let squares: Vec<u64> = tasks.iter().map(|n| n * n).collect();
        for jobs in [0, 1, 3, 50] {
            let work = |n: &u64| {
                // The first tasks take longest.
                thread::sleep(Duration::from_millis((20 - n) / 4));
                assert_eq!(rayon::current_num_threads(), 1);
                Ok::<u64, Infallible>(n * n)
            };
            assert_eq!(parallel_map(&tasks, jobs, work).unwrap(), squares, "{jobs}");
        }
        assert_eq!(parallel_map(&[], 4, |n: &u64| Ok::<u64, Infallible>(*n)).unwrap(), [0; 0]);
    }

    /// Shared work of a job stays in its thread.
    #[test]
    fn a_job_is_one_thread() {
        let work = |_: &u32| {
            let here = thread::current().id();
            let (left, right) = rayon::join(|| thread::current().id(), || thread::current().id());
            Ok::<bool, Infallible>(left == here && right == here)
        };
        assert_eq!(parallel_map(&[1, 2, 3, 4], 2, work).unwrap(), [true; 4]);
    }

    #[test]
    fn a_panic_is_what_it_was() {
        let work = |n: &u32| if *n == 7 { panic!("seven is odd") } else { Ok::<u32, Infallible>(*n) };
        let panic = std::panic::catch_unwind(|| parallel_map(&[6, 7, 8], 2, work)).unwrap_err();
        assert_eq!(panic.downcast_ref(), Some(&"seven is odd"));
    }

    #[test]
    fn an_error_ends_it() {
        let count = AtomicUsize::new(0);
        let work = |n: &usize| {
            count.fetch_add(1, Ordering::Relaxed);
            if *n >= 3 { Err(*n) } else { Ok(*n) }
        };
        let tasks: Vec<usize> = (0..100).collect();
        assert_eq!(parallel_map(&tasks, 1, work).unwrap_err(), 3);
        assert_eq!(count.load(Ordering::Relaxed), 4);
    }
}
