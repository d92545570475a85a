//! Dilatations averaged at the corners of triangles, tetrahedra, prisms and all cells of second order (Bonet & Burton, Commun. Numer. Meth. Engng
//! 14 (1998) 437, for small strains).
//!
//! With the shape functions L_a of the corners, a corner has a share of each surrounding cell and the mean dilatation
//! of these shares, separately for each material:
//!
//! ```text
//! V_a = Σ_e ∫_e L_a dV,   G_a = Σ_e ∫_e L_a tr B dV,   θ_a = G_a u / V_a,
//! K = Σ_e ∫ Bᵀ D_dev B dV + Σ_a κ / V_a G_aᵀ G_a,   D_dev = 2 μ (1 - ⅓ 1 1ᵀ).
//! ```
//!
//! The volumetric stress is therefore `κ Σ L_a θ_a` within a cell. Since there are fewer volume constraints than
//! displacements, the elements do not lock, and displacements are the only unknowns. In exchange, all nodes of the
//! cells around a corner are coupled.

use std::collections::HashMap;

use super::element::{CellPoint, Element, InvertedElement};
use super::facet::NodalForces;
use super::material::{Elasticity, numbered};
use crate::algebra::vector::dot;
use crate::body::mesh::{CellKind, Mesh, corner_shape, quadrature_of, shape};

/// The nodal volumes of a mesh: one for each corner and each law of the cells around it.
#[derive(Debug, Clone, Default)]
pub(crate) struct NodalVolumes {
    pub(crate) volumes: Vec<NodalVolume>,
    /// The volumes at the corners of each cell; empty for a cell whose dilatation is not averaged.
    cells: Vec<Vec<usize>>,
}

/// The share of a corner in the surrounding cells of one law.
#[derive(Debug, Clone, Default)]
pub(crate) struct NodalVolume {
    /// `V_a`, m³; in two dimensions m², in a body of revolution over the full circumference.
    volume: f64,
    /// `κ`, Pa.
    bulk: f64,
    /// The nodes of these cells.
    pub(crate) nodes: Vec<usize>,
    /// `G_a / V_a`, 1/m: the dilatation for a unit displacement of each node.
    gradients: Vec<[f64; 3]>,
}

impl NodalVolumes {
    /// Returns `true` if cells of this kind have averaged dilatations; quadrilaterals and hexahedra of first order, for
    /// which there is B-bar, keep their own dilatation.
    pub fn apply_to(kind: CellKind) -> bool {
        kind.is_simplex() || kind.is_prism() || kind.is_quadratic()
    }

    /// Computes the nodal volumes of `mesh`, where `material` returns the law of each cell; empty unless the elements
    /// are [`Element::NodalVolume`].
    ///
    /// # Errors
    /// [`InvertedElement`] for the first inverted or degenerate element.
    pub fn new(mesh: &Mesh, element: Element, material: impl Fn(usize) -> Elasticity) -> Result<Self, InvertedElement> {
        let mut all = NodalVolumes::default();
        if element != Element::NodalVolume {
            return Ok(all);
        }
        let laws = numbered((0..mesh.cells.len()).map(&material));
        let mut known = HashMap::new();
        for (e, (cell, law)) in mesh.cells.iter().zip(laws).enumerate() {
            let corners = if Self::apply_to(cell.kind) { &cell.nodes[..cell.kind.corners()] } else { &[] };
            let mut index = |corner: &usize| {
                *known.entry((*corner, law)).or_insert_with(|| {
                    all.volumes.push(NodalVolume { bulk: material(e).bulk(), ..NodalVolume::default() });
                    all.volumes.len() - 1
                })
            };
            let at_corners: Vec<usize> = corners.iter().map(&mut index).collect();
            let nodes = mesh.points(&cell.nodes);
            let rule = quadrature_of(cell.kind, mesh.geometry, &nodes);
            let points = CellPoint::all(cell.kind, mesh.geometry, &nodes, &rule);
            let points = points.ok_or_else(|| InvertedElement::of(mesh, e))?;
            for ((place, _), point) in rule.iter().zip(&points) {
                for (&a, share) in at_corners.iter().zip(corner_shape(cell.kind, *place)) {
                    all.volumes[a].add(share * point.volume, &cell.nodes, point);
                }
            }
            all.cells.push(at_corners);
        }
        for NodalVolume { volume, gradients, .. } in &mut all.volumes {
            gradients.iter_mut().flatten().for_each(|g| *g /= *volume);
        }
        Ok(all)
    }

    /// Returns `true` if no dilatation is averaged.
    pub fn is_empty(&self) -> bool {
        self.volumes.is_empty()
    }

    /// Returns the numbers of the volumes at the corners of cell `e`; empty if the dilatation of the cell is not
    /// averaged.
    pub fn of_cell(&self, e: usize) -> &[usize] {
        self.cells.get(e).map_or(&[], |cell| cell)
    }

    /// Computes the dilatation `θ_a` of volume `a` for `displacements` of all nodes, m.
    pub fn dilatation(&self, a: usize, displacements: &[[f64; 3]]) -> f64 {
        let NodalVolume { nodes, gradients, .. } = &self.volumes[a];
        nodes.iter().zip(gradients).map(|(&node, g)| dot(*g, displacements[node])).sum()
    }

    /// Computes the mean `Σ_e ∫ L_a f dV / V_a` in each volume of `value`, a function of the cell and the position (m),
    /// at the points at which the dilatation is averaged.
    pub fn means(&self, mesh: &Mesh, value: impl Fn(usize, [f64; 3]) -> f64) -> Vec<f64> {
        let mut means = vec![0.0; self.volumes.len()];
        for (e, cell) in mesh.cells.iter().enumerate().filter(|(e, _)| !self.of_cell(*e).is_empty()) {
            let nodes = mesh.points(&cell.nodes);
            let rule = quadrature_of(cell.kind, mesh.geometry, &nodes);
            // All cells were checked when the volumes were computed.
            let Some(points) = CellPoint::all(cell.kind, mesh.geometry, &nodes, &rule) else { continue };
            for ((point, _), CellPoint { volume, .. }) in rule.iter().zip(&points) {
                let n = shape(cell.kind, *point);
                let value = value(e, [0, 1, 2].map(|c| n.iter().zip(&nodes).map(|(n, x)| n * x[c]).sum()));
                for (&a, share) in self.of_cell(e).iter().zip(corner_shape(cell.kind, *point)) {
                    means[a] += share * volume / self.volumes[a].volume * value;
                }
            }
        }
        means
    }

    /// Computes the forces `Σ_a κ θ_a G_aᵀ` (N; in two dimensions per unit depth, for a body of revolution over the
    /// full circumference) of a stress-free `dilatation` of each volume with all nodes held.
    pub fn forces(&self, dilatation: &[f64]) -> NodalForces {
        let of_volume = |(of, dilatation): (&NodalVolume, &f64)| {
            let NodalVolume { volume, bulk, nodes, gradients } = of;
            let pressure = bulk * dilatation * volume;
            let force = |(node, g): (&usize, &[f64; 3])| (*node, g.map(|g| pressure * g));
            nodes.iter().zip(gradients).map(force).collect::<Vec<_>>()
        };
        self.volumes.iter().zip(dilatation).flat_map(of_volume).collect()
    }

    /// Computes the energy `½ Σ_a κ V_a θ_a²` (J; in two dimensions per unit depth) of the elastic `dilatation` of each
    /// volume.
    pub fn energy(&self, dilatation: impl Fn(usize) -> f64) -> f64 {
        let of = |(a, volume): (usize, &NodalVolume)| 0.5 * volume.bulk * volume.volume * dilatation(a).powi(2);
        self.volumes.iter().enumerate().map(of).sum()
    }
}

impl NodalVolume {
    /// Adds a `share` of a point of a cell with these nodes. The gradients contain `G_a` until they are divided by
    /// `V_a`.
    fn add(&mut self, share: f64, nodes: &[usize], point: &CellPoint) {
        self.volume += share;
        for (k, node) in nodes.iter().enumerate() {
            let index = self.nodes.iter().position(|other| other == node).unwrap_or_else(|| {
                self.nodes.push(*node);
                self.gradients.push([0.0; 3]);
                self.nodes.len() - 1
            });
            self.gradients[index].iter_mut().zip(point.dilatation(k)).for_each(|(sum, g)| *sum += share * g);
        }
    }

    /// Computes `κ / V_a G_aᵀ G_a` (N/m; in two dimensions per unit depth), with unknowns as for an element.
    pub(crate) fn stiffness(&self, components: usize) -> Vec<Vec<f64>> {
        let row: Vec<f64> = self.gradients.iter().flat_map(|g| &g[..components]).copied().collect();
        row.iter().map(|g| row.iter().map(|other| self.bulk * self.volume * (g * other)).collect()).collect()
    }
}
