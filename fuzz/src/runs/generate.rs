//! Cases by chance.

use super::case::{Action, Body, Case, Contact, Load, Motion, Scalar, Shape, Support};
use crate::random::Random;

const SOLVERS: [&str; 10] = [
    "",
    "",
    "",
    "",
    "",
    "method = 'ip'\n",
    "setting = 'paper'\n",
    "linear = 'auto'\n",
    "method = 'events'\n",
    "method = 'ip'\nsetting = 'paper'\n",
];

impl Case {
    /// Some case: sound, but not always held, and not always solvable.
    pub fn random(random: &mut Random) -> Self {
        let dimension = if random.percent(70) { 2 } else { 3 };
        let length = random.decades(-3.0, 1.0);
        let two = random.percent(12);
        let plane = if dimension == 3 { "" } else { random.one(&["strain", "strain", "stress", "axisymmetric"]) };
        let cells = match (two, dimension) {
            (true, 2) => "quadrilateral",
            (true, _) => "hexahedron",
            (false, 2) => random.one(&["quadrilateral", "quadrilateral", "triangle", "triangle6"]),
            (false, _) => random.one(&["hexahedron", "hexahedron", "hexahedron", "tetrahedron", "prism"]),
        };
        let element = match (cells, plane) {
            ("quadrilateral", "stress") => "bilinear",
            ("quadrilateral" | "hexahedron" | "prism", _) => random.one(&["bilinear", "bilinear", "b-bar"]),
            _ => "bilinear",
        };
        let young = random.decades(6.0, 12.0);
        let mut bodies = vec![body(random, dimension, length, young, "lower")];
        if two {
            let softer = young * random.decades(-1.0, 1.0);
            let mut upper = body(random, dimension, length, softer, "upper");
            let below = &bodies[0];
            let share = random.between(0.5, 1.0);
            upper.at[0] = below.size[0] * random.between(0.0, 1.0 - share);
            upper.at[dimension - 1] = below.size[dimension - 1];
            upper.size[0] = below.size[0] * share;
            upper.size[1] = if dimension == 3 { below.size[1] } else { upper.size[1] };
            bodies.push(upper);
        }
        let end = random.one(&[1.0, 1.0, 2.0, 0.125, 1e3]);
        let mut case = Case {
            dimension,
            cells,
            element,
            plane,
            bodies,
            density: random.decades(2.0, 4.0),
            expansion: random.decades(-6.0, -4.0),
            layers: Vec::new(),
            supports: Vec::new(),
            contacts: Vec::new(),
            spring: None,
            loads: Vec::new(),
            end,
            increments: 1 + random.below(4),
            solver: random.one(&SOLVERS),
        };
        if (dimension, case.solver) == (3, SOLVERS[8]) {
            case.solver = "";
        }
        if !two && random.percent(10) {
            let height = case.bodies[0].size[dimension - 1];
            case.layers.push([0.4137 * height, young * random.decades(-3.0, 3.0), 0.3]);
        }
        hold(random, &mut case);
        touch(random, &mut case);
        load(random, &mut case);
        case
    }
}

fn body(random: &mut Random, dimension: usize, length: f64, young: f64, name: &'static str) -> Body {
    let most = if dimension == 2 { 6 } else { 3 };
    let mut sizes = [0; 3].map(|_: i32| length * random.one(&[1.0, 1.0, 0.5, 2.0, 0.3, 5.0]));
    let mut elements = [0; 3].map(|_: i32| 1 + random.below(most));
    let grading = [0; 3].map(|_: i32| if random.percent(15) { random.decades(-1.0, 1.0) } else { 1.0 });
    if dimension == 2 {
        (sizes[2], elements[2]) = (0.0, 0);
    }
    let poisson = random.one(&[0.3, 0.3, 0.0, 0.25, 0.45, -0.3]);
    Body { name, at: [0.0; 3], size: sizes, elements, grading, young, poisson }
}

/// Points of one to four stretches: to 1 at first, to anything after.
fn history(random: &mut Random, end: f64) -> Vec<[f64; 2]> {
    let stretches = 1 + random.below(4);
    let later = |k: usize, random: &mut Random| {
        let value = if k == 1 { 1.0 } else { random.one(&[0.0, 1.0, -1.0, 0.5, 2.0]) };
        [end * k as f64 / stretches as f64, value]
    };
    let points: Vec<[f64; 2]> = (1..=stretches).map(|k| later(k, random)).collect();
    [[0.0, 0.0]].into_iter().chain(points).collect()
}

fn boundary(case: &Case, side: &'static str) -> &'static str {
    match (case.bodies.len(), side) {
        (1, side) => side,
        (_, "bottom") => "lower:bottom",
        (_, "left") => "upper:left",
        (_, "right") => "upper:right",
        _ => "upper:top",
    }
}

fn hold(random: &mut Random, case: &mut Case) {
    let all: Vec<usize> = (0..case.dimension).collect();
    let up = case.dimension - 1;
    let (deep, end, turned) = (-random.decades(-5.0, -3.0), case.end, case.plane == "axisymmetric");
    let fixed = |side, fix| Support { boundary: boundary(case, side), fix, displacement: None, history: Vec::new() };
    let moved = |random: &mut Random, body: &Body, sideways: f64| {
        let moved = |k: usize| {
            if k == up {
                deep
            } else if k == 0 {
                sideways
            } else {
                0.0
            }
        };
        let displacement = all.iter().map(|&k| body.size[up] * moved(k)).collect();
        Support { displacement: Some(displacement), history: history(random, end), ..fixed("top", all.clone()) }
    };
    let supports = match (&case.bodies[..], random.below(10)) {
        ([_, _], 0..=6) => vec![fixed("bottom", all.clone())],
        ([_, upper], _) => vec![fixed("bottom", all.clone()), moved(random, upper, 0.0)],
        (_, 0..=3) if !turned => vec![fixed("left", all.clone())],
        (_, 4..=5) if !turned => vec![fixed("left", vec![0])],
        ([body], 6..=7) => {
            let sideways = if turned { 0.0 } else { deep * random.one(&[0.0, 1.0, -1.0]) };
            vec![moved(random, body, sideways)]
        }
        _ => Vec::new(),
    };
    case.supports = supports;
    if case.supports.is_empty() && random.percent(40) {
        let stiffness = 0.1 * case.bodies[0].young / case.bodies[0].size[up];
        case.spring = Some(("right", stiffness, 0.5 * stiffness));
    }
}

fn friction(random: &mut Random, case: &Case) -> Scalar {
    let constant = match random.below(8) {
        0 => 0.0,
        1..=4 => random.between(0.0, 0.3),
        5..=6 => random.between(0.3, 1.0),
        _ => random.between(1.0, 2.0),
    };
    let slope = if random.percent(12) { 0.1 / case.width() } else { 0.0 };
    // A formula that is 0 at an end is less than 0 there after rounding.
    let constant = if slope > 0.0 { constant.max(0.01) } else { constant };
    Scalar { constant, slope: [slope, 0.0, 0.0], ..Scalar::default() }
}

fn touch(random: &mut Random, case: &mut Case) {
    let up = case.dimension - 1;
    let size = case.bodies[0].size;
    if case.bodies.len() == 2 {
        let friction = friction(random, case);
        let shape = Shape::Body { boundary: "lower:top" };
        let contact =
            Contact { boundary: "upper:bottom", friction, history: None, shape, nearest: false, motion: Motion::None };
        case.contacts.push(contact);
        return;
    }
    let small = random.decades(-6.0, -3.0) * size[up] * random.one(&[0.0, 1.0, 1.0, -1.0]);
    let apex = [
        size[0] * random.between(0.0, 1.0),
        if case.dimension == 3 { size[1] * random.between(0.0, 1.0) } else { -small },
        -small,
    ];
    let (nearest, axis) = (random.percent(20), random.below(2));
    let bent = case.plane != "axisymmetric";
    let shape = match random.below(10) {
        5..=6 if bent => {
            let round: &[&str] = if case.dimension == 3 {
                &["sphere", "cylinder", "socket", "bore"]
            } else {
                &["cylinder", "cylinder", "bore"]
            };
            let kind = random.one(round);
            let mut radius = size[0] * random.decades(-0.5, 2.0);
            let mut apex = apex;
            if ["socket", "bore"].contains(&kind) {
                // Wide enough for the body, and so much lower that its corners are not in the wall.
                let longest = size[0].max(size[1]);
                radius = longest * random.decades(0.7, 2.0);
                apex[up] -= longest * longest / radius;
            }
            Shape::Round { kind, radius, apex, axis }
        }
        7 if bent => {
            let kind = if case.dimension == 3 { random.one(&["cone", "wedge"]) } else { "wedge" };
            let lean = random.decades(-3.0, -0.5);
            let angle = if kind == "cone" { std::f64::consts::FRAC_PI_2 - lean } else { lean };
            Shape::Edge { kind, angle, apex, axis }
        }
        8..=9 => {
            let slope = [random.one(&[0.0, 1e-4, -1e-3]), 0.0, 0.0];
            let curve = random.one(&[0.0, 1e-3]) / size[0];
            Shape::Formula { gap: Scalar { constant: small, slope, curve, middle: random.between(0.0, size[0]) } }
        }
        _ => Shape::Plane { gap: small },
    };
    let formula = matches!(shape, Shape::Formula { .. } | Shape::Plane { .. });
    let (end, far) = (case.end, random.decades(-5.0, -3.0) * size[up]);
    let motion = match random.below(10) {
        0 => Motion::Approach(scaled(history(random, end), far)),
        1 if bent => Motion::Translation([1.0, 0.0, 0.0], scaled(history(random, end), far)),
        2 if bent => {
            let angles = scaled(history(random, end), random.decades(-5.0, -3.0));
            Motion::Rotation(size.map(|l| 0.5 * l), angles)
        }
        _ => Motion::None,
    };
    let changes = random.percent(8) && friction_stays_above(case);
    let history = changes.then(|| vec![[0.0, 1.0], [end, random.one(&[0.0, 0.5, 1.5])]]);
    let friction = friction(random, case);
    let history = history.filter(|_| friction.constant > 0.0);
    case.contacts.push(Contact { boundary: "bottom", friction, history, shape, nearest: nearest && !formula, motion });
    for (side, share) in [("right", 15), ("top", 6), ("left", 6)] {
        let is_supported = case.supports.iter().any(|support| support.boundary == side);
        if random.percent(share) && !is_supported && (case.plane != "axisymmetric" || side != "left") {
            let gap = random.decades(-6.0, -3.0) * size[up] * random.one(&[1.0, -1.0]);
            let contact = Contact {
                boundary: side,
                friction: self::friction(random, case),
                history: None,
                shape: Shape::Plane { gap },
                nearest: false,
                motion: Motion::None,
            };
            case.contacts.push(contact);
        }
    }
}

/// The method `events` asks for friction that stays.
fn friction_stays_above(case: &Case) -> bool {
    !case.solver.contains("events")
}

fn scaled(history: Vec<[f64; 2]>, by: f64) -> Vec<[f64; 2]> {
    history.into_iter().map(|[time, value]| [time, by * value]).collect()
}

fn load(random: &mut Random, case: &mut Case) {
    let (up, end) = (case.dimension - 1, case.end);
    let body = case.bodies.last().unwrap_or(&case.bodies[0]).clone();
    let stress = body.young * random.decades(-6.0, -3.0);
    let bent = case.plane != "axisymmetric";
    let sloped = |random: &mut Random, value: f64| Scalar {
        constant: value,
        slope: [if random.percent(15) { 0.5 * value / body.size[0] } else { 0.0 }, 0.0, 0.0],
        ..Scalar::default()
    };
    let (top, right) = (boundary(case, "top"), boundary(case, "right"));
    if random.percent(85) {
        let action = if random.percent(40) {
            Action::Pressure(top, sloped(random, stress))
        } else {
            let mut traction = [Scalar::default(); 3];
            traction[up] = sloped(random, -stress);
            if bent && random.percent(40) {
                traction[0] = (stress * random.between(-0.5, 0.5)).into();
            }
            Action::Traction(top, traction)
        };
        case.loads.push(Load { action, history: history(random, end) });
    }
    if bent && random.percent(50) {
        let mut traction = [Scalar::default(); 3];
        let push = stress * random.between(-1.0, 1.0);
        traction[0] = sloped(random, push);
        if case.dimension == 3 {
            traction[1] = (stress * random.between(-0.5, 0.5)).into();
        }
        case.loads.push(Load { action: Action::Traction(right, traction), history: history(random, end) });
    }
    if random.percent(10) {
        let mut acceleration = [0.0; 3];
        acceleration[up] = -stress / (case.density * body.size[up]);
        if bent {
            acceleration[0] = acceleration[up] * random.one(&[0.0, 0.3, -0.3]);
        }
        case.loads.push(Load { action: Action::Acceleration(acceleration), history: history(random, end) });
    }
    if random.percent(10) {
        let temperature = sloped(random, stress / body.young / case.expansion);
        case.loads.push(Load { action: Action::Temperature(temperature), history: history(random, end) });
    }
}
