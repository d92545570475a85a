//! The stresses of a body from its displacements.

use super::Model;
use crate::fem::{centre_stress, thermal_stress};
use crate::problem::ProblemError;
use crate::problem::error::expect_length;

impl Model {
    /// The stress `(σ_xx, σ_yy, σ_zz, τ_xy, τ_yz, τ_zx)` (Pa) at the centre of every cell, for the displacements
    /// of all nodes (m) at time `t` (s); with `σ_zz` of plane strain, and 0 in plane stress. What heat alone makes of the strain
    /// is taken off.
    ///
    /// # Errors
    /// When there is not one displacement for each node of the mesh.
    pub fn centre_stresses(&self, t: f64, displacements: &[[f64; 3]]) -> Result<Vec<[f64; 6]>, ProblemError> {
        expect_length("displacements", self.mesh.nodes.len(), displacements.len(), "one for each node of the mesh")?;
        Ok(self.stresses(t, displacements))
    }

    /// [`Model::centre_stresses`] of displacements that fit.
    pub(crate) fn stresses(&self, t: f64, displacements: &[[f64; 3]]) -> Vec<[f64; 6]> {
        let factors: Vec<f64> = self.thermal.iter().map(|(_, load)| self.loading.cases()[*load].factor(t)).collect();
        let free_strain =
            |e: usize| -> f64 { self.thermal.iter().zip(&factors).map(|((of_cell, _), f)| f * of_cell[e]).sum() };
        let cells = self.mesh.cells.iter().zip(&self.materials).enumerate();
        cells
            .map(|(e, (cell, material))| {
                let corners = self.mesh.points(&cell.nodes);
                let corner_displacements: Vec<_> = cell.nodes.iter().map(|&node| displacements[node]).collect();
                // Assembly has refused cells that have none.
                let stress = centre_stress(cell.kind, &corners, &corner_displacements, self.element(), material);
                let mut stress = stress.unwrap_or([f64::NAN; 6]);
                if !factors.is_empty() {
                    let free = thermal_stress(material, self.is_thin(), free_strain(e));
                    stress.iter_mut().zip(free).for_each(|(s, free)| *s -= free);
                }
                if self.is_thin() {
                    stress[2] = 0.0;
                }
                stress
            })
            .collect()
    }
}
