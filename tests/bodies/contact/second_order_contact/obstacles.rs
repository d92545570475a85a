//! Obstacles that are curved, move or end, and supports that move corners.

use super::{lines, solve, sums};
use crate::common::prelude::*;
use stickslip::body::Term;

/// The distances of the nodes in the rows of a contact node from its obstacle, by what supports and unknowns make of them.
fn distances(contact: &ContactNode, u: &[[f64; 3]], gap: &dyn Fn(&Term) -> f64) -> Vec<f64> {
    contact.terms().map(|term| gap(&term) - dot(u[term.node], term.facing.normal)).collect()
}

/// Supports hold and move the ends of the boundary: what they prescribe is in the rows beside them, and their forces balance.
#[test]
fn corners_that_supports_move() {
    let text = scene! { r#"
[mesh] kind = "block", size = [1, 0.5], elements = [4, 2], cells = "triangle6"
[material] young = 1.0, poisson = 0.3
[[support]] boundary = "left", fix = ["x", "y"], displacement = [0.0, -2e-3]
[[support]] boundary = "right", fix = ["x", "y"], displacement = [1e-3, -5e-4]
[[contact]] boundary = "bottom", friction = 0.3, obstacle = { kind = "plane", gap = 2e-3 }
[[load]] boundary = "top", traction = [0.0, -0.002]
[time] end = 1.0, increments = 3
"# };
    let scene = parsed(&text);
    let model = discretise(&scene).unwrap();
    let held_ends = model.contact.nodes.iter().flat_map(|contact| contact.ends.iter().flatten());
    let corners = [0.0, 1.0].map(|x| held_ends.clone().filter(|end| end.position[0] == x).count());
    assert_eq!(corners, [1, 1]);
    assert!(model.contact.nodes.iter().all(|contact| (1e-9..1.0 - 1e-9).contains(&contact.position[0])));
    let mut keep = Keep::default();
    for linear in both() {
        let state =
            solve(&model, model.times(), SolverChoice { linear: Some(linear), ..SolverChoice::default() }, &mut keep)
                .state;
        let u = model.displacements(1.0, &state.u).unwrap();
        assert_eq!(u[0], [0.0, -2e-3, 0.0]);
        let mut closed = 0;
        for (contact, p_n) in model.contact.nodes.iter().zip(&state.p_n) {
            let d = distances(contact, &u, &|_| 2e-3);
            let of_rows: f64 = contact.terms().zip(&d).map(|(term, d)| term.coefficient * d).sum();
            assert!(of_rows > -1e-12 && d[0] > -1e-12, "{of_rows:e}");
            assert!(p_n.min(of_rows / 2e-3).abs() < 1e-9, "{p_n:e} {of_rows:e}");
            closed += usize::from(*p_n > 0.0);
        }
        assert!((2..model.contact.nodes.len()).contains(&closed), "{closed}");
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
        let scene = parsed(&text);
        let model = discretise(&scene).unwrap();
        let mut keep = Keep::default();
        solve(&model, model.times(), SolverChoice::default(), &mut keep);
        for (state, t) in keep.states.iter().zip(model.times()) {
            let u = model.displacements(*t, &state.u).unwrap();
            let centre = [0.36 + 0.3 * (t - 1.0).max(0.0), 0.7 - 0.01 * t.min(1.0), 0.0];
            let largest = state.p_n.iter().copied().fold(0.0, f64::max);
            let mut closed = 0;
            for (i, contact) in model.contact.nodes.iter().enumerate() {
                // Along the line from the node to the circle.
                let along = |term: &Term| {
                    let (x, n) = (term.position, term.facing.normal);
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
    let text = scene! { r#"
[mesh] kind = "block", size = [1, 1], elements = [1, 1]
[material] young = 1.0, poisson = 0.3
[[support]] point = [0.6, 0], fix = ["y"]
[[support]] point = [-0.6, 0], fix = ["y"]
[[support]] point = [0, 0.6], fix = ["x"]
[[contact]] boundary = "outer", friction = 0.0
obstacle = { kind = "bore", radius = 1.0, apex = [0, 1], normal = [0, 1], direction = "nearest" }
[[load]] boundary = "inner", pressure = 1e-3
[time] end = 1.0, increments = 1
"# };
    let mut scene = parsed(&text);
    scene.description.mesh = MeshSource::from(mesh);
    let model = discretise(&scene).unwrap();
    let (_, lines) = lines(&model, &[1.0], SolverChoice::default());
    // Lamé in plane strain: nothing moves at the outside. With σ_r = A - B / r², u_r = ((1 - 2ν) A r + B / r) (1 + ν) / E.
    let (a2, nu) = (0.36, 0.3);
    let ratio = -(1.0 - 2.0 * nu);
    let a = -1e-3 / (1.0 - ratio / a2);
    let outside = -(a - ratio * a);
    for point in &lines[0].points {
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

/// An obstacle that is smaller than the boundary: where the end of an edge is not in front of it the gap of the row is that of the node.
#[test]
fn rims_of_obstacles() {
    let text = "[mesh]\nkind = \"block\"\nsize = [1, 1, 0.5]\nelements = [4, 4, 1]\ncells = \"tetrahedron10\"\n\
         [material]\nyoung = 1.0\npoisson = 0.3\n\
         [[support]]\nboundary = \"bottom\"\nfix = [\"x\", \"y\", \"z\"]\n\
         [[contact]]\nboundary = \"top\"\nfriction = 0.2\n\
         obstacle = { kind = \"sphere\", radius = 0.3, apex = [0.5, 0.5, 0.5], approach = [[0, 0], [1, 0.01]] }\n\
         [time]\nend = 1.0\nincrements = 2\n";
    let scene = parsed(text);
    let model = discretise(&scene).unwrap();
    let exact = |x: [f64; 3]| 0.3 - (0.09 - (x[0] - 0.5).powi(2) - (x[1] - 0.5).powi(2)).sqrt();
    let gaps = model.loading.gaps_at(0.0);
    let mut isolated = 0;
    for (contact, gap) in model.contact.nodes.iter().zip(&gaps) {
        let all: Vec<f64> = contact.terms().map(|term| exact(term.position)).collect();
        let of_rows: f64 = contact.terms().zip(&all).map(|(term, gap)| term.coefficient * gap).sum();
        let expected = if of_rows.is_nan() { all[0] } else { of_rows };
        isolated += usize::from(of_rows.is_nan());
        assert!((gap - expected).abs() < 1e-14, "{gap} {expected}");
    }
    assert!(isolated > 2, "{isolated}");
    assert!(model.contact.boundaries[0].unreached > 0);
    let state = solve(&model, model.times(), SolverChoice::default(), &mut ()).state;
    assert!(sums(&state)[0] > 0.0);
}

/// Triangles and quadrilaterals of second order share the displacements of an edge differently among its nodes: prisms have
/// contact on the one or on the other.
#[test]
fn triangles_and_quadrilaterals_of_second_order_do_not_meet() {
    let text = |side: &str| {
        format!(
            "[mesh]\nkind = \"block\"\nsize = [1, 1, 0.5]\nelements = [2, 2, 1]\ncells = \"prism15\"\n\
             [material]\nyoung = 1.0\npoisson = 0.3\n\
             [[contact]]\nboundary = \"bottom\"\nfriction = 0\nobstacle = {{ kind = \"plane\", gap = 0 }}\n\
             [[contact]]\nboundary = \"{side}\"\nfriction = 0\nobstacle = {{ kind = \"plane\", gap = 0 }}\n\
             [time]\nend = 1\nincrements = 1\n"
        )
    };
    assert!(discretise(&parsed(&text("top"))).is_ok());
    let error = discretise(&parsed(&text("left"))).unwrap_err();
    assert!(error.to_string().contains("a triangle and a quadrilateral of second order with contact meet"), "{error}");
}

/// Glue has a row of its own for each pair, so that prisms of second order may be periodic along two axes, across triangles and
/// quadrilaterals. The strains are uniform: 5.86 mm for 1 m under traction, and the period keeps its length.
#[test]
fn prisms_of_second_order_are_periodic_along_two_axes() {
    let (young, poisson, traction): (f64, f64, [f64; 3]) = (1e6, 0.3, [100.0, 100.0, 200.0]);
    let shear = young / (2.0 * (1.0 + poisson));
    let axial = young * (1.0 - poisson) / ((1.0 + poisson) * (1.0 - 2.0 * poisson));
    let expected = (traction[1] / axial).hypot(traction[0] / shear).hypot(traction[2] / shear);
    for cells in ["prism15", "hexahedron20"] {
        let text = format!(
            "[mesh]\nkind = \"block\"\nsize = [1, 1, 1]\nelements = [3, 3, 2]\ncells = \"{cells}\"\n\
             [material]\nyoung = {young:e}\npoisson = {poisson}\n\
             [[contact]]\nboundary = \"left\"\nagainst = \"right\"\nglue = true\nshift = [-1, 0, 0]\n\
             [[contact]]\nboundary = \"bottom\"\nagainst = \"top\"\nglue = true\nshift = [0, 0, -1]\n\
             [[support]]\nboundary = \"front\"\nfix = [\"x\", \"y\", \"z\"]\n\
             [[load]]\nboundary = \"back\"\ntraction = {traction:?}\nhistory = [[0, 0], [1, 1]]\n\
             [time]\nend = 1\nincrements = 1\n"
        );
        let report = Run::new(&parsed(&text)).unwrap().solve(&mut ()).unwrap();
        let length = report.largest_displacement.unwrap().length;
        assert!((length / expected - 1.0).abs() < 1e-9, "{cells}: {length}, expected {expected}");
    }
}
