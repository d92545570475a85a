//! The prescribed data over time: external forces and gaps.

mod gap_correction;

use crate::solver::problem::error::{expect_each, expect_finite, expect_history, expect_length};
use crate::solver::problem::{ContactProblem, ProblemError};
use std::ops::Range;

pub use gap_correction::GapCorrection;

use crate::base::timeline::kinks;

const PER_NODE: &str = "one for each node in front of the obstacle";

/// The nodal forces of one load at factor 1, and the history of the factor.
#[derive(Debug, Clone, PartialEq)]
pub struct LoadCase {
    force: Vec<f64>,
    history: Vec<[f64; 2]>,
}

/// A motion of an obstacle in one direction, or about one axis.
#[derive(Debug, Clone, PartialEq)]
pub struct Motion {
    nodes: Range<usize>,
    gap: Vec<f64>,
    drift: Vec<[f64; 2]>,
    history: Vec<[f64; 2]>,
}

/// The external forces and gaps of a history.
///
/// ```
/// use stickslip::solver::{LoadCase, Loading};
///
/// // 2 N on the first of two displacements, raised over a second; one node, 1 mm from its obstacle.
/// let load = LoadCase::new(vec![2.0, 0.0], vec![[0.0, 0.0], [1.0, 1.0]])?;
/// let loading = Loading::new(vec![load], vec![1e-3])?;
/// assert_eq!((loading.cases()[0].factor(0.5), loading.gaps_at(0.5)), (0.5, vec![1e-3]));
/// # Ok::<(), stickslip::solver::ProblemError>(())
/// ```
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Loading {
    cases: Vec<LoadCase>,
    gap: Vec<f64>,
    motions: Vec<Motion>,
    gap_corrections: Vec<GapCorrection>,
    friction: Option<FrictionHistory>,
}

/// Returns the value of a history at time `t`: linear between its points, constant outside.
pub(crate) fn piecewise_linear(history: &[[f64; 2]], t: f64) -> Option<f64> {
    let after = history.partition_point(|[time, _]| *time <= t);
    match (after.checked_sub(1).map(|k| history[k]), history.get(after)) {
        (Some([_, value]), None) => Some(value),
        (None, first) => first.map(|[_, value]| *value),
        (Some([t0, v0]), Some([t1, v1])) => Some(v0 + (v1 - v0) * ((t - t0) / (t1 - t0))),
    }
}

impl LoadCase {
    /// Creates a load of `force` (n_u, N) at factor 1. The factor is linear between the points `[time (s), factor]`
    /// of `history` and constant outside; it is 1 if there are no points.
    ///
    /// # Errors
    /// If a number is not finite, or if the times do not increase.
    pub fn new(force: Vec<f64>, history: Vec<[f64; 2]>) -> Result<Self, ProblemError> {
        expect_finite("force", &force)?;
        expect_history("history", &history)?;
        Ok(LoadCase { force, history })
    }

    /// Returns the nodal forces at factor 1, n_u, N.
    pub fn force(&self) -> &[f64] {
        &self.force
    }

    /// Returns the points of the factor's history.
    pub fn history(&self) -> &[[f64; 2]] {
        &self.history
    }

    /// Returns a load with the same factor and another `force`.
    pub(crate) fn on(&self, force: Vec<f64>) -> Self {
        LoadCase { force, history: self.history.clone() }
    }

    /// Returns the factor at time `t`.
    pub fn factor(&self, t: f64) -> f64 {
        piecewise_linear(&self.history, t).unwrap_or(1.0)
    }
}

impl Motion {
    /// Creates the motion of an obstacle in front of the contact nodes `nodes`. One unit of motion adds `gap` (m per
    /// unit) to the gap of each node and moves the surface by `drift` (m per unit) along its tangents. The motion is
    /// linear between the points `[time (s), distance (m) or angle (rad)]` of `history` and constant outside.
    ///
    /// # Errors
    /// If there is not one gap and one drift for each node, if a number is not finite, or if the times do not
    /// increase.
    pub fn new(
        nodes: Range<usize>,
        gap: Vec<f64>,
        drift: Vec<[f64; 2]>,
        history: Vec<[f64; 2]>,
    ) -> Result<Self, ProblemError> {
        expect_length("gap", nodes.len(), gap.len(), PER_NODE)?;
        expect_length("drift", nodes.len(), drift.len(), PER_NODE)?;
        expect_finite("gap", &gap)?;
        drift.iter().enumerate().try_for_each(|(k, drift)| expect_finite(&format!("drift[{k}]"), drift))?;
        expect_history("history", &history)?;
        Ok(Motion { nodes, gap, drift, history })
    }

    /// Returns the points of the history.
    pub fn history(&self) -> &[[f64; 2]] {
        &self.history
    }

    /// Returns the motion at time `t`.
    fn at(&self, t: f64) -> f64 {
        piecewise_linear(&self.history, t).unwrap_or(0.0)
    }
}

impl Loading {
    /// Returns `true` if the loads have the nodal forces of those of `other`, with any histories.
    pub(crate) fn has_forces_of(&self, other: &Loading) -> bool {
        self.cases.len() == other.cases.len() && self.cases.iter().zip(&other.cases).all(|(a, b)| a.force == b.force)
    }

    /// Creates the sum of `cases`, with `gap`, the gaps before any obstacle moves, n_c, m.
    ///
    /// # Errors
    /// If the loads have forces of different lengths, or if a gap is not finite.
    pub fn new(cases: Vec<LoadCase>, gap: Vec<f64>) -> Result<Self, ProblemError> {
        let first = cases.first().map_or(0, |case| case.force.len());
        for (k, case) in cases.iter().enumerate() {
            expect_length(format!("force of load {k}"), first, case.force.len(), "as many as the first load has")?;
        }
        expect_finite("gap", &gap)?;
        Ok(Loading { cases, gap, motions: Vec::new(), gap_corrections: Vec::new(), friction: None })
    }

    /// Adds motions of obstacles, whose effects are summed, and corrections of gaps.
    ///
    /// # Errors
    /// If one of them names a missing contact node, or if the motions overflow.
    pub fn with_motions(self, motions: Vec<Motion>, gap_corrections: Vec<GapCorrection>) -> Result<Self, ProblemError> {
        let n_c = self.gap.len();
        let ends = motions
            .iter()
            .map(|motion| ("motion", &motion.nodes))
            .chain(gap_corrections.iter().map(|bend| ("bend", &bend.nodes)));
        for (what, nodes) in ends {
            if nodes.start > nodes.end {
                let (array, value) = (format!("nodes of a {what}"), nodes.start as f64);
                return Err(ProblemError::Value { array, value, must: "a range that does not end before it begins" });
            }
            if nodes.end > n_c {
                return expect_length(format!("nodes of a {what}"), n_c, nodes.end, "at most one for each gap")
                    .map(|()| self);
            }
        }
        let loading = Loading { motions, gap_corrections, ..self };
        let mut gap = vec![0.0; n_c];
        for t in loading.corner_times() {
            loading.gap_at(t, &mut gap);
            expect_finite("gap", &gap)?;
            for k in 0..2 {
                expect_finite("drift", &loading.drift_at(t, k))?;
            }
        }
        Ok(loading)
    }

    /// Sets the history of friction, if it changes in time.
    ///
    /// # Errors
    /// If there is not one coefficient for each gap.
    pub fn with_friction(self, friction: Option<FrictionHistory>) -> Result<Self, ProblemError> {
        let nodes = friction.as_ref().map_or(self.gap.len(), FrictionHistory::nodes);
        expect_length("mu", self.gap.len(), nodes, "one for each gap")?;
        Ok(Loading { friction, ..self })
    }

    /// Returns the history of friction, if it changes in time.
    pub fn friction(&self) -> Option<&FrictionHistory> {
        self.friction.as_ref()
    }

    /// Returns the loads.
    pub fn cases(&self) -> &[LoadCase] {
        &self.cases
    }

    /// Returns `g`, the gaps before any obstacle moves, n_c, m.
    pub fn gap(&self) -> &[f64] {
        &self.gap
    }

    /// Returns the motions of obstacles.
    pub fn motions(&self) -> &[Motion] {
        &self.motions
    }

    /// Returns the corrections of gaps beyond the rates of the motions.
    pub fn gap_corrections(&self) -> &[GapCorrection] {
        &self.gap_corrections
    }

    /// Calls `visit` with every array of loads and gaps.
    pub(crate) fn each_array(&self, mut visit: impl FnMut(&[f64])) {
        visit(&self.gap);
        for LoadCase { force, history } in &self.cases {
            visit(force);
            visit(history.as_flattened());
        }
        for Motion { nodes, gap, drift, history } in &self.motions {
            visit(&[nodes.start as f64]);
            [gap, drift.as_flattened(), history.as_flattened()].into_iter().for_each(&mut visit);
        }
        for GapCorrection { nodes, times, gap, drift } in &self.gap_corrections {
            visit(&[nodes.start as f64]);
            visit(times);
            for row in gap.iter().map(Vec::as_slice).chain(drift.iter().map(|row| row.as_flattened())) {
                visit(row);
            }
        }
    }

    /// Replaces the loads; the contact nodes remain.
    pub(crate) fn with_cases(&self, cases: Vec<LoadCase>) -> Self {
        Loading { cases, ..self.clone() }
    }

    /// Checks that the loading fits `problem`.
    ///
    /// # Errors
    /// If the number of forces or gaps differs from that of the displacements or contact nodes of `problem`, or if the
    /// history of friction has friction at other nodes.
    pub fn check(&self, problem: &ContactProblem) -> Result<(), ProblemError> {
        if let Some(case) = self.cases.first() {
            expect_length("force of a load", problem.displacements(), case.force.len(), "one for each displacement")?;
        }
        expect_length("gap", problem.contacts(), self.gap.len(), "one for each contact node")?;
        let largest = self.friction.as_ref().map_or_else(Vec::new, FrictionHistory::largest);
        match largest.iter().zip(problem.mu()).position(|(mu, of_problem)| (*mu > 0.0) != (*of_problem > 0.0)) {
            None => Ok(()),
            Some(i) => Err(ProblemError::Value {
                array: format!("mu[{i}] of the history of friction"),
                value: largest[i],
                must: "positive where that of the problem is, and 0 elsewhere",
            }),
        }
    }

    /// Returns the external forces (n_u, N) on `problem` at time `t`.
    ///
    /// # Errors
    /// As [`Loading::check`].
    pub fn force_at(&self, t: f64, problem: &ContactProblem) -> Result<Vec<f64>, ProblemError> {
        self.check(problem)?;
        let mut force = vec![0.0; problem.displacements()];
        self.force(t, &mut force);
        Ok(force)
    }

    /// Computes the external forces (n_u, N) at time `t`.
    pub(crate) fn force(&self, t: f64, force: &mut [f64]) {
        force.fill(0.0);
        for case in &self.cases {
            let factor = case.factor(t);
            for (sum, f) in force.iter_mut().zip(&case.force) {
                *sum += factor * f;
            }
        }
    }

    /// Returns the sums of the absolute values of the loads (n_u, N) at time `t`.
    pub(crate) fn force_sizes(&self, t: f64, displacements: usize) -> Vec<f64> {
        let mut sizes = vec![0.0; displacements];
        for case in &self.cases {
            let factor = case.factor(t);
            sizes.iter_mut().zip(&case.force).for_each(|(size, f)| *size += (factor * f).abs());
        }
        sizes
    }

    /// Returns `true` if there are loads or interference at t = 0.
    pub(crate) fn is_present_at_start(&self, displacements: usize) -> bool {
        let loaded = self.force_sizes(0.0, displacements).iter().any(|f| *f != 0.0);
        loaded || self.gaps_at(0.0).iter().any(|gap| *gap < 0.0)
    }

    /// Returns the largest distance of curved gap histories from their linear interpolation between the times of
    /// their [`GapCorrection`]s, m.
    pub(crate) fn off_the_chords(&self) -> f64 {
        let kinks = self.kinks();
        self.gap_corrections.iter().map(|bend| bend.off_the_chords(&kinks)).fold(0.0, f64::max)
    }

    /// Returns the factors of all loads, the motions of all obstacles and the factors of friction at time `t`: the loading
    /// at two times is equal if these are.
    pub(crate) fn factors_at(&self, t: f64) -> Vec<f64> {
        let loads = self.cases.iter().map(|case| case.factor(t));
        let motions = self.motions.iter().map(|motion| motion.at(t));
        let friction = self.friction.iter().flat_map(|friction| &friction.cases);
        let friction = friction.map(|(_, history)| piecewise_linear(history, t).unwrap_or(1.0));
        loads.chain(motions).chain(friction).collect()
    }

    /// Returns the gaps (n_c, m) at time `t`.
    pub fn gaps_at(&self, t: f64) -> Vec<f64> {
        let mut gap = self.gap.clone();
        self.gap_at(t, &mut gap);
        gap
    }

    /// Computes the gaps (n_c, m) at time `t`.
    pub(crate) fn gap_at(&self, t: f64, gap: &mut [f64]) {
        gap.copy_from_slice(&self.gap);
        for motion in &self.motions {
            let distance = motion.at(t);
            let nodes = gap[motion.nodes.clone()].iter_mut();
            nodes.zip(&motion.gap).for_each(|(g, rate)| *g += distance * rate);
        }
        for bend in &self.gap_corrections {
            bend.add(t, &mut gap[bend.nodes.clone()]);
        }
    }

    /// Returns the tangential motions of the obstacles at the contact nodes along their first (`k` = 0) or second
    /// tangents until time `t`, n_c, m. Slip is the change of `w - drift`.
    pub fn drift_at(&self, t: f64, k: usize) -> Vec<f64> {
        let mut drift = vec![0.0; self.gap.len()];
        for motion in &self.motions {
            let distance = motion.at(t);
            let nodes = drift[motion.nodes.clone()].iter_mut();
            nodes.zip(&motion.drift).for_each(|(d, rate)| *d += distance * rate.get(k).unwrap_or(&0.0));
        }
        for bend in self.gap_corrections.iter().filter(|_| k < 2) {
            bend.add_drift(t, k, &mut drift[bend.nodes.clone()]);
        }
        drift
    }

    /// Returns the times after 0 between which forces and gaps are linear, ascending.
    pub(crate) fn corners(&self) -> Vec<f64> {
        let mut times = self.corner_times();
        times.extend(self.cases.iter().flat_map(|case| case.history.iter().map(|point| point[0])));
        times.retain(|time| *time > 0.0);
        times.sort_by(f64::total_cmp);
        times.dedup();
        times
    }

    /// Returns the times (s) at which a load, the motion of an obstacle or friction changes its rate, ascending.
    pub fn kinks(&self) -> Vec<f64> {
        let loads = self.cases.iter().map(|case| &case.history);
        let motions = self.motions.iter().map(|motion| &motion.history);
        let friction = self.friction.iter().flat_map(|friction| friction.cases.iter().map(|(_, history)| history));
        let mut times: Vec<f64> = loads.chain(motions).chain(friction).flat_map(|history| kinks(history)).collect();
        times.sort_by(f64::total_cmp);
        times.dedup();
        times
    }

    /// Returns the times between which gaps are linear.
    fn corner_times(&self) -> Vec<f64> {
        let mut times = vec![0.0];
        times.extend(self.gap_corrections.iter().flat_map(|bend| bend.times.iter().copied()));
        times.extend(self.motions.iter().flat_map(|motion| motion.history.iter().map(|point| point[0])));
        times.sort_by(f64::total_cmp);
        times.dedup();
        times
    }

    /// Returns the largest interference over all time, m: the depth of an obstacle in the undeformed body.
    pub fn largest_interference(&self) -> f64 {
        let mut gap = vec![0.0; self.gap.len()];
        let mut deepest = 0.0_f64;
        for t in self.corner_times() {
            self.gap_at(t, &mut gap);
            deepest = gap.iter().fold(deepest, |m, g| m.max(-g));
        }
        deepest
    }

    /// Returns a bound on the nodal forces over all time, N: the sum of each case's largest.
    pub fn largest_force(&self) -> f64 {
        let largest = |values: &mut dyn Iterator<Item = f64>| values.fold(0.0_f64, |m, v| m.max(v.abs()));
        (self.cases.iter())
            .map(|case| {
                largest(&mut case.force.iter().copied()) * largest(&mut case.history.iter().map(|point| point[1]))
            })
            .sum()
    }
}

impl Loading {
    /// Restricts the loading to the contact `nodes`, ascending.
    pub(crate) fn of_nodes(&self, nodes: &[usize]) -> Self {
        let motion = |motion: &Motion| {
            let (indices, nodes) = restricted(&motion.nodes, nodes);
            Motion {
                gap: nodes.iter().map(|i| motion.gap[i - motion.nodes.start]).collect(),
                drift: nodes.iter().map(|i| motion.drift[i - motion.nodes.start]).collect(),
                nodes: indices,
                history: motion.history.clone(),
            }
        };
        let restricted_correction = |correction: &GapCorrection| {
            let (indices, nodes) = restricted(&correction.nodes, nodes);
            let of = |i: &usize| i - correction.nodes.start;
            GapCorrection {
                gap: correction.gap.iter().map(|row| nodes.iter().map(|i| row[of(i)]).collect()).collect(),
                drift: correction.drift.iter().map(|row| nodes.iter().map(|i| row[of(i)]).collect()).collect(),
                nodes: indices,
                times: correction.times.clone(),
            }
        };
        Loading {
            cases: self.cases.clone(),
            gap: nodes.iter().map(|&i| self.gap[i]).collect(),
            motions: self.motions.iter().map(motion).collect(),
            gap_corrections: self.gap_corrections.iter().map(restricted_correction).collect(),
            friction: self.friction.as_ref().map(|friction| friction.of_nodes(nodes)),
        }
    }
}

impl FrictionHistory {
    fn of_nodes(&self, nodes: &[usize]) -> Self {
        let case =
            |(mu, history): &(Vec<f64>, Vec<[f64; 2]>)| (nodes.iter().map(|&i| mu[i]).collect(), history.clone());
        FrictionHistory { nodes: nodes.len(), cases: self.cases.iter().map(case).collect() }
    }
}

/// Returns the `nodes` in `range`, and their positions in `nodes`.
fn restricted<'a>(range: &Range<usize>, nodes: &'a [usize]) -> (Range<usize>, &'a [usize]) {
    let index = |end: usize| nodes.partition_point(|node| *node < end);
    let indices = index(range.start)..index(range.end);
    (indices.clone(), &nodes[indices])
}

/// Coulomb's coefficients of the contact nodes over time, `μ_i(t) = Σ_k f_k(t) μ_ki`.
#[derive(Debug, Clone, PartialEq)]
pub struct FrictionHistory {
    nodes: usize,
    /// `μ_k` at factor 1, with the points of `f_k`.
    cases: Vec<(Vec<f64>, Vec<[f64; 2]>)>,
}

impl FrictionHistory {
    /// Creates the sum of `cases`: coefficients of `nodes` contact nodes at factor 1, and points
    /// `[time (s), factor]`. The factor is linear between the points and constant outside; it is 1 if there are no
    /// points.
    ///
    /// # Errors
    /// If there is not one coefficient for each node, if one is negative or not finite, if times do not increase, or
    /// if a factor is negative.
    pub fn new(nodes: usize, cases: Vec<(Vec<f64>, Vec<[f64; 2]>)>) -> Result<Self, ProblemError> {
        for (mu, history) in &cases {
            expect_length("mu", nodes, mu.len(), "one for each contact node")?;
            expect_finite("mu", mu)?;
            expect_each("mu", mu, "0 or more", |mu| mu >= 0.0)?;
            expect_history("history of friction", history)?;
            let factors: Vec<f64> = history.iter().map(|point| point[1]).collect();
            expect_each("factors of friction", &factors, "0 or more", |factor| factor >= 0.0)?;
        }
        Ok(FrictionHistory { nodes, cases })
    }

    /// Returns the number of contact nodes.
    pub fn nodes(&self) -> usize {
        self.nodes
    }

    /// Calls `visit` with every array.
    pub(crate) fn each_array(&self, mut visit: impl FnMut(&[f64])) {
        for (mu, history) in &self.cases {
            visit(mu);
            visit(history.as_flattened());
        }
    }

    /// Returns the coefficients at time `t` (s).
    pub fn at(&self, t: f64) -> Vec<f64> {
        let mut mu = vec![0.0; self.nodes];
        for (case, history) in &self.cases {
            let factor = piecewise_linear(history, t).unwrap_or(1.0);
            mu.iter_mut().zip(case).for_each(|(sum, mu)| *sum += factor * mu);
        }
        mu
    }

    /// Returns the largest coefficient of each node over all time.
    pub fn largest(&self) -> Vec<f64> {
        let times = self.cases.iter().flat_map(|(_, history)| history.iter().map(|point| point[0]));
        times.chain([0.0]).map(|t| self.at(t)).fold(vec![0.0; self.nodes], |mut largest, mu| {
            largest.iter_mut().zip(mu).for_each(|(largest, mu)| *largest = largest.max(mu));
            largest
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn factors_are_piecewise_linear_and_constant_outside() {
        let case = LoadCase::new(vec![2.0, -4.0], vec![[1.0, 0.0], [2.0, 1.0], [4.0, -1.0]]).unwrap();
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

        let correction = GapCorrection {
            nodes: 0..2,
            times: vec![1.0, 1.5, 3.5],
            gap: vec![vec![0.0, 0.5], vec![1.0, 4.0], vec![-3.0, 0.0]],
            drift: vec![vec![[0.0; 2], [0.0; 2]], vec![[0.0; 2], [0.0, 2.0]], vec![[4.0, 0.0], [0.0, 2.0]]],
        };
        let loading = Loading { gap_corrections: vec![correction], ..loading };
        for (t, expected) in
            [(0.5, [1.0, 1.5, 2.5]), (1.25, [1.5, 1.75, 1.75]), (1.5, [2.0, 3.0, 1.5]), (2.0, [1.0, 1.0, 1.0])]
        {
            loading.gap_at(t, &mut gap);
            assert_eq!(gap, expected, "{t}");
        }
        assert_eq!(loading.largest_interference(), 2.0);
        loading.gap_at(9.0, &mut gap);
        assert_eq!(gap[0], -2.0);
        let before = Loading { gap_corrections: Vec::new(), ..loading.clone() };
        for (t, added) in [(1.0, [[0.0; 2]; 2]), (1.25, [[0.0; 2], [0.0, 1.0]]), (9.0, [[4.0, 0.0], [0.0, 2.0]])] {
            for k in 0..2 {
                let [with, without] = [&loading, &before].map(|loading| loading.drift_at(t, k));
                assert_eq!([with[0] - without[0], with[1] - without[1]], added.map(|of_node| of_node[k]), "{t}");
            }
        }
    }

    #[test]
    fn gaps_drifts_and_friction_are_those_of_the_nodes() {
        let history = vec![[0.0, 0.0], [2.0, 4.0]];
        let motion =
            Motion::new(1..4, vec![-1.0, -0.5, 2.0], vec![[0.0, 2.0], [1.0, 0.0], [3.0, 1.0]], history).unwrap();
        let correction = GapCorrection::new(0..2, vec![0.0, 2.0], vec![vec![0.0, 0.5], vec![1.0, 4.0]]).unwrap();
        let correction = correction.with_drift(vec![vec![[0.0; 2]; 2], vec![[1.0, 2.0], [3.0, 4.0]]]).unwrap();
        let friction = FrictionHistory::new(5, vec![(vec![0.1, 0.2, 0.3, 0.4, 0.5], Vec::new())]).unwrap();
        let all = Loading::new(Vec::new(), vec![1.0, 2.0, 3.0, 4.0, 5.0]).unwrap();
        let all = all.with_motions(vec![motion], vec![correction]).unwrap().with_friction(Some(friction)).unwrap();
        for nodes in [vec![0, 1, 2, 3, 4], vec![1, 3], vec![0, 4], vec![2], vec![3, 4], vec![4]] {
            let some = all.of_nodes(&nodes);
            let of_all = |values: Vec<f64>| nodes.iter().map(|&i| values[i]).collect::<Vec<_>>();
            for t in [0.0, 0.7, 2.0, 3.0] {
                assert_eq!(some.gaps_at(t), of_all(all.gaps_at(t)));
                assert_eq!(some.friction().unwrap().at(t), of_all(all.friction().unwrap().at(t)));
                for k in 0..2 {
                    assert_eq!(some.drift_at(t, k), of_all(all.drift_at(t, k)));
                }
            }
        }
    }

    #[test]
    fn coefficients_are_sums_of_cases() {
        let falling = (vec![0.4, 0.1, 0.0], vec![[1.0, 1.0], [3.0, 0.5]]);
        let friction = FrictionHistory::new(3, vec![falling, (vec![0.0, 0.1, 0.2], Vec::new())]).unwrap();
        assert_eq!(friction.at(0.0), [0.4, 0.2, 0.2]);
        assert_eq!(friction.at(9.0), [0.2, 0.5 * 0.1 + 0.1, 0.2]);
        assert_eq!(friction.at(2.0)[0], 0.75 * 0.4);
        assert_eq!(friction.largest(), [0.4, 0.2, 0.2]);
        for (mu, history, says) in [
            (vec![0.4], vec![], "mu has 1"),
            (vec![0.4, 0.4, -0.1], vec![], "mu[2] is -0.1"),
            (vec![0.4; 3], vec![[0.0, 1.0], [1.0, -1.0]], "factors of friction[1] is -1"),
            (vec![0.4; 3], vec![[1.0, 1.0], [0.0, 1.0]], "history of friction"),
        ] {
            let error = FrictionHistory::new(3, vec![(mu, history)]).unwrap_err().to_string();
            assert!(error.contains(says), "{error}");
        }
    }
}
