//! Nodes in space with one tangent: on a symmetry plane, and on an edge of the body in front of two obstacles.

use crate::common::prelude::*;
use crate::common::run_default;

const MU: f64 = 0.3;

/// A cube under the pressure 1 MPa, then the plane below moves `along` so far (m). `more` is TOML.
fn cube(n: usize, along: [f64; 2], more: &str) -> Scene {
    let [x, y] = along;
    let text = scene! { format r#"
[mesh] kind = "block", size = [1.0, 1.0, 1.0], elements = [{n}, {n}, {n}]
[material] young = 210e9, poisson = 0.3
[[support]] boundary = "right", fix = ["x"]
[[support]] boundary = "back", fix = ["y"]
[[contact]] boundary = "bottom", friction = {MU}
obstacle = {{ kind = "plane", motion = {{ translation = [[0, 0, 0, 0], [1, 0, 0, 0], [2, {x}, {y}, 0]] }} }}
[[load]] boundary = "top", traction = [0, 0, -1e6], history = [[0, 0], [1, 1]]
[time] end = 2, increments = 4
{more}
"# };
    parsed(&text)
}

/// The supports take what friction does across them: it is as if the obstacle only moved along the nodes' own tangents.
#[test]
fn an_obstacle_that_passes_symmetry_planes() {
    for along in [[-1e-3, 0.0], [0.0, -1e-3], [-1e-3, -5e-4]] {
        let scene = cube(3, along, "");
        let model = discretise(&scene).unwrap();
        let mut keep = Keep::default();
        assert_eq!(run_default(&scene, &model, &mut keep).status, Status::Converged, "{along:?}");
        let state = keep.states.last().unwrap();
        let (mut one, mut friction) = (0, [0.0; 2]);
        for (i, contact) in model.contact.nodes.iter().enumerate() {
            let [p_t, p_o] = contact.in_frame([state.p_t[i], state.p_o[i]]);
            let [x, y, _] = contact.position;
            assert!((x < 1.0 || p_t == 0.0) && (y < 1.0 || p_o == 0.0), "{along:?} {:?}", contact.position);
            one += usize::from(contact.tangents[1].is_empty() && !contact.tangents[0].is_empty());
            friction = [friction[0] + p_t, friction[1] + p_o];
        }
        assert_eq!(one, 6);
        // The corner has none, and neither set of nodes moves across its supports.
        let [x, y] = along.map(f64::abs);
        let whole = 1e6 * MU;
        assert!(
            friction.iter().all(|f| f.abs() < whole) && friction[0].hypot(friction[1]) > 0.5 * whole,
            "{friction:?}"
        );
        assert!(x == y || (x > y) == (friction[0].abs() > friction[1].abs()), "{along:?} {friction:?}");

        let settings = settings_of(&model, Method::Ip).until(100, scene.solver.tolerance);
        let (linear, mut by_ip) = (SystemSolver::from(LinearAlgebra::condensed()), Keep::default());
        let times = scene.time.all();
        let outcome = history_of(&model, &times, &settings, linear, &mut by_ip);
        assert_eq!(outcome.status, Status::Converged, "{along:?}");
        let found = by_ip.states.last().unwrap();
        for (a, b) in found.p_n.iter().chain(&found.p_t).zip(state.p_n.iter().chain(&state.p_t)) {
            assert!((a - b).abs() < 1e-8 * whole, "{along:?}: {a} {b}");
        }
    }
}

/// A second obstacle that is far away changes next to nothing: nodes on the edge keep their friction along it.
#[test]
fn a_second_obstacle_out_of_reach() {
    let force = |more: &str| {
        let scene = cube(4, [-1e-3, 0.0], more);
        let model = discretise(&scene).unwrap();
        let outcome = run_default(&scene, &model, &mut ());
        assert_eq!(outcome.status, Status::Converged);
        Resultant::all(&model, outcome.reached, &outcome.state)[0].force.clone()
    };
    let alone = force("");
    let far = "[[contact]]\nboundary = \"front\"\nfriction = 0.3\nobstacle = { kind = \"plane\", gap = 0.1 }";
    let beside = force(far);
    assert!(alone[0].abs() > 0.2e6 && (beside[0] / alone[0] - 1.0).abs() < 5e-3, "{alone:?} {beside:?}");
}

/// A bar slides in a corner along its edge: every node that can slide bears its whole friction, the nodes on the edge at both
/// obstacles.
#[test]
fn sliding_along_a_corner() {
    let moving = "motion = { translation = [[0, 0, 0, 0], [1, 0, 0, 0], [2, -1e-3, 0, 0]] }";
    let corner = format!(
        "[[contact]]\nboundary = \"front\"\nfriction = {MU}\nobstacle = {{ kind = \"plane\", {moving} }}\n\
         [[load]]\nboundary = \"back\"\ntraction = [0, -1e6, 0]\nhistory = [[0, 0], [1, 1]]"
    );
    // The back is free.
    let scene = cube(3, [-1e-3, 0.0], &corner).with(&["support[1].boundary=\"right\"".parse().unwrap()]).unwrap();
    let scene = scene.with(&["support[1].fix=[\"x\"]".parse().unwrap()]).unwrap();
    let model = discretise(&scene).unwrap();
    let outcome = run_default(&scene, &model, &mut ());
    assert_eq!(outcome.status, Status::Converged);
    let (mut edge, state) = (0, &outcome.state);
    for (i, contact) in model.contact.nodes.iter().enumerate() {
        let [x, y, z] = contact.position;
        if x == 1.0 || state.p_n[i] == 0.0 {
            continue;
        }
        let friction = state.p_t[i].hypot(state.p_o[i]);
        edge += usize::from(y == 0.0 && z == 0.0);
        assert!((friction / (MU * state.p_n[i]) - 1.0).abs() < 1e-6, "{:?}", contact.position);
    }
    assert_eq!(edge, 6);
}
