//! A linearisation that is put away, and written again to the last bit.

use serde::{Deserialize, Serialize};

use super::{Bdiff, Case};

/// The cases of the last linearisation, and the friction that its slip rows have. Coefficients of slip that hardly turns are
/// kept from one linearisation to the next, so that no `z` tells them.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Linearization {
    cases: Vec<Option<Case>>,
    mu: Vec<f64>,
}

impl Bdiff {
    /// The last linearisation.
    pub fn linearization(&self) -> Linearization {
        Linearization { cases: self.cases.clone(), mu: self.data.mu.to_vec() }
    }

    /// Linearises as it was; whether that is one of this problem.
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
            self.tie_unheld_motions();
        }
        true
    }
}
