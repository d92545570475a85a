//! Jumps between the two sides of a glued pair: nodes outside the mesh whose displacement is the jump.
//!
//! With the jump `J`, the rows of the pair are `Σ D u - Σ P u = J`. Along axes that are held, `J` is 0 or prescribed; along
//! free axes it is an unknown, on which the force across the pair acts.

use super::dofs::Dofs;
use super::reference_point::Jump;
use super::relative::{Coefficient, Relative};

impl Dofs {
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

    /// Adds `factor` times jump `k` to a relation between the two sides.
    pub fn with_jump(&self, mut relation: Relative, k: usize, factor: f64) -> Relative {
        relation.others.push((self.node_of_jump(k), Coefficient::Factor(factor)));
        relation
    }
}
