//! MUMPS, a multifrontal LU on all MPI processes, for the uncondensed contact Jacobian.
//!
//! The values change while the analysis is kept. Therefore the analysis must not depend on values: there is no
//! permutation for large diagonals. Zero diagonals, such as in the rows of sticking nodes, are pivots that are delayed
//! to a later front; explicit zeros, with which one front holds the forces of a node and its displacements, save
//! nothing. If pivots need more memory than predicted, the factorisation is repeated with more. Refinement
//! is left to [`RefinedSolver`](stickslip::algebra::linear::RefinedSolver).

use std::sync::Arc;

use stickslip::algebra::linear::{FactorInfo, LinearError, LinearSolver};
use stickslip::algebra::{Csc, Pattern};

use crate::expect_length;
use crate::job::{Job, Own, Remote};
use crate::petsc::{Entries, Int, int};
use crate::ranks;
use crate::system::{By, Setup, info, solve};

/// The options of PETSc for factorisations. No permutation for the first values, which is useless for later ones; no
/// search for vanishing pivots, which does not find the rigid modes of a body without supports.
pub(crate) const OPTIONS: &str = "-factors_ksp_type preonly -factors_pc_type lu \
    -factors_pc_factor_mat_solver_type mumps -factors_mat_mumps_icntl_6 0 -factors_mat_mumps_icntl_24 0";

/// The MUMPS backend, on rank 0: the pattern, and the system on all ranks.
#[derive(Default)]
pub(crate) struct Direct(Option<(Arc<Pattern>, Remote)>);

impl LinearSolver for Direct {
    fn name(&self) -> &'static str {
        "mumps"
    }

    fn analyze(&mut self, pattern: &Arc<Pattern>) -> Result<(), LinearError> {
        let n = pattern.columns();
        expect_length("rows of the matrix", n, pattern.rows())?;
        int(n)?;
        self.0 = None;
        let (ranks, mut rest) = (ranks::start()?.1, Entries::default());
        Csc::zeros(Arc::clone(pattern)).entries().for_each(|(i, j, zero)| rest.push(i as Int, j as Int, zero));
        let rows = (0..=ranks).map(|rank| rank * n / ranks).collect();
        let setup = Setup { options: OPTIONS.to_string(), rows, ..Setup::default() };
        let own = Own { places: (0..n as Int).collect(), rest, ..Own::default() };
        let system = Remote::new(Job::System(setup), own)?;
        self.0 = Some((Arc::clone(pattern), system));
        Ok(())
    }

    fn factorize(&mut self, values: &[f64]) -> Result<FactorInfo, LinearError> {
        let Some((pattern, system)) = &self.0 else { return Err(crate::NOT_ANALYZED) };
        expect_length("values of the matrix", pattern.len(), values.len())?;
        let own = Own { x: [values, &[]], ..Own::default() };
        info(&system.run(Job::Factorize(Some(1.0), By::Factors), own)?)
    }

    fn solve(&mut self, b: &[f64], x: &mut [f64]) -> Result<(), LinearError> {
        let Some((pattern, system)) = &self.0 else { return Err(crate::NOT_FACTORIZED) };
        expect_length("right-hand side", pattern.columns(), b.len())?;
        expect_length("solution", pattern.columns(), x.len())?;
        match solve(system, 0.5, b, x)?.1 {
            0.. => Ok(()),
            reason => Err(LinearError::Backend { backend: "mumps", step: "the solve", status: reason.into() }),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn pattern(entries: &[(usize, usize)], n: usize) -> Arc<Pattern> {
        Arc::new(Pattern::from_entries(n, n, |take| entries.iter().for_each(|&(i, j)| take(i, j))).unwrap())
    }

    /// Creates -u'' on a square of nodes, in which some rows prescribe a displacement: a zero diagonal.
    fn held_square(side: usize) -> (Arc<Pattern>, Vec<f64>) {
        let (nodes, at) = (side * side, |i: usize, j: usize| side * i + j);
        let mut entries = Vec::new();
        for i in 0..side {
            for j in 0..side {
                entries.push((at(i, j), at(i, j), 4.0));
                for (k, l) in [(i + 1, j), (i, j + 1)].into_iter().filter(|&(k, l)| k < side && l < side) {
                    entries.extend([(at(i, j), at(k, l), -1.0), (at(k, l), at(i, j), -1.0)]);
                }
            }
        }
        for j in 0..side {
            entries.extend([(nodes + j, at(side - 1, j), 1.0), (at(side - 1, j), nodes + j, 1.0)]);
            entries.push((nodes + j, nodes + j, 0.0));
        }
        let matrix = Csc::from_triplets(nodes + side, nodes + side, &entries).unwrap();
        (Arc::clone(matrix.pattern()), matrix.values().to_vec())
    }

    fn residual(pattern: &Arc<Pattern>, values: &[f64], x: &[f64], b: &[f64]) -> f64 {
        let product = Csc::new(Arc::clone(pattern), values.to_vec()).unwrap().times(x).unwrap();
        product.iter().zip(b).map(|(p, b)| (p - b).abs()).fold(0.0, f64::max)
    }

    #[test]
    fn factors_and_solves() {
        let pattern = pattern(&[(0, 0), (1, 0), (0, 1), (1, 1)], 2);
        let mut solver = Direct::default();
        solver.analyze(&pattern).unwrap();
        let mut x = [0.0; 2];
        for scale in [1.0, 3.0] {
            // Column-wise [[2, 1], [4, 3]] with right-hand side [4, 10]: x = [1, 2].
            let values = [2.0, 4.0, 1.0, 3.0].map(|v| v * scale);
            let info = solver.factorize(&values).unwrap();
            assert!(info.entries >= 4);
            solver.solve(&[4.0 * scale, 10.0 * scale], &mut x).unwrap();
            assert!((x[0] - 1.0).abs() < 1e-14 && (x[1] - 2.0).abs() < 1e-14, "{x:?}");
        }
    }

    #[test]
    fn every_misuse_has_its_error() {
        let pattern = pattern(&[(0, 0), (1, 1)], 2);
        let mut solver = Direct::default();
        let mut x = [0.0; 2];
        assert_eq!(solver.factorize(&[1.0, 1.0]), Err(LinearError::Order { missing: "analyze" }));
        solver.analyze(&pattern).unwrap();
        assert_eq!(solver.solve(&[1.0, 1.0], &mut x), Err(LinearError::Order { missing: "factorize" }));
        assert!(matches!(solver.factorize(&[1.0]), Err(LinearError::Shape { expected: 2, found: 1, .. })));
        assert!(matches!(solver.factorize(&[1.0, 0.0]), Err(LinearError::Singular { .. })));
        // A failed factorisation leaves no old factors behind, and does not prevent the next one.
        assert_eq!(solver.solve(&[1.0, 1.0], &mut x), Err(LinearError::Order { missing: "factorize" }));
        solver.factorize(&[1.0, 2.0]).unwrap();
        solver.solve(&[1.0, 1.0], &mut x).unwrap();
        assert_eq!(x, [1.0, 0.5]);
        let wide = Arc::new(Pattern::from_entries(1, 2, |take| take(0, 1)).unwrap());
        assert!(matches!(solver.analyze(&wide), Err(LinearError::Shape { .. })));
    }

    #[test]
    fn nothing_is_chosen_by_values() {
        let (pattern, values) = held_square(20);
        let mut solver = Direct::default();
        solver.analyze(&pattern).unwrap();
        let first = solver.factorize(&values).unwrap();
        let b: Vec<f64> = (0..pattern.columns()).map(|i| (i as f64).sin()).collect();
        let mut x = vec![0.0; b.len()];
        solver.solve(&b, &mut x).unwrap();
        assert!(residual(&pattern, &values, &x, &b) < 1e-13);
        // Systems without prescribed displacements have the same analysis.
        let nodes = 400;
        let slots = (0..20).map(|j| (pattern.slot(nodes + j, 380 + j), pattern.slot(nodes + j, nodes + j)));
        let mut open = values.clone();
        for (held, own) in slots {
            (open[held.unwrap()], open[own.unwrap()]) = (0.0, 1.0);
        }
        let later = solver.factorize(&open).unwrap();
        assert!(later.entries as f64 <= 1.05 * first.entries as f64, "{} {}", later.entries, first.entries);
        solver.solve(&b, &mut x).unwrap();
        assert!(residual(&pattern, &open, &x, &b) < 1e-13);
    }

    #[test]
    fn several_at_a_time_are_kept_apart() {
        let (pattern, values) = held_square(8);
        let twice: Vec<f64> = values.iter().map(|v| 2.0 * v).collect();
        let b = vec![1.0; pattern.columns()];
        let mut solvers = [Direct::default(), Direct::default()];
        for (solver, values) in solvers.iter_mut().zip([&values, &twice]) {
            solver.analyze(&pattern).unwrap();
            solver.factorize(values).unwrap();
        }
        std::thread::scope(|scope| {
            for (solver, values) in solvers.iter_mut().zip([&values, &twice]) {
                let (b, pattern) = (&b, &pattern);
                scope.spawn(move || {
                    let mut x = vec![0.0; b.len()];
                    solver.solve(b, &mut x).unwrap();
                    assert!(residual(pattern, values, &x, b) < 1e-13);
                });
            }
        });
    }
}
