//! Handles refused memory.

use stickslip::algebra::linear::process::{AbortReport, memory_was_refused, set_abort_report};

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
    set_abort_report(AbortReport { out_of_memory: NOTE, output, aborted: ABORTED, status: STATUS });
    #[cfg(feature = "blas")]
    if stickslip::algebra::linear::process::blas_is_stuck() {
        let help = "set OPENBLAS_NUM_THREADS=1, or raise the memory limit";
        let failure = super::Failure::machine("out of memory: the BLAS has no room for its threads", help);
        super::output::failure(&failure, json);
        // Exit at once: the normal exit waits for those threads.
        signal_hook::low_level::exit(STATUS);
    }
}

/// Returns `true` if a failure may have been caused by refused memory.
pub(super) fn is_short() -> bool {
    memory_was_refused()
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
