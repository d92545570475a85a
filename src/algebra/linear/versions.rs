//! A check that the loaded SuiteSparse is the one whose headers were compiled in. Structures and array layouts are
//! those of the headers ([`super::sys`]). Another version may have a different layout and would write to wrong
//! places.

#![allow(unsafe_code)]

use std::ffi::c_int;
use std::sync::OnceLock;

use libloading::os::unix::Library;

use super::{Computed, LinearError, sys};

/// A version, `[main, sub, subsub]`.
type Version = [i32; 3];

/// The number of version parts that must agree if only statuses and arrays of fixed length are shared.
const MAIN: usize = 1;
/// The number that must agree if structures are shared: `cholmod_common` has grown within one main version of
/// CHOLMOD.
const MAIN_AND_SUB: usize = 2;

/// Returns an error if the loaded SuiteSparse is not that of the headers. Checked once, before any other call.
///
/// # Errors
/// [`LinearError::Version`].
pub(super) fn agree() -> Computed<()> {
    static AGREE: OnceLock<Computed<()>> = OnceLock::new();
    AGREE
        .get_or_init(|| {
            compare("SuiteSparse", MAIN, suitesparse_headers(), suitesparse_version())?;
            compare("CHOLMOD", MAIN_AND_SUB, cholmod_headers(), cholmod_loaded())?;
            // Before 6, UMFPACK has no such function; the version of SuiteSparse is used instead.
            umfpack_loaded().map_or(Ok(()), |loaded| compare("UMFPACK", MAIN, umfpack_version(), loaded))
        })
        .clone()
}

/// Returns an error unless the first `count` parts of both versions agree.
fn compare(library: &'static str, count: usize, built: Version, loaded: Version) -> Computed<()> {
    if built[..count] == loaded[..count] { Ok(()) } else { Err(LinearError::Version { library, built, loaded }) }
}

/// Converts a version from the headers, where bindgen has unsigned numbers.
const fn of_headers([main, sub, subsub]: [u32; 3]) -> Version {
    [main as i32, sub as i32, subsub as i32]
}

fn suitesparse_headers() -> Version {
    of_headers([sys::SUITESPARSE_MAIN_VERSION, sys::SUITESPARSE_SUB_VERSION, sys::SUITESPARSE_SUBSUB_VERSION])
}

fn cholmod_headers() -> Version {
    of_headers([sys::CHOLMOD_MAIN_VERSION, sys::CHOLMOD_SUB_VERSION, sys::CHOLMOD_SUBSUB_VERSION])
}

/// Returns the version of UMFPACK whose headers were compiled in, `[main, sub, subsub]`.
pub fn umfpack_version() -> [i32; 3] {
    of_headers([sys::UMFPACK_MAIN_VERSION, sys::UMFPACK_SUB_VERSION, sys::UMFPACK_SUBSUB_VERSION])
}

/// Returns the version of the loaded SuiteSparse library, `[main, sub, subsub]`.
pub fn suitesparse_version() -> [i32; 3] {
    let mut version = [0; 3];
    // SAFETY: the call writes three integers.
    unsafe { sys::SuiteSparse_version(version.as_mut_ptr()) };
    version
}

fn cholmod_loaded() -> Version {
    let mut version = [0; 3];
    // SAFETY: the call writes three integers.
    unsafe { sys::cholmod_l_version(version.as_mut_ptr()) };
    version
}

/// Returns the version of the loaded UMFPACK, if it has a function for it.
fn umfpack_loaded() -> Option<Version> {
    let process = Library::this();
    // SAFETY: this is a documented function of UMFPACK, which takes an array of three integers and returns nothing.
    let tell = unsafe { process.get::<unsafe extern "C" fn(*mut c_int)>(b"umfpack_version\0") }.ok()?;
    let mut version = [0; 3];
    // SAFETY: the call writes three integers.
    unsafe { tell(version.as_mut_ptr()) };
    Some(version)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_must_agree_is_compared_and_no_more() {
        for (count, built, loaded, same) in [
            (MAIN, [5, 12, 0], [5, 12, 0], true),
            (MAIN, [5, 12, 0], [5, 4, 1], true),
            (MAIN, [5, 12, 0], [7, 12, 0], false),
            (MAIN, [7, 10, 1], [5, 10, 1], false),
            (MAIN_AND_SUB, [5, 3, 1], [5, 3, 0], true),
            (MAIN_AND_SUB, [5, 3, 1], [5, 1, 1], false),
            (MAIN_AND_SUB, [5, 3, 1], [3, 3, 1], false),
        ] {
            let found = compare("X", count, built, loaded);
            let expected = if same { Ok(()) } else { Err(LinearError::Version { library: "X", built, loaded }) };
            assert_eq!(found, expected, "{built:?} and {loaded:?}");
        }
    }

    #[test]
    fn the_error_tells_both_versions_and_the_cure() {
        let error = compare("CHOLMOD", MAIN_AND_SUB, [5, 3, 1], [5, 1, 0]).unwrap_err().to_string();
        for part in ["CHOLMOD 5.1.0 is loaded", "built with the headers of 5.3.1", "LD_LIBRARY_PATH"] {
            assert!(error.contains(part), "{error}");
        }
    }

    #[test]
    fn the_library_of_this_machine_is_that_of_its_headers() {
        assert_eq!(suitesparse_version(), suitesparse_headers());
        assert_eq!(cholmod_loaded(), cholmod_headers());
        assert_eq!(umfpack_loaded().unwrap_or(umfpack_version()), umfpack_version());
        assert_eq!(agree(), Ok(()));
    }
}
