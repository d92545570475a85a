//! The places of the slacks and multipliers in `z`.

use std::ops::Range;

use crate::solver::formulation::{Layout, Pair};

/// The layout of `z = (u, p_t, p_n, v_n, s, λ)`.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct SlackLayout {
    forces: Layout,
}

impl SlackLayout {
    /// Creates the layout of the slacks and multipliers for the unknowns of `forces`.
    pub fn new(forces: &Layout) -> Self {
        SlackLayout { forces: forces.clone() }
    }

    /// Returns the layout of `(u, p_t, p_n)`, with which `z` begins.
    pub fn forces(&self) -> &Layout {
        &self.forces
    }

    /// Returns the length of `z`.
    pub fn unknowns(&self) -> usize {
        self.s_start() + 4 * self.forces.tangentials()
    }

    fn s_start(&self) -> usize {
        self.forces.unknowns() + self.forces.contacts()
    }

    /// Returns the place of `v_n` of contact node `i`.
    pub fn v_n(&self, i: usize) -> usize {
        self.forces.unknowns() + i
    }

    /// Returns the places of `s⁺` and `s⁻` of the node whose tangential force is at `p_t`.
    pub fn s(&self, p_t: usize) -> [usize; 2] {
        let k = self.s_start() + p_t - self.forces.displacements();
        [k, k + self.forces.tangentials()]
    }

    /// Returns the places of `λ⁺` and `λ⁻` of the node whose tangential force is at `p_t`.
    pub fn lambda(&self, p_t: usize) -> [usize; 2] {
        self.s(p_t).map(|k| k + 2 * self.forces.tangentials())
    }

    /// Returns the places of all `s`, which are also those of the cone rows.
    pub fn cone_rows(&self) -> Range<usize> {
        self.s_start()..self.s_start() + 2 * self.forces.tangentials()
    }

    /// Returns the complementary pairs `(p_n, v_n)`, then `(s, λ)`.
    pub fn pairs(&self) -> impl Iterator<Item = Pair> + '_ {
        let normal = (0..self.forces.contacts()).map(|i| Pair { force: self.forces.p_n(i), length: self.v_n(i) });
        let cone = self.cone_rows();
        normal.chain(cone.clone().map(move |k| Pair { force: k, length: k + cone.len() }))
    }
}
