//! How many threads the BLAS behind SuiteSparse uses.
//!
//! Fronts of two-dimensional problems are small: a second BLAS thread gains little and, on a busy
//! machine, can cost an order of magnitude. Which BLAS is loaded is only known at run time, so its
//! thread control is looked up by name.

#![allow(unsafe_code)]

use std::ffi::c_int;

type SetThreads = unsafe extern "C" fn(c_int);

/// Thread controls of the BLAS libraries that have one, in C calling convention by value.
const CONTROLS: [(&str, &[u8]); 3] = [
    ("OpenBLAS", b"openblas_set_num_threads\0"),
    ("BLIS", b"bli_thread_set_num_threads\0"),
    ("MKL", b"MKL_Set_Num_Threads\0"),
];

/// Sets the number of BLAS threads and returns the name of the library that took it.
///
/// `None` means that the loaded BLAS has no such control, as the reference BLAS, which is
/// single-threaded and two to six times slower here than OpenBLAS.
pub fn set_threads(threads: usize) -> Option<&'static str> {
    let threads = c_int::try_from(threads.max(1)).unwrap_or(c_int::MAX);
    let process = process()?;
    CONTROLS.iter().find_map(|&(name, symbol)| {
        // SAFETY: all three symbols are functions that take the number of threads and return
        // nothing (BLIS takes its own integer, which is as wide or read from the same register).
        let control = unsafe { process.get::<SetThreads>(symbol) }.ok()?;
        // SAFETY: setting the number of threads has no precondition but a positive number.
        unsafe { control(threads) };
        Some(name)
    })
}

#[cfg(unix)]
fn process() -> Option<libloading::Library> {
    Some(libloading::os::unix::Library::this().into())
}

#[cfg(not(unix))]
fn process() -> Option<libloading::Library> {
    None
}
