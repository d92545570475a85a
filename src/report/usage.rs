//! What a run takes of the machine.

use rustix::time::{ClockId, clock_gettime};

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
    kilobytes("/proc/self/status", "VmHWM:")
}

/// Memory that the system can still give, bytes; `None` where it does not tell.
pub fn available_bytes() -> Option<u64> {
    kilobytes("/proc/meminfo", "MemAvailable:")
}

/// The value of a line such as `VmHWM:   1234 kB`, in bytes.
fn kilobytes(file: &str, key: &str) -> Option<u64> {
    let text = std::fs::read_to_string(file).ok()?;
    let line = text.lines().find_map(|line| line.strip_prefix(key))?;
    let kilobytes: u64 = line.trim().strip_suffix("kB")?.trim().parse().ok()?;
    Some(1024 * kilobytes)
}

#[cfg(test)]
mod tests {
    #[test]
    fn usage_is_plausible() {
        assert!(super::cpu_seconds() > 0.0 && super::thread_cpu_seconds() > 0.0);
        for bytes in [super::peak_rss_bytes(), super::available_bytes()] {
            assert!(!cfg!(target_os = "linux") || bytes.is_some_and(|bytes| bytes > 1 << 18));
        }
    }
}
