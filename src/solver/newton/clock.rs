//! A stopwatch that adds up the times of closures.

use std::time::Instant;

#[derive(Default)]
pub(super) struct Clock {
    pub seconds: f64,
}

impl Clock {
    pub(super) fn time<T>(&mut self, work: impl FnOnce() -> T) -> T {
        let start = Instant::now();
        let result = work();
        self.seconds += start.elapsed().as_secs_f64();
        result
    }
}
