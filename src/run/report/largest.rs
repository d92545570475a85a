//! Finds the largest value of a history, independent of rounding.

/// Values that differ by a smaller share count as equal. Otherwise rounding, and with it the linear solver, would
/// decide between their times.
const EQUAL_SHARE: f64 = 1e-9;

/// Returns `true` if a value is at least as large as the `largest` so far. Of several equal values the last one counts.
pub(in crate::run) fn is_as_large(new: f64, largest: f64) -> bool {
    new >= (1.0 - EQUAL_SHARE) * largest
}

#[cfg(test)]
mod tests {
    use super::is_as_large;

    #[test]
    fn rounding_decides_nothing() {
        assert!(is_as_large(8000.0 - 1e-9, 8000.0) && is_as_large(8000.0, 8000.0 - 1e-9) && is_as_large(0.0, 0.0));
        assert!(!is_as_large(7999.0, 8000.0));
    }
}
