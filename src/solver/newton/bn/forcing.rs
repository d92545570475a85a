//! Forcing terms: each direction is solved only as accurately as needed, since each digit costs time.

/// The accuracy far from the solution.
const LOOSE: f64 = 1e-2;
/// The accuracy that rounding and the end of an increment require.
const TIGHT: f64 = 1e-8;
/// The share of the expected reduction.
const SAFETY: f64 = 0.9;

/// The forcing terms of Eisenstat and Walker (1996), choice 2: `0.9 (|b| / |b_last|)²`.
#[derive(Debug, Default)]
pub(super) struct Forcing {
    last: f64,
}

impl Forcing {
    /// Returns the admissible residual of the direction for the right-hand side `b`, relative to `b`. If `b` has
    /// grown, as at the start of an increment, the loosest term is used.
    pub(super) fn term(&mut self, b: &[f64]) -> f64 {
        let size = b.iter().map(|b| b * b).sum::<f64>().sqrt();
        let last = std::mem::replace(&mut self.last, size);
        if last > 0.0 { (SAFETY * (size / last).powi(2)).clamp(TIGHT, LOOSE) } else { LOOSE }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn terms_follow_the_reduction() {
        let mut forcing = Forcing::default();
        assert_eq!(forcing.term(&[3.0, 4.0]), LOOSE);
        assert!((forcing.term(&[0.3, 0.4]) - 0.9e-2).abs() < 1e-15);
        assert_eq!(forcing.term(&[3e-6, 4e-6]), TIGHT);
        assert_eq!(forcing.term(&[1.0, 1.0]), LOOSE);
    }
}
