//! Problems of one contact node, and how many iterations many histories take.

use stickslip::algebra::{Csr, Symmetric};
use stickslip::solver::history::{HistoryOutcome, Status};
use stickslip::solver::{ContactProblem, Parts};

use super::runs::iterations;

/// A node of `n` displacements: its stiffness by the entries of the lower triangle, its rows along the normal and both tangents,
/// its friction. Nothing is free.
pub fn node(
    n: usize,
    stiffness: &[(usize, usize, f64)],
    [normal, t, o]: [&[(usize, f64)]; 3],
    mu: f64,
) -> ContactProblem {
    let row = |entries: &[(usize, f64)]| Csr::from_rows(n, [entries.to_vec()]).unwrap();
    ContactProblem::new(Parts {
        stiffness: Symmetric::from_triplets(n, stiffness).unwrap().into(),
        c_n: row(normal),
        c_t: row(t),
        c_o: row(o),
        mu: vec![mu],
        weight: Some(vec![1.0]),
        rigid_modes: Some(Vec::new()),
    })
    .unwrap()
}

/// A node in space on springs `k` along x, y and z, on a plane across z.
pub fn node_on_springs(k: f64, mu: f64) -> ContactProblem {
    node(3, &[(0, 0, k), (1, 1, k), (2, 2, k)], [&[(2, 1.0)], &[(0, 1.0)], &[(1, 1.0)]], mu)
}

/// The settings of the histories.
#[derive(Default)]
pub struct Count {
    pub increments: usize,
    iterations: usize,
    pub most: usize,
    backtracks: usize,
    pub failures: usize,
}

impl Count {
    pub fn add(&mut self, outcome: &HistoryOutcome) {
        let iterations = iterations(outcome);
        self.increments += iterations.len();
        self.iterations += iterations.iter().sum::<usize>();
        self.most = iterations.into_iter().fold(self.most, usize::max);
        self.backtracks += outcome.records.iter().map(|record| record.backtracks).sum::<usize>();
        self.failures += usize::from(outcome.status != Status::Converged);
    }

    /// Iterations in an increment.
    pub fn mean(&self) -> f64 {
        self.iterations as f64 / self.increments as f64
    }
}

impl std::fmt::Display for Count {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        let Count { increments, most, failures, .. } = self;
        let backtracks = self.backtracks as f64 / *increments as f64;
        write!(
            f,
            "{:.2} iterations (at most {most}), {backtracks:.2} backtracks in {increments} increments, {failures} failures",
            self.mean()
        )
    }
}
