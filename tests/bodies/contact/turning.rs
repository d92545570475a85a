//! Obstacles that turn and pass: gaps of every kind are exact at any angle, a back does not press, and only what touches leans.

use crate::common::prelude::*;
use stickslip::body::Facing;

/// The gaps of the bottom of `mesh` at t = 1 s, in front of a `shape` that turns by `angle` until then about `axis` through a point.
fn turned(mesh: &Mesh, shape: Shape, (axis, through): ([f64; 3], [f64; 3]), angle: f64) -> Vec<f64> {
    let short = |x: [f64; 3]| x[..mesh.dimension].to_vec().try_into().unwrap();
    let rotation =
        Rotation { axis: Some(axis.into()), through: short(through), history: vec![[0.0, 0.0], [1.0, angle]] };
    let given = Obstacle { rotation: Some(rotation), ..Obstacle::at_rest(shape) };
    let bottom = mesh.boundary("bottom").unwrap();
    let obstacle = PlacedObstacle::new(mesh, bottom, &given).unwrap();
    let motion = ObstacleMotion::new(&given, obstacle.normal, 1.0);
    // As a model sees it, what is not in front of a node at first is as far as the boundary is long.
    let facing = |x: [f64; 3]| match obstacle.at(x) {
        Facing { gap, normal, .. } if gap.is_nan() => Facing { gap: 1.0, inward: normal, ..obstacle.at(x) },
        facing => facing,
    };
    let gap = |node: &usize| motion.exact_gap(&obstacle, 1.0, mesh.nodes[*node], &facing(mesh.nodes[*node]));
    bottom.nodes().iter().map(gap).collect()
}

fn formula(text: &str) -> Shape {
    Shape::Formula(Formula::parse(text).unwrap())
}

/// A table of gaps in a file of its own.
fn table(name: &str, text: &str) -> (Scratch, Shape) {
    let file = Scratch::new(name, text.as_bytes());
    let shape = Shape::Table { file: file.0.clone(), scale: 1.0 };
    (file, shape)
}

/// A plane, a wedge and a circle, by their shapes and by their gaps: to first order in the angle, as sin θ for tan θ, the gaps of
/// fields would be off by up to half their size.
#[test]
fn fields_of_gaps_turn_as_the_shapes_they_are() {
    let square = block(&[1.0, 0.5], &[10, 2]);
    let about = ([0.0, 0.0, 1.0], [0.3, -0.2, 0.0]);
    let (_plane, flat) = table("flat.csv", "x,gap\n-4,0.1\n5,0.1\n");
    let (_wedge, roof) = table("roof.csv", "x,gap\n-5.5,0.7\n0.5,0.1\n6.5,0.7\n");
    let wedge = || Shape::Wedge { apex: [0.5, -0.1].into(), angle: 0.1_f64.atan(), axis: None };
    let circle = Shape::Cylinder { radius: 3.0, place: Place::Apex([0.5, -0.1].into()), axis: None };
    for (shape, field) in [
        (Shape::Plane { gap: 0.1 }, formula("0.1")),
        (Shape::Plane { gap: 0.1 }, flat),
        (wedge(), formula("0.1 + 0.1 * abs(x - 0.5)")),
        (wedge(), roof),
        (circle, formula("3.1 - sqrt(9 - (x - 0.5)^2)")),
    ] {
        for angle in [1e-9, 0.01, -0.3, 0.7, -1.0] {
            let (exact, found) = [&shape, &field].map(|shape| turned(&square, shape.clone(), about, angle)).into();
            let error = exact.iter().zip(&found).fold(0.0_f64, |m, (a, b)| m.max((a - b).abs()));
            assert!(error < 4e-15, "{field:?} by {angle}: {exact:?} {found:?}");
        }
    }
    // In space, about an oblique axis.
    let cube = block(&[1.0; 3], &[3; 3]);
    let about = ([0.48, 0.6, 0.64], [0.3, 0.9, -0.2]);
    let sphere = Shape::Sphere { radius: 3.0, place: Place::Apex([0.5, 0.4, -0.1].into()) };
    let cap = formula("3.1 - sqrt(9 - (x - 0.5)^2 - (y - 0.4)^2)");
    for angle in [0.2, -0.6] {
        let (exact, found) = [&sphere, &cap].map(|shape| turned(&cube, shape.clone(), about, angle)).into();
        let error = exact.iter().zip(&found).fold(0.0_f64, |m, (a, b)| m.max((a - b).abs()));
        assert!(error < 1e-14, "by {angle}: {exact:?} {found:?}");
    }
}

/// A plane that turns by θ about a point at its level is x tan θ away; beyond a right angle it has its back to the nodes, and those
/// that it does not cover have nothing before them. A wedge turns one side away and shows the other.
#[test]
fn a_back_does_not_press() {
    let square = block(&[1.0, 0.5], &[10, 2]);
    let about = |x: f64, y: f64| ([0.0, 0.0, 1.0], [x, y, 0.0]);
    for angle in [0.4, 1.5] {
        for (k, gap) in turned(&square, Shape::Plane { gap: 0.0 }, about(1.2, 0.0), angle).into_iter().enumerate() {
            let exact = (1.2 - 0.1 * k as f64) * angle.tan();
            assert!((gap - exact).abs() <= 1e-13 * exact, "{gap} {exact}");
        }
    }
    let extent = vec![1.0; 11];
    for angle in [1.6, 1.7, 2.4] {
        for shape in [Shape::Plane { gap: 0.01 }, formula("0.01")] {
            assert_eq!(turned(&square, shape, about(1.2, -0.01), angle), extent, "{angle}");
        }
    }
    let wedge = Shape::Wedge { apex: [0.55, -0.01].into(), angle: 1.4, axis: None };
    for (k, gap) in turned(&square, wedge, about(0.55, -0.01), 0.3).into_iter().enumerate() {
        let x = 0.1 * k as f64 - 0.55;
        let exact = if x > 0.0 { 0.01 + x * 1.1_f64.tan() } else { 1.0 };
        assert!((gap - exact).abs() < 1e-13, "{k}: {gap} {exact}");
    }
    // A roller that has gone round the body is above it, and not a body's height inside.
    let roller = Shape::Cylinder { radius: 0.05, place: Place::Apex([0.5, -0.01].into()), axis: None };
    assert_eq!(turned(&square, roller, about(0.5, 0.25), PI), extent);
}

scene! {
static SCENE = r#"
[mesh] kind = "block", size = [1.0, 0.2], elements = [20, 4]
[material] young = 1e9, poisson = 0.3
[[support]] boundary = "top", fix = ["x", "y"]
[[contact]] boundary = "bottom", friction = 0.1, obstacle = { OBSTACLE }
[time] end = 1.0, increments = 10
"# }

fn scene(obstacle: &str) -> String {
    SCENE.replace("OBSTACLE", obstacle)
}

/// What covers a node with its back is refused, by its name and with the time at which it first does.
#[test]
fn a_back_that_covers_the_body_is_refused() {
    for (shape, sense, place, time) in [
        ("kind = \"plane\", gap = 0.01", -2.0, 0, "0.8"),
        ("kind = \"formula\", formula = \"0.01\"", -2.0, 0, "0.8"),
        ("kind = \"plane\", gap = 0.01", 3.1, 1, "1"),
    ] {
        let motion = format!("motion.rotation = {{ through = [1.2, -0.01], history = [[0, 0], [1, {sense}]] }}");
        let text = scene(&format!("{shape}, {motion}"));
        let Err(stickslip::run::RunError::Scene(error)) = discretise(&parsed(&text)) else {
            panic!("accepted: {text}")
        };
        let says = format!("turns its back to the body and covers the contact node at ({place}, 0) m at t = {time} s");
        verify(&error, &text, line_of(&text, "obstacle ="), &says, "turn less far");
    }
}

/// The warnings of a scene's run.
fn warnings(text: &str) -> Vec<Warning> {
    let scene = parsed(text);
    let model = discretise(&scene).unwrap();
    Run::of(&model, scene.time.all(), scene.solver).unwrap().solve(&mut ()).unwrap().warnings
}

/// The kinds of the warnings that are not of the mesh, nor of the increments.
fn kinds(text: &str) -> Vec<WarningKind> {
    let of_others = [
        WarningKind::CONTACT_UNRESOLVED,
        WarningKind::CONTACT_COARSE,
        WarningKind::SINGULAR_EDGE,
        WarningKind::STICK_ZONE_COARSE,
        WarningKind::OBSTACLE_BETWEEN_NODES,
        WarningKind::LOCKING,
        WarningKind::COARSE_MESH,
        WarningKind::CURVED_GAPS,
        WarningKind::INCREMENTS_WORK,
        WarningKind::INCREMENTS_FORCE,
        WarningKind::SLOW_BLAS,
    ];
    let kinds = warnings(text).into_iter().map(|warning| warning.kind);
    kinds.filter(|kind| !of_others.contains(kind)).collect()
}

/// A roller that passes below the body between the ends of two increments, and one that turns about a line beside its own and lets go on the way, are
/// warned of; with short increments they are not.
#[test]
fn obstacles_that_pass_between_the_ends_of_increments_are_warned_of() {
    let passes = "kind = \"cylinder\", radius = 1.0, apex = [0.2, 1e-4], motion.translation = [[0, 0, 0], [1, 0.6, 0]]";
    let turns = "kind = \"cylinder\", radius = 1.0, apex = [0.5, 1e-4], \
                 motion.rotation = { through = [0.5, -1.0001], history = [[0, 0], [1, 12.566370614359172]] }";
    for (obstacle, few, many) in [(passes, 2, 200), (turns, 2, 100)] {
        let warned = [few, many].map(|n| {
            let text = scene(obstacle).replace("increments = 10", &format!("increments = {n}"));
            assert!(n == 10 || text != scene(obstacle));
            kinds_of_all(&text).contains(&WarningKind::CURVED_GAPS)
        });
        assert_eq!(warned, [true, false], "{obstacle}");
    }
}

fn kinds_of_all(text: &str) -> Vec<WarningKind> {
    warnings(text).into_iter().map(|warning| warning.kind).collect()
}

/// A roller leans against the nodes beside it, under which it has been or will be; that it does when it touches is nothing. A plane
/// that tips and touches leans by as much as it has tipped.
#[test]
fn only_what_touches_leans() {
    for (radius, from) in [(0.1, 0.2), (0.05, 0.2), (0.2, 0.1), (0.3, 0.25)] {
        let moves = "motion.translation = [[0, 0, 0], [1, 0.6, 0]]";
        let text = scene(&format!("kind = \"cylinder\", radius = {radius}, apex = [{from}, 1e-4], {moves}"));
        assert_eq!(kinds(&text), [], "{radius} {from}");
    }
    for (angle, leans) in [(0.05, None), (0.2, Some("inclined by 11 degrees"))] {
        let tips = format!("motion.rotation = {{ through = [1.0, 0.0], history = [[0, 0], [1, -{angle}]] }}");
        let found = warnings(&scene(&format!("kind = \"plane\", {tips}")));
        let leaning = found.iter().find(|warning| warning.kind == WarningKind::LEANING_OBSTACLE);
        match (leaning, leans) {
            (None, None) => {}
            (Some(warning), Some(says)) => assert!(warning.message.contains(says), "{warning:?}"),
            _ => panic!("{angle}: {found:?}"),
        }
    }
}

/// In front of a node under the very side of a roller the surface is as steep as one likes: its rate must not take the digits of
/// the gap that the node has later.
#[test]
fn gaps_of_nodes_under_the_side_keep_their_digits() {
    let moves = "motion.translation = [[0, 0, 0], [1, 0.6, 0]]";
    for side in [0.1, 0.1 - 1e-16, 0.1 - 1e-13, 0.1 - 1e-10, 0.1 - 1e-7] {
        let text = scene(&format!("kind = \"cylinder\", radius = 0.1, apex = [{}, 1e-4], {moves}", 0.5 - side));
        let model = model_of(&text);
        let node = model.contact.nodes.iter().position(|contact| (contact.position[0] - 0.5).abs() < 1e-9).unwrap();
        for k in 1..=3 {
            let t = 0.1 * f64::from(k);
            let s = 0.06 * f64::from(k) - side;
            let exact = -1e-4 + s * s / (0.1 + (0.01 - s * s).sqrt());
            let gap = model.loading.gaps_at(t)[node];
            assert!((gap - exact).abs() < 2e-15, "{side} at {t}: {gap} {exact}");
        }
    }
}

/// A node on the crest of a cylinder is pressed and does not move along the normal: what it moves aside is nothing beside what
/// the load presses in. Where it is not, the warning stays.
#[test]
fn a_pressed_crest_is_in_range() {
    let held = SCENE.replace("boundary = \"top\"\n", "boundary = \"left\"\n");
    let pressed = |load: &str| {
        let obstacle = "kind = \"cylinder\", radius = 0.4, apex = [0.5, 0]";
        held.replace("OBSTACLE", obstacle) + &format!("[[load]]\nboundary = \"top\"\ntraction = {load}\n")
    };
    for load in ["[0, -1e3]", "[1e3, 0]", "[0, -10]"] {
        assert!(!kinds(&pressed(load)).contains(&WarningKind::GAPS_OUT_OF_RANGE), "{load}");
    }
    // An edge that slides up a slope by more than it is pressed in.
    let wedge = "kind = \"wedge\", angle = 0.3, apex = [0.55, -1e-6]";
    let slides = held.replace("OBSTACLE", wedge) + "[[load]]\nboundary = \"top\"\ntraction = [1e7, -1e5]\n";
    assert!(kinds(&slides).contains(&WarningKind::GAPS_OUT_OF_RANGE));
}

/// A plane that turns until it stands upright lies along the lines on which gaps are measured: where it stands in the body it is
/// refused, and where it is beside it there is nothing in front.
#[test]
fn planes_that_stand_upright() {
    let upright = |through: &str, sense: &str| {
        let angle = std::f64::consts::FRAC_PI_2;
        let turns = format!("motion.rotation = {{ through = {through}, history = [[0, 0], [1, {sense}{angle}]] }}");
        discretise(&parsed(&scene(&format!("kind = \"plane\", gap = 1e-3, {turns}"))))
    };
    let found = ["", "-"].map(|sense| upright("[-0.5, 0.0]", sense).map(|_| ()).map_err(|error| error.to_string()));
    let refused: Vec<&String> = found.iter().filter_map(|found| found.as_ref().err()).collect();
    assert!(refused.len() == 1 && refused[0].contains("turns its back"), "{found:?}");
}

/// A smooth roller that turns about its own axis is where it was, also for nodes that see it steeply, or not at all.
#[test]
fn a_roller_that_turns_about_itself() {
    let forces = [0.0, 1.5, 30.0].map(|angle| {
        let text = format!(
            "[mesh]\nkind = \"block\"\nsize = [0.2, 0.1]\nelements = [32, 16]\n\
             [material]\nyoung = 1e7\npoisson = 0.3\n[[support]]\nboundary = \"top\"\nfix = [\"x\", \"y\"]\n\
             [[contact]]\nboundary = \"bottom\"\nfriction = 0\n\
             obstacle = {{ kind = \"cylinder\", radius = 0.02, center = [0.1, -0.019], \
             motion = {{ rotation = {{ through = [0.1, -0.019], history = [[0, 0], [1, {angle}]] }} }} }}\n\
             [time]\nend = 1.0\nincrements = 3\n"
        );
        let scene = parsed(&text);
        let report = Run::new(&scene).unwrap().solve(&mut ()).unwrap();
        assert_eq!(report.status, Status::Converged);
        report.end.sum_p_n
    });
    assert!(forces[0] > 1000.0 && forces.iter().all(|force| (force / forces[0] - 1.0).abs() < 1e-9), "{forces:?}");
}
