//! MUMPS, a multifrontal LU on all MPI processes, with settings for the uncondensed contact Jacobian.
//!
//! The values change while the analysis is kept. Therefore the analysis must not depend on values, and receives none:
//! there is no permutation for large diagonals. Zero diagonals, such as in the rows of sticking nodes, are pivots
//! that are delayed to a later front. If they need more memory than predicted, the factorisation is repeated with
//! more. Refinement is left to [`RefinedSolver`](stickslip::algebra::linear::RefinedSolver).

mod instance;
mod order;
mod sys;

use std::ffi::c_int;
use std::sync::Arc;

use super::ranks::{Kind, Shared};
use crate::expect_length;
pub(super) use instance::Instance;
use instance::Job;
use stickslip::algebra::Pattern;
use stickslip::algebra::linear::{FactorInfo, LinearError, LinearSolver};

/// The settings of MUMPS, by the numbers of its ICNTL.
const SETTINGS: [(usize, c_int); 8] = [
    // No permutation of columns: one for the first values is useless for later ones.
    (6, 0),
    // The order is given.
    (7, 1),
    // Scaling is computed in each factorisation.
    (8, 77),
    // No refinement, no analysis of errors.
    (10, 0),
    (11, 0),
    // The matrix comes from rank 0.
    (18, 0),
    // A vanishing pivot is an error. MUMPS's detection of null pivots does not find the rigid modes of a body without
    // supports.
    (24, 0),
    // The analysis is done on rank 0.
    (28, 1),
];

/// The index of the setting for the memory of the factors beyond the prediction, in per cent.
const ROOM: usize = 14;
/// The initial value of this setting.
const FIRST_ROOM: c_int = 30;
/// The number of attempts with more memory.
const TRIES: usize = 7;

/// The MUMPS backend, on rank 0.
#[derive(Default)]
pub struct Mumps {
    pattern: Option<Arc<Pattern>>,
    /// The rows and columns of the entries, from 1.
    places: [Vec<c_int>; 2],
    shared: Option<Shared<Instance>>,
    is_factored: bool,
    /// The number of times that more memory was needed.
    retries: usize,
}

/// The pattern, the places of the entries, and the instance.
type Analyzed<'a> = (&'a Pattern, &'a mut [Vec<c_int>; 2], &'a mut Shared<Instance>);

impl Mumps {
    /// Returns the instance and its data, if there is an analysis.
    fn analyzed(&mut self) -> Result<Analyzed<'_>, LinearError> {
        match (&self.pattern, &mut self.shared) {
            (Some(pattern), Some(shared)) => Ok((pattern, &mut self.places, shared)),
            _ => Err(LinearError::Order { missing: "analyze" }),
        }
    }

    /// Factors with the present memory setting.
    fn try_to_factorize(&mut self, values: &[f64]) -> Result<&mut Instance, LinearError> {
        let (_, [rows, columns], shared) = self.analyzed()?;
        shared.run(Job::Factorize as i64, |_, instance| {
            instance.factorize(rows, columns, values);
            Ok(())
        })?;
        Ok(shared.part())
    }
}

impl LinearSolver for Mumps {
    fn name(&self) -> &'static str {
        "mumps"
    }

    fn analyze(&mut self, pattern: &Arc<Pattern>) -> Result<(), LinearError> {
        const STEP: &str = "the symbolic analysis";
        let n = pattern.columns();
        expect_length("rows of the matrix", n, pattern.rows())?;
        // The indices have 32 bits; the number of entries may be larger.
        c_int::try_from(n).map_err(|_| LinearError::OutOfMemory { step: STEP })?;
        *self = Mumps::default();
        let mut order = order::places(pattern)?;
        let rows = pattern.row_indices().iter().map(|&row| row as c_int + 1).collect();
        let columns =
            (0..n).flat_map(|j| std::iter::repeat_n(j as c_int + 1, order::column(pattern, j).len())).collect();
        self.places = [rows, columns];
        let mut shared = Shared::new(Kind::Mumps, |world| Ok(Instance::new(world)))?;
        shared.part().check("its start")?;
        for (k, value) in SETTINGS.into_iter().chain([(ROOM, FIRST_ROOM)]) {
            shared.part().set(k, value);
        }
        let [rows, columns] = &mut self.places;
        shared.run(Job::Analyze as i64, |_, instance| {
            instance.analyze(rows, columns, &mut order);
            Ok(())
        })?;
        shared.part().check(STEP)?;
        self.shared = Some(shared);
        self.pattern = Some(Arc::clone(pattern));
        Ok(())
    }

    fn factorize(&mut self, values: &[f64]) -> Result<FactorInfo, LinearError> {
        let (pattern, ..) = self.analyzed()?;
        expect_length("values of the matrix", pattern.len(), values.len())?;
        self.is_factored = false;
        for _ in 1..TRIES {
            let instance = self.try_to_factorize(values)?;
            if !instance.lacks_room() {
                break;
            }
            let room = instance.setting(ROOM);
            instance.set(ROOM, 2 * room.max(0) + 20);
            self.retries += 1;
        }
        let (_, _, shared) = self.analyzed()?;
        let instance = shared.part();
        instance.check("the factorisation")?;
        let info = FactorInfo {
            entries: instance.counted(29),
            flops: instance.measured(3),
            pivot_ratio: instance.pivot_ratio(),
            peak_bytes: 1e6 * f64::from(instance.told(22)),
        };
        self.is_factored = true;
        Ok(info)
    }

    fn solve(&mut self, b: &[f64], x: &mut [f64]) -> Result<(), LinearError> {
        if !self.is_factored {
            return Err(LinearError::Order { missing: "factorize" });
        }
        let (pattern, _, shared) = self.analyzed()?;
        let n = pattern.columns();
        expect_length("right-hand side", n, b.len())?;
        expect_length("solution", n, x.len())?;
        x.copy_from_slice(b);
        shared.run(Job::Solve as i64, |_, instance| {
            instance.solve(x);
            Ok(())
        })?;
        shared.part().check("the solve")
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
        let matrix = stickslip::algebra::Csc::from_triplets(nodes + side, nodes + side, &entries).unwrap();
        (Arc::clone(matrix.pattern()), matrix.values().to_vec())
    }

    fn residual(pattern: &Arc<Pattern>, values: &[f64], x: &[f64], b: &[f64]) -> f64 {
        let product = stickslip::algebra::Csc::new(Arc::clone(pattern), values.to_vec()).unwrap().times(x).unwrap();
        product.iter().zip(b).map(|(p, b)| (p - b).abs()).fold(0.0, f64::max)
    }

    #[test]
    fn factors_and_solves() {
        let pattern = pattern(&[(0, 0), (1, 0), (0, 1), (1, 1)], 2);
        let mut solver = Mumps::default();
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
        let mut solver = Mumps::default();
        let mut x = [0.0; 2];
        assert_eq!(solver.factorize(&[1.0, 1.0]), Err(LinearError::Order { missing: "analyze" }));
        solver.analyze(&pattern).unwrap();
        assert_eq!(solver.solve(&[1.0, 1.0], &mut x), Err(LinearError::Order { missing: "factorize" }));
        assert!(matches!(solver.factorize(&[1.0]), Err(LinearError::Shape { expected: 2, found: 1, .. })));
        assert!(matches!(solver.factorize(&[1.0, 0.0]), Err(LinearError::Singular { .. })));
        // A failed factorisation leaves no old factors behind.
        assert_eq!(solver.solve(&[1.0, 1.0], &mut x), Err(LinearError::Order { missing: "factorize" }));
        let wide = Arc::new(Pattern::from_entries(1, 2, |take| take(0, 1)).unwrap());
        assert!(matches!(solver.analyze(&wide), Err(LinearError::Shape { .. })));
    }

    #[test]
    fn nothing_is_chosen_by_values_and_the_order_is_ours() {
        let (pattern, values) = held_square(20);
        let mut solver = Mumps::default();
        solver.analyze(&pattern).unwrap();
        let first = solver.factorize(&values).unwrap();
        let instance = solver.shared.as_mut().unwrap().part();
        // INFOG(7): the order that was used; INFOG(23): the permutation for large diagonals.
        assert_eq!((instance.told(7), instance.told(23)), (1, 0));
        let b: Vec<f64> = (0..pattern.columns()).map(|i| (i as f64).sin()).collect();
        let mut x = vec![0.0; b.len()];
        solver.solve(&b, &mut x).unwrap();
        assert!(residual(&pattern, &values, &x, &b) < 1e-13);
        // With no prescribed displacements the same analysis is used.
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
    fn what_lacks_room_is_done_once_more() {
        let (pattern, values) = held_square(30);
        let mut solver = Mumps::default();
        solver.analyze(&pattern).unwrap();
        solver.factorize(&values).unwrap();
        assert_eq!(solver.retries, 0);
        solver.shared.as_mut().unwrap().part().set(ROOM, -60);
        solver.factorize(&values).unwrap();
        assert_eq!(solver.retries, 1);
    }

    #[test]
    fn memory_that_is_refused_is_an_error() {
        let (pattern, values) = held_square(100);
        let mut solver = Mumps::default();
        solver.analyze(&pattern).unwrap();
        // The memory limit of each rank, MB, instead of that of the system.
        solver.shared.as_mut().unwrap().part().set(23, 1);
        assert!(matches!(solver.factorize(&values), Err(LinearError::OutOfMemory { .. })));
        let mut x = vec![0.0; pattern.columns()];
        let b = x.clone();
        assert_eq!(solver.solve(&b, &mut x), Err(LinearError::Order { missing: "factorize" }));
    }

    #[test]
    fn several_at_a_time_are_kept_apart() {
        let (pattern, values) = held_square(8);
        let twice: Vec<f64> = values.iter().map(|v| 2.0 * v).collect();
        let b = vec![1.0; pattern.columns()];
        let mut solvers = [Mumps::default(), Mumps::default()];
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
