//! Settings of the whole process that decide how fast a factorisation runs: BLAS threads and what
//! becomes of freed memory. A library must not change them behind its caller's back; a program
//! does.

#![allow(unsafe_code)]

use std::ffi::c_int;

#[cfg(feature = "umfpack")]
use libloading::os::unix::Library;

#[cfg(feature = "umfpack")]
use super::blas::loaded;

/// Sets the number of BLAS threads and returns the name of the library that took it.
///
/// Fronts of two-dimensional problems are small: a second BLAS thread gains little and, on a busy
/// machine, can cost an order of magnitude. `None` means that the library has no thread control, as
/// the reference BLAS, which is single-threaded and slower.
#[cfg(feature = "umfpack")]
pub fn set_blas_threads(threads: usize) -> Option<&'static str> {
    let process = Library::this();
    if threads <= 1 {
        run_openmp_serially(&process);
    }
    loaded::set_threads(&process, threads)
}

/// CHOLMOD has parallel regions of its own, whatever the BLAS is told. Without an active level they
/// run in the thread that meets them; with an OpenMP that keeps this per thread, in the calling one.
#[cfg(feature = "umfpack")]
fn run_openmp_serially(process: &Library) {
    // SAFETY: the symbol is OpenMP's documented function, which takes a C int; 0 is valid.
    if let Ok(set) = unsafe { process.get::<unsafe extern "C" fn(c_int)>(b"omp_set_max_active_levels\0") } {
        // SAFETY: see above.
        unsafe { set(0) };
    }
}

/// Keeps freed memory in the process instead of giving it back to the system.
///
/// Every factorisation allocates and frees the same large blocks. By default glibc maps them anew
/// each time, and the system spends a quarter of the run clearing their pages (block 100 × 100: 3.7
/// of 15.8 s CPU; with this, 0.1 of 12.6 s). The peak memory grows by a few per cent. Does nothing
/// where the C library is not glibc.
pub fn keep_freed_memory() {
    #[cfg(all(target_os = "linux", target_env = "gnu"))]
    // SAFETY: mallopt only sets two thresholds of the allocator; called before other threads exist
    // or not, it is guarded by the allocator's own lock.
    unsafe {
        libc::mallopt(libc::M_MMAP_MAX, 0);
        libc::mallopt(libc::M_TRIM_THRESHOLD, c_int::MAX);
    }
}
