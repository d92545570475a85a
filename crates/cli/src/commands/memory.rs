//! Handles refused memory.

pub(super) use stickslip::algebra::linear::process::exits;
use stickslip::algebra::linear::process::{Last, memory_was_refused, say_last};

/// The message for a refused allocation that cannot be returned as an error.
pub(super) const MESSAGE: &str = "out of memory: an allocation that the program needs was refused";
pub(super) const HELP: &str = "use a coarser mesh, raise the memory limit, or use a machine with more memory";

const NOTE: &str = "out of memory: an allocation that the program needs was refused; use a coarser mesh, raise the memory limit, \
                    or use a machine with more memory\nwhat was written before is complete\n";

const ABORTED: &str = "a library ended the program, possibly for lack of memory; otherwise please report it with \
                       the scene\nwhat was written before is complete\n";

/// The message as one JSON object, in the format of `output`.
const JSON: &str = "{\n  \"schema_version\": 1,\n  \"status\": \"machine-failure\",\n  \"message\": \"out of memory: an allocation that \
                    the program needs was refused\",\n  \"help\": \"use a coarser mesh, raise the memory limit, or use a machine with \
                    more memory\"\n}\n";

/// The exit status of a machine failure.
const STATUS: i32 = 3;

/// Makes a refused allocation end the program with a message and an exit status; with `json` the message is also
/// printed on standard output.
pub(super) fn end_in_order(json: bool) {
    let output = if json { JSON } else { "" };
    say_last(Last { out_of_memory: NOTE, output, aborted: ABORTED, status: STATUS });
    #[cfg(feature = "blas")]
    go_on_with_one_thread();
}

/// Returns `true` if a failure may have been caused by refused memory.
pub(super) fn is_short() -> bool {
    memory_was_refused()
}

/// If a limit on mapped memory leaves less than this, in bytes, the threads of the BLAS do not fit: each maps 128 MiB
/// when it starts.
#[cfg(feature = "blas")]
const SCARCE: u64 = 1 << 30;

/// Restarts the program without BLAS threads if such a thread retries an allocation for ever or uses up scarce memory.
#[cfg(feature = "blas")]
fn go_on_with_one_thread() {
    use std::os::unix::process::CommandExt;
    use std::process::Command;

    use stickslip::algebra::linear::blas::Blas;
    use stickslip::algebra::linear::process::blas_is_stuck;
    use stickslip::base::Budget;

    use super::output;

    const THREADS: &str = "OPENBLAS_NUM_THREADS";
    // glibc maps 64 MiB per thread for its allocations unless all threads share one arena.
    const ARENAS: &str = "MALLOC_ARENA_MAX";
    let one = std::env::var_os(THREADS).is_some_and(|threads| threads == "1");
    let several = || Blas::loaded().is_some_and(|blas| blas.library == "OpenBLAS" && blas.threads > Some(1));
    let left = || Budget::of_process().filter(|budget| budget.source.counts_what_is_mapped());
    let scarce = || left().is_some_and(|budget| budget.bytes < SCARCE) && several();
    if one || !(blas_is_stuck() || scarce()) {
        return;
    }
    let mut arguments = std::env::args_os();
    let name = arguments.next().unwrap_or_default();
    let error = Command::new("/proc/self/exe").arg0(name).args(arguments).env(THREADS, "1").env(ARENAS, "1").exec();
    if blas_is_stuck() {
        output::note(&format!(
            "out of memory: the BLAS has no room for its threads, and the program cannot restart itself: \
             {error}\nset {THREADS}=1, or raise the memory limit"
        ));
        // Exit at once: the normal exit waits for those threads.
        signal_hook::low_level::exit(STATUS);
    }
}

#[cfg(test)]
mod tests {
    use super::{HELP, JSON, MESSAGE, NOTE};

    #[test]
    fn what_is_said_last_is_what_is_said_elsewhere() {
        let json: serde_json::Value = serde_json::from_str(JSON).unwrap();
        let expected = serde_json::json!({
            "schema_version": stickslip::run::report::SCHEMA_VERSION,
            "status": "machine-failure",
            "message": MESSAGE,
            "help": HELP,
        });
        assert_eq!(json, expected);
        assert!(NOTE.starts_with(MESSAGE) && NOTE.contains(HELP));
    }
}
