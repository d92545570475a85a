//! An allocator with which a program ends in an orderly way if memory is refused.
//!
//! Fallible allocations return errors as usual. Infallible ones abort; this allocator turns the abort into a message
//! and an exit status.

use std::alloc::{GlobalAlloc, Layout, System};
use std::ffi::c_int;
use std::sync::OnceLock;
use std::sync::atomic::{AtomicBool, Ordering};

/// The messages and the exit status after an abort.
#[derive(Debug, Clone, Copy)]
pub struct AbortReport {
    /// The message on standard error if memory was refused before.
    pub out_of_memory: &'static str,
    /// The text on standard output in that case.
    pub output: &'static str,
    /// The message on standard error if no memory was refused.
    pub aborted: &'static str,
    /// The exit status.
    pub status: i32,
}

static REPORT: OnceLock<AbortReport> = OnceLock::new();
static REFUSED: AtomicBool = AtomicBool::new(false);

/// The messages and status before [`set_abort_report`] is called.
const UNSET: AbortReport =
    AbortReport { out_of_memory: "out of memory\n", output: "", aborted: "aborted\n", status: 3 };

/// Sets the messages and the exit status for an abort: by Rust after a refused infallible allocation, or by a C
/// library. Only the first call has an effect.
pub fn set_abort_report(report: AbortReport) {
    if REPORT.set(report).is_ok() {
        arm();
    }
}

/// Returns `true` if the allocator of this process, if it is [`ReportingAllocator`], has refused memory.
pub fn memory_was_refused() -> bool {
    REFUSED.load(Ordering::Relaxed)
}

/// The system allocator with an orderly end: after it has refused memory, an abort ends the process as set by
/// [`set_abort_report`]. A program makes it its `#[global_allocator]`.
#[derive(Debug)]
pub struct ReportingAllocator;

// SAFETY: every call and its result are passed on unchanged to and from the system allocator.
unsafe impl GlobalAlloc for ReportingAllocator {
    unsafe fn alloc(&self, layout: Layout) -> *mut u8 {
        // SAFETY: the caller keeps the contract, which is the same for this function.
        noted(unsafe { System.alloc(layout) })
    }

    unsafe fn alloc_zeroed(&self, layout: Layout) -> *mut u8 {
        // SAFETY: as above.
        noted(unsafe { System.alloc_zeroed(layout) })
    }

    unsafe fn realloc(&self, block: *mut u8, layout: Layout, size: usize) -> *mut u8 {
        // SAFETY: as above.
        noted(unsafe { System.realloc(block, layout, size) })
    }

    unsafe fn dealloc(&self, block: *mut u8, layout: Layout) {
        // SAFETY: as above.
        unsafe { System.dealloc(block, layout) }
    }
}

/// Returns `block`. If it was refused, installs the handler, so that the end is orderly also before `main`, or after
/// a library has replaced the signal handler.
fn noted(block: *mut u8) -> *mut u8 {
    if block.is_null() {
        REFUSED.store(true, Ordering::Relaxed);
        arm();
    }
    block
}

fn arm() {
    let end: extern "C" fn(c_int) = end;
    let mut abort = std::mem::MaybeUninit::<libc::sigset_t>::uninit();
    // SAFETY: SIGABRT can be caught, and the handler does only what a handler may do: it reads data that are set
    // once, writes to open files and ends the process. The signal set is emptied before use. The signal is unblocked,
    // because METIS, after refused memory, jumps out of its own handler and leaves the signal blocked; then abort of
    // glibc 2.41 and later would call no handler.
    unsafe {
        libc::signal(libc::SIGABRT, end as libc::sighandler_t);
        libc::sigemptyset(abort.as_mut_ptr());
        libc::sigaddset(abort.as_mut_ptr(), libc::SIGABRT);
        libc::pthread_sigmask(libc::SIG_UNBLOCK, abort.as_ptr(), std::ptr::null_mut());
    }
}

/// Ends the process without allocating, unwinding or running exit handlers of libraries.
extern "C" fn end(_: c_int) {
    let report = REPORT.get().unwrap_or(&UNSET);
    let (note, output) =
        if memory_was_refused() { (report.out_of_memory, report.output) } else { (report.aborted, "") };
    for (file, text) in [(libc::STDERR_FILENO, note), (libc::STDOUT_FILENO, output)] {
        // SAFETY: the text is alive and has this length; a failed write is ignored.
        unsafe { libc::write(file, text.as_ptr().cast(), text.len()) };
    }
    // SAFETY: this function takes any status and does not return.
    unsafe { libc::_exit(report.status) }
}
