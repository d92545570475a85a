//! Coulomb's disk: friction in two tangential directions.

use crate::common::nodes::{Count, node, node_on_springs};
use crate::common::prelude::*;
use crate::common::random;

const TIMES: [f64; 5] = [0.2, 0.4, 0.6, 0.8, 1.0];

fn run(problem: &ContactProblem, loading: &Loading, settings: &HistorySettings) -> HistoryOutcome {
    history::run(problem, loading, &TIMES, settings, SystemSolver::default(), &mut ()).unwrap()
}

/// The default settings, without halving.
fn settings(problem: &ContactProblem, loading: &Loading) -> HistorySettings {
    HistorySettings { halvings: 0, ..HistorySettings::new(problem, loading, Method::BN).unwrap().until(100, 1e-10) }
}

fn solve(problem: &ContactProblem, loading: &Loading) -> HistoryOutcome {
    run(problem, loading, &settings(problem, loading))
}

fn assert_close(a: &[f64], b: &[f64], tolerance: f64) {
    assert!(apart(a, b) <= tolerance, "{a:?} {b:?}");
}

/// `|p_T|` of every node.
fn friction(state: &State) -> Vec<f64> {
    state.p_t.iter().zip(&state.p_o).map(|(t, o)| t.hypot(*o)).collect()
}

/// Loads that turn, friction from little to much: no increment fails in the default setting. The setting paper,
/// whose stop is an absolute Theta and belongs to the paper's scale, is counted beside it.
fn random_histories(seeds: Range<u64>) {
    for mu in [0.1, 0.4, 0.8, 2.0] {
        let [mut default, mut paper] = [Count::default(), Count::default()];
        for seed in seeds.clone() {
            let mut random = Random(seed * 7919 + 3);
            let contacts = 1 + (30.0 * random.next()) as usize;
            let (problem, loading) = random::problem(&mut random, contacts, mu, 0.0);
            let settings = settings(&problem, &loading);
            let outcome = run(&problem, &loading, &settings);
            assert_eq!(outcome.status, Status::Converged, "mu {mu}, seed {seed}: {:?}", outcome.violation);
            assert!(outcome.records.iter().all(|record| record.kkt.worst().1 <= 1e-10), "mu {mu}, seed {seed}");
            default.add(&outcome);
            let settings = HistorySettings::new(&problem, &loading, Method::PaperBn).unwrap().until(100, 1e-6);
            paper.add(&run(&problem, &loading, &settings));
        }
        println!("mu {mu}: default {default}; paper {paper}");
        assert!(default.mean() <= 7.0 && default.most <= 20, "mu {mu}: {default}");
        assert!(paper.failures <= 2, "mu {mu}: {paper}");
    }
}

#[test]
fn ten_random_histories() {
    random_histories(0..10);
}

#[test]
#[ignore = "four times as many as the test before"]
fn forty_random_histories() {
    random_histories(0..40);
}

/// Whatever pair of tangents a node has: the same displacements and forces in as many iterations.
#[test]
fn the_choice_of_tangents_does_not_matter() {
    for seed in 0..12 {
        let mut random = Random(seed * 104_729 + 1);
        let (problem, loading) = random::problem(&mut random, 1 + seed as usize, 0.7, 0.0);
        let turned = random::turn_tangents(&problem, &mut random);
        let paper = |problem| HistorySettings::new(problem, &loading, Method::PaperBn).unwrap().until(100, 1e-6);
        for (tolerance, [own, other]) in [
            (1e-10, [&problem, &turned].map(|problem| solve(problem, &loading))),
            (1e-7, [&problem, &turned].map(|problem| run(problem, &loading, &paper(problem)))),
        ] {
            assert_eq!(own.status, Status::Converged, "seed {seed}");
            assert_eq!(iterations(&own), iterations(&other), "seed {seed}");
            assert_close(&own.state.u, &other.state.u, tolerance);
            assert_close(&own.state.p_n, &other.state.p_n, tolerance);
            assert_close(&friction(&own.state), &friction(&other.state), tolerance);
        }
    }
}

/// A problem in two dimensions, with two displacements a node, and the same with a third one that nothing
/// moves, which is that of the second tangent.
fn flat(random: &mut Random, contacts: usize) -> ([ContactProblem; 2], [Loading; 2]) {
    let n = 2 * contacts;
    let factor: Vec<f64> = (0..n * n).map(|_| random.sign()).collect();
    let entry = |i: usize, j: usize| {
        let product: f64 = (0..n).map(|k| factor[i * n + k] * factor[j * n + k]).sum();
        1e11 * (f64::from(u8::from(i == j)) + 2.0 * product / n as f64)
    };
    let mu: Vec<f64> = (0..contacts).map(|_| random.next()).collect();
    let problem = |n: usize, third: bool| {
        ContactProblem::new(Parts {
            stiffness: random::symmetric(n, |i, j| {
                if i.max(j) < 2 * contacts { entry(i, j) } else { 7e10 * f64::from(u8::from(i == j)) }
            })
            .into(),
            c_n: random::rows(n, (0..contacts).map(|i| vec![(2 * i, 0.8), (2 * i + 1, 0.6)])),
            c_t: random::rows(n, (0..contacts).map(|i| vec![(2 * i, -0.6), (2 * i + 1, 0.8)])),
            c_o: random::rows(n, (0..contacts).map(|i| if third { vec![(2 * contacts + i, 1.0)] } else { Vec::new() })),
            mu: mu.clone(),
            weight: Some(vec![0.05; contacts]),
            rigid_modes: Some(Vec::new()),
        })
        .unwrap()
    };
    let problems = [problem(n, false), problem(3 * contacts, true)];
    let push: Vec<f64> = (0..n).map(|k| 1e6 * [0.8 + 0.3 * random.sign(), 0.6 + 0.8 * random.sign()][k % 2]).collect();
    let wiggle: Vec<f64> = (0..n).map(|k| 6e5 * [-0.6, 0.8][k % 2] * random.sign()).collect();
    let gap: Vec<f64> = (0..contacts).map(|_| 2e-6 * random.sign()).collect();
    let loading = |n: usize| {
        let case = |force: &Vec<f64>, history: &[[f64; 2]]| {
            let mut force = force.clone();
            force.resize(n, 0.0);
            LoadCase::new(force, history.to_vec()).unwrap()
        };
        let cases = vec![
            case(&push, &[[0.0, 0.0], [0.5, 1.0], [1.0, 0.7]]),
            case(&wiggle, &[[0.0, 0.0], [0.3, 1.0], [0.7, -1.0], [1.0, 1.0]]),
        ];
        Loading::new(cases, gap.clone()).unwrap()
    };
    (problems, [loading(n), loading(3 * contacts)])
}

/// Where nothing moves along the second tangent, three dimensions are two; and where only the second tangent
/// is free, it is as good as the first.
#[test]
fn an_idle_direction_changes_nothing() {
    let mut slipped = 0;
    for seed in 0..10 {
        let mut random = Random(seed * 31 + 7);
        let contacts = 1 + 2 * seed as usize;
        let ([two, three], [loading, padded]) = flat(&mut random, contacts);
        let other =
            ContactProblem::new(Parts { c_t: two.c_o().clone(), c_o: two.c_t().clone(), ..two.clone().into_parts() })
                .unwrap();
        let expected = solve(&two, &loading);
        assert_eq!(expected.status, Status::Converged, "seed {seed}");
        slipped += expected.records.iter().map(|record| record.contact.slip).sum::<usize>();
        let other = solve(&other, &loading);
        assert_eq!(iterations(&other), iterations(&expected));
        assert_eq!((&other.state.u, &other.state.p_n), (&expected.state.u, &expected.state.p_n));
        assert_eq!((&other.state.p_o, &other.state.p_t), (&expected.state.p_t, &expected.state.p_o));
        // Alone, a node is as stiff in space as in the plane, but r is another share of that.
        let same_r = HistorySettings { conventions: FormulationScaling::natural(&two), ..settings(&three, &padded) };
        let three = run(&three, &padded, &same_r);
        assert_eq!(three.status, Status::Converged, "seed {seed}");
        // In space an increment starts where the last one was going: the way there is another.
        assert_close(&three.state.u[..2 * contacts], &expected.state.u, 1e-12);
        assert_close(&three.state.p_n, &expected.state.p_n, 1e-12);
        assert_close(&three.state.p_t, &expected.state.p_t, 1e-12);
        assert!(three.state.u[2 * contacts..].iter().chain(&three.state.p_o).all(|x| *x == 0.0));
    }
    assert!(slipped > 50, "{slipped}");
}

/// A slip of a billionth of the displacements: its direction is lost in their rounding, and found in their second word.
#[test]
fn a_tiny_slip() {
    let oblique: [&[(usize, f64)]; 3] = [&[(2, 1.0)], &[(0, 0.6), (1, 0.8)], &[(0, -0.8), (1, 0.6)]];
    let problem = node(3, &[(0, 0, 1.0), (1, 1, 1.0), (2, 2, 1.0)], oblique, 0.5);
    let case = |force: [f64; 3], history: &[[f64; 2]]| LoadCase::new(force.to_vec(), history.to_vec()).unwrap();
    let loading = Loading::new(
        vec![case([1.7, 1.1, 1.0], &[[0.0, 0.0], [0.2, 1.0]]), case([1e-8, 3e-9, 0.0], &[[0.2, 0.0], [1.0, 1.0]])],
        vec![0.0],
    )
    .unwrap();
    let outcome = solve(&problem, &loading);
    assert_eq!(outcome.status, Status::Converged, "{:?}", outcome.violation);
    assert_eq!(outcome.records.iter().map(|record| record.contact.slip).sum::<usize>(), 5);
}

/// One node on springs k along each axis: inside the cone it stays, beyond it goes the way of the load until
/// the springs carry what friction does not.
#[test]
fn one_node() {
    let (k, mu) = (2.0, 0.3);
    let problem = node_on_springs(k, mu);
    for (force, slips) in [([0.2, -0.1, 1.0], false), ([0.3, -0.4, 1.0], true), ([-2.0, 0.1, 3.0], true)] {
        let loading =
            Loading::new(vec![LoadCase::new(force.to_vec(), vec![[0.0, 0.0], [1.0, 1.0]]).unwrap()], vec![0.0])
                .unwrap();
        let outcome = solve(&problem, &loading);
        assert_eq!(outcome.status, Status::Converged);
        let State { u, p_t, p_o, p_n, .. } = outcome.state;
        let length = force[0].hypot(force[1]);
        let carried = if slips { mu * force[2] / length } else { 1.0 };
        let expected = [
            carried * force[0],
            carried * force[1],
            force[2],
            (1.0 - carried) * force[0] / k,
            (1.0 - carried) * force[1] / k,
            0.0,
        ];
        let found = [p_t[0], p_o[0], p_n[0], u[0], u[1], u[2]];
        assert!(found.iter().zip(expected).all(|(a, b)| (a - b).abs() < 1e-12), "{found:?} {expected:?}");
    }
}

/// The error measure sees friction that points past the slip in proportion to the angle, and a force beyond the
/// disk though each component is within the limit.
#[test]
fn the_measure_sees_directions() {
    let problem = node_on_springs(1.0, 0.5);
    let increment =
        Increment { force: &[0.9, 1.2, 2.0], gap: &[0.0], mu: problem.mu(), w_t_last: &[0.0], w_o_last: &[0.0] };
    let measure = |p_t, p_o| {
        let state =
            State { u: vec![0.3, 0.4, 0.0], u_rest: Vec::new(), p_t: vec![p_t], p_o: vec![p_o], p_n: vec![2.0] };
        let status = statuses(&problem, &increment, &state).unwrap()[0];
        (KktErrors::measure(&problem, &increment, &state, &KktScales::default()).unwrap(), status)
    };
    let (errors, status) = measure(0.6, 0.8);
    assert!(errors.worst().1 < 1e-15 && status == ContactStatus::Slip, "{errors:?}");
    for angle in [1e-3_f64, 1e-6, 1e-9] {
        let (s, c) = angle.sin_cos();
        let (errors, _) = measure(0.6 * c - 0.8 * s, 0.6 * s + 0.8 * c);
        assert!((errors.dissipation / (angle / 2.0) - 1.0).abs() < 1e-6 && errors.cone < 1e-15, "{errors:?}");
    }
    let (errors, _) = measure(0.9, 0.9);
    assert!((errors.cone - (0.9 * 2.0_f64.sqrt() - 1.0) / 2.0).abs() < 1e-15, "{errors:?}");
}

type Case = (&'static str, f64, f64, [f64; 2], [f64; 2]);

/// Contact cases by (p_n, gap left, p_T, slip) in units of force and length, away from the borders.
const CASES: [Case; 9] = [
    ("open, no pressure", -0.5, 2.0, [0.3, -0.1], [0.2, 0.4]),
    ("open, pressure left over, sticking", 0.5, 3.0, [0.01, 0.02], [0.002, -0.01]),
    ("open, pressure left over, sliding", 0.5, 3.0, [0.7, 0.1], [0.9, -0.4]),
    ("closed, no pressure, sliding", -0.5, -2.0, [0.3, 0.6], [0.2, 0.5]),
    ("closed, stick", 2.0, -0.3, [0.1, -0.07], [0.05, 0.02]),
    ("closed, slip", 2.0, -0.3, [0.5, 0.2], [2.0, -1.0]),
    ("closed, slip, friction against it", 2.0, 0.1, [-0.4, 0.3], [-3.0, -2.0]),
    ("closed, slip along the second tangent", 2.0, -0.4, [0.0, 0.3], [0.0, 2.0]),
    ("closed, friction beyond the disk", 1.0, -0.2, [5.0, -3.0], [-0.1, 0.2]),
];

/// The Jacobian is the derivative of the residual in every case, with both pressures, up to the row operation
/// that belongs to it.
#[test]
fn jacobian_is_the_derivative() {
    let mut random = Random(5);
    let (problem, loading) = random::problem(&mut random, CASES.len(), 0.5, 0.0);
    let scaling = Scaling::near(1e11, 1.0);
    for conventions in [FormulationScaling::paper(problem.weight().unwrap()), FormulationScaling::natural(&problem)] {
        let mut formulation = Bdiff::new(&problem, scaling, &conventions);
        let layout = formulation.layout().clone();
        let n = layout.unknowns();
        let mut z: Vec<f64> = (0..n).map(|k| (1.0 + k as f64 * 0.7).sin()).collect();
        let [mut gap, mut w_t_last, mut w_o_last] = [(); 3].map(|()| vec![0.0; CASES.len()]);
        for (i, (_, p_n, gap_left, p, slip)) in CASES.into_iter().enumerate() {
            let [r_n, r_t] = [conventions.r_n[i], conventions.r_t[i]].map(|r| r / scaling.stiffness());
            z[layout.p_n(i)] = p_n;
            layout.tangential(i).into_iter().zip(p).for_each(|(k, p)| z[k.unwrap()] = p);
            gap[i] = (problem.c_n().times(&z[..problem.displacements()]).unwrap()[i] + gap_left / r_n) * scaling.length;
            w_t_last[i] =
                (problem.c_t().times(&z[..problem.displacements()]).unwrap()[i] - slip[0] / r_t) * scaling.length;
            w_o_last[i] =
                (problem.c_o().times(&z[..problem.displacements()]).unwrap()[i] - slip[1] / r_t) * scaling.length;
        }
        let force = loading.cases()[0].force();
        formulation.begin(
            &Increment { force, gap: &gap, mu: problem.mu(), w_t_last: &w_t_last, w_o_last: &w_o_last },
            &vec![0.0; formulation.unknowns()],
        );
        assert!(formulation.linearize(&z));
        assert!(!formulation.linearize(&z), "the same state changes nothing");
        let at = |shifted: &[f64]| {
            let mut h = vec![0.0; n];
            formulation.residual(shifted, &mut h).unwrap();
            h
        };
        let step = 1e-6;
        for column in 0..n {
            let mut shifted = z.clone();
            shifted[column] += step;
            let ahead = at(&shifted);
            shifted[column] -= 2.0 * step;
            let mut difference = at(&shifted);
            difference.iter_mut().zip(ahead).for_each(|(behind, ahead)| *behind = (ahead - *behind) / (2.0 * step));
            formulation.right_hand_side(&mut difference);
            for (row, difference) in difference.into_iter().enumerate() {
                let entry = formulation.jacobian().get(row, column);
                let of = |i: &usize| row == layout.p_n(*i) || layout.tangential(*i).contains(&Some(row));
                let name = (0..CASES.len()).find(of).map_or("equilibrium", |i| CASES[i].0);
                let what = format!("{:?}, {name}: row {row}, column {column}", conventions.pressure);
                assert!((difference - entry).abs() < 1e-8, "{what}: {difference} {entry}");
            }
        }
        // Friction turns a little: the cases stay, the coefficients of slip do not, and that is told.
        let cases = formulation.cases();
        for i in 0..CASES.len() {
            z[layout.p_o(i).unwrap()] += 1e-3;
        }
        assert!(formulation.linearize(&z));
        assert_eq!(formulation.cases(), cases);
    }
}
