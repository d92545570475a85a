//! Contact of bodies of revolution. Figures without a closed form are those of a program that shares nothing with this one.

use crate::closed_forms::axisymmetric_bodies::{ELEMENTS, ring, solved};
use crate::common::prelude::*;
use crate::contact::second_order_contact::hertz::{alternating, graded, keep_zone};

/// A cylinder of radius and height 1 on its base under a parabola.
fn cylinder(cells: &str, n: usize, element: &str, poisson: f64, friction: f64) -> Scene {
    let text = format!(
        "[mesh]\nkind = \"block\"\nsize = [1, 1]\nelements = [{n}, {n}]\ncells = \"{cells}\"\nelement = \"{element}\"\n\
         [material]\nyoung = 1.0\npoisson = {poisson}\nplane = \"axisymmetric\"\n\
         [[support]]\nboundary = \"bottom\"\nfix = [\"x\", \"y\"]\n\
         [[contact]]\nboundary = \"top\"\nfriction = {friction}\n\
         obstacle = {{ kind = \"formula\", formula = \"0.1 * x^2 - 0.02\" }}\n\
         [time]\nend = 1.0\nincrements = 1\n"
    );
    parsed(&text)
}

fn solve(model: &Model, times: &[f64], solver: SolverChoice, observer: &mut dyn Observer) -> HistoryOutcome {
    let outcome = Run::of(model, times.to_vec(), solver).unwrap().history(observer).unwrap();
    assert_eq!(outcome.status, Status::Converged, "{solver:?}");
    outcome
}

/// The sums of the normal forces and of the sizes of the tangential ones.
fn sums(state: &State) -> [f64; 2] {
    [state.p_n.iter().sum(), state.p_t.iter().map(|t| t.abs()).sum()]
}

fn methods() -> [(Method, LinearAlgebra); 4] {
    [
        (Method::BN, LinearAlgebra::Whole(SparseLu::default())),
        (Method::BN, LinearAlgebra::Whole(SparseLu::Faer)),
        (Method::BN, LinearAlgebra::Condensed(SparseCholesky::Faer)),
        (Method::Ip, LinearAlgebra::Whole(SparseLu::default())),
    ]
}

#[test]
fn parabolas_on_cylinders() {
    for (cells, n, element, poisson, frictionless, frictional) in [
        ("quadrilateral", 8, "bilinear", 0.3, 1.185_084_298_5e-2, [1.206_990_564_4e-2, 2.573_787_665_7e-3]),
        ("quadrilateral", 8, "b-bar", 0.49, 1.459_128_966_3e-2, [1.463_842_822_7e-2, 1.348_538_098_4e-3]),
        ("triangle", 8, "bilinear", 0.3, 1.252_219_990_8e-2, [1.289_577_026_4e-2, 3.178_546_806_4e-3]),
        ("triangle6", 4, "bilinear", 0.3, 1.307_673_592_2e-2, [1.336_649_878_2e-2, 3.371_338_204_1e-3]),
    ] {
        for (mu, expected) in [(0.0, [frictionless, 0.0]), (0.3, frictional)] {
            let model = discretise(&cylinder(cells, n, element, poisson, mu)).unwrap();
            // A node on the axis cannot slide.
            let cannot = |contact: &ContactNode| contact.tangents[0].is_empty() == (contact.position[0] == 0.0);
            assert!(model.contact.nodes.iter().all(cannot));
            for (method, linear) in methods() {
                let solver = SolverChoice { method: method.into(), linear: Some(linear), ..SolverChoice::default() };
                let state = solve(&model, &[1.0], solver, &mut ()).state;
                let mut found = sums(&state);
                // The node between the axis and the next corner pulls at the axis with half its friction, which the other program
                // counts at the axis.
                let beside = |contact: &ContactNode| contact.ends.is_some() && contact.position[0] < 0.2;
                found[1] += model.contact.nodes.iter().position(beside).map_or(0.0, |i| 0.5 * state.p_t[i].abs());
                for (found, expected) in found.into_iter().zip(expected) {
                    let close = (found - expected).abs() <= 2e-9 * expected.abs() + 1e-16;
                    assert!(close, "{cells} {element} {mu} {solver:?}: {found:.10e} {expected:.10e}");
                }
            }
        }
    }
}

/// Sliding history: all methods agree on every state.
#[test]
fn methods_agree_over_a_history() {
    let times: Vec<f64> = (1..=4).map(f64::from).collect();
    for cells in ["quadrilateral", "triangle6"] {
        let mut scene = cylinder(cells, 4, "bilinear", 0.3, 0.2);
        scene.description.times = times.clone();
        let contact = &mut scene.description.contacts[0];
        contact.against =
            contact.obstacles()[0].clone().approaching(&[[0.0, -0.02], [2.0, 0.01], [4.0, -0.005]]).into();
        let model = discretise(&scene).unwrap();
        let all = methods().map(|(method, linear)| {
            let mut keep = Keep::default();
            let solver = SolverChoice { method: method.into(), linear: Some(linear), ..SolverChoice::default() };
            solve(&model, &times, solver, &mut keep);
            keep.states
        });
        for other in &all[1..] {
            let off = difference(&all[0], other);
            assert!(off < 1e-8, "{cells}: {off:e}");
        }
    }
}

/// Quadrilaterals or triangles between the lines `xs` and `ys`, with the boundary `zone` of what of the top is within it.
fn mesh(lines: &[f64], kind: CellKind, zone: f64) -> Mesh {
    let ys: Vec<f64> = lines.iter().rev().map(|y| -y).collect();
    let mut mesh = alternating(lines, &ys);
    if kind == CellKind::Quadrilateral {
        let corners = |pair: &[Cell]| {
            let mut all: Vec<usize> = pair.iter().flat_map(|cell| cell.nodes.iter().copied()).collect();
            all.sort_unstable();
            all.dedup();
            let [a, b, c, d] = all[..] else { panic!() };
            Cell { kind, nodes: vec![a, b, d, c], group: 0 }
        };
        mesh.cells = mesh.cells.chunks(2).map(corners).collect();
    }
    if kind.is_quadratic() {
        mesh = mesh.into_second_order();
    }
    keep_zone(&mut mesh, "zone", zone);
    mesh
}

/// A half-space, cut off where it moves as a point force moves it (Boussinesq), under a sphere or a flat punch: the force as another
/// program finds it on the same mesh, near that of Hertz and of the punch.
#[test]
fn spheres_and_punches() {
    let (young, nu, a) = (1.0, 0.3, 0.02_f64);
    let (modulus, shear) = (young / (1.0 - nu * nu), 0.5 * young / (1.0 + nu));
    let sphere = |kind, element, n, expected, near| (true, kind, element, n, expected, near);
    let punch = |kind, element, n, expected, near| (false, kind, element, n, expected, near);
    let (q, t, t6) = (CellKind::Quadrilateral, CellKind::Triangle, CellKind::Triangle6);
    for (round, kind, element, n, expected, near) in [
        sphere(q, Element::Bilinear, 8, 1.204_016_561_0e-5, 0.0273),
        sphere(q, Element::Bilinear, 16, 1.177_358_562_7e-5, 0.0045),
        sphere(q, Element::BBar, 8, 1.195_477_973_7e-5, 0.0200),
        sphere(t, Element::Bilinear, 8, 1.237_706_462_1e-5, 0.0560),
        sphere(t6, Element::Bilinear, 4, 1.190_725_291_2e-5, 0.0160),
        punch(q, Element::Bilinear, 8, 9.615_314_775_5e-7, 0.0940),
        punch(q, Element::BBar, 8, 9.433_569_730_5e-7, 0.0732),
        punch(t, Element::Bilinear, 8, 1.025_942_777_6e-6, 0.168),
        punch(t6, Element::Bilinear, 8, 8.987_325_112_1e-7, 0.0225),
    ] {
        let (zone, depth) = if round { (1.5 * a, a * a) } else { (a, 1e-3 * a) };
        let exact = if round { 4.0 / 3.0 * modulus * a.powi(3) } else { 2.0 * modulus * a * depth };
        let lines = graded(n, zone, 1.0);
        let mesh = mesh(&lines, kind, zone);
        let far: Vec<[f64; 3]> =
            mesh.nodes.iter().copied().filter(|x| x[0] > 1.0 - 1e-9 || x[1] < -1.0 + 1e-9).collect();
        // Of both obstacles the tip, or the face, is at y = -depth.
        let obstacle = if round {
            Obstacle { shape: Shape::Formula(Formula::parse("0.5 * x^2 - 4e-4").unwrap()), ..Obstacle::plane(0.0) }
        } else {
            Obstacle::plane(-depth)
        };
        let mut body = Description::new(mesh, Material::new(young, nu).in_plane(Plane::Axisymmetric), vec![1.0])
            .contact("zone", 0.0, [obstacle]);
        body.element = element;
        for [r, y, _] in far {
            let (z, distance) = (-y, r.hypot(y));
            let of = exact / (4.0 * std::f64::consts::PI * shear * distance);
            let u_r = of * (r * z / (distance * distance) - (1.0 - 2.0 * nu) * r / (distance + z));
            let u_z = of * (z * z / (distance * distance) + 2.0 * (1.0 - nu));
            body = body.with_support(Support::new("", &[Axis::X, Axis::Y]).at([r, y]).moved(&[u_r, -u_z]));
        }
        let model = Model::build(&body).unwrap();
        let state = solve(&model, &[1.0], SolverChoice::default(), &mut ()).state;
        let found = sums(&state)[0];
        if round {
            let axis = model.contact.nodes.iter().position(|contact| contact.position[0] == 0.0).unwrap();
            let hertz = Hertz::sphere(found, 1.0, modulus);
            let share = state.p_n[axis] / model.contact.nodes[axis].weight / hertz.p0;
            println!(
                "sphere, {kind:?} {element:?} {n}: force {:+.4}, pressure on the axis {share:.4}",
                found / exact - 1.0
            );
            assert!((0.8..1.02).contains(&share), "{kind:?} {element:?}: {share}");
        }
        assert!((found / expected - 1.0).abs() < 1e-8, "{round} {kind:?} {element:?}: {found:.10e} {expected:.10e}");
        assert!((found / exact - 1.0).abs() < near, "{round} {kind:?} {element:?}: {}", found / exact - 1.0);
    }
}

/// Uniform pressure is exact on every element: a plate on a cylinder, and a tube around one.
#[test]
fn contact_patch_tests() {
    let (young, nu, to) = (200e9, 0.3, 1e-5);
    for (cells, element) in ELEMENTS {
        for inner in [0.0, 0.1] {
            let cylinder = || ring(inner, [0.2, 0.3], [4, 3], cells, Material::new(young, nu));
            let plate =
                cylinder().with_support(Support::new("bottom", &[Axis::Y])).contact("top", 0.0, [Obstacle::plane(-to)]);
            let tube = (cylinder()
                .with_support(Support::new("bottom", &[Axis::Y]))
                .with_support(Support::new("top", &[Axis::Y])))
            .contact("right", 0.0, [Obstacle::plane(-to)]);
            // Beside a hole the tube's pressure is not uniform in the body, but on the tube it is.
            let (a, b) = (inner, inner + 0.2);
            let lame = young * to / b * (b * b - a * a) / ((1.0 + nu) * ((1.0 - 2.0 * nu) * b * b + a * a));
            for (mut body, pressure, within) in
                [(plate, young * to / 0.3, 1e-11), (tube, lame, if inner == 0.0 { 1e-11 } else { 2e-2 })]
            {
                body.element = element;
                let model = Model::build(&body).unwrap();
                let state = solve(&model, &[1.0], SolverChoice::default(), &mut ()).state;
                for (contact, p) in model.contact.nodes.iter().zip(&state.p_n) {
                    let off = p / contact.weight / pressure - 1.0;
                    assert!(off.abs() < within, "{cells:?} {element:?} {inner}: {:?} {off:e}", contact.position);
                }
            }
        }
    }
}

/// A ring that is shrunk on a rigid shaft, and the force that draws the shaft out of it.
#[test]
fn shrink_fit() {
    let (young, nu, a, b, h, by, mu) = (200e9, 0.3, 0.1_f64, 0.2_f64, 0.05, 1e-5, 0.15);
    let pressure = young * by / a * (b * b - a * a) / ((1.0 + nu) * ((1.0 - 2.0 * nu) * a * a + b * b));
    for (cells, n) in [(CellKind::Quadrilateral, 16), (CellKind::Triangle6, 8)] {
        let drawn = Obstacle {
            translation: Some(vec![(0.0, [0.0, 0.0].into()), (1.0, [0.0, 0.0].into()), (2.0, [0.0, 1e-3].into())]),
            ..Obstacle::plane(-by)
        };
        let mut body = ring(a, [b - a, h], [n, n], cells, Material::new(young, nu))
            .with_support(Support::new("bottom", &[Axis::Y]))
            .with_support(Support::new("top", &[Axis::Y]))
            .contact("left", mu, [drawn]);
        body.times = vec![1.0, 2.0];
        let found = solved(&body);
        let [fitted, drawn] = &found.report.forces[..] else { panic!() };
        let all_round = 2.0 * std::f64::consts::PI * a * h * pressure;
        let off = fitted.resultant.sums.sum_p_n / all_round - 1.0;
        assert!(off.abs() < 3e-3, "{cells:?}: {off:e}");
        // What leads away from the axis is told as the sum all around.
        assert!((fitted.resultant.force[0] / fitted.resultant.sums.sum_p_n + 1.0).abs() < 1e-12);
        assert_eq!(fitted.resultant.moment, [0.0]);
        let out = drawn.resultant.sums.sum_p_n * mu;
        // The corners of the ring are held along the shaft.
        let share = drawn.resultant.force[1].abs() / out;
        assert!((0.8..1.0 + 1e-9).contains(&share), "{cells:?}: {share}");
        let reactions = found.reaction(0) + found.reaction(1);
        assert!((reactions - drawn.resultant.force[1]).abs() < 1e-6 * out, "{reactions}");
    }
}

/// A sphere is a cylinder of the section whose axis is in the middle, a cone a wedge; both press with the force that Hertz has.
#[test]
fn obstacles_of_revolution() {
    let shapes = |kinds: [&str; 2]| {
        kinds.map(|kind| {
            let mut scene = cylinder("quadrilateral", 8, "bilinear", 0.3, 0.0);
            let text = format!("kind = \"{kind}\"");
            let shape = match kind {
                "sphere" => Shape::Sphere { radius: 2.0, place: Place::Center([0.0, 2.98].into()) },
                "cylinder" => Shape::Cylinder { radius: 2.0, place: Place::Center([0.0, 2.98].into()), axis: None },
                "cone" => Shape::Cone { apex: [0.0, 0.98].into(), half_angle: 1.5, axis: None },
                _ => {
                    let angle = 0.5 * std::f64::consts::PI - 1.5;
                    Shape::Wedge { apex: [0.0, 0.98].into(), angle, axis: None }
                }
            };
            scene.description.contacts[0].against = vec![Obstacle { shape, ..Obstacle::plane(0.0) }].into();
            let report = Run::new(&scene).unwrap().solve(&mut ()).unwrap();
            assert_eq!(report.status, Status::Converged, "{text}");
            let estimate = report.estimates.contact[0].clone();
            let hertz = kind == "sphere" || kind == "cylinder";
            assert_eq!(estimate.hertz.is_some(), hertz && estimate.nodes_across.unwrap() <= 3, "{text}: {estimate:?}");
            report.forces[0].resultant.sums.sum_p_n
        })
    };
    let [sphere, cylinder] = shapes(["sphere", "cylinder"]);
    assert!((sphere / cylinder - 1.0).abs() < 1e-9, "{sphere} {cylinder}");
    let [cone, wedge] = shapes(["cone", "wedge"]);
    assert!((cone / wedge - 1.0).abs() < 1e-9, "{cone} {wedge}");
}

/// A cylinder that nothing holds falls on a plate and stays: it can move along its axis, and nowhere else.
#[test]
fn contact_alone_holds() {
    for (cells, element) in ELEMENTS {
        let mut body = ring(0.0, [0.2, 0.1], [4, 2], cells, Material::new(1e9, 0.0))
            .contact("bottom", 0.3, [Obstacle::plane(1e-2)])
            .load(Load::new("top", &[0.0, -1e6]).over(&[[0.0, 1.0]]));
        body.element = element;
        let found = solved(&body);
        let force = found.report.forces[0].resultant.force[1];
        assert!((force / (-1e6 * std::f64::consts::PI * 0.04) - 1.0).abs() < 1e-10, "{cells:?}: {force}");
        assert!(found.end.iter().all(|u| (u[1] + 1e-2).abs() < 1.1e-4));
        body.loads[0] = Load::new("top", &[0.0, 1e6]).over(&[[0.0, 1.0]]);
        let model = Model::build(&body).unwrap();
        let report = Run::of(&model, vec![1.0], SolverChoice::default()).unwrap().solve(&mut ()).unwrap();
        assert_eq!(report.status, Status::NoEquilibrium);
    }
}
