//! The strains of a body at integration points.

use crate::algebra::vector::{cross, dot};
use crate::body::fem::{Elasticity, Element, with_dilatation};
use crate::body::mesh::{CellKind, Geometry, MAX_NODES, Mesh, ReferenceCell, ReferenceCells, ReferencePoint};
use crate::body::model::Model;

/// The volume (m³; in two dimensions the area, m²) of a point and its strain `(ε_xx, ε_yy, ε_zz, γ_xy, γ_yz, γ_zx)`.
pub(super) type Sample = (f64, [f64; 6]);

/// Strains count as rounding if they are smaller than this share of the displacements divided by the size of the body.
const STRAIN_ROUNDING: f64 = 1e-10;

/// Strain energies below this share of that of another part are rounding: displacements of 1e-10 of the others.
const PART_ROUNDING: f64 = 1e-20;

/// The elastic strains of a body.
pub(super) struct Strains<'a> {
    body: StrainedBody<'a>,
    /// The samples at the integration points of the stiffness, cell by cell.
    points: Vec<Sample>,
    /// The first sample of each cell, and the end.
    begins: Vec<usize>,
    /// The volume of each cell.
    pub(super) volumes: Vec<f64>,
    /// The strain energy of each cell, J, in two dimensions per m of depth.
    pub(super) energies: Vec<f64>,
}

impl<'a> Strains<'a> {
    /// Computes the strains of the `displacements` of all nodes (m), with the `factors` of [`Model::thermal_factors`].
    pub(super) fn new(model: &'a Model, factors: &'a [f64], displacements: &'a [[f64; 3]]) -> Self {
        Self::in_cells(model, factors, displacements, |_| true)
    }

    /// Computes the strains in the `wanted` cells only; the others have no points.
    pub(super) fn in_cells(
        model: &'a Model,
        factors: &'a [f64],
        displacements: &'a [[f64; 3]],
        wanted: impl Fn(usize) -> bool,
    ) -> Self {
        let body = StrainedBody { model, factors, displacements, kinds: ReferenceCells::new(&model.mesh) };
        let (mut points, mut begins) = (Vec::new(), vec![0]);
        let (mut volumes, mut energies) = (Vec::new(), Vec::new());
        for (e, law) in model.materials().iter().enumerate() {
            if wanted(e) {
                body.sample(e, ReferenceCell::of, &mut points);
            }
            let own = &mut points[begins[e]..];
            let volume = own.iter().map(|(volume, _)| volume).sum();
            if model.element() == Element::BBar {
                let mean = mean_dilatation(own, volume);
                for (_, strain) in own.iter_mut() {
                    *strain = with_dilatation(*strain, mean);
                }
            }
            energies.push(own.iter().map(|(v, strain)| v * law.energy_density(strain)).sum());
            volumes.push(volume);
            begins.push(points.len());
        }
        Strains { body, points, begins, volumes, energies }
    }

    /// Returns volume and strain at the integration points of the stiffness of cell `e`.
    pub(super) fn of_cell(&self, e: usize) -> &[Sample] {
        &self.points[self.begins[e]..self.begins[e + 1]]
    }

    /// Returns `true` if the strains of the body are within the rounding of its `displacements` (m), or all
    /// displacements are 0.
    pub(super) fn are_rounding(&self, displacements: &[[f64; 3]]) -> bool {
        let model = self.body.model;
        let moved = displacements.iter().flatten().fold(0.0_f64, |most, u| most.max(u.abs())) / model.mesh.size();
        let with_moved: f64 = self.volumes.iter().zip(model.materials()).map(|(volume, law)| volume * law.mu).sum();
        self.energies.iter().sum::<f64>() <= with_moved * (STRAIN_ROUNDING * moved).powi(2)
    }

    /// Returns the cells of each part of the body that neither elasticity nor contact connects with another, without the
    /// parts whose strains are rounding beside the largest.
    pub(super) fn parts(&self) -> Vec<Vec<usize>> {
        let model = self.body.model;
        let natural = model.problem.natural();
        let mut parts = vec![Vec::new(); natural.parts.max(1)];
        for (e, cell) in model.mesh.cells.iter().enumerate() {
            let free = cell.nodes.iter().flat_map(|&node| model.constraints.dofs.node(node)).flatten().next();
            // A cell without a free displacement counts with the first part.
            parts[free.map_or(0, |&dof| natural.part[dof])].push(e);
        }
        let energy = |cells: &Vec<usize>| sum(cells, &self.energies);
        let largest = parts.iter().map(energy).fold(0.0, f64::max);
        parts.retain(|cells| energy(cells) > PART_ROUNDING * largest);
        parts
    }

    /// Returns the root mean square of the magnitude `√(ε : ε)` of the strains of a part, weighted by the strain energy: that of
    /// the part where it is largest; 0 without strain energy.
    pub(super) fn magnitude(&self) -> f64 {
        let square =
            |[xx, yy, zz, xy, yz, zx]: [f64; 6]| xx * xx + yy * yy + zz * zz + 0.5 * (xy * xy + yz * yz + zx * zx);
        let of_cell = |(e, law): (usize, &Elasticity)| {
            self.of_cell(e).iter().map(|(v, strain)| v * law.energy_density(strain) * square(*strain)).sum::<f64>()
        };
        let squares: Vec<f64> = self.body.model.materials().iter().enumerate().map(of_cell).collect();
        let of_part = |cells: Vec<usize>| (sum(&cells, &squares) / sum(&cells, &self.energies)).sqrt();
        self.parts().into_iter().map(of_part).fold(0.0, f64::max)
    }

    /// Returns the mean dilatation of cell `e`.
    pub(super) fn mean_dilatation(&self, e: usize) -> f64 {
        mean_dilatation(self.of_cell(e), self.volumes[e])
    }

    /// Writes to `samples` volume and strain at the points of [`crate::body::mesh::fine_quadrature`]; returns these
    /// points.
    pub(super) fn at_fine_points(&self, e: usize, samples: &mut Vec<Sample>) -> &[ReferencePoint] {
        let kind = self.body.model.mesh.cells[e].kind;
        let points = self.body.kinds.get(kind).map_or(&[][..], |reference| &reference.fine);
        samples.clear();
        match self.of_cell(e) {
            // The strain and the Jacobian are uniform.
            [(volume, strain)] => {
                let all: f64 = points.iter().map(|point| point.weight).sum();
                samples.extend(points.iter().map(|point| (volume * point.weight / all, *strain)));
            }
            _ if kind.is_quadratic() => self.body.sample(e, |reference, _, _| &reference.fine, samples),
            same => samples.extend_from_slice(same),
        }
        points
    }
}

/// The data from which strains are computed.
struct StrainedBody<'a> {
    model: &'a Model,
    factors: &'a [f64],
    displacements: &'a [[f64; 3]],
    kinds: ReferenceCells,
}

impl StrainedBody<'_> {
    /// Adds volume and strain of cell `e`, without the thermal strain, at the points of a rule.
    fn sample(
        &self,
        e: usize,
        rule: impl for<'r> Fn(&'r ReferenceCell, CellKind, &[[f64; 3]]) -> &'r [ReferencePoint],
        samples: &mut Vec<Sample>,
    ) {
        let mesh = &self.model.mesh;
        let cell = &mesh.cells[e];
        let Some(reference) = self.kinds.get(cell.kind) else { return };
        let (mut nodes, mut moved) = ([[0.0; 3]; MAX_NODES], [[0.0; 3]; MAX_NODES]);
        for ((x, u), &node) in nodes.iter_mut().zip(&mut moved).zip(&cell.nodes) {
            (*x, *u) = (mesh.nodes[node], self.displacements[node]);
        }
        let (nodes, moved) = (&nodes[..cell.nodes.len()], &moved[..cell.nodes.len()]);
        let at_corners = self.model.corner_dilatations(e, self.factors, self.displacements);
        let free = (!self.factors.is_empty()).then(|| self.model.free_stretch(e, self.factors));
        let at = if mesh.dimension == 2 { strain_at::<2> } else { strain_at::<3> };
        for point in rule(reference, cell.kind, nodes) {
            let (volume, mut strain) = at(point, mesh.geometry, nodes, moved);
            if let Some(at_corners) = &at_corners {
                let dilatation = at_corners.iter().zip(point.corners).map(|(at_corner, n)| at_corner * n).sum();
                strain = with_dilatation(strain, dilatation);
            } else if let Some(free) = free {
                strain.iter_mut().zip(free).for_each(|(strain, free)| *strain -= free);
            }
            samples.push((volume, strain));
        }
    }
}

/// Returns the volume of an integration point of a cell with these `nodes` (m), and its strain for the displacements
/// `moved` (m).
fn strain_at<const D: usize>(
    point: &ReferencePoint,
    geometry: Geometry,
    nodes: &[[f64; 3]],
    moved: &[[f64; 3]],
) -> Sample {
    // ∂x/∂ξ and ∂u/∂ξ.
    let (mut j, mut h) = ([[0.0; 3]; 3], [[0.0; 3]; 3]);
    for ((slope, x), u) in point.slopes.iter().zip(nodes).zip(moved) {
        for r in 0..D {
            for c in 0..3 {
                j[r][c] += slope[r] * x[c];
                h[r][c] += slope[r] * u[c];
            }
        }
    }
    if D == 2 {
        // A slice of unit depth.
        j[2] = [0.0, 0.0, 1.0];
    }
    let cofactors = [cross(j[1], j[2]), cross(j[2], j[0]), cross(j[0], j[1])];
    let determinant = dot(j[0], cofactors[0]);
    let inverse = 1.0 / determinant;
    // ∂u_c/∂x_k.
    let d = |c: usize, k: usize| inverse * (0..D).map(|r| cofactors[r][k] * h[r][c]).sum::<f64>();
    let mut strain = [d(0, 0), d(1, 1), 0.0, d(0, 1) + d(1, 0), 0.0, 0.0];
    if D == 3 {
        (strain[2], strain[4], strain[5]) = (d(2, 2), d(1, 2) + d(2, 1), d(2, 0) + d(0, 2));
    }
    let area = determinant * point.weight;
    if geometry == Geometry::Cartesian {
        return (area, strain);
    }
    let along = |of: &[[f64; 3]], c: usize| point.shape.iter().zip(of).map(|(n, x)| n * x[c]).sum::<f64>();
    let r = along(nodes, 0);
    // No integration point is on the axis.
    strain[2] = along(moved, 0) / r;
    (strain[4], strain[5]) = (d(2, 1), d(2, 0) - along(moved, 2) / r);
    (area * geometry.depth([r, 0.0, 0.0]), strain)
}

/// Computes the volume of a body, m³; in two dimensions the area of its section, m².
pub(super) fn volume(mesh: &Mesh, cells: &[usize]) -> f64 {
    let kinds = ReferenceCells::new(mesh);
    let of_cell = |&e: &usize| points_of(mesh, Geometry::Cartesian, &kinds, e).iter().map(|(v, _)| v).sum::<f64>();
    cells.iter().map(of_cell).sum()
}

/// Returns volume and position (m) of the integration points of cell `e` in this geometry.
pub(super) fn points_of(mesh: &Mesh, geometry: Geometry, kinds: &ReferenceCells, e: usize) -> Vec<(f64, [f64; 3])> {
    let cell = &mesh.cells[e];
    let nodes = mesh.points(&cell.nodes);
    let at = if mesh.dimension == 2 { strain_at::<2> } else { strain_at::<3> };
    let points = kinds.get(cell.kind).map_or(&[][..], |reference| reference.of(cell.kind, &nodes));
    let place = |point: &ReferencePoint| {
        let along = |c: usize| point.shape.iter().zip(&nodes).map(|(n, x)| n * x[c]).sum();
        (at(point, geometry, &nodes, &nodes).0, [0, 1, 2].map(along))
    };
    points.iter().map(place).collect()
}

/// Returns the sum of a value over `cells`.
pub(super) fn sum(cells: &[usize], of_cells: &[f64]) -> f64 {
    cells.iter().map(|&e| of_cells[e]).sum()
}

/// Computes `tr ε`.
pub(super) fn dilatation(strain: &[f64; 6]) -> f64 {
    strain[0] + strain[1] + strain[2]
}

fn mean_dilatation(points: &[Sample], volume: f64) -> f64 {
    points.iter().map(|(v, strain)| v * dilatation(strain)).sum::<f64>() / volume
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::body::description::{Action, Axis, Description};
    use crate::body::fem::Material;
    use crate::body::mesh::MeshSource;

    /// The fast computation gives the strains of the energy of the model.
    #[test]
    fn strains_are_those_of_the_model() {
        for kind in CellKind::ALL {
            for element in [Element::Bilinear, Element::BBar, Element::NodalVolume] {
                let meant = match element {
                    Element::Bilinear => true,
                    Element::BBar => !kind.is_simplex() && !kind.is_quadratic(),
                    Element::NodalVolume => kind.is_simplex() || kind.is_prism() || kind.is_quadratic(),
                };
                if !meant {
                    continue;
                }
                let d = kind.dimension();
                let axes: Vec<_> = (0..d).map(|_| vec![1.0]).collect();
                let source = MeshSource::segmented(&axes, &vec![vec![2]; d], None, Some(kind)).unwrap();
                let mesh = source.build().unwrap();
                let mut mesh = (*mesh).clone();
                for (k, x) in mesh.nodes.iter_mut().enumerate() {
                    (0..d).for_each(|c| x[c] += 0.02 * ((7 * k + 3 * c) as f64).sin());
                }
                let action = Action::Temperature(30.0.into());
                let material = Material { expansion: Some(1e-5), ..Material::new(1e9, 0.3) };
                let body = Description::new(MeshSource::Given(mesh.into()), material, vec![1.0])
                    .element(element)
                    .support("left", &[Axis::X, Axis::Y, Axis::Z][..d])
                    .load(action.into());
                let model = Model::build(&body).unwrap();
                let moved: Vec<[f64; 3]> = (0..model.mesh.nodes.len())
                    .map(|k| std::array::from_fn(|c| if c < d { ((3 * k + c) as f64).cos() } else { 0.0 }))
                    .collect();
                let strains = Strains::new(&model, &[0.7], &moved);
                for e in 0..model.mesh.cells.len() {
                    let exact = model.elastic_strains(e, &[0.7], &moved).unwrap();
                    assert_eq!(exact.len(), strains.of_cell(e).len());
                    let (mut volume, mut fine) = (0.0, Vec::new());
                    for ((v, strain), (w, other)) in exact.iter().zip(strains.of_cell(e)) {
                        assert!((v - w).abs() < 1e-13 * v, "{kind:?} {v} {w}");
                        assert!(strain.iter().zip(other).all(|(a, b)| (a - b).abs() < 1e-11), "{strain:?} {other:?}");
                        volume += v;
                    }
                    assert!((volume - strains.volumes[e]).abs() < 1e-13 * volume);
                    let points = strains.at_fine_points(e, &mut fine);
                    assert_eq!(points.len(), fine.len());
                    let fine: f64 = fine.iter().map(|(volume, _)| volume).sum();
                    assert!((volume - fine).abs() < 1e-3 * volume, "{kind:?} {volume} {fine}");
                }
            }
        }
    }
}
