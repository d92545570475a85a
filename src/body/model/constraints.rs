//! The constraints of a model, `u = T û + ū(t)`: `T` and `ū` with what made them, and the rigid motions that they leave.

use super::coupling::Couplings;
use super::holding::{self, Holding};
use super::joint::Joints;
use super::pair::Pairs;
use super::support::{PrescribedMotion, RigidGroups};
use crate::algebra::vector::plus;
use crate::base::input_error::InputError;
use crate::body::constraints::{Dofs, RigidMotion, unresisted_motions};
use crate::body::contact::ContactNode;
use crate::body::description::Description;
use crate::body::fem::Spring;
use crate::body::mesh::Mesh;

/// The constraints of the displacements.
#[derive(Debug, Clone)]
pub struct Constraints {
    /// The rows of `T`: the numbering of the free displacements.
    pub dofs: Dofs,
    /// The rigid motions that neither supports nor springs resist, which `problem.rigid_modes()` represents.
    pub rigid_motions: Vec<RigidMotion>,
    /// The terms of `ū(t)`: the displacements that moving supports and joints prescribe.
    pub(super) prescribed: Vec<PrescribedMotion>,
    /// The bodies that supports move as rigid bodies.
    pub(super) groups: RigidGroups,
    pub(super) couplings: Couplings,
    pub(super) joints: Joints,
}

impl Constraints {
    /// Creates the constraints of `description` with the numbering `dofs`, where supports hold the displacements of
    /// `holdings`, beside springs.
    pub(super) fn new(
        description: &Description,
        mesh: &Mesh,
        dofs: Dofs,
        (couplings, joints): (Couplings, Joints),
        pairs: &Pairs,
        (holdings, beds): (&[Holding], &[Vec<Spring>]),
    ) -> Result<Self, InputError> {
        let groups = RigidGroups::new(description, mesh, &dofs, (&couplings, pairs), holdings)?;
        let mut prescribed = PrescribedMotion::all(description, mesh, &dofs, holdings, &groups)?;
        let jumps = joints.tightened(description, &dofs, false);
        prescribed.extend(jumps.map(|(jump, history)| PrescribedMotion::of_jump(&dofs, groups.count, jump, history)));
        let ties = [pairs.ties(&dofs, &joints), holding::ties(&couplings, mesh, &dofs)].concat();
        let springs: Vec<Spring> = beds.iter().flatten().cloned().collect();
        let rigid_motions = unresisted_motions(mesh, &dofs, &springs, &ties);
        Ok(Constraints { dofs, rigid_motions, prescribed, groups, couplings, joints })
    }

    /// Returns the displacements (m) of all nodes from the unknowns `u` (n_u, m) at time `t` (s), those of reference points
    /// last.
    pub(super) fn displaced(&self, t: f64, u: &[f64]) -> Vec<[f64; 3]> {
        let mut all = self.strained(t, u);
        let offsets: Vec<[f64; 3]> = (0..self.groups.count).map(|group| self.offset(group, t)).collect();
        if offsets.iter().any(|offset| *offset != [0.0; 3]) {
            for (node, u) in all.iter_mut().enumerate() {
                *u = plus(*u, 1.0, offsets[self.groups.of_node[node]]);
            }
        }
        all
    }

    /// Returns the displacements of all nodes relative to the rigid offset by supports, to which gaps refer.
    pub(super) fn strained(&self, t: f64, u: &[f64]) -> Vec<[f64; 3]> {
        let mut all = self.dofs.displacements(u);
        for motion in &self.prescribed {
            let factor = motion.factor(t);
            all.iter_mut().zip(&motion.deviation).for_each(|(u, deviation)| *u = plus(*u, factor, *deviation));
        }
        all
    }

    /// Returns `true` if supports move the nodes in the rows of a contact node along its tangents.
    pub(super) fn move_past(&self, contact: &ContactNode) -> bool {
        let along = |motion: &PrescribedMotion| motion.deviation_of(&self.dofs, &self.groups, contact);
        self.prescribed.iter().map(along).any(|[_, t, o]| t != 0.0 || o != 0.0)
    }

    /// Returns the rigid offset of the bodies of a group by supports at time `t` (s), m.
    pub(super) fn offset(&self, group: usize, t: f64) -> [f64; 3] {
        [0, 1, 2].map(|c| self.prescribed.iter().map(|motion| motion.factor(t) * motion.offset[group][c]).sum())
    }
}
