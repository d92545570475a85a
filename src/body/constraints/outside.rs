//! Nodes outside the mesh: the two nodes of each reference point, which carries nodes of the mesh, and the jumps between the
//! two sides of glued pairs.
//!
//! The rows of a pair with the jump `J` are `Σ D u - Σ P u = J`. Along axes that are held, `J` is 0 or prescribed; along
//! free axes it is an unknown, on which the force across the pair acts.

use super::dofs::{Dofs, SAME_DIRECTION};
use super::reference_point::{Jump, ReferencePoint};
use super::relative::{Coefficient, Relative};
use super::rigid::{BodyMotion, Tie};
use crate::body::mesh::Mesh;

impl Dofs {
    /// Returns the reference point of a node outside the mesh, and `true` for the node of its rotation.
    fn point_of(&self, node: usize) -> Option<(&ReferencePoint, bool)> {
        let beyond = node.checked_sub(self.of_mesh)?;
        Some((self.points.get(beyond / 2)?, beyond % 2 == 1))
    }

    /// Returns `true` if there are nodes outside the mesh: those of reference points and jumps.
    pub fn has_nodes_outside(&self) -> bool {
        self.nodes() > self.of_mesh
    }

    /// Returns `true` for a node whose displacement is the rotation of a reference point.
    pub fn is_rotation(&self, node: usize) -> bool {
        self.point_of(node).is_some_and(|(_, rotation)| rotation)
    }

    /// Returns the node of the translation for that of the rotation of a reference point, and other nodes unchanged.
    pub fn translating(&self, node: usize) -> usize {
        if self.is_rotation(node) { node - 1 } else { node }
    }

    /// Returns the nodes of translation and rotation of reference point `k`.
    pub fn nodes_of_point(&self, k: usize) -> [usize; 2] {
        [self.of_mesh + 2 * k, self.of_mesh + 2 * k + 1]
    }

    /// Returns the node of the mesh that belongs to `node`: the node itself or, for a node of a reference point, one
    /// that the point carries, and for a jump one on its first side.
    pub fn in_mesh(&self, node: usize) -> usize {
        match self.jump_of(node) {
            Some(jump) => jump.node,
            None => self.point_of(node).map_or(node, |(point, _)| point.carried),
        }
    }

    /// Returns the displacement of a node of the mesh or of a reference point in a rigid motion.
    pub fn in_motion(&self, mesh: &Mesh, node: usize, motion: &BodyMotion) -> [f64; 3] {
        match self.point_of(node) {
            None => motion.at(mesh.nodes[node]),
            Some((point, false)) => motion.at(point.position),
            Some((point, true)) => point.of_rotation(mesh.dimension, motion.rotation),
        }
    }

    /// Returns the force on the node of the rotation of point `k` that is equivalent to a `moment`, N m.
    pub fn of_moment(&self, k: usize, moment: [f64; 3]) -> [f64; 3] {
        let radius = self.points[k].radius;
        self.points[k].of_rotation(self.dimension(), moment).map(|x| x / (radius * radius))
    }

    /// Returns the rotation (rad) of point `k` from the displacement of its second node.
    pub fn rotation(&self, k: usize, u: [f64; 3]) -> [f64; 3] {
        let [x, y, z] = u.map(|u| u / self.points[k].radius);
        if self.dimension() == 2 { [0.0, 0.0, x] } else { [x, y, z] }
    }

    /// Returns the moment (N m) of a force on the node of a rotation; `None` for other nodes.
    pub fn moment(&self, node: usize, force: [f64; 3]) -> Option<[f64; 3]> {
        let (point, _) = self.point_of(node).filter(|(_, rotation)| *rotation)?;
        let [x, y, z] = force.map(|f| point.radius * f);
        Some(if self.dimension() == 2 { [0.0, 0.0, x] } else { [x, y, z] })
    }

    /// Returns the stiffness (N/m, along the components of the second node) of a `rotational` stiffness of point `k`, N m.
    pub fn of_rotational(&self, k: usize, rotational: [f64; 3]) -> [f64; 3] {
        let radius = self.points[k].radius;
        self.of_moment(k, rotational).map(|x| x / radius)
    }

    /// Returns `true` if the other nodes of `relation` can move along the parts of `n` that act on them: supports do not
    /// hold them there, or move them along such an axis, as `moved` tells for a node and an axis.
    pub fn may_move(&self, relation: &Relative, n: [f64; 3], moved: impl Fn(usize, [f64; 3]) -> bool) -> bool {
        relation.others.iter().any(|(other, coefficient)| {
            let along = self.in_frame(*other, coefficient.transposed_times(n));
            let axes = self.axes(*other).into_iter().enumerate();
            axes.filter(|(a, _)| along[*a].abs() > SAME_DIRECTION)
                .any(|(a, axis)| !self.is_held_along(*other, a) || moved(*other, axis))
        })
    }

    /// Returns the form `n · (u - Σ coefficient · u_other)` of a relation.
    pub fn tie(&self, relation: &Relative, n: [f64; 3]) -> Tie {
        let others = relation.others.iter().map(|(other, c)| (*other, c.transposed_times(n).map(|x| -x)));
        std::iter::once((relation.node, n)).chain(others).collect()
    }

    /// Returns `true` if one reference point carries all of `nodes`, which then cause no strain.
    pub fn are_rigid(&self, nodes: &[usize]) -> bool {
        let first = nodes.first().and_then(|node| self.point_carrying(*node));
        first.is_some() && nodes.iter().all(|node| self.point_carrying(*node) == first)
    }

    /// Returns the reference point that carries `node`, if one does.
    pub fn point_carrying(&self, node: usize) -> Option<usize> {
        let (other, _) = self.relative.get(&node)?.others.first()?;
        self.point_of(*other)?;
        Some((other - self.of_mesh) / 2)
    }

    /// Returns the position of a node of the mesh or of a reference point, m, and for a jump that of its node.
    pub fn position(&self, mesh: &Mesh, node: usize) -> [f64; 3] {
        self.point_of(node).map_or_else(|| mesh.nodes[self.in_mesh(node)], |(point, _)| point.position)
    }

    /// Returns the relation that lets point `k` carry `node` of the mesh.
    pub fn carried_by(&self, mesh: &Mesh, k: usize, node: usize) -> Relative {
        let [translation, rotation] = self.nodes_of_point(k);
        let arm = self.points[k].arm(mesh.dimension, mesh.nodes[node]);
        let others = vec![(translation, Coefficient::Factor(1.0)), (rotation, Coefficient::Matrix(Box::new(arm)))];
        Relative { node, own: 1.0, others, tied: true }
    }

    /// Returns the node of jump `k`. These nodes follow those of reference points.
    pub fn node_of_jump(&self, k: usize) -> usize {
        self.of_mesh + 2 * self.points.len() + k
    }

    /// Returns the jump of a node outside the mesh.
    pub(super) fn jump_of(&self, node: usize) -> Option<&Jump> {
        self.jumps.get(node.checked_sub(self.node_of_jump(0))?)
    }

    /// Returns `true` for a node whose displacement is a jump.
    pub fn is_jump(&self, node: usize) -> bool {
        self.jump_of(node).is_some()
    }

    /// Returns jump `k` as the sum `Σ c u` of displacements of nodes.
    pub fn sum_of_jump(&self, k: usize) -> &[(usize, f64)] {
        self.jumps.get(k).map_or(&[], |jump| &jump.sum)
    }

    /// Sets the sum of displacements that is jump `k`.
    pub(crate) fn set_jump(&mut self, k: usize, sum: Vec<(usize, f64)>) {
        if let Some(jump) = self.jumps.get_mut(k) {
            jump.sum = sum;
        }
    }
}
