//! A history as curves, gathered while it goes on.

use serde::{Deserialize, Serialize};

use super::resultant::ForceRecord;
use super::thinned::Thinned;
use crate::history::{IncrementRecord, Status};

/// What the charts of a history show, gathered while it goes on.
#[derive(Debug, Clone, PartialEq, Default, Serialize, Deserialize)]
pub struct HistoryCurves {
    pub(super) increments: usize,
    pub(super) boundaries: Vec<ForceCurves>,
    pub(super) iterations: Thinned,
    pub(super) backtracks: Thinned,
    pub(super) failed: Thinned,
    pub(super) halved: Thinned,
    pub(super) rescued: Thinned,
}

/// The forces at a boundary.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub(super) struct ForceCurves {
    pub(super) boundary: String,
    /// The boundary in front of it, if that is one.
    pub(super) opposite: Option<String>,
    /// Each component over time, N.
    pub(super) components: Vec<Thinned>,
}

impl HistoryCurves {
    /// Takes in an increment, and the forces at its end if it converged.
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
            let place = known.unwrap_or_else(|| {
                self.boundaries.push(ForceCurves {
                    boundary: resultant.boundary.clone(),
                    opposite: resultant.opposite.as_ref().map(|of| of.boundary.clone()),
                    components: vec![Thinned::default(); resultant.force.len()],
                });
                self.boundaries.len() - 1
            });
            let components = &mut self.boundaries[place].components;
            components.iter_mut().zip(&resultant.force).for_each(|(curve, force)| curve.push([*time, *force]));
        }
    }
}
