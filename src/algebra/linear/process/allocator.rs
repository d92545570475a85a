//! The allocator of a program that is to end in order where memory is refused.
//!
//! What asks for memory and can do without is told so, as ever. For the rest Rust aborts the process, which is what this allocator
//! turns into a message and an exit status.

use std::alloc::{GlobalAlloc, Layout, System};
use std::ffi::c_int;
use std::sync::OnceLock;
use std::sync::atomic::{AtomicBool, Ordering};

/// What is said when the process is aborted, and by what status it ends.
#[derive(Debug, Clone, Copy)]
pub struct Last {
    /// On standard error, where memory was refused before.
    pub out_of_memory: &'static str,
    /// On standard output then.
    pub output: &'static str,
    /// On standard error, where none was.
    pub aborted: &'static str,
    /// The exit status.
    pub status: i32,
}

static LAST: OnceLock<Last> = OnceLock::new();
static ENDS: AtomicBool = AtomicBool::new(false);
static REFUSED: AtomicBool = AtomicBool::new(false);

/// Before [`say_last`] was called.
const UNTOLD: Last = Last { out_of_memory: "out of memory\n", output: "", aborted: "aborted\n", status: 3 };

/// Chooses what is said and by what status the process ends where it is aborted, by Rust where memory is refused that it cannot do
/// without, or where a library of C finds no way to go on and aborts or exits. Only the first choice counts. From then on [`exits`] comes
/// before an exit that is meant.
pub fn say_last(last: Last) {
    if LAST.set(last).is_ok() {
        arm();
        // SAFETY: the function may be called at the end of the process, and does only what it may in a handler of a signal.
        unsafe { libc::atexit(unless_meant) };
    }
}

/// The process is about to end as it should.
pub fn exits() {
    ENDS.store(true, Ordering::Relaxed);
}

extern "C" fn unless_meant() {
    if !ENDS.load(Ordering::Relaxed) {
        end(0);
    }
}

/// Whether the allocator of this process, if it is [`OrderlyEnd`], has refused memory.
pub fn memory_was_refused() -> bool {
    REFUSED.load(Ordering::Relaxed)
}

/// The allocator of the system. Once that has refused memory, an abort ends the process as [`say_last`] has it; a program makes it its
/// `#[global_allocator]`.
#[derive(Debug)]
pub struct OrderlyEnd;

// SAFETY: every call is passed on to the allocator of the system, with what it was called with, and so is its answer.
unsafe impl GlobalAlloc for OrderlyEnd {
    unsafe fn alloc(&self, layout: Layout) -> *mut u8 {
        // SAFETY: the caller keeps the contract of this function, which is the same.
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

/// The same `block`. One that was refused arms the end, so that it comes in order before `main`, too, and after a library has had the signal
/// for itself.
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
    // SAFETY: SIGABRT is a signal that can be caught, and the handler does only what a handler may: it reads what is set once, writes
    // to open files and ends the process. The set is made empty before it is used. METIS, where memory is refused to it, jumps out of a
    // handler of its own and leaves the signal blocked, and then abort of glibc 2.41 and later calls no handler.
    unsafe {
        libc::signal(libc::SIGABRT, end as libc::sighandler_t);
        libc::sigemptyset(abort.as_mut_ptr());
        libc::sigaddset(abort.as_mut_ptr(), libc::SIGABRT);
        libc::pthread_sigmask(libc::SIG_UNBLOCK, abort.as_ptr(), std::ptr::null_mut());
    }
}

/// Ends the process without allocating, unwinding or running what libraries want done at the end.
extern "C" fn end(_: c_int) {
    let last = LAST.get().unwrap_or(&UNTOLD);
    let (note, output) = if memory_was_refused() { (last.out_of_memory, last.output) } else { (last.aborted, "") };
    for (file, text) in [(libc::STDERR_FILENO, note), (libc::STDOUT_FILENO, output)] {
        // SAFETY: the text is alive and as long as that; a file that cannot be written is left alone.
        unsafe { libc::write(file, text.as_ptr().cast(), text.len()) };
    }
    // SAFETY: this function takes any status and does not return.
    unsafe { libc::_exit(last.status) }
}
