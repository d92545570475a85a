//! A stiffness that other processes have, and what becomes of a run if one of them fails.

use crate::common::prelude::*;
use std::sync::atomic::{AtomicUsize, Ordering};

use stickslip::algebra::DoubleDouble;
use stickslip::algebra::linear::{Distributed, Stiffness};
use stickslip::solver::ProblemError;
use stickslip::solver::history::{Error as HistoryError, HistoryMethod};

/// A stiffness of which this process has the whole. It answers as often as `answers` says.
#[derive(Debug)]
struct Elsewhere {
    k: Symmetric,
    diagonal: Vec<f64>,
    row_norms: Vec<f64>,
    both_triangles: Csc,
    answers: AtomicUsize,
}

impl Elsewhere {
    fn new(k: &Symmetric, answers: usize) -> Self {
        let mut row_norms = vec![0.0_f64; k.order()];
        k.entries().for_each(|(i, _, value)| row_norms[i] = row_norms[i].max(value.abs()));
        Elsewhere {
            diagonal: k.diagonal(),
            both_triangles: Csc::from_triplets(k.order(), k.order(), &k.entries().collect::<Vec<_>>()).unwrap(),
            row_norms,
            k: k.clone(),
            answers: AtomicUsize::new(answers),
        }
    }

    fn answer(&self) -> Result<&Symmetric, LinearError> {
        let left = self.answers.fetch_update(Ordering::Relaxed, Ordering::Relaxed, |left| left.checked_sub(1));
        left.map(|_| &self.k).map_err(|_| LinearError::RankFailed)
    }
}

impl Distributed for Elsewhere {
    fn order(&self) -> usize {
        self.k.order()
    }

    fn entries(&self) -> usize {
        self.both_triangles.values().len()
    }

    fn owner(&self, _node: usize) -> Option<usize> {
        Some(0)
    }

    fn diagonal(&self) -> &[f64] {
        &self.diagonal
    }

    fn row_norms(&self) -> &[f64] {
        &self.row_norms
    }

    fn near(&self) -> &Csc {
        &self.both_triangles
    }

    fn mul(&self, x: &[f64], y: &mut [f64]) -> Result<(), LinearError> {
        y.copy_from_slice(&self.answer()?.times(x).unwrap());
        Ok(())
    }

    fn products(&self, x: &[f64], y: &mut [f64], sizes: &mut [f64]) -> Result<(), LinearError> {
        self.mul(x, y)?;
        sizes.fill(0.0);
        self.k.entries().for_each(|(i, j, value)| sizes[i] += (value * x[j]).abs());
        Ok(())
    }

    fn add_beyond(&self, factor: f64, x: &[f64], rest: &[f64], sums: &mut [DoubleDouble]) -> Result<(), LinearError> {
        for (i, j, value) in self.answer()?.entries() {
            sums[i].add_product(factor * value, x[j]);
            sums[i].add(factor * value * rest[j]);
        }
        Ok(())
    }

    fn gathered(&self) -> Result<Symmetric, LinearError> {
        self.answer().cloned()
    }
}

/// Solves a block whose stiffness answers as often as this, or one that is assembled.
fn solved(method: HistoryMethod, answers: Option<usize>) -> Result<HistoryOutcome, HistoryError> {
    let scene = common::block(&["mesh.elements=[4,4]", "time.increments=2"]);
    let model = discretise(&scene).unwrap();
    let parts = model.problem.clone().into_parts();
    let stiffness = match (answers, parts.stiffness.assembled().unwrap()) {
        (Some(answers), k) => Stiffness::Distributed(Arc::new(Elsewhere::new(&k, answers))),
        (None, k) => Stiffness::Assembled(k),
    };
    let problem = match ContactProblem::new(Parts { stiffness, ..parts }) {
        Ok(problem) => problem,
        Err(ProblemError::Linear(error)) => return Err(HistoryError::Linear(error)),
        Err(error) => panic!("{error}"),
    };
    let solver = SolverChoice::new(method);
    let settings = solver.settings(&problem, &model.loading).unwrap();
    solver.solve(&problem, &model.loading, &scene.time.all(), &settings, SystemSolver::default(), &mut ())
}

const METHODS: [HistoryMethod; 3] =
    [HistoryMethod::Increments(Method::BN), HistoryMethod::Increments(Method::Ip), HistoryMethod::ExactPath];

#[test]
fn every_method_solves_with_it() {
    for method in METHODS {
        let [assembled, distributed] = [None, Some(usize::MAX)].map(|answers| solved(method, answers).unwrap());
        assert_eq!((assembled.status, distributed.status), (Status::Converged, Status::Converged));
        let State { u, p_n, .. } = distributed.state;
        for (found, expected) in [(&u, &assembled.state.u), (&p_n, &assembled.state.p_n)] {
            assert!(apart(found, expected) <= 1e-9, "{method:?}");
        }
    }
}

/// Whichever product a process fails in, the run ends with that error, and not with numbers that are none.
#[test]
fn a_failed_process_is_an_error() {
    for method in METHODS {
        let ends = (0..10_000).map(|answers| solved(method, Some(answers)));
        let mut failures = 0;
        for end in ends {
            match end {
                Err(HistoryError::Linear(LinearError::RankFailed)) => failures += 1,
                end => {
                    assert_eq!(end.unwrap().status, Status::Converged, "{method:?} after {failures} answers");
                    break;
                }
            }
        }
        assert!(failures > 10, "{method:?}");
    }
}
