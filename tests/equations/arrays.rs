//! Arrays that do not fit, numbers that are none: each is refused by an error that names the array.

use crate::common::prelude::*;
use stickslip::algebra::MatrixError;
use stickslip::solver::{FrictionHistory, GapCorrection, LinearSystem, rigid_equilibrium};

/// A node on two springs, pressed on a floor and pushed along it.
fn parts() -> Parts {
    let stiffness = Symmetric::from_triplets(2, &[(0, 0, 2.0), (1, 0, 0.5), (1, 1, 2.0)]).unwrap();
    let c_n = Csr::from_rows(2, [[(1, 1.0)]]).unwrap();
    let c_t = Csr::from_rows(2, [[(0, 1.0)]]).unwrap();
    Parts { c_t, mu: vec![0.3], weight: Some(vec![1.0]), ..Parts::new(stiffness, c_n) }
}

fn problem() -> ContactProblem {
    ContactProblem::new(parts()).unwrap()
}

fn loading(force: Vec<f64>, gap: Vec<f64>) -> Loading {
    Loading::new(vec![LoadCase::new(force, vec![[0.0, 0.0], [1.0, 1.0]]).unwrap()], gap).unwrap()
}

fn run(loading: &Loading, times: &[f64], change: impl FnOnce(&mut HistorySettings)) -> Result<Status, history::Error> {
    let mut settings = HistorySettings::new(&problem(), &self::loading(vec![1.0; 2], vec![0.0]), Method::BN).unwrap();
    change(&mut settings);
    history::run(&problem(), loading, times, &settings, SystemSolver::default(), &mut ()).map(|outcome| outcome.status)
}

/// Every way to hand in nonsense, with what its error says.
#[test]
#[allow(clippy::too_many_lines)] // A list.
fn every_error_names_its_array() {
    fn message<T, E: ToString>(result: Result<T, E>) -> Result<(), String> {
        result.map(|_| ()).map_err(|error| error.to_string())
    }
    const NAN: f64 = f64::NAN;
    const ONE: [(usize, f64); 1] = [(1, 1.0)];
    let made = |change: &dyn Fn(&mut Parts)| {
        let mut parts = parts();
        change(&mut parts);
        message(ContactProblem::new(parts))
    };
    let matrix = |result: Result<Csc, MatrixError>| message(result);
    let symmetric = |entries: &[(usize, usize, f64)]| message(Symmetric::from_triplets(2, entries));
    let rows = |columns: usize, row: [(usize, f64); 1]| Csr::from_rows(columns, [row]);
    let good = loading(vec![1.0, 1.0], vec![0.0]);
    let ran = |loading: &Loading, times: &[f64]| message(run(loading, times, |_| ()));
    let with_friction = |mu: f64| {
        let history = FrictionHistory::new(1, vec![(vec![mu], vec![[0.0, 0.5], [1.0, 1.0]])]).unwrap();
        good.clone().with_friction(Some(history)).unwrap()
    };
    let set = |change: &dyn Fn(&mut HistorySettings)| message(run(&good, &[1.0], change));
    let case = |force: Vec<f64>, history: Vec<[f64; 2]>| message(LoadCase::new(force, history));
    let (problem, state) = (problem(), State::zero(&problem()));
    let judged = |force: &[f64], gap: &[f64], w_t_last: &[f64], state: &State| {
        let increment = Increment { force, gap, mu: problem.mu(), w_t_last, w_o_last: &[0.0] };
        let scales = KktScales::default();
        let measured = message(KktErrors::measure(&problem, &increment, state, &scales));
        let found = message(statuses(&problem, &increment, state));
        assert_eq!(measured, found);
        let critical = critical_friction(&problem, &increment, state, Scaling::SI, &mut RefinedSolver::default());
        assert_eq!(message(critical), measured);
        measured
    };
    let longer = |change: &dyn Fn(&mut State)| {
        let mut state = state.clone();
        change(&mut state);
        state
    };
    let motion = |nodes, gap: Vec<f64>, drift: Vec<[f64; 2]>, history: Vec<[f64; 2]>| {
        message(Motion::new(nodes, gap, drift, history))
    };
    // Each block of two is definite.
    let three = [(0, 0, 1.0), (1, 1, 1.0), (2, 2, 1.0), (1, 0, 0.9), (2, 0, -0.9), (2, 1, 0.9)];
    let stiffness = Symmetric::from_triplets(3, &three).unwrap();
    let indefinite = Parts::new(stiffness, Csr::from_rows(3, [ONE]).unwrap());
    let previous = |far: f64| Method::paper_ip(Start::Prev { shortest_step: 0.01, far, patience: 30 });
    let spring = Symmetric::from_triplets(1, &[(0, 0, 2.0)]).unwrap();
    let other = ContactProblem::new(Parts::new(spring, Csr::from_rows(1, [[(0, 1.0)]]).unwrap())).unwrap();
    let still = || vec![[0.0, 0.0], [1.0, 1.0]];
    let cases: Vec<(Result<(), String>, &str)> = vec![
        // Matrices (R2, N6).
        (matrix(Csc::from_triplets(2, 2, &[(2, 0, 1.0)])), "row 2 of a matrix with 2 rows"),
        (matrix(Csc::from_triplets(2, 2, &[(0, 3, 1.0)])), "column 3 of a matrix with 2 columns"),
        (matrix(Csc::from_triplets(2, 2, &[(0, 1, NAN)])), "(0, 1) is NaN"),
        (matrix(Csc::from_parts(2, &[0, 2, 1], &[0, 1], &[1.0, 1.0])), "start 2 is 1"),
        (matrix(Csc::from_parts(2, &[1, 2], &[0, 1], &[1.0, 1.0])), "start 0 is 1"),
        (matrix(Csc::from_parts(2, &[0, 1, 2], &[0, 2], &[1.0, 1.0])), "row 2"),
        (matrix(Csc::from_parts(2, &[0, 1, 3], &[0, 1], &[1.0, 1.0])), "row indices: expected 3 entries, got 2"),
        (matrix(Csc::from_parts(2, &[0, 1, 2], &[0, 1], &[1.0])), "values of the matrix: expected 2 entries, got 1"),
        (symmetric(&[(0, 1, 1.0), (1, 0, 2.0)]), "not symmetric: (1, 0) is 2e0 and (0, 1) is 1e0"),
        (symmetric(&[(0, 2, 1.0)]), "column 2"),
        (message(rows(2, [(2, 1.0)])), "column 2 of a matrix with 2 columns"),
        (message(rows(2, [(1, f64::INFINITY)])), "(0, 1) is inf"),
        // Problems (N4, N5).
        (made(&|p| p.c_n = Csr::from_rows(2, [ONE, ONE]).unwrap()), "c_t has 1 rows, but must have 2"),
        (made(&|p| p.c_t = rows(3, ONE).unwrap()), "c_t has 3 columns, but must have 2"),
        (made(&|p| p.c_o = Csr::empty(2, 2).unwrap()), "c_o has 2 rows, but must have 1"),
        (made(&|p| p.mu = vec![0.3; 2]), "mu has 2 entries, but must have 1"),
        (made(&|p| p.mu = vec![-1.0]), "mu[0] is -1, but must be 0 or more"),
        (made(&|p| p.mu = vec![NAN]), "mu[0] is NaN"),
        (made(&|p| p.weight = Some(vec![])), "weight has 0 entries, but must have 1"),
        (made(&|p| p.weight = Some(vec![NAN])), "weight[0] is NaN, but must be above 0"),
        (made(&|p| p.weight = Some(vec![0.0])), "weight[0] is 0"),
        (made(&|p| common::scale(&mut p.stiffness, -1.0)), "stiffness is not positive semidefinite"),
        (made(&|p| common::scale(&mut p.stiffness, NAN)), "stiffness(0, 0) is NaN"),
        (
            made(&|p| {
                p.stiffness = Symmetric::from_triplets(2, &[(0, 0, 1.0), (1, 0, 2.0), (1, 1, 1.0)]).unwrap().into();
            }),
            "(1, 0) = 2e0",
        ),
        (made(&|p| *p = indefinite.clone()), "takes energy out of it"),
        (made(&|p| p.stiffness = Symmetric::from_triplets(0, &[]).unwrap().into()), "order 0"),
        (made(&|p| p.rigid_modes = Some(vec![vec![1.0]])), "rigid_modes[0] has 1 entries, but must have 2"),
        (made(&|p| p.rigid_modes = Some(vec![vec![NAN, 1.0]])), "rigid_modes[0][0] is NaN"),
        (made(&|p| p.rigid_modes = Some(vec![vec![1.0, 0.0]])), "rigid_modes[0] is no rigid mode"),
        (made(&|p| p.rigid_modes = Some(vec![vec![0.0, 0.0]])), "rigid_modes[0] is zero or a combination"),
        // Loads, times, settings (N3).
        (case(vec![NAN], still()), "force[0] is NaN"),
        (case(vec![1.0], vec![[1.0, 1.0], [0.0, 0.0]]), "history[1] goes from 1 to 0"),
        (case(vec![1.0], vec![[0.0, f64::INFINITY]]), "history[0][1] is inf"),
        (message(Loading::new(Vec::new(), vec![NAN])), "gap[0] is NaN"),
        (motion(0..2, vec![1.0], vec![[0.0; 2]; 2], still()), "gap has 1 entries, but must have 2"),
        (motion(0..1, vec![1.0], Vec::new(), still()), "drift has 0 entries, but must have 1"),
        (motion(0..1, vec![1.0], vec![[0.0, NAN]], still()), "drift[0][1] is NaN"),
        (message(GapCorrection::new(0..1, vec![0.0, 0.0], vec![vec![0.0]; 2])), "times[1]"),
        (message(GapCorrection::new(0..1, vec![0.0], vec![vec![]])), "gap[0] has 0 entries"),
        (
            message(
                good.clone().with_motions(
                    vec![Motion::new(0..3, vec![0.0; 3], vec![[0.0; 2]; 3], still()).unwrap()],
                    Vec::new(),
                ),
            ),
            "nodes of a motion has 3 entries, but must have 1",
        ),
        (ran(&loading(vec![1.0], vec![0.0]), &[1.0]), "force of a load has 1 entries, but must have 2"),
        (ran(&loading(vec![1.0, 1.0, 5.0], vec![0.0]), &[1.0]), "force of a load has 3 entries, but must have 2"),
        (ran(&loading(vec![1.0, 1.0], vec![]), &[1.0]), "gap has 0 entries, but must have 1"),
        (ran(&good, &[]), "times is empty"),
        (ran(&good, &[NAN]), "times[0] is NaN"),
        (ran(&good, &[1.0, 0.5]), "times[1] goes from 1 to 0.5, but must increase"),
        (set(&|s| s.working_set = Some(vec![0, 0])), "working_set[1] goes from 0 to 0, but must increase"),
        (ran(&with_friction(0.0), &[1.0]), "mu[0] of the history of friction is 0, but must be positive where"),
        (set(&|s| s.tolerance = 0.0), "tolerance is 0, but must be above 0"),
        (set(&|s| s.max_iterations = 0), "max_iterations is 0"),
        (ran(&good, &[-1.0, 1.0]), "times[0] is -1, but must be 0 or more"),
        (set(&|s| s.halvings = 53), "halvings is 53, but must be at most 52"),
        (set(&|s| s.conventions.r_n[0] = NAN), "r_n[0] is NaN, but must be finite and above 0"),
        (set(&|s| s.conventions.r_t[0] = -1.0), "r_t[0] is -1"),
        (set(&|s| s.conventions.row_unit[0] = 0.0), "row_unit[0] is 0"),
        (set(&|s| s.contact_stiffness[0] = f64::INFINITY), "contact_stiffness[0] is inf"),
        (set(&|s| s.scaling.force = 0.0), "scaling.force is 0"),
        (set(&|s| s.scaling.length = NAN), "scaling.length is NaN"),
        (set(&|s| s.method = previous(NAN)), "start.far is NaN"),
        (message(good.force_at(1.0, &other)), "force of a load has 2 entries"),
        (set(&|s| s.conventions.r_n.clear()), "r_n has 0 entries, but must have 1"),
        (set(&|s| s.contact_stiffness.push(1.0)), "contact_stiffness has 2 entries, but must have 1"),
        // The judge.
        (judged(&[1.0], &[0.0], &[0.0], &state), "force has 1 entries, but must have 2"),
        (judged(&[1.0, NAN], &[0.0], &[0.0], &state), "force[1] is NaN"),
        (judged(&[1.0; 2], &[], &[0.0], &state), "gap has 0 entries, but must have 1"),
        (judged(&[1.0; 2], &[0.0], &[0.0; 2], &state), "w_t_last has 2 entries, but must have 1"),
        (judged(&[1.0; 2], &[0.0], &[0.0], &longer(&|s| s.u.push(0.0))), "u has 3 entries, but must have 2"),
        (judged(&[1.0; 2], &[0.0], &[0.0], &longer(&|s| s.p_n.clear())), "p_n has 0 entries, but must have 1"),
        (judged(&[1.0; 2], &[0.0], &[0.0], &longer(&|s| s.u_rest.push(0.0))), "u_rest has 1 entries, but must have 2"),
    ];
    assert!(cases.len() >= 40);
    for (result, expected) in cases {
        let error = result.expect_err(expected);
        assert!(error.contains(expected), "`{error}` does not say `{expected}`");
    }
}

/// The constants of the paper are stresses: only they ask for the weights of the contact nodes.
#[test]
fn weights_are_asked_for_where_they_are_used() {
    let problem = ContactProblem::new(Parts { weight: None, ..parts() }).unwrap();
    let loading = loading(vec![0.1, 1.0], vec![0.0]);
    for method in [Method::BN, Method::Ip] {
        let settings = HistorySettings::new(&problem, &loading, method).unwrap();
        let outcome = history::run(&problem, &loading, &[1.0], &settings, SystemSolver::default(), &mut ()).unwrap();
        assert_eq!(outcome.status, Status::Converged);
    }
    for method in [Method::PaperBn, Method::paper_ip(Start::Safe)] {
        let refused = HistorySettings::new(&problem, &loading, method).unwrap_err();
        assert!(refused.to_string().contains("weight"), "{refused}");
    }
}

/// A loose node, found to be free by its stiffness, is pressed on a floor.
#[test]
fn free_motions_are_found_where_they_are_not_given() {
    let stiffness = Symmetric::from_triplets(2, &[(0, 0, 2.0)]).unwrap();
    let problem = ContactProblem::new(Parts { stiffness: stiffness.into(), ..parts() }).unwrap();
    let [motion] = problem.rigid_modes() else { panic!("{:?}", problem.rigid_modes()) };
    assert!(motion[0].abs() < 1e-15 && (motion[1] - 1.0).abs() < 1e-15, "{motion:?}");
    let loading = loading(vec![0.1, 1.0], vec![0.0]);
    let settings = HistorySettings::new(&problem, &loading, Method::BN).unwrap();
    let outcome = history::run(&problem, &loading, &[1.0], &settings, SystemSolver::default(), &mut ()).unwrap();
    assert_eq!(outcome.status, Status::Converged);
    assert!((outcome.state.p_n[0] - 1.0).abs() < 1e-12);
}

/// An observer sees the linear system of every step: the matrix, the right-hand side and the direction fit.
#[test]
fn an_observer_sees_the_linear_systems() {
    #[derive(Default)]
    struct Watch {
        systems: usize,
        iterations: usize,
    }
    impl Observer for Watch {
        fn linear_system(&mut self, _index: usize, system: &LinearSystem<'_>) -> ControlFlow<()> {
            self.systems += 1;
            let product = system.matrix.times(system.solution).unwrap();
            // Row by row against the sizes of its entries and of the solution.
            let size = largest(system.solution);
            let mut sizes: Vec<f64> = system.rhs.iter().map(|b| b.abs()).collect();
            system.matrix.to_csc().unwrap().entries().for_each(|(i, _, a)| sizes[i] += a.abs() * size);
            let rows = product.iter().zip(system.rhs).zip(sizes);
            let fits = rows.into_iter().all(|((a, b), size)| (a - b).abs() <= 1e-12 * size);
            assert!(fits, "{product:?} {:?} {:?}", system.rhs, system.solution);
            assert_eq!(system.layout.unknowns(), 4);
            ControlFlow::Continue(())
        }

        fn increment(&mut self, step: &IncrementView<'_>) -> ControlFlow<()> {
            self.iterations += step.record.iterations;
            ControlFlow::Continue(())
        }
    }
    let loading = loading(vec![1.0, 1.0], vec![0.0]);
    for method in [Method::BN, Method::PaperBn, Method::Ip] {
        let settings = HistorySettings::new(&problem(), &loading, method).unwrap();
        let mut watch = Watch::default();
        history::run(&problem(), &loading, &[0.5, 1.0], &settings, SystemSolver::default(), &mut watch).unwrap();
        assert!(watch.systems > 0 && watch.systems <= watch.iterations, "{method}");
    }
}

/// The least load that there is: whatever fails on the way, no solver is asked for factors that it does not have.
#[test]
fn a_load_below_all_that_is_normal() {
    let loading = loading(vec![5e-324, 5e-324], vec![0.0]);
    for method in [Method::BN, Method::Ip, Method::PaperBn] {
        let settings = HistorySettings::new(&problem(), &loading, method).unwrap();
        for linear in both() {
            let outcome = history::run(&problem(), &loading, &[0.5, 1.0], &settings, linear.into(), &mut ());
            assert!(outcome.is_ok(), "{method} {linear}: {outcome:?}");
        }
    }
}

/// A body without any stiffness, friction without end: whatever the verdict, it is one, and an honest one (R1).
#[test]
fn an_interior_point_method_that_fails_at_its_first_step() {
    let loading = loading(vec![0.1, 1.0], vec![0.0]);
    let none = Symmetric::from_entries(2, |take| (0..2).for_each(|i| take(i, i))).unwrap();
    for parts in [Parts { stiffness: none.into(), ..parts() }, Parts { mu: vec![1e160], ..parts() }] {
        let problem = ContactProblem::new(parts).unwrap();
        for method in [Method::BN, Method::Ip, Method::PaperBn, Method::paper_ip(Start::Safe)] {
            let settings = HistorySettings::new(&problem, &loading, method).unwrap();
            let outcome =
                history::run(&problem, &loading, &[1.0], &settings, SystemSolver::default(), &mut ()).unwrap();
            let are_solved = outcome.records.iter().all(|record| record.kkt.worst().1 <= settings.tolerance);
            assert_eq!(outcome.status == Status::Converged, are_solved && !outcome.records.is_empty(), "{method}");
        }
    }
}

/// What an error is compared with is a size, and a state has a status where it is one of numbers.
#[test]
fn nothing_is_judged_against_no_size() {
    let (problem, state) = (problem(), State::zero(&problem()));
    let increment = Increment { force: &[1.0; 2], gap: &[0.0], mu: problem.mu(), w_t_last: &[0.0], w_o_last: &[0.0] };
    for (terms, array) in
        [([f64::INFINITY, 1.0], "scales[0]"), ([1.0, -1.0], "scales[1]"), ([f64::NAN, 1.0], "scales[0]")]
    {
        let refused = KktScales::new(&terms).unwrap_err().to_string();
        assert!(refused.contains(array), "{refused}");
    }
    assert!(KktScales::new(&[1.0; 3]).unwrap_err().to_string().contains("scales has 3 entries, but must have 2"));
    let other = KktScales::new(&[1.0; 4]).unwrap();
    let refused = KktErrors::measure(&problem, &increment, &state, &other).unwrap_err().to_string();
    assert!(refused.contains("scales has 4 entries, but must have 2"), "{refused}");
    let scales = KktScales::new(&[1.0; 2]).unwrap();
    let lost = State { u: vec![f64::NAN; 2], ..state };
    assert!(KktErrors::measure(&problem, &increment, &lost, &scales).unwrap().worst().1.is_nan());
    assert!(statuses(&problem, &increment, &lost).unwrap_err().to_string().contains("u[0] is NaN"));
}

/// The constants of the paper ask for weights, however they got into the settings.
#[test]
fn a_method_changed_afterwards_is_checked() {
    let problem = ContactProblem::new(Parts { weight: None, ..parts() }).unwrap();
    let loading = loading(vec![0.1, 1.0], vec![0.0]);
    let settings =
        HistorySettings { method: Method::PaperBn, ..HistorySettings::new(&problem, &loading, Method::BN).unwrap() };
    let error = history::run(&problem, &loading, &[1.0], &settings, SystemSolver::default(), &mut ()).unwrap_err();
    assert!(error.to_string().contains("weight"), "{error}");
}

/// Finite rates and finite distances may be too much together, and a range may be none.
#[test]
fn obstacles_stay_where_numbers_reach() {
    let moved = |nodes: std::ops::Range<usize>, distance: f64| {
        let each = nodes.len();
        let history = vec![[0.0, 0.0], [1.0, distance]];
        let motion = Motion::new(nodes, vec![1e300; each], vec![[0.0, 0.0]; each], history).unwrap();
        loading(vec![1.0, 1.0], vec![0.0]).with_motions(vec![motion], Vec::new()).map(|_| ()).map_err(|e| e.to_string())
    };
    assert_eq!(moved(0..1, 1.0), Ok(()));
    assert!(moved(0..1, 1e300).unwrap_err().contains("gap[0]"));
    #[allow(clippy::reversed_empty_ranges)]
    let reversed = moved(1..0, 1.0);
    assert!(reversed.unwrap_err().contains("nodes of a motion"));
}

/// A body that slides freely along x: what fits is judged, and nothing else.
#[test]
fn a_load_that_does_not_fit_is_in_no_balance() {
    let stiffness = Symmetric::from_triplets(2, &[(1, 1, 1.0)]).unwrap();
    let problem = ContactProblem::new(Parts::new(stiffness, Csr::from_rows(2, [[(1, 1.0)]]).unwrap())).unwrap();
    assert_eq!(rigid_equilibrium(&problem, &[0.0, 1.0]), Ok(None));
    assert!(rigid_equilibrium(&problem, &[1.0, 0.0]).unwrap().is_some());
    for force in [&[][..], &[0.0], &[0.0; 9], &[f64::NAN, 0.0], &[f64::INFINITY, 0.0]] {
        let error = rigid_equilibrium(&problem, force).unwrap_err().to_string();
        assert!(error.contains("force"), "{error}");
    }
}

/// Between neighbouring numbers there is no time in which a failed increment could be halved.
#[test]
fn increments_without_a_middle_end() {
    let stiffness = Symmetric::from_triplets(2, &[(1, 1, 1.0)]).unwrap();
    let c_n = Csr::from_rows(2, [[(1, -1.0)]]).unwrap();
    let c_t = Csr::from_rows(2, [[(0, 1.0)]]).unwrap();
    let problem = ContactProblem::new(Parts { c_t, mu: vec![0.3], ..Parts::new(stiffness, c_n) }).unwrap();
    for next in [1.0_f64.next_up(), 1.0 + 1e-15] {
        let press = LoadCase::new(vec![0.0, -1.0], vec![[0.0, 1.0], [1.0, 1.0]]).unwrap();
        let push = LoadCase::new(vec![1.0, 0.0], vec![[1.0, 0.0], [next, 1.0]]).unwrap();
        let loading = Loading::new(vec![press, push], vec![0.0]).unwrap();
        let settings = HistorySettings::new(&problem, &loading, Method::BN).unwrap();
        let times = [1.0, next];
        let outcome = history::run(&problem, &loading, &times, &settings, SystemSolver::default(), &mut ()).unwrap();
        assert_ne!(outcome.status, Status::Converged);
    }
}
