//! Memory for the buffers of OpenBLAS. Each of its threads maps a buffer once, and retries forever if that is
//! refused, so the memory is checked in advance.

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

/// The size of the buffer that OpenBLAS maps for a thread on x86-64, bytes; it is smaller on other processors.
pub(in crate::algebra::linear) const BUFFER: usize = 128 << 20;

/// Mapping a buffer takes a millisecond; a thread that takes longer than this will never finish.
const PATIENCE: Duration = Duration::from_secs(5);

/// The size of a thread's stack, bytes.
const STACK: usize = 8 << 20;

/// The number of buffers that ended OpenBLAS threads have left behind. Other threads use them before they map new
/// ones.
static LEFT: AtomicUsize = AtomicUsize::new(0);

thread_local! {
    /// `true` if this thread has its buffer.
    static READY: Cell<bool> = const { Cell::new(false) };
}

/// Makes sure that the BLAS has its buffer for this thread before its first use there.
///
/// # Errors
/// [`LinearError::OutOfMemory`] if the system refuses the memory.
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

/// Returns `true` if there is memory for `wanted` threads of OpenBLAS, which has `before` threads.
pub(super) fn for_threads(before: usize, wanted: usize) -> bool {
    let more = wanted.saturating_sub(before);
    more == 0 || can_map(more.saturating_mul(BUFFER + STACK))
}

/// Records that threads of OpenBLAS have ended and left this many buffers.
pub(super) fn left_behind(buffers: usize) {
    LEFT.fetch_add(buffers, Ordering::Relaxed);
}

/// Returns `true` if a thread that OpenBLAS started when it was loaded cannot get its buffer. It retries forever, and
/// the end of the process would wait for it forever.
pub(in crate::algebra::linear) fn is_stuck(process: &Library) -> bool {
    let workers = openblas_threads(process).map_or(0, |threads| threads - 1);
    workers > mapped_buffers() && !can_map(BUFFER)
}

/// Returns the number of OpenBLAS threads, if OpenBLAS is the BLAS of this process.
fn openblas_threads(process: &Library) -> Option<usize> {
    // SAFETY: OpenBLAS' documented function takes nothing and returns the number of threads as a C int.
    let count = unsafe { process.get::<unsafe extern "C" fn() -> c_int>(b"openblas_get_num_threads\0") }.ok()?;
    // SAFETY: see above.
    Some(usize::try_from(unsafe { count() }).unwrap_or(1).max(1))
}

/// Returns the number of OpenBLAS buffers that fit into the mapped memory of this process.
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

/// Returns `true` if the system would map this many bytes now.
fn can_map(bytes: usize) -> bool {
    // SAFETY: a new anonymous mapping does not affect existing memory.
    let block = unsafe {
        let (protection, flags) = (libc::PROT_READ | libc::PROT_WRITE, libc::MAP_PRIVATE | libc::MAP_ANONYMOUS);
        libc::mmap(ptr::null_mut(), bytes, protection, flags, -1, 0)
    };
    if block == libc::MAP_FAILED {
        return false;
    }
    // SAFETY: this mapping was made above with this length, and has no other user.
    unsafe { libc::munmap(block, bytes) };
    true
}

/// The function `dtrsm` of BLAS: solves with a triangular matrix for many right-hand sides. Its integers are C's.
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

/// Makes OpenBLAS map a buffer for the next thread that needs one. Returns `false` if it takes too long: another
/// process may have taken the memory since the check, and OpenBLAS then retries forever in a thread that is
/// abandoned.
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

/// Makes OpenBLAS map its buffer for this thread by a triangular solve with the identity.
fn take_buffer(process: &Library) {
    const N: usize = 4;
    // SAFETY: the symbol is that of OpenBLAS, whose function takes no lengths of its characters.
    let Ok(solve) = (unsafe { process.get::<Dtrsm>(b"dtrsm_\0") }) else { return };
    let mut identity = [0.0; N * N];
    (0..N).for_each(|i| identity[(N + 1) * i] = 1.0);
    let mut x = identity;
    // Reading these as 64 or as 32 bits gives the same number.
    let n = [N as c_int, 0];
    let [left, lower, no] = [b'L', b'L', b'N'].map(|letter| letter as c_char);
    let scale = 1.0;
    // SAFETY: both matrices have n columns of n entries; the characters and numbers are valid arguments of the
    // function, and all outlive the call.
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
