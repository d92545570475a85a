//! Checks of the arrays of a problem, which name the array and the cure.

use stickslip::base::InputError;

/// Returns an error unless the dimension is 2 or 3.
pub(crate) fn expect_dimension(dimension: usize) -> Result<(), InputError> {
    if matches!(dimension, 2 | 3) {
        return Ok(());
    }
    Err(InputError::new("dimension", format!("it is {dimension}"), "the dimension is 2 in the plane, 3 in space"))
}

/// Returns an error unless the array `key` has the `expected` number of what is counted.
pub(crate) fn expect_size(key: &str, what: &str, expected: usize, found: usize, help: &str) -> Result<(), InputError> {
    if expected == found {
        return Ok(());
    }
    Err(InputError::new(key, format!("it has {found} {what}, but must have {expected}"), help))
}

/// Returns an error unless all `values` of the array `key` are finite.
pub(crate) fn expect_finite(key: &str, values: &[f64]) -> Result<(), InputError> {
    let Some(place) = values.iter().position(|value| !value.is_finite()) else { return Ok(()) };
    let message = format!("entry {place} is {}, but must be finite", values[place]);
    Err(InputError::new(key, message, "give a number other than nan or inf"))
}

/// Returns an error unless all coefficients of friction are finite, and none is negative.
pub(crate) fn expect_friction(mu: &[f64]) -> Result<(), InputError> {
    expect_finite("mu", mu)?;
    let Some(place) = mu.iter().position(|mu| *mu < 0.0) else { return Ok(()) };
    Err(InputError::new("mu", format!("entry {place} is {}", mu[place]), "a coefficient of friction is 0 or more"))
}
