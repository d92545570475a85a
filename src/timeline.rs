//! Values prescribed over time by points `[time, value, …]`: linear between them, constant outside.

use crate::fault::{Fault, not_huge};

/// Relative to the steepest rate: far above its rounding, far below what matters.
const ROUNDING: f64 = 1e-9;

/// Checks the points of a history at `key`; `value` says what stands behind the time in each.
///
/// # Errors
/// [`Fault`] of `key` where there is no point, one is not finite or huge, or times do not increase.
pub fn check_points<const N: usize>(key: &str, value: &str, points: &[[f64; N]]) -> Result<(), Fault> {
    let name = key.rsplit('.').next().unwrap_or(key);
    if points.is_empty() {
        let [first, last] = ["0", "1"].map(|x| format!("[{}]", [x; N].join(", ")));
        let help = format!("give points [time, {value}], e.g. [{first}, {last}]");
        return Err(Fault::new(key, format!("{name} is empty"), help));
    }
    if let Some(point) = points.iter().find(|point| !point.iter().all(|x| x.is_finite())) {
        let message = format!("{name} has the point {point:?}");
        return Err(Fault::new(key, message, "give numbers other than nan or inf"));
    }
    not_huge(key, points.iter().flatten().copied())?;
    if let Some(pair) = points.windows(2).find(|pair| pair[1][0] <= pair[0][0]) {
        let message = format!("{name} goes from time {} to {}, but times must increase", pair[0][0], pair[1][0]);
        return Err(Fault::new(key, message, format!("order the points [time, {value}] by time, each time once")));
    }
    Ok(())
}

/// Checks the ends (s) of increments at `key`, the first of which begins at 0.
///
/// # Errors
/// [`Fault`] of `key` where there is none, or they do not increase from 0 on.
pub fn check_times(key: &str, times: &[f64]) -> Result<(), Fault> {
    if times.is_empty() {
        return Err(Fault::new(key, format!("{key} is empty"), "give the end of each increment, s"));
    }
    let before = [0.0].into_iter().chain(times.iter().copied());
    match before.zip(times).find(|(before, t)| !(t.is_finite() && before < *t)) {
        None => Ok(()),
        Some((before, t)) => {
            let message =
                format!("{key} goes from {before} to {t}, but the ends of increments must increase from 0 on");
            Err(Fault::new(key, message, "give finite times in s, each later than the one before"))
        }
    }
}

/// The ends of `count` equal increments from 0 to `end`, both in s.
pub fn equal_increments(end: f64, count: usize) -> Vec<f64> {
    (1..=count).map(|k| if k == count { end } else { end * k as f64 / count as f64 }).collect()
}

/// The times at which a rate of `history` changes; before the first point and after the last they are 0.
pub fn kinks<const N: usize>(history: &[[f64; N]]) -> Vec<f64> {
    let rates: Vec<Vec<f64>> = (1..N)
        .map(|c| {
            let inner = history.windows(2).map(|pair| (pair[1][c] - pair[0][c]) / (pair[1][0] - pair[0][0]));
            [0.0].into_iter().chain(inner).chain([0.0]).collect()
        })
        .collect();
    let steepest = rates.iter().flatten().fold(0.0_f64, |m, rate| m.max(rate.abs()));
    let bends = |k: usize| rates.iter().any(|rates| (rates[k + 1] - rates[k]).abs() > ROUNDING * steepest);
    (0..history.len()).filter(|&k| bends(k)).map(|k| history[k][0]).collect()
}

/// The part of `points` from 0 to `end` (s). What is never reached must not count as the largest of anything.
pub fn within<const N: usize>(end: f64, points: &[[f64; N]]) -> Vec<[f64; N]> {
    let mut times: Vec<f64> = points.iter().map(|point| point[0].clamp(0.0, end)).collect();
    times.dedup();
    let at = |t: f64| {
        let after = points.partition_point(|point| point[0] <= t);
        let mut point = points[after.saturating_sub(1)];
        if let (1.., Some(next)) = (after, points.get(after)) {
            let share = (t - point[0]) / (next[0] - point[0]);
            point = std::array::from_fn(|k| point[k] + share * (next[k] - point[k]));
        }
        point[0] = t;
        point
    };
    times.into_iter().map(at).collect()
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
        // Constant outside.
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
    fn times_increase_from_zero_on() {
        assert_eq!(equal_increments(0.3, 3), [0.3 / 3.0, 0.3 * 2.0 / 3.0, 0.3]);
        assert!(check_times("times", &[0.5, 0.7]).is_ok());
        for times in [&[][..], &[0.0], &[-1.0], &[f64::NAN], &[1.0, 1.0], &[2.0, 1.0], &[1.0, f64::INFINITY]] {
            assert_eq!(check_times("times", times).unwrap_err().key, "times");
        }
    }
}
