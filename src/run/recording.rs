//! Results as arrays, at the ends of increments.

use serde::{Deserialize, Serialize};

use crate::solver::history::{IncrementRecord, IncrementView, Observer};
use crate::solver::laws::ContactStatus;
use crate::solver::problem::{Increment, State};
use std::ops::ControlFlow;

/// An [`Observer`] that keeps the increments of a history as plain data.
#[derive(Debug, Clone, Default, PartialEq, Serialize)]
#[non_exhaustive]
pub struct Recording {
    /// `true` if only the last increment is kept.
    #[serde(skip)]
    only_last: bool,
    /// The increments that were reached, in order; one that does not converge is the last of them.
    pub increments: Vec<RecordedIncrement>,
}

/// An increment with its data and its result, SI units throughout.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[non_exhaustive]
pub struct RecordedIncrement {
    /// Number, time, verdict, errors, counts.
    #[serde(flatten)]
    pub record: IncrementRecord,
    /// The final state: `u` and `u_rest` (n_u, m), `p_n`, `p_t` and `p_o` (n_c, N).
    #[serde(flatten)]
    pub state: State,
    /// The status of each contact node, n_c.
    pub statuses: Vec<ContactStatus>,
    /// `f`, external nodal forces, n_u, N.
    pub force: Vec<f64>,
    /// `g`, gaps, n_c, m.
    pub gap: Vec<f64>,
    /// `μ`, friction coefficients, n_c.
    pub mu: Vec<f64>,
    /// `w̄_t`, tangential displacements at the beginning of the increment, or of its last substep if it was halved,
    /// n_c, m.
    pub w_t_last: Vec<f64>,
    /// `w̄_o`, the same displacements along the other tangent, n_c, m.
    pub w_o_last: Vec<f64>,
}

impl Recording {
    /// Creates a recording of every increment.
    pub fn all() -> Self {
        Recording::default()
    }

    /// Creates a recording of the last increment that is reached.
    pub fn last() -> Self {
        Recording { only_last: true, increments: Vec::new() }
    }

    /// Returns the states at the ends of the recorded increments.
    pub fn states(&self) -> impl Iterator<Item = &State> {
        self.increments.iter().map(|increment| &increment.state)
    }
}

impl Observer for Recording {
    fn increment(&mut self, step: &IncrementView<'_>) -> ControlFlow<()> {
        if self.only_last {
            self.increments.clear();
        }
        self.increments.push(RecordedIncrement::new(step));
        ControlFlow::Continue(())
    }
}

impl RecordedIncrement {
    /// Copies the data shown to an observer.
    pub fn new(step: &IncrementView<'_>) -> Self {
        let Increment { force, gap, mu, w_t_last, w_o_last } = *step.increment;
        RecordedIncrement {
            record: step.record.clone(),
            state: step.state.clone(),
            statuses: step.statuses.to_vec(),
            force: force.to_vec(),
            gap: gap.to_vec(),
            mu: mu.to_vec(),
            w_t_last: w_t_last.to_vec(),
            w_o_last: w_o_last.to_vec(),
        }
    }

    /// Restores the view shown to an observer. `data` is [`RecordedIncrement::data`].
    pub fn step<'a>(&'a self, data: &'a Increment<'a>) -> IncrementView<'a> {
        IncrementView { record: &self.record, increment: data, state: &self.state, statuses: &self.statuses }
    }

    /// Returns the data of the increment, in the form for [`crate::solver::laws::KktErrors::measure`].
    pub fn data(&self) -> Increment<'_> {
        let RecordedIncrement { force, gap, mu, w_t_last, w_o_last, .. } = self;
        Increment { force, gap, mu, w_t_last, w_o_last }
    }
}
