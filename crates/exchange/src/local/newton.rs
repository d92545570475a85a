//! Algorithm BN on a local problem: Newton's method on the laws `F(r, W r + q) = 0` of all contacts.
//!
//! The linearisation of `law` gives `(A W + B) dr = -F`. The proximal term `ε D` is added to `W` in the matrix only. If
//! `W` is singular, many forces lead to the same velocities, and the step is then about the shortest of those that lead
//! there. `ε` is divided by ten after each full step and multiplied by ten after a step that was shortened three times.
//! The merit is `½ Σ |F_i|² / ρ_i`, an energy, which does not depend on the units of a contact.

use super::judge::Judge;
use super::law::Linear;
use super::scaled::ScaledContacts;
use super::system::FactoredMatrix;

/// The smallest `ε`, which is also the initial one, and the largest. It must be small compared with 1, which would
/// double the stiffness of the contact. The rounding of an equation, 1e-16, moves non-unique forces by 1e-16 / `ε`.
/// Below 1e-6 this decides about statuses, and the same problem in other units takes another number of iterations.
const PROXIMAL: [f64; 2] = [1e-6, 0.1];
/// The required share of the possible decrease (12).
const SIGMA: f64 = 0.1;
/// The largest number of halvings of a step, after which it is accepted whatever the merit.
const HALVINGS: usize = 6;
/// The number of iterations without a better merit after which the statuses are cycling.
const PATIENCE: usize = 10;
/// A merit below which another step would change only the last digits.
const POLISHED: f64 = 1e-12;

/// A point with its merit and residuals.
struct Point {
    r: Vec<f64>,
    u: Vec<f64>,
    f: Vec<f64>,
    merit: f64,
}

impl Point {
    fn new(scaled: &ScaledContacts, r: Vec<f64>, u: Vec<f64>) -> Self {
        let mut f = vec![0.0; r.len()];
        let mut merit = 0.0;
        for (k, law) in scaled.laws.iter().enumerate() {
            let own = law.residual(scaled.at(k, &r), scaled.at(k, &u));
            merit += 0.5 * own.map(|f| f * f).iter().sum::<f64>() / law.stiffness;
            scaled.put(k, own, &mut f);
        }
        Point { r, u, f, merit }
    }

    /// Returns the point after a `step` along `(dr, du)`.
    fn ahead(&self, scaled: &ScaledContacts, step: f64, dr: &[f64], du: &[f64]) -> Self {
        let along = |x: &[f64], dx: &[f64]| x.iter().zip(dx).map(|(x, dx)| x + step * dx).collect();
        Point::new(scaled, along(&self.r, dr), along(&self.u, du))
    }

    /// Returns the direction, with `ε` increased until the matrix can be factored.
    fn direction(&self, scaled: &ScaledContacts, proximal: &mut f64) -> Option<Vec<f64>> {
        let at =
            |(k, law): (usize, &super::law::LocalContact)| law.linearize(scaled.at(k, &self.r), scaled.at(k, &self.u));
        let blocks: Vec<Linear> = scaled.laws.iter().enumerate().map(at).collect();
        let rhs: Vec<f64> = self.f.iter().map(|f| -f).collect();
        loop {
            if let Ok(mut system) = FactoredMatrix::new(scaled, &blocks, *proximal) {
                let dr = system.solve(&rhs);
                if dr.iter().all(|dr| dr.is_finite()) {
                    return Some(dr);
                }
            }
            *proximal *= 100.0;
            if *proximal > 1.0 {
                return None;
            }
        }
    }
}

/// Iterates from `start` until the judge accepts a point, at most `limit` times. Returns the number of iterations.
pub(super) fn newton(judge: &mut Judge<'_>, start: Vec<f64>, limit: usize) -> usize {
    let scaled = judge.scaled;
    let [least, largest] = PROXIMAL;
    let mut proximal = least;
    let u = scaled.velocities(&start);
    let mut point = Point::new(scaled, start, u);
    let mut error = judge.offer(&point.r);
    let (mut lowest, mut since, mut iterations) = (point.merit, 0, 0);
    while iterations < limit && since < PATIENCE && (!judge.is_solved() || error > POLISHED) {
        let last = judge.is_solved();
        let Some(dr) = point.direction(scaled, &mut proximal) else { break };
        iterations += 1;
        let du = scaled.product(&dr);
        let (mut step, mut halvings) = (1.0, 0);
        let mut ahead = point.ahead(scaled, step, &dr, &du);
        // NaN is no decrease.
        let falls = |ahead: &Point, step: f64| ahead.merit <= (1.0 - 2.0 * SIGMA * step) * point.merit;
        while halvings < HALVINGS && !falls(&ahead, step) {
            (step, halvings) = (0.5 * step, halvings + 1);
            ahead = point.ahead(scaled, step, &dr, &du);
        }
        // Velocities summed step by step would drift away from their forces.
        let u = scaled.velocities(&ahead.r);
        point = Point::new(scaled, ahead.r, u);
        error = judge.offer(&point.r);
        if last || !point.merit.is_finite() {
            break;
        }
        if halvings == 0 {
            proximal = (0.1 * proximal).max(least);
        } else if halvings >= 3 {
            proximal = (10.0 * proximal).min(largest);
        }
        since = if point.merit < 0.9 * lowest { 0 } else { since + 1 };
        lowest = lowest.min(point.merit);
    }
    iterations
}
