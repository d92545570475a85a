//! Held nodes: support forces, and forces on the rest of the body due to prescribed displacements.

use std::collections::BTreeMap;

use super::assembly::{assemble_watched, cells_at, each_stiffness};
use super::dofs::Dofs;
use crate::algebra::sparse::{Csr, Symmetric};
use crate::algebra::vector::{axis, dot, minus};
use crate::body::fem::{Elasticity, Element, InvertedElement, NodalForces, NodalVolumes, Spring};
use crate::body::mesh::Mesh;

/// The rows of the stiffness of a body, including springs, at held nodes and at nodes whose displacements are relative
/// to held nodes. Rows and columns are for the components x, y and z of all nodes; the rows of other nodes are empty.
#[derive(Debug, Clone)]
pub(crate) struct HeldRows(Csr);

impl HeldRows {
    /// Assembles `K` like [`super::assemble`], with `springs`, and the rows at the held nodes of `dofs`; `volumes` are
    /// those of the mesh.
    ///
    /// # Errors
    /// [`InvertedElement`] for the first inverted or degenerate element.
    pub fn beside(
        mesh: &Mesh,
        dofs: &Dofs,
        element: Element,
        volumes: &NodalVolumes,
        material: impl Fn(usize) -> Elasticity + Sync,
        springs: &[Spring],
    ) -> Result<(Symmetric, Self), InvertedElement> {
        let mut gathered = Gathered::new(dofs);
        let watch = |nodes: &[usize], stiffness: &[Vec<f64>]| gathered.add(nodes, stiffness);
        let stiffness = assemble_watched(mesh, dofs, element, (volumes, springs), material, watch)?;
        Ok((stiffness, gathered.rows()))
    }

    /// Assembles only the rows, for a body without springs and nodal volumes whose `K` other processes assemble.
    ///
    /// # Errors
    /// [`InvertedElement`] for the first inverted or degenerate element at these nodes.
    pub fn alone(
        mesh: &Mesh,
        dofs: &Dofs,
        element: Element,
        material: impl Fn(usize) -> Elasticity + Sync,
    ) -> Result<Self, InvertedElement> {
        let mut gathered = Gathered::new(dofs);
        let cells = cells_at(mesh, |node| gathered.rows.contains_key(&node));
        let mut add = |nodes: &[usize], stiffness: Vec<Vec<f64>>| gathered.add(nodes, &stiffness);
        each_stiffness(mesh, element, material, &cells, &mut add)?;
        Ok(gathered.rows())
    }

    /// Computes `K u` at these nodes, and 0 at others, N, for the displacements `u` (m) of all nodes plus `rest`, their
    /// low-order part.
    pub fn forces(&self, u: &[[f64; 3]], rest: &[[f64; 3]]) -> Vec<[f64; 3]> {
        let (u_of, rest) = (u.as_flattened(), rest.as_flattened());
        (0..u.len()).map(|node| [0, 1, 2].map(|c| self.0.difference(3 * node + c, u_of, rest, 0.0))).collect()
    }

    /// Computes `K u` at all nodes (N) if only these nodes are displaced, by `displacements` (m, all nodes).
    pub fn response(&self, displacements: &[[f64; 3]]) -> NodalForces {
        let mut forces = vec![0.0; self.0.columns()];
        self.0.add_transposed(displacements.as_flattened(), &mut forces);
        forces.as_chunks().0.iter().copied().enumerate().filter(|(_, force)| *force != [0.0; 3]).collect()
    }
}

/// Accumulates the rows cell by cell.
struct Gathered {
    /// The number of all nodes.
    all: usize,
    rows: BTreeMap<usize, [Vec<(usize, f64)>; 3]>,
}

impl Gathered {
    fn new(dofs: &Dofs) -> Self {
        let held = (0..dofs.nodes()).filter(|node| dofs.is_held(*node));
        let rows = held.chain(dofs.followers()).map(|node| (node, Default::default())).collect();
        Gathered { all: dofs.nodes(), rows }
    }

    /// Adds the stiffness of a cell or spring with these nodes.
    fn add(&mut self, nodes: &[usize], stiffness: &[Vec<f64>]) {
        let d = stiffness.len() / nodes.len();
        for (a, node) in nodes.iter().enumerate() {
            let Some(of_node) = self.rows.get_mut(node) else { continue };
            for (row, values) in of_node.iter_mut().zip(&stiffness[d * a..d * (a + 1)]) {
                row.extend(values.iter().enumerate().map(|(j, value)| (3 * nodes[j / d] + j % d, *value)));
            }
        }
    }

    fn rows(mut self) -> HeldRows {
        let of_node = |node: usize| self.rows.remove(&node).unwrap_or_default();
        HeldRows(Csr::of_rows(3 * self.all, (0..self.all).flat_map(of_node)))
    }
}

/// A translation counts as not prescribed if its effect on the held directions is below this share of the largest
/// effect.
const FELT: f64 = 1e-6;

/// Computes the translation (m) nearest in the least-squares sense to displacements prescribed at nodes, pairs of a
/// unit vector and the displacement (m) along it. The translation is 0 along directions that are not prescribed.
pub(crate) fn nearest_translation(prescribed: impl Iterator<Item = ([f64; 3], f64)> + Clone) -> [f64; 3] {
    // Gram-Schmidt on the columns of `n · t = value`, twice, recording the combination for each basis vector. The
    // longest column is first, since a column that is small because a direction is off its axis by rounding contains no
    // information.
    let mut columns: Vec<(usize, Vec<f64>)> =
        (0..3).map(|c| (c, prescribed.clone().map(|(n, _)| n[c]).collect())).collect();
    columns.sort_by(|(_, a), (_, b)| dot(b, b).total_cmp(&dot(a, a)));
    let whole = dot(&columns[0].1, &columns[0].1).sqrt();
    let mut basis: Vec<(Vec<f64>, [f64; 3])> = Vec::new();
    for (c, mut member) in columns {
        let mut made_of = axis(c);
        for (other, of) in basis.iter().chain(&basis) {
            let along = dot(&member, other);
            member.iter_mut().zip(other).for_each(|(x, y)| *x -= along * y);
            made_of = minus(made_of, of.map(|x| along * x));
        }
        let rest = dot(&member, &member).sqrt();
        if rest > FELT * whole {
            basis.push((member.into_iter().map(|x| x / rest).collect(), made_of.map(|x| x / rest)));
        }
    }
    let mut left: Vec<f64> = prescribed.map(|(_, value)| value).collect();
    let mut translation = [0.0; 3];
    for (member, made_of) in basis.iter().chain(&basis) {
        let along = dot(&left, member);
        left.iter_mut().zip(member).for_each(|(x, y)| *x -= along * y);
        (0..3).for_each(|c| translation[c] += along * made_of[c]);
    }
    translation
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::algebra::vector::{norm, unit};

    #[test]
    fn what_moves_as_a_whole_is_seen_to() {
        let to = [1.0, -2.0, 3e-3];
        let along = |n: [f64; 3]| (n, dot(n, to));
        let oblique = unit([1.0, 1.0, 0.0]);
        let all = [axis(0), axis(1), axis(2), oblique].map(along);
        let found = nearest_translation(all.into_iter());
        assert!((0..3).all(|c| (found[c] - to[c]).abs() < 1e-15), "{found:?}");
        // The motion across is not prescribed.
        let found = nearest_translation([along(oblique), along(oblique)].into_iter());
        assert!((dot(found, oblique) - dot(to, oblique)).abs() < 1e-15 && found[2] == 0.0, "{found:?}");
        assert_eq!(nearest_translation(std::iter::empty()), [0.0; 3]);
        // A direction turned off its axis by rounding.
        for off in [1e-25, 6e-17, 1e-10, 1e-7] {
            let found = nearest_translation([(unit([off, -1.0, 0.0]), 1e-6); 5].into_iter());
            assert!(norm(found) < 1.1e-6 && (found[1] + 1e-6).abs() < 1e-12, "{off}: {found:?}");
        }
    }
}
