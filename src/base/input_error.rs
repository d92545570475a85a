//! The error of an invalid input, with the key of the value.

use std::fmt::Debug;

/// An invalid value of an input.
///
/// Keys are those of a scene file, such as `contact[0].friction` (lists count from 0), also for descriptions built in
/// Rust.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error, miette::Diagnostic)]
#[error("{key}: {message}")]
#[diagnostic(help("{help}"))]
pub struct InputError {
    /// The key of the invalid value.
    pub key: String,
    /// The description of the error.
    pub message: String,
    /// The advice for correcting it.
    pub help: String,
}

impl InputError {
    /// Creates the error of the value at `key`.
    pub fn new(key: impl Into<String>, message: impl Into<String>, help: impl Into<String>) -> Self {
        InputError { key: key.into(), message: message.into(), help: help.into() }
    }

    /// Prefixes the key with `parent`, the key of the containing value, which an empty key stands for.
    #[must_use]
    pub fn with_key(self, parent: &str) -> Self {
        let key = if self.key.is_empty() { parent.to_string() } else { format!("{parent}.{}", self.key) };
        InputError { key, ..self }
    }
}

/// Takes each entry of a `list` with its number; an error names its key.
///
/// # Errors
/// The first one of `take`.
pub(crate) fn each<T, U>(
    list: &str,
    all: impl IntoIterator<Item = T>,
    mut take: impl FnMut(usize, T) -> Result<U, InputError>,
) -> Result<Vec<U>, InputError> {
    let one = |(k, entry)| take(k, entry).map_err(|fault| fault.with_key(&format!("{list}[{k}]")));
    all.into_iter().enumerate().map(one).collect()
}

/// Returns an error unless `is_valid`, with the `value` of `key` and the condition `must`.
///
/// # Errors
/// [`InputError`] of `key`.
pub(crate) fn ensure(is_valid: bool, key: &str, value: &impl Debug, must: &str, help: &str) -> Result<(), InputError> {
    if is_valid {
        return Ok(());
    }
    Err(InputError::new(key, format!("{key} is {value:?}, but must be {must}"), help))
}

/// Returns an error of the key `name` unless the `name` of a thing is a text in one line.
///
/// # Errors
/// [`InputError`] of `name`.
pub(crate) fn in_one_line(thing: &str, name: &str, help: &str) -> Result<(), InputError> {
    if !name.trim().is_empty() && !name.contains(char::is_control) {
        return Ok(());
    }
    let message = format!("the name of {thing} is {name:?}, but must be a text in one line");
    Err(InputError::new("name", message, help))
}

/// The largest admissible number. The square of a product of three such numbers is finite.
const LARGEST: f64 = 1e50;

/// Returns an error unless the `value` of `key` is finite, and small enough that computations with it do not
/// overflow.
///
/// # Errors
/// [`InputError`] of `key`.
pub fn finite(key: &str, value: f64) -> Result<(), InputError> {
    ensure(value.is_finite(), key, &value, "a finite number", "give a number other than nan or inf")?;
    not_huge(key, [value])
}

/// Returns an error unless the `value` of `key` is positive, and neither too large nor too small for computations
/// with it.
///
/// # Errors
/// [`InputError`] of `key`.
pub fn positive(key: &str, value: f64, help: &str) -> Result<(), InputError> {
    finite(key, value)?;
    ensure(value > 0.0, key, &value, "positive", help)?;
    ensure(value >= 1.0 / LARGEST, key, &value, "1e-50 or more, so that products of it are not lost", help)
}

/// Returns an error if one of the `numbers` at `key` is so large that computations with it overflow.
///
/// # Errors
/// [`InputError`] of `key`.
pub(crate) fn not_huge(key: &str, numbers: impl IntoIterator<Item = f64>) -> Result<(), InputError> {
    match numbers.into_iter().find(|x| x.is_finite() && x.abs() > LARGEST) {
        None => Ok(()),
        Some(x) => {
            let message = format!("{key} has the number {x:e}, but products of numbers beyond {LARGEST:e} overflow");
            Err(InputError::new(key, message, "give numbers in SI units or as [units] says, and smaller ones"))
        }
    }
}
