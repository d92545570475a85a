//! What is wrong with an input, told by the key of it.

use std::fmt::Debug;

/// A value that cannot be used.
///
/// Keys are those of a scene file, such as `contact[0].friction` (lists count from 0), also for what was put together
/// from Rust.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error, miette::Diagnostic)]
#[error("{key}: {message}")]
#[diagnostic(help("{help}"))]
pub struct InputError {
    /// The path of the value that is wrong.
    pub key: String,
    /// What is wrong with it.
    pub message: String,
    /// What mends the fault.
    pub help: String,
}

impl InputError {
    /// The fault of the value at `key`.
    pub fn new(key: impl Into<String>, message: impl Into<String>, help: impl Into<String>) -> Self {
        InputError { key: key.into(), message: message.into(), help: help.into() }
    }

    /// The same fault of a number that was converted to SI units.
    #[must_use]
    pub fn in_si(self) -> Self {
        InputError { message: format!("in SI units {}", self.message), ..self }
    }

    /// The same fault, told by whom holds the value under `parent`.
    #[must_use]
    pub fn with_key(self, parent: &str) -> Self {
        InputError { key: format!("{parent}.{}", self.key), ..self }
    }
}

/// Fails unless `sound`, saying what the `value` of `key` is and what it must be.
///
/// # Errors
/// [`InputError`] of `key`.
pub fn ensure(sound: bool, key: &str, value: &impl Debug, must: &str, help: &str) -> Result<(), InputError> {
    if sound {
        return Ok(());
    }
    Err(InputError::new(key, format!("{key} is {value:?}, but must be {must}"), help))
}

/// Numbers beyond this are refused: up to it the square of a product of three of them is finite.
const LARGEST: f64 = 1e50;

/// Fails unless the `value` of `key` is finite, and not so large that what is computed from it overflows.
///
/// # Errors
/// [`InputError`] of `key`.
pub fn finite(key: &str, value: f64) -> Result<(), InputError> {
    ensure(value.is_finite(), key, &value, "a finite number", "give a number other than nan or inf")?;
    not_huge(key, [value])
}

/// Fails unless the `value` of `key` is above 0, and neither so large nor so small that what is computed from it is lost.
///
/// # Errors
/// [`InputError`] of `key`.
pub fn positive(key: &str, value: f64, help: &str) -> Result<(), InputError> {
    finite(key, value)?;
    ensure(value > 0.0, key, &value, "positive", help)?;
    ensure(value >= 1.0 / LARGEST, key, &value, "1e-50 or more, so that products of it are not lost", help)
}

/// Fails if one of the `numbers` at `key` is so large that what is computed from it overflows.
///
/// # Errors
/// [`InputError`] of `key`.
pub fn not_huge(key: &str, numbers: impl IntoIterator<Item = f64>) -> Result<(), InputError> {
    match numbers.into_iter().find(|x| x.is_finite() && x.abs() > LARGEST) {
        None => Ok(()),
        Some(x) => {
            let message = format!("{key} has the number {x:e}, but products of numbers beyond {LARGEST:e} overflow");
            Err(InputError::new(key, message, "give numbers in SI units or as [units] says, and smaller ones"))
        }
    }
}
