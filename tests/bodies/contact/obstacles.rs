//! Gaps, normals and motions of obstacles against what a pencil gives, and bad obstacles.

use crate::common::prelude::*;
use stickslip::algebra::plus;
use stickslip::body::{Facing, ObstacleError};

const Z: [f64; 3] = [0.0, 0.0, 1.0];

fn close(a: &[f64], b: &[f64]) -> bool {
    a.len() == b.len() && a.iter().zip(b).all(|(a, b)| (a - b).abs() <= 1e-14 * (1.0 + b.abs()))
}

/// What points at `x` see of `given` above the top of a block.
fn above(mesh: &Mesh, given: &Obstacle, points: &[[f64; 3]]) -> Vec<Facing> {
    let obstacle = PlacedObstacle::new(mesh, mesh.boundary("top").unwrap(), given).unwrap();
    points.iter().map(|&x| obstacle.at(x)).collect()
}

fn gaps(mesh: &Mesh, shape: Shape, points: &[[f64; 3]]) -> Vec<f64> {
    above(mesh, &Obstacle::at_rest(shape), points).iter().map(|facing| facing.gap).collect()
}

#[test]
fn gaps_along_one_normal() {
    let mesh = block(&[1.0, 1.0], &[2, 2]);
    let points = [[0.0, 1.0, 0.0], [0.3, 1.0, 0.0], [0.3, 0.9, 0.0]];
    assert_eq!(gaps(&mesh, Shape::Plane { gap: 1e-5 }, &points)[..2], [1e-5; 2]);
    assert!(close(
        &gaps(&mesh, Shape::PlaneThrough { through: [9.0, 1.25, 0.0].into() }, &points),
        &[0.25, 0.25, 0.35]
    ));
    let round = Shape::Cylinder { radius: 0.5, place: Place::Apex([0.0, 1.1, 0.0].into()), axis: None };
    assert!(close(&gaps(&mesh, round, &points), &[0.1, 0.2, 0.3]));
    let wedge = Shape::Wedge { apex: [0.1, 1.0, 0.0].into(), angle: 0.5_f64.atan(), axis: None };
    assert!(close(&gaps(&mesh, wedge, &points), &[0.05, 0.1, 0.2]));
    let formula = Shape::Formula(Formula::parse("x^2 / 2 + (1 - y)").unwrap());
    assert!(close(&gaps(&mesh, formula, &points), &[0.0, 0.045, 0.145]));
}

#[test]
fn a_sphere_and_an_oblique_cylinder_over_a_cube() {
    let mesh = block(&[1.0, 1.0, 1.0], &[2, 2, 2]);
    let points = [[0.5, 0.5, 1.0], [0.8, 0.5, 1.0], [0.8, 0.9, 1.0]];
    let sphere = Shape::Sphere { radius: 1.3, place: Place::Apex([0.5, 0.5, 1.0].into()) };
    assert!(close(&gaps(&mesh, sphere, &points), &[0.0, 1.3 - 1.6_f64.sqrt(), 1.3 - 1.44_f64.sqrt()]));
    // Across an axis along (1, 1, 0) the last point is 0.1 / √2 away.
    let cylinder = Shape::Cylinder {
        radius: 1.0,
        place: Place::Apex([0.5, 0.5, 1.0].into()),
        axis: Some([FRAC_1_SQRT_2, FRAC_1_SQRT_2, 0.0].into()),
    };
    let expected = [0.0, 1.0 - (1.0_f64 - 0.045).sqrt(), 1.0 - (1.0_f64 - 0.005).sqrt()];
    assert!(close(&gaps(&mesh, cylinder, &points), &expected));
}

#[test]
fn gaps_to_the_nearest_point() {
    let nearest = |shape| Obstacle { direction: GapDirection::Nearest, ..Obstacle::at_rest(shape) };
    let mesh = block(&[1.0, 1.0, 1.0], &[2, 2, 2]);
    // The centre is at (0, 0, 1.5): 3-4-5 from (0.3, 0, 1.1) and from (0, 0.4, 1.2).
    let sphere = nearest(Shape::Sphere { radius: 0.4, place: Place::Apex([0.0, 0.0, 1.1].into()) });
    for (x, normal) in [([0.3, 0.0, 1.1], [-0.6, 0.0, 0.8]), ([0.0, 0.4, 1.2], [0.0, -0.8, 0.6])] {
        let facing = above(&mesh, &sphere, &[x])[0];
        assert!((facing.gap - 0.1).abs() < 1e-15 && close(&facing.normal, &normal), "{facing:?}");
        let [t, o] = facing.tangents;
        let dot = |a: [f64; 3], b: [f64; 3]| a.iter().zip(b).map(|(a, b)| a * b).sum::<f64>();
        let products = [dot(t, t), dot(o, o), dot(t, o), dot(t, facing.normal), dot(o, facing.normal)];
        assert!(close(&products, &[1.0, 1.0, 0.0, 0.0, 0.0]));
    }
    let plane = block(&[1.0, 1.0], &[2, 2]);
    let wedge = nearest(Shape::Wedge { apex: [0.5, 1.1, 0.0].into(), angle: PI / 4.0, axis: None });
    let facings = above(&plane, &wedge, &[[0.5, 1.0, 0.0], [1.0, 1.0, 0.0]]);
    assert!((facings[0].gap - 0.1).abs() < 1e-15 && close(&facings[0].normal, &[0.0, 1.0, 0.0]));
    assert!((facings[1].gap - 0.6 * FRAC_1_SQRT_2).abs() < 1e-15);
    assert!(close(&facings[1].normal, &[-FRAC_1_SQRT_2, FRAC_1_SQRT_2, 0.0]));
}

/// Round a whole bore a tangent across the axis turns with the normal, and one along the axis stays; a given tangent says which way.
#[test]
fn tangents_go_round_a_bore() {
    let (square, cube) = (block(&[1.0, 1.0], &[1, 1]), block(&[1.0; 3], &[1; 3]));
    let along = [0.0, 1.0, 0.0];
    let bore = |axis: Option<[f64; 3]>, centre: Vector| Shape::Bore {
        radius: 2.0,
        place: Place::Center(centre),
        axis: axis.map(Vector::from),
    };
    let nearest = |shape: Shape, tangent: Option<Vector>, normal: Vector| Obstacle {
        direction: GapDirection::Nearest,
        tangent,
        normal: Some(normal),
        ..Obstacle::at_rest(shape)
    };
    for k in 0..48 {
        let (sin, cos) = (PI * f64::from(k) / 24.0).sin_cos();
        for (tangent, sense) in [(None, 1.0), (Some([1.0, 0.0].into()), -1.0)] {
            let given = nearest(bore(None, [0.5, 0.5].into()), tangent, [0.0, 1.0].into());
            let facing = above(&square, &given, &[[0.5 + 0.7 * cos, 0.5 + 0.7 * sin, 0.0]])[0];
            let turned = [-sin, cos, 0.0].map(|c| sense * c);
            assert!(norm(minus(facing.tangents[0], turned)) < 2e-15, "{k}: {facing:?}");
        }
        let x = [0.5 + 0.7 * cos, 0.3, 0.5 + 0.7 * sin];
        for (tangent, expected) in [([1.0, 0.0, 0.0], [sin, 0.0, -cos]), (along, along)] {
            let given = nearest(bore(Some(along), [0.5; 3].into()), Some(tangent.into()), [0.0, 0.0, 1.0].into());
            let facing = above(&cube, &given, &[x])[0];
            assert!(norm(minus(facing.tangents[0], expected)) < 2e-15, "{k}: {facing:?}");
            assert!(norm(minus(facing.tangents[1], cross(facing.normal, facing.tangents[0]))) < 2e-15);
        }
    }
}

/// By its centre a round obstacle stays where it is when its radius changes, and is the same as by its apex.
#[test]
fn round_obstacles_by_apex_or_centre() {
    let square = block(&[1.0, 1.0], &[2, 2]);
    let points = [[0.0, 1.0, 0.0], [0.4, 1.0, 0.0], [1.0, 1.0, 0.0]];
    let (apex, centre) = (|y: f64| Place::Apex([0.3, y].into()), Place::Center([0.3, 2.0].into()));
    for radius in [0.8, 0.9] {
        let cylinder = |place| gaps(&square, Shape::Cylinder { radius, place, axis: None }, &points);
        assert!(close(&cylinder(centre), &cylinder(apex(2.0 - radius))));
        let exact = points.map(|x| 1.0 - (radius * radius - (x[0] - 0.3).powi(2)).sqrt());
        assert!(close(&cylinder(centre), &exact), "{exact:?}");
        let bore = |place| gaps(&square, Shape::Bore { radius: 3.0 * radius, place, axis: None }, &points);
        assert!(close(&bore(centre), &bore(apex(2.0 + 3.0 * radius))));
    }
    // In space from an oblique axis, and the nearest point of a socket.
    let cube = block(&[1.0; 3], &[2; 3]);
    let (axis, points) = ([0.6, 0.8, 0.0], [[0.1, 0.2, 1.0], [0.9, 0.4, 1.0]]);
    let cylinder = |place| gaps(&cube, Shape::Cylinder { radius: 2.0, place, axis: Some(axis.into()) }, &points);
    let by_apex = cylinder(Place::Apex([0.5, 0.5, 1.1].into()));
    let on_the_axis = plus([0.5, 0.5, 3.1], 7.0, axis);
    assert!(close(&cylinder(Place::Center(on_the_axis.into())), &by_apex));
    let socket = Shape::Socket { radius: 2.0, place: Place::Center([0.5, 0.4, 0.3].into()) };
    let given = Obstacle { direction: GapDirection::Nearest, ..Obstacle::at_rest(socket) };
    for (x, facing) in points.iter().zip(above(&cube, &given, &points)) {
        let from = minus(*x, [0.5, 0.4, 0.3]);
        assert!((facing.gap - (2.0 - norm(from))).abs() < 1e-15);
        assert!(norm(minus(facing.normal, unit(from))) < 1e-15);
    }
}

#[test]
fn obstacles_that_do_not_suit_the_dimension_are_refused() {
    let (plane, cube) = (block(&[1.0, 1.0], &[1, 1]), block(&[1.0, 1.0, 1.0], &[1, 1, 1]));
    let refused =
        |mesh: &Mesh, given: &Obstacle| PlacedObstacle::new(mesh, mesh.boundary("top").unwrap(), given).unwrap_err();
    let at_rest = Obstacle::at_rest;
    let cylinder = |axis| at_rest(Shape::Cylinder { radius: 1.0, place: Place::Apex([0.0, 1.0, 0.0].into()), axis });
    let sphere = at_rest(Shape::Sphere { radius: 1.0, place: Place::Apex([0.0, 1.0, 0.0].into()) });
    assert!(matches!(refused(&plane, &sphere), ObstacleError::OnlyInSpace("sphere")));
    assert!(matches!(refused(&cube, &cylinder(None)), ObstacleError::NoAxis));
    assert!(matches!(refused(&cube, &cylinder(Some(Z.into()))), ObstacleError::SkewAxis));
    assert!(matches!(refused(&plane, &cylinder(Some([1.0, 0.0, 0.0].into()))), ObstacleError::OutOfPlane("the axis")));
    let upwards = Obstacle { normal: Some(Z.into()), ..at_rest(Shape::Plane { gap: 0.0 }) };
    assert!(matches!(refused(&plane, &upwards), ObstacleError::OutOfPlane("the normal")));
    let away = Obstacle { translation: Some(vec![(0.0, Z.into())]), ..at_rest(Shape::Plane { gap: 0.0 }) };
    assert!(matches!(refused(&plane, &away), ObstacleError::OutOfPlane("the translation")));
    // A boundary of two opposite sides faces nothing.
    let mut both = cube.clone();
    let bottom = both.boundary("bottom").unwrap().facets.clone();
    both.boundaries.iter_mut().find(|boundary| boundary.name == "top").unwrap().facets.extend(bottom);
    let plane_at_rest = at_rest(Shape::Plane { gap: 0.0 });
    assert!(matches!(refused(&both, &plane_at_rest), ObstacleError::NoNormal));
    let upwards = Obstacle { normal: Some(Z.into()), ..plane_at_rest };
    let top = both.boundary("top").unwrap();
    assert!(PlacedObstacle::new(&both, top, &upwards).unwrap().faces_away(&both, top).is_some());
    let table = at_rest(Shape::Table { file: "nowhere.csv".into(), scale: 1.0 });
    assert!(matches!(refused(&plane, &table), ObstacleError::Table(_)));
}

/// Normal motion closes the gap, tangential motion drifts, a turning disc drifts by angle × radius however
/// far it turns, and the obstacle is found where it was.
#[test]
fn motions_of_a_plane_over_a_cube() {
    let mesh = block(&[1.0, 1.0, 1.0], &[2, 2, 2]);
    let rotation =
        Rotation { axis: Some(Z.into()), through: [0.5, 0.5, 0.0].into(), history: vec![[0.0, 0.0], [1.0, 20.0 * PI]] };
    let given = Obstacle {
        translation: Some(vec![(0.0, [0.0; 3].into()), (2.0, [0.2, -0.4, -1e-3].into())]),
        rotation: Some(rotation),
        ..Obstacle::at_rest(Shape::Plane { gap: 1e-3 })
    };
    let x = [0.75, 0.5, 1.0];
    let facing = above(&mesh, &given, &[x])[0];
    assert_eq!(facing.tangents, [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0]]);
    let motion = ObstacleMotion::new(&given, facing.normal, 2.0);
    let mut sum = [0.0; 3];
    for (rates, history) in motion.rates(&[x], &[facing]) {
        // At t = 1, the end of the rotation and the middle of the translation.
        let factor = if history[1][0] == 2.0 { 0.5 * history[1][1] } else { history[1][1] };
        let [t, o] = rates[0].drift;
        sum.iter_mut().zip([rates[0].gap, t, o]).for_each(|(sum, rate)| *sum += factor * rate);
    }
    assert!(close(&sum, &[-5e-4, 0.1, -0.2 + 20.0 * PI * 0.25]), "{sum:?}");
    assert!((motion.gap(2.0, x, &facing)).abs() < 1e-18);
    let obstacle = PlacedObstacle::new(&mesh, mesh.boundary("top").unwrap(), &given).unwrap();
    assert!((motion.smallest_gap(&obstacle, x, &facing, &[0.5, 2.0], |_| 0.0)).abs() < 1e-18);
    // Neither a plane that slides nor one that turns about its normal bends.
    let corrections = motion.corrections(&obstacle, &[x], &[facing], &[0.0, 0.3, 1.0, 2.0]);
    assert_eq!(corrections, None);
    let quarter =
        Rotation { axis: Some(Z.into()), through: [0.5, 0.5, 0.0].into(), history: vec![[0.0, 0.0], [1.0, PI / 2.0]] };
    let turned = ObstacleMotion::new(&Obstacle { rotation: Some(quarter), ..given }, facing.normal, 2.0);
    let (back, n) = turned.back(1.0, [0.6 + 0.1, 0.75 - 0.2, 1.0 - 5e-4], Z);
    assert!(close(&back, &[0.75, 0.4, 1.0]) && close(&n, &Z), "{back:?}");
}

/// A round or oblique surface that moves along changes the gap by its slope; one that turns about its own axis
/// does not change it.
#[test]
fn leaning_surfaces_change_the_gap_as_they_pass() {
    let mesh = block(&[1.0, 1.0], &[2, 2]);
    let top = mesh.boundary("top").unwrap();
    let along = Some(vec![(0.0, [0.0, 0.0].into()), (1.0, [1.0, 0.0].into())]);
    let x = [0.8, 1.0, 0.0];
    let rates = |given: &Obstacle| {
        let obstacle = PlacedObstacle::new(&mesh, top, given).unwrap();
        let motions = ObstacleMotion::new(given, obstacle.normal, 1.0).rates(&[x], &[obstacle.at(x)]);
        (motions[0].0[0].gap, motions[0].0[0].drift[0])
    };
    // A circle of radius 0.5 about (0.5, 1.5): 3-4-5 at 0.3 aside, slope 3/4; the first tangent is -x.
    let round =
        Obstacle::at_rest(Shape::Cylinder { radius: 0.5, place: Place::Apex([0.5, 1.0, 0.0].into()), axis: None });
    let (gap, drift) = rates(&Obstacle { translation: along.clone(), ..round.clone() });
    assert!((gap + 0.75).abs() < 1e-14 && drift == -1.0, "{gap} {drift}");
    let rotation =
        Rotation { axis: Some(Z.into()), through: [0.5, 1.5, 0.0].into(), history: vec![[0.0, 0.0], [1.0, 1.0]] };
    let (gap, drift) = rates(&Obstacle { rotation: Some(rotation), ..round });
    // At the node itself, 0.5 below the axis, the surface passes with 0.5.
    assert!(gap.abs() < 1e-15 && (drift + 0.5).abs() < 1e-15, "{gap} {drift}");
    let formula = Shape::Formula(Formula::parse("0.5 * (x - 0.5)^2").unwrap());
    let (gap, _) = rates(&Obstacle { translation: along, ..Obstacle::at_rest(formula) });
    assert!((gap + 0.3).abs() < 1e-9, "{gap}");
}

#[test]
fn bad_obstacles_get_one_message() {
    let kind = "kind = \"plane\", motion = { translation = [[0, 0, 0], [1, 0, 0], [2, 0.5, 0]] }";
    for (obstacle, message) in [
        ("kind = \"plane\", gap = -0.3", "the obstacle starts 300 mm inside the body"),
        ("kind = \"plane\", gap = -0.05, approach = [[0, 0.1]]", "the obstacle starts 150 mm"),
        (
            "kind = \"formula\", formula = \"sqrt(x - 0.5)\"",
            "the formula has no finite value at the contact node at (0, 0) m",
        ),
        ("kind = \"formula\", formula = \"x +\"", "the formula: "),
        ("kind = \"formula\", formula = \"r\"", "`r` is neither x, y nor z"),
        ("kind = \"table\", file = \"none.csv\"", "none.csv: the table of gaps cannot be read"),
        ("kind = \"plane\", normal = [0, 1]", "points into the body at `bottom`"),
        ("kind = \"sphere\", radius = 1.0, apex = [0, 0]", "the obstacle is a sphere, but the body has two dimensions"),
        ("kind = \"plane\", direction = \"nearest\"", "a plane, a formula and a table have no direction"),
        ("kind = \"plane\", gap = 0, through = [0, 0]", "a plane has both gap and through"),
        ("kind = \"plane\", radius = 1.0", "a plane has no radius"),
        ("kind = \"wedge\", apex = [0, 0], angle = 2.0", "angle is 2.0, but must be between 0 and pi/2"),
        ("kind = \"plane\", motion = { translation = [[1, 0, 0], [0, 0, 0]] }", "translation is not a list of points"),
        ("kind = \"plane\", normal = [0, -1, 0, 0]", "invalid length 4, expected 2 or 3 values"),
    ] {
        let scene = Scene::parse("bad.toml", &BELT.replace(kind, obstacle), &[]);
        let said = match scene {
            Err(error) => error.to_string(),
            Ok(scene) => discretise(&scene).unwrap_err().to_string(),
        };
        assert!(said.starts_with("bad.toml:") && said.contains(message), "`{message}`: {said}");
    }
}

/// The label is on what is wrong within the formula, also on a line of its own.
#[test]
fn a_bad_formula_is_marked_where_it_is_wrong() {
    let kind = "kind = \"plane\", motion = { translation = [[0, 0, 0], [1, 0, 0], [2, 0.5, 0]] }";
    let marked = |formula: &str| {
        let text = BELT.replace(kind, &format!("kind = \"formula\", formula = {formula}"));
        let error = Scene::parse("bad.toml", &text, &[]).unwrap_err();
        let label = error.labels().unwrap().next().unwrap();
        text[label.offset()..label.offset() + label.len()].to_string()
    };
    assert_eq!(marked("\"0.5 * (x - r)^2\""), "r");
    assert_eq!(marked("'2 + 3x'"), "x");
    assert_eq!(marked("\"\"\"\n0.5 * x^2\n+ foo(y)\"\"\""), "foo");
    assert_eq!(marked("\"x +\""), "");
    // Escapes are longer in the file than in the formula.
    assert_eq!(marked("\"x\\t+ r\""), "\"x\\t+ r\"");
}

/// What an obstacle or a load would do after the end is neither a contradiction nor a measure of anything.
#[test]
fn what_lies_beyond_the_end_does_not_count() {
    let scene = |obstacle: &str, history: &str| {
        let obstacle =
            format!("contact.obstacle={{ kind = \"cylinder\", radius = 5.0, apex = [0.5, -1e-3], {obstacle} }}");
        common::block(&[&obstacle, &format!("load[1].history={history}")])
    };
    let within = scene(
        "approach = [[0, 0], [1, 1e-3], [2, 1.2e-3]], motion.translation = [[0, 0, 0], [2, 0.2, 0]], \
         motion.rotation = { through = [0.5, -5.0], history = [[0, 0], [2, 0.1]] }",
        "[[0, 0], [2, 0.5]]",
    );
    let overhanging = scene(
        "approach = [[0, 0], [1, 1e-3], [2, 1.2e-3], [100, 0.5]], motion.translation = [[0, 0, 0], [4, 0.4, 0]], \
         motion.rotation = { through = [0.5, -5.0], history = [[-1, 0], [0, 0], [2, 0.1], [3, 9.0]] }",
        "[[0, 0], [4, 1]]",
    );
    let [within, beyond] = [within, overhanging].map(|scene| discretise(&scene).unwrap());
    assert_eq!(within.loading, beyond.loading);
    assert_eq!(within.contact.obstacles[0].1, beyond.contact.obstacles[0].1);
    let deepest = beyond.loading.largest_interference();
    assert!(0.0 < deepest && deepest < 3e-4, "{deepest}");
    // Supports hold the left end of the bottom, which the obstacle would come to only later.
    let reaches = |end: &str| {
        let late = ["contact.obstacle.approach=[[0, 0], [2, 5e-6], [100, 0.5]]", end];
        discretise(&common::block(&late)).err().map(|error| error.to_string())
    };
    assert_eq!(reaches("time.end=2"), None);
    assert!(reaches("time.end=3").unwrap().contains("supports hold the body"));
}
