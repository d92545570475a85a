//! A lock that allows one fill-reducing ordering at a time.

use std::sync::{Mutex, MutexGuard, PoisonError};

static ORDERING: Mutex<()> = Mutex::new(());

/// Returns a guard to be held while a backend orders. METIS uses the random numbers of the C library, which all
/// threads share. With exclusive access it orders the same pattern in the same way in every run.
pub(super) fn alone() -> MutexGuard<'static, ()> {
    ORDERING.lock().unwrap_or_else(PoisonError::into_inner)
}
