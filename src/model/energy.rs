//! The strain energy of a body.

use super::Model;
use crate::fem::{Spring, free_stretch, strains, with_dilatation};
use crate::problem::State;

impl Model {
    /// The strain energy of the body and its springs at time `t` (s), J, in two dimensions per m of depth, of a body of revolution all around:
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
        let of_cell = |e: usize| {
            let strains = self.elastic_strains(e, &factors, &displacements);
            strains.iter().map(|(volume, strain)| volume * self.materials[e].energy_density(strain)).sum::<f64>()
        };
        let springs = self.statics.springs().map(|spring: &Spring| spring.energy(&displacements));
        Some((0..self.mesh.cells.len()).map(of_cell).sum::<f64>() + springs.sum::<f64>())
    }

    /// The strains of cell `e` at its integration points, each with its volume, beyond those that heat alone makes; where dilatations are
    /// averaged at the nodes, those of its nodes at each point, with their shares of its volume.
    pub(crate) fn elastic_strains(
        &self,
        e: usize,
        factors: &[f64],
        displacements: &[[f64; 3]],
    ) -> Vec<(f64, [f64; 6])> {
        let (cell, mesh) = (&self.mesh.cells[e], &self.mesh);
        let corners = mesh.points(&cell.nodes);
        let moved: Vec<_> = cell.nodes.iter().map(|&node| displacements[node]).collect();
        // Assembly has refused cells that have none.
        let mut strains = strains(cell.kind, mesh.geometry, &corners, &moved, self.element()).unwrap_or_default();
        let volumes = self.volumes.of_cell(e);
        if !volumes.is_empty() {
            let dilatations: Vec<f64> =
                volumes.iter().map(|&a| self.elastic_dilatation(a, factors, displacements)).collect();
            let of_point = |(shares, (_, strain)): (&Vec<f64>, (f64, [f64; 6]))| {
                let in_node = |(share, dilatation): (&f64, &f64)| (*share, with_dilatation(strain, *dilatation));
                shares.iter().zip(&dilatations).map(in_node).collect::<Vec<_>>()
            };
            return self.volumes.shares(e).iter().zip(strains).flat_map(of_point).collect();
        }
        if !factors.is_empty() {
            let free = free_stretch(self.is_thin(), self.free_strain(e, factors));
            for (_, strain) in &mut strains {
                strain.iter_mut().zip(free).for_each(|(strain, free)| *strain -= free);
            }
        }
        strains
    }
}
