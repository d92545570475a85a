//! Algorithm BN on a local problem: Newton's method on the laws `F(r, W r + q) = 0` of all contacts.
//!
//! The linearisation is that of `law`, `(A W + B) dr = -F`, with the proximal term `ε D` added to `W` in the matrix alone: where `W` is
//! singular many forces make the same velocities, and the step is then about the shortest of those that lead there. `ε` falls tenfold
//! after each full step and grows tenfold after one that had to be shortened three times. The merit is `½ Σ |F_i|² / ρ_i`, an energy,
//! which is the same whatever the units of a contact.

use super::judge::Judge;
use super::law::Linear;
use super::scaled::ScaledContacts;
use super::system::FactoredMatrix;

/// The least `ε`, with which it begins, and the largest: small beside 1, which would be as stiff again as the contact itself. The rounding
/// of an equation, 1e-16, moves forces that are not unique by that over `ε`: below 1e-6 it decides about statuses, and the same problem
/// in other units takes another number of iterations.
const PROXIMAL: [f64; 2] = [1e-6, 0.1];
/// The demanded share of the possible decrease (12).
const SIGMA: f64 = 0.1;
/// Steps are halved so often, at most: after that the step is taken whatever the merit.
const HALVINGS: usize = 6;
/// After so many iterations without a better merit the statuses go round in a circle.
const PATIENCE: usize = 10;
/// One step more, below this, would only move the last digits.
const POLISHED: f64 = 1e-12;

/// A point with what belongs to it.
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
        for (k, law) in scaled.laws().iter().enumerate() {
            let own = law.residual(scaled.at(k, &r), scaled.at(k, &u));
            merit += 0.5 * own.map(|f| f * f).iter().sum::<f64>() / law.stiffness;
            scaled.put(k, own, &mut f);
        }
        Point { r, u, f, merit }
    }

    /// The point a `step` along `(dr, du)`.
    fn ahead(&self, scaled: &ScaledContacts, step: f64, dr: &[f64], du: &[f64]) -> Self {
        let along = |x: &[f64], dx: &[f64]| x.iter().zip(dx).map(|(x, dx)| x + step * dx).collect();
        Point::new(scaled, along(&self.r, dr), along(&self.u, du))
    }

    /// The direction, with an `ε` that grows until there is one.
    fn direction(&self, scaled: &ScaledContacts, proximal: &mut f64) -> Option<Vec<f64>> {
        let at =
            |(k, law): (usize, &super::law::LocalContact)| law.linearize(scaled.at(k, &self.r), scaled.at(k, &self.u));
        let blocks: Vec<Linear> = scaled.laws().iter().enumerate().map(at).collect();
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

/// Iterates from `start` until the judge calls a point solved, at most `limit` times; how many iterations it took.
pub(super) fn newton(judge: &mut Judge<'_>, start: Vec<f64>, limit: usize) -> usize {
    let scaled = judge.scaled();
    let [least, largest] = PROXIMAL;
    let mut proximal = least;
    let u = scaled.velocities(&start);
    let mut point = Point::new(scaled, start, u);
    let mut error = judge.offer(&point.r);
    let (mut lowest, mut since, mut iterations) = (point.merit, 0, 0);
    while iterations < limit && since < PATIENCE && (!judge.solved() || error > POLISHED) {
        let last = judge.solved();
        let Some(dr) = point.direction(scaled, &mut proximal) else { break };
        iterations += 1;
        let du = scaled.delassus.mul(&dr);
        let (mut step, mut halvings) = (1.0, 0);
        let mut ahead = point.ahead(scaled, step, &dr, &du);
        // Not a number is no decrease.
        let falls = |ahead: &Point, step: f64| ahead.merit <= (1.0 - 2.0 * SIGMA * step) * point.merit;
        while halvings < HALVINGS && !falls(&ahead, step) {
            (step, halvings) = (0.5 * step, halvings + 1);
            ahead = point.ahead(scaled, step, &dr, &du);
        }
        // Velocities that are added up step by step would drift away from their forces.
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
