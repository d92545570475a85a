//! A snapshot of an exact path between two steps.

use serde::{Deserialize, Serialize};

use super::node::{Given, NodalContact, NodeStatus};
use super::rate_problem::Effort;
use super::tangent::{Taken, Tangent};
use super::walk::ExactPath;
use crate::algebra::linear::{LinearError, Statistics};

/// The data from which an exact path continues.
#[derive(Clone, Serialize, Deserialize)]
pub(crate) struct SavedExactPath {
    corners: Vec<f64>,
    times: [f64; 2],
    given: Given,
    change: Given,
    share: f64,
    statuses: Vec<NodeStatus>,
    stuck: Vec<f64>,
    at: NodalContact,
    rate: NodalContact,
    decided: bool,
    hit: Vec<bool>,
    largest: [f64; 2],
    standstill: usize,
    effort: Effort,
    equations: Taken,
    statistics: Statistics,
}

impl SavedExactPath {
    /// Returns the statistics of the linear solver at the snapshot.
    pub(crate) fn statistics(&self) -> Statistics {
        self.statistics
    }

    /// Returns `true` if the snapshot has these numbers of displacements and contact nodes.
    fn fits(&self, displacements: usize, contacts: usize) -> bool {
        let given = |given: &Given| {
            given.force.len() == displacements && given.gap.len() == contacts && given.slide.len() == contacts
        };
        let contact = |contact: &NodalContact| {
            let NodalContact { w_n, w_t, p_n, p_t, u, u_rest, .. } = contact;
            // Rates that were never computed have no displacements.
            [w_n, w_t, p_n, p_t].iter().all(|values| values.len() == contacts)
                && [u, u_rest].iter().all(|values| [0, displacements].contains(&values.len()))
        };
        given(&self.given)
            && given(&self.change)
            && contact(&self.at)
            && self.at.u.len() == displacements
            && contact(&self.rate)
            && [self.statuses.len(), self.stuck.len(), self.hit.len()] == [contacts; 3]
            && [0, contacts].contains(&self.equations.statuses.len())
    }
}

impl ExactPath<'_> {
    /// Takes a snapshot of the path, from which it can continue later.
    pub(crate) fn save(&self) -> SavedExactPath {
        SavedExactPath {
            corners: self.stretch.corners.clone(),
            times: self.stretch.times,
            given: self.stretch.at.clone(),
            change: self.stretch.change.clone(),
            share: self.share,
            statuses: self.statuses.clone(),
            stuck: self.stuck.clone(),
            at: self.at.clone(),
            rate: self.rate.clone(),
            decided: self.decided,
            hit: self.hit.clone(),
            largest: self.largest,
            standstill: self.standstill,
            effort: self.effort,
            equations: self.equations.taken(),
            statistics: self.statistics(),
        }
    }

    /// Restores the path from a snapshot. Returns `false` if the snapshot belongs to another problem.
    ///
    /// # Errors
    /// If the linear solver fails.
    pub(crate) fn resume(&mut self, saved: SavedExactPath) -> Result<bool, LinearError> {
        if !saved.fits(self.at.u.len(), self.statuses.len()) || !self.equations.take_up(&saved.equations)? {
            return Ok(false);
        }
        (self.stretch.corners, self.stretch.times) = (saved.corners, saved.times);
        (self.stretch.at, self.stretch.change) = (saved.given, saved.change);
        (self.share, self.statuses, self.stuck) = (saved.share, saved.statuses, saved.stuck);
        (self.at, self.rate) = (saved.at, saved.rate);
        (self.decided, self.hit) = (saved.decided, saved.hit);
        (self.largest, self.standstill, self.effort) = (saved.largest, saved.standstill, saved.effort);
        Ok(true)
    }
}
