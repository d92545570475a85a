//! Room for what OpenBLAS takes for itself. Each of its threads maps a buffer once, and asks for ever where that is refused, so
//! it is asked for beforehand.

#![allow(unsafe_code)]

use std::cell::Cell;
use std::ffi::{c_char, c_int};
use std::ptr;
use std::sync::atomic::{AtomicUsize, Ordering};
use std::sync::{Arc, Condvar, Mutex, PoisonError};
use std::thread;
use std::time::Duration;

use libloading::os::unix::Library;

use crate::algebra::linear::LinearError;

/// What OpenBLAS maps for a thread on x86-64, bytes; elsewhere it is less.
pub(in crate::algebra::linear) const BUFFER: usize = 128 << 20;

/// To map a buffer takes a millisecond; who waits so long waits for ever.
const PATIENCE: Duration = Duration::from_secs(5);

/// The stack of a thread, bytes.
const STACK: usize = 8 << 20;

/// Buffers that threads of OpenBLAS have left behind, which others take before they map new ones.
static LEFT: AtomicUsize = AtomicUsize::new(0);

thread_local! {
    /// Whether this thread has what it needs.
    static READY: Cell<bool> = const { Cell::new(false) };
}

/// Sees to it that the BLAS has its buffer for this thread, before its first use there.
///
/// # Errors
/// [`LinearError::OutOfMemory`] where the system refuses that memory.
pub(in crate::algebra::linear) fn prepare() -> Result<(), LinearError> {
    if READY.get() {
        return Ok(());
    }
    let process = Library::this();
    if openblas_threads(&process).is_some() {
        let left = LEFT.fetch_update(Ordering::Relaxed, Ordering::Relaxed, |left| left.checked_sub(1)).is_ok();
        if !left && !can_map(BUFFER) {
            return Err(LinearError::OutOfMemory { step: "the BLAS, which takes 128 MiB for itself" });
        }
        if !takes_buffer_in_time() {
            return Err(LinearError::OutOfMemory { step: "the BLAS, which waits for memory of its own" });
        }
    }
    READY.set(true);
    Ok(())
}

/// Whether OpenBLAS, which has `before` threads, can have as many as `wanted`.
pub(super) fn for_threads(before: usize, wanted: usize) -> bool {
    let more = wanted.saturating_sub(before);
    more == 0 || can_map(more.saturating_mul(BUFFER + STACK))
}

/// Threads of OpenBLAS have ended and left so many buffers.
pub(super) fn left_behind(buffers: usize) {
    LEFT.fetch_add(buffers, Ordering::Relaxed);
}

/// Whether a thread that OpenBLAS has started when it was loaded asks for its buffer in vain. It does so for ever, and whoever waits for
/// its end waits for ever, too, such as the end of the process.
pub(in crate::algebra::linear) fn is_stuck(process: &Library) -> bool {
    let workers = openblas_threads(process).map_or(0, |threads| threads - 1);
    workers > mapped_buffers() && !can_map(BUFFER)
}

/// The threads of OpenBLAS, if that is the BLAS of this process.
fn openblas_threads(process: &Library) -> Option<usize> {
    // SAFETY: OpenBLAS' documented function takes nothing and returns the number of threads as a C int.
    let count = unsafe { process.get::<unsafe extern "C" fn() -> c_int>(b"openblas_get_num_threads\0") }.ok()?;
    // SAFETY: see above.
    Some(usize::try_from(unsafe { count() }).unwrap_or(1).max(1))
}

/// How many buffers of OpenBLAS this process can hold among what it has mapped.
fn mapped_buffers() -> usize {
    let maps = std::fs::read_to_string("/proc/self/maps").unwrap_or_default();
    let size = |line: &str| {
        let (range, rest) = line.split_once(' ')?;
        let (from, to) = range.split_once('-')?;
        let [from, to] = [from, to].map(|address| usize::from_str_radix(address, 16).ok());
        rest.starts_with("rw").then(|| to?.checked_sub(from?))?
    };
    maps.lines().filter_map(size).map(|size| size / BUFFER).sum()
}

/// Whether the system would map so many bytes now.
fn can_map(bytes: usize) -> bool {
    // SAFETY: a new mapping of memory without a file touches nothing that is there.
    let block = unsafe {
        let (protection, flags) = (libc::PROT_READ | libc::PROT_WRITE, libc::MAP_PRIVATE | libc::MAP_ANONYMOUS);
        libc::mmap(ptr::null_mut(), bytes, protection, flags, -1, 0)
    };
    if block == libc::MAP_FAILED {
        return false;
    }
    // SAFETY: this mapping was made above, as long as that, and nobody else knows it.
    unsafe { libc::munmap(block, bytes) };
    true
}

/// `dtrsm` of BLAS: solves with a triangular matrix for many right-hand sides. Its integers are C's.
type Dtrsm = unsafe extern "C" fn(
    *const c_char,
    *const c_char,
    *const c_char,
    *const c_char,
    *const c_int,
    *const c_int,
    *const f64,
    *const f64,
    *const c_int,
    *mut f64,
    *const c_int,
);

/// Lets OpenBLAS map a buffer, which the next thread that needs one takes; whether it did. Somebody may have taken the memory since it was
/// asked for, and then OpenBLAS asks for ever: that thread is left behind.
fn takes_buffer_in_time() -> bool {
    let taken = Arc::new((Mutex::new(false), Condvar::new()));
    let told = Arc::clone(&taken);
    let taking = move || {
        take_buffer(&Library::this());
        *told.0.lock().unwrap_or_else(PoisonError::into_inner) = true;
        told.1.notify_one();
    };
    let Ok(thread) = thread::Builder::new().spawn(taking) else { return false };
    let is_taken = taken.0.lock().unwrap_or_else(PoisonError::into_inner);
    let waited = taken.1.wait_timeout_while(is_taken, PATIENCE, |is_taken| !*is_taken);
    let is_taken = *waited.unwrap_or_else(PoisonError::into_inner).0;
    is_taken && thread.join().is_ok()
}

/// Lets OpenBLAS map its buffer for this thread by a triangular solve with the identity.
fn take_buffer(process: &Library) {
    const N: usize = 4;
    // SAFETY: the symbol is that of the BLAS, and OpenBLAS, which this is, takes no lengths of its characters.
    let Ok(solve) = (unsafe { process.get::<Dtrsm>(b"dtrsm_\0") }) else { return };
    let mut identity = [0.0; N * N];
    (0..N).for_each(|i| identity[(N + 1) * i] = 1.0);
    let mut x = identity;
    // Read as 64 or as 32 bits, these are the same number.
    let n = [N as c_int, 0];
    let [left, lower, no] = [b'L', b'L', b'N'].map(|letter| letter as c_char);
    let scale = 1.0;
    // SAFETY: both matrices have n columns of n entries; the characters and numbers are those that the function takes, and all outlive
    // the call.
    unsafe {
        solve(
            &raw const left,
            &raw const lower,
            &raw const no,
            &raw const no,
            n.as_ptr(),
            n.as_ptr(),
            &raw const scale,
            identity.as_ptr(),
            n.as_ptr(),
            x.as_mut_ptr(),
            n.as_ptr(),
        );
    }
}
