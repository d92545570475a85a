//! The process as a whole: its memory, and the BLAS that is loaded into it.
//!
//! A program may set these; the library sets none of them without a call of the program. Each part is here because a
//! user meets what it prevents:
//!
//! - [`keep_freed_memory`]: without it the system clears the pages of each factor anew, a fifth of the CPU time.
//! - [`Blas::better_kernel`]: an OpenBLAS that does not know the processor takes its oldest kernel, which makes
//!   factorisations in space a third slower and dense products two to four times.
//! - [`set_blas_threads`]: OpenBLAS and OpenMP would start as many threads as there are processors, for products too
//!   small to gain from them.
//! - `blas::blas_buffer`: OpenBLAS asks for a buffer of 128 MiB until it gets one. If the memory is limited, that is forever. So
//!   each thread asks for that much first, and then lets OpenBLAS map its buffer, before its first product.
//! - [`blas_is_stuck`]: a thread that OpenBLAS starts when it is loaded may ask forever, too, and the process could not
//!   end in the usual way.
//! - [`ReportingAllocator`]: Rust aborts if an allocation that cannot fail is refused. The program then ends with a message, a
//!   JSON object if it was asked for, and its own exit status.

#![allow(unsafe_code)]

mod allocator;
pub(crate) mod blas;
pub use blas::{Blas, KERNEL_VARIABLE};

pub use allocator::{AbortReport, ReportingAllocator, memory_was_refused, set_abort_report};

#[cfg(any(feature = "blas", all(target_os = "linux", target_env = "gnu")))]
use std::ffi::c_int;

#[cfg(feature = "blas")]
use libloading::os::unix::Library;

#[cfg(feature = "blas")]
use blas::{blas_buffer, loaded};

/// Makes sure that the BLAS has its buffer for this thread before its first product there.
///
/// # Errors
/// [`LinearError::OutOfMemory`](super::LinearError) if the system refuses the memory.
#[cfg(feature = "blas")]
pub fn prepare_blas() -> Result<(), super::LinearError> {
    blas_buffer::prepare()
}

/// Sets the number of BLAS threads, and of OpenMP threads for this thread. Returns the name of the library that
/// accepted it.
///
/// Fronts of two-dimensional problems are small: a second BLAS thread gains nothing there, doubles the CPU time and,
/// on a busy machine, can cost an order of magnitude. `None` means that the library has no thread control, like the
/// reference BLAS, which is single-threaded and slower.
#[cfg(feature = "blas")]
pub fn set_blas_threads(threads: usize) -> Option<&'static str> {
    let process = Library::this();
    set_openmp(&process, threads);
    loaded::set_threads(&process, threads)
}

/// Returns `true` if a thread that OpenBLAS started when it was loaded cannot get its memory and retries forever. The
/// process can then neither use the BLAS nor end in the usual way. A process with `OPENBLAS_NUM_THREADS=1` in its
/// environment has no such thread.
#[cfg(feature = "blas")]
pub fn blas_is_stuck() -> bool {
    blas_buffer::is_stuck(&Library::this())
}

/// Makes the parallel regions of CHOLMOD that this thread reaches run in it; other threads are unaffected. Does
/// nothing in a build without CHOLMOD.
pub(crate) fn keep_openmp_in_this_thread() {
    #[cfg(feature = "blas")]
    set_openmp(&Library::this(), 1);
}

/// CHOLMOD has its own parallel regions, independent of the BLAS. With zero active levels they run in the thread that
/// reaches them; in an OpenMP with per-thread settings, this applies to the calling thread.
#[cfg(feature = "blas")]
fn set_openmp(process: &Library, threads: usize) {
    let count = c_int::try_from(threads.max(1)).unwrap_or(c_int::MAX);
    let settings = [(&b"omp_set_max_active_levels\0"[..], c_int::from(count > 1)), (b"omp_set_num_threads\0", count)];
    for (symbol, value) in settings {
        // SAFETY: the symbols are OpenMP's documented functions, which take a C int; zero levels and one thread are
        // valid.
        if let Ok(set) = unsafe { process.get::<unsafe extern "C" fn(c_int)>(symbol) } {
            // SAFETY: see above.
            unsafe { set(value) };
        }
    }
}

/// Keeps freed memory in the process instead of returning it to the system.
///
/// Every factorisation allocates and frees the same large blocks. By default glibc maps them anew each time, and the
/// system spends a quarter of the run clearing their pages (block 100 × 100: 3.7 of 15.8 s CPU; with this, 0.1 of
/// 12.6 s). The peak memory grows by a few per cent. Does nothing if the C library is not glibc.
pub fn keep_freed_memory() {
    #[cfg(all(target_os = "linux", target_env = "gnu"))]
    // SAFETY: mallopt only sets two thresholds of the allocator; called before other threads exist
    // or not, it is guarded by the allocator's own lock.
    unsafe {
        libc::mallopt(libc::M_MMAP_MAX, 0);
        libc::mallopt(libc::M_TRIM_THRESHOLD, c_int::MAX);
    }
}
