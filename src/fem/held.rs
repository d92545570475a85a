//! What happens where supports hold a body: their forces on it, and what their motion does to the rest.

use super::assembly::InvertedElement;
use super::dofs::Dofs;
use super::elastic::Elasticity;
use super::facet::NodalForces;
use super::rigid::{RigidMotion, all_motions};
use super::spring::Spring;
use super::stiffness::element_stiffness;
use super::strain::Element;
use crate::mesh::Mesh;
use crate::sparse::Csr;
use crate::vector::dot;

/// The rows of the stiffness of a body, springs included, at the nodes that supports hold: as all nodes have them, with
/// the components x, y and z.
#[derive(Debug, Clone)]
pub struct HeldRows {
    nodes: Vec<usize>,
    rows: Csr,
}

impl HeldRows {
    /// The rows at the nodes of which `dofs` holds something.
    ///
    /// # Errors
    /// [`InvertedElement`] for the first element there that is not sound.
    pub fn new(
        mesh: &Mesh,
        dofs: &Dofs,
        element: Element,
        material: impl Fn(usize) -> Elasticity,
        springs: &[Spring],
    ) -> Result<Self, InvertedElement> {
        let d = mesh.dimension;
        let holds = |node: &usize| dofs.node(*node).contains(&None);
        let nodes: Vec<usize> = (0..mesh.nodes.len()).filter(holds).collect();
        let place = |node: usize| nodes.binary_search(&node).ok();
        let mut rows = vec![Vec::new(); 3 * nodes.len()];
        for (e, cell) in mesh.cells.iter().enumerate().filter(|(_, cell)| cell.nodes.iter().any(holds)) {
            let stiffness = element_stiffness(cell.kind, &mesh.points(&cell.nodes), element, &material(e))
                .ok_or_else(|| InvertedElement { element: e, centre: mesh.centre(e), dimension: d })?;
            for (k, values) in stiffness.iter().enumerate() {
                let Some(held) = place(cell.nodes[k / d]) else { continue };
                let columns = values.iter().enumerate().map(|(j, value)| (3 * cell.nodes[j / d] + j % d, *value));
                rows[3 * held + k % d].extend(columns);
            }
        }
        for (row, column, value) in springs.iter().flat_map(Spring::entries) {
            if let Some(held) = place(row / 3) {
                rows[3 * held + row % 3].push((column, value));
            }
        }
        Ok(HeldRows { rows: Csr::of_rows(3 * mesh.nodes.len(), rows), nodes })
    }

    /// The nodes, ascending.
    pub fn nodes(&self) -> &[usize] {
        &self.nodes
    }

    /// `K u` at these nodes (N), of displacements `u` (m) of all nodes, and of `rest`, what rounding leaves off them.
    pub fn forces(&self, u: &[[f64; 3]], rest: &[[f64; 3]]) -> Vec<[f64; 3]> {
        let (u, rest) = (u.as_flattened(), rest.as_flattened());
        (0..self.nodes.len()).map(|k| [0, 1, 2].map(|c| self.rows.difference(3 * k + c, u, rest, 0.0))).collect()
    }

    /// `K u` at all nodes (N), where these nodes alone are displaced, each by its own of `displacements` (m).
    pub fn response(&self, displacements: &[[f64; 3]]) -> NodalForces {
        let mut forces = vec![0.0; self.rows.columns()];
        self.rows.add_transposed(displacements.as_flattened(), &mut forces);
        forces.as_chunks().0.iter().copied().enumerate().filter(|(_, force)| *force != [0.0; 3]).collect()
    }
}

/// The rigid motion that comes nearest, in the mean square, to displacements prescribed at nodes: triples of a node, a unit
/// vector, and the displacement (m) along it.
pub fn nearest_rigid_motion(mesh: &Mesh, prescribed: &[(usize, [f64; 3], f64)]) -> Option<RigidMotion> {
    let all = all_motions(mesh);
    let column =
        |motion: &RigidMotion| prescribed.iter().map(|(node, n, _)| dot(motion.at(mesh.nodes[*node]), *n)).collect();
    let mut left: Vec<f64> = prescribed.iter().map(|(.., value)| *value).collect();
    let mut weights = vec![0.0; all.len()];
    // Members of an orthonormal basis of the columns, each with its weights of the motions.
    let mut basis: Vec<(Vec<f64>, Vec<f64>)> = Vec::new();
    for (k, motion) in all.iter().enumerate() {
        let mut member: Vec<f64> = column(motion);
        let mut made_of = vec![0.0; all.len()];
        made_of[k] = 1.0;
        let whole = dot(&member, &member).sqrt();
        // Twice is enough.
        for (other, of) in basis.iter().chain(&basis) {
            let along = dot(&member, other);
            member.iter_mut().zip(other).for_each(|(x, y)| *x -= along * y);
            made_of.iter_mut().zip(of).for_each(|(x, y)| *x -= along * y);
        }
        let rest = dot(&member, &member).sqrt();
        if rest > 1e-6 * whole {
            member.iter_mut().chain(&mut made_of).for_each(|x| *x /= rest);
            basis.push((member, made_of));
        }
    }
    for (member, made_of) in basis.iter().chain(&basis) {
        let along = dot(&left, member);
        left.iter_mut().zip(member).for_each(|(x, y)| *x -= along * y);
        weights.iter_mut().zip(made_of).for_each(|(x, y)| *x += along * y);
    }
    RigidMotion::combination(&all, &weights)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::mesh::block;
    use crate::vector::axis;

    #[test]
    fn a_body_that_moves_as_a_whole_is_seen_to() {
        let mesh = block(&[2.0, 1.0, 1.0], &[2, 1, 1]);
        let moved = |x: [f64; 3]| [1.0 - 0.2 * x[1], 0.2 * x[0], 3.0];
        let all: Vec<_> = (0..mesh.nodes.len()).flat_map(|node| (0..3).map(move |c| (node, axis(c)))).collect();
        let along = |(node, n): (usize, [f64; 3])| (node, n, dot(moved(mesh.nodes[node]), n));
        // On the plane x = 0 nothing is known of rotations about z and y.
        for part in
            [all.clone(), all.into_iter().filter(|(node, n)| mesh.nodes[*node][0] == 0.0 && n[0] == 1.0).collect()]
        {
            let prescribed: Vec<_> = part.into_iter().map(along).collect();
            let motion = nearest_rigid_motion(&mesh, &prescribed).unwrap();
            for (node, n, value) in prescribed {
                assert!((dot(motion.at(mesh.nodes[node]), n) - value).abs() < 1e-14);
            }
        }
    }
}
