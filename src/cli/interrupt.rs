//! Ctrl-C: the first one asks the run to stop after the iteration at hand, the second ends the program. Where nobody looks
//! whether there was a first, because the set-up is not through or a library is at work for longer than it ever was, the first
//! ends the program, too.

use std::io::Read;
use std::os::unix::net::UnixStream;
use std::sync::atomic::{AtomicBool, AtomicU64, Ordering};
use std::sync::{Arc, LazyLock};
use std::thread;
use std::time::{Duration, Instant};

use signal_hook::consts::{SIGINT, SIGTERM};
use signal_hook::{flag, low_level};

use super::output;

static REQUESTED: LazyLock<Arc<AtomicBool>> = LazyLock::new(Arc::default);

/// When the first look was taken for a request, which the times below are counted from.
static FIRST: LazyLock<Instant> = LazyLock::new(Instant::now);
/// How often somebody looked.
static LOOKS: AtomicU64 = AtomicU64::new(0);
/// When somebody looked last, and the longest time between two looks, ms.
static LAST: AtomicU64 = AtomicU64::new(0);
static LONGEST: AtomicU64 = AtomicU64::new(0);

/// The exit status that shells give to a program that Ctrl-C ended.
const INTERRUPTED: i32 = 130;

/// A request is seen within so many times the longest iteration so far, or within the time that people wait for an answer.
const ITERATIONS: u32 = 3;
const PATIENCE: Duration = Duration::from_secs(2);

/// During the set-up nothing is there that would be lost.
const SET_UP: Duration = Duration::from_millis(100);

/// The stack of the thread that waits for a request, bytes.
const STACK: usize = 128 << 10;

/// From now on Ctrl-C and SIGTERM are requests.
pub(super) fn listen() {
    // Without the thread that sees to it that a request has an end, the signal ends the program, as it does everywhere.
    let Ok((mut told, tells)) = UnixStream::pair() else { return };
    let waiting = thread::Builder::new().name("interrupt".to_string()).stack_size(STACK);
    let waits = move || {
        if told.read(&mut [0]).is_ok_and(|bytes| bytes > 0) {
            see_to_the_end();
        }
    };
    if waiting.spawn(waits).is_err() {
        return;
    }
    for signal in [SIGINT, SIGTERM] {
        let Ok(tells) = tells.try_clone() else { return };
        // The order matters: a signal first sees whether another one came before, then leaves its mark.
        // Where this is refused, the signal ends the program; that is no failure.
        let _ = flag::register_conditional_shutdown(signal, INTERRUPTED, Arc::clone(&REQUESTED))
            .and_then(|_| flag::register(signal, Arc::clone(&REQUESTED)))
            .and_then(|_| low_level::pipe::register(signal, tells));
    }
}

/// Whether the run is to stop.
pub(super) fn requested() -> bool {
    let now = FIRST.elapsed().as_millis() as u64;
    if LOOKS.fetch_add(1, Ordering::Relaxed) > 0 {
        LONGEST.fetch_max(now.saturating_sub(LAST.load(Ordering::Relaxed)), Ordering::Relaxed);
    }
    LAST.store(now, Ordering::Relaxed);
    REQUESTED.load(Ordering::Relaxed)
}

/// Ends the program if nobody looks for the request that has come.
fn see_to_the_end() {
    let before = LOOKS.load(Ordering::Relaxed);
    thread::sleep(patience(before, Duration::from_millis(LONGEST.load(Ordering::Relaxed))));
    if LOOKS.load(Ordering::Relaxed) == before {
        output::note("interrupted; what was written before is complete");
        // At once: what libraries want done at the end may wait for what is being interrupted.
        low_level::exit(INTERRUPTED);
    }
}

/// How long a request may wait where somebody has looked so often, at most so long apart.
fn patience(looks: u64, longest: Duration) -> Duration {
    if looks == 0 { SET_UP } else { PATIENCE.max(ITERATIONS * longest) }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_set_up_ends_at_once_and_an_iteration_has_its_time() {
        assert_eq!(patience(0, Duration::ZERO), SET_UP);
        assert_eq!(patience(1, Duration::ZERO), PATIENCE);
        assert_eq!(patience(5, Duration::from_secs(4)), Duration::from_secs(12));
    }
}
