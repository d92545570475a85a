//! Corrections of gaps that are not proportional to a motion.

use std::ops::Range;

use super::PER_NODE;
use crate::solver::problem::ProblemError;
use crate::solver::problem::error::{expect_finite, expect_increasing, expect_length};

/// The difference between the gaps and those from the rates of a [`super::Motion`], for example if a round obstacle
/// passes, an oblique one turns, or another one comes nearer.
#[derive(Debug, Clone, PartialEq)]
pub struct GapCorrection {
    pub(super) nodes: Range<usize>,
    pub(super) times: Vec<f64>,
    pub(super) gap: Vec<Vec<f64>>,
    /// The correction of the surface's motion along both tangents; empty if there is none.
    pub(super) drift: Vec<Vec<[f64; 2]>>,
}

impl GapCorrection {
    /// Creates a correction of the gaps of the contact nodes `nodes`, m: a row of `gap` for each of the `times` (s),
    /// linear between them and constant outside.
    ///
    /// # Errors
    /// If there is not a row for each time and a number for each node, if a number is not finite, or if the times do
    /// not increase.
    pub fn new(nodes: Range<usize>, times: Vec<f64>, gap: Vec<Vec<f64>>) -> Result<Self, ProblemError> {
        expect_length("gap", times.len(), gap.len(), "one row for each time")?;
        expect_finite("times", &times)?;
        expect_increasing("times", times.iter().copied())?;
        for (k, row) in gap.iter().enumerate() {
            let name = format!("gap[{k}]");
            expect_length(&name, nodes.len(), row.len(), PER_NODE)?;
            expect_finite(&name, row)?;
        }
        Ok(GapCorrection { nodes, times, gap, drift: Vec::new() })
    }

    /// Adds a correction of the surface's motion along both tangents, m: a row of `drift` for each time.
    ///
    /// # Errors
    /// If there is not a row for each time and a pair for each node, or if a number is not finite.
    pub fn with_drift(self, drift: Vec<Vec<[f64; 2]>>) -> Result<Self, ProblemError> {
        expect_length("drift", self.times.len(), drift.len(), "one row for each time")?;
        for (k, row) in drift.iter().enumerate() {
            let name = format!("drift[{k}]");
            expect_length(&name, self.nodes.len(), row.len(), PER_NODE)?;
            expect_finite(&name, row.as_flattened())?;
        }
        Ok(GapCorrection { drift, ..self })
    }

    /// Returns the times, s.
    pub fn times(&self) -> &[f64] {
        &self.times
    }

    /// Estimates the largest distance of the true gaps from their linear interpolation, m, from the interpolated
    /// values at three consecutive times. The `kinks` (s), at which rates change, are excluded.
    pub(crate) fn off_the_chords(&self, kinks: &[f64]) -> f64 {
        let off = |k: usize| {
            let [before, at, after] = [k - 1, k, k + 1].map(|k| self.times[k]);
            if kinks.contains(&at) {
                return 0.0;
            }
            let share = (at - before) / (after - before);
            // The distance from the chord over both intervals is g'' (at - before) (after - at) / 2, that from the
            // chord over one g'' h² / 8.
            let longest = (at - before).max(after - at);
            let of_one = longest * longest / (4.0 * (at - before) * (after - at));
            let of_node = |i: usize| {
                let [before, at, after] = [k - 1, k, k + 1].map(|k| self.gap[k][i]);
                (at - before - share * (after - before)).abs()
            };
            of_one * (0..self.nodes.len()).map(of_node).fold(0.0, f64::max)
        };
        (1..self.times.len().saturating_sub(1)).map(off).fold(0.0, f64::max)
    }

    /// Adds the correction at time `t` to the `gap` of its nodes.
    pub(super) fn add(&self, t: f64, gap: &mut [f64]) {
        let Some((k, share)) = self.interval(t) else { return };
        for (i, g) in gap.iter_mut().enumerate() {
            *g += between(share, self.gap[k][i], || self.gap[k + 1][i]);
        }
    }

    /// Adds the correction at time `t` to the `drift` of its nodes along their first (`axis` = 0) or second tangents.
    pub(super) fn add_drift(&self, t: f64, axis: usize, drift: &mut [f64]) {
        let Some((k, share)) = self.interval(t).filter(|_| !self.drift.is_empty()) else { return };
        for (i, d) in drift.iter_mut().enumerate() {
            *d += between(share, self.drift[k][i][axis], || self.drift[k + 1][i][axis]);
        }
    }

    /// Returns the index of the row before time `t`, and the share of the interval up to `t`.
    fn interval(&self, t: f64) -> Option<(usize, f64)> {
        let last = self.times.len().checked_sub(1)?;
        let after = self.times.partition_point(|time| *time <= t);
        Some(match (after.checked_sub(1), self.times.get(after)) {
            (Some(k), Some(next)) => (k, (t - self.times[k]) / (next - self.times[k])),
            (Some(_), None) => (last, 0.0),
            (None, _) => (0, 0.0),
        })
    }
}

/// Interpolates between `here` and the next value.
fn between(share: f64, here: f64, next: impl Fn() -> f64) -> f64 {
    if share > 0.0 { here + share * (next() - here) } else { here }
}
