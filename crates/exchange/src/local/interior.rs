//! The predictor–corrector interior point method for the exact law of a local problem.
//!
//! The equations of `cone` are solved at all contacts. The path starts far inside the cones and follows products `τ`
//! that go to zero, with `σ` after Mehrotra. The matrix has a tiny constant proximal term, as in BN. The start is cold:
//! a force that would stop the largest free velocity at every contact. The result is accurate to a few digits, and BN
//! completes it.
//!
//! The law is not monotone, so a path may come to a dead end. Other paths often succeed: from further inside (`reach`),
//! or with the cone equation satisfied at every step (`on_cone`), which is slower.

mod cone;

use super::judge::Judge;
use super::law::{Linear, LocalContact, Vector3};
use super::scaled::ScaledContacts;
use super::system::FactoredMatrix;
use cone::{Missing, Unknowns};

/// The share of the distance to the boundary that a step may cover.
const SHARE: f64 = 0.99;
/// A shorter step has jammed, and a centred step is taken instead.
const JAMMED: f64 = 0.1;
/// The share of the cone's reserve that must remain after a step on the cone.
const LEFT: f64 = 0.01;
/// The factor by which such a step is shortened until enough remains, and the largest number of reductions.
const SHORTER: (f64, usize) = (0.8, 30);
/// The proximal term: sufficient if forces are not unique, negligible otherwise.
const PROXIMAL: f64 = 1e-9;
/// The natural map at which BN takes over.
const HANDOVER: f64 = 1e-8;
/// The number of iterations without an error below 0.9 of the least, after which a path is a dead end.
const PATIENCE: usize = 15;

/// The way in which a path is followed.
#[derive(Debug, Clone, Copy)]
pub(super) struct Path {
    /// The starting distance inside the cones, as a multiple of the value estimated from the data.
    reach: f64,
    /// `true` if the cone equation holds at every point, and not only at the end.
    on_cone: bool,
}

/// Returns a path that satisfies the cone equation only at its end.
pub(super) const fn plain(reach: f64) -> Path {
    Path { reach, on_cone: false }
}

impl Path {
    /// Returns the same path with the cone equation satisfied at every step.
    pub(super) const fn on_cone(self) -> Path {
        Path { on_cone: true, ..self }
    }
}

/// Follows `path` for at most `limit` iterations. Returns the best forces on it, and the number of iterations.
pub(super) fn interior(judge: &mut Judge<'_>, path: Path, limit: usize) -> (Vec<f64>, usize) {
    let scaled = judge.scaled;
    let mut points = start(scaled, path.reach);
    let mut best = forces(scaled, &points);
    let (mut least, mut since, mut iterations) = (f64::INFINITY, 0, 0);
    while iterations < limit && since < PATIENCE && least > HANDOVER {
        iterations += 1;
        let Some(next) = advance(scaled, &points, path.on_cone) else { break };
        points = next;
        let r = forces(scaled, &points);
        let error = judge.offer(&r);
        since = if error < 0.9 * least { 0 } else { since + 1 };
        if error < least {
            (least, best) = (error, r);
        } else if !error.is_finite() {
            break;
        }
    }
    (best, iterations)
}

/// Returns the cold start, from the root of the largest energy `q² / W` of any contact, which does not depend on units.
fn start(scaled: &ScaledContacts, reach: f64) -> Vec<Unknowns> {
    let mut root = 0.0_f64;
    for (k, law) in scaled.laws.iter().enumerate() {
        root = scaled.at(k, &scaled.q).iter().fold(root, |m, q| m.max(q.abs() * law.stiffness.sqrt()));
    }
    let of_contact = |law: &LocalContact| {
        let (root, stiffness) = (reach * root, law.stiffness.sqrt());
        Unknowns::start(law, root * stiffness, root / stiffness)
    };
    scaled.laws.iter().map(of_contact).collect()
}

/// Returns the forces of all contacts.
fn forces(scaled: &ScaledContacts, points: &[Unknowns]) -> Vec<f64> {
    let mut r = vec![0.0; scaled.rows()];
    points.iter().enumerate().for_each(|(k, point)| scaled.put(k, point.r, &mut r));
    r
}

/// Performs one iteration: predictor, corrector, step. Returns `None` if the matrix is singular or no step is possible.
fn advance(scaled: &ScaledContacts, points: &[Unknowns], on_cone: bool) -> Option<Vec<Unknowns>> {
    let laws = &scaled.laws;
    let (blocks, sizes): (Vec<Linear>, Vec<[f64; 2]>) =
        points.iter().zip(laws).map(|(point, law)| point.linearize(law)).unzip();
    let mut system = FactoredMatrix::new(scaled, &blocks, PROXIMAL).ok()?;
    let mut solve = |missing: &[Missing]| -> Vec<Unknowns> {
        let mut rhs = vec![0.0; scaled.rows()];
        for (k, missing) in missing.iter().enumerate() {
            scaled.put(k, points[k].reduce(&laws[k], sizes[k], missing), &mut rhs);
        }
        let dr = system.solve(&rhs);
        let du = scaled.product(&dr);
        let own = |k: usize| points[k].recover(&laws[k], &missing[k], scaled.at(k, &dr), scaled.at(k, &du));
        (0..points.len()).map(own).collect()
    };
    let all = missing(scaled, points);

    // The predictor aims at the solution.
    let predicted = solve(&all);
    let beta = mean_product(scaled, points, &predicted, 0.0);
    let reach = largest_step(scaled, points, &predicted).min(1.0);
    let sigma = (mean_product(scaled, points, &predicted, reach) / beta).powi(3).clamp(0.0, 1.0);

    // The corrector aims at products of σ β, and takes their second order from the predictor.
    let mut aimed = all.clone();
    for (missing, change) in aimed.iter_mut().zip(&predicted) {
        missing.products[0] += sigma * beta - change.r[0] * change.v;
        missing.products[1] += sigma * beta - change.s * change.lambda;
    }
    let mut direction = solve(&aimed);
    let mut step = (SHARE * largest_step(scaled, points, &direction)).min(1.0);
    if step < JAMMED {
        // A very short predictor step does not predict the second order. The centred step omits it, with σ = 1.
        let mut centred = all;
        for missing in &mut centred {
            missing.products = missing.products.map(|product| product + beta);
        }
        direction = solve(&centred);
        step = (SHARE * largest_step(scaled, points, &direction)).min(1.0);
    }
    let ahead = |step: f64| -> Vec<Unknowns> {
        points.iter().zip(&direction).map(|(point, direction)| point.ahead(step, direction)).collect()
    };
    let next = if on_cone { shortened(scaled, points, step, ahead)? } else { ahead(step) };
    next.iter().all(|point| point.r.iter().all(|r| r.is_finite())).then_some(next)
}

/// Returns the longest step that keeps all forces inside their cones, with the reserve of the cones after it.
fn shortened(
    scaled: &ScaledContacts,
    points: &[Unknowns],
    mut step: f64,
    ahead: impl Fn(f64) -> Vec<Unknowns>,
) -> Option<Vec<Unknowns>> {
    for _ in 0..SHORTER.1 {
        let mut next = ahead(step);
        let mut inside = true;
        for ((point, next), law) in points.iter().zip(&mut next).zip(&scaled.laws) {
            if law.tangents > 0 {
                next.s = next.room(law);
                inside &= next.s >= LEFT * point.s;
            }
        }
        if inside {
            return Some(next);
        }
        step *= SHORTER.0;
    }
    None
}

/// Returns the residuals at all contacts.
fn missing(scaled: &ScaledContacts, points: &[Unknowns]) -> Vec<Missing> {
    let u: Vec<f64> = scaled.velocities(&forces(scaled, points));
    let own = |k: usize| -> Vector3 { scaled.at(k, &u) };
    points.iter().zip(&scaled.laws).enumerate().map(|(k, (point, law))| point.missing(law, own(k))).collect()
}

/// Returns the mean product of all pairs after a step `t`.
fn mean_product(scaled: &ScaledContacts, points: &[Unknowns], direction: &[Unknowns], t: f64) -> f64 {
    let (mut sum, mut count) = (0.0, 0.0);
    for ((point, direction), law) in points.iter().zip(direction).zip(&scaled.laws) {
        for (a, b) in point.ahead(t, direction).pairs(law) {
            (sum, count) = (sum + a * b, count + 1.0);
        }
    }
    sum / count
}

/// Returns the step at which the first member of a pair becomes 0.
fn largest_step(scaled: &ScaledContacts, points: &[Unknowns], direction: &[Unknowns]) -> f64 {
    let mut largest = f64::INFINITY;
    for ((point, direction), law) in points.iter().zip(direction).zip(&scaled.laws) {
        for ((a, b), (da, db)) in point.pairs(law).zip(direction.pairs(law)) {
            for (x, dx) in [(a, da), (b, db)] {
                if dx < 0.0 {
                    largest = largest.min(-x / dx);
                }
            }
        }
    }
    largest
}
