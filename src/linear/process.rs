//! Settings of the whole process that decide how fast a factorisation runs: BLAS threads and what
//! becomes of freed memory. A library must not change them behind its caller's back; a program
//! does.

#![allow(unsafe_code)]

use std::ffi::c_int;

use libloading::os::unix::Library;

type SetThreads = unsafe extern "C" fn(c_int);

/// Thread controls of the BLAS libraries that have one, in C calling convention by value.
const CONTROLS: [(&str, &[u8]); 3] = [
    ("OpenBLAS", b"openblas_set_num_threads\0"),
    ("BLIS", b"bli_thread_set_num_threads\0"),
    ("MKL", b"MKL_Set_Num_Threads\0"),
];

/// Sets the number of BLAS threads and returns the name of the library that took it.
///
/// Fronts of two-dimensional problems are small: a second BLAS thread gains little and, on a busy
/// machine, can cost an order of magnitude. Which BLAS is loaded is only known at run time, so its
/// thread control is looked up by name. `None` means that it has none, as the reference BLAS, which
/// is single-threaded and two to six times slower here than OpenBLAS.
pub fn set_blas_threads(threads: usize) -> Option<&'static str> {
    let threads = c_int::try_from(threads.max(1)).unwrap_or(c_int::MAX);
    let process = Library::this();
    CONTROLS.iter().find_map(|&(name, symbol)| {
        // SAFETY: all three symbols are functions that take the number of threads and return
        // nothing (BLIS takes its own integer, which is as wide or read from the same register).
        let control = unsafe { process.get::<SetThreads>(symbol) }.ok()?;
        // SAFETY: setting the number of threads has no precondition but a positive number.
        unsafe { control(threads) };
        Some(name)
    })
}

/// Keeps freed memory in the process instead of giving it back to the system.
///
/// Every factorisation allocates and frees the same large blocks. By default glibc maps them anew
/// each time, and the system spends a quarter of the run clearing their pages (block 100 × 100: 3.7
/// of 15.8 s CPU, against 0.1 s with this). The peak memory grows by a few per cent. Does nothing
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
