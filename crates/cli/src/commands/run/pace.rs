//! The interval between checkpoints.

use std::io;
use std::time::{Duration, Instant};

/// Checkpoints may take one part in this many of the run time.
const SHARE: u32 = 50;

/// The expected duration of the first checkpoint.
const FIRST: Duration = Duration::from_millis(20);

/// A fixed interval, or one for which checkpoints take 1/[`SHARE`] of the run time.
pub(super) struct Pace {
    every: Option<Duration>,
    last: Instant,
    cost: Duration,
}

impl Pace {
    pub(super) fn new(every: Option<Duration>) -> Self {
        Pace { every, last: Instant::now(), cost: FIRST }
    }

    pub(super) fn is_due(&self) -> bool {
        self.last.elapsed() >= self.every.unwrap_or(SHARE * self.cost)
    }

    /// Writes a checkpoint and measures its duration.
    pub(super) fn keep(&mut self, keep: impl FnOnce() -> io::Result<()>) -> io::Result<()> {
        let start = Instant::now();
        let kept = keep();
        (self.last, self.cost) = (Instant::now(), start.elapsed());
        kept
    }
}
