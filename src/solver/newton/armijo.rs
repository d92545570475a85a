//! The step size rule (12).

/// Armijo's rule for a merit whose initial rate along the direction is at best `-2 Theta`.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Armijo {
    /// `β`, the factor of each backtrack, in (0, 1).
    pub beta: f64,
    /// `σ`, the required share of the possible decrease, in (0, ½).
    pub sigma: f64,
    /// The number of backtracks after which the step is taken regardless.
    pub max_backtracks: usize,
}

impl Armijo {
    /// The rule of the paper.
    pub const PAPER: Armijo = Armijo { beta: 0.9, sigma: 0.1, max_backtracks: 22 };

    /// A rule that halves steps, down to 1/64: shorter ones gain nothing.
    pub const HALVING: Armijo = Armijo { beta: 0.5, sigma: 0.1, max_backtracks: 6 };

    /// Returns `(β^m, m)` with the smallest `m` such that `Theta(β^m) ≤ (1 - 2 σ β^m) Theta(0)`, where `merit` maps a
    /// step length to `Theta` and `theta` is `Theta(0)`.
    pub fn step(&self, theta: f64, merit: impl Fn(f64) -> f64) -> (f64, usize) {
        let mut step = 1.0;
        for m in 0..self.max_backtracks {
            if merit(step) <= (1.0 - 2.0 * self.sigma * step) * theta {
                return (step, m);
            }
            step *= self.beta;
        }
        (step, self.max_backtracks)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_first_step_that_decreases_enough() {
        let rule = Armijo { beta: 0.5, sigma: 0.1, max_backtracks: 5 };
        assert_eq!(rule.step(1.0, |t| (1.0 - t).powi(2)), (1.0, 0));
        // The direction is too long: the merit of 1 - 3t is smallest at a third of it.
        assert_eq!(rule.step(1.0, |t| (1.0 - 3.0 * t).powi(2)), (0.5, 1));
        assert_eq!(rule.step(1.0, |_| 2.0), (0.03125, 5));
    }
}
