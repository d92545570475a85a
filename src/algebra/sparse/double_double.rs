//! Sums in twice the working precision, for residuals that cancel down to the rounding of their terms.

/// A sum as `high + low`, with about 106 bits; Dekker (1971), Knuth.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub struct DoubleDouble {
    high: f64,
    low: f64,
}

impl DoubleDouble {
    /// Adds `x`.
    pub fn add(&mut self, x: f64) {
        let sum = self.high + x;
        let part = sum - self.high;
        self.low += (self.high - (sum - part)) + (x - part);
        self.high = sum;
    }

    /// Adds `a b` with the rounding error of the product.
    pub fn add_product(&mut self, a: f64, b: f64) {
        let product = a * b;
        let ((a1, a2), (b1, b2)) = (halves(a), halves(b));
        self.add(product);
        self.low += a2 * b2 - (((product - a1 * b1) - a2 * b1) - a1 * b2);
    }

    /// Returns the high and the low part.
    pub fn parts(self) -> [f64; 2] {
        [self.high, self.low]
    }

    /// Returns the sum, rounded.
    pub fn value(self) -> f64 {
        self.high + self.low
    }
}

/// Splits `x` into a sum of two numbers of at most 26 bits, whose products are exact.
fn halves(x: f64) -> (f64, f64) {
    // 2^27 + 1: each part gets half of the 53 bits.
    let c = 134_217_729.0 * x;
    let high = c - (c - x);
    (high, x - high)
}

/// Returns `x + y` as the rounded sum and its rounding error.
pub fn sum(x: f64, y: f64) -> (f64, f64) {
    let mut sum = DoubleDouble { high: x, low: 0.0 };
    sum.add(y);
    (sum.high, sum.low)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn cancellation_leaves_the_small_terms() {
        let mut sum = DoubleDouble::default();
        sum.add(1e16);
        sum.add(1.0);
        sum.add(-1e16);
        assert_eq!(sum.value(), 1.0);
        // (1 + 2⁻³⁰)² - 1 - 2⁻²⁹ = 2⁻⁶⁰.
        let x = 1.0 + 2.0_f64.powi(-30);
        let mut square = DoubleDouble::default();
        square.add_product(x, x);
        square.add(-1.0);
        square.add(-(2.0_f64.powi(-29)));
        assert_eq!(square.value(), 2.0_f64.powi(-60));
        assert_eq!(super::sum(1e16, 1.0), (1e16, 1.0));
    }
}
