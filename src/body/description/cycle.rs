//! The load cycle whose slip and stresses are recorded.

use crate::base::input_error::{InputError, ensure, finite};

/// The choice of a load cycle.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum CycleChoice {
    /// The last cycle. It ends with the last increment in which a load changes, and begins at the last earlier increment at
    /// which all loads had the same values and, just before, changed in the same proportions.
    Last,
    /// The times of its beginning and its end, s.
    Between([f64; 2]),
}

/// A load cycle whose slip and stresses are recorded.
#[derive(Debug, Clone, Copy, PartialEq)]
#[non_exhaustive]
pub struct CycleRequest {
    /// The cycle.
    pub choice: CycleChoice,
    /// Archard's coefficient k, 1/Pa: the wear depth is k times the integral of the pressure over the slip path. `None` if
    /// no wear depth is wanted.
    pub wear_coefficient: Option<f64>,
}

impl CycleRequest {
    /// Creates the request of a cycle.
    ///
    /// # Errors
    /// [`InputError`] if the times of the cycle do not increase from 0, or if the coefficient is not positive.
    pub fn new(choice: CycleChoice, wear_coefficient: Option<f64>) -> Result<Self, InputError> {
        if let CycleChoice::Between(times) = choice {
            let [start, end] = times;
            if !(start >= 0.0 && start < end && end.is_finite()) {
                let help = "give the times of the beginning and the end of the cycle, s, or \"last\"";
                return Err(InputError::new("cycle", format!("cycle is {times:?}, but times increase from 0"), help));
            }
        }
        if let Some(k) = wear_coefficient {
            finite("wear_coefficient", k)?;
            let help = "the wear depth is this times the integral of the pressure over the slip path";
            ensure(k > 0.0, "wear_coefficient", &k, "above 0", help)?;
        }
        Ok(CycleRequest { choice, wear_coefficient })
    }
}
