//! The strain energy of a body.

use super::Model;
use crate::fem::{Spring, free_stretch, strain_energy};
use crate::mesh::Cell;
use crate::problem::State;

impl Model {
    /// The strain energy of the body and its springs at time `t` (s), J, in two dimensions per m of depth:
    ///
    /// ```text
    /// ½ ∫ (ε - ε₀) D (ε - ε₀) dV + ½ uᵀ K_s u
    /// ```
    ///
    /// with the stress-free strain ε₀ of loads by temperature, which counts as that at the centre of each cell. Where there are
    /// none of these and no support moves the body, this is `½ uᵀ K u`, and nothing is computed: `None`.
    pub(crate) fn strain_energy(&self, t: f64, state: &State) -> Option<f64> {
        if self.thermal.is_empty() && self.moved.is_empty() {
            return None;
        }
        let displacements = self.displaced(t, &state.u);
        let factors = self.thermal_factors(t);
        let of_cell = |(e, cell): (usize, &Cell)| {
            let corners = self.mesh.points(&cell.nodes);
            let moved: Vec<_> = cell.nodes.iter().map(|&node| displacements[node]).collect();
            let free = free_stretch(self.is_thin(), self.free_strain(e, &factors));
            // Assembly has refused cells that have none.
            strain_energy(cell.kind, &corners, &moved, self.element(), &self.materials[e], free).unwrap_or(f64::NAN)
        };
        let springs = self.statics.springs().map(|spring: &Spring| spring.energy(&displacements));
        Some(self.mesh.cells.iter().enumerate().map(of_cell).sum::<f64>() + springs.sum::<f64>())
    }
}
