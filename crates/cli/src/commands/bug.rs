//! Reports a panic as a bug of this program. Files written before it remain.

use std::backtrace::{Backtrace, BacktraceStatus};
use std::panic::{self, AssertUnwindSafe};
use std::sync::Mutex;

/// The place and the message of the last panic.
static LAST: Mutex<Option<String>> = Mutex::new(None);

/// Runs `command` and turns a panic into an error that asks for a bug report.
pub(super) fn caught<T>(command: impl FnOnce() -> T) -> Result<T, String> {
    let hook = panic::take_hook();
    panic::set_hook(Box::new(|info| {
        let mut words = info.to_string();
        // Captured only if RUST_BACKTRACE is set.
        let backtrace = Backtrace::capture();
        if backtrace.status() == BacktraceStatus::Captured {
            words = format!("{words}\n{backtrace}");
        }
        if let Ok(mut last) = LAST.lock() {
            *last = Some(words);
        }
    }));
    // Nothing that a panic may leave inconsistent is used again.
    let result = panic::catch_unwind(AssertUnwindSafe(command));
    panic::set_hook(hook);
    result.map_err(|_| {
        let words = LAST.lock().ok().and_then(|mut last| last.take()).unwrap_or_default();
        format!(
            "this is a bug in stickslip {}, please report it with the scene: {words}\n\
             what was written before is complete",
            env!("CARGO_PKG_VERSION")
        )
    })
}

#[cfg(test)]
mod tests {
    use super::caught;

    #[test]
    fn a_panic_becomes_a_bug_with_its_place() {
        assert_eq!(caught(|| 3), Ok(3));
        let bug = caught(|| -> usize { panic!("seven is odd") }).unwrap_or_else(|bug| {
            for words in ["a bug in stickslip", "please report", "bug.rs:", "seven is odd", "written before"] {
                assert!(bug.contains(words), "{bug}");
            }
            7
        });
        assert_eq!(bug, 7);
    }
}
