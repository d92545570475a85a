//! Verdicts where a careless one goes wrong.

use crate::common::prelude::*;
use stickslip::solver::rigid_equilibrium;

fn solve(overrides: &[&str]) -> HistoryOutcome {
    let scene = common::block(&[&["mesh.elements=[10,10]", "time.increments=10"], overrides].concat());
    common::run(&scene, &discretise(&scene).unwrap(), &mut ())
}

/// When all load is gone only rounding is left; it is judged against the history's own forces.
#[test]
fn full_unloading_converges() {
    for mu in ["contact.friction=0", "contact.friction=0.1", "contact.friction=0.4"] {
        for gap in ["contact.obstacle.gap=0", "contact.obstacle.gap=1e-5"] {
            let outcome = solve(&["load.history=[[0,0],[1,1],[2,0]]", mu, gap]);
            assert_eq!(outcome.status, Status::Converged, "{mu}, {gap}: {:?}", outcome.records.last());
        }
    }
}

/// Without load the solution is zero, and its verdict is no matter of luck.
#[test]
fn no_load_converges_to_nothing() {
    for gap in ["contact.obstacle.gap=0", "contact.obstacle.gap=1e-5"] {
        let outcome = solve(&["load.traction=[0,0]", gap]);
        assert_eq!(outcome.status, Status::Converged, "{:?}", outcome.records.last());
        assert!(outcome.state.u.iter().chain(&outcome.state.p_n).chain(&outcome.state.p_t).all(|&x| x == 0.0));
    }
}

/// The absolute stop test of the setting `paper` ends far too early under a load of 1 N/m²: then
/// the verdict says so.
#[test]
fn a_stop_test_that_is_met_too_early_is_no_convergence() {
    let outcome = solve(&["load.traction=[-1, -1]", "contact.obstacle.gap=0"]);
    assert_eq!(outcome.status, Status::Inaccurate);
    let record = outcome.records.last().unwrap();
    assert!(record.theta <= 1e-2 && record.kkt.worst().1 > 1e-10, "{record:?}");
}

const CORNER: &str = r#"
    mesh = { kind = "block", size = [1.0, 1.0], elements = [6, 6] }
    material = { young = 210e9, poisson = 0.3 }
    contact = [
        { boundary = "bottom", friction = 0.4, obstacle = { kind = "plane" } },
        { boundary = "right", friction = 0.2, obstacle = { kind = "plane" } },
    ]
    load = [
        { boundary = "top", traction = [0, -8e6] },
        { boundary = "left", traction = [6e6, 0] },
    ]
    time = { end = 1, increments = 4 }
"#;

/// A body pressed into a corner, held by contact alone; the corner node meets two obstacles.
#[test]
fn a_block_in_a_corner() {
    let scene = parsed(CORNER);
    let model = discretise(&scene).unwrap();
    assert_eq!((model.constraints.rigid_motions.len(), model.contact.nodes.len()), (3, 14));
    let outcome = common::run(&scene, &model, &mut ());
    assert_eq!(outcome.status, Status::Converged, "{:?}", outcome.records.last());
    assert_eq!((outcome.layout.contacts(), outcome.layout.tangentials()), (14, 14));
    // Global equilibrium: the bottom's tangent is +x, the right side's is +y.
    let sum = |forces: &[f64], nodes: std::ops::Range<usize>| forces[nodes].iter().sum::<f64>();
    let (p_n, p_t) = (&outcome.state.p_n, &outcome.state.p_t);
    let x = 6e6 - sum(p_n, 7..14) - sum(p_t, 0..7);
    let y = -8e6 + sum(p_n, 0..7) - sum(p_t, 7..14);
    assert!(x.abs() < 1e-2 && y.abs() < 1e-2, "{x} {y}");
}

/// The corner with its wall so far away that the block has to slide to it: 6 MN push against at most 0.4 · 8 MN.
fn towards_a_wall(wall: f64, setting: &str) -> (Model, HistoryOutcome) {
    let overrides = [format!("contact[1].obstacle.gap={wall}"), format!("solver.setting={setting}")];
    let overrides = overrides.map(|text| text.parse().unwrap());
    let scene = Scene::parse("slide.toml", CORNER, &overrides).unwrap();
    let model = discretise(&scene).unwrap();
    let outcome = common::run(&scene, &model, &mut ());
    (model, outcome)
}

/// The free motion that a verdict blames, without the sign of its direction.
fn blamed(model: &Model, outcome: &HistoryOutcome) -> String {
    let weights = outcome.free_motion.as_ref().unwrap();
    let motion =
        stickslip::body::constraints::RigidMotion::combination(&model.constraints.rigid_motions, weights).unwrap();
    motion.to_string().replace('-', "")
}

/// However far the wall is, there the block comes to rest, and its forces are what they are at a wall that is near.
#[test]
fn sliding_to_a_wall_is_an_equilibrium() {
    for setting in ["default", "paper"] {
        let (model, outcome) = towards_a_wall(1.0, setting);
        assert_eq!(outcome.status, Status::Converged, "{setting}: {:?}", outcome.records.last());
        assert_eq!(outcome.records.len(), 4);
        let u = model.constraints.dofs.displacements(&outcome.state.u);
        assert!(u.into_iter().all(|u| (u[0] - 1.0).abs() < 1e-3));
        let (_, near) = towards_a_wall(1e-3, setting);
        assert!(apart(&outcome.state.p_n, &near.state.p_n) < 1e-9, "{setting}");
    }
}

/// A cube of one element on a floor, its left side before a wall, pulled off that: the load comes down on the edge that
/// both share, so friction at right angles to the edge would have to carry it, and the equations are without.
#[test]
fn a_balance_across_an_edge_is_not_denied() {
    let scene = |pull: f64| {
        let text = format!(
            r#"
            mesh = {{ kind = "block", size = [1.0, 1.0, 1.0], elements = [1, 1, 1] }}
            material = {{ young = 1e9, poisson = 0.3 }}
            contact = [
                {{ boundary = "bottom", friction = 0.5, obstacle = {{ kind = "plane" }} }},
                {{ boundary = "left", friction = 0.5, obstacle = {{ kind = "plane" }} }},
            ]
            load = [{{ boundary = "left", traction = [{pull:e}, 0, -1e5] }}]
            time = {{ end = 1, increments = 2 }}
            "#
        );
        parsed(&text)
    };
    let outcome = |pull: f64, linear: LinearAlgebra| {
        let scene = scene(pull);
        let model = discretise(&scene).unwrap();
        let settings = settings_of(&model, Method::BN);
        let outcome = history_of(&model, model.times(), &settings, linear, &mut ());
        (outcome.status, outcome.records.len(), outcome.free_motion.is_some())
    };
    for linear in both() {
        assert_eq!(outcome(0.45e5, linear), (Status::Converged, 2, false));
        // More than all friction there is.
        assert_eq!(outcome(0.55e5, linear), (Status::Slips, 1, true));
    }
    let model = discretise(&scene(0.45e5)).unwrap();
    let force = model.loading.force_at(1.0, &model.problem).unwrap();
    assert_eq!(rigid_equilibrium(&model.problem, &force), Ok(None));
}

/// A free motion that contact cannot stop ends the run and is named.
#[test]
fn sliding_away_is_a_slip() {
    let wall = "        { boundary = \"right\", friction = 0.2, obstacle = { kind = \"plane\" } },\n";
    let scene = parsed(&common::edit(CORNER, wall, ""));
    let model = discretise(&scene).unwrap();
    let outcome = common::run(&scene, &model, &mut ());
    assert_eq!(outcome.status, Status::Slips, "{:?}", outcome.records.last());
    // Every force that the plane can take resists it by nothing or pushes along: (1, mu), of unit length.
    assert_eq!(blamed(&model, &outcome), "a translation along (0.928477, 0.371391)");
}

/// No displacement brings a held node out of an obstacle that moves in: refused, not overlooked.
#[test]
fn an_obstacle_must_not_move_into_a_held_node() {
    let approach = "contact.obstacle.approach=[[0, 0], [1, 2e-5]]";
    let error = discretise(&common::block(&[approach])).unwrap_err().to_string();
    assert!(error.contains("supports hold the body where the obstacle"), "{error}");
    // Just touching the clamped corner is allowed.
    assert!(discretise(&common::block(&[&approach.replace("2e-5", "1e-5")])).is_ok());
}

/// An obstacle on the wrong side of the boundary would never be touched: it is refused.
#[test]
fn an_obstacle_must_face_the_boundary() {
    for normal in ["[0, 1]", "[1, 0]"] {
        let scene = common::block(&[&format!("contact.obstacle.normal={normal}")]);
        let error = discretise(&scene).unwrap_err().to_string();
        assert!(error.contains("block.toml (with --set):23: the normal of the obstacle"), "{error}");
    }
}
