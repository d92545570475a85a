//! Static condensation: the smaller problem, the way back, and whole runs on it that have their own
//! difficulties. That histories agree with the uncondensed ones is tests/backends_agree.rs.

use crate::common::prelude::*;
use stickslip::solver::Condensation;

const SUPPORT: &str = "[[support]]\nboundary = \"left\"\nfix = [\"x\", \"y\"]\n";

fn run(model: &Model, times: &[f64], backend: LinearAlgebra) -> (HistoryOutcome, Keep) {
    let settings = settings_of(model, Method::BN).until(100, 1e-10);
    recorded(model, times, &settings, backend)
}

/// Any contact forces and displacements: the interior is in equilibrium, and what the contact nodes lack is
/// what the condensed problem says.
#[test]
fn the_way_back_keeps_equilibrium() {
    for (name, text, friction) in [
        ("held", BLOCK.to_string(), 0.4),
        ("free", BLOCK.replace(SUPPORT, ""), 0.4),
        ("smooth", BLOCK.to_string(), 0.0),
    ] {
        let model = model_with(&text, &["mesh.elements=[9,7]", &format!("contact.friction={friction}")]);
        let condensed = Condensed::new(&model.problem, &model.loading, SparseCholesky::default()).unwrap();
        let border = model.problem.contact_displacements();
        assert_eq!(condensed.problem.displacements(), border.len());
        let n_c = model.problem.contacts();
        let some = |n: usize, size: f64| (0..n).map(|i| size * (1.0 + 2.7 * i as f64).sin()).collect::<Vec<_>>();
        let p_t = if friction > 0.0 { some(n_c, 3e5) } else { vec![0.0; n_c] };
        let contact =
            State { u: some(border.len(), 1e-5), u_rest: Vec::new(), p_t, p_o: vec![0.0; n_c], p_n: some(n_c, 1e6) };
        let time = 0.7;
        let force = model.loading.force_at(time, &model.problem).unwrap();
        let small_force = condensed.loading.force_at(time, &condensed.problem).unwrap();
        let state = condensed.state(time, &contact).unwrap();
        let imbalance = model.problem.equilibrium(&force, &state).unwrap();
        let expected = condensed.problem.equilibrium(&small_force, &contact).unwrap();
        let scale = largest(&expected);
        let mut whole = vec![0.0; imbalance.len()];
        border.iter().zip(&expected).for_each(|(&dof, f)| whole[dof] = *f);
        let worst = imbalance.iter().zip(&whole).fold(0.0_f64, |m, (a, b)| m.max((a - b).abs()));
        assert!(worst <= 1e-12 * scale, "{name}: {worst:e} against {scale:e}");
        assert!(border.iter().zip(&contact.u).all(|(&dof, u)| state.u[dof] == *u), "{name}");
    }
}

#[test]
fn a_body_that_only_contact_holds() {
    let text = include_str!("../../data/scenes/held_by_contact.toml");
    let scene = parsed(text);
    let model = discretise(&scene).unwrap();
    assert!(!model.problem.rigid_modes().is_empty());
    let [whole, condensed] = both().map(|backend| run(&model, &scene.time.all(), backend));
    assert_eq!((whole.0.status, condensed.0.status), (Status::Converged, Status::Converged));
    let largest = largest(&whole.0.state.p_n);
    let pairs = whole.1.states.iter().zip(&condensed.1.states);
    let worst = pairs.flat_map(|(a, b)| a.p_n.iter().zip(&b.p_n)).fold(0.0_f64, |m, (a, b)| m.max((a - b).abs()));
    assert!(worst <= 1e-9 * largest, "{worst:e} against {largest:e}");
}

/// Nothing holds the body, not even contact: the motion is named, and nothing crashes.
#[test]
fn a_body_that_nothing_holds() {
    let contact = BLOCK.find("[[contact]]").unwrap();
    let load = BLOCK.find("[[load]]").unwrap();
    let without = [&BLOCK[..contact], &BLOCK[load..]].concat();
    let free = model_with(&without.replace(SUPPORT, ""), &["mesh.elements=[4,4]"]);
    assert!(matches!(
        Condensed::new(&free.problem, &free.loading, SparseCholesky::default()),
        Err(LinearError::Singular { .. })
    ));
    for backend in both() {
        let outcome = run(&free, &[1.0], backend).0;
        assert_eq!(outcome.status, Status::Singular, "{backend:?}");
        assert!(outcome.free_motion.is_some(), "{backend:?}");
    }
    // Without contact there is nothing to condense to, and nothing to iterate.
    let held = model_with(&without, &["mesh.elements=[4,4]"]);
    let [whole, condensed] = both().map(|backend| run(&held, &[0.5, 1.0], backend).0);
    assert_eq!((whole.status, condensed.status), (Status::Converged, Status::Converged));
    assert!(apart(&condensed.state.u, &whole.state.u) <= 1e-12);
}

/// In a slender body the forces follow from small differences of displacements: the whole system is refined,
/// with a second word for u.
#[test]
fn slender_bodies_are_refined() {
    let strip = model_with(
        BLOCK,
        &[
            "mesh.size=[10.0,0.1]",
            "mesh.elements=[400,4]",
            "contact.obstacle.gap=0.1",
            "load[0].traction=[0.0,-1e4]",
            "load[1].traction=[-1e3,0.0]",
        ],
    );
    let times = [0.5, 1.0, 1.5, 2.0];
    let [whole, condensed] = both().map(|backend| run(&strip, &times, backend));
    assert_eq!((whole.0.status, condensed.0.status), (Status::Converged, Status::Converged));
    assert!(condensed.0.rounding > 1e-10, "not slender enough to show anything: {:e}", condensed.0.rounding);
    assert!(condensed.1.states.iter().any(|state| !state.u_rest.is_empty()));
    assert!(condensed.0.linear.worst_backward_error <= 1e-14);
    let sum = |state: &State| state.p_n.iter().sum::<f64>();
    let (a, b) = (sum(&whole.0.state), sum(&condensed.0.state));
    assert!((a - b).abs() <= 1e-8 * a.abs(), "{a} {b}");
}

/// Problems that differ in friction share the factors of the body. Another stiffness or other contact rows have their
/// own.
#[test]
fn a_condensation_is_used_again() {
    let cube = CUBE;
    let bodies = [
        model_with(BLOCK, &["mesh.elements=[12,10]"]),
        model_with(BLOCK, &["mesh.elements=[12,10]", "material.young=1e11"]),
        model_with(&BLOCK.replace(SUPPORT, ""), &["mesh.elements=[12,10]"]),
        model_with(BLOCK, &["mesh.elements=[8,8]", "mesh.cells=\"triangle6\""]),
        model_with(cube, &["mesh.elements=[3,3,3]"]),
    ];
    let shared = Condensation::from(SparseCholesky::default());
    for model in bodies.iter().chain(&bodies) {
        for mu in [0.0, 0.2, 0.5] {
            let friction = (0..model.problem.contacts()).map(|i| mu * (1.0 + (i as f64).sin())).collect();
            let problem = model.problem.with_friction(friction).unwrap();
            let settings = HistorySettings::new(&problem, &model.loading, Method::BN).unwrap().until(100, 1e-10);
            let [first, second] = [&shared, &Condensation::from(SparseCholesky::default())].map(|condensation| {
                let system = SystemSolver::Condensed(condensation.clone());
                history::run(&problem, &model.loading, &[0.5, 1.0], &settings, system, &mut ()).unwrap()
            });
            assert_eq!(first.status, second.status);
            assert_eq!(first.state, second.state);
        }
    }
    let refused = bodies[0].problem.with_friction(vec![-1.0; bodies[0].problem.contacts()]).unwrap_err();
    assert_eq!(refused.to_string(), "mu[0] is -1, but must be 0 or more");
    assert!(bodies[0].problem.with_friction(vec![0.1]).is_err());
}
