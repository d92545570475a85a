//! Friction that differs from place to place, and with time.

use crate::common::prelude::*;
use crate::contact::fronts::{divided, pushed, solved};

/// On a belt that runs, every node slides with the friction of its own place.
#[test]
fn friction_by_formula_is_that_of_each_node() {
    let formula = Formula::parse("0.1 + 0.2 * x").unwrap();
    let belt = Obstacle {
        translation: Some(vec![(0.0, [0.0, 0.0].into()), (1.0, [0.0, 0.0].into()), (2.0, [0.5, 0.0].into())]),
        ..Obstacle::plane(0.0)
    };
    let mut description =
        Description::new(MeshSource::block([1.0, 0.5], [8, 4]), Material::new(1e9, 0.3), vec![1.0, 2.0])
            .support("top", &[Axis::X])
            .load(Load::new("top", &[0.0, -1e5]).over(&[[0.0, 0.0], [1.0, 1.0], [2.0, 1.0]]))
            .contact("bottom", formula, belt);
    let (model, states) = solved(&description);
    let state = &states[1];
    for (i, contact) in model.contact.nodes.iter().enumerate() {
        let mu = 0.1 + 0.2 * contact.position[0];
        assert!((model.problem.mu()[i] - mu).abs() < 1e-15);
        assert!((state.p_t[i] + mu * state.p_n[i]).abs() < 1e-9 * 1e5, "{i}");
    }
    // The same by text, and the same number as a formula.
    let text = |mu: &str| Scene::parse("belt.toml", &BELT.replace("friction = 0.3", &format!("friction = {mu}")), &[]);
    let mu = |scene: &str| discretise(&text(scene).unwrap()).unwrap().problem.mu().to_vec();
    assert_eq!(mu("\"0.1 + 0.2 * x\""), model.problem.mu());
    assert_eq!(mu("0.25"), mu("\"1 / 4\""));
    // A coefficient below 0 is found where it is.
    description.contacts[0].friction = Formula::parse("0.125 - 2 * x").unwrap().into();
    let error = Model::build(&description).unwrap_err().to_string();
    assert!(
        error.starts_with("contact[0].friction: the friction is -0.125 at the contact node at (0.125, 0) m"),
        "{error}"
    );
}

/// Friction that grows while a belt runs: at the end of each increment every node slides with what it has then, and in the middle
/// a body that stuck lets go as friction falls. Two boundaries with histories of their own have the mean where they meet, and no
/// method knows another answer.
#[test]
fn friction_with_a_history() {
    let belt = Obstacle {
        translation: Some(vec![(0.0, [0.0, 0.0].into()), (1.0, [0.0, 0.0].into()), (3.0, [1.0, 0.0].into())]),
        ..Obstacle::plane(0.0)
    };
    let source = divided(&["one", "two"], |x| usize::from(x > 0.4));
    let mut description = Description::new(source, Material::new(1e9, 0.3), vec![1.0, 2.0, 3.0])
        .support("top", &[Axis::X])
        .load(Load::new("top", &[0.0, -1e5]).over(&[[0.0, 0.0], [1.0, 1.0], [3.0, 1.0]]))
        .contact("one", 0.2, belt.clone())
        .contact("two", 0.4, belt);
    description.contacts[0].friction_history = Some(vec![[0.0, 0.5], [2.0, 0.5], [3.0, 2.0]]);
    let expected = |t: f64, x: f64| {
        let one = if t < 2.5 { 0.1 } else { 0.4 };
        match x {
            _ if x < 0.37 => one,
            _ if x > 0.38 => 0.4,
            _ => 0.5 * (one + 0.4),
        }
    };
    let model = Model::build(&description).unwrap();
    assert!(model.problem.mu().iter().all(|mu| (mu - 0.4).abs() < 1e-15));
    for (method, linear) in [
        (Method::BN, LinearAlgebra::default()),
        (Method::BN, LinearAlgebra::condensed()),
        (Method::Ip, LinearAlgebra::condensed()),
    ] {
        let solver = solver_of(method, linear);
        let mut recording = Recording::all();
        let run = Run::of(&model, model.times().to_vec(), solver).unwrap();
        assert_eq!(run.history(&mut recording).unwrap().status, Status::Converged, "{method:?}");
        for (k, t) in [(1, 2.0), (2, 3.0)] {
            let increment = &recording.increments[k];
            for (i, contact) in model.contact.nodes.iter().enumerate() {
                let mu = expected(t, contact.position[0]);
                assert!((increment.mu[i] - mu).abs() < 1e-15, "{t} {:?}", contact.position);
                let full = mu * increment.state.p_n[i];
                assert!((increment.state.p_t[i] + full).abs() < 1e-8 * 1e5, "{method:?} {t} {:?}", contact.position);
            }
        }
    }
    // A block that is pushed sticks, and slides as friction falls: then no friction balances the push.
    let falling = |last: f64| {
        let mut pushed = pushed(MeshSource::block([1.0, 0.5], [8, 4])).contact("bottom", 0.8, Obstacle::plane(0.0));
        pushed.supports.clear();
        pushed.loads[1].history = Some(vec![[0.0, 0.0], [1.0, 0.5], [2.0, 0.5]]);
        pushed.contacts[0].friction_history = Some(vec![[1.0, 1.0], [2.0, last]]);
        let model = Model::build(&pushed).unwrap();
        let run = Run::of(&model, model.times().to_vec(), bn()).unwrap();
        let outcome = run.history(&mut ()).unwrap();
        (outcome.status, outcome.records.len())
    };
    // 0.3 MN of push on 1 MN of pressure.
    assert_eq!(falling(0.5), (Status::Converged, 4));
    assert_eq!(falling(0.25), (Status::Slips, 4));
}

/// A contact that is greased at first and at the end: without friction there, and as with hardly any. Every method and linear
/// solver finds the same.
#[test]
fn friction_that_begins_and_ends_at_zero() {
    let sums = |cells: &str, least: f64, method: &str, linear: &str| {
        let (size, elements, fix, tractions) = match cells {
            "quadrilateral" => ("[1.0, 0.5]", "[8, 4]", "[\"x\"]", ["[0, -1e6]", "[-1e6, 0]"]),
            _ => ("[1.0, 0.5, 0.5]", "[4, 2, 2]", "[\"x\", \"y\"]", ["[0, 0, -1e6]", "[-1e6, 2e5, 0]"]),
        };
        let [press, push] = tractions;
        let text = format!(
            "solver = {{ method = \"{method}\", linear = \"{linear}\" }}\n\
             time = {{ end = 4.0, increments = 12 }}\noutput = {{ times = \"all\" }}\n\
             mesh = {{ kind = \"block\", size = {size}, elements = {elements}, cells = \"{cells}\" }}\n\
             material = {{ young = 1e9, poisson = 0.3 }}\nsupport = [{{ boundary = \"left\", fix = {fix} }}]\n\
             [[contact]]\nboundary = \"bottom\"\nfriction = 0.4\nobstacle = {{ kind = \"plane\" }}\n\
             friction_history = [[0, {least:?}], [1, {least:?}], [2, 1], [3, 1], [4, {least:?}]]\n\
             [[load]]\nboundary = \"top\"\ntraction = {press}\nhistory = [[0, 0], [1, 1]]\n\
             [[load]]\nboundary = \"right\"\ntraction = {push}\nhistory = [[1.5, 0], [3, 1]]\n"
        );
        let scene = parsed(&text);
        let mut recording = Recording::default();
        let report = Run::new(&scene).unwrap().solve(&mut recording).unwrap();
        assert_eq!(report.status, Status::Converged, "{cells} {method} {linear}");
        let size = |state: &State| state.p_t.iter().zip(&state.p_o).map(|(t, o)| t.hypot(*o)).sum::<f64>();
        recording.increments.iter().map(|increment| size(&increment.state)).collect::<Vec<_>>()
    };
    for cells in ["quadrilateral", "hexahedron"] {
        let nearly = sums(cells, 1e-12, "bn", "umfpack");
        let largest = nearly.iter().copied().fold(0.0, f64::max);
        for (method, linear) in [("bn", "umfpack"), ("bn", "condensed"), ("ip", "partial"), ("ip", "faer")] {
            let found = sums(cells, 0.0, method, linear);
            assert!(found[0] <= 1e-9 * largest && found[found.len() - 1] <= 1e-9 * largest, "{found:?}");
            let off = found.iter().zip(&nearly).fold(0.0_f64, |most, (a, b)| most.max((a - b).abs()));
            assert!(largest > 1e4 && off <= 1e-8 * largest, "{cells} {method} {linear}: {off:e} of {largest:e}");
        }
    }
}
