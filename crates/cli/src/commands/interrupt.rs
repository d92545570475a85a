//! Handles Ctrl-C, SIGTERM, and SIGUSR1, which launchers of MPI pass on without ending the job. During the set-up,
//! which does not check for requests, a signal ends the program. Later, the first signal asks the run to stop after the
//! current iteration, and the second one ends the program.

use std::ops::ControlFlow;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Arc, LazyLock};

use signal_hook::consts::{SIGINT, SIGTERM, SIGUSR1};
use signal_hook::flag;
use stickslip::solver::IterationRecord;
use stickslip::solver::history::Observer;

static REQUESTED: LazyLock<Arc<AtomicBool>> = LazyLock::new(Arc::default);

/// `true` until the program has first checked for a request.
static UNSEEN: LazyLock<Arc<AtomicBool>> = LazyLock::new(|| Arc::new(AtomicBool::new(true)));

const SIGNALS: [i32; 3] = [SIGINT, SIGTERM, SIGUSR1];

/// The exit status that shells report for a program ended by Ctrl-C.
const INTERRUPTED: i32 = 130;

/// Turns these signals into requests.
pub(super) fn listen() {
    for signal in SIGNALS {
        // The order matters: a signal first tests whether requests are checked and whether another signal came before,
        // then sets its flag. If registration is refused, the signal ends the program as usual, which is no failure.
        let _ = flag::register_conditional_shutdown(signal, INTERRUPTED, Arc::clone(&UNSEEN))
            .and_then(|_| flag::register_conditional_shutdown(signal, INTERRUPTED, Arc::clone(&REQUESTED)))
            .and_then(|_| flag::register(signal, Arc::clone(&REQUESTED)));
    }
}

/// An observer that stops a run when the user asks for it.
pub(super) struct UntilInterrupted;

impl Observer for UntilInterrupted {
    fn iteration(&mut self, _: usize, _: &IterationRecord) -> ControlFlow<()> {
        if requested() { ControlFlow::Break(()) } else { ControlFlow::Continue(()) }
    }
}

/// Ignores these signals from now on.
#[cfg(feature = "petsc")]
pub(super) fn disregard() {
    for signal in SIGNALS {
        let _ = flag::register(signal, Arc::default());
    }
}

/// Returns `true` if the run is to stop.
pub(super) fn requested() -> bool {
    UNSEEN.store(false, Ordering::Relaxed);
    REQUESTED.load(Ordering::Relaxed)
}
