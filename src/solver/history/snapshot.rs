//! What a method knows at the end of an increment, for the next one.

use serde::{Deserialize, Serialize};

use super::increment_error::IncrementErrors;
use crate::solver::formulation::Linearization;
use crate::solver::problem::State;

/// All that the next increment of a method depends on, beside the data: with it, it goes on to the last bit as if it had never
/// stopped.
#[derive(Debug, Clone, Default, Serialize, Deserialize)]
pub struct Snapshot {
    /// The state, of a method that has nothing else.
    pub(super) state: Option<State>,
    /// The unknowns, in the method's own units.
    pub(super) unknowns: Vec<f64>,
    /// What rounding leaves off them.
    pub(super) rest: Vec<f64>,
    /// From where to where the last increment went.
    pub(super) last: Option<[Vec<f64>; 2]>,
    /// What the increments have left.
    pub(super) errors: Option<IncrementErrors>,
    /// The last linearisation.
    pub(super) linearization: Option<Linearization>,
    /// Whether there are factors of it.
    pub(super) is_factored: bool,
    /// That of the method that rescues this one.
    pub(super) rescue: Option<Box<Snapshot>>,
}

impl Snapshot {
    /// That of a method which nothing but its state tells from a new one.
    pub fn of_state(state: State) -> Self {
        Snapshot { state: Some(state), ..Snapshot::default() }
    }

    /// The state of such a method.
    pub fn into_state(self) -> Option<State> {
        self.state
    }
}

/// Takes `kept` values over, if there are as many.
pub(super) fn take_over(values: &mut [f64], kept: &[f64]) -> bool {
    let fits = values.len() == kept.len();
    if fits {
        values.copy_from_slice(kept);
    }
    fits
}
