//! Displacements and strains that are not small.

use super::prelude::*;
use crate::algebra::vector::norm;

kinds! {
    /// Displacements are above a tenth of the body's size, but assumed to be small.
    LARGE_DISPLACEMENTS("large-displacements", "Check the units.", "never");
    /// The mean strain (root mean square weighted by the strain energy) is above 1 %, but assumed to be small: forces and
    /// displacements are off by about as much.
    LARGE_STRAINS("large-strains", "Check the modulus and its unit; a program for large strains.",
        "the share in the message suffices");
}

/// The displacement, relative to the body's size, above which displacements are not small. A rotation of this size
/// turns normals by six degrees, and the neglected squares of strains reach a percent.
pub(super) const NOT_SMALL: f64 = 0.1;

/// The mean strain above which a warning is given: forces are off by about a percent.
const LARGE_STRAIN: f64 = 0.01;

/// The largest displacement, with the position of its node, m.
#[derive(Debug, Clone, PartialEq, Default, Serialize, Deserialize)]
pub(super) struct LargeDisplacements(pub(super) Largest<[f64; 3]>);

impl Check for LargeDisplacements {
    fn observe(&mut self, model: &Model, step: &IncrementView<'_>, _: &SoFar) {
        let is_revolved = model.mesh.geometry.is_revolved();
        for (position, mut u) in model.mesh.nodes.iter().zip(model.displaced(step.record.time, &step.state.u)) {
            // A body of revolution may turn by any angle.
            u[2] = if is_revolved { 0.0 } else { u[2] };
            // No length exceeds the sum of its components, which is faster to compute.
            let largest = self.0.0.map_or(-1.0, |(length, ..)| length);
            if u.iter().map(|u| u.abs()).sum::<f64>() > largest {
                self.0.add(step, Some((norm(u), *position)));
            }
        }
    }

    fn warning(&self, model: &Model, _: &SoFar) -> Option<Warning> {
        let (units, size) = (model.units(), model.mesh.size());
        let (length, time, position) = self.0.above(NOT_SMALL * size)?;
        let (place, moved, share) = (units.point(*position), units.rounded(Quantity::Length, length, 3), length / size);
        let [lengths, stresses] = [Quantity::Length, Quantity::Stress].map(|quantity| units.name(quantity));
        Some(WarningKind::LARGE_DISPLACEMENTS.warning(format!(
            "displacements are assumed to be small, but the node {place} moves by {moved} at t = {time} s, {:.0} % of the \
             body's size; are lengths in {lengths}, moduli and tractions in {stresses}?",
            100.0 * share
        )))
    }
}

/// Warns if strains are not small. The cause of large displacements is that of the strains.
pub(super) fn strains(Solved { model, checks, estimates, .. }: &Solved<'_>) -> Option<Warning> {
    let are_small = || checks.displacements.warning(model, &checks.so_far).is_none();
    let strain = estimates.strain.filter(|strain| *strain > LARGE_STRAIN && are_small())?;
    let (share, stresses) = (100.0 * strain, model.units().name(Quantity::Stress));
    Some(WarningKind::LARGE_STRAINS.warning(format!(
        "strains are assumed to be small, but their mean is {share:.1} %: forces and displacements may be off by about as much, \
         because linear elasticity neglects their squares and the change of shape; press less, use a program for large \
         strains, or correct the modulus, which is in {stresses}"
    )))
}
