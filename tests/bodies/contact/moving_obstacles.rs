//! Obstacles that move: friction along a belt, and gaps that are exact wherever the obstacle has gone.

use crate::common::prelude::*;

fn solve(text: &str) -> (Model, Vec<[f64; 2]>) {
    let scene = parsed(text);
    let model = discretise(&scene).unwrap();
    let settings = settings_of(&model, Method::BN).until(200, 1e-10);
    let (outcome, keep) = recorded(&model, &scene.time.all(), &settings, LinearAlgebra::default());
    assert_eq!(outcome.status, Status::Converged);
    let sums = keep.states.iter().map(|state| [state.p_n.iter().sum(), state.p_t.iter().sum()]).collect();
    (model, sums)
}

/// While the belt stands still the block sticks or spreads symmetrically; when it runs, every node slides, and the
/// whole friction μ N pulls along the belt.
#[test]
fn a_running_belt_pulls_with_the_whole_friction() {
    let (_, sums) = solve(&BELT);
    assert!((sums[1][0] - 1e5).abs() < 1e-3 && sums[1][1].abs() < 1e-3, "{sums:?}");
    // p_t is the force of the body on the obstacle, against the motion of the belt.
    for k in [2, 3] {
        assert!((sums[k][0] - 1e5).abs() < 1e-3 && (sums[k][1] + 0.3e5).abs() < 1e-3, "{sums:?}");
    }
    let (_, sums) = solve(&BELT.replace("0.5, 0]", "-0.5, 0]"));
    assert!((sums[3][1] - 0.3e5).abs() < 1e-3, "{sums:?}");
}

/// An obstacle that carries the whole body along is as if the body were pushed back: only the relative motion counts.
#[test]
fn approach_and_translation_along_the_normal_are_the_same() {
    let pressed = BELT
        .replace("traction = [0.0, -1e5]", "traction = [1e4, 0.0]")
        .replace("fix = [\"x\"]", "fix = [\"x\", \"y\"]");
    let translation = "motion = { translation = [[0, 0, 0], [1, 0, 0], [2, 0.5, 0]] }";
    let (_, by_translation) =
        solve(&pressed.replace(translation, "motion = { translation = [[0, 0, 0], [2, 0, 1e-4]] }"));
    let (_, by_approach) = solve(&pressed.replace(translation, "approach = [[0, 0], [2, 1e-4]]"));
    assert_eq!(by_translation, by_approach);
    assert!(by_approach[3][0] > 1e4);
}

/// The belt with a cylinder of this radius in place of the plane.
fn roller(radius: f64, motion: &str) -> String {
    let kind = format!("kind = \"cylinder\", radius = {radius}, apex = [0.5, 0.0], motion = {{ {motion} }}");
    BELT.replace("kind = \"plane\", motion = { translation = [[0, 0, 0], [1, 0, 0], [2, 0.5, 0]] }", &kind)
}

/// However far an obstacle moves and turns, the gaps in front of it are exact. What the body does is linearised: on a
/// wedge it leaves that range.
#[test]
fn only_the_body_leaves_the_range() {
    let share = |text: &str| left(&parsed(text));
    assert!(share(&BELT).is_none());
    assert!(share(&roller(10.0, "rotation = { through = [0.5, -10.0], history = [[0, 0], [2, 6.0]] }")).is_none());
    for distance in ["0.02", "0.2", "-0.3"] {
        let translation = format!("translation = [[0, 0, 0], [1, 0, 0], [2, {distance}, 0]]");
        assert!(share(&roller(10.0, &translation)).is_none(), "{distance}");
    }
    // The block is pushed to the wall over the ridge of a wedge.
    let wedge = "contact.obstacle={ kind = \"wedge\", angle = 0.2, apex = [0.75, -1e-5] }";
    assert!(
        left(&common::block(&["mesh.elements=[4,4]", "time.end=1", "time.increments=2", "output.times=[1]", wedge]))
            .unwrap()
            > 0.2
    );
}

/// A roller that passes under a body that is the same everywhere: moved by whole elements, and turned over, the contact
/// forces move and turn over, too. By the rates alone the gaps would be wrong by as much as they are.
#[test]
fn a_roller_passes() {
    let last = |text: &str| {
        let scene = parsed(text);
        let (model, mut keep) = (discretise(&scene).unwrap(), Keep::default());
        assert_eq!(common::run_default(&scene, &model, &mut keep).status, Status::Converged);
        (model, keep.states.last().unwrap().p_n.clone())
    };
    let held = |motion: &str| {
        let text = roller(10.0, motion).replace("friction = 0.3", "friction = 0").replace("[8, 4]", "[16, 8]");
        text.replace("fix = [\"x\"]", "fix = [\"x\", \"y\"]")
    };
    let moved = |distance: f64| held(&format!("translation = [[0, 0, 0], [1, 0, 4e-3], [2, {distance}, 4e-3]]"));
    let (model, right) = last(&moved(0.25));
    let (_, left) = last(&moved(-0.25));
    let put = held("translation = [[0, 0, 0], [1, 0, 4e-3]]").replace("apex = [0.5, 0.0]", "apex = [0.75, 0.0]");
    let (_, put) = last(&put);
    assert!(right.iter().filter(|p| **p > 0.0).count() > 2 && right[0] == 0.0, "{right:?}");
    for (i, contact) in model.contact.nodes.iter().enumerate() {
        let mirror = |x: f64| model.contact.nodes.iter().position(|c| (c.position[0] + x - 1.0).abs() < 1e-9).unwrap();
        let other = left[mirror(contact.position[0])];
        assert!((right[i] - other).abs() < 1e-4 && (right[i] - put[i]).abs() < 1e-4, "{right:?} {left:?} {put:?}");
    }
}

/// However little an obstacle moves: what the rates leave out as a cylinder passes is up to a hundredth of the approach here,
/// and far below what rounding leaves of a coordinate in the last line.
#[test]
fn gaps_are_exact_however_small_the_motion() {
    for (approach, aside) in [(1e-9, 1.3e-6), (1e-10, 1.3e-6), (1e-15, 4e-9)] {
        let text = roller(1.0, &format!("translation = [[0, 0, 0], [2, {aside:e}, 0]]"));
        let text = text.replace("motion = {", &format!("approach = [[0, 0], [2, {approach:e}]], motion = {{"));
        let model = model_of(&text);
        for (contact, gap) in model.contact.nodes.iter().zip(model.loading.gaps_at(2.0)) {
            let s = contact.position[0] - 0.5 - aside;
            let error = (gap - (s * s / (1.0 + (1.0 - s * s).sqrt()) - approach)).abs();
            // The place of the node is rounded, too, and the surface in front of it slopes by about s.
            assert!(error <= 1e-9 * approach + 1e-15 * s.abs(), "{approach} at {s}: {gap}, off by {error}");
        }
    }
}

/// What turns about its own axis bends nothing; beside it, it does.
#[test]
fn what_turns_in_itself_has_no_bend() {
    for (centre, bends) in [("[0.5, -0.7]", 0), ("[0.5, -0.70001]", 1)] {
        let approach = "translation = [[0, 0, 0], [2, 0, 1e-4]]";
        let text =
            roller(0.7, &format!("{approach}, rotation = {{ through = {centre}, history = [[0, 0], [2, 1.0]] }}"));
        let model = model_of(&text);
        assert_eq!(model.loading.gap_corrections().len(), bends, "{centre}");
    }
}

/// A plane that tips over by a large angle is where it is, at the node's normal.
#[test]
fn a_plane_that_tips() {
    let tips =
        "kind = \"plane\", gap = 0.0, motion = { rotation = { through = [1, 0], history = [[0, 0], [2, 0.4]] } }";
    let text = BELT.replace("kind = \"plane\", motion = { translation = [[0, 0, 0], [1, 0, 0], [2, 0.5, 0]] }", tips);
    let model = model_of(&text);
    for (t, angle) in [(0.5, 0.1_f64), (2.0, 0.4)] {
        for (contact, gap) in model.contact.nodes.iter().zip(model.loading.gaps_at(t)) {
            let expected = (1.0 - contact.position[0]) * angle.tan();
            assert!((gap - expected).abs() < 1e-12, "{t} {:?}: {gap} {expected}", contact.position);
        }
    }
}

/// Keeps by how much the last state leaves the range.
struct Last<'a>(&'a Model, Option<f64>);

impl stickslip::solver::history::Observer for Last<'_> {
    fn increment(&mut self, step: &stickslip::solver::history::IncrementView<'_>) -> ControlFlow<()> {
        let left = self.0.range_left(step.record.time, step.state, step.increment.gap, step.statuses);
        self.1 = left.map(|left| left.share);
        ControlFlow::Continue(())
    }
}

/// By how much the last state leaves the range.
fn left(scene: &Scene) -> Option<f64> {
    let model = discretise(scene).unwrap();
    let mut last = Last(&model, None);
    assert_eq!(common::run_default(scene, &model, &mut last).status, Status::Converged);
    last.1
}
