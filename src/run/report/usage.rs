//! What a run takes of the machine.

use std::path::Path;

use rustix::time::{ClockId, clock_gettime};
use serde::Serialize;

use crate::algebra::linear::RankUse;
use crate::algebra::linear::built_in::ranks_used;
use crate::base::memory::kilobytes;

/// CPU time of this process so far, all threads, s.
pub fn cpu_seconds() -> f64 {
    seconds(ClockId::ProcessCPUTime)
}

/// CPU time of the thread that calls, s.
pub fn thread_cpu_seconds() -> f64 {
    seconds(ClockId::ThreadCPUTime)
}

fn seconds(clock: ClockId) -> f64 {
    let time = clock_gettime(clock);
    time.tv_sec as f64 + time.tv_nsec as f64 * 1e-9
}

/// The largest resident memory of this process so far, bytes; `None` where the system does not tell.
pub fn peak_rss_bytes() -> Option<u64> {
    kilobytes(Path::new("/proc/self/status"), "VmHWM:")
}

/// What one of several processes took.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct RankRecord {
    /// Its rank, from 0.
    pub rank: usize,
    /// CPU time, s.
    pub cpu_seconds: f64,
    /// Peak resident memory, bytes.
    pub peak_rss_bytes: u64,
}

impl RankRecord {
    /// Those of all ranks, if there are several.
    pub fn all() -> Vec<Self> {
        let record = |(rank, RankUse { cpu_seconds, peak_rss_bytes })| RankRecord { rank, cpu_seconds, peak_rss_bytes };
        ranks_used().into_iter().enumerate().map(record).collect()
    }
}

#[cfg(test)]
mod tests {
    #[test]
    fn usage_is_plausible() {
        assert!(super::cpu_seconds() > 0.0 && super::thread_cpu_seconds() > 0.0);
        assert!(!cfg!(target_os = "linux") || super::peak_rss_bytes().is_some_and(|bytes| bytes > 1 << 18));
    }
}
