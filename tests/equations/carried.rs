//! Bodies that contact alone holds and that obstacles and loads carry far beyond what they deform: the forces are those that
//! they would have on the spot, from every method and every linear algebra, in a few iterations.

use crate::common::prelude::*;
use crate::neutral::{agreed, solve};

const METHODS: [Method; 2] = [Method::BN, Method::Ip];

/// A steel block of 10 mm at a distance from a floor and a wall, pressed against both.
fn approaching(elements: &str, gap: f64, force: f64) -> Model {
    let plane = elements.split(',').count() == 2;
    let (size, down, left) = if plane {
        ("[0.01, 0.01]", format!("[0, -{force:e}]"), format!("[-{force:e}, 0]"))
    } else {
        ("[0.01, 0.01, 0.01]", format!("[0, 0, -{force:e}]"), format!("[-{force:e}, 0, 0]"))
    };
    model_of(&format!(
        r#"
        mesh = {{ kind = "block", size = {size}, elements = [{elements}] }}
        material = {{ young = 210e9, poisson = 0.3 }}
        contact = [
            {{ boundary = "bottom", friction = 0.3, obstacle = {{ kind = "plane", gap = {gap:e} }} }},
            {{ boundary = "left", friction = 0.3, obstacle = {{ kind = "plane", gap = {gap:e} }} }},
        ]
        load = [{{ boundary = "top", force = {down} }}, {{ boundary = "right", force = {left} }}]
        time = {{ end = 1, increments = 2 }}
        "#
    ))
}

/// Ten newtons carry it by a millimetre and deform it by a nanometre: `ε |K| |u|` is a share of 1e-9 of the load.
#[test]
fn a_block_comes_to_rest_in_a_corner() {
    for elements in ["6, 6", "3, 3, 3"] {
        for (gap, force) in [(1e-5, 1e3), (1e-3, 1e3), (1e-3, 10.0), (1e-2, 0.1)] {
            let model = approaching(elements, gap, force);
            for method in METHODS {
                let outcome = agreed(&model, method, 20);
                // One tangent lies in the other obstacle's normal: friction at one counts at the other.
                let on_obstacles = Resultant::all(&model, outcome.reached, &outcome.state);
                let sum = |axis: usize| on_obstacles.iter().map(|resultant| resultant.force[axis]).sum::<f64>();
                let [x, y] = [sum(0), sum(model.mesh.dimension - 1)];
                assert!((x + force).abs() < 1e-9 * force && (y + force).abs() < 1e-9 * force, "{gap} {force}: {x} {y}");
            }
        }
    }
}

/// Who measures the state from outside finds what its verdict says.
#[test]
fn a_body_that_was_carried_is_in_equilibrium() {
    let model = approaching("3, 3, 3", 1e-3, 10.0);
    let settings = settings_of(&model, Method::BN);
    let mut measured = Vec::new();
    let measure = |step: &IncrementView<'_>| {
        let errors = KktErrors::measure(&model.problem, step.increment, step.state, &KktScales::default()).unwrap();
        measured.push((errors, step.increment.gap.iter().fold(f64::INFINITY, |least, gap| least.min(*gap))));
    };
    history_of(&model, model.times(), &settings, LinearAlgebra::default(), &mut each(measure));
    assert_eq!(measured.len(), 2);
    for (errors, gap) in measured {
        assert!(errors.worst().1 < 1e-10, "{errors:?}");
        assert!((gap - 1e-3).abs() < 1e-15, "{gap}");
    }
}

/// A gap that nothing ever closes is no distance to anything.
#[test]
fn an_obstacle_out_of_reach() {
    let model = model_of(
        r#"
        mesh = { kind = "block", size = [1.0, 1.0], elements = [5, 5] }
        material = { young = 1e9, poisson = 0.3 }
        contact = [
            { boundary = "bottom", friction = 0.3, obstacle = { kind = "plane", gap = 1e-3 } },
            { boundary = "left", friction = 0.3, obstacle = { kind = "plane", gap = 1e30 } },
        ]
        load = [{ boundary = "right", traction = [-0.5e4, 0] }, { boundary = "top", traction = [0, -0.7e5] }]
        time = { end = 1, increments = 2 }
        "#,
    );
    for method in METHODS {
        let outcome = agreed(&model, method, 20);
        assert!(outcome.state.u.iter().all(|u| u.abs() < 2e-3));
    }
}

/// A block on an oblique guide, between an obstacle on its left and nothing.
fn on_a_guide(gap: f64, load: &str) -> Model {
    model_of(&format!(
        r#"
        mesh = {{ kind = "block", size = [1.0, 1.0], elements = [4, 4] }}
        material = {{ young = 1e9, poisson = 0.3 }}
        support = [{{ boundary = "bottom", direction = [-0.28, 0.96] }}]
        contact = [{{ boundary = "left", friction = 0.3, obstacle = {{ kind = "plane", gap = {gap:e} }} }}]
        load = [{load}]
        time = {{ end = 1, increments = 2 }}
        "#
    ))
}

/// An obstacle that has come into a body which nothing presses moves it by no more than it must, and no force is needed.
#[test]
fn a_body_without_load_is_pushed_out() {
    for gap in [0.0, -1e-6, -1e-2] {
        let model = on_a_guide(gap, "");
        for method in METHODS {
            let outcome = agreed(&model, method, 0);
            assert!(outcome.state.p_n.iter().chain(&outcome.state.p_t).all(|p| *p == 0.0));
            let displacement = -gap / 0.96;
            let moved = model.constraints.dofs.displacements(&outcome.state.u);
            let off = moved.iter().map(|u| (u[0] - 0.96 * displacement).abs().max((u[1] - 0.28 * displacement).abs()));
            assert!(off.fold(0.0, f64::max) <= 1e-15 * gap.abs(), "{gap}: {moved:?}");
        }
    }
}

/// What rounding leaves of a load that is balanced drives nothing: the body stays where it is.
#[test]
fn a_body_without_net_load_stays() {
    // At right angles to the guide.
    let pressed = on_a_guide(1e-3, "{ boundary = \"top\", force = [28, -96] }");
    // In balance node by node, but for rounding, and side by side.
    let cancelled = on_a_guide(
        1e-3,
        "{ boundary = \"top\", traction = [0.1, -0.3] }, { boundary = \"top\", traction = [-0.3, 0.1] }, \
         { boundary = \"top\", traction = [0.2, 0.2] }",
    );
    let pulled = on_a_guide(
        1e-3,
        "{ boundary = \"left\", traction = [-0.7e2, 0.1e2] }, { boundary = \"right\", traction = [0.7e2, -0.1e2] }",
    );
    for (name, model) in [("pressed", pressed), ("cancelled", cancelled), ("pulled", pulled)] {
        for method in METHODS {
            for (word, linear) in LinearAlgebra::WORDS.into_iter().filter(|(_, linear)| linear.is_built_in()) {
                let outcome = solve(&model, method, linear);
                assert_eq!(outcome.status, Status::Converged, "{name} {method} {word}");
                let u = largest(&outcome.state.u);
                assert!(u < 1e-6, "{name} {method} {word}: {u}");
            }
        }
    }
}

/// Where two obstacles meet in the plane and three in space, friction and pressure share the forces of a node in many ways: while
/// the loads stay, so do the forces, and a small change of the loads changes them a little.
#[test]
fn forces_in_a_corner_stay_while_loads_do() {
    let in_a_corner = |space: bool, end: f64, last: f64| {
        let (size, front, back) = if space {
            let front = ", { boundary = \"front\", friction = 0.3, obstacle = { kind = \"plane\" } }";
            (
                "[1, 1, 1]",
                front,
                format!(
                    ", {{ boundary = \"back\", traction = [0, -0.6, 0], history = [[0, 0], [1, 1], [2, {last}]] }}"
                ),
            )
        } else {
            ("[1, 1]", "", String::new())
        };
        let [down, left] = if space { ["[0, 0, -1]", "[-0.6, 0, 0]"] } else { ["[0, -1]", "[-0.6, 0]"] };
        model_of(&format!(
            r#"
            mesh = {{ kind = "block", size = {size}, elements = {size} }}
            material = {{ young = 1000, poisson = 0.3 }}
            contact = [
                {{ boundary = "bottom", friction = 0.3, obstacle = {{ kind = "plane" }} }},
                {{ boundary = "left", friction = 0.3, obstacle = {{ kind = "plane" }} }}{front}
            ]
            load = [
                {{ boundary = "top", traction = {down}, history = [[0, 0], [1, 1], [2, {last}]] }},
                {{ boundary = "right", traction = {left}, history = [[0, 0], [1, 1], [2, {last}]] }}{back}
            ]
            time = {{ end = {end}, increments = {end} }}
            "#
        ))
    };
    for space in [false, true] {
        for method in METHODS {
            let forces = |end: f64, last: f64| {
                let state = agreed(&in_a_corner(space, end, last), method, 40).state;
                [state.p_n, state.p_t, state.p_o].concat()
            };
            let [at_first, later, more] = [forces(1.0, 1.0), forces(2.0, 1.0), forces(2.0, 1.0001)];
            let off = |other: &[f64]| at_first.iter().zip(other).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max);
            assert!(off(&later) < 1e-8 && off(&more) < 1e-3, "{space} {method}: {} {}", off(&later), off(&more));
        }
    }
}
