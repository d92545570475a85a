//! The data along the path, one load segment after another.

use super::node::{Given, largest};
use crate::base::units::Scaling;
use crate::solver::loading::Loading;
use crate::solver::problem::ContactProblem;
use serde::{Deserialize, Serialize};

/// The loads of a path in its units.
pub(super) struct PathLoads<'a> {
    pub problem: &'a ContactProblem,
    pub loading: &'a Loading,
    pub scaling: Scaling,
    /// The tangent along which each node slides, if any.
    pub tangents: Vec<Option<usize>>,
}

/// A load segment: all data change at constant rates.
#[derive(Clone, Serialize, Deserialize)]
pub(super) struct Stretch {
    /// The times at which the rates change, in descending order.
    pub corners: Vec<f64>,
    /// The start and end of the segment, s; the end is infinite if the data change no more.
    pub times: [f64; 2],
    /// The data at the start.
    #[serde(rename = "given")]
    pub at: Given,
    /// The change of the data until the end.
    pub change: Given,
}

impl Stretch {
    /// Creates the segment of no duration in which the loads at t = 0 are applied in proportion. If there are none,
    /// creates the first segment after it.
    pub(super) fn first(loads: &PathLoads<'_>) -> Self {
        let mut corners = loads.loading.corners();
        corners.reverse();
        let there = loads.given(0.0);
        let apart = there.gap.iter().map(|gap| gap.max(0.0)).collect();
        let at = Given { force: vec![0.0; there.force.len()], gap: apart, slide: there.slide.clone() };
        let mut stretch = Stretch { corners, times: [0.0; 2], change: there.plus(-1.0, &at), at };
        if largest(&stretch.change.force) == 0.0 && largest(&stretch.change.gap) == 0.0 {
            stretch.next(loads);
        }
        stretch
    }

    /// Advances to the segment up to the next corner, or to infinity if there is none.
    pub(super) fn next(&mut self, loads: &PathLoads<'_>) {
        let start = self.times[1];
        while self.corners.last().is_some_and(|corner| *corner <= start) {
            self.corners.pop();
        }
        // Beyond the last corner the data are constant.
        let end = self.corners.pop().unwrap_or(f64::INFINITY);
        self.at = loads.given(start);
        self.change = loads.given(if end.is_finite() { end } else { start }).plus(-1.0, &self.at);
        self.times = [start, end];
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
}

impl PathLoads<'_> {
    /// Returns the data at a time, in the units of the path.
    fn given(&self, time: f64) -> Given {
        let PathLoads { problem, loading, scaling, tangents } = self;
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
        let slide = tangents.iter().enumerate().map(slide).collect();
        Given { force, gap, slide }
    }
}
