//! The value that a picture marks.

/// Returns the number of the largest value if it is positive: the first one if several are equal within rounding, so
/// that a symmetric body has the same mark on every machine.
pub(super) fn first_largest(values: impl Iterator<Item = f64> + Clone) -> Option<usize> {
    let most = values.clone().fold(0.0, f64::max);
    values.into_iter().position(|value| most > 0.0 && is_equal(value, most))
}

/// Returns `true` if `value` is not below `most` by more than rounding.
pub(super) fn is_equal(value: f64, most: f64) -> bool {
    value >= (1.0 - 1e-9) * most
}

#[cfg(test)]
mod tests {
    use super::first_largest;

    #[test]
    fn the_first_of_equal_values_is_the_largest() {
        let largest = |values: &[f64]| first_largest(values.iter().copied());
        assert_eq!(largest(&[1.0, 3.0, 3.0 + 1e-12, 2.0]), Some(1));
        assert_eq!([largest(&[]), largest(&[0.0, -1.0])], [None; 2]);
    }
}
