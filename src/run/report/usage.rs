//! The time and memory used by a run.

use std::path::Path;

use rustix::time::{ClockId, clock_gettime};
use serde::Serialize;

use crate::algebra::linear::RankUse;
use crate::algebra::linear::built_in::ranks_used;
use crate::base::memory::kilobytes;

/// Returns the CPU time of this process so far, all threads, s.
pub fn cpu_seconds() -> f64 {
    seconds(ClockId::ProcessCPUTime)
}

/// Returns the CPU time of the calling thread, s.
pub fn thread_cpu_seconds() -> f64 {
    seconds(ClockId::ThreadCPUTime)
}

fn seconds(clock: ClockId) -> f64 {
    let time = clock_gettime(clock);
    time.tv_sec as f64 + time.tv_nsec as f64 * 1e-9
}

/// Returns the largest resident memory of this process so far, bytes; `None` if the system does not report it.
pub fn peak_rss_bytes() -> Option<u64> {
    kilobytes(Path::new("/proc/self/status"), "VmHWM:")
}

/// The time and memory of one of several processes.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, schemars::JsonSchema)]
pub struct RankRecord {
    /// The rank of the process, from 0.
    pub rank: usize,
    /// CPU time, s.
    pub cpu_seconds: f64,
    /// Peak resident memory, bytes.
    pub peak_rss_bytes: u64,
}

impl RankRecord {
    /// Returns the records of all ranks, if there are several.
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
