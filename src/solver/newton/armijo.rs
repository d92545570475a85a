//! The step size rule (12).

/// Armijo's rule on a merit that falls along the direction at most at the rate `2 Theta`.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Armijo {
    /// `β`, the factor of each backtrack, in (0, 1).
    pub beta: f64,
    /// `σ`, the demanded share of the possible decrease, in (0, ½).
    pub sigma: f64,
    /// After so many backtracks the step is taken as it is.
    pub max_backtracks: usize,
}

impl Armijo {
    /// The paper's.
    pub const PAPER: Armijo = Armijo { beta: 0.9, sigma: 0.1, max_backtracks: 22 };

    /// Steps are halved, down to 1/64: finer ones gain nothing.
    pub const HALVING: Armijo = Armijo { beta: 0.5, sigma: 0.1, max_backtracks: 6 };

    /// `(β^m, m)` with the smallest `m` such that `Theta(β^m) ≤ (1 - 2 σ β^m) Theta(0)`, where
    /// `merit` maps a step length to `Theta` and `theta` is `Theta(0)`.
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
        // Too long a direction: the merit of 1 - 3t is least at a third of it.
        assert_eq!(rule.step(1.0, |t| (1.0 - 3.0 * t).powi(2)), (0.5, 1));
        assert_eq!(rule.step(1.0, |_| 2.0), (0.03125, 5));
    }
}
