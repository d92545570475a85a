//! The stresses of a body from its displacements.

use super::Model;
use crate::fem::stress_at;
use crate::problem::ProblemError;
use crate::problem::error::expect_length;

impl Model {
    /// The stress `(σ_xx, σ_yy, σ_zz, τ_xy, τ_yz, τ_zx)` (Pa) at the centre of every cell, for the displacements
    /// of all nodes (m); with `σ_zz` of plane strain, and 0 in plane stress.
    ///
    /// # Errors
    /// When there is not one displacement for each node of the mesh.
    pub fn centre_stresses(&self, displacements: &[[f64; 3]]) -> Result<Vec<[f64; 6]>, ProblemError> {
        expect_length("displacements", self.mesh.nodes.len(), displacements.len(), "one for each node of the mesh")?;
        Ok(self.stresses(displacements))
    }

    /// [`Model::centre_stresses`] of displacements that fit.
    pub(crate) fn stresses(&self, displacements: &[[f64; 3]]) -> Vec<[f64; 6]> {
        let cells = self.mesh.cells.iter().enumerate();
        cells.map(|(e, cell)| self.stress_in(e, cell.kind.centre(), displacements)).collect()
    }

    /// The same at the reference point `point` of cell `e`.
    pub(crate) fn stress_in(&self, e: usize, point: [f64; 3], displacements: &[[f64; 3]]) -> [f64; 6] {
        let (cell, material) = (&self.mesh.cells[e], &self.materials[e]);
        let corners = self.mesh.points(&cell.nodes);
        let corner_displacements: Vec<_> = cell.nodes.iter().map(|&node| displacements[node]).collect();
        // Assembly has refused cells that have none.
        let stress = stress_at(cell.kind, point, &corners, &corner_displacements, self.element(), material);
        let mut stress = stress.unwrap_or([f64::NAN; 6]);
        if self.is_thin() {
            stress[2] = 0.0;
        }
        stress
    }
}
