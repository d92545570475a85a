//! The stresses of a body from its displacements.

use std::collections::BTreeMap;

use super::Model;
use crate::fem::{cell_volume, strain_at, thermal_stress, with_dilatation};
use crate::mesh::shape;
use crate::problem::ProblemError;
use crate::problem::error::expect_length;

impl Model {
    /// The stress `(σ_xx, σ_yy, σ_zz, τ_xy, τ_yz, τ_zx)` (Pa) at the centre of every cell, for the displacements
    /// of all nodes (m) at time `t` (s); with `σ_zz` of plane strain, 0 in plane stress, and the hoop stress in a body of revolution. What heat alone makes of the strain
    /// is taken off.
    ///
    /// # Errors
    /// When there is not one displacement for each node of the mesh.
    pub fn centre_stresses(&self, t: f64, displacements: &[[f64; 3]]) -> Result<Vec<[f64; 6]>, ProblemError> {
        expect_length("displacements", self.mesh.nodes.len(), displacements.len(), "one for each node of the mesh")?;
        Ok(self.stresses(&self.thermal_factors(t), displacements))
    }

    /// [`Model::centre_stresses`] of displacements that fit, with the `factors` of [`Model::thermal_factors`].
    pub(crate) fn stresses(&self, factors: &[f64], displacements: &[[f64; 3]]) -> Vec<[f64; 6]> {
        let cells = self.mesh.cells.iter().enumerate();
        cells.map(|(e, cell)| self.stress_in(e, cell.kind.centre(), factors, displacements)).collect()
    }

    /// The stress in each node (Pa), the mean of those that the elements around it have there, each with the weight of its volume; at a
    /// border between materials only those of the material of the first element.
    pub(crate) fn nodal_stresses(&self, factors: &[f64], displacements: &[[f64; 3]]) -> Vec<[f64; 6]> {
        let mut sums: BTreeMap<usize, (usize, f64, [f64; 6])> = BTreeMap::new();
        for (e, cell) in self.mesh.cells.iter().enumerate() {
            let volume = cell_volume(cell.kind, self.mesh.geometry, &self.mesh.points(&cell.nodes)).unwrap_or(f64::NAN);
            let alike =
                |first: usize| self.materials[first] == self.materials[e] && self.mesh.cells[first].group == cell.group;
            for (k, &node) in cell.nodes.iter().enumerate() {
                let (first, weight, sum) = sums.entry(node).or_insert((e, 0.0, [0.0; 6]));
                if alike(*first) {
                    let stress = self.stress_in(e, cell.kind.reference_node(k), factors, displacements);
                    *weight += volume;
                    sum.iter_mut().zip(stress).for_each(|(sum, s)| *sum += volume * s);
                }
            }
        }
        // Every node is of a cell.
        sums.into_values().map(|(_, weight, sum)| sum.map(|s| s / weight)).collect()
    }

    /// The factors of the loads by temperature at time `t` (s).
    pub(crate) fn thermal_factors(&self, t: f64) -> Vec<f64> {
        self.thermal.iter().map(|(_, load)| self.loading.cases()[*load].factor(t)).collect()
    }

    /// The stress-free strain of cell `e`, where loads by temperature have these `factors`; none stand for no such loads.
    pub(super) fn free_strain(&self, e: usize, factors: &[f64]) -> f64 {
        self.thermal.iter().zip(factors).map(|((free, _), f)| f * free.of_cells[e]).sum()
    }

    /// The dilatation of nodal volume `a` beyond that of heat alone.
    pub(super) fn elastic_dilatation(&self, a: usize, factors: &[f64], displacements: &[[f64; 3]]) -> f64 {
        let free: f64 = self.thermal.iter().zip(factors).map(|((free, _), f)| f * free.of_volumes[a]).sum();
        self.volumes.dilatation(a, displacements) - 3.0 * free
    }

    /// The stress (Pa) at the reference point `point` of cell `e`.
    pub(crate) fn stress_in(&self, e: usize, point: [f64; 3], factors: &[f64], displacements: &[[f64; 3]]) -> [f64; 6] {
        let (cell, material) = (&self.mesh.cells[e], &self.materials[e]);
        let corners = self.mesh.points(&cell.nodes);
        let moved: Vec<_> = cell.nodes.iter().map(|&node| displacements[node]).collect();
        let strain = strain_at(cell.kind, self.mesh.geometry, point, &corners, &moved, self.element());
        // Assembly has refused cells that have none.
        let strain = strain.unwrap_or([f64::NAN; 6]);
        let volumes = self.volumes.of_cell(e);
        if !volumes.is_empty() {
            // The dilatations of the nodes, interpolated: what equilibrium knows of the dilatation is its mean in the cell.
            let mut sum = [0.0; 6];
            for (&a, n) in volumes.iter().zip(shape(cell.kind, point)) {
                let at_node = with_dilatation(strain, self.elastic_dilatation(a, factors, displacements));
                sum.iter_mut().zip(at_node).for_each(|(sum, c)| *sum += n * c);
            }
            return material.stress(sum);
        }
        let mut stress = material.stress(strain);
        if !factors.is_empty() {
            let free = thermal_stress(material, self.is_thin(), self.free_strain(e, factors));
            stress.iter_mut().zip(free).for_each(|(s, free)| *s -= free);
        }
        if self.is_thin() {
            stress[2] = 0.0;
        }
        stress
    }
}
