//! The start of PETSc, its options, and its errors.

#![allow(unsafe_code)]

use std::ffi::{CStr, CString, c_char, c_int, c_void};
use std::ptr;
use std::sync::{Mutex, OnceLock, PoisonError};

use stickslip::algebra::linear::LinearError;

use super::sys;

/// The message of the last error.
static MESSAGE: Mutex<String> = Mutex::new(String::new());

static STARTED: OnceLock<Result<(), LinearError>> = OnceLock::new();

/// Starts PETSc, once, and replaces the options that it has by these, unless they are empty. All ranks must call it, with
/// the same ones.
pub(crate) fn start(options: &str) -> Result<(), LinearError> {
    const STEP: &str = "its options";
    STARTED.get_or_init(first).clone()?;
    let text = CString::new(options).unwrap_or_default();
    if text.is_empty() {
        return Ok(());
    }
    // SAFETY: PETSc runs, and copies the text.
    unsafe {
        check(STEP, sys::PetscOptionsClear(ptr::null_mut()))?;
        check(STEP, sys::PetscOptionsInsertString(ptr::null_mut(), text.as_ptr()))?;
        if has(c"-log_view")? { check(STEP, sys::PetscLogDefaultBegin()) } else { Ok(()) }
    }
}

/// Returns `true` if there is an option of this name.
pub(crate) fn has(name: &CStr) -> Result<bool, LinearError> {
    let mut is_set = sys::PetscBool_PETSC_FALSE;
    let (options, prefix) = (ptr::null_mut(), ptr::null());
    // SAFETY: PETSc runs, and the name is a C string.
    check("its options", unsafe { sys::PetscOptionsHasName(options, prefix, name.as_ptr(), &raw mut is_set) })?;
    Ok(is_set == sys::PetscBool_PETSC_TRUE)
}

/// Ends PETSc, if it runs; `-log_view` then prints.
pub(crate) fn end() {
    if STARTED.get().is_some_and(Result::is_ok) {
        // SAFETY: PETSc runs, and this is the last call. There is nobody left to tell an error to.
        unsafe { sys::PetscFinalize() };
    }
}

fn first() -> Result<(), LinearError> {
    const STEP: &str = "its start";
    const BUILT: [i32; 3] =
        [sys::PETSC_VERSION_MAJOR as i32, sys::PETSC_VERSION_MINOR as i32, sys::PETSC_VERSION_SUBMINOR as i32];
    let mut loaded = [0; 4];
    let [major, minor, sub, release] = &mut loaded;
    // SAFETY: the version may be asked for at any time, and is written to four places.
    check(STEP, unsafe { sys::PetscGetVersionNumber(major, minor, sub, release) })?;
    if loaded[..2] != BUILT[..2] {
        let [major, minor, sub, _] = loaded;
        return Err(LinearError::Version { library: "PETSc", built: BUILT, loaded: [major, minor, sub] });
    }
    // SAFETY: MPI runs, and PETSc uses it unchanged. Options are copied.
    unsafe {
        let (name, value) = (c"-no_signal_handler".as_ptr(), c"true".as_ptr());
        check(STEP, sys::PetscOptionsSetValue(ptr::null_mut(), name, value))?;
        check(STEP, sys::PetscInitializeNoArguments())?;
        check(STEP, sys::PetscPushErrorHandler(Some(keep), ptr::null_mut()))
    }
}

/// Keeps the message of an error for [`check`], and prints nothing.
unsafe extern "C" fn keep(
    _: sys::MPI_Comm,
    _: c_int,
    _: *const c_char,
    _: *const c_char,
    status: sys::PetscErrorCode,
    kind: sys::PetscErrorType,
    message: *const c_char,
    _: *mut c_void,
) -> sys::PetscErrorCode {
    if kind == sys::PetscErrorType_PETSC_ERROR_INITIAL && !message.is_null() {
        // SAFETY: PETSc passes a C string.
        let text = unsafe { CStr::from_ptr(message) }.to_string_lossy().into_owned();
        *MESSAGE.lock().unwrap_or_else(PoisonError::into_inner) = text;
    }
    status
}

/// Converts the status of a call to an error with the option that helps.
pub(super) fn check(step: &'static str, status: sys::PetscErrorCode) -> Result<(), LinearError> {
    // The codes of PETSc; the first is that of refused memory. Where the system refuses memory, PETSc 3.18 returns other
    // numbers.
    const CODES: std::ops::RangeInclusive<i64> = 55..=99;
    const NO_SUCH_TYPE: i64 = 86;
    let status = i64::from(status);
    if status == 0 {
        return Ok(());
    }
    let message = std::mem::take(&mut *MESSAGE.lock().unwrap_or_else(PoisonError::into_inner));
    let help = match status {
        status if status == *CODES.start() || !CODES.contains(&status) => {
            return Err(LinearError::OutOfMemory { step });
        }
        NO_SUCH_TYPE => "correct the type in solver.petsc: PETSc's manual lists them",
        _ => "correct solver.petsc, or leave it out",
    };
    let reason = message.lines().next().unwrap_or("").trim().to_string();
    let reason = format!("{reason} (status {status})").trim_start().to_string();
    Err(LinearError::Engine { engine: "PETSc", step, reason, help })
}
