//! Contact on boundaries of second order: the law for Bernstein's polynomials, three nodes a row at the middles of edges.

mod fits;
pub(crate) mod hertz;
mod obstacles;
mod tables;

use crate::common::prelude::*;
use stickslip::solver::history::run;

/// A block of the given cells on its base under a formula of the gap on its top; `more` are further tables.
pub(super) fn pressed(cells: &str, elements: &str, friction: f64, formula: &str, more: &str) -> Scene {
    let size = if cells == "triangle6" { "[1, 1]" } else { "[1, 1, 1]" };
    let fix = if cells == "triangle6" { "[\"x\", \"y\"]" } else { "[\"x\", \"y\", \"z\"]" };
    let text = format!(
        "[mesh]\nkind = \"block\"\nsize = {size}\nelements = {elements}\ncells = \"{cells}\"\n\
         [material]\nyoung = 1.0\npoisson = 0.3\n\
         [[support]]\nboundary = \"bottom\"\nfix = {fix}\n\
         [[contact]]\nboundary = \"top\"\nfriction = {friction}\n\
         obstacle = {{ kind = \"formula\", formula = \"{formula}\" }}\n{more}\
         [time]\nend = 1.0\nincrements = 1\n"
    );
    parsed(&text)
}

pub(super) fn solve(model: &Model, times: &[f64], solver: SolverChoice, observer: &mut dyn Observer) -> HistoryOutcome {
    let outcome = Run::of(model, times.to_vec(), solver).unwrap().history(observer).unwrap();
    assert_eq!(outcome.status, Status::Converged, "{solver:?}");
    outcome
}

/// The sums of the normal forces and of the sizes of the tangential ones.
pub(super) fn sums(state: &State) -> [f64; 2] {
    [state.p_n.iter().sum(), state.p_t.iter().zip(&state.p_o).map(|(t, o)| t.hypot(*o)).sum()]
}

/// The history and its contact lines.
pub(super) fn lines(model: &Model, times: &[f64], solver: SolverChoice) -> (HistoryOutcome, Vec<ContactLine>) {
    let mut lines = Vec::new();
    let outcome = solve(model, times, solver, &mut each(|step| lines.extend(ContactLine::all(model, step))));
    (outcome, lines)
}

/// A parabola pressed into the whole top; from a program that shares nothing with this one.
#[test]
fn parabolas_on_squares_and_cubes() {
    let plane = "0.1 * (x - 0.5)^2 - 0.02";
    let space = "0.1 * ((x - 0.5)^2 + (y - 0.5)^2) - 0.02";
    for (cells, elements, formula, mu, expected) in [
        ("triangle6", "[4, 4]", plane, 0.0, [1.553_997_616_5e-2, 0.0]),
        ("triangle6", "[4, 4]", plane, 0.3, [1.557_209_424_9e-2, 1.583_467_744_8e-3]),
        ("tetrahedron10", "[2, 2, 2]", space, 0.0, [1.198_242_956_8e-2, 0.0]),
        ("tetrahedron10", "[2, 2, 2]", space, 0.3, [1.208_377_641_0e-2, 1.548_289_953_8e-3]),
    ] {
        let scene = pressed(cells, elements, mu, formula, "");
        let model = discretise(&scene).unwrap();
        let found = sums(&solve(&model, &[1.0], SolverChoice::default(), &mut ()).state);
        for (found, expected) in found.into_iter().zip(expected) {
            assert!((found - expected).abs() <= 2e-10 * expected.abs(), "{cells} {mu}: {found:.10e} {expected:.10e}");
        }
    }
}

/// A block that is pressed and then pushed, so that nodes open, stick and slip.
pub(super) fn pushed(cells: &str, elements: &str) -> (Scene, Model, Vec<f64>) {
    let (traction, push, formula) = match cells {
        "triangle6" => ("[0, 0.02]", "[0.01, 0]", "0.02 * (x - 0.4)^2"),
        _ => ("[0, 0, 0.02]", "[0.008, 0.004, 0]", "0.02 * ((x - 0.4)^2 + (y - 0.5)^2)"),
    };
    let more = format!(
        "[[load]]\nboundary = \"bottom\"\ntraction = {traction}\nhistory = [[0, 0], [1, 1], [3, 1]]\n\
         [[load]]\nboundary = \"left\"\ntraction = {push}\nhistory = [[0, 0], [1, 0], [2, 1], [3, -1]]\n"
    );
    let mut scene = pressed(cells, elements, 0.4, formula, &more);
    // Springs hold it, and contact does.
    scene.description.supports.clear();
    let axes = if cells == "triangle6" { vec![0.02; 2] } else { vec![0.02; 3] };
    scene
        .description
        .springs
        .push(stickslip::body::Bed::Axes { at: stickslip::body::Where::Boundary("bottom".into()), stiffness: axes });
    let times = stickslip::base::equal_increments(3.0, 6);
    scene.description.times.clone_from(&times);
    let model = Model::build(&scene.description).unwrap();
    (scene, model, times)
}

/// Every linear algebra and both methods, with rows that hang together from node to node.
#[test]
fn all_ways_agree() {
    for (cells, elements) in [("triangle6", "[6, 3]"), ("tetrahedron10", "[3, 2, 1]")] {
        let (_, model, times) = pushed(cells, elements);
        assert!(model.contact.nodes.iter().filter(|contact| contact.ends.is_some()).count() > 5);
        // An increment that ends at a touch is degenerate, and the interior point method's matrix nearly singular.
        for halvings in [0, 6] {
            let states = |method: Method, linear: LinearAlgebra| {
                let mut keep = Keep::default();
                let settings = SolverChoice::new(method).settings(&model.problem, &model.loading).unwrap();
                let settings = HistorySettings { halvings, ..settings };
                let system = SystemSolver::from(linear);
                let outcome = run(&model.problem, &model.loading, &times, &settings, system, &mut keep).unwrap();
                assert_eq!(outcome.status, Status::Converged, "{method:?} {linear:?}");
                let worst = outcome.linear.worst_backward_error;
                assert!(halvings > 0 || worst < 1e-13, "{method:?} {linear:?}: {worst:e}");
                keep.states
            };
            let reference = states(Method::BN, LinearAlgebra::Whole(SparseLu::default()));
            // Friction and normal forces come and go.
            let slid = reference.iter().any(|state| sums(state)[1] > 1e-3);
            let opened = reference.iter().flat_map(|state| &state.p_n).any(|p| *p == 0.0);
            assert!(slid && opened, "{:?}", reference.iter().map(sums).collect::<Vec<_>>());
            for (method, linear) in [
                (Method::BN, LinearAlgebra::Whole(SparseLu::Faer)),
                (Method::BN, LinearAlgebra::Condensed(SparseCholesky::default())),
                (Method::BN, LinearAlgebra::Condensed(SparseCholesky::Faer)),
                (Method::Ip, LinearAlgebra::Whole(SparseLu::default())),
                (Method::Ip, LinearAlgebra::Condensed(SparseCholesky::default())),
            ] {
                let off = difference(&reference, &states(method, linear));
                assert!(off < 1e-9, "{cells} {method:?} {linear:?} {halvings}: {off:e}");
            }
        }
    }
}

/// A body that only contact holds, condensed and not: springs of its own tie what contact leaves open.
#[test]
fn bodies_that_only_contact_holds() {
    for cells in ["triangle6", "tetrahedron10"] {
        let (elements, load) = match cells {
            "triangle6" => ("[3, 2]", "[0, 0.02]"),
            _ => ("[2, 2, 1]", "[0, 0, 0.02]"),
        };
        let more = format!("[[load]]\nboundary = \"bottom\"\ntraction = {load}\n");
        let mut scene = pressed(cells, elements, 0.3, "0 * x", &more);
        scene.description.supports.clear();
        scene.description.material.poisson = 0.0;
        let model = Model::build(&scene.description).unwrap();
        let states = both().map(|linear| {
            let mut keep = Keep::default();
            solve(&model, &[1.0], SolverChoice { linear: Some(linear), ..SolverChoice::default() }, &mut keep);
            keep.states
        });
        assert!((sums(&states[0][0])[0] - 0.02).abs() < 1e-12);
        let pressures =
            |state: &State| model.contact.nodes.iter().zip(&state.p_n).map(|(c, p)| p / c.weight).collect::<Vec<_>>();
        for state in states.iter().flatten() {
            assert!(pressures(state).iter().all(|p| (p / 0.02 - 1.0).abs() < 1e-9), "{cells}: {:?}", pressures(state));
        }
    }
}

/// A block pressed into the corner of two planes: both have the pressure of the load at all nodes, those of the edge that they share
/// included.
#[test]
fn a_block_in_a_corner() {
    for (cells, d) in [("triangle6", 2), ("tetrahedron10", 3)] {
        let (size, elements, down, aside, front) = match d {
            2 => ("[1, 0.5]", "[3, 2]", "[0, -0.02]", "[0.01, 0]", ""),
            _ => (
                "[1, 0.8, 0.5]",
                "[2, 2, 1]",
                "[0, 0, -0.02]",
                "[0.01, 0, 0]",
                "[[support]]\nboundary = \"front\"\nfix = [\"y\"]\n",
            ),
        };
        let text = format!(
            "[mesh]\nkind = \"block\"\nsize = {size}\nelements = {elements}\ncells = \"{cells}\"\n\
             [material]\nyoung = 1.0\npoisson = 0.0\n{front}\
             [[contact]]\nboundary = \"bottom\"\nfriction = 1e-3\nobstacle = {{ kind = \"plane\" }}\n\
             [[contact]]\nboundary = \"right\"\nfriction = 1e-3\nobstacle = {{ kind = \"plane\" }}\n\
             [[load]]\nboundary = \"top\"\ntraction = {down}\n[[load]]\nboundary = \"left\"\ntraction = {aside}\n\
             [time]\nend = 1.0\nincrements = 1\n"
        );
        let scene = parsed(&text);
        let model = discretise(&scene).unwrap();
        for linear in both() {
            let state =
                solve(&model, &[1.0], SolverChoice { linear: Some(linear), ..SolverChoice::default() }, &mut ()).state;
            for (contact, p) in model.contact.nodes.iter().zip(&state.p_n) {
                let pressure = if contact.facing.normal[0] == 1.0 { 0.01 } else { 0.02 };
                // Friction takes a little off.
                assert!((p / contact.weight / pressure - 1.0).abs() < 0.02, "{cells} {linear:?}: {p} of {contact:?}");
            }
        }
    }
}
