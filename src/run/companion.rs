//! The increments of a companion run: fewer, or where there are few already more, and among them the same corners of the history.

use super::watch::tangential_forces;
use crate::solver::history::{IncrementView, Observer, Status};
use crate::solver::newton::IterationRecord;
use crate::solver::problem::State;
use std::ops::ControlFlow;

/// The companion has so many times fewer increments.
const COARSER: usize = 4;

/// The share of the difference from a run with twice the increments that is the error, by comparison with exact paths.
const OF_DOUBLED: f64 = 1.2;

/// The most parts of a history that are tried so that its kinks lie between them.
const MOST_PARTS: usize = 64;

/// Relative to the end of the history, how near an increment ends to a corner that it ends at.
const ROUNDING: f64 = 1e-9;

/// The increments of a companion run.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Companion {
    /// Their ends, s.
    pub times: Vec<f64>,
    /// Which increments of the run, and which of these, end stretches in which everything goes on in one direction, from 1.
    pub ends: [Vec<usize>; 2],
    /// The share of the difference between both that is the error of the run.
    pub share: f64,
}

impl Companion {
    /// For a run over increments that end at `times` (s), of a history with these `kinks`.
    pub(super) fn of(times: &[f64], kinks: &[f64]) -> Self {
        let ends = stretch_ends(times, kinks);
        let begins = [0].into_iter().chain(ends.iter().copied());
        let lengths: Vec<usize> = begins.zip(&ends).map(|(begin, end)| end - begin).collect();
        if lengths.iter().any(|length| *length < COARSER) {
            return Self::doubled(times, ends);
        }
        let (mut coarse, mut coarse_ends, mut begin) = (Vec::new(), Vec::new(), 0);
        for &length in &lengths {
            let count = length.div_ceil(COARSER);
            coarse.extend((1..=count).map(|k| times[begin + k * length / count - 1]));
            coarse_ends.push(coarse.len());
            begin += length;
        }
        // Errors are proportional to the length of increments.
        let ratios = lengths.iter().map(|length| *length as f64 / length.div_ceil(COARSER) as f64);
        let share = 1.0 / (ratios.fold(f64::INFINITY, f64::min) - 1.0);
        Companion { times: coarse, ends: [ends, coarse_ends], share }
    }

    /// Every increment in two halves.
    fn doubled(times: &[f64], ends: Vec<usize>) -> Self {
        let before = [0.0].into_iter().chain(times.iter().copied());
        let halves = before.zip(times).flat_map(|(begin, end)| [begin + 0.5 * (end - begin), *end]).collect();
        let fine_ends = ends.iter().map(|k| 2 * k).collect();
        Companion { times: halves, ends: [ends, fine_ends], share: OF_DOUBLED }
    }
}

/// The increments, from 1, that end at a kink, and the last one.
fn stretch_ends(times: &[f64], kinks: &[f64]) -> Vec<usize> {
    let slack = times.last().map_or(0.0, |end| ROUNDING * end);
    let is_kink = |t: f64| kinks.iter().any(|kink| (kink - t).abs() <= slack);
    (1..=times.len()).filter(|&k| k == times.len() || is_kink(times[k - 1])).collect()
}

/// The ends of the stretches of a history until `end` (s) between its `kinks`.
fn corners(end: f64, kinks: &[f64]) -> Vec<f64> {
    let mut corners: Vec<f64> = kinks.iter().copied().filter(|t| *t > 0.0 && *t < end).collect();
    corners.push(end);
    corners
}

/// The length (s) of the shortest stretch between `kinks` of a history until `end` (s).
pub(super) fn shortest_stretch(end: f64, kinks: &[f64]) -> f64 {
    let corners = corners(end, kinks);
    let begins = [0.0].into_iter().chain(corners.iter().copied());
    begins.zip(&corners).map(|(begin, end)| end - begin).fold(end, f64::min)
}

/// Into how few equal parts a history until `end` (s) is divided so that its `kinks` lie between parts, and how many of these the
/// shortest stretch between kinks has. Where too many would be needed, kinks lie within parts.
pub(super) fn equal_parts(end: f64, kinks: &[f64]) -> (usize, usize) {
    let corners = corners(end, kinks);
    let between = |parts: usize| {
        corners.iter().all(|t| {
            let at = t / end * parts as f64;
            (at - at.round()).abs() <= ROUNDING * parts as f64
        })
    };
    let parts = (1..=MOST_PARTS).find(|&parts| between(parts)).unwrap_or(MOST_PARTS);
    let shortest = shortest_stretch(end, kinks);
    (parts, ((shortest / end * parts as f64).round() as usize).max(1))
}

/// Keeps the tangential forces at the ends of some increments of a companion run. The observer of the run sees nothing of it but
/// iterations, at which it may stop it.
pub(super) struct Quiet<'a> {
    pub observer: &'a mut dyn Observer,
    /// The increments, ascending from 1.
    pub numbers: &'a [usize],
    pub states: Vec<State>,
}

impl Observer for Quiet<'_> {
    fn waits_for(&mut self, _index: usize) -> bool {
        false
    }

    fn iteration(&mut self, index: usize, record: &IterationRecord) -> ControlFlow<()> {
        self.observer.iteration(index, record)
    }

    fn increment(&mut self, step: &IncrementView<'_>) -> ControlFlow<()> {
        if step.record.status == Status::Converged && self.numbers.binary_search(&step.record.index).is_ok() {
            self.states.push(tangential_forces(step.state));
        }
        ControlFlow::Continue(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::base::timeline::equal_increments;

    #[test]
    fn a_companion_has_a_quarter_of_the_increments_and_all_corners() {
        let times = equal_increments(3.0, 24);
        let Companion { times: coarse, ends, share } = Companion::of(&times, &[0.0, 1.0, 3.0]);
        assert_eq!(coarse, [0.5, 1.0, 1.5, 2.0, 2.5, 3.0]);
        assert_eq!((ends, share), ([vec![8, 24], vec![2, 6]], 1.0 / 3.0));
        // What does not go by four goes by less, and the error is a larger share of the difference.
        let Companion { times: coarse, share, .. } = Companion::of(&equal_increments(1.0, 5), &[]);
        assert_eq!((coarse, share), (vec![2.0 / 5.0, 1.0], 1.0 / 1.5));
    }

    #[test]
    fn few_increments_are_halved() {
        let Companion { times, ends, share } = Companion::of(&equal_increments(2.0, 4), &[0.0, 1.0, 2.0]);
        assert_eq!(times, equal_increments(2.0, 8));
        assert_eq!((ends, share), ([vec![2, 4], vec![4, 8]], OF_DOUBLED));
    }

    #[test]
    fn parts_end_at_kinks() {
        assert_eq!(equal_parts(1.0, &[0.0, 1.0]), (1, 1));
        assert_eq!(equal_parts(4.0, &[0.0, 1.0, 3.0, 9.0]), (4, 1));
        assert_eq!(equal_parts(1.0, &[0.4]), (5, 2));
        // No equal parts end at such a kink.
        assert_eq!(equal_parts(1.0, &[0.5_f64.sqrt()]), (MOST_PARTS, 19));
    }
}
