//! Contact where the contact rows of nodes depend on each other or nearly do, and rings that contact alone holds.

use crate::common::prelude::*;
use std::f64::consts::TAU;

/// Both methods with every linear solver of this build: the largest number of iterations, and `check` of the last state.
fn by_all(model: &Model, name: &str, most: usize, check: impl Fn(&Model, &stickslip::solver::State)) {
    for method in [Method::BN, Method::Ip] {
        for (word, linear) in LinearAlgebra::WORDS.into_iter().filter(|(_, linear)| linear.is_built_in()) {
            let solver = solver_of(method, linear);
            let outcome = Run::of(model, model.times().to_vec(), solver).unwrap().history(&mut ()).unwrap();
            assert_eq!(outcome.status, Status::Converged, "{name}, {method}, {word}");
            let iterations = outcome.records.iter().map(|record| record.iterations).max().unwrap();
            assert!(iterations <= most, "{name}, {method}, {word}: {iterations}");
            check(model, &outcome.state);
        }
    }
}

/// Pressures of 10 mPa everywhere and no friction.
fn is_uniform(model: &Model, state: &stickslip::solver::State) {
    for boundary in &model.contact.boundaries {
        for (i, _) in boundary.shares(&model.contact.nodes) {
            let [p, t] = [state.p_n[i], state.p_t[i].hypot(state.p_o[i])].map(|p| p / model.contact.nodes[i].weight);
            // A floor that is a million times as stiff gives way by a millionth.
            assert!((p / 0.01 - 1.0).abs() < 2e-6 && t < 1e-8, "{}: {p} {t}", boundary.name);
        }
    }
}

/// Two glued blocks side by side, pressed on one floor: rigid or a body, in the plane and in space, with meshes that match at the
/// seam and that do not.
#[test]
fn glued_blocks_on_one_floor() {
    for (space, cells, [a, b], elastic) in [
        (false, "quadrilateral", [3, 3], true),
        (false, "quadrilateral", [3, 3], false),
        (false, "quadrilateral", [4, 3], false),
        (false, "quadrilateral8", [3, 3], true),
        (false, "quadrilateral8", [3, 2], false),
        (false, "triangle6", [3, 3], false),
        (true, "tetrahedron", [3, 3], false),
        (true, "tetrahedron", [3, 2], false),
        (true, "hexahedron", [4, 3], false),
        (true, "hexahedron20", [2, 2], false),
        (true, "tetrahedron10", [2, 2], false),
    ] {
        let (size, at, fix, press, left) = if space {
            (
                "[1, 1, 1]",
                "[1, 0, 0]",
                "[\"x\", \"y\", \"z\"]",
                "[0, 0, -0.01]",
                [format!("[{a}, {a}, {a}]"), format!("[{b}, {b}, {b}]")],
            )
        } else {
            ("[1, 1]", "[1, 0]", "[\"x\", \"y\"]", "[0, -0.01]", [format!("[{a}, {a}]"), format!("[{b}, {b}]")])
        };
        let body = |name: &str, at: &str, elements: &str| {
            format!(
                "[[body]]\nname = \"{name}\"\n{at}mesh = {{ kind = \"block\", cells = \"{cells}\", size = {size}, elements = {elements} }}\n\
                 material = {{ young = 1, poisson = 0 }}\n[[support]]\nboundary = \"{name}:top\"\nfix = {fix}\n\
                 displacement = {press}\n"
            )
        };
        let floor = "[[body]]\nname = \"floor\"\nat = [-0.5, -1]\nmesh = { kind = \"block\", size = [3, 1], elements = [7, 2] }\n\
                     material = { young = 1e6, poisson = 0 }\n[[support]]\nboundary = \"floor:bottom\"\nfix = [\"x\", \"y\"]\n";
        let opposite = if elastic { "against = \"floor:top\"" } else { "obstacle = { kind = \"plane\" }" };
        let contact = |name: &str| format!("[[contact]]\nboundary = \"{name}:bottom\"\nfriction = 0.3\n{opposite}\n");
        let text = [
            body("a", "", &left[0]),
            body("b", &format!("at = {at}\n"), &left[1]),
            if elastic { floor.to_string() } else { String::new() },
            "[[contact]]\nboundary = \"a:right\"\nagainst = \"b:left\"\nglue = true\n".to_string(),
            contact("a"),
            contact("b"),
            "[time]\nend = 1\nincrements = 1\n".to_string(),
        ]
        .concat();
        let name = format!("{cells} {a} {b} {elastic}");
        let model = model_of(&text);
        by_all(&model, &name, 10, is_uniform);
    }
}

/// A periodic block, one element high, and one that is periodic both ways.
#[test]
fn a_period_over_an_obstacle() {
    for (size, elements, shifts) in [
        ("[1, 1]", "[3, 1]", vec![("right", "left", "[1, 0]")]),
        ("[1, 1, 1]", "[3, 3, 1]", vec![("right", "left", "[1, 0, 0]")]),
        ("[1, 1, 1]", "[2, 2, 2]", vec![("right", "left", "[1, 0, 0]"), ("back", "front", "[0, 1, 0]")]),
        ("[1, 1, 1]", "[2, 2, 2]", vec![("back", "front", "[0, 1, 0]"), ("right", "left", "[1, 0, 0]")]),
    ] {
        let space = shifts[0].2.len() > 6;
        let (fix, press) = if space { ("\"x\", \"y\", \"z\"", "0, 0, -0.01") } else { ("\"x\", \"y\"", "0, -0.01") };
        let glued = |(boundary, against, shift): &(&str, &str, &str)| {
            format!("[[contact]]\nboundary = \"{boundary}\"\nagainst = \"{against}\"\nglue = true\nshift = {shift}\n")
        };
        for cells in
            if space { vec!["hexahedron", "hexahedron20", "tetrahedron10"] } else { vec!["quadrilateral", "triangle6"] }
        {
            let text = format!(
                "[mesh]\nkind = \"block\"\ncells = \"{cells}\"\nsize = {size}\nelements = {elements}\n[material]\nyoung = 1\npoisson = 0\n\
                 [[contact]]\nboundary = \"bottom\"\nfriction = 0.3\nobstacle = {{ kind = \"plane\" }}\n{}\
                 [[support]]\nboundary = \"top\"\nfix = [{fix}]\ndisplacement = [{press}]\n[time]\nend = 1\nincrements = 1\n",
                shifts.iter().map(glued).collect::<String>()
            );
            let model = model_of(&text);
            by_all(&model, &format!("{cells} {shifts:?}"), 10, is_uniform);
        }
    }
}

/// A ring of `n` elements around and two across.
fn ring(kind: CellKind, [from, to]: [f64; 2], n: usize) -> Mesh {
    let mut grid = block(&[1.0, 1.0], &[2, n]);
    if kind.is_simplex() {
        grid = grid.into_simplices();
    }
    if kind.is_quadratic() {
        grid = grid.into_second_order();
    }
    let joins: Vec<usize> = (0..grid.nodes.len())
        .map(|i| {
            let [s, t, _] = grid.nodes[i];
            let first = |x: &[f64; 3]| x[1] == 0.0 && (x[0] - s).abs() < 1e-12;
            if t == 1.0 { grid.nodes.iter().position(first).unwrap() } else { i }
        })
        .collect();
    let mut mesh = moved(grid, |[s, t, _]| {
        let r = from + s * (to - from);
        let (sin, cos) = (TAU * t).sin_cos();
        [r * cos, r * sin, 0.0]
    });
    let first_nodes: Vec<usize> = (0..joins.len()).filter(|&i| joins[i] == i).collect();
    let number = |i: usize| first_nodes.binary_search(&joins[i]).unwrap();
    mesh.cells.iter_mut().flat_map(|cell| &mut cell.nodes).for_each(|node| *node = number(*node));
    mesh.boundaries.retain(|boundary| ["left", "right"].contains(&boundary.name.as_str()));
    let facets = mesh.boundaries.iter_mut().flat_map(|boundary| &mut boundary.facets);
    facets.flatten().for_each(|node| *node = number(*node));
    mesh.nodes = first_nodes.into_iter().map(|i| mesh.nodes[i]).collect();
    mesh
}

/// A hub shrunk on a shaft that nothing else holds: it sticks all round, from the first iteration on.
#[test]
fn rings_on_contact_and_friction_alone() {
    for kind in [CellKind::Quadrilateral, CellKind::Triangle6, CellKind::Quadrilateral8] {
        let mut forces = Vec::new();
        for n in [4, 8, 12, 16, 20, 24, 32, 48, 64] {
            if kind == CellKind::Triangle6 && n < 8 {
                continue;
            }
            let shaft = Body::new("shaft", ring(kind, [0.01, 0.02], n));
            let hub = Body::new("hub", ring(kind, [0.02, 0.04], n));
            let material = Material::new(210e9, 0.3).in_plane(Plane::Stress);
            let opposite = Opposite::from("shaft:right").apart(-2e-5);
            let body = Description::new(MeshSource::Bodies(vec![shaft, hub]), material, vec![1.0])
                .support("shaft:left", &[Axis::X, Axis::Y])
                .pair("hub:left", 0.12, opposite);
            let model = Model::build(&body).unwrap();
            by_all(&model, &format!("{kind:?}, {n} around"), 10, |model, state| {
                let largest = largest(&state.p_n);
                assert!(state.p_n.iter().all(|p| *p > 0.1 * largest), "{kind:?} {n}");
                assert!(state.p_t.iter().all(|p| p.abs() < 0.12 * 0.5 * largest), "{kind:?} {n}");
                assert!(!model.constraints.rigid_motions.is_empty());
            });
            let outcome = Run::of(&model, vec![1.0], bn()).unwrap().history(&mut ()).unwrap();
            forces.push(outcome.state.p_n.iter().sum::<f64>());
        }
        let last = forces[forces.len() - 1];
        assert!((forces[forces.len() - 2] / last - 1.0).abs() < 0.05, "{forces:?}");
    }
}

/// A hub whose mesh is turned against that of the shaft, or has other facets: their normals are a little turned, but no body
/// screws itself out of the interference.
#[test]
fn turned_rings_stay() {
    for (n, m, turn) in [(16, 16, 0.05), (32, 32, 0.02), (32, 32, 0.09), (48, 48, 0.05), (32, 24, 0.05), (16, 32, 0.02)]
    {
        let mut outer = ring(CellKind::Quadrilateral, [0.02, 0.04], m);
        for x in &mut outer.nodes {
            let (s, c) = f64::sin_cos(turn);
            *x = [c * x[0] - s * x[1], s * x[0] + c * x[1], 0.0];
        }
        let shaft = Body::new("shaft", ring(CellKind::Quadrilateral, [0.01, 0.02], n));
        let material = Material::new(210e9, 0.3).in_plane(Plane::Stress);
        let bodies = MeshSource::Bodies(vec![shaft, Body::new("hub", outer)]);
        let body = Description::new(bodies, material, vec![1.0]).support("shaft:left", &[Axis::X, Axis::Y]).pair(
            "hub:left",
            0.12,
            Opposite::from("shaft:right").apart(-2e-5),
        );
        let model = Model::build(&body).unwrap();
        by_all(&model, &format!("{n} on {m} turned by {turn}"), 10, |_, state| {
            let largest = largest(&state.p_n);
            assert!(state.p_n.iter().all(|p| *p > 0.1 * largest), "{n} {m} {turn}: {:?}", state.p_n);
            assert!(state.u.iter().all(|u| u.abs() < 1e-4), "{n} {m} {turn}");
        });
    }
}

/// Half of an interface is welded, the rest in contact: the node at the end of the weld has no contact force of its own, and
/// nobody is told that forces are not unique.
#[test]
fn the_end_of_a_weld() {
    let body = |name: &str, at: &str| {
        format!(
            "[[body]]\nname = \"{name}\"\nat = {at}\nmesh = {{ kind = \"block\", size = [1, 1], elements = [4, 4] }}\n\
             material = {{ young = 1, poisson = 0 }}\n"
        )
    };
    let text = [
        body("a", "[0, 0]"),
        body("b", "[1, 0]"),
        body("c", "[0, 1]"),
        body("d", "[1, 1]"),
        "[[contact]]\nboundary = \"a:right\"\nagainst = \"b:left\"\nglue = true\n\
         [[contact]]\nboundary = \"c:right\"\nagainst = \"d:left\"\nglue = true\n\
         [[contact]]\nboundary = \"c:bottom\"\nagainst = \"a:top\"\nglue = true\n\
         [[contact]]\nboundary = \"d:bottom\"\nagainst = \"b:top\"\nfriction = 0.3\n\
         [[support]]\nboundary = \"a:bottom\"\nfix = [\"x\", \"y\"]\n[[support]]\nboundary = \"b:bottom\"\nfix = [\"x\", \"y\"]\n\
         [[support]]\nboundary = \"c:top\"\nfix = [\"x\", \"y\"]\ndisplacement = [0, -0.02]\n\
         [[support]]\nboundary = \"d:top\"\nfix = [\"x\", \"y\"]\ndisplacement = [0, -0.02]\n[time]\nend = 1\nincrements = 1\n"
            .to_string(),
    ]
    .concat();
    let model = model_of(&text);
    by_all(&model, "weld", 10, |model, state| {
        for (i, contact) in model.contact.nodes.iter().enumerate() {
            let pressure = state.p_n[i] / contact.weight;
            let is_end = contact.position[0] < 1.0 + 1e-9;
            assert!((pressure / 0.01 - 1.0).abs() < 1e-6 || is_end, "{:?}: {pressure}", contact.position);
        }
    });
    let report = Run::of(&model, vec![1.0], bn()).unwrap().solve(&mut ()).unwrap();
    assert!(report.warnings.iter().all(|warning| warning.kind != WarningKind::NOT_UNIQUE), "{:?}", report.warnings);
}

/// Two glued blocks in space, whose nodes at the seam do not match, over a slope: the motion that closes all gaps at once
/// closes those of the nodes that carry others, too. Obstacles that move apart keep their rows.
#[test]
fn a_seam_over_a_slope() {
    let scene = |motion: &str| {
        let body = |name: &str, at: f64, across: usize| {
            format!(
                "[[body]]\nname = \"{name}\"\nat = [{at}, 0, 0]\nmaterial = {{ young = 1, poisson = 0 }}\n\
                 mesh = {{ kind = \"block\", size = [1, 1, 1], elements = [2, {across}, 2] }}\n\
                 [[support]]\nboundary = \"{name}:top\"\nfix = [\"x\", \"y\", \"z\"]\n"
            )
        };
        let contact = |name: &str, motion: &str| {
            format!(
                "[[contact]]\nboundary = \"{name}:bottom\"\nfriction = 0.1\n\
                 obstacle = {{ kind = \"formula\", formula = \"0.02 + 0.01 * y\"{motion} }}\n"
            )
        };
        let glue = "[[contact]]\nboundary = \"a:right\"\nagainst = \"b:left\"\nglue = true\n";
        let time = "[time]\nend = 1\nincrements = 1\n";
        let text = [body("a", 0.0, 3), body("b", 1.0, 4), glue.into(), contact("a", ""), contact("b", motion)];
        model_of(&(text.concat() + time))
    };
    let model = scene("");
    let nodes = model.mesh.nodes.clone();
    let u = model.constraints.dofs.unknowns(|node| [0.0, 0.0, -0.02 - 0.01 * nodes[node][1]]);
    for (i, (gap, contact)) in model.loading.gap().iter().zip(&model.contact.nodes).enumerate() {
        let w: f64 = model.problem.c_n().row(i).iter().map(|(dof, c)| c * u[*dof]).sum();
        assert!((w - gap).abs() < 1e-12, "{w} {gap} at {:?}", nodes[contact.node]);
    }
    let apart = scene(", approach = [[0, 0], [1, 0.01]]");
    assert_eq!(apart.contact.nodes.len(), model.contact.nodes.len() + 4);
}

/// A block of `elements` whose top is held and whose bottom an `obstacle` presses.
fn pressed_block(name: &str, at: &str, [size, elements]: [&str; 2], obstacle: &str) -> String {
    let fix = if size.matches(',').count() == 2 { "\"x\", \"y\", \"z\"" } else { "\"x\", \"y\"" };
    format!(
        "[[body]]\nname = \"{name}\"\nat = {at}\nmesh = {{ kind = \"block\", size = {size}, elements = {elements} }}\n\
         material = {{ young = 1e9, poisson = 0.3 }}\n[[support]]\nboundary = \"{name}:top\"\nfix = [{fix}]\n\
         [[contact]]\nboundary = \"{name}:bottom\"\nfriction = 0\nobstacle = {{ {obstacle} }}\n"
    )
}

fn glued(boundary: &str, against: &str) -> String {
    format!("[[contact]]\nboundary = \"{boundary}\"\nagainst = \"{against}\"\nglue = true\n")
}

/// A contact goes on across glue and the end of a period, whose meshes do not match: its width and edges are not
/// those of one boundary.
#[test]
fn a_contact_goes_on_across_seams() {
    let report = |scene: &[String]| {
        let text = [&scene.concat(), "[time]\nend = 1\nincrements = 1\n"].concat();
        let report = Run::new(&parsed(&text)).unwrap().solve(&mut ()).unwrap();
        assert_eq!(report.status, Status::Converged);
        report
    };
    let cylinder = "kind = \"cylinder\", radius = 10, apex = [1, 0], approach = [[0, 0], [1, 0.005]]";
    let sphere = "kind = \"sphere\", radius = 10, apex = [1, 0.5, 0], approach = [[0, 0], [1, 0.03]]";
    let wave = |depth: f64, crest: f64| {
        format!(
            "kind = \"formula\", formula = \"-0.01 * (1 - cos(PI * (x - {crest})))\", normal = [0, -1], \
             approach = [[0, 0], [1, {depth}]]"
        )
    };
    let two = |[size, a, b]: [&str; 3], obstacle: &str| {
        let at = if size.matches(',').count() == 2 { ["[0, 0, 0]", "[1, 0, 0]"] } else { ["[0, 0]", "[1, 0]"] };
        [
            pressed_block("a", at[0], [size, a], obstacle),
            pressed_block("b", at[1], [size, b], obstacle),
            glued("a:right", "b:left"),
        ]
        .concat()
    };
    let period = glued("b:right", "a:left") + "shift = [2, 0]\n";
    let periodic = |n: usize, obstacle: &str| {
        let [a, b] = [4, 5].map(|up| format!("[{n}, {up}]"));
        vec![two(["[1, 1]", &a, &b], obstacle), period.clone()]
    };
    let one = report(&[pressed_block("a", "[0, 0]", ["[2, 1]", "[40, 5]"], cylinder)]);
    let in_space = report(&[pressed_block("a", "[0, 0, 0]", ["[2, 1, 0.5]", "[18, 9, 3]"], sphere)]);
    let cases = [
        (vec![two(["[1, 1]", "[20, 4]", "[20, 5]"], cylinder)], one.estimates.contact[0].nodes_across),
        (vec![two(["[1, 1, 0.5]", "[9, 9, 3]", "[11, 11, 3]"], sphere)], in_space.estimates.contact[0].nodes_across),
        (periodic(20, &wave(0.002, 1.0)), Some(31)),
        (periodic(20, &wave(0.002, 0.0)), Some(31)),
        (periodic(5, &wave(0.1, 1.0)), None),
        (periodic(5, &wave(0.1, 0.0)), None),
    ];
    for (k, (scene, across)) in cases.into_iter().enumerate() {
        let report = report(&scene);
        let [contact] = &report.estimates.contact[..] else { panic!("{k}: {:?}", report.estimates.contact) };
        assert_eq!((contact.zones, contact.singular_edge), (1, false), "{k}");
        assert_eq!(contact.nodes_across, across, "{k}");
        let of_contact = [WarningKind::CONTACT_COARSE, WarningKind::CONTACT_UNRESOLVED, WarningKind::SINGULAR_EDGE];
        assert!(
            report.warnings.iter().all(|warning| !of_contact.contains(&warning.kind)),
            "{k}: {:?}",
            report.warnings
        );
    }
}
