//! Values prescribed over time by points `[time, value, …]`: linear between them, constant outside.

use crate::base::input_error::{InputError, not_huge};

/// The tolerance of rates, relative to the steepest one: far above rounding, far below any effect.
const RATE_TOLERANCE: f64 = 1e-9;

/// The smallest kink, relative to the largest value of the history. A smaller deviation from the straight line
/// between two ends of increments is ignored: it is far above the last digits in which histories are written, and far
/// below any effect on the result.
const STRAIGHT: f64 = 1e-6;

/// Checks the points of a history at `key`; `value` describes the values after the time in each point.
///
/// # Errors
/// [`InputError`] of `key` if there is no point, if a number is not finite or too large, or if times do not increase.
pub(crate) fn check_points<const N: usize>(key: &str, value: &str, points: &[[f64; N]]) -> Result<(), InputError> {
    let name = key.rsplit('.').next().unwrap_or(key);
    if points.is_empty() {
        let [first, last] = ["0", "1"].map(|x| format!("[{}]", [x; N].join(", ")));
        let help = format!("give points [time, {value}], e.g. [{first}, {last}]");
        return Err(InputError::new(key, format!("{name} is empty"), help));
    }
    if let Some(point) = points.iter().find(|point| !point.iter().all(|x| x.is_finite())) {
        let message = format!("{name} has the point {point:?}");
        return Err(InputError::new(key, message, "give numbers other than nan or inf"));
    }
    not_huge(key, points.iter().flatten().copied())?;
    if let Some(pair) = points.windows(2).find(|pair| pair[1][0] <= pair[0][0]) {
        let message = format!("{name} goes from time {} to {}, but times must increase", pair[0][0], pair[1][0]);
        return Err(InputError::new(key, message, format!("order the points [time, {value}] by time, each time once")));
    }
    Ok(())
}

/// Checks the ends (s) of increments at `key`; the first increment begins at 0.
///
/// # Errors
/// [`InputError`] of `key` if there is none, or if they do not increase from 0.
pub(crate) fn check_times(key: &str, times: &[f64]) -> Result<(), InputError> {
    if times.is_empty() {
        return Err(InputError::new(key, format!("{key} is empty"), "give the end of each increment, s"));
    }
    let before = [0.0].into_iter().chain(times.iter().copied());
    match before.zip(times).find(|(before, t)| !(t.is_finite() && before < *t)) {
        None => Ok(()),
        Some((before, t)) => {
            let message =
                format!("{key} goes from {before} to {t}, but the ends of increments must increase from 0 on");
            Err(InputError::new(key, message, "give finite times in s, each later than the one before"))
        }
    }
}

/// Returns the ends of `count` equal increments from 0 to `end`, both in s.
pub fn equal_increments(end: f64, count: usize) -> Vec<f64> {
    (1..=count).map(|k| if k == count { end } else { end * k as f64 / count as f64 }).collect()
}

/// Returns the times at which a rate of `history` changes. The rates are 0 before the first point and after the last.
pub fn kinks<const N: usize>(history: &[[f64; N]]) -> Vec<f64> {
    let rates: Vec<Vec<f64>> = (1..N)
        .map(|c| {
            let inner = history.windows(2).map(|pair| (pair[1][c] - pair[0][c]) / (pair[1][0] - pair[0][0]));
            [0.0].into_iter().chain(inner).chain([0.0]).collect()
        })
        .collect();
    let steepest = rates.iter().flatten().fold(0.0_f64, |m, rate| m.max(rate.abs()));
    let bends = |k: usize| rates.iter().any(|rates| (rates[k + 1] - rates[k]).abs() > RATE_TOLERANCE * steepest);
    (0..history.len()).filter(|&k| bends(k)).map(|k| history[k][0]).collect()
}

/// Returns the times inside increments with these `ends` (s) at which `history` has kinks. With these as further
/// ends, the history is straight in every increment.
pub fn kinks_between<const N: usize>(ends: &[f64], history: &[[f64; N]]) -> Vec<f64> {
    let points = within(ends.last().copied().unwrap_or(0.0), history);
    let largest = points.iter().flat_map(|point| &point[1..]).fold(0.0_f64, |m, value| m.max(value.abs()));
    let mut found = Vec::new();
    for inside in points.chunk_by(|a, b| increment_at(ends, a[0]) == increment_at(ends, b[0])) {
        let Some([begin, end]) = increment_at(ends, inside[0][0]) else { continue };
        let mut chords = vec![(at(&points, begin), at(&points, end), inside)];
        while let Some((from, to, between)) = chords.pop() {
            let farthest = (0..between.len())
                .map(|k| (k, off_the_chord(&from, &to, &between[k])))
                .max_by(|a, b| a.1.total_cmp(&b.1));
            if let Some((k, _)) = farthest.filter(|(_, off)| *off > STRAIGHT * largest) {
                found.push(between[k][0]);
                chords.push((from, between[k], &between[..k]));
                chords.push((between[k], to, &between[k + 1..]));
            }
        }
    }
    found.sort_by(f64::total_cmp);
    found
}

/// Adds further `times` (s) to the `ends` of increments, except those that would make an increment as short as
/// rounding.
pub(crate) fn with_further_ends(ends: &[f64], times: impl IntoIterator<Item = f64>) -> Vec<f64> {
    let mut further: Vec<f64> = times.into_iter().filter(|&t| increment_at(ends, t).is_some()).collect();
    further.sort_by(f64::total_cmp);
    further.dedup_by(|next, kept| {
        increment_at(ends, *kept).is_some_and(|[begin, end]| *next - *kept <= rounding(begin, end))
    });
    let mut all = [ends, &further].concat();
    all.sort_by(f64::total_cmp);
    all
}

/// Returns the number of `ends` of increments until the time `t` (s). An end that is later by no more than rounding counts,
/// as in [`with_further_ends`].
pub(crate) fn ends_until(ends: &[f64], t: f64) -> usize {
    let k = ends.partition_point(|end| *end < t);
    let Some(&end) = ends.get(k) else { return k };
    let begin = k.checked_sub(1).map_or(0.0, |k| ends[k]);
    if k > 0 && t - begin <= rounding(begin, end) { k } else { k + 1 }
}

/// Returns the start and the end (s) of the increment that contains the time `t`, if there is one.
fn increment_at(ends: &[f64], t: f64) -> Option<[f64; 2]> {
    let k = ends.partition_point(|end| *end < t);
    let (begin, end) = (k.checked_sub(1).map_or(0.0, |k| ends[k]), *ends.get(k)?);
    let rounding = rounding(begin, end);
    (t - begin > rounding && end - t > rounding).then_some([begin, end])
}

/// Returns the rounding of a time within an increment, s.
fn rounding(begin: f64, end: f64) -> f64 {
    RATE_TOLERANCE * (end - begin) + 4.0 * f64::EPSILON * end
}

/// Returns the largest distance of the values of `point` from the straight line between two other points.
fn off_the_chord<const N: usize>(from: &[f64; N], to: &[f64; N], point: &[f64; N]) -> f64 {
    let share = (point[0] - from[0]) / (to[0] - from[0]);
    (1..N).map(|c| (point[c] - (from[c] + share * (to[c] - from[c]))).abs()).fold(0.0, f64::max)
}

/// Returns the point at time `t` (s) of a history.
fn at<const N: usize>(points: &[[f64; N]], t: f64) -> [f64; N] {
    let after = points.partition_point(|point| point[0] <= t);
    let mut point = points[after.saturating_sub(1)];
    if let (1.., Some(next)) = (after, points.get(after)) {
        let share = (t - point[0]) / (next[0] - point[0]);
        point = std::array::from_fn(|k| point[k] + share * (next[k] - point[k]));
    }
    point[0] = t;
    point
}

/// Returns the part of `points` from 0 to `end` (s), so that later points do not affect the largest values.
pub fn within<const N: usize>(end: f64, points: &[[f64; N]]) -> Vec<[f64; N]> {
    let mut times: Vec<f64> = points.iter().map(|point| point[0].clamp(0.0, end)).collect();
    times.dedup();
    times.into_iter().map(|t| at(points, t)).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn histories_are_cut_where_the_time_ends() {
        let whole = [[0.0, 1.0], [0.5, -3.0], [2.0, 4.0]];
        assert_eq!(within(2.0, &whole), whole);
        assert_eq!(within(2.0, &[[-1.0, 2.0], [1.0, 4.0], [5.0, 8.0]]), [[0.0, 3.0], [1.0, 4.0], [2.0, 5.0]]);
        assert_eq!(within(2.0, &[[-3.0, 9.0], [-1.0, 2.0], [3.0, 6.0], [4.0, 9.0]]), [[0.0, 3.0], [2.0, 5.0]]);
        // Constant outside the points.
        assert_eq!(within(2.0, &[[1.0, 7.0]]), [[1.0, 7.0]]);
        assert_eq!(within(2.0, &[[3.0, 7.0], [4.0, 9.0]]), [[2.0, 7.0]]);
        assert_eq!(within(2.0, &[[-3.0, 9.0], [-2.0, 7.0]]), [[0.0, 7.0]]);
        assert_eq!(within(2.0, &[[0.0, 0.0, 1.0], [4.0, 2.0, -1.0]]), [[0.0, 0.0, 1.0], [2.0, 1.0, 0.0]]);
    }

    #[test]
    fn kinks_are_where_rates_change() {
        assert_eq!(kinks(&[[0.0, 0.0], [1.0, 1.0], [2.0, 2.0], [3.0, 0.0]]), [0.0, 2.0, 3.0]);
        assert_eq!(kinks(&[[0.3, 1.0], [0.9, 1.0]]), [0.0; 0]);
        assert_eq!(kinks(&[[0.0, 0.0, 0.0], [1.0, 0.0, 1.0], [3.0, 0.0, 3.0]]), [0.0, 3.0]);
    }

    #[test]
    fn kinks_between_ends_of_increments() {
        let there_and_back = [[0.0, 0.0], [1.0, 1.0], [2.0, 0.0]];
        assert_eq!(kinks_between(&equal_increments(2.0, 7), &there_and_back), [1.0]);
        assert_eq!(kinks_between(&equal_increments(2.0, 8), &there_and_back), [0.0; 0]);
        // Constant values have no kink, but a history has kinks where it begins and ends.
        let seven = equal_increments(2.0, 7);
        assert_eq!(kinks_between(&seven, &[[0.0, 0.0], [0.3, 0.3], [2.0, 2.0]]), [0.0; 0]);
        assert_eq!(kinks_between(&seven, &[[0.3, 1.0], [0.9, 1.0]]), [0.0; 0]);
        assert_eq!(kinks_between(&seven, &[[0.3, 0.0], [0.9, 1.0]]), [0.3, 0.9]);
        assert_eq!(kinks_between(&seven, &[[0.4, 7.0]]), [0.0; 0]);
        // Any component counts; times after the end do not.
        let path = [[0.0, 0.0, 0.0], [1.0, 0.0, 1.0], [3.0, 0.0, 0.0]];
        assert_eq!(kinks_between(&equal_increments(2.0, 3), &path), [1.0]);
        // 0.1 s is 3 increments up to rounding.
        assert_eq!(kinks_between(&equal_increments(0.3, 9), &[[0.0, 0.0], [0.1, 1.0]]), [0.0; 0]);
        // A ramp in four digits is one straight line; a deviation of a thousandth is not.
        let ramp: Vec<[f64; 2]> =
            (0..=9).map(|k| [f64::from(k) / 9.0, (f64::from(k) / 9.0 * 1e7).round() / 1e7]).collect();
        assert_eq!(kinks_between(&[1.0], &ramp), [0.0; 0]);
        let push = [[0.0, 1.0], [0.4, 1.0], [0.5, 1.001], [0.6, 1.0]];
        assert_eq!(kinks_between(&[0.5, 1.0], &push), [0.4, 0.6]);
    }

    #[test]
    fn further_ends_are_no_increments_of_rounding() {
        assert_eq!(with_further_ends(&[1.0, 2.0], [0.5, 1.0 + 1e-12, 1.5, 0.5 + 1e-12, 3.0]), [0.5, 1.0, 1.5, 2.0]);
        assert_eq!(with_further_ends(&[1.0, 2.0], []), [1.0, 2.0]);
    }

    #[test]
    fn times_increase_from_zero_on() {
        assert_eq!(equal_increments(0.3, 3), [0.3 / 3.0, 0.3 * 2.0 / 3.0, 0.3]);
        assert!(check_times("times", &[0.5, 0.7]).is_ok());
        for times in [&[][..], &[0.0], &[-1.0], &[f64::NAN], &[1.0, 1.0], &[2.0, 1.0], &[1.0, f64::INFINITY]] {
            assert_eq!(check_times("times", times).unwrap_err().key, "times");
        }
    }
}
