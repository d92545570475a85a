//! Memory for the buffers of OpenBLAS. Each of its threads maps a buffer once, and retries forever if that is
//! refused, so the memory is checked in advance.

#![allow(unsafe_code)]

use std::cell::Cell;
use std::ffi::{c_int, c_void};
use std::time::Duration;
use std::{ptr, thread};

use libloading::os::unix::Library;

use crate::algebra::linear::{Computed, LinearError};

/// The size of the buffer that OpenBLAS maps for a thread on x86-64, bytes; it is smaller on other processors.
pub(in crate::algebra::linear) const BUFFER: usize = 128 << 20;

/// The time to wait for buffers of OpenBLAS threads that have just been started, ms. It takes them one.
const PATIENCE: usize = 1000;

/// The size of a thread's stack, bytes.
const STACK: usize = 8 << 20;

thread_local! {
    /// `true` if this thread has its buffer.
    static READY: Cell<bool> = const { Cell::new(false) };
}

/// Makes sure that the BLAS has its buffer for this thread before its first use there.
///
/// # Errors
/// [`LinearError::OutOfMemory`] if the system refuses the memory.
pub(in crate::algebra::linear) fn prepare() -> Computed<()> {
    if READY.get() {
        return Ok(());
    }
    let process = Library::this();
    if openblas_threads(&process).is_some() {
        if !can_map(BUFFER) {
            let step = "the BLAS, which takes 128 MiB for each of its threads (one with OPENBLAS_NUM_THREADS=1)";
            return Err(LinearError::OutOfMemory { step });
        }
        take_buffer(&process);
    }
    READY.set(true);
    Ok(())
}

/// Returns `true` if there is memory for `wanted` threads of OpenBLAS, which has `before` threads.
pub(super) fn for_threads(before: usize, wanted: usize) -> bool {
    let more = wanted.saturating_sub(before);
    more == 0 || can_map(more.saturating_mul(BUFFER + STACK))
}

/// Returns `true` if a thread that OpenBLAS started when it was loaded cannot get its buffer. It retries forever, and
/// the end of the process would wait for it forever. If it returns `false`, each of them has its buffer or can get it.
pub(in crate::algebra::linear) fn is_stuck(process: &Library) -> bool {
    let threads = openblas_threads(process).unwrap_or(1);
    if threads == 1 || can_map(threads.saturating_mul(BUFFER)) {
        return false;
    }
    for _ in 0..PATIENCE {
        if mapped_buffers() >= threads - 1 {
            return false;
        }
        if !can_map(BUFFER) {
            return true;
        }
        thread::sleep(Duration::from_millis(1));
    }
    false
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

/// Makes OpenBLAS map a buffer for the next thread that needs one.
fn take_buffer(process: &Library) {
    // SAFETY: OpenBLAS exports the two functions by which each product takes and returns its buffer. The first one takes
    // a C int, which it ignores, and returns a pointer; the second one takes that pointer.
    let take = unsafe { process.get::<unsafe extern "C" fn(c_int) -> *mut c_void>(b"blas_memory_alloc\0") };
    // SAFETY: see above.
    let give = unsafe { process.get::<unsafe extern "C" fn(*mut c_void)>(b"blas_memory_free\0") };
    if let (Ok(take), Ok(give)) = (take, give) {
        // SAFETY: the buffer goes back as it came, and stays mapped.
        unsafe { give(take(0)) };
    }
}
