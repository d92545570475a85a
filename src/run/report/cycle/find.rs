//! Load cycles of a history.

use crate::solver::Loading;

/// Times that differ by less than this share of the duration are equal: far above rounding, far below any increment.
pub(super) const SAME_TIME: f64 = 1e-9;

/// Values and rates of loads that differ by less than this share of the largest are equal: far above the last digits in
/// which histories are written.
const SAME_LOAD: f64 = 1e-6;

/// Returns the cycle between two times (s) and those of equal length before it in which all loads took the same course, the
/// first one first, at most `most` of them.
pub(super) fn repeated(loading: &Loading, [start, end]: [f64; 2], most: usize) -> Vec<[f64; 2]> {
    let period = end - start;
    let loads = |begin: f64, place: u32| loading.factors_at(begin + period * f64::from(place) / f64::from(PLACES));
    let cycle: Vec<Vec<f64>> = (0..=PLACES).map(|place| loads(start, place)).collect();
    let largest = |c: usize| cycle.iter().map(|loads| loads[c].abs()).fold(0.0, f64::max);
    let is_alike = |begin: f64| {
        (0..=PLACES).zip(&cycle).all(|(place, loads_of_cycle)| {
            let pairs = loads(begin, place).into_iter().zip(loads_of_cycle).enumerate();
            pairs.into_iter().all(|(c, (a, b))| (a - b).abs() <= SAME_LOAD * largest(c))
        })
    };
    let before = ((start / period) * (1.0 + SAME_TIME) + SAME_TIME).floor() as usize;
    let begins = (1..=before.min(most)).map(|k| start - k as f64 * period).take_while(|begin| is_alike(*begin));
    let mut cycles: Vec<[f64; 2]> = begins.map(|begin| [begin, begin + period]).collect();
    cycles.reverse();
    cycles.push([start, end]);
    cycles
}

/// The number of places in a cycle at which loads are compared.
const PLACES: u32 = 16;

/// Returns the load cycles at the end of a history whose increments end at `times` (s), the first one first. Let E be the last
/// increment in which a load changes. A cycle ends at an increment at which loads, motions and friction factors equal those
/// of E, and just before, change in the same proportions as before E. The result is empty if there is no such cycle.
pub fn last_cycles(loading: &Loading, times: &[f64]) -> Vec<[f64; 2]> {
    let states: Vec<Vec<f64>> = times.iter().map(|&t| loading.factors_at(t)).collect();
    let largest = |c: usize| states.iter().map(|state| state[c].abs()).fold(0.0, f64::max);
    let sizes: Vec<f64> = (0..states.first().map_or(0, Vec::len)).map(largest).collect();
    let shortest = times.windows(2).map(|pair| pair[1] - pair[0]).fold(times.first().copied().unwrap_or(0.0), f64::min);
    let directions: Vec<Option<Vec<f64>>> = (times.iter().zip(&states))
        .map(|(t, state)| direction(&loading.factors_at(t - SHORT * shortest), state, &sizes))
        .collect();
    let Some(end) = directions.iter().rposition(Option::is_some) else { return Vec::new() };
    let has_the_loads = |k: usize| {
        states[k].iter().zip(&states[end]).zip(&sizes).all(|((a, b), size)| (a - b).abs() <= SAME_LOAD * size)
    };
    let goes_the_same_way = |k: usize| match (&directions[k], &directions[end]) {
        (Some(one), Some(other)) => one.iter().zip(other).all(|(a, b)| (a - b).abs() <= SAME_DIRECTION),
        _ => false,
    };
    let returns: Vec<f64> = (0..=end).filter(|&k| has_the_loads(k) && goes_the_same_way(k)).map(|k| times[k]).collect();
    returns.windows(2).map(|pair| [pair[0], pair[1]]).collect()
}

/// Returns the change from `before` to `after`, each component relative to its `sizes`, divided by the largest one; `None` if
/// nothing changes.
fn direction(before: &[f64], after: &[f64], sizes: &[f64]) -> Option<Vec<f64>> {
    let share = |((before, after), size): ((&f64, &f64), &f64)| if *size > 0.0 { (after - before) / size } else { 0.0 };
    let changes: Vec<f64> = before.iter().zip(after).zip(sizes).map(share).collect();
    let largest = changes.iter().fold(0.0_f64, |m, change| m.max(change.abs()));
    (largest > ROUNDING).then(|| changes.iter().map(|change| change / largest).collect())
}

/// The time over which changes are taken, as a share of the shortest increment.
const SHORT: f64 = 1e-3;

/// Smaller changes, relative to the largest value, are rounding.
const ROUNDING: f64 = 1e-13;

/// Directions of change that differ by less are equal.
const SAME_DIRECTION: f64 = 0.01;

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used)]

    use super::*;
    use crate::base::timeline::equal_increments;
    use crate::solver::LoadCase;

    fn loading(histories: &[&[[f64; 2]]]) -> Loading {
        let case = |history: &&[[f64; 2]]| LoadCase::new(vec![1.0], history.to_vec()).unwrap();
        Loading::new(histories.iter().map(case).collect(), vec![]).unwrap()
    }

    #[test]
    fn cycles_of_a_triangular_wave() {
        let pressed = [[0.0, 0.0], [1.0, 1.0]];
        let wave = [[0.0, 0.0], [1.0, 0.0], [2.0, 1.0], [4.0, -1.0], [6.0, 1.0], [8.0, -1.0], [10.0, 1.0]];
        let ends = |end: f64, count| last_cycles(&loading(&[&pressed, &wave]), &equal_increments(end, count));
        assert_eq!(ends(10.0, 20), [[2.0, 6.0], [6.0, 10.0]]);
        assert_eq!(ends(9.5, 19), [[1.5, 5.5], [5.5, 9.5]]);
        // At zero load on the way up, once a cycle and not twice.
        assert_eq!(ends(9.0, 18), [[5.0, 9.0]]);
        assert_eq!(ends(1.0, 4), [[0.0; 2]; 0]);
    }

    #[test]
    fn a_pause_is_no_cycle() {
        let wave = [[0.0, 0.0], [1.0, 1.0], [2.0, -1.0], [3.0, 1.0], [4.0, 1.0], [5.0, -1.0], [6.0, 1.0], [7.0, 1.0]];
        assert_eq!(last_cycles(&loading(&[&wave]), &equal_increments(7.0, 14)), [[1.0, 3.0], [3.0, 6.0]]);
        assert!(last_cycles(&loading(&[&[[0.0, 0.0], [1.0, 1.0]]]), &[1.0]).is_empty());
        assert!(last_cycles(&Loading::default(), &[]).is_empty());
        assert!(last_cycles(&loading(&[&[[0.0, 1.0], [1.0, 1.0]]]), &[0.5, 1.0]).is_empty());
    }

    #[test]
    fn cycles_repeat_backwards() {
        let wave = [[0.0, 0.0], [1.0, 1.0], [2.0, 0.0], [3.0, 1.0], [4.0, 0.0], [5.0, 1.0], [6.0, 0.0]];
        let found = |cycle| repeated(&loading(&[&wave]), cycle, 10);
        assert_eq!(found([4.0, 6.0]), [[0.0, 2.0], [2.0, 4.0], [4.0, 6.0]]);
        assert_eq!(found([3.0, 5.0]), [[1.0, 3.0], [3.0, 5.0]]);
        // The load of half a cycle goes the other way in the half before.
        assert_eq!(found([4.0, 5.0]), [[4.0, 5.0]]);
    }
}
