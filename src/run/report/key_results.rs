//! The results that a reader asks for first, each with its errors: the largest force, the holding force, the friction
//! work, the stick zone.
//! The largest pressure is in [`super::LargestPressure`].

use serde::{Deserialize, Serialize};

use super::estimates::Estimates;
use super::largest::is_as_large;
use super::resultant::{ForceRecord, Resultant};
use crate::body::mesh::Geometry;
use crate::solver::history::{IncrementRecord, Status};

/// The largest contact force of a history.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[non_exhaustive]
pub struct LargestForce {
    /// The boundary.
    pub boundary: String,
    /// The resultant on the obstacle or the opposing body: x, y and, in three dimensions, z, N; in two dimensions N per
    /// m of depth.
    pub force: Vec<f64>,
    /// Its magnitude, N; for a body of revolution the axial force, because the radial forces balance each other.
    pub magnitude: f64,
    /// The time, s.
    pub time: f64,
    /// The error of the mesh, as a share, unless loads alone determine the force: `(e / 0.6)²` for the error e in the energy
    /// norm, an upper estimate at singular corners. `None` if e is unknown.
    pub mesh_error: Option<f64>,
    /// The error of the tangential forces by the time steps, as a share of the largest tangential force, if it was
    /// estimated.
    pub time_error: Option<f64>,
}

/// The largest tangential force of a contact in a history: the force by which it holds, or at which it is drawn out.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[non_exhaustive]
pub struct HoldingForce {
    /// The boundary.
    pub boundary: String,
    /// The magnitude of (Σ p_t, Σ p_o), N; in two dimensions |Σ p_t|, N per m of depth. On a curved boundary it is the sum
    /// along the turning tangents.
    pub magnitude: f64,
    /// The time, s.
    pub time: f64,
    /// The error of the mesh, as a share of the largest tangential force. `None` if it is unknown.
    pub mesh_error: Option<f64>,
    /// The error of the time steps, as a share of the largest tangential force, if it was estimated.
    pub time_error: Option<f64>,
}

/// The friction work of a history.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[non_exhaustive]
pub struct FrictionResult {
    /// The friction work of all increments, J; in two dimensions J per m of depth.
    pub friction_work: f64,
    /// An upper estimate of the error of the mesh, as a share: one node of the width of each slip zone, in the root mean square
    /// weighted by the friction work, or the error of the tangential forces if that is larger. `None` if both are unknown.
    pub mesh_error: Option<f64>,
    /// The error of the time steps, as a share, if it was estimated; it is positive if the work is too large.
    pub time_error: Option<f64>,
}

/// Friction work below this share of the negligible one is rounding.
const ROUNDING: f64 = 1e-8;

/// Collects the largest force and the friction work during a history.
#[derive(Debug, Clone, PartialEq, Default, Serialize, Deserialize)]
pub struct KeyWatch {
    largest: Option<LargestForce>,
    holding: Option<HoldingForce>,
    work: f64,
}

impl KeyWatch {
    /// Examines an increment, with the `forces` at its end. Increments that did not converge are ignored.
    pub fn see(&mut self, geometry: Geometry, record: &IncrementRecord, forces: &[ForceRecord]) {
        if record.status != Status::Converged {
            return;
        }
        self.work += record.friction_work;
        let first = usize::from(geometry == Geometry::Axisymmetric);
        for ForceRecord { time, resultant, .. } in forces {
            self.see_tangential(resultant, *time);
            let magnitude = resultant.force[first..].iter().map(|f| f * f).sum::<f64>().sqrt();
            let so_far = self.largest.as_ref().map_or(0.0, |largest| largest.magnitude);
            // The first of equally large forces counts.
            if magnitude > 0.0 && !is_as_large(so_far, magnitude) {
                self.largest = Some(LargestForce {
                    boundary: resultant.boundary.clone(),
                    force: resultant.force.clone(),
                    magnitude,
                    time: *time,
                    mesh_error: None,
                    time_error: None,
                });
            }
        }
    }

    fn see_tangential(&mut self, resultant: &Resultant, time: f64) {
        let magnitude = resultant.sums.sum_p_t.hypot(resultant.sums.sum_p_o.unwrap_or(0.0));
        let so_far = self.holding.as_ref().map_or(0.0, |holding| holding.magnitude);
        if magnitude > 0.0 && !is_as_large(so_far, magnitude) {
            let boundary = resultant.boundary.clone();
            self.holding = Some(HoldingForce { boundary, magnitude, time, mesh_error: None, time_error: None });
        }
    }

    /// Returns the largest tangential force with its errors; `None` without any.
    pub(super) fn holding_force(&self, estimates: &Estimates) -> Option<HoldingForce> {
        let (mesh_error, time_error) = (estimates.tangential, estimates.force_error());
        self.holding.clone().map(|holding| HoldingForce { mesh_error, time_error, ..holding })
    }

    /// Returns the largest force with its errors; `None` without contact.
    pub(super) fn largest_force(&self, estimates: &Estimates) -> Option<LargestForce> {
        let (mesh_error, time_error) = (estimates.force_error_of_mesh(), estimates.force_error());
        self.largest.clone().map(|largest| LargestForce { mesh_error, time_error, ..largest })
    }

    /// Returns the friction work with its errors; `None` if nothing slipped.
    pub(super) fn friction(&self, estimates: &Estimates) -> Option<FrictionResult> {
        let by_width = estimates.work_by_width;
        (self.work > ROUNDING * estimates.negligible_work).then_some(FrictionResult {
            friction_work: self.work,
            mesh_error: by_width.into_iter().chain(estimates.tangential).reduce(f64::max),
            time_error: estimates.increments.map(|increments| increments.work_error),
        })
    }
}
