//! Hertz's solution for a round obstacle and the computed force, for comparison if the mesh is too coarse to be judged
//! otherwise.

use std::f64::consts::PI;

use serde::Serialize;

use crate::algebra::vector::{cross, dot, norm};
use crate::body::contact::Round;
use crate::body::fem::Elasticity;
use crate::body::model::Model;

/// The Hertz contact of a rigid cylinder or sphere with a half-space.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, schemars::JsonSchema)]
pub struct HertzContact {
    /// The half-width of the contact or its radius, m.
    pub half_width: f64,
    /// The largest pressure, Pa.
    pub peak_pressure: f64,
}

/// Two held directions are normal to the same symmetry plane if the sine between them is smaller than this. A centre is
/// on the axis if its distance divided by the radius is at most this.
const SAME: f64 = 1e-3;

impl HertzContact {
    /// Computes the contact of a cylinder of `radius` (m) with the line force `line` (N/m) on a body of `modulus` E/(1
    /// - ν²) (Pa).
    fn of_line(line: f64, radius: f64, modulus: f64) -> Self {
        let half_width = (4.0 * line * radius / (PI * modulus)).sqrt();
        HertzContact { half_width, peak_pressure: 2.0 * line / (PI * half_width) }
    }

    /// Computes the contact of a sphere with the `force` (N).
    fn of_point(force: f64, radius: f64, modulus: f64) -> Self {
        let half_width = (0.75 * force * radius / modulus).cbrt();
        HertzContact { half_width, peak_pressure: 1.5 * force / (PI * half_width * half_width) }
    }

    /// Computes the Hertz contact for the forces `p_n` (N) at `time` (s) on the `closed` contact nodes of a flat
    /// surface, if the obstacle in front of its node `peak` is a cylinder or a sphere.
    pub(super) fn under(model: &Model, time: f64, p_n: &[f64], closed: &[usize], peak: usize) -> Option<Self> {
        let assigned = |i: usize| model.assigned(i, time).map(|(k, _)| k);
        let obstacle = assigned(peak)?;
        let Round { radius, centre, axis } = model.contact.obstacles[obstacle].0.roundness()?;
        let nodes: Vec<usize> = closed.iter().copied().filter(|&i| assigned(i) == Some(obstacle)).collect();
        let force: f64 = nodes.iter().map(|&i| p_n[i]).sum();
        let modulus = modulus(model, model.contact.nodes[peak].node)?;
        if model.mesh.geometry.is_revolved() {
            // The force is that of the full circumference. Hertz's solution does not apply to a ring of contact.
            let on_axis =
                centre[0].abs() <= SAME * radius && nodes.iter().any(|&i| model.contact.nodes[i].position[0] == 0.0);
            return on_axis.then(|| Self::of_point(force, radius, modulus));
        }
        let force = force * f64::from(mirrors(model, &nodes, axis));
        match axis {
            None => Some(Self::of_point(force, radius, modulus)),
            Some(_) if model.mesh.dimension == 2 => Some(Self::of_line(force, radius, modulus)),
            Some(axis) => {
                let along = nodes.iter().map(|&i| dot(model.contact.nodes[i].position, axis));
                let (first, last) =
                    along.fold((f64::INFINITY, f64::NEG_INFINITY), |(first, last), s| (first.min(s), last.max(s)));
                (last > first).then(|| Self::of_line(force / (last - first), radius, modulus))
            }
        }
    }
}

/// Returns the factor from the computed to the full contact by symmetry planes: 1, 2 or 4. Planes across the `axis` of
/// a cylinder change its length but not the line force.
fn mirrors(model: &Model, nodes: &[usize], axis: Option<[f64; 3]>) -> u8 {
    let mut planes: Vec<[f64; 3]> = Vec::new();
    for &i in nodes {
        let normal = model.contact.nodes[i].facing.normal;
        for held in model.constraints.dofs.held(model.contact.nodes[i].node) {
            let new = planes.iter().chain(&axis).all(|plane| norm(cross(*plane, held)) > SAME);
            let in_space = model.mesh.dimension == 3 || held[2] == 0.0;
            if new && in_space && dot(held, normal).abs() < super::graph::ALONG && planes.len() < 2 {
                planes.push(held);
            }
        }
    }
    1 << planes.len()
}

/// Returns `E/(1 - ν²)` (Pa) of the body at `node`; in plane stress `E`.
fn modulus(model: &Model, node: usize) -> Option<f64> {
    let cell = model.mesh.cells.iter().position(|cell| cell.nodes.contains(&node))?;
    let Elasticity { lambda, mu, .. } = model.materials()[cell];
    Some(4.0 * mu * (lambda + mu) / (lambda + 2.0 * mu))
}
