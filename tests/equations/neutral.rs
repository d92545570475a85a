//! Bodies that contact alone holds, on a node or along a line: whatever factors the systems, the answer is the same, and takes
//! a few iterations.

use crate::common::prelude::*;

/// A block under a load, on an obstacle that it touches in the middle of its bottom, and nothing else.
fn on_top(elements: &str, obstacle: &str, load: &str) -> Model {
    let sides = elements.split(',').count();
    let text = format!(
        r#"
        mesh = {{ kind = "block", size = {:?}, elements = [{elements}] }}
        material = {{ young = 1e9, poisson = 0.3 }}
        contact = [{{ boundary = "bottom", friction = 0.5, obstacle = {{ {obstacle} }} }}]
        load = [{load}]
        time = {{ end = 1, increments = 3 }}
        "#,
        vec![1.0; sides],
    );
    model_of(&text)
}

pub fn solve(model: &Model, method: Method, linear: LinearAlgebra) -> HistoryOutcome {
    let settings = settings_of(model, method);
    history_of(model, model.times(), &settings, linear, &mut ())
}

/// What all linear algebras agree on, in so many iterations at most.
pub fn agreed(model: &Model, method: Method, iterations: usize) -> HistoryOutcome {
    let mut first: Option<HistoryOutcome> = None;
    for (word, linear) in LinearAlgebra::WORDS.into_iter().filter(|(_, linear)| linear.is_built_in()) {
        let outcome = solve(model, method, linear);
        assert_eq!(outcome.status, Status::Converged, "{word} {method}: {:?}", outcome.records.last());
        let taken: usize = outcome.records.iter().map(|record| record.iterations).sum();
        assert!(taken <= iterations, "{word} {method}: {taken}");
        let first = first.get_or_insert_with(|| outcome.clone());
        assert!(apart(&outcome.state.p_n, &first.state.p_n) <= 1e-8, "{word} {method}");
        assert!(apart(&outcome.state.u, &first.state.u) <= 1e-6, "{word} {method}");
    }
    first.unwrap()
}

/// A block on the crest of a cylinder is free to turn about it, and balanced. The forces are those that an independent
/// calculation found.
#[test]
fn a_block_on_a_line() {
    let cylinder = "kind = \"cylinder\", radius = 1.0, apex = [0.5, 0.5, 0], normal = [0, 0, -1], axis = [0, 1, 0]";
    let model = on_top("2, 2, 2", cylinder, "{ boundary = \"top\", traction = [0, 0, -1e5] }");
    for (method, iterations) in [(Method::BN, 6), (Method::Ip, 60)] {
        let outcome = agreed(&model, method, iterations);
        let mut pressed: Vec<f64> = outcome.state.p_n.iter().copied().filter(|p| *p > 0.0).collect();
        pressed.sort_by(f64::total_cmp);
        let off = |(p, known): (&f64, f64)| (p - known).abs();
        assert_eq!(pressed.len(), 3);
        assert!(pressed.iter().zip([25434.0, 25434.0, 49133.0]).all(|pair| off(pair) < 1.0), "{pressed:?}");
        // Of all places along the free motion the one next to where it came from.
        let u = largest(&outcome.state.u);
        assert!(u < 2e-4, "{u}");
    }
}

/// On the top of a sphere it is free to turn about every axis, on that of a cylinder in the plane about one.
#[test]
fn a_block_on_a_node() {
    let sphere = "kind = \"sphere\", radius = 1.0, apex = [0.5, 0.5, 0], normal = [0, 0, -1]";
    let down = "{ boundary = \"top\", traction = [0, 0, -1e5] }";
    let outcome = agreed(&on_top("4, 4, 4", sphere, down), Method::BN, 10);
    assert_eq!(outcome.state.p_n.iter().filter(|p| **p > 0.0).count(), 1);
    let cylinder = "kind = \"cylinder\", radius = 1.0, apex = [0.5, 0]";
    let outcome = agreed(&on_top("8, 8", cylinder, "{ boundary = \"top\", traction = [0, -1e5] }"), Method::BN, 10);
    assert_eq!(outcome.state.p_n.iter().filter(|p| **p > 0.0).count(), 1);
}

/// A load beside the node rolls the block until the next one touches; both then carry it as the moments ask.
#[test]
fn a_block_that_rolls() {
    let cylinder = "kind = \"cylinder\", radius = 1.0, apex = [0.5, 0]";
    for (aside, iterations) in [(1e3, 20), (4e4, 20)] {
        let right = format!("{{ boundary = \"right\", traction = [0, -{aside:e}] }}");
        let load = format!("{{ boundary = \"top\", traction = [0, -1e5] }}, {right}");
        let model = on_top("8, 8", cylinder, &load);
        let outcome = agreed(&model, Method::BN, iterations);
        let carried = model.contact.nodes.iter().zip(&outcome.state.p_n).filter(|(_, p)| **p > 0.0);
        let carried: Vec<(f64, f64)> = carried.map(|(contact, p)| (contact.position[0], *p)).collect();
        assert_eq!(carried.len(), 2, "{carried:?}");
        let (sum, moment) = carried.iter().fold((0.0, 0.0), |(s, m), (x, p)| (s + p, m + (x - 0.5) * p));
        assert!((sum - 1e5 - aside).abs() < 1e-6 * sum && (moment - 0.5 * aside).abs() < 1e-6 * sum, "{sum} {moment}");
    }
}

/// A body without any stiffness, pressed on a floor: its force is known all the same.
#[test]
fn a_particle_on_a_floor() {
    let stiffness = Symmetric::from_triplets(1, &[(0, 0, 0.0)]).unwrap();
    let problem = ContactProblem::new(Parts::new(stiffness, Csr::from_rows(1, [[(0, -1.0)]]).unwrap())).unwrap();
    assert_eq!(problem.rigid_modes().len(), 1);
    let load = LoadCase::new(vec![-3.0], vec![[0.0, 0.0], [1.0, 1.0]]).unwrap();
    let loading = Loading::new(vec![load], vec![0.5]).unwrap();
    for (word, linear) in LinearAlgebra::WORDS.into_iter().filter(|(_, linear)| linear.is_built_in()) {
        let settings = HistorySettings::new(&problem, &loading, Method::BN).unwrap();
        let outcome = history::run(&problem, &loading, &[1.0], &settings, linear.into(), &mut ()).unwrap();
        assert_eq!(outcome.status, Status::Converged, "{word}");
        assert!((outcome.state.p_n[0] - 3.0).abs() < 1e-12 && (outcome.state.u[0] + 0.5).abs() < 1e-12, "{word}");
    }
}
