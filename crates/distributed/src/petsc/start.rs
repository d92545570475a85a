//! The start of PETSc, its options, and its errors.

#![allow(unsafe_code)]

use std::ffi::{CStr, CString, c_char, c_int, c_void};
use std::ptr;
use std::sync::{Mutex, OnceLock, PoisonError};

use stickslip::algebra::linear::LinearError;

use super::{call, sys};

/// The message of the last error.
static MESSAGE: Mutex<String> = Mutex::new(String::new());

/// The step that reads options.
pub(super) const OPTIONS: &str = "its options";

static STARTED: OnceLock<Result<(), LinearError>> = OnceLock::new();

/// The options that PETSc has: all its solvers have them in common.
static PRESENT: Mutex<String> = Mutex::new(String::new());

/// Starts PETSc, once, and replaces the options that it has by those of the environment and these, unless these are
/// empty or equal. All ranks must call it, with the same ones.
pub(crate) fn start(options: &str) -> Result<(), LinearError> {
    STARTED.get_or_init(first).clone()?;
    let environment = std::env::var("PETSC_OPTIONS").unwrap_or_default();
    let text = CString::new(format!("{environment} {options}")).unwrap_or_default();
    let mut present = PRESENT.lock().unwrap_or_else(PoisonError::into_inner);
    if options.is_empty() || *present == options {
        return Ok(());
    }
    call!(OPTIONS, PetscOptionsClear(ptr::null_mut()))?;
    call!(OPTIONS, PetscOptionsInsertString(ptr::null_mut(), text.as_ptr()))?;
    *present = options.to_string();
    if has(c"-log_view")? { call!(OPTIONS, PetscLogDefaultBegin()) } else { Ok(()) }
}

/// Returns `true` if there is an option of this name.
pub(crate) fn has(name: &CStr) -> Result<bool, LinearError> {
    let mut is_set = sys::PetscBool_PETSC_FALSE;
    call!(OPTIONS, PetscOptionsHasName(ptr::null_mut(), ptr::null(), name.as_ptr(), &raw mut is_set))?;
    Ok(is_set == sys::PetscBool_PETSC_TRUE)
}

/// Sets an option.
pub(crate) fn set(name: &CStr, value: &CStr) -> Result<(), LinearError> {
    call!(OPTIONS, PetscOptionsSetValue(ptr::null_mut(), name.as_ptr(), value.as_ptr()))
}

/// Returns an error unless PETSc has asked for each of these `options`.
pub(crate) fn check_options(options: &str) -> Result<(), LinearError> {
    /// The requests of PETSc at its start and its end.
    const LATER: [&str; 5] = ["help", "info", "log_", "malloc_", "options_"];
    let (mut wrong, is_later) = (Vec::new(), |name: &str| LATER.iter().any(|later| name.starts_with(later)));
    for name in options.split_whitespace().filter_map(|word| word.strip_prefix('-')).filter(|name| !is_later(name)) {
        let [text, option] = [name, &format!("-{name}")].map(|text| CString::new(text).unwrap_or_default());
        let mut is_used = sys::PetscBool_PETSC_FALSE;
        call!(OPTIONS, PetscOptionsUsed(ptr::null_mut(), text.as_ptr(), &raw mut is_used))?;
        // A negative value is no option, nor is one of a system whose options others have replaced. The question uses
        // the option.
        if is_used == sys::PetscBool_PETSC_FALSE && has(&option)? {
            wrong.push(name);
        }
    }
    if wrong.is_empty() {
        return Ok(());
    }
    let reason = format!("it does not know -{}, or the others leave it no use", wrong.join(", -"));
    let help = "correct or remove it in solver.petsc: -help prints the options that there are";
    Err(LinearError::Engine { engine: "PETSc", step: OPTIONS, reason, help, of_options: true })
}

/// Ends PETSc, if it runs; `-log_view` then prints.
pub(crate) fn end() {
    if STARTED.get().is_some_and(Result::is_ok) {
        // SAFETY: PETSc runs, and this is the last call. There is nobody left to tell an error to.
        unsafe { sys::PetscFinalize() };
    }
}

fn first() -> Result<(), LinearError> {
    set(c"-no_signal_handler", c"true")?;
    call!("its start", PetscInitializeNoArguments())?;
    call!("its start", PetscPushErrorHandler(Some(keep), ptr::null_mut()))
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
    // The codes of PETSc; the first is that of refused memory. Where the system refuses memory, PETSc 3.18 returns
    // other numbers.
    const CODES: std::ops::RangeInclusive<i64> = 55..=99;
    /// The errors of values: not built in, out of range, no type, or no factorisation.
    const WRONG: [i64; 4] = [56, 63, 86, 92];
    let status = i64::from(status);
    if status == 0 {
        return Ok(());
    }
    let message = std::mem::take(&mut *MESSAGE.lock().unwrap_or_else(PoisonError::into_inner));
    if status == *CODES.start() || !CODES.contains(&status) {
        return Err(LinearError::OutOfMemory { step });
    }
    let reason = format!("{} (status {status})", message.lines().next().unwrap_or("").trim());
    let of_options = step == OPTIONS || WRONG.contains(&status);
    let help = if of_options {
        "correct solver.petsc: PETSc's manual lists types and values, and -help prints the options"
    } else {
        "take other options in solver.petsc, or none"
    };
    Err(LinearError::Engine { engine: "PETSc", step, reason, help, of_options })
}
