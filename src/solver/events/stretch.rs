//! The data along the path, one load segment after another.

use super::node::{Given, largest};
use crate::base::units::Scaling;
use crate::solver::loading::Loading;
use crate::solver::problem::ContactProblem;

/// A load segment: all data change at constant rates.
pub(super) struct Stretch<'a> {
    problem: &'a ContactProblem,
    loading: &'a Loading,
    scaling: Scaling,
    tangents: Vec<Option<usize>>,
    /// The times at which the rates change, in descending order.
    pub corners: Vec<f64>,
    /// The start and end of the segment, s; the end is infinite if the data change no more.
    pub times: [f64; 2],
    /// The data at the start.
    pub at: Given,
    /// The change of the data until the end.
    pub change: Given,
}

impl<'a> Stretch<'a> {
    /// Creates the segment of no duration in which the loads at t = 0 are applied in proportion. If there are none,
    /// creates the first segment after it.
    pub(super) fn first(
        problem: &'a ContactProblem,
        loading: &'a Loading,
        scaling: Scaling,
        tangents: Vec<Option<usize>>,
    ) -> Self {
        let mut corners = loading.corners();
        corners.reverse();
        let (times, at, change) = ([0.0; 2], Given::default(), Given::default());
        let mut stretch = Stretch { problem, loading, scaling, tangents, corners, times, at, change };
        let there = stretch.given(0.0);
        let apart = there.gap.iter().map(|gap| gap.max(0.0)).collect();
        stretch.at = Given { force: vec![0.0; there.force.len()], gap: apart, slide: there.slide.clone() };
        stretch.change = there.plus(-1.0, &stretch.at);
        if largest(&stretch.change.force) == 0.0 && largest(&stretch.change.gap) == 0.0 {
            stretch.next();
        }
        stretch
    }

    /// Advances to the segment up to the next corner, or to infinity if there is none.
    pub(super) fn next(&mut self) {
        let start = self.times[1];
        while self.corners.last().is_some_and(|corner| *corner <= start) {
            self.corners.pop();
        }
        // Beyond the last corner the data are constant.
        let end = self.corners.pop().unwrap_or(f64::INFINITY);
        self.at = self.given(start);
        self.change = self.given(if end.is_finite() { end } else { start }).plus(-1.0, &self.at);
        self.times = [start, end];
    }

    /// Shortens the segment to start at `time` (s).
    pub(super) fn begin_at(&mut self, time: f64) {
        if self.times[1].is_finite() {
            self.corners.push(self.times[1]);
        }
        self.times[1] = time;
        self.next();
    }

    /// Returns the time after this share of the segment, s.
    pub(super) fn time_at(&self, share: f64) -> f64 {
        let [start, end] = self.times;
        if end.is_infinite() || share == 0.0 {
            start
        } else if share == 1.0 {
            end
        } else {
            start + share * (end - start)
        }
    }

    /// Returns the data after this share of the segment.
    pub(super) fn given_at(&self, share: f64) -> Given {
        self.at.plus(share, &self.change)
    }

    /// Returns the data at a time, in the units of the path.
    fn given(&self, time: f64) -> Given {
        let Stretch { problem, loading, scaling, .. } = self;
        let (mut force, mut gap) = (vec![0.0; problem.displacements()], vec![0.0; problem.contacts()]);
        loading.force(time, &mut force);
        loading.gap_at(time, &mut gap);
        for f in &mut force {
            *f /= scaling.force;
        }
        for g in &mut gap {
            *g /= scaling.length;
        }
        let drifts = [0, 1].map(|k| loading.drift_at(time, k));
        let slide = |(i, tangent): (usize, &Option<usize>)| tangent.map_or(0.0, |k| drifts[k][i] / scaling.length);
        let slide = self.tangents.iter().enumerate().map(slide).collect();
        Given { force, gap, slide }
    }
}
