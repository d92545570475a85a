//! Faces of the constrained set: one member of every complementary pair is zero. On a face `H_I` is linear, so on the
//! right face a single Newton step ends the iteration.

use super::Constrained;
use crate::solver::formulation::{Face, Pair};

impl Constrained {
    /// Returns the face that a step from `before` to `z` has approached: the member of each pair that has shrunk more
    /// vanishes (Tapia's indicator). It compares no force with a length, so it does not depend on units.
    pub(super) fn face_between(&self, before: &[f64], z: &[f64]) -> Face {
        let force_shrinks_more =
            |pair: &Pair| z[pair.force] * before[pair.length] <= z[pair.length] * before[pair.force];
        let mut vanishes: Vec<bool> = self.pairs.iter().map(force_shrinks_more).collect();
        // Without pressure both s vanish, and with them p_t, so the row of the first s suffices. With pressure at
        // most one s vanishes.
        let (n_c, n_t) = (self.data.layout.contacts(), self.data.layout.tangentials());
        for i in 0..n_c {
            let Some(p_t) = self.data.layout.p_t(i) else { continue };
            let plus = n_c + p_t - self.data.layout.displacements();
            let minus = plus + n_t;
            if vanishes[i] || vanishes[plus] && vanishes[minus] {
                let [s_plus, s_minus] = self.layout.s(p_t);
                vanishes[plus] = vanishes[i] || z[s_plus] <= z[s_minus];
                vanishes[minus] = !vanishes[plus];
            }
        }
        Face::new(vanishes)
    }
}
