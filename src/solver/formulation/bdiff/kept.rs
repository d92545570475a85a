//! Snapshots of a linearisation, restored to the last bit.

use serde::{Deserialize, Serialize};

use super::{Bdiff, Case};

/// The cases of the last linearisation and the friction coefficients of its slip rows. Slip coefficients are reused
/// while the slip direction changes little, so they cannot be reconstructed from `z`.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Linearization {
    cases: Vec<Option<Case>>,
    mu: Vec<f64>,
}

impl Bdiff {
    /// Returns a snapshot of the last linearisation.
    pub fn linearization(&self) -> Linearization {
        Linearization { cases: self.cases.clone(), mu: self.data.mu.to_vec() }
    }

    /// Restores a linearisation from a snapshot. Returns `false` if the snapshot belongs to another problem.
    pub fn linearize_as(&mut self, kept: &Linearization) -> bool {
        let contacts = self.layout().contacts();
        let has_friction = |i: usize| self.layout().has_friction(i);
        let fits = |(i, case): (usize, &Option<Case>)| case.is_none_or(|(_, case)| case.is_some() == has_friction(i));
        if [kept.cases.len(), kept.mu.len()] != [contacts; 2] || !kept.cases.iter().enumerate().all(fits) {
            return false;
        }
        self.data.mu = kept.mu.clone().into();
        self.cases.fill(None);
        self.matrix.release();
        for (i, case) in kept.cases.iter().enumerate() {
            if let Some(case) = case {
                self.write_rows(i, *case);
            }
        }
        if kept.cases.iter().any(Option::is_some) {
            self.pin_unconstrained_modes();
        }
        true
    }
}
