//! Faces of the constrained set: of every complementary pair one member is zero. On a face `H_I` is
//! linear, so on the right one a single Newton step ends the iteration.

use super::{Constrained, Pair};

/// What every contact node does: for each pair, in their order, whether the force vanishes (else
/// the length does).
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Face(Vec<bool>);

impl Constrained {
    /// The face that a step from `before` to `z` has gone towards: of each pair that member vanishes
    /// which has shrunk more (Tapia's indicator). It compares no force with a length, so it is the
    /// same in all units.
    pub fn face_ahead(&self, before: &[f64], z: &[f64]) -> Face {
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

    /// A point of the relative interior of `face`, at which the products' linearisation says which
    /// member of each pair is to vanish.
    pub fn point_on(&self, face: &Face) -> Vec<f64> {
        let mut point = vec![0.0; self.layout.unknowns()];
        for (pair, &force_vanishes) in self.pairs.iter().zip(&face.0) {
            point[if force_vanishes { pair.length } else { pair.force }] = 1.0;
        }
        point
    }

    /// The right-hand side of the step from `z` (with residual `h`) to `face`: `-h`, and in the
    /// products the member that is to vanish.
    pub fn towards(&self, face: &Face, z: &[f64], h: &[f64], b: &mut [f64]) {
        b.iter_mut().zip(h).for_each(|(b, h)| *b = -h);
        for (pair, &force_vanishes) in self.pairs.iter().zip(&face.0) {
            b[pair.length] = -z[if force_vanishes { pair.force } else { pair.length }];
        }
    }

    /// Sets `v_n`, `s` and `λ` to what `(u, p_t, p_n)` leave of gap, cone and slip.
    pub fn complete(&self, z: &mut [f64]) {
        for i in 0..self.data.layout.contacts() {
            let p_n = self.data.layout.p_n(i);
            z[self.layout.v_n(i)] = self.distance(i, z);
            if let Some(p_t) = self.data.layout.p_t(i) {
                let slip = self.data.w_t(i, z) - self.data.w_t_last[i];
                let (s, lambda) = (self.layout.s(p_t), self.layout.lambda(p_t));
                for (sign, s, lambda) in [(1.0, s[0], lambda[0]), (-1.0, s[1], lambda[1])] {
                    z[s] = self.data.mu[i] * z[p_n] - sign * z[p_t];
                    z[lambda] = (sign * slip).max(0.0);
                }
            }
        }
    }
}
