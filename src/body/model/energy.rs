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
    /// moving supports, the energy is `½ uᵀ K u`, and the result is `None`. The result is
    /// NaN if a cell has no valid strain, which happens only if the mesh is not the assembled one.
    pub(crate) fn strain_energy(&self, t: f64, state: &State) -> Option<f64> {
        if self.thermal.is_empty() && self.moved.is_empty() {
            return None;
        }
        let displacements = self.all_displaced(t, &state.u);
        let factors = self.thermal_factors(t);
        let of_cell = |e: usize| {
            let (whole, shares) = (self.materials[e], !self.volumes.of_cell(e).is_empty());
            let law = if shares { whole.deviatoric() } else { whole };
            let strains = self.elastic_strains(e, &factors, &displacements);
            let energy = |(volume, strain): &(f64, [f64; 6])| volume * law.energy_density(strain);
            strains.map_or(f64::NAN, |strains| strains.iter().map(energy).sum())
        };
        let springs = self.statics.springs().map(|spring: &Spring| spring.energy(&displacements));
        let of_volumes = self.volumes.energy(|a| self.elastic_dilatation(a, &factors, &displacements));
        Some((0..self.mesh.cells.len()).map(of_cell).sum::<f64>() + of_volumes + springs.sum::<f64>())
    }

    /// Computes the elastic strains of cell `e` at its integration points, without the thermal strain, each with its
    /// volume. Returns `None` for an inverted or degenerate cell.
    pub(crate) fn elastic_strains(
        &self,
        e: usize,
        factors: &[f64],
        displacements: &[[f64; 3]],
    ) -> Option<Vec<(f64, [f64; 6])>> {
        let cell = &self.mesh.cells[e];
        let nodes = self.mesh.points(&cell.nodes);
        let moved: Vec<_> = cell.nodes.iter().map(|&node| displacements[node]).collect();
        let mut strains = strains(cell.kind, self.mesh.geometry, &nodes, &moved, self.element())?;
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
        Some(strains)
    }

    /// Returns the thermal strain of cell `e`.
    pub(crate) fn free_stretch(&self, e: usize, factors: &[f64]) -> [f64; 6] {
        free_stretch(self.is_thin(), self.free_strain(e, factors))
    }
}

#[cfg(test)]
mod tests {
    use crate::body::description::{Action, Axis, Description};
    use crate::body::fem::Material;
    use crate::body::mesh::{MeshSource, block};
    use crate::body::model::Model;
    use crate::solver::problem::State;

    #[test]
    fn a_cell_without_strains_is_not_left_out() {
        let material = Material { expansion: Some(1e-5), ..Material::new(1e9, 0.3) };
        let body = Description::new(MeshSource::Given(block(&[2.0, 1.0], &[2, 1]).into()), material, vec![1.0])
            .support("left", &[Axis::X, Axis::Y])
            .load(Action::Temperature(30.0.into()).into());
        let mut model = Model::build(&body).unwrap();
        let energy = |model: &Model| model.strain_energy(1.0, &State::zero(&model.problem)).unwrap();
        assert!(energy(&model) > 0.0);
        let mut mesh = (*model.mesh).clone();
        for &node in &model.mesh.cells[1].nodes {
            mesh.nodes[node] = [0.0; 3];
        }
        model.mesh = mesh.into();
        assert!(energy(&model).is_nan(), "{}", energy(&model));
    }
}
