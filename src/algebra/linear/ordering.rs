//! One fill-reducing ordering at a time.

use std::sync::{Mutex, MutexGuard, PoisonError};

static ORDERING: Mutex<()> = Mutex::new(());

/// Held while a backend orders. METIS draws from the generator of the C library, which all threads
/// share: alone it orders the same pattern the same way in every run.
pub(super) fn alone() -> MutexGuard<'static, ()> {
    ORDERING.lock().unwrap_or_else(PoisonError::into_inner)
}
