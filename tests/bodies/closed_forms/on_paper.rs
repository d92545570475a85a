//! Cases with an answer on paper.

use crate::common::prelude::*;

/// A block pressed on a foundation, free to widen: uniform stress, whatever the mesh.
fn compressed(plane: &str, friction: f64) -> Scene {
    let text = format!(
        r#"
        mesh = {{ kind = "block", size = [2.0, 1.0], elements = [7, 5] }}
        material = {{ young = 200e9, poisson = 0.25, plane = "{plane}" }}
        support = [{{ boundary = "left", fix = ["x"] }}]
        contact = [{{ boundary = "bottom", friction = {friction}, obstacle = {{ kind = "plane", gap = 1e-5 }} }}]
        load = [{{ boundary = "top", traction = [0, -8e6] }}]
        time = {{ end = 1, increments = 3 }}
        "#
    );
    parsed(&text)
}

/// Contact patch test: without friction the pressure is the load and the strain that of uniaxial
/// stress, in plane stress `ε_yy = -p/E` and in plane strain `-p (1 - ν²)/E`.
#[test]
fn contact_patch_test() {
    let (young, poisson, pressure) = (200e9, 0.25, 8e6);
    for (plane, e_y, e_x) in [
        ("stress", -pressure / young, poisson * pressure / young),
        ("strain", -pressure * (1.0 - poisson * poisson) / young, poisson * (1.0 + poisson) * pressure / young),
    ] {
        let scene = compressed(plane, 0.0);
        let model = discretise(&scene).unwrap();
        // Held along y by the foundation alone: K is singular.
        assert_eq!(model.constraints.rigid_motions.len(), 1);
        let problem = &model.problem;
        let outcome = common::run(&scene, &model, &mut ());
        assert_eq!(outcome.status, Status::Converged, "{:?}", outcome.records.last());
        assert_eq!(outcome.layout.tangentials(), 0);
        for (p_n, l) in outcome.state.p_n.iter().zip(problem.weight().unwrap()) {
            assert!((p_n / l / pressure - 1.0).abs() < 1e-12, "{p_n} {l}");
        }
        for (x, u) in model.mesh.nodes.iter().zip(model.constraints.dofs.displacements(&outcome.state.u)) {
            let exact = [e_x * x[0], -1e-5 + e_y * x[1]];
            assert!((0..2).all(|c| (u[c] - exact[c]).abs() < 1e-16), "{u:?} {exact:?}");
        }
    }
}

/// A contact node without friction and one with a friction that is never felt give the same.
#[test]
fn no_friction_is_the_limit_of_little_friction() {
    let solve = |mu: &str| {
        let scene = common::block(&["mesh.elements=[10,10]", "time.increments=4", mu]);
        let model = discretise(&scene).unwrap();
        let outcome = common::run(&scene, &model, &mut ());
        assert_eq!(outcome.status, Status::Converged);
        outcome
    };
    let (none, little) = (solve("contact.friction=0"), solve("contact.friction=1e-13"));
    assert_eq!((none.layout.tangentials(), little.layout.tangentials()), (0, 10));
    for (a, b) in none.state.p_n.iter().zip(&little.state.p_n) {
        assert!((a - b).abs() < 1e-9 * a.max(1e5), "{a} {b}");
    }
}

/// One node on a plane, K = [[2, 1.5], [1.5, 2]] for (u_t, u_n): stick under (0.1, 1), slip under
/// (1, 1), open under (0, -1).
#[test]
fn one_node() {
    let mu = 0.3;
    let slip = 0.25 / (1.0 - 0.75 * mu);
    for (force, u_t, p_n, p_t) in [
        ([0.1, 1.0], 0.0, 1.0, 0.1),
        ([1.0, 1.0], (1.0 - mu * slip) / 2.0, slip, mu * slip),
        ([0.0, -1.0], 1.5 / 1.75, 0.0, 0.0),
    ] {
        let entries = [(0, 0, 2.0), (1, 0, 1.5), (1, 1, 2.0)];
        let problem = common::nodes::node(2, &entries, [&[(1, 1.0)], &[(0, 1.0)], &[]], mu);
        let case = LoadCase::new(force.to_vec(), vec![[0.0, 0.0], [1.0, 1.0]]).unwrap();
        let loading = Loading::new(vec![case], vec![0.0]).unwrap();
        let method = Method::Bn { r_factor: 1.0, rescue: false };
        let settings = HistorySettings::new(&problem, &loading, method).unwrap().until(50, 1e-12);
        let settings = HistorySettings { scaling: Scaling::SI, halvings: 0, ..settings };
        let outcome = history::run(&problem, &loading, &[1.0], &settings, SystemSolver::default(), &mut ()).unwrap();
        assert_eq!(outcome.status, Status::Converged, "{force:?}");
        let found = [outcome.state.u[0], outcome.state.p_n[0], outcome.state.p_t[0]];
        for (found, exact) in found.into_iter().zip([u_t, p_n, p_t]) {
            assert!((found - exact).abs() < 1e-12, "{force:?}: {found} {exact}");
        }
    }
}
