//! The predictor–corrector interior point method for the exact law of a local problem.
//!
//! The equations are those of `cone`, at all contacts; the path leads from far inside along products `τ` that go to zero, with `σ` after
//! Mehrotra, and the matrix has the proximal term of BN, tiny and constant. The start is cold: a force that would stop the largest free
//! velocity at every contact. What it ends with is good to a few digits, and BN finishes it.
//!
//! The law is not monotone, and so a path may come to a dead end. Others, from further inside (`reach`) or with the cone kept
//! exactly at every step (`on_cone`), which is slower, often do not.

mod cone;

use super::judge::Judge;
use super::law::{Linear, LocalContact, Vector3};
use super::scaled::ScaledContacts;
use super::system::FactoredMatrix;
use cone::{Missing, Unknowns};

/// The share of the way to the border that a step may go.
const SHARE: f64 = 0.99;
/// A step that is shorter has jammed, and is taken centred instead.
const JAMMED: f64 = 0.1;
/// So much of what the cone left must be left after a step that keeps it.
const LEFT: f64 = 0.01;
/// Such a step is made shorter by this factor until it is kept, at most so many times.
const SHORTER: (f64, usize) = (0.8, 30);
/// The proximal term: enough where forces are not unique, too little to be felt elsewhere.
const PROXIMAL: f64 = 1e-9;
/// A natural map at which BN takes over.
const HANDOVER: f64 = 1e-8;
/// A dead end: so many iterations without an error below 0.9 of the least.
const PATIENCE: usize = 15;

/// How a path is followed.
#[derive(Debug, Clone, Copy)]
pub(super) struct Path {
    /// How far inside it begins, as a multiple of what the data say.
    reach: f64,
    /// Whether what the cone leaves is what the forces say at every point, and not only at the end.
    on_cone: bool,
}

/// A path that comes to the cone at its end only.
pub(super) const fn plain(reach: f64) -> Path {
    Path { reach, on_cone: false }
}

impl Path {
    /// The path that keeps to the cone.
    pub(super) const fn on_cone(self) -> Path {
        Path { on_cone: true, ..self }
    }
}

/// Follows `path`, at most `limit` iterations; the best forces on it, and how many iterations it took.
pub(super) fn interior(judge: &mut Judge<'_>, path: Path, limit: usize) -> (Vec<f64>, usize) {
    let scaled = judge.scaled();
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

/// The cold start, by the root of the largest energy `q² / W` of any contact: the same in whatever units.
fn start(scaled: &ScaledContacts, reach: f64) -> Vec<Unknowns> {
    let mut root = 0.0_f64;
    for (k, law) in scaled.laws().iter().enumerate() {
        root = scaled.at(k, &scaled.q).iter().fold(root, |m, q| m.max(q.abs() * law.stiffness.sqrt()));
    }
    let of_contact = |law: &LocalContact| {
        let (root, stiffness) = (reach * root, law.stiffness.sqrt());
        Unknowns::start(law, root * stiffness, root / stiffness)
    };
    scaled.laws().iter().map(of_contact).collect()
}

/// The forces of all contacts.
fn forces(scaled: &ScaledContacts, points: &[Unknowns]) -> Vec<f64> {
    let mut r = vec![0.0; scaled.rows()];
    points.iter().enumerate().for_each(|(k, point)| scaled.put(k, point.r, &mut r));
    r
}

/// One iteration: a predictor, a corrector, and the step; none where the matrix is singular or nothing can be done.
fn advance(scaled: &ScaledContacts, points: &[Unknowns], on_cone: bool) -> Option<Vec<Unknowns>> {
    let laws = scaled.laws();
    let (blocks, sizes): (Vec<Linear>, Vec<[f64; 2]>) =
        points.iter().zip(laws).map(|(point, law)| point.linearize(law)).unzip();
    let mut system = FactoredMatrix::new(scaled, &blocks, PROXIMAL).ok()?;
    let mut solve = |missing: &[Missing]| -> Vec<Unknowns> {
        let mut rhs = vec![0.0; scaled.rows()];
        for (k, missing) in missing.iter().enumerate() {
            scaled.put(k, points[k].reduce(&laws[k], sizes[k], missing), &mut rhs);
        }
        let dr = system.solve(&rhs);
        let du = scaled.delassus.mul(&dr);
        let own = |k: usize| points[k].recover(&laws[k], &missing[k], scaled.at(k, &dr), scaled.at(k, &du));
        (0..points.len()).map(own).collect()
    };
    let all = missing(scaled, points);

    // The predictor aims at the solution itself.
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
        // A predictor that gets nowhere tells nothing of the second order. Without it, σ = 1.
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

/// The longest step that keeps all forces inside their cones, with what these leave then.
fn shortened(
    scaled: &ScaledContacts,
    points: &[Unknowns],
    mut step: f64,
    ahead: impl Fn(f64) -> Vec<Unknowns>,
) -> Option<Vec<Unknowns>> {
    for _ in 0..SHORTER.1 {
        let mut next = ahead(step);
        let mut inside = true;
        for ((point, next), law) in points.iter().zip(&mut next).zip(scaled.laws()) {
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

/// What is missing at all contacts.
fn missing(scaled: &ScaledContacts, points: &[Unknowns]) -> Vec<Missing> {
    let u: Vec<f64> = scaled.velocities(&forces(scaled, points));
    let own = |k: usize| -> Vector3 { scaled.at(k, &u) };
    points.iter().zip(scaled.laws()).enumerate().map(|(k, (point, law))| point.missing(law, own(k))).collect()
}

/// The mean product of all pairs a step `t` ahead.
fn mean_product(scaled: &ScaledContacts, points: &[Unknowns], direction: &[Unknowns], t: f64) -> f64 {
    let (mut sum, mut count) = (0.0, 0.0);
    for ((point, direction), law) in points.iter().zip(direction).zip(scaled.laws()) {
        for (a, b) in point.ahead(t, direction).pairs(law) {
            (sum, count) = (sum + a * b, count + 1.0);
        }
    }
    sum / count
}

/// The step at which the first member of a pair becomes 0.
fn largest_step(scaled: &ScaledContacts, points: &[Unknowns], direction: &[Unknowns]) -> f64 {
    let mut largest = f64::INFINITY;
    for ((point, direction), law) in points.iter().zip(direction).zip(scaled.laws()) {
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
