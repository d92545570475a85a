//! Independent computations, several at a time, with a bar.

use std::sync::atomic::{AtomicUsize, Ordering};
use std::sync::{Mutex, MutexGuard, PoisonError};
use std::thread;

use indicatif::{ProgressBar, ProgressStyle};

/// The number of jobs: as many as there are processors, unless told.
pub(super) fn count(wanted: Option<u16>) -> usize {
    wanted.map_or_else(|| thread::available_parallelism().map_or(1, Into::into), usize::from)
}

/// `work` on every task, `jobs` at a time in the order of `tasks`; the results stand in that order. The
/// first error ends it.
pub(super) fn run<T: Sync, R: Send, E: Send>(
    tasks: &[T],
    jobs: usize,
    describe: impl Fn(&T) -> String + Sync,
    work: impl Fn(&T) -> Result<R, E> + Sync,
) -> Result<Vec<R>, E> {
    let bar = bar(tasks.len());
    let next = AtomicUsize::new(0);
    let done: Mutex<Vec<Option<R>>> = Mutex::new(tasks.iter().map(|_| None).collect());
    let failure: Mutex<Option<E>> = Mutex::new(None);
    thread::scope(|scope| {
        for _ in 0..jobs.min(tasks.len()) {
            scope.spawn(|| {
                loop {
                    let place = next.fetch_add(1, Ordering::Relaxed);
                    let Some(task) = tasks.get(place) else { break };
                    bar.set_message(describe(task));
                    match work(task) {
                        Ok(result) => lock(&done)[place] = Some(result),
                        Err(error) => {
                            lock(&failure).get_or_insert(error);
                            next.store(tasks.len(), Ordering::Relaxed);
                        }
                    }
                    bar.inc(1);
                }
            });
        }
    });
    bar.finish_and_clear();
    match lock(&failure).take() {
        Some(error) => Err(error),
        None => Ok(lock(&done).iter_mut().filter_map(Option::take).collect()),
    }
}

fn lock<T>(mutex: &Mutex<T>) -> MutexGuard<'_, T> {
    mutex.lock().unwrap_or_else(PoisonError::into_inner)
}

/// A bar of `length` steps on a terminal; nothing elsewhere.
pub(super) fn bar(length: usize) -> ProgressBar {
    let style = ProgressStyle::with_template("{pos}/{len}, {elapsed}, {eta} left  {msg}");
    ProgressBar::new(length as u64).with_style(style.unwrap_or_else(|_| ProgressStyle::default_bar()))
}
