//! The linearisation with given right-hand sides: the propagation of solutions and of errors for fixed contact cases.

use super::Bdiff;
use crate::solver::laws::coulomb::{NormalCase, TangentialCase};

/// Slip directions count as different if the cosine between them is smaller.
const ALIKE: f64 = 0.99;

impl Bdiff {
    /// Returns the tangential case of node `i` at `z`: [`TangentialCase::NoPressure`] if the node is open or has no
    /// friction.
    pub fn friction_case(&self, i: usize, z: &[f64]) -> TangentialCase {
        match self.case(i, z) {
            (NormalCase::Closed, Some(case)) => case,
            _ => TangentialCase::NoPressure,
        }
    }

    /// Returns `true` if node `i` is closed at `z`.
    pub fn is_closed(&self, i: usize, z: &[f64]) -> bool {
        self.case(i, z).0 == NormalCase::Closed
    }

    /// Returns `true` if the last linearisation has these cases (closed or not, tangential case), ignoring small
    /// changes of slip direction.
    pub fn is_linearized_for(&self, cases: &[(bool, TangentialCase)]) -> bool {
        let alike = |last: &TangentialCase, case: &TangentialCase| match (last, case) {
            (TangentialCase::Slip { direction: n, .. }, TangentialCase::Slip { direction: m, .. }) => {
                n[0] * m[0] + n[1] * m[1] > ALIKE
            }
            (last, case) => last == case,
        };
        self.cases.iter().zip(cases).all(|(last, &(closed, case))| match last {
            None => false,
            Some((normal, last)) => {
                closed == (*normal == NormalCase::Closed)
                    && last.as_ref().is_none_or(|last| !closed || alike(last, &case))
            }
        })
    }

    /// Linearises for these cases, as [`Bdiff::linearize`] does for those of a `z`.
    pub fn linearize_for(&mut self, cases: &[(bool, TangentialCase)]) {
        self.write_cases(|this, i| {
            let (closed, case) = cases[i];
            (closed.into(), this.layout().has_friction(i).then_some(case))
        });
    }

    /// Returns the right-hand side of [`Bdiff::jacobian`] for the change of a solution when the forces change by
    /// `force`, the gaps by `gap`, and the origins of slip by `origin`, with the cases of the last linearisation.
    pub fn change(&self, force: impl IntoIterator<Item = f64>, gap: &[f64], origin: &[[f64; 2]]) -> Vec<f64> {
        let mut b = vec![0.0; self.unknowns()];
        b.iter_mut().zip(force).for_each(|(b, force)| *b = force);
        for (i, (gap, origin)) in gap.iter().zip(origin).enumerate() {
            let Some((normal, tangential)) = self.cases[i] else { continue };
            if normal == NormalCase::Closed {
                b[self.layout().p_n(i)] = self.rows.r_n[i] * gap;
            }
            let moved = match tangential {
                Some(TangentialCase::Stick) => *origin,
                Some(TangentialCase::Slip { turning, .. }) => {
                    turning.map(|row| row[0] * origin[0] + row[1] * origin[1])
                }
                Some(TangentialCase::NoPressure) | None => continue,
            };
            for (place, moved) in self.layout().tangential(i).into_iter().zip(moved) {
                if let Some(place) = place {
                    b[place] = self.rows.r_t[i] * moved;
                }
            }
        }
        b
    }

    /// Returns `w_n` of node `i` in a `z`, or in a change of one.
    pub fn w_n(&self, i: usize, z: &[f64]) -> f64 {
        self.data.w_n(i, z)
    }

    /// Returns `w_T` of node `i`.
    pub fn w_t(&self, i: usize, z: &[f64]) -> [f64; 2] {
        self.data.tangential(i, z)
    }

    /// Returns `p_T` of node `i`.
    pub fn p_t(&self, i: usize, z: &[f64]) -> [f64; 2] {
        self.data.friction(i, z)
    }

    /// Returns the slip increment of node `i` at `z`.
    pub fn slip(&self, i: usize, z: &[f64]) -> [f64; 2] {
        self.data.slip(i, self.data.tangential(i, z))
    }

    /// Returns the gap, the coefficient of friction and the origins of slip of node `i` in this increment.
    pub fn at_node(&self, i: usize) -> (f64, f64, [f64; 2]) {
        (self.data.gap[i], self.data.mu[i], [self.data.w_t_last[i], self.data.w_o_last[i]])
    }

    /// Returns the forces of this increment.
    pub fn force(&self) -> &[f64] {
        &self.data.force
    }
}
