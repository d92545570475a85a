//! Faces of the constrained set: of every complementary pair one member is zero. On a face `H_I` is
//! linear, so on the right one a single Newton step ends the iteration.

use super::Constrained;
use crate::formulation::Pair;

/// What every contact node does: for each pair, in their order, whether the force vanishes (else
/// the length does).
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Face(Vec<bool>);

impl Constrained {
    /// The face that a step from `before` to `z` has gone towards: of each pair that member vanishes
    /// which has shrunk more (Tapia's indicator). It compares no force with a length, so it is the
    /// same in all units.
    pub(super) fn face_between(&self, before: &[f64], z: &[f64]) -> Face {
        let force_shrinks_more =
            |pair: &Pair| z[pair.force] * before[pair.length] <= z[pair.length] * before[pair.force];
        let mut vanishes: Vec<bool> = self.pairs.iter().map(force_shrinks_more).collect();
        // Without pressure both s vanish, and with them p_t: that the first does says it all. With
        // pressure at most one does.
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
        Face(vanishes)
    }
}

impl Face {
    /// A point of length `unknowns` in the relative interior of the face, at which the products'
    /// linearisation says which member of each of the `pairs` is to vanish.
    pub fn point(&self, pairs: &[Pair], unknowns: usize) -> Vec<f64> {
        let mut point = vec![0.0; unknowns];
        for (pair, &force_vanishes) in pairs.iter().zip(&self.0) {
            point[if force_vanishes { pair.length } else { pair.force }] = 1.0;
        }
        point
    }

    /// The right-hand side of the step from `z` (with residual `h`) to the face: `-h`, and in the
    /// products the member that is to vanish.
    pub fn towards(&self, pairs: &[Pair], z: &[f64], h: &[f64], b: &mut [f64]) {
        b.iter_mut().zip(h).for_each(|(b, h)| *b = -h);
        for (pair, &force_vanishes) in pairs.iter().zip(&self.0) {
            b[pair.length] = -z[if force_vanishes { pair.force } else { pair.length }];
        }
    }
}
