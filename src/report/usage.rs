//! What a run takes of the machine.

use rustix::time::{ClockId, clock_gettime};

/// CPU time of this process so far, all threads, s.
pub fn cpu_seconds() -> f64 {
    let time = clock_gettime(ClockId::ProcessCPUTime);
    time.tv_sec as f64 + time.tv_nsec as f64 * 1e-9
}

/// The largest resident memory of this process so far, bytes; `None` where the system does not tell.
pub fn peak_rss_bytes() -> Option<u64> {
    let status = std::fs::read_to_string("/proc/self/status").ok()?;
    let line = status.lines().find_map(|line| line.strip_prefix("VmHWM:"))?;
    let kilobytes: u64 = line.trim().strip_suffix("kB")?.trim().parse().ok()?;
    Some(1024 * kilobytes)
}

#[cfg(test)]
mod tests {
    #[test]
    fn usage_is_plausible() {
        assert!(super::cpu_seconds() > 0.0);
        assert!(!cfg!(target_os = "linux") || super::peak_rss_bytes().is_some_and(|bytes| bytes > 1 << 18));
    }
}
