//! What is the largest of a history, whatever rounding makes of it.

/// Of times that differ by a smaller share rounding would decide, and with it the linear algebra.
const ROUNDING: f64 = 1e-9;

/// Whether something is as large as the `largest` so far, or larger: of several times that are alike the last one counts.
pub(super) fn is_as_large(new: f64, largest: f64) -> bool {
    new >= (1.0 - ROUNDING) * largest
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
