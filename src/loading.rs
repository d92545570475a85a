//! What is prescribed over time: external forces and gaps.

/// Nodal forces of one load at factor 1, and the factor's history.
#[derive(Debug, Clone, PartialEq)]
pub struct LoadCase {
    /// Nodal forces, n_u, N.
    pub force: Vec<f64>,
    /// Points `[time (s), factor]` with increasing times; linear between them, constant outside.
    pub history: Vec<[f64; 2]>,
}

/// The external forces and gaps of a history.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Loading {
    /// The loads, which add up.
    pub cases: Vec<LoadCase>,
    /// `g`, initial gaps, n_c, m.
    pub gap: Vec<f64>,
}

impl LoadCase {
    /// The factor at time `t`.
    pub fn factor(&self, t: f64) -> f64 {
        let after = self.history.partition_point(|[time, _]| *time <= t);
        match (after.checked_sub(1).map(|k| self.history[k]), self.history.get(after)) {
            (Some([_, factor]), None) => factor,
            (None, Some([_, factor])) => *factor,
            (Some([t0, f0]), Some([t1, f1])) => f0 + (f1 - f0) * ((t - t0) / (t1 - t0)),
            (None, None) => 1.0,
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
        let loading = Loading { cases: vec![case.clone(), case], gap: vec![] };
        let mut force = [0.0; 2];
        loading.force(1.5, &mut force);
        assert_eq!(force, [2.0, -4.0]);
        assert_eq!(loading.largest_force(), 8.0);
    }
}
