//! Queries of the loaded BLAS by functions specific to each library. Since the library is known only at run time, the
//! functions are looked up by name.

#![allow(unsafe_code)]

use std::ffi::{CStr, c_char, c_int};

use libloading::os::unix::Library;

use super::kernel::{Vectors, better_kernel};
use super::{Blas, KERNEL_VARIABLE, UNKNOWN, blas_buffer};

/// A BLAS library, with its functions for setting and reading the number of threads.
struct Kind {
    name: &'static str,
    set_threads: &'static [u8],
    get_threads: &'static [u8],
    /// `true` if it counts in 64-bit integers, `false` for a C int.
    counts_in_64_bits: bool,
}

const OPENBLAS: &str = "OpenBLAS";

const KINDS: [Kind; 3] = [
    Kind {
        name: OPENBLAS,
        set_threads: b"openblas_set_num_threads\0",
        get_threads: b"openblas_get_num_threads\0",
        counts_in_64_bits: false,
    },
    Kind {
        name: "MKL",
        set_threads: b"MKL_Set_Num_Threads\0",
        get_threads: b"MKL_Get_Max_Threads\0",
        counts_in_64_bits: false,
    },
    Kind {
        name: "BLIS",
        set_threads: b"bli_thread_set_num_threads\0",
        get_threads: b"bli_thread_get_num_threads\0",
        counts_in_64_bits: true,
    },
];

/// Sets the number of threads of the BLAS, if it differs. Returns the name of the library, or `None` if it has no
/// such function.
pub(in crate::algebra::linear) fn set_threads(process: &Library, wanted: usize) -> Option<&'static str> {
    let count = c_int::try_from(wanted.max(1)).unwrap_or(c_int::MAX);
    // SAFETY (all): the symbols are the libraries' documented functions, which take the number of threads as a C int
    // (OpenBLAS, MKL) or as a 64-bit integer (BLIS) and return nothing; any positive number is valid.
    KINDS.iter().find_map(|kind| {
        let before = threads(process, kind)?;
        // A thread of OpenBLAS without memory for its buffer would never end.
        if before == wanted || kind.name == OPENBLAS && !blas_buffer::for_threads(before, wanted) {
            return Some(kind.name);
        }
        if kind.counts_in_64_bits {
            // SAFETY: see above.
            let set = unsafe { process.get::<unsafe extern "C" fn(i64)>(kind.set_threads) }.ok()?;
            // SAFETY: see above.
            unsafe { set(i64::from(count)) };
        } else {
            // SAFETY: see above.
            let set = unsafe { process.get::<unsafe extern "C" fn(c_int)>(kind.set_threads) }.ok()?;
            // SAFETY: see above.
            unsafe { set(count) };
        }
        Some(kind.name)
    })
}

/// Returns all properties that the BLAS of this process reports.
pub(super) fn describe() -> Blas {
    let process = Library::this();
    let found = KINDS.iter().find_map(|kind| Some((kind.name, threads(&process, kind)?)));
    let blas = Blas {
        library: found.map_or(UNKNOWN, |(name, _)| name),
        version: None,
        kernel: None,
        threads: found.map(|(_, threads)| threads),
        kernel_asked: None,
        better_kernel: None,
        selectable: false,
    };
    match blas.library {
        OPENBLAS => of_openblas(&process, &blas),
        "BLIS" => {
            Blas { version: text(&process, b"bli_info_get_version_str\0"), kernel: blis_kernel(&process), ..blas }
        }
        _ => blas,
    }
}

fn of_openblas(process: &Library, blas: &Blas) -> Blas {
    // For example `OpenBLAS 0.3.21 NO_LAPACKE DYNAMIC_ARCH NO_AFFINITY Haswell MAX_THREADS=64`.
    let config = text(process, b"openblas_get_config\0").unwrap_or_default();
    let kernel = text(process, b"openblas_get_corename\0");
    let asked = std::env::var_os(KERNEL_VARIABLE).filter(|name| !name.is_empty());
    Blas {
        version: config.split_whitespace().nth(1).map(String::from),
        kernel_asked: asked.map(|name| name.to_string_lossy().into_owned()),
        better_kernel: kernel.as_deref().and_then(|kernel| better_kernel(kernel, Vectors::of_processor())),
        selectable: config.split_whitespace().any(|word| word == "DYNAMIC_ARCH"),
        kernel,
        ..*blas
    }
}

fn threads(process: &Library, kind: &Kind) -> Option<usize> {
    // SAFETY (both): the symbols are the libraries' documented functions, which take nothing and return the number of
    // threads as a C int (OpenBLAS, MKL) or as a 64-bit integer (BLIS).
    let count = if kind.counts_in_64_bits {
        // SAFETY: see above.
        let get = unsafe { process.get::<unsafe extern "C" fn() -> i64>(kind.get_threads) }.ok()?;
        // SAFETY: see above.
        unsafe { get() }
    } else {
        // SAFETY: see above.
        let get = unsafe { process.get::<unsafe extern "C" fn() -> c_int>(kind.get_threads) }.ok()?;
        // SAFETY: see above.
        i64::from(unsafe { get() })
    };
    // BLIS returns -1 if no number was set; it uses one thread then.
    Some(usize::try_from(count).unwrap_or(1).max(1))
}

/// Returns the name of the processor that BLIS has detected.
fn blis_kernel(process: &Library) -> Option<String> {
    // SAFETY (all): the symbols are documented functions of BLIS; an architecture is an enumeration, a C int, and its
    // name a string that is never freed.
    // SAFETY: see above.
    let id = unsafe { process.get::<unsafe extern "C" fn() -> c_int>(b"bli_arch_query_id\0") }.ok()?;
    // SAFETY: see above.
    let name = unsafe { process.get::<unsafe extern "C" fn(c_int) -> *const c_char>(b"bli_arch_string\0") }.ok()?;
    // SAFETY: see above.
    owned(unsafe { name(id()) })
}

/// Calls the function `symbol`, which takes nothing and returns a string that is never freed.
fn text(process: &Library, symbol: &[u8]) -> Option<String> {
    // SAFETY: the callers pass documented functions with this signature.
    let tell = unsafe { process.get::<unsafe extern "C" fn() -> *const c_char>(symbol) }.ok()?;
    // SAFETY: see above.
    owned(unsafe { tell() })
}

fn owned(text: *const c_char) -> Option<String> {
    // SAFETY: a pointer that is not null points to a zero-terminated string that is never freed.
    (!text.is_null()).then(|| unsafe { CStr::from_ptr(text) }.to_string_lossy().trim().to_string())
}
