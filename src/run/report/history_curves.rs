//! The curves of a history for its charts, collected during the run.

use serde::{Deserialize, Serialize};

use super::resultant::ForceRecord;
use super::thinned::Thinned;
use crate::solver::history::{IncrementRecord, Status};

/// The curves of a history for its charts, collected during the run.
#[derive(Debug, Clone, PartialEq, Default, Serialize, Deserialize)]
#[non_exhaustive]
pub struct HistoryCurves {
    /// The number of increments so far.
    pub increments: usize,
    /// The forces at each boundary, or pair of boundaries.
    pub boundaries: Vec<ForceCurves>,
    /// Newton iterations by increment.
    pub iterations: Thinned,
    /// Backtracks by increment.
    pub backtracks: Thinned,
    /// The iterations of increments that did not converge.
    pub failed: Thinned,
    /// The iterations of increments that were halved.
    pub halved: Thinned,
    /// The iterations of increments that the interior point method solved in place of BN.
    pub rescued: Thinned,
}

/// The forces at a boundary.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[non_exhaustive]
pub struct ForceCurves {
    /// The name of the boundary.
    pub boundary: String,
    /// The opposing boundary, for a pair.
    pub opposite: Option<String>,
    /// Each component over time, N.
    pub components: Vec<Thinned>,
}

impl HistoryCurves {
    /// Adds an increment, and the forces at its end if it converged.
    pub fn add(&mut self, record: &IncrementRecord, forces: &[ForceRecord]) {
        self.increments += 1;
        let x = record.index as f64;
        let iterations = [x, record.iterations as f64];
        self.iterations.push(iterations);
        self.backtracks.push([x, record.backtracks as f64]);
        let marked = [
            (&mut self.failed, record.status != Status::Converged),
            (&mut self.halved, record.parts > 1),
            (&mut self.rescued, record.rescued),
        ];
        marked.into_iter().filter(|(_, is)| *is).for_each(|(curve, _)| curve.push(iterations));
        for ForceRecord { time, resultant, .. } in forces {
            let known = self.boundaries.iter().position(|of| of.boundary == resultant.boundary);
            let index = known.unwrap_or_else(|| {
                self.boundaries.push(ForceCurves {
                    boundary: resultant.boundary.clone(),
                    opposite: resultant.opposite.as_ref().map(|of| of.boundary.clone()),
                    components: vec![Thinned::default(); resultant.force.len()],
                });
                self.boundaries.len() - 1
            });
            let components = &mut self.boundaries[index].components;
            components.iter_mut().zip(&resultant.force).for_each(|(curve, force)| curve.push([*time, *force]));
        }
    }
}
