//! The increments of a companion run: fewer, or more if there are few already, with the same kinks of the history.

use super::watch::tangential_forces;
use crate::solver::history::{IncrementView, Observer, Status};
use crate::solver::newton::IterationRecord;
use crate::solver::problem::State;
use std::ops::ControlFlow;

/// The factor by which a companion run has fewer increments.
const COARSER: usize = 4;

/// The ratio of the error to the difference from a run with twice the increments, calibrated with exact paths.
const OF_DOUBLED: f64 = 1.2;

/// The largest number of equal parts of a history that are tried to make its kinks coincide with ends of parts.
const MAX_PARTS: usize = 64;

/// The tolerance for an increment that ends at a kink, relative to the end of the history.
const KINK_TOLERANCE: f64 = 1e-9;

/// The increments of a companion run.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Companion {
    /// Their ends, s.
    pub times: Vec<f64>,
    /// The increments of the run, and of the companion, that end a load segment, from 1.
    pub ends: [Vec<usize>; 2],
    /// The ratio of the error of the run to the difference between both runs.
    pub share: f64,
}

impl Companion {
    /// Creates the companion of a run over increments that end at `times` (s), for a history with these `kinks`.
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
        // The error is proportional to the length of the increments.
        let ratios = lengths.iter().map(|length| *length as f64 / length.div_ceil(COARSER) as f64);
        let share = 1.0 / (ratios.fold(f64::INFINITY, f64::min) - 1.0);
        Companion { times: coarse, ends: [ends, coarse_ends], share }
    }

    /// Divides every increment into two halves.
    fn doubled(times: &[f64], ends: Vec<usize>) -> Self {
        let before = [0.0].into_iter().chain(times.iter().copied());
        let halves = before.zip(times).flat_map(|(begin, end)| [begin + 0.5 * (end - begin), *end]).collect();
        let fine_ends = ends.iter().map(|k| 2 * k).collect();
        Companion { times: halves, ends: [ends, fine_ends], share: OF_DOUBLED }
    }
}

/// Returns the increments, from 1, that end at a kink, and the last one.
fn stretch_ends(times: &[f64], kinks: &[f64]) -> Vec<usize> {
    let slack = times.last().map_or(0.0, |end| KINK_TOLERANCE * end);
    let is_kink = |t: f64| kinks.iter().any(|kink| (kink - t).abs() <= slack);
    (1..=times.len()).filter(|&k| k == times.len() || is_kink(times[k - 1])).collect()
}

/// Returns the ends of the load segments between the `kinks` of a history until `end` (s).
fn corners(end: f64, kinks: &[f64]) -> Vec<f64> {
    let mut corners: Vec<f64> = kinks.iter().copied().filter(|t| *t > 0.0 && *t < end).collect();
    corners.push(end);
    corners
}

/// Returns the length (s) of the shortest load segment between the `kinks` of a history until `end` (s).
pub(super) fn shortest_stretch(end: f64, kinks: &[f64]) -> f64 {
    let corners = corners(end, kinks);
    let begins = [0.0].into_iter().chain(corners.iter().copied());
    begins.zip(&corners).map(|(begin, end)| end - begin).fold(end, f64::min)
}

/// Returns the least number of equal parts of a history until `end` (s) for which its `kinks` coincide with ends of
/// parts, and the number of parts in the shortest load segment. If too many would be needed, kinks may lie inside
/// parts.
pub(super) fn equal_parts(end: f64, kinks: &[f64]) -> (usize, usize) {
    let corners = corners(end, kinks);
    let between = |parts: usize| {
        corners.iter().all(|t| {
            let at = t / end * parts as f64;
            (at - at.round()).abs() <= KINK_TOLERANCE * parts as f64
        })
    };
    let parts = (1..=MAX_PARTS).find(|&parts| between(parts)).unwrap_or(MAX_PARTS);
    let shortest = shortest_stretch(end, kinks);
    (parts, ((shortest / end * parts as f64).round() as usize).max(1))
}

/// An observer that keeps the tangential forces at the ends of some increments of a companion run. The observer of the
/// main run sees only its iterations, at which it may stop it.
pub(super) struct Quiet<'a> {
    pub observer: &'a mut dyn Observer,
    /// The selected increments, ascending from 1.
    pub numbers: &'a [usize],
    pub states: Vec<State>,
}

impl Observer for Quiet<'_> {
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
        // Lengths that are not multiples of four are divided by less, and the ratio of error to difference is larger.
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
        assert_eq!(equal_parts(1.0, &[0.5_f64.sqrt()]), (MAX_PARTS, 19));
    }
}
