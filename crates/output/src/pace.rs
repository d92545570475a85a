//! The interval between checkpoints.

use std::io;
use std::time::{Duration, Instant};

/// Checkpoints may take one part in this many of the run time.
const SHARE: u32 = 50;

/// The expected duration of the first checkpoint.
const FIRST: Duration = Duration::from_millis(20);

/// The interval between checkpoints: a fixed one, or one for which checkpoints take 2 % of the run time.
pub struct Pace {
    every: Option<Duration>,
    last: Instant,
    cost: Duration,
}

impl Pace {
    /// Returns a pace of a checkpoint `every` so often; with `None` their cost decides.
    pub fn new(every: Option<Duration>) -> Self {
        Pace { every, last: Instant::now(), cost: FIRST }
    }

    /// Returns `true` if it is time for the next checkpoint.
    pub fn is_due(&self) -> bool {
        self.last.elapsed() >= self.every.unwrap_or(SHARE * self.cost)
    }

    /// Writes a checkpoint and measures its duration.
    ///
    /// # Errors
    /// The error of `keep`.
    pub fn keep(&mut self, keep: impl FnOnce() -> io::Result<()>) -> io::Result<()> {
        let start = Instant::now();
        let kept = keep();
        (self.last, self.cost) = (Instant::now(), start.elapsed());
        kept
    }
}
