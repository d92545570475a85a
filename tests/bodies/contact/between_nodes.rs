//! What contact nodes do not feel of obstacles: another obstacle that comes, what is between nodes, holes.

use crate::closed_forms::estimates::solved;
use crate::common::prelude::*;
use crate::contact::surfaces::{Triangle, ascii};

const TIMES: [f64; 8] = [0.25, 0.5, 0.75, 1.0, 1.25, 1.5, 1.75, 2.0];

/// A plate that is clamped above.
fn plate() -> Description {
    let mesh = MeshSource::block([2.0, 0.2], [40, 4]);
    Description::new(mesh, Material::new(1e9, 0.3), TIMES.to_vec()).support("top", &[Axis::X, Axis::Y])
}

fn down() -> Vector {
    [0.0, -1.0].into()
}

/// A roller under the plate that is pressed into it and then rolls along by 1 m.
fn roller(x: f64) -> Obstacle {
    let shape = Shape::Cylinder { radius: 0.5, place: Place::Apex([x, 0.0].into()), axis: None };
    let travel = vec![(1.0, [0.0, 0.0].into()), (2.0, [1.0, 0.0].into())];
    Obstacle { normal: Some(down()), translation: Some(travel), ..Obstacle::at_rest(shape) }
        .approaching(&[[0.0, 0.0], [1.0, 3e-3]])
}

/// The model and all its converged states, and the report.
fn recorded(description: &Description) -> (Model, Vec<State>, RunReport) {
    let (model, mut recording) = (Model::build(description).unwrap(), Recording::all());
    let report = Run::of(&model, model.times().to_vec(), bn()).unwrap().solve(&mut recording).unwrap();
    let states = recording.increments.into_iter().map(|increment| increment.state).collect();
    (model, states, report)
}

fn is_warned(report: &RunReport, kind: WarningKind) -> bool {
    report.warnings.iter().any(|warning| warning.kind == kind)
}

/// A roller that comes to where another one was presses as that one did: the plate does not remember which it met first.
#[test]
fn a_roller_takes_the_place_of_another() {
    let (model, both, report) = recorded(&plate().contact("bottom", 0.0, vec![roller(0.5), roller(1.5)]));
    let (_, one, _) = recorded(&plate().contact("bottom", 0.0, roller(0.5)));
    let force = |state: &State| state.p_n.iter().sum::<f64>();
    assert!(force(&both[7]) > 1e5 && (force(&both[7]) / force(&one[7]) - 1.0).abs() < 1e-9);
    assert!(!is_warned(&report, WarningKind::OBSTACLE_NOT_MET), "{:?}", report.warnings);
    // The force is on the roller that presses, wherever its nodes began.
    let [bottom] = &report.boundaries[..] else { panic!() };
    let on = |k: usize| bottom.obstacles[k].force[1];
    assert!((on(0) + force(&both[7])).abs() < 1e-9 * force(&both[7]) && on(1) == 0.0, "{} {}", on(0), on(1));
    let assigned: Vec<usize> = (0..model.contact.nodes.len()).filter_map(|i| Some(model.assigned(i, 2.0)?.0)).collect();
    assert!(assigned.iter().zip(&model.contact.nodes).all(|(k, contact)| *k == 0 || contact.position[0] > 1.5));
}

/// Nodes of second order, too, follow the nearest obstacle: at each time the gaps are those that the obstacles have if they stand there.
#[test]
fn gaps_of_second_order_follow_the_nearest_obstacle() {
    let body = |obstacles: Vec<Obstacle>| {
        let mesh = Mesh::into_second_order(block(&[2.0, 0.2], &[20, 2]).into_simplices());
        let mesh = MeshSource::Given(Arc::new(mesh));
        let body = Description::new(mesh, Material::new(1e9, 0.3), TIMES.to_vec()).support("top", &[Axis::X, Axis::Y]);
        Model::build(&body.contact("bottom", 0.0, obstacles)).unwrap()
    };
    let standing = |x: f64| Obstacle { translation: None, ..roller(x) };
    let plane = || Obstacle { normal: Some(down()), ..Obstacle::plane(0.05) };
    let moving = body(vec![roller(0.5), plane()]);
    let stands = body(vec![standing(1.5), plane()]);
    let [there, here] = [moving.loading.gaps_at(2.0), stands.loading.gaps_at(2.0)];
    assert_eq!(moving.contact.nodes.len(), stands.contact.nodes.len());
    assert!(there.iter().zip(&here).all(|(a, b)| (a - b).abs() < 1e-12), "{there:?} {here:?}");
}

/// Slip is the motion past the obstacle that is nearest at the time: two planes that take turns are as one that turns round.
#[test]
fn slip_is_past_the_obstacle_that_presses() {
    let plane = |approach: &[[f64; 2]], path: &[(f64, f64)]| Obstacle {
        normal: Some(down()),
        translation: Some(path.iter().map(|(t, x)| (*t, [*x, 0.0].into())).collect()),
        ..Obstacle::plane(0.0).approaching(approach)
    };
    let first = plane(&[[0.0, 1e-4], [1.0, 1e-4], [2.0, -1e-3]], &[(0.0, 0.0), (1.0, 1e-4)]);
    let second = plane(&[[0.0, -1e-3], [1.0, 1e-4]], &[(1.0, 0.0), (2.0, -1e-4)]);
    let single = plane(&[[0.0, 1e-4]], &[(0.0, 0.0), (1.0, 1e-4), (2.0, 0.0)]);
    let (_, both, _) = recorded(&plate().contact("bottom", 0.3, vec![first, second]));
    let (_, one, _) = recorded(&plate().contact("bottom", 0.3, single));
    assert!(common::difference(&both, &one) < 1e-9, "{}", common::difference(&both, &one));
    assert!(
        one[7].p_t.iter().any(|p| p.abs() > 1.0)
            && one[3].p_t.iter().sum::<f64>() * one[7].p_t.iter().sum::<f64>() < 0.0
    );
}

/// An obstacle that presses along another normal is not met where another was nearer at first. If it comes, that is a warning.
#[test]
fn an_obstacle_of_another_normal_that_comes_is_told() {
    let at = |through: [f64; 2], normal: [f64; 2]| Obstacle {
        normal: Some(normal.into()),
        ..Obstacle::at_rest(Shape::PlaneThrough { through: through.into() })
    };
    for (approach, warned) in [(1e-3, true), (3e-5, false)] {
        let level = at([0.0, -1e-4], [0.0, -1.0]).approaching(&[[0.0, 0.0], [1.0, 2e-4]]);
        let leaning = at([1.9, -1e-5], [1e-3, -1.0]).approaching(&[[0.0, 0.0], [1.0, 0.0], [2.0, approach]]);
        let (_, _, report) = recorded(&plate().contact("bottom", 0.0, vec![level, leaning]));
        assert_eq!(is_warned(&report, WarningKind::OBSTACLE_NOT_MET), warned, "{:?}", report.warnings);
    }
}

/// A small body on an obstacle that is given by a formula.
fn on_formula(formula: &str, approach: f64, elements: usize) -> RunReport {
    let mesh = MeshSource::block([1.0, 0.5], [elements, 4]);
    let shape = Shape::Formula(Formula::parse(formula).unwrap());
    solved(&Description::new(mesh, Material::new(1e9, 0.3), vec![1.0]).support("top", &[Axis::X, Axis::Y]).contact(
        "bottom",
        0.0,
        Obstacle::at_rest(shape).approaching(&[[0.0, 0.0], [1.0, approach]]),
    ))
}

/// Bumps between the nodes are told, whatever their period, unless they are small; curves that the elements resolve are not.
#[test]
fn details_between_nodes_are_told() {
    for (formula, warned) in [
        ("1e-4 * (1 - cos(2 * PI * x * 8))", true),
        ("1e-4 * (1 - cos(2 * PI * x * 16))", true),
        ("2e-4 * exp(-((x - 0.56) / 0.02)^2 / 2) * (0 - 1)", true),
        ("1e-6 * (1 - cos(2 * PI * x * 8))", false),
        ("1e-4 * (1 - cos(2 * PI * x))", false),
        ("2e-4 * x", false),
    ] {
        let report = on_formula(formula, 2e-4, 8);
        assert_eq!(is_warned(&report, WarningKind::OBSTACLE_BETWEEN_NODES), warned, "{formula}: {:?}", report.warnings);
    }
    let resolved = on_formula("1e-4 * (1 - cos(2 * PI * x * 8))", 2e-4, 128);
    assert!(!is_warned(&resolved, WarningKind::OBSTACLE_BETWEEN_NODES), "{:?}", resolved.warnings);
}

/// The facets of a ring cut off the arc between its nodes; that is none of the shaft in it.
#[test]
fn facets_of_a_curved_boundary_are_no_details() {
    for n in [4, 12] {
        let shaft = Obstacle {
            normal: Some([-1.0, -1.0].into()),
            direction: GapDirection::Nearest,
            ..Obstacle::at_rest(Shape::Cylinder { radius: 1.001, place: Place::Center([0.0, 0.0].into()), axis: None })
        };
        let body = Description::new(MeshSource::Given(Arc::new(ring(1.0, 1.5, n))), Material::new(1e9, 0.3), vec![1.0]);
        let body = body.support("x axis", &[Axis::Y]).support("y axis", &[Axis::X]);
        let report = solved(&body.contact("inner", 0.0, shaft));
        assert!(!is_warned(&report, WarningKind::OBSTACLE_BETWEEN_NODES), "{n}: {:?}", report.warnings);
    }
}

/// A plane of `n` by `n` squares of two triangles under a unit face, wider by one square all around; seen from above.
fn sheet(n: usize) -> Vec<Triangle> {
    let at = |i: usize, j: usize| [i, j].map(|k| k as f64 / (n - 2) as f64 - 1.0 / (n - 2) as f64);
    let point = |i: usize, j: usize| [at(i, j)[0], at(i, j)[1], 0.0];
    let squares = (0..n).flat_map(|i| (0..n).map(move |j| (i, j)));
    squares
        .flat_map(|(i, j)| {
            let [a, b, c, d] = [point(i, j), point(i + 1, j), point(i + 1, j + 1), point(i, j + 1)];
            [[a, b, c], [a, c, d]]
        })
        .collect()
}

/// A triangle that is missing under the body, and a crack, are told before the run. The outer rim is not, and no hole beside the body.
#[test]
fn holes_under_the_body_are_told() {
    let warned = |triangles: &[Triangle], name: &str, direction: GapDirection| {
        let scratch = Scratch::new(name, ascii(triangles).as_bytes());
        let file = scratch.path().into();
        let obstacle = Obstacle { direction, ..Obstacle::at_rest(Shape::Surface { file, scale: 1.0 }) };
        let body = Description::new(MeshSource::block([1.0, 1.0, 0.5], [4, 4, 2]), Material::new(1e9, 0.3), vec![1.0]);
        let body = body.support("top", &[Axis::X, Axis::Y, Axis::Z]).contact("bottom", 0.0, obstacle);
        let warnings = Warning::of_model(&Model::build(&body).unwrap());
        let warning = warnings.into_iter().find(|warning| warning.kind == WarningKind::SURFACE_HOLE);
        warning.map(|warning| warning.message)
    };
    let whole = sheet(8);
    let without = |k: usize| [&whole[..k], &whole[k + 1..]].concat();
    // The squares from x = 0.5 on, moved apart.
    let cracked = |width: f64| -> Vec<Triangle> {
        let middle = |corners: &Triangle| corners.iter().map(|x| x[0]).sum::<f64>() / 3.0;
        let apart = |corners: &Triangle| corners.map(|[x, y, z]| [x + width, y, z]);
        whole.iter().map(|corners| if middle(corners) > 0.5 { apart(corners) } else { *corners }).collect()
    };
    for direction in [GapDirection::Normal, GapDirection::Nearest] {
        assert_eq!(warned(&whole, "whole.stl", direction), None);
        let inside = 2 * (8 * 4 + 4);
        let message = warned(&without(inside), "hole.stl", direction).unwrap();
        assert!(message.contains("a hole in front of `bottom`") && message.contains("167 mm long"), "{message}");
        // Nothing is lost in a seam with corners that differ by less than 2e-5 of the surface, and any wider one is told.
        for (width, is_told) in [(1e-3, true), (2.8e-5, true), (2.6e-5, false), (1e-5, false), (1e-12, false)] {
            assert_eq!(warned(&cracked(width), "crack.stl", direction).is_some(), is_told, "{width}");
        }
        let corner = 0;
        assert_eq!(warned(&without(corner), "beside.stl", direction), None);
    }
}

/// A block on a plane, whose pressure is singular at its corners, however small a share of the force these bear; one that is rounded
/// there has a peak that a finer mesh resolves.
#[test]
fn edges_are_singular_at_corners_alone() {
    let on_plane = |mesh: Mesh, friction: f64| {
        let mesh = MeshSource::Given(Arc::new(mesh));
        solved(&Description::new(mesh, Material::new(1e9, 0.3), vec![1.0]).support("top", &[Axis::X, Axis::Y]).contact(
            "bottom",
            friction,
            Obstacle::plane(0.0).approaching(&[[0.0, 0.0], [1.0, 1e-4]]),
        ))
    };
    let long = on_plane(block(&[8.0, 0.25], &[192, 4]), 1.0);
    assert!(long.estimates.contact[0].edge_share < 0.01, "{:?}", long.estimates.contact);
    assert!(is_warned(&long, WarningKind::SINGULAR_EDGE), "{:?}", long.warnings);

    let rounded = |radius: f64| {
        let mut mesh: Mesh = block(&[1.0, 0.25], &[40, 6]);
        for [x, y, _] in &mut mesh.nodes {
            let outside = (x.max(1.0 - *x) - (1.0 - radius)).max(0.0);
            *y += (1.0 - *y / 0.25) * (radius - (radius * radius - outside * outside).max(0.0).sqrt()).min(0.1);
        }
        mesh
    };
    let report = on_plane(rounded(0.2), 0.0);
    assert!(!is_warned(&report, WarningKind::SINGULAR_EDGE), "{:?}", report.warnings);
    let sharp = on_plane(block(&[1.0, 0.25], &[40, 6]), 1.0);
    assert!(is_warned(&sharp, WarningKind::SINGULAR_EDGE), "{:?}", sharp.warnings);
    assert!(!is_warned(&sharp, WarningKind::PEAK_SCATTER), "{:?}", sharp.warnings);
}

/// The error of the peak is that of the increment and the zone with the largest pressure, though a wider contact bears more later.
#[test]
fn the_error_of_the_peak_is_of_its_own_time() {
    let shape = Shape::Cylinder { radius: 2.0, place: Place::Apex([1.0, 0.0].into()), axis: None };
    let round = Obstacle { normal: Some(down()), ..Obstacle::at_rest(shape) };
    let leaves = round.clone().approaching(&[[0.0, 0.0], [1.0, 8e-3], [1.5, -1e-2]]);
    let comes = Obstacle { normal: Some(down()), ..Obstacle::plane(0.0) }.approaching(&[
        [0.0, -6e-3],
        [1.5, -6e-3],
        [2.0, 1.5e-3],
    ]);
    let report = solved(&plate().contact("bottom", 0.0, vec![leaves, comes]));
    let until = Description { times: vec![0.5, 1.0], ..plate() };
    let single = solved(&until.contact("bottom", 0.0, round.approaching(&[[0.0, 0.0], [1.0, 8e-3]])));
    assert_eq!((report.largest_pressure.unwrap().time, report.estimates.contact[0].time), (1.0, 2.0));
    assert!(report.estimates.peak_error.is_some());
    assert_eq!(report.estimates.peak_error, single.estimates.peak_error);
}

/// Triangles between lines of points `(x, z)`, from one y to the other, seen from above.
fn strips(line: &[[f64; 2]]) -> Vec<Triangle> {
    let at = |k: usize, y: f64| [line[k][0], y, line[k][1]];
    let of_strip = |k: usize| {
        let [a, b, c, d] = [at(k, -0.1), at(k + 1, -0.1), at(k + 1, 0.3), at(k, 0.3)];
        [[a, b, c], [a, c, d]]
    };
    (0..line.len() - 1).flat_map(of_strip).collect()
}

/// A slab on an obstacle of triangles that rises.
fn on_triangles(triangles: &[Triangle], rise: f64) -> (Description, Scratch) {
    let file = Scratch::new("chords.stl", ascii(triangles).as_bytes());
    let mesh = MeshSource::Given(Arc::new(common::round::moved(block(&[1.0, 0.2, 0.3], &[40, 2, 8]), |[x, y, z]| {
        [x - 0.5, y, z]
    })));
    let obstacle = Obstacle {
        normal: Some([0.0, 0.0, -1.0].into()),
        ..Obstacle::at_rest(Shape::Surface { file: file.path().into(), scale: 1.0 })
    };
    let body = Description::new(mesh, Material::new(1e9, 0.3), vec![1.0])
        .support("top", &[Axis::X, Axis::Y, Axis::Z])
        .contact("bottom", 0.0, obstacle.approaching(&[[0.0, 0.0], [1.0, rise]]));
    (body, file)
}

/// Strips of a cylinder as wide as a third of the contact make peaks a tenth too high, which is told, and narrower ones are not. Flat faces,
/// also those beside chamfers and roundings, approximate nothing.
#[test]
fn triangles_that_are_chords() {
    let round = |a: f64| [2.0 * a.sin(), 2.0 * a.cos() - 2.0];
    let arc = |n: usize| (0..=n).map(|k| round(1.2 * k as f64 / n as f64 - 0.6)).collect::<Vec<_>>();
    let pressed = |triangles: &[Triangle]| {
        let (body, _file) = on_triangles(triangles, 5e-3);
        let (model, states, report) = recorded(&body);
        let pressures = model.contact.nodes.iter().zip(&states[0].p_n).map(|(contact, p)| p / contact.weight);
        (pressures.fold(0.0, f64::max), report)
    };
    let (exact, _) = pressed(&strips(&arc(1600)));
    for (n, wrong) in [(1600, 0.0), (96, 0.0), (48, 0.1), (32, 0.25), (24, 0.42)] {
        let (peak, report) = pressed(&strips(&arc(n)));
        assert!((peak / exact - 1.0 - wrong).abs() < 0.02, "{n}: {peak} {exact}");
        let warning = report.warnings.iter().find(|warning| warning.kind == WarningKind::FACETED_GAPS);
        let message = warning.map(|warning| warning.message.as_str()).unwrap_or_default();
        assert_eq!(message.contains("contact[0].obstacle are chords"), wrong > 0.0, "{n}: {message}");
    }
    for (h, wrong) in [(0.2, true), (0.02, false)] {
        let ball = |i: i32, j: i32| {
            let [x, y] = [i, j].map(|k| h * f64::from(k));
            [x, 0.1 + y, (4.0 - x * x - y * y).sqrt() - 2.0]
        };
        let n = (0.6 / h).round() as i32;
        let cells = (-n..n).flat_map(|i| (-n..n).map(move |j| (i, j)));
        let halves = cells.flat_map(|(i, j)| {
            let [a, b, c, d] = [ball(i, j), ball(i + 1, j), ball(i + 1, j + 1), ball(i, j + 1)];
            [[a, b, c], [a, c, d]]
        });
        let (_, report) = pressed(&halves.collect::<Vec<_>>());
        assert_eq!(is_warned(&report, WarningKind::FACETED_GAPS), wrong, "{h}: {:?}", report.warnings);
    }
    let quarter = (0..=6).map(|k| f64::from(6 - k) * 15.0_f64.to_radians());
    let left: Vec<[f64; 2]> = quarter.map(|a| [-0.2 - 0.1 * a.sin(), 0.1 * a.cos() - 0.1]).collect();
    let rounded = [left.clone(), left.iter().rev().map(|[x, z]| [-x, *z]).collect()].concat();
    let chamfered = vec![[-0.4, -0.4], [-0.4, -0.05], [-0.2, 0.0], [0.2, 0.0], [0.4, -0.05], [0.4, -0.4]];
    for line in [rounded, chamfered, vec![[-0.6, 0.0], [0.6, 0.0]], vec![[-0.6, -0.1], [0.0, 0.0], [0.6, -0.1]]] {
        let (_, report) = pressed(&strips(&line));
        assert!(!is_warned(&report, WarningKind::FACETED_GAPS), "{line:?}: {:?}", report.warnings);
    }
}
