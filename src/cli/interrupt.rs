//! Ctrl-C: the first one asks the run to stop after the iteration at hand, the second ends the program.

use std::process::exit;
use std::sync::atomic::{AtomicBool, Ordering};

static REQUESTED: AtomicBool = AtomicBool::new(false);

/// From now on Ctrl-C and SIGTERM are requests.
pub(super) fn listen() {
    // Without a handler the first Ctrl-C ends the program, as it does everywhere; that is no failure.
    let _ = ctrlc::set_handler(|| {
        if REQUESTED.swap(true, Ordering::Relaxed) {
            exit(130);
        }
    });
}

/// Whether the run is to stop.
pub(super) fn requested() -> bool {
    REQUESTED.load(Ordering::Relaxed)
}
