//! The strain energy of a body.

use super::Model;
use crate::algebra::vector::dot;
use crate::body::fem::{Spring, free_stretch, strains, with_dilatation};
use crate::body::mesh::{corner_shape, quadrature_of};
use crate::solver::problem::State;

impl Model {
    /// Computes the strain energy of the body and its springs at time `t` (s), J; in two dimensions per m of depth, for
    /// a body of revolution over the full circumference:
    ///
    /// ```text
    /// ½ ∫ (ε - ε₀) D (ε - ε₀) dV + ½ uᵀ K_s u
    /// ```
    ///
    /// with the stress-free strain ε₀ of thermal loads, taken at the centre of each cell. Without thermal loads and
    /// moving supports, the energy is `½ uᵀ K u`, and the result is `None`.
    pub(crate) fn strain_energy(&self, t: f64, state: &State) -> Option<f64> {
        if self.thermal.is_empty() && self.moved.is_empty() {
            return None;
        }
        let displacements = self.displaced(t, &state.u);
        let factors = self.thermal_factors(t);
        let of_cell = |e: usize| {
            let (whole, shares) = (self.materials[e], !self.volumes.of_cell(e).is_empty());
            let law = if shares { whole.deviatoric() } else { whole };
            let strains = self.elastic_strains(e, &factors, &displacements);
            strains.iter().map(|(volume, strain)| volume * law.energy_density(strain)).sum::<f64>()
        };
        let springs = self.statics.springs().map(|spring: &Spring| spring.energy(&displacements));
        let of_volumes = self.volumes.energy(|a| self.elastic_dilatation(a, &factors, &displacements));
        Some((0..self.mesh.cells.len()).map(of_cell).sum::<f64>() + of_volumes + springs.sum::<f64>())
    }

    /// Computes the elastic strains of cell `e` at its integration points, without the thermal strain, each with its
    /// volume.
    pub(crate) fn elastic_strains(
        &self,
        e: usize,
        factors: &[f64],
        displacements: &[[f64; 3]],
    ) -> Vec<(f64, [f64; 6])> {
        let cell = &self.mesh.cells[e];
        let nodes = self.mesh.points(&cell.nodes);
        let moved: Vec<_> = cell.nodes.iter().map(|&node| displacements[node]).collect();
        // Assembly has already failed for cells without a valid strain.
        let mut strains = strains(cell.kind, self.mesh.geometry, &nodes, &moved, self.element()).unwrap_or_default();
        if let Some(at_corners) = self.corner_dilatations(e, factors, displacements) {
            for ((_, strain), (point, _)) in
                strains.iter_mut().zip(quadrature_of(cell.kind, self.mesh.geometry, &nodes))
            {
                *strain = with_dilatation(*strain, dot(&at_corners, corner_shape(cell.kind, point)));
            }
        } else if !factors.is_empty() {
            let free = self.free_stretch(e, factors);
            for (_, strain) in &mut strains {
                strain.iter_mut().zip(free).for_each(|(strain, free)| *strain -= free);
            }
        }
        strains
    }

    /// Returns the thermal strain of cell `e`.
    pub(crate) fn free_stretch(&self, e: usize, factors: &[f64]) -> [f64; 6] {
        free_stretch(self.is_thin(), self.free_strain(e, factors))
    }
}
