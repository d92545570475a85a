//! Contact on boundaries of second order: the law for Bernstein's polynomials, three nodes a row at the middles of edges.
#![allow(clippy::unwrap_used)]

use crate::common::{Keep, difference};
use stickslip::contact::ContactNode;
use stickslip::contact::ContactStatus;
use stickslip::history::{HistoryOutcome, LinearAlgebra, Method, Observer, Solver, Status, Step};
use stickslip::linear::{SparseCholesky, SparseLu};
use stickslip::mesh::{Boundary, Cell, CellKind, Mesh, MeshSource};
use stickslip::model::Model;
use stickslip::nonlinear::Flow;
use stickslip::problem::State;
use stickslip::report::ContactLine;
use stickslip::run::Run;
use stickslip::scene::Scene;
use stickslip::vector::{dot, norm};

/// A block of the given cells on its base under a formula of the gap on its top; `more` are further tables.
fn pressed(cells: &str, elements: &str, friction: f64, formula: &str, more: &str) -> Scene {
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
    Scene::parse("pressed.toml", &text, &[]).unwrap()
}

fn solve(model: &Model, times: &[f64], solver: Solver, observer: &mut dyn Observer) -> HistoryOutcome {
    let outcome = Run::of(model, times.to_vec(), solver).unwrap().history(observer).unwrap();
    assert_eq!(outcome.status, Status::Converged, "{solver:?}");
    outcome
}

/// The sums of the normal forces and of the sizes of the tangential ones.
fn sums(state: &State) -> [f64; 2] {
    [state.p_n.iter().sum(), state.p_t.iter().zip(&state.p_o).map(|(t, o)| t.hypot(*o)).sum()]
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
        let model = Model::new(&scene).unwrap();
        let found = sums(&solve(&model, &[1.0], Solver::default(), &mut ()).state);
        for (found, expected) in found.into_iter().zip(expected) {
            assert!((found - expected).abs() <= 2e-10 * expected.abs(), "{cells} {mu}: {found:.10e} {expected:.10e}");
        }
    }
}

/// A rectangle with the lines `xs` and `ys` of which each square is cut in two, by turns one way and the other.
fn alternating(xs: &[f64], ys: &[f64]) -> Mesh {
    let n = xs.len();
    let nodes: Vec<[f64; 3]> = ys.iter().flat_map(|&y| xs.iter().map(move |&x| [x, y, 0.0])).collect();
    let mut cells = Vec::new();
    for (i, j) in (0..ys.len() - 1).flat_map(|j| (0..n - 1).map(move |i| (i, j))) {
        let [a, b, c, d] = [j * n + i, j * n + i + 1, (j + 1) * n + i + 1, (j + 1) * n + i];
        let halves = if (i + j) % 2 == 0 { [[a, b, c], [a, c, d]] } else { [[a, b, d], [b, c, d]] };
        cells.extend(halves.map(|nodes| Cell { kind: CellKind::Triangle, nodes: nodes.to_vec(), group: 0 }));
    }
    let edges = |k: &dyn Fn(usize) -> usize| (0..n - 1).map(|i| vec![k(i), k(i + 1)]).collect();
    let top = (ys.len() - 1) * n;
    let boundaries = vec![
        Boundary { name: "bottom".into(), facets: edges(&|i| i) },
        Boundary { name: "top".into(), facets: edges(&|i| top + i) },
    ];
    Mesh::new(nodes, cells, Vec::new(), boundaries).unwrap()
}

/// `n` equal lengths up to `zone`, then `n` more, at least three, in geometric progression up to 1.
fn graded(n: usize, zone: f64, end: f64) -> Vec<f64> {
    let (h, k) = (zone / n as f64, n.max(3));
    let sum = |q: f64| (1..=k).map(|i| h * q.powi(i as i32)).sum::<f64>();
    let (mut low, mut high) = (1.0, 50.0);
    for _ in 0..200 {
        let middle = 0.5 * (low + high);
        *(if sum(middle) > end - zone { &mut high } else { &mut low }) = middle;
    }
    let mut lines: Vec<f64> = (0..=n).map(|i| zone * i as f64 / n as f64).collect();
    let mut at = zone;
    for i in 0..k {
        at += h * low.powi(i as i32 + 1);
        lines.push(at);
    }
    lines
}

/// Keeps to `name` what of the top is within `zone` of the axis.
fn keep_zone(mesh: &mut Mesh, name: &str, zone: f64) {
    let facets = mesh.boundary("top").unwrap().facets.clone();
    let d = mesh.dimension - 1;
    let inside = |facet: &Vec<usize>| facet.iter().all(|&k| mesh.nodes[k][..d].iter().all(|c| c.abs() < 1.0001 * zone));
    let facets = facets.into_iter().filter(inside).collect();
    mesh.boundaries.push(Boundary { name: name.into(), facets });
}

/// A cylinder on a half-plane: the force as another program finds it on the same mesh, the stresses at the nodes near Hertz'.
#[test]
fn hertz_line_of_second_order() {
    for (n, force) in [(4, 3.811_741_265_8e-4), (8, 3.780_432_604_0e-4)] {
        let right = graded(n, 0.03, 1.0);
        let xs: Vec<f64> = right.iter().skip(1).rev().map(|x| -x).chain(right.iter().copied()).collect();
        let ys: Vec<f64> = right.iter().rev().map(|y| -y).collect();
        let mut mesh = alternating(&xs, &ys).into_second_order();
        keep_zone(&mut mesh, "zone", 0.03);
        let mut scene = pressed("triangle6", "[1, 1]", 0.0, "0.5 * x^2 - 0.001", "");
        scene.description.mesh = MeshSource::from(mesh);
        scene.description.contacts[0].boundary = "zone".into();
        let model = Model::new(&scene).unwrap();
        let mut lines = Lines(&model, Vec::new());
        let found = sums(&solve(&model, &[1.0], Solver::default(), &mut lines).state)[0];
        assert!((found / force - 1.0).abs() < 1e-9, "{n}: {found:.10e}");
        let (a, p0) = {
            let modulus = 1.0 / 0.91;
            let a = (4.0 * found / (std::f64::consts::PI * modulus)).sqrt();
            (a, 2.0 * found / (std::f64::consts::PI * a))
        };
        let off = lines.1[0].points.iter().filter(|p| p.x.abs() < 0.8 * a).map(|p| {
            let exact = p0 * (1.0 - (p.x / a).powi(2)).sqrt();
            (p.sigma_n - exact).abs() / p0
        });
        let worst = off.fold(0.0, f64::max);
        assert!(worst < 0.03, "{n}: {worst}");
    }
}

/// Keeps the contact lines.
struct Lines<'a>(&'a Model, Vec<ContactLine>);

impl Observer for Lines<'_> {
    fn increment(&mut self, step: &Step<'_>) -> Flow {
        self.1.extend(ContactLine::all(self.0, step));
        Flow::Continue
    }
}

/// A quarter of a block of tetrahedra under a punch or a sphere, whose zone is fine: the forces as another program finds them. No corner
/// opens under the flat punch, and the corrected stresses under the sphere are near Hertz'.
#[test]
fn hertz_sphere_and_flat_punch_of_second_order() {
    let lines = graded(4, 0.03, 0.4);
    let ratio = (lines[8] - lines[7]) / (lines[5] - lines[4]);
    let outwards = vec![1.0, ratio];
    let source = MeshSource::segmented(
        &[vec![0.03, 0.37], vec![0.03, 0.37], vec![0.37, 0.03]],
        &[vec![4, 4], vec![4, 4], vec![4, 4]],
        Some(&[outwards.clone(), outwards, vec![1.0 / ratio, 1.0]]),
        Some(CellKind::Tetrahedron10),
    );
    let mut mesh = (*source.unwrap().build().unwrap()).clone();
    keep_zone(&mut mesh, "zone", 0.03);
    let corners: Vec<usize> =
        mesh.boundary("zone").unwrap().facets.iter().flat_map(|f| f.iter().step_by(2)).copied().collect();
    let symmetric =
        "[[support]]\nboundary = \"left\"\nfix = [\"x\"]\n[[support]]\nboundary = \"front\"\nfix = [\"y\"]\n";
    for (formula, force) in [("0 * x - 1e-4", 8.763_792_915_0e-6), ("0.5 * (x^2 + y^2) - 4e-4", 1.237_097_934_2e-5)] {
        let mut scene = pressed("tetrahedron10", "[1, 1, 1]", 0.0, formula, symmetric);
        scene.description.mesh = MeshSource::from(mesh.clone());
        scene.description.contacts[0].boundary = "zone".into();
        let model = Model::new(&scene).unwrap();
        let solver = Solver { linear: Some(LinearAlgebra::condensed()), ..Solver::default() };
        let mut lines = Lines(&model, Vec::new());
        let found = 4.0 * sums(&solve(&model, &[1.0], solver, &mut lines).state)[0];
        assert!((found / force - 1.0).abs() < 1e-9, "{formula}: {found:.10e}");
        if formula.starts_with('0') && formula.contains("1e-4") {
            let inner = |x: f64| x < 0.0299;
            let open = lines.1[0]
                .points
                .iter()
                .filter(|p| corners.contains(&p.node) && inner(p.x) && inner(p.y) && p.status == ContactStatus::Open);
            assert_eq!(open.count(), 0);
            continue;
        }
        let modulus = 1.0 / 0.91;
        let a = (0.75 * found / modulus).cbrt();
        let p0 = 1.5 * found / (std::f64::consts::PI * a * a);
        let inside = lines.1[0].points.iter().filter(|p| p.x.hypot(p.y) < 0.8 * a);
        let (mut error, mut whole) = (0.0, 0.0);
        for (point, contact) in inside.map(|p| (p, model.contacts.iter().find(|c| c.node == p.node).unwrap())) {
            let exact = p0 * (1.0 - (point.x.hypot(point.y) / a).powi(2)).sqrt();
            error += contact.weight * (point.sigma_n - exact).powi(2);
            whole += contact.weight * exact * exact;
        }
        let rms = f64::sqrt(error / whole);
        assert!(rms < 0.028, "{rms}");
    }
}

/// A block that is pressed and then pushed, so that nodes open, stick and slip.
fn pushed(cells: &str, elements: &str) -> (Scene, Model, Vec<f64>) {
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
    scene.description.springs.push(stickslip::description::Bed::Axes {
        at: stickslip::description::Where::Boundary("bottom".into()),
        stiffness: axes,
    });
    let times = stickslip::timeline::equal_increments(3.0, 6);
    scene.description.times.clone_from(&times);
    let model = Model::build(&scene.description).unwrap();
    (scene, model, times)
}

/// Every linear algebra and both methods, with rows that hang together from node to node.
#[test]
fn all_ways_agree() {
    for (cells, elements) in [("triangle6", "[6, 3]"), ("tetrahedron10", "[3, 2, 1]")] {
        let (_, model, times) = pushed(cells, elements);
        assert!(model.contacts.iter().filter(|contact| contact.ends.is_some()).count() > 5);
        let states = |method: Method, linear: LinearAlgebra| {
            let mut keep = Keep::default();
            let outcome = solve(&model, &times, Solver { linear: Some(linear), ..Solver::new(method) }, &mut keep);
            assert!(outcome.linear.worst_backward_error < 1e-13, "{:e}", outcome.linear.worst_backward_error);
            keep.states
        };
        let reference = states(Method::BN, LinearAlgebra::Whole(SparseLu::Umfpack));
        // Friction and normal forces come and go.
        let slid = reference.iter().any(|state| sums(state)[1] > 1e-3);
        let opened = reference.iter().flat_map(|state| &state.p_n).any(|p| *p == 0.0);
        assert!(slid && opened, "{:?}", reference.iter().map(sums).collect::<Vec<_>>());
        for (method, linear) in [
            (Method::BN, LinearAlgebra::Whole(SparseLu::Faer)),
            (Method::BN, LinearAlgebra::Condensed(SparseCholesky::Cholmod)),
            (Method::BN, LinearAlgebra::Condensed(SparseCholesky::Faer)),
            (Method::IP, LinearAlgebra::Whole(SparseLu::Umfpack)),
            (Method::IP, LinearAlgebra::Condensed(SparseCholesky::Cholmod)),
        ] {
            let off = difference(&reference, &states(method, linear));
            assert!(off < 1e-9, "{cells} {method:?} {linear:?}: {off:e}");
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
        let states = [LinearAlgebra::default(), LinearAlgebra::condensed()].map(|linear| {
            let mut keep = Keep::default();
            solve(&model, &[1.0], Solver { linear: Some(linear), ..Solver::default() }, &mut keep);
            keep.states
        });
        assert!((sums(&states[0][0])[0] - 0.02).abs() < 1e-12);
        let pressures =
            |state: &State| model.contacts.iter().zip(&state.p_n).map(|(c, p)| p / c.weight).collect::<Vec<_>>();
        for state in states.iter().flatten() {
            assert!(pressures(state).iter().all(|p| (p / 0.02 - 1.0).abs() < 1e-9), "{cells}: {:?}", pressures(state));
        }
    }
}

/// A block pressed into the corner of two planes: both have the pressure of the load at all nodes, those of the edge that they share
/// included, which carry friction along it alone.
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
        let scene = Scene::parse("corner.toml", &text, &[]).unwrap();
        let model = Model::new(&scene).unwrap();
        let shared = |contact: &ContactNode| contact.position[0] == 1.0 && contact.position[d - 1] == 0.0;
        let edge: Vec<&ContactNode> = model.contacts.iter().filter(|contact| shared(contact)).collect();
        assert_eq!(edge.len(), if d == 2 { 2 } else { 10 });
        // At the end that a support holds there is none.
        let along = edge.iter().filter(|contact| !contact.tangents[0].is_empty()).count();
        assert_eq!(along, if d == 2 { 0 } else { 4 });
        for linear in [LinearAlgebra::default(), LinearAlgebra::condensed()] {
            let state = solve(&model, &[1.0], Solver { linear: Some(linear), ..Solver::default() }, &mut ()).state;
            for (contact, p) in model.contacts.iter().zip(&state.p_n) {
                let pressure = if contact.facing.normal[0] == 1.0 { 0.01 } else { 0.02 };
                // Friction takes a little off.
                assert!((p / contact.weight / pressure - 1.0).abs() < 0.02, "{cells} {linear:?}: {p} of {contact:?}");
            }
        }
    }
}

/// The distances of the nodes in the rows of a contact node from its obstacle, by what supports and unknowns make of them.
fn distances(contact: &ContactNode, u: &[[f64; 3]], gap: &dyn Fn([f64; 3]) -> f64) -> Vec<f64> {
    contact.terms().map(|term| gap(term.position) - dot(u[term.node], contact.facing.normal)).collect()
}

/// Supports hold and move the ends of the boundary: what they prescribe is in the rows beside them, and their forces balance.
#[test]
fn corners_that_supports_move() {
    let text = r#"
        [mesh]
        kind = "block"
        size = [1, 0.5]
        elements = [4, 2]
        cells = "triangle6"
        [material]
        young = 1.0
        poisson = 0.3
        [[support]]
        boundary = "left"
        fix = ["x", "y"]
        displacement = [0.0, -2e-3]
        [[support]]
        boundary = "right"
        fix = ["x", "y"]
        displacement = [1e-3, -5e-4]
        [[contact]]
        boundary = "bottom"
        friction = 0.3
        obstacle = { kind = "plane", gap = 2e-3 }
        [[load]]
        boundary = "top"
        traction = [0.0, -0.002]
        [time]
        end = 1.0
        increments = 3
    "#;
    let scene = Scene::parse("moved.toml", text, &[]).unwrap();
    let model = Model::new(&scene).unwrap();
    let held_ends = model.contacts.iter().flat_map(|contact| contact.ends.iter().flatten());
    let corners = [0.0, 1.0].map(|x| held_ends.clone().filter(|end| end.position[0] == x).count());
    assert_eq!(corners, [1, 1]);
    assert!(model.contacts.iter().all(|contact| (1e-9..1.0 - 1e-9).contains(&contact.position[0])));
    let mut keep = Keep::default();
    for linear in [LinearAlgebra::default(), LinearAlgebra::condensed()] {
        let state = solve(&model, model.times(), Solver { linear: Some(linear), ..Solver::default() }, &mut keep).state;
        let u = model.displacements(1.0, &state.u).unwrap();
        assert_eq!(u[0], [0.0, -2e-3, 0.0]);
        let mut closed = 0;
        for (contact, p_n) in model.contacts.iter().zip(&state.p_n) {
            let d = distances(contact, &u, &|_| 2e-3);
            let of_rows: f64 = contact.terms().zip(&d).map(|(term, d)| term.coefficient * d).sum();
            assert!(of_rows > -1e-12 && d[0] > -1e-12, "{of_rows:e}");
            assert!(p_n.min(of_rows / 2e-3).abs() < 1e-9, "{p_n:e} {of_rows:e}");
            closed += usize::from(*p_n > 0.0);
        }
        assert!((2..model.contacts.len()).contains(&closed), "{closed}");
        let balance = model.balance(1.0, &state).unwrap();
        assert!(balance.closure < 1e-12, "{:e}", balance.closure);
    }
}

/// A cylinder that is pressed on and moves along: rows see it where it is, at all their nodes, and nodes stay out of it.
#[test]
fn a_cylinder_that_moves_along() {
    for direction in ["normal", "nearest"] {
        let text = format!(
            "[mesh]\nkind = \"block\"\nsize = [1, 0.4]\nelements = [10, 4]\ncells = \"triangle6\"\n\
             [material]\nyoung = 1.0\npoisson = 0.3\n\
             [[support]]\nboundary = \"bottom\"\nfix = [\"x\", \"y\"]\n\
             [[contact]]\nboundary = \"top\"\nfriction = 0.2\n\
             obstacle = {{ kind = \"cylinder\", radius = 0.3, apex = [0.36, 0.4], direction = \"{direction}\", \
             motion = {{ translation = [[0, 0, 0], [1, 0, -0.01], [2, 0.3, -0.01]] }} }}\n\
             [time]\nend = 2.0\nincrements = 8\n"
        );
        let scene = Scene::parse("roller.toml", &text, &[]).unwrap();
        let model = Model::new(&scene).unwrap();
        let mut keep = Keep::default();
        solve(&model, model.times(), Solver::default(), &mut keep);
        for (state, t) in keep.states.iter().zip(model.times()) {
            let u = model.displacements(*t, &state.u).unwrap();
            let centre = [0.36 + 0.3 * (t - 1.0).max(0.0), 0.7 - 0.01 * t.min(1.0), 0.0];
            let largest = state.p_n.iter().copied().fold(0.0, f64::max);
            let mut closed = 0;
            for (i, contact) in model.contacts.iter().enumerate() {
                // Along the line from the node to the circle.
                let n = contact.facing.normal;
                let along = |x: [f64; 3]| {
                    let to = [0, 1, 2].map(|c| centre[c] - x[c]);
                    let (ahead, aside) = (dot(to, n), dot(to, to) - dot(to, n).powi(2));
                    ahead - (0.09 - aside).sqrt()
                };
                let d = distances(contact, &u, &along);
                let of_rows: f64 = contact.terms().zip(&d).map(|(term, d)| term.coefficient * d).sum();
                assert!(d[0].is_nan() || d[0] > -1e-11, "{direction} at {t}: {d:?}");
                if state.p_n[i] > 1e-9 * largest {
                    closed += 1;
                    assert!(of_rows.abs() < 1e-11, "{direction} at {t}: {of_rows:e}");
                }
            }
            assert!((1..8).contains(&closed), "{direction} at {t}: {closed}");
        }
    }
}

/// A ring of curved edges in a bore: pressure makes the same contact stress everywhere, along normals of every direction.
#[test]
fn stresses_on_curved_boundaries() {
    let (n, layers) = (24, 2);
    let nodes: Vec<[f64; 3]> = (0..=layers)
        .flat_map(|j| {
            (0..n).map(move |k| {
                let (angle, r) = (std::f64::consts::TAU * k as f64 / n as f64, 0.6 + 0.4 * j as f64 / layers as f64);
                [r * angle.cos(), r * angle.sin(), 0.0]
            })
        })
        .collect();
    let at = |k: usize, j: usize| j * n + k % n;
    let cell = |nodes: [usize; 3]| Cell { kind: CellKind::Triangle, nodes: nodes.to_vec(), group: 0 };
    let cells = (0..layers).flat_map(|j| (0..n).map(move |k| (k, j))).flat_map(|(k, j)| {
        [[at(k, j), at(k, j + 1), at(k + 1, j + 1)], [at(k, j), at(k + 1, j + 1), at(k + 1, j)]].map(cell)
    });
    let ring = |name: &str, j: usize| Boundary {
        name: name.into(),
        facets: (0..n).map(|k| vec![at(k, j), at(k + 1, j)]).collect(),
    };
    let mesh = Mesh::new(nodes, cells.collect(), Vec::new(), vec![ring("inner", 0), ring("outer", layers)]).unwrap();
    let mut mesh = mesh.into_second_order();
    for (j, radius) in [(0, 0.6), (1, 1.0)] {
        for facet in mesh.boundaries[j].facets.clone() {
            let x = mesh.nodes[facet[1]];
            mesh.nodes[facet[1]] = x.map(|c| c * radius / norm(x));
        }
    }
    let text = r#"
        [mesh]
        kind = "block"
        size = [1, 1]
        elements = [1, 1]
        [material]
        young = 1.0
        poisson = 0.3
        [[support]]
        point = [0.6, 0]
        fix = ["y"]
        [[support]]
        point = [-0.6, 0]
        fix = ["y"]
        [[support]]
        point = [0, 0.6]
        fix = ["x"]
        [[contact]]
        boundary = "outer"
        friction = 0.0
        obstacle = { kind = "bore", radius = 1.0, apex = [0, 1], normal = [0, 1], direction = "nearest" }
        [[load]]
        boundary = "inner"
        pressure = 1e-3
        [time]
        end = 1.0
        increments = 1
    "#;
    let mut scene = Scene::parse("ring.toml", text, &[]).unwrap();
    scene.description.mesh = MeshSource::from(mesh);
    let model = Model::new(&scene).unwrap();
    let mut lines = Lines(&model, Vec::new());
    solve(&model, &[1.0], Solver::default(), &mut lines);
    // Lamé in plane strain: nothing moves at the outside. With σ_r = A - B / r², u_r = ((1 - 2ν) A r + B / r) (1 + ν) / E.
    let (a2, nu) = (0.36, 0.3);
    let ratio = -(1.0 - 2.0 * nu);
    let a = -1e-3 / (1.0 - ratio / a2);
    let outside = -(a - ratio * a);
    for point in &lines.1[0].points {
        assert!(
            (point.sigma_n / outside - 1.0).abs() < 5e-3,
            "{} of {outside} at {}, {}",
            point.sigma_n,
            point.x,
            point.y
        );
        assert!(point.gap.abs() < 1e-6, "{:e}", point.gap);
    }
}

/// Looks at tables.
struct Tables<'a>(&'a Model);
impl Observer for Tables<'_> {
    fn increment(&mut self, step: &Step<'_>) -> Flow {
        let u = self.0.displacements(step.record.time, &step.state.u).unwrap();
        let lines = ContactLine::all(self.0, step);
        for point in &lines[0].points {
            let [_, t, _] = point.frame;
            assert!((point.w_n - dot(u[point.node], point.frame[0])).abs() < 1e-14);
            assert!((point.w_t - dot(u[point.node], t)).abs() < 1e-14);
            assert!((point.slip_t - point.w_t).abs() < 1e-14);
            let gap = 0.02 * (point.x - 0.4).powi(2);
            assert!((point.gap - (gap - point.w_n)).abs() < 1e-14, "{point:?}");
            assert!(point.gap > -1e-12);
        }
        // In a row: from end to end, the middles between.
        assert!(lines[0].points.windows(2).all(|pair| (pair[0].x - pair[1].x).abs() < 0.1));
        Flow::Continue
    }
}

/// Displacements, gaps and slips of tables are those of the nodes, not of the rows.
#[test]
fn tables_tell_of_nodes() {
    let (_, model, times) = pushed("triangle6", "[6, 3]");
    solve(&model, &times, Solver::default(), &mut Tables(&model));
}

/// The largest pressure of a run, and the peak that its estimate is about, are those of the tables.
#[test]
fn one_peak_in_all_reports() {
    let scene = pressed("triangle6", "[8, 8]", 0.0, "0.1 * (x - 0.5)^2 - 0.01", "");
    let model = Model::new(&scene).unwrap();
    let mut lines = Lines(&model, Vec::new());
    solve(&model, &[1.0], scene.solver, &mut lines);
    let peak = lines.1[0].points.iter().map(|point| point.sigma_n).fold(0.0, f64::max);
    let mean = lines.1[0].points.iter().zip(&model.contacts).map(|(point, contact)| point.p_n / contact.weight);
    assert!(peak > 1.01 * mean.fold(0.0, f64::max));
    let report = Run::new(&scene).unwrap().solve(&mut ()).unwrap();
    let near = |pressure: f64| (pressure / peak - 1.0).abs() < 1e-9;
    assert!(near(report.largest_pressure.unwrap().pressure.unwrap()));
    assert!(near(report.estimates.contact[0].peak_pressure));
}

/// An obstacle that is smaller than the boundary: where the end of an edge is not in front of it the gap of the row is that of the node.
#[test]
fn rims_of_obstacles() {
    let text = "[mesh]\nkind = \"block\"\nsize = [1, 1, 0.5]\nelements = [4, 4, 1]\ncells = \"tetrahedron10\"\n\
         [material]\nyoung = 1.0\npoisson = 0.3\n\
         [[support]]\nboundary = \"bottom\"\nfix = [\"x\", \"y\", \"z\"]\n\
         [[contact]]\nboundary = \"top\"\nfriction = 0.2\n\
         obstacle = { kind = \"sphere\", radius = 0.3, apex = [0.5, 0.5, 0.5], approach = [[0, 0], [1, 0.01]] }\n\
         [time]\nend = 1.0\nincrements = 2\n";
    let scene = Scene::parse("sphere.toml", text, &[]).unwrap();
    let model = Model::new(&scene).unwrap();
    let exact = |x: [f64; 3]| 0.3 - (0.09 - (x[0] - 0.5).powi(2) - (x[1] - 0.5).powi(2)).sqrt();
    let gaps = model.loading.gaps_at(0.0);
    let mut alone = 0;
    for (contact, gap) in model.contacts.iter().zip(&gaps) {
        let all: Vec<f64> = contact.terms().map(|term| exact(term.position)).collect();
        let of_rows: f64 = contact.terms().zip(&all).map(|(term, gap)| term.coefficient * gap).sum();
        let expected = if of_rows.is_nan() { all[0] } else { of_rows };
        alone += usize::from(of_rows.is_nan());
        assert!((gap - expected).abs() < 1e-14, "{gap} {expected}");
    }
    assert!(alone > 2, "{alone}");
    assert!(model.contact_boundaries[0].beyond > 0);
    let state = solve(&model, model.times(), Solver::default(), &mut ()).state;
    assert!(sums(&state)[0] > 0.0);
}
