//! Ctrl-C, SIGTERM, and SIGUSR1, which launchers of MPI pass on and otherwise leave the job alone: during the set-up, in which nobody
//! looks for a request, it ends the program; later the first one asks the run to stop after the iteration at hand, and the second
//! ends the program.

use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Arc, LazyLock};

use signal_hook::consts::{SIGINT, SIGTERM, SIGUSR1};
use signal_hook::flag;

static REQUESTED: LazyLock<Arc<AtomicBool>> = LazyLock::new(Arc::default);

/// Nobody has looked for a request so far.
static UNSEEN: LazyLock<Arc<AtomicBool>> = LazyLock::new(|| Arc::new(AtomicBool::new(true)));

const SIGNALS: [i32; 3] = [SIGINT, SIGTERM, SIGUSR1];

/// The exit status that shells give to a program that Ctrl-C ended.
const INTERRUPTED: i32 = 130;

/// From now on these signals are requests.
pub(super) fn listen() {
    for signal in SIGNALS {
        // The order matters: a signal first sees whether anybody looks and whether another one came before, then leaves its mark.
        // Where this is refused, the signal ends the program, as it does everywhere; that is no failure.
        let _ = flag::register_conditional_shutdown(signal, INTERRUPTED, Arc::clone(&UNSEEN))
            .and_then(|_| flag::register_conditional_shutdown(signal, INTERRUPTED, Arc::clone(&REQUESTED)))
            .and_then(|_| flag::register(signal, Arc::clone(&REQUESTED)));
    }
}

/// From now on these signals do nothing.
#[cfg(feature = "mpi")]
pub(super) fn disregard() {
    for signal in SIGNALS {
        let _ = flag::register(signal, Arc::default());
    }
}

/// Whether the run is to stop.
pub(super) fn requested() -> bool {
    UNSEEN.store(false, Ordering::Relaxed);
    REQUESTED.load(Ordering::Relaxed)
}
