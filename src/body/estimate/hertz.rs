//! What Hertz has for a round obstacle and the force that was found: it tells how far off a mesh is that cannot.

use std::f64::consts::PI;

use serde::Serialize;

use crate::algebra::vector::{cross, dot, norm};
use crate::body::contact::Round;
use crate::body::fem::Elasticity;
use crate::body::mesh::Geometry;
use crate::body::model::Model;

/// Hertz' contact of a rigid cylinder or sphere with a half-space.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct HertzContact {
    /// The half-width of the contact, or its radius, m.
    pub half_width: f64,
    /// The largest pressure, Pa.
    pub peak_pressure: f64,
}

/// Two held directions whose sine is smaller are one symmetry plane, and a centre that is as near to an axis, by the radius, is on it.
const SAME: f64 = 1e-3;

impl HertzContact {
    /// A line of force `line` (N/m) along a cylinder of `radius` (m) on a body of `modulus` E/(1 - ν²) (Pa).
    fn of_line(line: f64, radius: f64, modulus: f64) -> Self {
        let half_width = (4.0 * line * radius / (PI * modulus)).sqrt();
        HertzContact { half_width, peak_pressure: 2.0 * line / (PI * half_width) }
    }

    /// A `force` (N) on a sphere.
    fn of_point(force: f64, radius: f64, modulus: f64) -> Self {
        let half_width = (0.75 * force * radius / modulus).cbrt();
        HertzContact { half_width, peak_pressure: 1.5 * force / (PI * half_width * half_width) }
    }

    /// What the forces `p_n` (N) at `time` (s) on the `closed` contact nodes of a surface make under the obstacle before its node `peak`, where
    /// that is a cylinder or a sphere and the body is flat.
    pub(super) fn under(model: &Model, time: f64, p_n: &[f64], closed: &[usize], peak: usize) -> Option<Self> {
        let met = |i: usize| model.met(i, time).map(|(k, _)| k);
        let obstacle = met(peak)?;
        let Round { radius, centre, axis } = model.obstacles[obstacle].0.roundness()?;
        let nodes: Vec<usize> = closed.iter().copied().filter(|&i| met(i) == Some(obstacle)).collect();
        let force: f64 = nodes.iter().map(|&i| p_n[i]).sum();
        let modulus = modulus(model, model.contacts[peak].node)?;
        if model.mesh.geometry == Geometry::Axisymmetric {
            // The force is that all around; a ring of contact is none of Hertz'.
            let on_axis =
                centre[0].abs() <= SAME * radius && nodes.iter().any(|&i| model.contacts[i].position[0] == 0.0);
            return on_axis.then(|| Self::of_point(force, radius, modulus));
        }
        let force = force * f64::from(mirrors(model, &nodes, axis));
        match axis {
            None => Some(Self::of_point(force, radius, modulus)),
            Some(_) if model.mesh.dimension == 2 => Some(Self::of_line(force, radius, modulus)),
            Some(axis) => {
                let along = nodes.iter().map(|&i| dot(model.contacts[i].position, axis));
                let (first, last) =
                    along.fold((f64::INFINITY, f64::NEG_INFINITY), |(first, last), s| (first.min(s), last.max(s)));
                (last > first).then(|| Self::of_line(force / (last - first), radius, modulus))
            }
        }
    }
}

/// How many copies of the contact there are beside those that symmetry planes leave out: 1, 2 or 4. Planes across the `axis` of a
/// cylinder make it longer, but no heavier.
fn mirrors(model: &Model, nodes: &[usize], axis: Option<[f64; 3]>) -> u8 {
    let mut planes: Vec<[f64; 3]> = Vec::new();
    for &i in nodes {
        let normal = model.contacts[i].facing.normal;
        for held in model.dofs.held(model.contacts[i].node) {
            let new = planes.iter().chain(&axis).all(|plane| norm(cross(*plane, held)) > SAME);
            let in_space = model.mesh.dimension == 3 || held[2] == 0.0;
            if new && in_space && dot(held, normal).abs() < super::graph::ALONG && planes.len() < 2 {
                planes.push(held);
            }
        }
    }
    1 << planes.len()
}

/// `E/(1 - ν²)` (Pa) of the body at `node`; in plane stress `E`.
fn modulus(model: &Model, node: usize) -> Option<f64> {
    let cell = model.mesh.cells.iter().position(|cell| cell.nodes.contains(&node))?;
    let Elasticity { lambda, mu, .. } = model.materials()[cell];
    Some(4.0 * mu * (lambda + mu) / (lambda + 2.0 * mu))
}
