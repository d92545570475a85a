//! Linear solvers of one's own: what is concluded from a matrix does not depend on what its solver says of its pivots, and what is
//! solved badly is no result.

use crate::common::prelude::*;
use stickslip::solver::history::Error;

/// The sparse LU of this build behind a mask.
struct Masked {
    lu: Box<dyn LinearSolver>,
    /// The pivot ratio that it reports.
    pivot_ratio: f64,
    /// The share by which its solutions are too large.
    excess: f64,
    /// A number added to each of its solutions, relative to the largest.
    noise: f64,
}

impl Masked {
    fn boxed(pivot_ratio: f64, excess: f64) -> Box<dyn LinearSolver> {
        Box::new(Masked { lu: SparseLu::default().solver(), pivot_ratio, excess, noise: 0.0 })
    }
}

impl LinearSolver for Masked {
    fn name(&self) -> &'static str {
        "masked"
    }

    fn analyze(&mut self, pattern: &Arc<Pattern>) -> Result<(), LinearError> {
        self.lu.analyze(pattern)
    }

    fn factorize(&mut self, values: &[f64]) -> Result<FactorInfo, LinearError> {
        Ok(FactorInfo { pivot_ratio: self.pivot_ratio, ..self.lu.factorize(values)? })
    }

    fn solve(&mut self, b: &[f64], x: &mut [f64]) -> Result<(), LinearError> {
        self.lu.solve(b, x)?;
        let noise = self.noise * x.iter().fold(0.0_f64, |most, x| most.max(x.abs()));
        for x in x.iter_mut() {
            *x = *x * (1.0 + self.excess) + noise;
        }
        Ok(())
    }
}

/// Three nodes of which the first slides on a plane with friction 0.5. Springs along the tangent join them in a ring and, where
/// `held`, each to the ground; along the normal it stands on a spring of its own, which the tangential ones feel.
fn ring(held: bool) -> ContactProblem {
    let springs = [(0, 1, 1.1), (1, 2, 1.3), (2, 0, 0.7)];
    let mut entries = vec![(3, 3, 2.0)];
    for (i, j, k) in springs {
        entries.extend([(i, i, k), (j, j, k), (i.max(j), i.min(j), -k)]);
    }
    if held {
        entries.extend((0..3).map(|i| (i, i, 0.4)));
        entries.push((3, 0, 0.3));
    }
    let parts = Parts {
        c_t: Csr::from_rows(4, [[(0, 1.0)]]).unwrap(),
        mu: vec![0.5],
        // A free motion is not reported.
        rigid_modes: Some(Vec::new()),
        ..Parts::new(Symmetric::from_triplets(4, &entries).unwrap(), Csr::from_rows(4, [[(3, 1.0)]]).unwrap())
    };
    ContactProblem::new(parts).unwrap()
}

fn critical(problem: &ContactProblem, solver: Box<dyn LinearSolver>) -> Result<CriticalFriction, Error> {
    let increment = Increment { force: &[0.0; 4], gap: &[0.0], mu: problem.mu(), w_t_last: &[-1.0], w_o_last: &[0.0] };
    let state = State { p_t: vec![0.5], p_n: vec![1.0], ..State::zero(problem) };
    let mut linear = RefinedSolver::new(solver);
    Ok(critical_friction(problem, &increment, &state, Scaling::SI, &mut linear)?.unwrap())
}

/// Also where the zero of a singular matrix hides in rounding.
#[test]
fn the_critical_friction_does_not_depend_on_what_a_solver_says_of_its_pivots() {
    for held in [true, false] {
        let problem = ring(held);
        let expected = critical(&problem, SparseLu::default().solver()).unwrap();
        assert_eq!(expected.factor > 0.0, held, "{expected:?}");
        for pivot_ratio in [0.0, 1e-300, 1.0, f64::NAN] {
            let found = critical(&problem, Masked::boxed(pivot_ratio, 0.0)).unwrap();
            assert_eq!(found, expected, "held {held}, {pivot_ratio}");
        }
    }
}

#[test]
fn the_backends_agree_on_what_is_singular() {
    for held in [true, false] {
        let problem = ring(held);
        let found: Vec<CriticalFriction> = [SparseLu::Umfpack, SparseLu::Mumps, SparseLu::Faer, SparseLu::Partial]
            .into_iter()
            .filter(|lu| lu.is_built_in())
            .map(|lu| critical(&problem, lu.solver()).unwrap())
            .collect();
        assert!(
            found.iter().all(|critical| (critical.factor - found[0].factor).abs() <= 1e-12 * found[0].factor),
            "{found:?}"
        );
    }
}

/// Refinement takes four times two thirds off the error: what is left is far above rounding.
#[test]
fn a_critical_friction_of_bad_solves_is_an_error() {
    let problem = ring(true);
    let exact = critical(&problem, SparseLu::default().solver()).unwrap();
    assert!((critical(&problem, Masked::boxed(1.0, 1e-4)).unwrap().factor / exact.factor - 1.0).abs() < 1e-12);
    let found = critical(&problem, Masked::boxed(1.0, 1.0 / 3.0));
    assert!(matches!(found, Err(Error::Linear(LinearError::Inaccurate { .. }))), "{found:?}, not {exact:?}");
}

/// A solver that says nothing of its pivots is no reason to give up the exact path.
#[test]
fn events_are_followed_by_any_solver() {
    let model = discretise(&common::block(&["mesh.elements=[6,6]", "time.increments=5"])).unwrap();
    let settings = settings_of(&model, Method::BN);
    let times = [0.5, 1.0];
    let run = |system: SystemSolver| {
        let mut keep = Keep::default();
        let outcome =
            history::follow_exact_path(&model.problem, &model.loading, &times, &settings, system, &mut keep).unwrap();
        (outcome.status, keep.states)
    };
    let expected = run(SystemSolver::from(SparseLu::default().solver()));
    assert_eq!(expected.0, Status::Converged);
    for pivot_ratio in [0.0, 1.0] {
        let found = run(SystemSolver::from(Masked::boxed(pivot_ratio, 0.0)));
        assert_eq!(found.0, Status::Converged, "{pivot_ratio}");
        assert!(difference(&found.1, &expected.1) <= 1e-12);
    }
}

/// An iterative solver leaves forces far below rounding where there is no contact.
#[test]
fn open_nodes_have_no_forces() {
    let model = discretise(&common::block(&["mesh.elements=[10,10]", "time.increments=5"])).unwrap();
    let settings = settings_of(&model, Method::BN);
    let (times, mut keep) = ([0.5, 1.0, 1.5, 2.0], Keep::default());
    let noisy = Masked { lu: SparseLu::default().solver(), pivot_ratio: 1.0, excess: 0.0, noise: 1e-22 };
    let system = SystemSolver::from(Box::new(noisy) as Box<dyn LinearSolver>);
    let outcome = history::run(&model.problem, &model.loading, &times, &settings, system, &mut keep).unwrap();
    assert_eq!(outcome.status, Status::Converged);
    let forces: Vec<f64> = keep.states.iter().flat_map(|state| [&state.p_n, &state.p_t]).flatten().copied().collect();
    let largest = forces.iter().fold(0.0_f64, |most, p| most.max(p.abs()));
    let (none, left) =
        (forces.iter().filter(|p| **p == 0.0).count(), forces.iter().filter(|p| p.abs() < 1e-14 * largest).count());
    assert!(none > 0 && none == left, "{none} of {left}");
}
