//! The rest position of a body that only contact holds.
//!
//! Obstacles that penetrate the body push it out, by the smallest rigid motion that leaves all of them, if there is
//! one. Then the load moves the body along the rigid motion that it drives, and nodes touch one after another, until
//! their contact forces balance the load.
//!
//! The body is rigid and follows its load arbitrarily slowly. It moves along the difference of the load and the
//! nearest combination of normal forces, which does not lead into any obstacle that it touches. The work of the load
//! therefore grows all the time, and the motion has at most as many segments as nodes come to touch. Friction can end
//! the motion, but does not change its direction.

use super::cone::{FiniteCone, norm};
use super::{Free, FrictionCone, Load, unbalanced};
use crate::algebra::linear::Computed;
use crate::algebra::null_space::NEGLIGIBLE;
use crate::algebra::vector::dot;
use crate::solver::problem::ContactProblem;

/// The largest number of rounds. Three or six nodes bring a body to rest; others may touch in the meantime.
const ROUNDS: usize = 100;

/// A contact node touches its obstacle if its distance, relative to its gap, is smaller.
pub(crate) const NEARBY: f64 = 1e-10;

/// The longest motion out of obstacles, relative to the deepest penetration, times [`NEGLIGIBLE`]: in a ring that a shaft
/// fills, normals of facets, which are turned a little, would turn the ring by radians.
const LONGEST: f64 = 1e8;

/// The largest `K r` of a rigid mode `r` along which a body may move, relative to its terms: ten times the rounding
/// in rotations of bodies with a thousand elements per side.
const UNSTRAINED: f64 = 1e-12;

/// The rest position of a body.
pub(crate) struct Landing {
    /// The weights of the problem's rigid modes in the motion to that position.
    pub weights: Vec<f64>,
    /// The contact nodes that touch there.
    pub nodes: Vec<usize>,
}

/// Returns the motion of a body under `load` to its rest position, or `None` if nothing stops it. Its contact nodes
/// are at `distance` from their obstacles (n_c, m) and count as touching within `tolerance` (n_c, m).
pub(crate) fn landing(
    problem: &ContactProblem,
    mu: &[f64],
    load: &Load<'_>,
    distance: &[f64],
    tolerance: &[f64],
) -> Option<Landing> {
    let free = Free::new(problem);
    let (load, sizes) = free.work(load);
    let size = norm(&sizes);
    let cones: Vec<FrictionCone> =
        (0..problem.contacts()).map(|i| FrictionCone::of(problem, mu[i], &free, i)).collect();
    let (mut distance, mut motion) = (distance.to_vec(), vec![0.0; load.len()]);
    if distance.iter().zip(tolerance).any(|(distance, reach)| -distance > *reach)
        && let Some(out) = pushed_out(&cones, &distance)
    {
        for (cone, distance) in cones.iter().zip(&mut distance) {
            *distance -= dot(&cone.normal, &out);
        }
        motion = out;
    }
    for _ in 0..ROUNDS {
        let (nodes, apart): (Vec<usize>, Vec<usize>) = (0..cones.len()).partition(|&i| distance[i] <= tolerance[i]);
        let touching: Vec<&FrictionCone> = nodes.iter().map(|&i| &cones[i]).collect();
        let driven = unbalanced(&touching, &load, size).and_then(|_| {
            FiniteCone::new(load.len(), touching.iter().map(|cone| cone.normal.clone())).outside(&load, size)
        });
        let Some(y) = driven else { return Some(Landing { weights: free.weights_of(&motion), nodes }) };
        let y: Vec<f64> = y.iter().map(|x| x / norm(&y)).collect();
        // A rounding component of the motion towards an obstacle does not count.
        let nearing = |i: usize| Some(dot(&cones[i].normal, &y)).filter(|w| *w > NEGLIGIBLE * norm(&cones[i].normal));
        let step = apart.iter().filter_map(|&i| Some(distance[i] / nearing(i)?)).min_by(f64::total_cmp)?;
        for (i, distance) in distance.iter_mut().enumerate() {
            if let Some(nearing) = nearing(i) {
                let remaining = *distance - step * nearing;
                *distance = if remaining <= NEGLIGIBLE * *distance { remaining.min(0.0) } else { remaining };
            } else {
                *distance -= step * dot(&cones[i].normal, &y).min(0.0);
            }
        }
        motion.iter_mut().zip(&y).for_each(|(way, y)| *way += step * y);
    }
    None
}

/// Returns the smallest `a` with `n · a ≤ distance` for all nodes, if there is any. This is the least distance
/// problem of Lawson and Hanson (1974, chapter 23), which a projection on a cone of one more dimension solves.
fn pushed_out(cones: &[FrictionCone], distance: &[f64]) -> Option<Vec<f64>> {
    let largest = distance.iter().fold(0.0_f64, |m, distance| m.max(-distance));
    let dimension = cones.first()?.normal.len();
    let generator = |(cone, distance): (&FrictionCone, &f64)| {
        let row = cone.normal.iter().map(|n| -n).chain([-distance / largest]);
        row.collect::<Vec<f64>>()
    };
    let one = [vec![0.0; dimension], vec![1.0]].concat();
    let outside = FiniteCone::new(dimension + 1, cones.iter().zip(distance).map(generator)).outside(&one, LONGEST)?;
    Some(outside[..dimension].iter().map(|x| -x * largest / outside[dimension]).collect())
}

/// Returns `true` if a body has rigid modes, and they cause no strain beyond rounding.
///
/// # Errors
/// If a rank that shares the stiffness has failed.
pub(crate) fn is_carried_without_strain(problem: &ContactProblem) -> Computed<bool> {
    let largest = |x: &[f64]| x.iter().fold(0.0_f64, |m, x| m.max(x.abs()));
    for motion in problem.rigid_modes() {
        let (mut force, sizes) = (vec![0.0; motion.len()], problem.stiffness().sizes(motion)?);
        problem.stiffness().mul(motion, &mut force)?;
        if largest(&force) > UNSTRAINED * largest(&sizes) {
            return Ok(false);
        }
    }
    Ok(!problem.rigid_modes().is_empty())
}
