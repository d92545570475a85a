//! Dilatations averaged at the nodes of linear triangles and tetrahedra (Bonet & Burton, Commun. Numer. Meth. Engng 14 (1998) 437,
//! for small strains).
//!
//! A node has a share of each cell around it, and of these the mean dilatation, material by material:
//!
//! ```text
//! V_a = Σ_e V_e / (d + 1),   G_a = Σ_e V_e / (d + 1) tr B_e,   θ_a = G_a u / V_a,
//! K = Σ_e ∫ Bᵀ D_dev B dV + Σ_a κ / V_a G_aᵀ G_a,   D_dev = 2 μ (1 - ⅓ 1 1ᵀ).
//! ```
//!
//! In a body of revolution, where strains and volumes are not uniform in a cell, the shares are `V_a = Σ_e ∫ N_a dV` and
//! `G_a = Σ_e ∫ N_a tr B dV`.
//!
//! There are fewer volumes to be held than displacements, so that nothing locks, and displacements are the only unknowns; in
//! exchange all nodes of the cells around a node are coupled.

use std::collections::HashMap;

use super::elastic::{Elasticity, numbered};
use super::facet::NodalForces;
use super::inverted::InvertedElement;
use super::shape::CellPoint;
use super::strain::Element;
use crate::mesh::{CellKind, Mesh, quadrature_of, shape};
use crate::vector::dot;

/// The nodal volumes of a mesh: one for each node and each law of the cells around it.
#[derive(Debug, Clone, Default)]
pub struct NodalVolumes {
    volumes: Vec<NodalVolume>,
    cells: Vec<Shared>,
}

/// What the cells of one law around a node leave to it.
#[derive(Debug, Clone)]
pub(super) struct NodalVolume {
    /// `V_a`, m³; in two dimensions m², in a body of revolution all around.
    volume: f64,
    /// `κ`, Pa.
    bulk: f64,
    /// The nodes of these cells.
    nodes: Vec<usize>,
    /// `G_a / V_a`, 1/m: the dilatation that a unit displacement of each makes.
    gradients: Vec<[f64; 3]>,
}

/// A cell that is shared between its nodes.
#[derive(Debug, Clone, Default)]
struct Shared {
    /// Of the volume that each of its integration points stands for, that of each of its nodes.
    shares: Vec<Vec<f64>>,
    /// The volumes of its nodes; none of a cell that keeps its own dilatation.
    volumes: Vec<usize>,
}

impl NodalVolumes {
    /// Whether cells of this kind share their volume between their nodes; others keep their own dilatation.
    pub fn take(kind: CellKind) -> bool {
        matches!(kind, CellKind::Triangle | CellKind::Tetrahedron)
    }

    /// Those of `mesh`, where `material` is that of each cell; none unless every element is an [`Element::NodalVolume`].
    ///
    /// # Errors
    /// [`InvertedElement`] for the first element that is not sound.
    pub fn new(mesh: &Mesh, element: Element, material: impl Fn(usize) -> Elasticity) -> Result<Self, InvertedElement> {
        let mut all = NodalVolumes::default();
        if element != Element::NodalVolume {
            return Ok(all);
        }
        let laws = numbered((0..mesh.cells.len()).map(&material));
        let mut known = HashMap::new();
        for (e, (cell, law)) in mesh.cells.iter().zip(laws).enumerate() {
            let mut shared = Shared::default();
            if Self::take(cell.kind) {
                let corners = mesh.points(&cell.nodes);
                let rule = quadrature_of(cell.kind, mesh.geometry, &corners);
                let points = CellPoint::all(cell.kind, mesh.geometry, &corners, &rule);
                let points = points.ok_or_else(|| InvertedElement::of(mesh, e))?;
                shared.shares = shares(cell.kind, &rule, &points);
                for (k, &node) in cell.nodes.iter().enumerate() {
                    let place = *known.entry((node, law)).or_insert_with(|| {
                        all.volumes.push(NodalVolume::without_cells(material(e).bulk()));
                        all.volumes.len() - 1
                    });
                    for (point, shares) in points.iter().zip(&shared.shares) {
                        all.volumes[place].add(shares[k], &cell.nodes, point);
                    }
                    shared.volumes.push(place);
                }
            }
            all.cells.push(shared);
        }
        for NodalVolume { volume, gradients, .. } in &mut all.volumes {
            gradients.iter_mut().flatten().for_each(|g| *g /= *volume);
        }
        Ok(all)
    }

    /// Whether no cell shares its volume.
    pub fn is_empty(&self) -> bool {
        self.volumes.is_empty()
    }

    /// The numbers of the volumes at the nodes of cell `e`; none where the cell keeps its own dilatation.
    pub fn of_cell(&self, e: usize) -> &[usize] {
        self.cells.get(e).map_or(&[], |cell| &cell.volumes)
    }

    /// Of the volume that each integration point of cell `e` stands for (m³; in two dimensions m², in a body of revolution all around),
    /// what its nodes have of it; none where the cell keeps its own dilatation.
    pub fn shares(&self, e: usize) -> &[Vec<f64>] {
        self.cells.get(e).map_or(&[], |cell| &cell.shares)
    }

    /// The dilatation `θ_a` of volume `a` for `displacements` of all nodes, m.
    pub fn dilatation(&self, a: usize, displacements: &[[f64; 3]]) -> f64 {
        let NodalVolume { nodes, gradients, .. } = &self.volumes[a];
        nodes.iter().zip(gradients).map(|(&node, g)| dot(*g, displacements[node])).sum()
    }

    /// The mean in each volume of what every cell has.
    pub fn means(&self, of_cells: &[f64]) -> Vec<f64> {
        let mut means = vec![0.0; self.volumes.len()];
        for (cell, value) in self.cells.iter().zip(of_cells) {
            for (&a, share) in cell.shares.iter().flat_map(|shares| cell.volumes.iter().zip(shares)) {
                means[a] += share / self.volumes[a].volume * value;
            }
        }
        means
    }

    /// The forces `Σ_a κ θ_a G_aᵀ` (N; in two dimensions per unit depth, of a body of revolution all around) that a stress-free `dilatation` of each volume exerts while
    /// the nodes are held.
    pub fn forces(&self, dilatation: &[f64]) -> NodalForces {
        let of_volume = |(of, dilatation): (&NodalVolume, &f64)| {
            let NodalVolume { volume, bulk, nodes, gradients } = of;
            let pressure = bulk * dilatation * volume;
            let force = |(node, g): (&usize, &[f64; 3])| (*node, g.map(|g| pressure * g));
            nodes.iter().zip(gradients).map(force).collect::<Vec<_>>()
        };
        self.volumes.iter().zip(dilatation).flat_map(of_volume).collect()
    }

    pub(super) fn iter(&self) -> impl Iterator<Item = &NodalVolume> {
        self.volumes.iter()
    }
}

/// What each node of a cell has of the volume that each point of a rule stands for.
fn shares(kind: CellKind, rule: &[([f64; 3], f64)], points: &[CellPoint]) -> Vec<Vec<f64>> {
    let nodes = kind.nodes();
    let of_point = |((place, _), point): (&([f64; 3], f64), &CellPoint)| match points {
        // The centre, without rounding.
        [_] => vec![point.volume / nodes as f64; nodes],
        _ => shape(kind, *place).into_iter().map(|n| n * point.volume).collect(),
    };
    rule.iter().zip(points).map(of_point).collect()
}

impl NodalVolume {
    fn without_cells(bulk: f64) -> Self {
        NodalVolume { volume: 0.0, bulk, nodes: Vec::new(), gradients: Vec::new() }
    }

    /// Adds a `share` of a point of a cell with these nodes. The sum is `G_a` until it is divided.
    fn add(&mut self, share: f64, nodes: &[usize], point: &CellPoint) {
        self.volume += share;
        for (k, node) in nodes.iter().enumerate() {
            let place = self.nodes.iter().position(|other| other == node).unwrap_or_else(|| {
                self.nodes.push(*node);
                self.gradients.push([0.0; 3]);
                self.nodes.len() - 1
            });
            self.gradients[place].iter_mut().zip(point.dilatation(k)).for_each(|(sum, g)| *sum += share * g);
        }
    }

    pub(super) fn nodes(&self) -> &[usize] {
        &self.nodes
    }

    /// `κ / V_a G_aᵀ G_a` (N/m; in two dimensions per unit depth), with unknowns as of an element.
    pub(super) fn stiffness(&self, dimension: usize) -> Vec<Vec<f64>> {
        let row: Vec<f64> = self.gradients.iter().flat_map(|g| &g[..dimension]).copied().collect();
        row.iter().map(|g| row.iter().map(|other| self.bulk * self.volume * (g * other)).collect()).collect()
    }
}
