//! Friction that changes in time.

use super::piecewise_linear;
use crate::solver::problem::ProblemError;
use crate::solver::problem::error::{expect_each, expect_finite, expect_history, expect_length};

/// Coulomb's coefficients of the contact nodes over time, `μ_i(t) = Σ_k f_k(t) μ_ki`.
#[derive(Debug, Clone, PartialEq)]
pub struct FrictionHistory {
    pub(super) nodes: usize,
    /// `μ_k` at factor 1, with the points of `f_k`.
    pub(super) cases: Vec<(Vec<f64>, Vec<[f64; 2]>)>,
}

impl FrictionHistory {
    /// Creates the sum of `cases`: coefficients of `nodes` contact nodes at factor 1, and points
    /// `[time (s), factor]`. The factor is linear between the points and constant outside; it is 1 if there are no
    /// points.
    ///
    /// # Errors
    /// If there is not one coefficient for each node, if one is negative or not finite, if times do not increase, or
    /// if a factor is negative.
    pub fn new(nodes: usize, cases: Vec<(Vec<f64>, Vec<[f64; 2]>)>) -> Result<Self, ProblemError> {
        for (mu, history) in &cases {
            expect_length("mu", nodes, mu.len(), "one for each contact node")?;
            expect_finite("mu", mu)?;
            expect_each("mu", mu, "0 or more", |mu| mu >= 0.0)?;
            expect_history("history of friction", history)?;
            let factors: Vec<f64> = history.iter().map(|point| point[1]).collect();
            expect_each("factors of friction", &factors, "0 or more", |factor| factor >= 0.0)?;
        }
        Ok(FrictionHistory { nodes, cases })
    }

    /// Returns the number of contact nodes.
    pub fn nodes(&self) -> usize {
        self.nodes
    }

    /// Calls `see` with every array.
    pub(crate) fn each_array(&self, mut see: impl FnMut(&[f64])) {
        for (mu, history) in &self.cases {
            see(mu);
            see(history.as_flattened());
        }
    }

    /// Returns the coefficients at time `t` (s).
    pub fn at(&self, t: f64) -> Vec<f64> {
        let mut mu = vec![0.0; self.nodes];
        for (case, history) in &self.cases {
            let factor = piecewise_linear(history, t).unwrap_or(1.0);
            mu.iter_mut().zip(case).for_each(|(sum, mu)| *sum += factor * mu);
        }
        mu
    }

    /// Returns the largest coefficient of each node over all time.
    pub fn largest(&self) -> Vec<f64> {
        let times = self.cases.iter().flat_map(|(_, history)| history.iter().map(|point| point[0]));
        times.chain([0.0]).map(|t| self.at(t)).fold(vec![0.0; self.nodes], |mut largest, mu| {
            largest.iter_mut().zip(mu).for_each(|(largest, mu)| *largest = largest.max(mu));
            largest
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn coefficients_are_sums_of_cases() {
        let falling = (vec![0.4, 0.1, 0.0], vec![[1.0, 1.0], [3.0, 0.5]]);
        let friction = FrictionHistory::new(3, vec![falling, (vec![0.0, 0.1, 0.2], Vec::new())]).unwrap();
        assert_eq!(friction.at(0.0), [0.4, 0.2, 0.2]);
        assert_eq!(friction.at(9.0), [0.2, 0.5 * 0.1 + 0.1, 0.2]);
        assert_eq!(friction.at(2.0)[0], 0.75 * 0.4);
        assert_eq!(friction.largest(), [0.4, 0.2, 0.2]);
        for (mu, history, says) in [
            (vec![0.4], vec![], "mu has 1"),
            (vec![0.4, 0.4, -0.1], vec![], "mu[2] is -0.1"),
            (vec![0.4; 3], vec![[0.0, 1.0], [1.0, -1.0]], "factors of friction[1] is -1"),
            (vec![0.4; 3], vec![[1.0, 1.0], [0.0, 1.0]], "history of friction"),
        ] {
            let error = FrictionHistory::new(3, vec![(mu, history)]).unwrap_err().to_string();
            assert!(error.contains(says), "{error}");
        }
    }
}
