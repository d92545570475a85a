//! The memory that this process may still use, and its limit: the machine, a control group, or a limit of the
//! process.
//!
//! The data are read from `/proc/meminfo`, `/proc/self/limits` and `/proc/self/status`. The limits of the control
//! group named in `/proc/self/cgroup`, and of the groups above it, are below `/sys/fs/cgroup`.

use std::path::Path;
use std::{fmt, fs};

/// The limit that leaves the least memory.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Source {
    /// The memory that the machine has free, or can free.
    Machine,
    /// A control group, such as that of a container or of a batch job.
    ControlGroup,
    /// The limit of the address space, `ulimit -v`.
    AddressSpace,
    /// The limit of data, `ulimit -d`.
    Data,
}

impl Source {
    /// Returns advice for raising the limit.
    pub fn remedy(self) -> &'static str {
        match self {
            Source::Machine => "use a coarser mesh or a machine with more memory",
            Source::ControlGroup => "use a coarser mesh, or give the container or the job more memory",
            Source::AddressSpace => "use a coarser mesh, or raise the limit (ulimit -v)",
            Source::Data => "use a coarser mesh, or raise the limit (ulimit -d)",
        }
    }
}

impl fmt::Display for Source {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Source::Machine => "the machine",
            Source::ControlGroup => "the control group",
            Source::AddressSpace => "the address-space limit",
            Source::Data => "the data limit",
        })
    }
}

/// The memory that may still be used.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Budget {
    /// The amount, bytes.
    pub bytes: u64,
    /// The limit that determines it.
    pub source: Source,
}

impl Budget {
    /// Returns the budget of this process, or `None` if the system does not report it.
    pub fn of_process() -> Option<Self> {
        Self::below(Path::new("/"))
    }

    /// Returns the budget from the files below `root`.
    fn below(root: &Path) -> Option<Self> {
        let proc = root.join("proc");
        let own = proc.join("self");
        let limits = fs::read_to_string(own.join("limits")).unwrap_or_default();
        let left = |limit: &str, used: &str| {
            let limit = limits.lines().find_map(|line| line.strip_prefix(limit))?.split_whitespace().next()?;
            // A missing limit reads `unlimited`.
            Some(limit.parse::<u64>().ok()?.saturating_sub(kilobytes(&own.join("status"), used)?))
        };
        let all = [
            (kilobytes(&proc.join("meminfo"), "MemAvailable:"), Source::Machine),
            (left_by_groups(root), Source::ControlGroup),
            (left("Max address space", "VmSize:"), Source::AddressSpace),
            (left("Max data size", "VmData:"), Source::Data),
        ];
        let known = all.into_iter().filter_map(|(bytes, source)| Some(Budget { bytes: bytes?, source }));
        known.min_by_key(|budget| budget.bytes)
    }
}

/// Returns the value of a line such as `VmHWM:   1234 kB` of a file, in bytes.
pub fn kilobytes(file: &Path, key: &str) -> Option<u64> {
    let text = fs::read_to_string(file).ok()?;
    let line = text.lines().find_map(|line| line.strip_prefix(key))?;
    let kilobytes: u64 = line.trim().strip_suffix("kB")?.trim().parse().ok()?;
    kilobytes.checked_mul(1024)
}

/// Formats an amount of memory: `864 MB`, `1.5 GB`.
pub fn in_words(bytes: u64) -> String {
    let bytes = bytes as f64;
    if bytes < 1e9 { format!("{:.0} MB", bytes * 1e-6) } else { format!("{:.1} GB", bytes * 1e-9) }
}

/// A version of control groups: the files of a limit and of the memory in use, and the key in `memory.stat` of the
/// part of it that can be reclaimed.
struct Kind {
    mounts: [&'static str; 2],
    limits: &'static [&'static str],
    used: &'static str,
    cached: &'static str,
}

const FIRST: Kind = Kind {
    mounts: ["sys/fs/cgroup/memory", "sys/fs/cgroup"],
    limits: &["memory.limit_in_bytes"],
    used: "memory.usage_in_bytes",
    cached: "total_inactive_file",
};

const SECOND: Kind = Kind {
    mounts: ["sys/fs/cgroup", "sys/fs/cgroup/unified"],
    limits: &["memory.max", "memory.high"],
    used: "memory.current",
    cached: "inactive_file",
};

/// Returns the smallest amount that this process's control groups leave.
fn left_by_groups(root: &Path) -> Option<u64> {
    let groups = fs::read_to_string(root.join("proc/self/cgroup")).ok()?;
    let lines = groups.lines().filter_map(|line| {
        let mut parts = line.splitn(3, ':');
        let (number, controllers, path) = (parts.next()?, parts.next()?, parts.next()?);
        match (number, controllers) {
            ("0", "") => Some((SECOND, path)),
            (_, controllers) if controllers.split(',').any(|name| name == "memory") => Some((FIRST, path)),
            _ => None,
        }
    });
    lines.flat_map(|(kind, path)| left_along(root, &kind, path)).min()
}

/// Returns the amounts left by the group at `path` and by the groups above it. In a container the path is that of the
/// machine, and only its top is visible.
fn left_along(root: &Path, kind: &Kind, path: &str) -> Vec<u64> {
    let path = Path::new(path.trim_start_matches('/'));
    let folders = kind.mounts.iter().flat_map(|mount| path.ancestors().map(move |path| root.join(mount).join(path)));
    folders.filter_map(|folder| left_by(&folder, kind)).collect()
}

fn left_by(folder: &Path, kind: &Kind) -> Option<u64> {
    let number = |file: &str| fs::read_to_string(folder.join(file)).ok()?.trim().parse::<u64>().ok();
    // A missing limit reads `max` or, in the first version, a number of pages near 2^63, more than any machine has.
    let limit = kind.limits.iter().filter_map(|file| number(file)).min().filter(|limit| *limit < 1 << 62)?;
    let stat = fs::read_to_string(folder.join("memory.stat")).unwrap_or_default();
    let mut words = stat.lines().filter_map(|line| line.split_once(' '));
    let cached = words.find_map(|(key, value)| (key == kind.cached).then(|| value.trim().parse::<u64>().ok())?);
    Some(limit.saturating_sub(number(kind.used)?.saturating_sub(cached.unwrap_or(0))))
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A temporary directory of made-up system files.
    struct Files(std::path::PathBuf);

    impl Files {
        fn new(name: &str, files: &[(&str, &str)]) -> Self {
            let root = std::env::temp_dir().join(format!("stickslip-memory-{name}-{}", std::process::id()));
            for (path, text) in files {
                let path = root.join(path);
                fs::create_dir_all(path.parent().unwrap()).unwrap();
                fs::write(path, text).unwrap();
            }
            Files(root)
        }

        fn budget(&self) -> Option<(u64, Source)> {
            Budget::below(&self.0).map(|budget| (budget.bytes, budget.source))
        }
    }

    impl Drop for Files {
        fn drop(&mut self) {
            let _ = fs::remove_dir_all(&self.0);
        }
    }

    const MACHINE: (&str, &str) = ("proc/meminfo", "MemTotal:  9000 kB\nMemAvailable:    4000 kB\n");
    const STATUS: (&str, &str) = ("proc/self/status", "VmPeak: 9 kB\nVmSize:\t    1000 kB\nVmData:     200 kB\n");

    #[test]
    fn this_process_has_a_budget() {
        let budget = Budget::of_process();
        assert!(!cfg!(target_os = "linux") || budget.is_some_and(|budget| budget.bytes > 1 << 18), "{budget:?}");
    }

    #[test]
    fn the_least_of_machine_and_limits() {
        let none = "Max data size             unlimited            unlimited            bytes\n\
                    Max address space         unlimited            unlimited            bytes\n";
        let files = Files::new("none", &[MACHINE, STATUS, ("proc/self/limits", none)]);
        assert_eq!(files.budget(), Some((4000 * 1024, Source::Machine)));
        let space = "Max address space         3072000              unlimited            bytes\n";
        let files = Files::new("space", &[MACHINE, STATUS, ("proc/self/limits", space)]);
        assert_eq!(files.budget(), Some((2000 * 1024, Source::AddressSpace)));
        let data = format!("{space}Max data size     1228800   1228800    bytes\n");
        let files = Files::new("data", &[MACHINE, STATUS, ("proc/self/limits", &data)]);
        assert_eq!(files.budget(), Some((1000 * 1024, Source::Data)));
        // More memory is in use than a later limit allows.
        let past = "Max address space         1024                 unlimited            bytes\n";
        let files = Files::new("past", &[MACHINE, STATUS, ("proc/self/limits", past)]);
        assert_eq!(files.budget(), Some((0, Source::AddressSpace)));
        assert_eq!(Files::new("empty", &[]).budget(), None);
    }

    #[test]
    fn control_groups_of_the_second_version_and_those_above() {
        let group = ("proc/self/cgroup", "0::/jobs/one\n");
        let own = |limit| ("sys/fs/cgroup/jobs/one/memory.max", limit);
        let used = ("sys/fs/cgroup/jobs/one/memory.current", "1000000\n");
        let cache = ("sys/fs/cgroup/jobs/one/memory.stat", "anon 600000\ninactive_file 400000\nactive_file 7\n");
        let files = Files::new("own", &[MACHINE, group, own("3000000\n"), used, cache]);
        assert_eq!(files.budget(), Some((2_400_000, Source::ControlGroup)));
        let files = Files::new("unlimited", &[MACHINE, group, own("max\n"), used, cache]);
        assert_eq!(files.budget(), Some((4000 * 1024, Source::Machine)));
        let high = ("sys/fs/cgroup/jobs/one/memory.high", "2000000\n");
        let files = Files::new("high", &[MACHINE, group, own("3000000\n"), high, used, cache]);
        assert_eq!(files.budget(), Some((1_400_000, Source::ControlGroup)));
        let above = [("sys/fs/cgroup/jobs/memory.max", "5000000"), ("sys/fs/cgroup/jobs/memory.current", "4900000")];
        let files = Files::new("above", &[MACHINE, group, own("3000000\n"), used, cache, above[0], above[1]]);
        assert_eq!(files.budget(), Some((100_000, Source::ControlGroup)));
    }

    #[test]
    fn control_groups_of_the_first_version_in_a_container() {
        // The path is that of the machine; in the container its group is at the top.
        let group = ("proc/self/cgroup", "5:devices:/\n4:cpu,memory:/docker/0123\n0::/\n");
        let limit = |limit| ("sys/fs/cgroup/memory/memory.limit_in_bytes", limit);
        let used = ("sys/fs/cgroup/memory/memory.usage_in_bytes", "500000");
        let files = Files::new("first", &[MACHINE, group, limit("2500000"), used]);
        assert_eq!(files.budget(), Some((2_000_000, Source::ControlGroup)));
        let files = Files::new("endless", &[MACHINE, group, limit("9223372036854771712"), used]);
        assert_eq!(files.budget(), Some((4000 * 1024, Source::Machine)));
    }
}
