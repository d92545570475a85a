//! What is prescribed over time: external forces and gaps.

use std::ops::Range;

/// Nodal forces of one load at factor 1, and the factor's history.
#[derive(Debug, Clone, PartialEq)]
pub struct LoadCase {
    /// Nodal forces, n_u, N.
    pub force: Vec<f64>,
    /// Points `[time (s), factor]` with increasing times; linear between them, constant outside.
    pub history: Vec<[f64; 2]>,
}

/// A motion of an obstacle in one direction, or about one axis.
#[derive(Debug, Clone, PartialEq)]
pub struct Motion {
    /// The contact nodes in front of it.
    pub nodes: Range<usize>,
    /// What a unit of it adds to the gap of each of them, m per unit.
    pub gap: Vec<f64>,
    /// The displacement of the surface at each of them along both tangents, m per unit.
    pub drift: Vec<[f64; 2]>,
    /// Points `[time (s), distance (m) or angle (rad)]` with increasing times; linear between, constant
    /// outside.
    pub history: Vec<[f64; 2]>,
}

/// What the rates of a [`Motion`] leave out of the gaps, as an obstacle that is round passes or one that is oblique turns.
#[derive(Debug, Clone, PartialEq)]
pub struct Bend {
    /// The contact nodes in front of the obstacle.
    pub nodes: Range<usize>,
    /// Times, s, increasing.
    pub times: Vec<f64>,
    /// What to add to the gap of each node at each of them, m; linear between, constant outside.
    pub gap: Vec<Vec<f64>>,
}

/// The external forces and gaps of a history.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Loading {
    /// The loads, which add up.
    pub cases: Vec<LoadCase>,
    /// `g`, gaps before any obstacle moves, n_c, m.
    pub gap: Vec<f64>,
    /// The motions of obstacles, which add up.
    pub motions: Vec<Motion>,
    /// What goes beyond their rates.
    pub bends: Vec<Bend>,
}

/// The value at time `t` of a history: linear between its points, constant outside.
pub(crate) fn piecewise_linear(history: &[[f64; 2]], t: f64) -> Option<f64> {
    let after = history.partition_point(|[time, _]| *time <= t);
    match (after.checked_sub(1).map(|k| history[k]), history.get(after)) {
        (Some([_, value]), None) => Some(value),
        (None, first) => first.map(|[_, value]| *value),
        (Some([t0, v0]), Some([t1, v1])) => Some(v0 + (v1 - v0) * ((t - t0) / (t1 - t0))),
    }
}

impl LoadCase {
    /// The factor at time `t`.
    pub fn factor(&self, t: f64) -> f64 {
        piecewise_linear(&self.history, t).unwrap_or(1.0)
    }
}

impl Motion {
    /// How far it has gone at time `t`.
    fn at(&self, t: f64) -> f64 {
        piecewise_linear(&self.history, t).unwrap_or(0.0)
    }
}

impl Bend {
    /// Adds what belongs to time `t` to the `gap` of its nodes.
    fn add(&self, t: f64, gap: &mut [f64]) {
        let Some(last) = self.times.len().checked_sub(1) else { return };
        let after = self.times.partition_point(|time| *time <= t);
        let (k, share) = match (after.checked_sub(1), self.times.get(after)) {
            (Some(k), Some(next)) => (k, (t - self.times[k]) / (next - self.times[k])),
            (Some(_), None) => (last, 0.0),
            (None, _) => (0, 0.0),
        };
        for (i, g) in gap.iter_mut().enumerate() {
            let here = self.gap[k][i];
            *g += if share > 0.0 { here + share * (self.gap[k + 1][i] - here) } else { here };
        }
    }
}

impl Loading {
    /// The external forces (n_u, N) at time `t`.
    pub fn force(&self, t: f64, force: &mut [f64]) {
        force.fill(0.0);
        for case in &self.cases {
            let factor = case.factor(t);
            for (sum, f) in force.iter_mut().zip(&case.force) {
                *sum += factor * f;
            }
        }
    }

    /// The gaps (n_c, m) at time `t`.
    pub fn gap_at(&self, t: f64, gap: &mut [f64]) {
        gap.copy_from_slice(&self.gap);
        for motion in &self.motions {
            let distance = motion.at(t);
            let nodes = gap[motion.nodes.clone()].iter_mut();
            nodes.zip(&motion.gap).for_each(|(g, rate)| *g += distance * rate);
        }
        for bend in &self.bends {
            bend.add(t, &mut gap[bend.nodes.clone()]);
        }
    }

    /// How far the surfaces of the obstacles have moved past the contact nodes along their first (`k` = 0)
    /// or second tangents until time `t`, n_c, m. What slips is `w - drift`.
    pub fn drift_at(&self, t: f64, k: usize) -> Vec<f64> {
        let mut drift = vec![0.0; self.gap.len()];
        for motion in &self.motions {
            let distance = motion.at(t);
            let nodes = drift[motion.nodes.clone()].iter_mut();
            nodes.zip(&motion.drift).for_each(|(d, rate)| *d += distance * rate[k]);
        }
        drift
    }

    /// The largest interference over all time, m: how deep an obstacle goes into the undeformed body.
    pub fn largest_interference(&self) -> f64 {
        // Gaps are linear between all these together.
        let mut times = vec![0.0];
        times.extend(self.bends.iter().flat_map(|bend| bend.times.iter().copied()));
        times.extend(self.motions.iter().flat_map(|motion| motion.history.iter().map(|point| point[0])));
        times.sort_by(f64::total_cmp);
        times.dedup();
        let mut gap = vec![0.0; self.gap.len()];
        let mut deepest = 0.0_f64;
        for t in times {
            self.gap_at(t, &mut gap);
            deepest = gap.iter().fold(deepest, |m, g| m.max(-g));
        }
        deepest
    }

    /// A bound on the nodal forces over all time, N: the sum of each case's largest.
    pub fn largest_force(&self) -> f64 {
        let largest = |values: &mut dyn Iterator<Item = f64>| values.fold(0.0_f64, |m, v| m.max(v.abs()));
        (self.cases.iter())
            .map(|case| {
                largest(&mut case.force.iter().copied()) * largest(&mut case.history.iter().map(|point| point[1]))
            })
            .sum()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn factors_are_piecewise_linear_and_constant_outside() {
        let case = LoadCase { force: vec![2.0, -4.0], history: vec![[1.0, 0.0], [2.0, 1.0], [4.0, -1.0]] };
        for (t, factor) in [(0.0, 0.0), (1.0, 0.0), (1.25, 0.25), (2.0, 1.0), (3.0, 0.0), (4.0, -1.0), (9.0, -1.0)] {
            assert_eq!(case.factor(t), factor, "at {t}");
        }
        let loading = Loading { cases: vec![case.clone(), case], ..Loading::default() };
        let mut force = [0.0; 2];
        loading.force(1.5, &mut force);
        assert_eq!(force, [2.0, -4.0]);
        assert_eq!(loading.largest_force(), 8.0);
    }

    #[test]
    fn an_obstacle_takes_its_nodes_gaps_away_and_drifts_past_them() {
        let motion = Motion {
            nodes: 1..3,
            gap: vec![-1.0, -0.5],
            drift: vec![[0.0, 2.0], [1.0, 0.0]],
            history: vec![[0.0, 0.0], [2.0, 4.0]],
        };
        let back = Motion { history: vec![[2.0, 0.0], [4.0, -4.0]], ..motion.clone() };
        let loading = Loading { gap: vec![1.0, 2.0, 3.0], motions: vec![motion, back], ..Loading::default() };
        let mut gap = [0.0; 3];
        loading.gap_at(1.5, &mut gap);
        assert_eq!(gap, [1.0, -1.0, 1.5]);
        assert_eq!([0, 1].map(|k| loading.drift_at(1.0, k)), [[0.0, 0.0, 2.0], [0.0, 4.0, 0.0]]);
        assert_eq!(loading.drift_at(5.0, 0), [0.0; 3]);
        assert_eq!(loading.largest_interference(), 2.0);

        let bend = Bend {
            nodes: 0..2,
            times: vec![1.0, 1.5, 3.5],
            gap: vec![vec![0.0, 0.5], vec![1.0, 4.0], vec![-3.0, 0.0]],
        };
        let loading = Loading { bends: vec![bend], ..loading };
        for (t, expected) in
            [(0.5, [1.0, 1.5, 2.5]), (1.25, [1.5, 1.75, 1.75]), (1.5, [2.0, 3.0, 1.5]), (2.0, [1.0, 1.0, 1.0])]
        {
            loading.gap_at(t, &mut gap);
            assert_eq!(gap, expected, "{t}");
        }
        assert_eq!(loading.largest_interference(), 2.0);
        loading.gap_at(9.0, &mut gap);
        assert_eq!(gap[0], -2.0);
    }
}
