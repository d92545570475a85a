//! The error measure: small on every solution of the block, and the truth about wrong states.

use crate::common::prelude::*;
use stickslip::solver::ContactStatus::{Open, Slip, Stick};
use stickslip::solver::ProblemError;

/// Every component at most 1e-10 in every increment.
#[test]
fn every_law_holds_on_the_block() {
    every_law_holds(&[5, 10, 20], &[0.0, 0.1, 0.4, 0.8]);
    every_law_holds(&[50], &[0.4]);
}

#[test]
#[ignore = "a minute without optimisation"]
fn every_law_holds_on_large_blocks() {
    every_law_holds(&[50], &[0.0, 0.1, 0.8]);
    every_law_holds(&[100], &[0.4]);
}

fn every_law_holds(sizes: &[usize], mus: &[f64]) {
    for n in sizes {
        for mu in mus {
            let scene = common::block(&[
                &format!("mesh.elements=[{n},{n}]"),
                &format!("contact.friction={mu}"),
                "time.increments=10",
            ]);
            let model = discretise(&scene).unwrap();
            let outcome = common::run(&scene, &model, &mut ());
            assert_eq!(outcome.status, Status::Converged, "n = {n}, mu = {mu}");
            assert_eq!(outcome.records.len(), 10);
            assert_eq!(outcome.linear.analyses, 1);
            assert!(outcome.linear.worst_backward_error <= 1e-15);
            for record in &outcome.records {
                for (law, error) in record.kkt.components() {
                    assert!(error <= 1e-10, "n = {n}, mu = {mu}, increment {}: {law} {error:e}", record.index);
                }
            }
        }
    }
}

/// One spoilt number raises the law it breaks, by what it breaks it.
#[test]
fn each_component_sees_its_own_violation() {
    let scene = common::block(&["mesh.elements=[10,10]", "time.increments=2"]);
    let model = discretise(&scene).unwrap();
    let mut keep = common::Keep::default();
    common::run(&scene, &model, &mut keep);
    let problem = &model.problem;
    // At the end some nodes are open, some stick, some slip.
    let (increment, state) = (keep.increment(1, model.loading.gap()), &keep.states[1]);
    let statuses = stickslip::solver::statuses(problem, &increment, state).unwrap();
    let find = |wanted| statuses.iter().position(|&s| s == wanted).unwrap();
    let (open, slip, stick) = (find(Open), find(Slip), find(Stick));
    // The largest contact force in the natural units of each node, and what is as large at another.
    let k = problem.contact_stiffness();
    let largest = state.p_n.iter().zip(k).fold(0.0_f64, |m, (p, k)| m.max(p / k.sqrt()));
    let (force, length) = (|i: usize| largest * k[i].sqrt(), |i: usize| largest / k[i].sqrt());
    let measure = |spoil: &dyn Fn(&mut State)| {
        let mut spoilt = state.clone();
        spoil(&mut spoilt);
        KktErrors::measure(problem, &increment, &spoilt, &KktScales::default()).unwrap()
    };
    let size = 1e-3;
    let near = |error: f64| (0.9 * size..1.1 * size).contains(&error);
    let dof = |i: usize, c: usize| model.constraints.dofs.node(model.contact.nodes[i].node)[c].unwrap();

    let tension = measure(&|s| s.p_n[open] = -size * force(open));
    assert!(near(tension.tension) && (0.5 * size..2.0 * size).contains(&tension.equilibrium), "{tension:?}");
    let across_a_gap = measure(&|s| s.p_n[open] = size * force(open));
    assert!(across_a_gap.complementarity > 0.1 * size && across_a_gap.tension == 0.0, "{across_a_gap:?}");
    let penetration = measure(&|s| s.u[dof(stick, 1)] -= size * length(stick));
    assert!(near(penetration.penetration), "{penetration:?}");
    let cone = measure(&|s| s.p_t[slip] += size * force(slip) * s.p_t[slip].signum());
    assert!(near(cone.cone) && cone.dissipation < 1e-12, "{cone:?}");
    let wrong_sign = measure(&|s| s.p_t[slip] = -s.p_t[slip]);
    assert!(wrong_sign.dissipation > 1e-4 && wrong_sign.cone < 1e-12, "{wrong_sign:?}");
    let creep = measure(&|s| s.u[dof(stick, 0)] += size * length(stick));
    assert!(near(creep.dissipation), "{creep:?}");
    let spoilers: [&dyn Fn(&mut State); 3] =
        [&|s| s.u[0] = f64::NAN, &|s| s.p_n[open] = f64::NAN, &|s| s.p_t[stick] = f64::NAN];
    for spoil in spoilers {
        assert!(measure(spoil).worst().1.is_nan(), "{:?}", measure(spoil));
    }
    let mut gap = model.loading.gap().to_vec();
    gap[stick] = f64::NAN;
    let nowhere = keep.increment(1, &gap);
    let errors = KktErrors::measure(problem, &nowhere, state, &KktScales::default());
    assert!(matches!(errors, Err(ProblemError::Value { array, .. }) if array == format!("gap[{stick}]")));
}

/// The measure does not depend on the system of units: all lengths and forces times a factor.
#[test]
fn the_measure_is_unit_free() {
    let scene = common::block(&["mesh.elements=[8,8]", "time.increments=2"]);
    let model = discretise(&scene).unwrap();
    let mut keep = common::Keep::default();
    common::run(&scene, &model, &mut keep);
    let (increment, mut state) = (keep.increment(1, model.loading.gap()), keep.states[1].clone());
    state.u.iter_mut().enumerate().for_each(|(k, u)| *u *= 1.0 + 1e-3 * (k as f64).sin());
    let scales = KktScales::default();
    let si = KktErrors::measure(&model.problem, &increment, &state, &scales).unwrap();
    // Powers of two, so that equality is exact.
    let (f, l) = (1024.0, 1.0 / 4096.0);
    let times = |values: &[f64], factor: f64| values.iter().map(|v| v * factor).collect::<Vec<_>>();
    let problem = common::changed(&model.problem, |parts| common::scale(&mut parts.stiffness, f / l));
    let (force, gap) = (times(increment.force, f), times(increment.gap, l));
    let [w_t_last, w_o_last] = [increment.w_t_last, increment.w_o_last].map(|w| times(w, l));
    let increment = Increment { force: &force, gap: &gap, mu: problem.mu(), w_t_last: &w_t_last, w_o_last: &w_o_last };
    let state = State {
        u: times(&state.u, l),
        u_rest: Vec::new(),
        p_t: times(&state.p_t, f),
        p_o: times(&state.p_o, f),
        p_n: times(&state.p_n, f),
    };
    assert_eq!(KktErrors::measure(&problem, &increment, &state, &scales), Ok(si));
    assert!(si.worst().1 > 1e-4);
}

/// In a body that sticks throughout the displacements are mere rounding, and so is their slip: it is compared with what
/// the contact forces would make of the node. A slip that large counts.
#[test]
fn rounding_of_a_body_that_sticks() {
    let problem = common::nodes::node(2, &[(0, 0, 2.0), (1, 1, 2.0)], [&[(1, 1.0)], &[(0, 1.0)], &[]], 0.5);
    let increment = Increment { force: &[0.1, 1.0], gap: &[0.0], mu: problem.mu(), w_t_last: &[0.0], w_o_last: &[0.0] };
    let dissipation = |slip: f64| {
        let state = State { u: vec![slip, 0.0], u_rest: Vec::new(), p_t: vec![0.1], p_o: vec![0.0], p_n: vec![1.0] };
        KktErrors::measure(&problem, &increment, &state, &KktScales::default()).unwrap().dissipation
    };
    assert!((dissipation(1e-17) / 2e-17 - 1.0).abs() < 1e-12, "{}", dissipation(1e-17));
    assert!((dissipation(1e-3) / 2e-3 - 1.0).abs() < 1e-12, "{}", dissipation(1e-3));
    // Beyond, the force that is missing counts.
    assert!((dissipation(1.0) - 0.4).abs() < 1e-12, "{}", dissipation(1.0));
}

/// A body that flies away has internal forces by rounding alone. Contact forces that balance these are no equilibrium.
#[test]
fn rounding_of_a_body_that_flies_away_balances_nothing() {
    let [a, b, c] = [1.0 / 3.0, 1.0 / 7.0, 1.0 / 11.0];
    let k = [(0, 0, a + b), (0, 1, -a), (0, 2, -b), (1, 1, a + c), (1, 2, -c), (2, 2, b + c)];
    let stiffness = Symmetric::from_triplets(3, &k).unwrap();
    let (far, none) = (1e20 / 13.0, vec![0.0; 3]);
    let problem = |normals: &[f64]| {
        let c_n = Csr::from_rows(3, normals.iter().enumerate().map(|(k, n)| [(k, *n)])).unwrap();
        let parts = Parts { rigid_modes: Some(vec![vec![1.0; 3]]), ..Parts::new(stiffness.clone(), c_n) };
        ContactProblem::new(parts).unwrap()
    };
    let away = State { u: vec![far; 3], p_n: none.clone(), p_t: none.clone(), p_o: none.clone(), ..State::default() };
    let rounding = problem(&[1.0; 3]).equilibrium(&none, &away).unwrap();
    let normals: Vec<f64> = rounding.iter().map(|f| if *f > 0.0 { -1.0 } else { 1.0 }).collect();
    let gap: Vec<f64> = normals.iter().map(|n| n * far).collect();
    let force = [1e-9, 0.0, 0.0];
    let increment = Increment { force: &force, gap: &gap, mu: &none, w_t_last: &none, w_o_last: &none };
    let state = State { p_n: rounding.iter().map(|f| f.abs()).collect(), ..away };
    let errors = KktErrors::measure(&problem(&normals), &increment, &state, &KktScales::default()).unwrap();
    assert!(errors.equilibrium > 0.1, "{rounding:?} {errors:?}");
}
