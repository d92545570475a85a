//! Stresses and strain energy of a body from its displacements.

use super::Model;
use crate::algebra::vector::dot;
use crate::body::fem::{Spring, free_stretch, strain_at, strains, thermal_stress, with_dilatation};
use crate::body::mesh::{corner_shape, quadrature_of};
use crate::solver::problem::error::expect_length;
use crate::solver::problem::{ProblemError, State};

impl Model {
    /// Computes the stress `(σ_xx, σ_yy, σ_zz, τ_xy, τ_yz, τ_zx)` (Pa) at the centre of every cell, for the
    /// displacements of all nodes (m) at time `t` (s).
    ///
    /// `σ_zz` is that of plane strain, 0 in plane stress, and the hoop stress in a body of revolution. Thermal strains
    /// are subtracted.
    ///
    /// # Errors
    /// If `displacements` does not have one entry for each node of the mesh.
    pub fn centre_stresses(&self, t: f64, displacements: &[[f64; 3]]) -> Result<Vec<[f64; 6]>, ProblemError> {
        expect_length("displacements", self.mesh.nodes.len(), displacements.len(), "one for each node of the mesh")?;
        Ok(self.stresses(&self.thermal_factors(t), displacements))
    }

    /// Computes [`Model::centre_stresses`] for displacements of the right length, with the `factors` of
    /// `Model::thermal_factors`.
    pub fn stresses(&self, factors: &[f64], displacements: &[[f64; 3]]) -> Vec<[f64; 6]> {
        let cells = self.mesh.cells.iter().enumerate();
        cells.map(|(e, cell)| self.stress_in(e, cell.kind.centre(), factors, displacements)).collect()
    }

    /// Computes the stress (Pa) at the reference point `point` of cell `e` from the displacements of its own nodes, for the
    /// displacements of all nodes (m) at time `t` (s).
    ///
    /// # Errors
    /// If `displacements` does not have one entry for each node of the mesh.
    pub fn stress_of_cell(
        &self,
        e: usize,
        point: [f64; 3],
        t: f64,
        displacements: &[[f64; 3]],
    ) -> Result<[f64; 6], ProblemError> {
        expect_length("displacements", self.mesh.nodes.len(), displacements.len(), "one for each node of the mesh")?;
        Ok(self.stress_in(e, point, &self.thermal_factors(t), displacements))
    }

    /// Computes the stress (Pa) of an elastic strain in cell `e`.
    pub(crate) fn law_stress(&self, e: usize, strain: [f64; 6]) -> [f64; 6] {
        let mut stress = self.elements.materials[e].stress(strain);
        if self.is_thin() {
            stress[2] = 0.0;
        }
        stress
    }

    /// Returns the factors of the thermal loads at time `t` (s).
    pub(crate) fn thermal_factors(&self, t: f64) -> Vec<f64> {
        self.statics.free_strains().map(|(load, _)| self.loading.cases()[load].factor(t)).collect()
    }

    /// Returns the stress-free strain of cell `e` for these `factors` of the thermal loads; without factors it is 0.
    pub(super) fn free_strain(&self, e: usize, factors: &[f64]) -> f64 {
        self.statics.free_strains().zip(factors).map(|((_, free), f)| f * free.of_cells[e]).sum()
    }

    /// Returns the dilatation of nodal volume `a` without the thermal part.
    fn elastic_dilatation(&self, a: usize, factors: &[f64], displacements: &[[f64; 3]]) -> f64 {
        let free: f64 = self.statics.free_strains().zip(factors).map(|((_, free), f)| f * free.of_volumes[a]).sum();
        self.elements.volumes.dilatation(a, displacements) - 3.0 * free
    }

    /// Returns the elastic dilatation at the corners of cell `e`, linear between them; `None` if the dilatation of the
    /// cell is not averaged.
    pub(crate) fn corner_dilatations(&self, e: usize, factors: &[f64], displacements: &[[f64; 3]]) -> Option<Vec<f64>> {
        let volumes = self.elements.volumes.of_cell(e);
        let at_corners = volumes.iter().map(|&a| self.elastic_dilatation(a, factors, displacements)).collect();
        (!volumes.is_empty()).then_some(at_corners)
    }

    /// Computes the stress (Pa) at the reference point `point` of cell `e`.
    pub(crate) fn stress_in(&self, e: usize, point: [f64; 3], factors: &[f64], displacements: &[[f64; 3]]) -> [f64; 6] {
        let (cell, material) = (&self.mesh.cells[e], &self.elements.materials[e]);
        let nodes = self.mesh.points(&cell.nodes);
        let of_nodes: Vec<_> = cell.nodes.iter().map(|&node| displacements[node]).collect();
        // Assembly has refused cells that have none.
        let strain = strain_at(cell.kind, self.mesh.geometry, point, &nodes, &of_nodes, self.element());
        let strain = strain.unwrap_or([f64::NAN; 6]);
        if let Some(at_corners) = self.corner_dilatations(e, factors, displacements) {
            return material.stress(with_dilatation(strain, dot(&at_corners, corner_shape(cell.kind, point))));
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
        if self.statics.free_strains().next().is_none() && self.constraints.prescribed.is_empty() {
            return None;
        }
        let displacements = self.constraints.displaced(t, &state.u);
        let factors = self.thermal_factors(t);
        let of_cell = |e: usize| {
            let (whole, shares) = (self.elements.materials[e], !self.elements.volumes.of_cell(e).is_empty());
            let law = if shares { whole.deviatoric() } else { whole };
            let strains = self.elastic_strains(e, &factors, &displacements);
            let energy = |(volume, strain): &(f64, [f64; 6])| volume * law.energy_density(strain);
            strains.map_or(f64::NAN, |strains| strains.iter().map(energy).sum())
        };
        let springs = self.statics.springs().map(|spring: &Spring| spring.energy(&displacements));
        let of_volumes = self.elements.volumes.energy(|a| self.elastic_dilatation(a, &factors, &displacements));
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
    use super::super::Model;
    use crate::body::constraints::{Dofs, assemble};
    use crate::body::description::{Action, Axis, Description};
    use crate::body::fem::{Element, Layer, Material, gradients};
    use crate::body::mesh::{CellKind, MeshSource, block, quadrature_of};
    use crate::solver::problem::State;

    /// For any displacements, the nodal forces of the stresses at the integration points equal those of the stiffness:
    /// for a body of two materials, on all cells with averaged dilatation, including curved ones.
    #[test]
    fn stresses_pull_as_the_stiffness_says() {
        let (plane, space) = (block(&[1.0, 0.8], &[3, 2]), block(&[1.0, 0.9, 0.8], &[2, 1, 2]));
        let simplices = [plane, space.clone()].map(crate::body::mesh::Mesh::into_simplices);
        let curved = simplices.clone().map(|mesh| {
            let (corners, mut mesh) = (mesh.nodes.len(), mesh.into_second_order());
            let d = mesh.dimension;
            for (k, x) in mesh.nodes.iter_mut().enumerate().skip(corners) {
                (0..d).for_each(|c| x[c] += 0.02 * (1.7 * (k * (c + 1)) as f64).sin());
            }
            mesh
        });
        for mesh in simplices.into_iter().chain(curved).chain([space.into_prisms()]) {
            let layer = Layer { thickness: 0.4, young: 4.0, poisson: 0.3 };
            let material = Material { layers: vec![layer], ..Material::new(1.0, 0.499) };
            let description = Description::new(MeshSource::from(mesh.clone()), material, vec![1.0]);
            let description = description.element(Element::NodalVolume).support("bottom", &[Axis::X, Axis::Y]);
            let model = Model::build(&description).unwrap();
            let moved =
                |k: usize| [0, 1, 2].map(|c| if c < mesh.dimension { (2.3 * (k + 7 * c) as f64).sin() } else { 0.0 });
            let u: Vec<[f64; 3]> = (0..mesh.nodes.len()).map(moved).collect();
            let mut forces = vec![[0.0; 3]; mesh.nodes.len()];
            for (e, cell) in mesh.cells.iter().enumerate() {
                let nodes = mesh.points(&cell.nodes);
                for (point, weight) in quadrature_of(cell.kind, model.mesh.geometry, &nodes) {
                    let (of_nodes, det) = gradients(cell.kind, point, &nodes).unwrap();
                    let [xx, yy, zz, xy, yz, zx] = model.stress_in(e, point, &[], &u);
                    for (&node, g) in cell.nodes.iter().zip(of_nodes) {
                        for (c, row) in [[xx, xy, zx], [xy, yy, yz], [zx, yz, zz]].into_iter().enumerate() {
                            forces[node][c] += weight * det * (0..3).map(|k| row[k] * g[k]).sum::<f64>();
                        }
                    }
                }
            }
            let dofs = Dofs::new(&mesh, |_, _| false);
            let k = assemble(&mesh, &dofs, Element::NodalVolume, |e| model.materials()[e]).unwrap();
            let free: Vec<f64> = u.iter().flat_map(|u| &u[..mesh.dimension]).copied().collect();
            let expected = dofs.displacements(&k.times(&free).unwrap());
            let size = expected.iter().flatten().fold(0.0_f64, |m, f| m.max(f.abs()));
            let kind: CellKind = mesh.cells[0].kind;
            for (found, expected) in forces.iter().zip(&expected) {
                let d = mesh.dimension;
                assert!(
                    (0..d).all(|c| (found[c] - expected[c]).abs() < 1e-13 * size),
                    "{kind:?}: {found:?} {expected:?}"
                );
            }
        }
    }

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
