//! The equations of a body that slides along its contact without end.

use super::Bdiff;
use crate::algebra::null_space::NEGLIGIBLE;
use crate::solver::laws::coulomb::{NormalCase, TangentialCase, direction, length};
use std::collections::BTreeSet;

/// The length of a motion, relative to the displacements and to the motion of obstacles, whose direction is the slip of
/// every node that it moves.
const FAR: f64 = 1e3;

impl Bdiff {
    /// Linearises for friction against the rigid motion with these weights at the nodes that press in `p_n` (n_c); the
    /// other nodes are open. Pins the modes that nothing but this friction resists.
    pub fn linearize_sliding(&mut self, p_n: &[f64], weights: &[f64]) {
        let motion = self.data.motion(weights, self.unknowns());
        let along: Vec<[f64; 2]> = (0..p_n.len()).map(|i| self.data.tangential(i, &motion)).collect();
        let farthest = along.iter().fold(0.0_f64, |m, w| m.max(length(*w)));
        let cases = along.iter().zip(p_n).map(|(w, p_n)| match p_n {
            p_n if *p_n <= 0.0 => (NormalCase::Open, TangentialCase::NoPressure),
            _ if length(*w) <= NEGLIGIBLE * farthest => (NormalCase::Closed, TangentialCase::Stick),
            _ => (NormalCase::Closed, TangentialCase::Slip { direction: direction(*w), turning: [[0.0; 2]; 2] }),
        });
        self.set_cases(cases.collect::<Vec<_>>());
        self.pin_unconstrained_modes();
    }

    /// Returns `true` if all nodes of the parts that the motion moves have the cases of [`Bdiff::linearize_sliding`] at `z`
    /// and however far they move on along it; `part` are the parts of the nodes. The solution `z` of its equations then obeys
    /// every law of contact there, while the pins carry what friction does not. Other parts know nothing of it.
    pub fn slides_on(&self, z: &[f64], weights: &[f64], part: &[usize]) -> bool {
        let largest = |x: &[f64]| x.iter().fold(0.0_f64, |m, x| m.max(x.abs()));
        let motion = self.data.motion(weights, z.len());
        let data = &self.data;
        let lengths = [&z[..self.layout().displacements()], &data.w_t_last, &data.w_o_last].map(largest);
        let size = FAR * lengths.into_iter().fold(0.0, f64::max) / largest(&motion);
        let ahead: Vec<f64> = z.iter().zip(&motion).map(|(z, u)| z + size * u).collect();
        let slips = |i: &usize| matches!(self.cases[*i], Some((_, Some(TangentialCase::Slip { .. }))));
        let moved: BTreeSet<usize> = (0..part.len()).filter(slips).map(|i| part[i]).collect();
        (0..part.len()).filter(|i| moved.contains(&part[*i])).all(|i| self.keeps_case(i, &ahead))
    }

    /// Returns the trial normal forces `p_n + r (w_n - g)` at `z`, at least 0, in the unit of the scaling.
    pub fn pressing(&self, z: &[f64]) -> Vec<f64> {
        let data = &self.data;
        let trial = |i: usize| z[data.layout.p_n(i)] + self.rows.r_n[i] * (data.w_n(i, z) - data.gap[i]);
        (0..data.layout.contacts()).map(|i| trial(i).max(0.0)).collect()
    }
}
