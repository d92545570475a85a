//! Independent computations, several at a time, with a bar.

use std::thread;

use indicatif::{ProgressBar, ProgressStyle};
use stickslip::algebra::parallel_map;

/// The number of jobs: as many as there are processors, unless told.
pub(super) fn count(wanted: Option<u16>) -> usize {
    wanted.map_or_else(|| thread::available_parallelism().map_or(1, Into::into), usize::from)
}

/// `work` on every task, `jobs` at a time in the order of `tasks`; the results stand in that order. An
/// error ends it.
pub(super) fn run<T: Sync, R: Send, E: Send>(
    tasks: &[T],
    jobs: usize,
    describe: impl Fn(&T) -> String + Sync,
    work: impl Fn(&T) -> Result<R, E> + Sync,
) -> Result<Vec<R>, E> {
    let bar = bar(tasks.len());
    let results = parallel_map(tasks, jobs, |task| {
        bar.set_message(describe(task));
        let result = work(task);
        bar.inc(1);
        result
    });
    bar.finish_and_clear();
    results
}

/// A bar of `length` steps on a terminal; nothing elsewhere.
pub(super) fn bar(length: usize) -> ProgressBar {
    let style = ProgressStyle::with_template("{pos}/{len}, {elapsed}, {eta} left  {msg}");
    ProgressBar::new(length as u64).with_style(style.unwrap_or_else(|_| ProgressStyle::default_bar()))
}
