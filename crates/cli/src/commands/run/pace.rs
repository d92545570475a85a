//! How often a run leaves the place from which it can be taken up.

use std::io;
use std::time::{Duration, Instant};

/// The share of the time that checkpoints may take.
const SHARE: u32 = 50;

/// What the first one is expected to take.
const FIRST: Duration = Duration::from_millis(20);

/// After so long each, or as often as takes one part in fifty of the time.
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

    /// Leaves one, and takes the time.
    pub(super) fn keep(&mut self, keep: impl FnOnce() -> io::Result<()>) -> io::Result<()> {
        let start = Instant::now();
        let kept = keep();
        (self.last, self.cost) = (Instant::now(), start.elapsed());
        kept
    }
}
