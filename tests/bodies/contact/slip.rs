//! A joint that friction alone holds slips as a whole where its loads exceed all friction, and the run ends there at once.

use crate::common::prelude::*;
use std::fmt::Write;

fn run(text: &str, overrides: &[&str]) -> RunReport {
    let scene = parsed_with(text, overrides);
    Run::new(&scene).unwrap().solve(&mut ()).unwrap()
}

/// The iterations of the increment that failed, and the most of one that converged.
fn iterations(report: &RunReport) -> [usize; 2] {
    let (last, before) = report.increments.split_last().unwrap();
    [last.iterations, before.iter().map(|record| record.iterations).max().unwrap()]
}

/// Runs with both methods and linear solvers, a little below and above the factor `limit` of a load, in one increment from
/// 90 % on. No run may say that the joint slips below the limit.
fn slips_beyond(text: &str, limit: f64, near: f64, load: &str, solvers: &[&str]) {
    for solver in solvers {
        for method in ["bn", "ip"] {
            for (share, status) in [(1.0 - near, Status::Converged), (1.0 + near, Status::Slips)] {
                let history = format!("{load}.history=[[0,0],[1,0],[2,{}],[3,{}]]", 0.9 * limit, share * limit);
                let chosen = [format!("solver.method=\"{method}\""), format!("solver.linear=\"{solver}\""), history];
                let chosen: Vec<&str> = chosen.iter().map(String::as_str).collect();
                let report = run(text, &[&chosen[..], &["time.end=3", "time.increments=3"]].concat());
                assert_eq!(report.status, status, "{chosen:?}: {}", report.explanation.reason);
            }
        }
    }
}

/// The whole system: condensed equations take more iterations until a joint is seen to slip, 6 where converged increments of
/// the block on a floor take 2, and 43 where those of the bolted bracket take 9.
fn whole() -> String {
    format!("solver.linear=\"{}\"", LinearAlgebra::default())
}

const SOLVERS: [&str; 4] = ["umfpack", "faer", "partial", "condensed"];

fn floor(space: bool) -> String {
    let (size, elements, press, push) = if space {
        ("[2.0, 1.0, 1.0]", "[4, 3, 3]", "[0, 0, -5e6]", "[8e6, 0, 0]")
    } else {
        ("[2.0, 1.0]", "[8, 4]", "[0, -5e6]", "[8e6, 0]")
    };
    format!(
        r#"
        mesh = {{ kind = "block", size = {size}, elements = {elements} }}
        material = {{ young = 210e9, poisson = 0.3 }}
        contact = [{{ boundary = "bottom", friction = 0.4, obstacle = {{ kind = "plane" }} }}]
        load = [
            {{ boundary = "top", traction = {press}, history = [[0, 1]] }},
            {{ boundary = "left", traction = {push} }},
        ]
        time = {{ end = 1, increments = 7 }}
        "#
    )
}

/// The limit is μ N = .4 · 10 MN, at half of the push.
#[test]
fn a_block_on_a_floor() {
    for (space, along) in [(false, "(1, 0)"), (true, "(1, 0, 0)")] {
        let report = run(&floor(space), &[&whole()]);
        assert_eq!(report.status, Status::Slips, "{}", report.explanation.reason);
        let slip = report.explanation.slip.as_ref().unwrap();
        assert_eq!(slip.motion, format!("the body slides along {along}"));
        let [from, by] = slip.between;
        assert!(from <= 0.5 && 0.5 < by && by - from < 0.2 / 7.0, "{from} {by}");
        assert_eq!(slip.factors.iter().map(|changing| changing.load).collect::<Vec<_>>(), [1]);
        assert!((slip.force.unwrap() - 4e6).abs() < 10.0 && slip.moment.is_none(), "{slip:?}");
        assert!((slip.friction_used - from / 0.5).abs() < 1e-6, "{slip:?}");
        let [last, most] = iterations(&report);
        assert!(last <= 2 * most, "{last} {most}");
        let reason = &report.explanation.reason;
        assert!(reason.split(' ').count() < 70 && !reason.contains("support"), "{reason}");
        slips_beyond(&floor(space), 0.5, 0.01, "load[1]", &SOLVERS);
    }
}

/// The push is a quarter of the limit when the pressure begins to fall, to no more than it takes at t = 2.75.
#[test]
fn a_block_whose_pressure_falls() {
    let push = "load[1].history=[[0,0],[1,0.125],[2,0.125],[3,0.125]]";
    for (space, method) in [(false, "bn"), (false, "ip"), (false, "events"), (true, "bn")] {
        let loads = ["load[0].history=[[0,1],[2,1],[3,0]]", push, "time.end=3", "time.increments=12"];
        let report = run(&floor(space), &[&loads[..], &[&format!("solver.method=\"{method}\""), &whole()]].concat());
        assert_eq!(report.status, Status::Slips, "{space} {method}: {}", report.explanation.reason);
        let [from, by] = report.explanation.slip.as_ref().unwrap().between;
        println!("{space} {method}: {from} {by}");
        assert!(from <= 2.75 + 1e-6 && 2.75 <= by, "{space} {method}: {from} {by}");
    }
}

/// A node in two contacts has friction at each: a wall that is never touched takes none from the floor, and a wall that is let go
/// leaves a block that slides along the floor. The exact path has none there, and says so.
#[test]
fn a_corner_before_a_wall() {
    let wall = |floor: String, side: &str, gap: f64| {
        let wall =
            format!("{{ boundary = \"{side}\", friction = 0.2, obstacle = {{ kind = \"plane\", gap = {gap} }} }}]");
        let floor = floor.replace("[8, 4]", "[2, 1]").replace("[4, 3, 3]", "[2, 1, 2]");
        floor.replace("\"plane\" } }]", &format!("\"plane\" }} }},\n{wall}"))
    };
    for space in [false, true] {
        slips_beyond(&wall(floor(space), "left", 0.5), 0.5, 0.02, "load[1]", &SOLVERS);
    }
    let pushed = wall(floor(false), "right", 0.0).replace("[8e6, 0]", "[-8e6, 0]");
    let warned = |report: &RunReport| {
        let kinds: Vec<WarningKind> = report.warnings.iter().map(|warning| warning.kind).collect();
        [WarningKind::FRICTION_LEFT_OUT, WarningKind::NOT_UNIQUE].map(|kind| kinds.contains(&kind))
    };
    for solver in SOLVERS {
        let report = run(&pushed, &[&format!("solver.linear=\"{solver}\"")]);
        let slip = report.explanation.slip.as_ref().unwrap();
        assert_eq!((report.status, slip.motion.as_str()), (Status::Slips, "the body slides along (-1, 0)"), "{solver}");
        assert!((0.98..1.01).contains(&slip.friction_used), "{solver}: {slip:?}");
    }
    let away = wall(floor(false), "left", 0.5);
    let held = run(&away, &["load[1].history=[[0,0],[1,0.4]]"]);
    assert_eq!((held.status, warned(&held)), (Status::Converged, [false, false]));
    let exact = run(&away, &["load[1].history=[[0,0],[1,0.1]]", "solver.method=\"events\""]);
    assert_eq!((exact.status, warned(&exact)), (Status::Converged, [true, false]));
}

/// A body in a corner gives way. It slides on one edge while it turns about another one, or leaves a floor although the friction
/// of a wall that it does not press could hold it. Both methods find that with all linear solvers, between the same times.
#[test]
fn a_corner_that_gives_way() {
    let turns = r#"
        mesh = { kind = "block", size = [1.0, 0.5], elements = [1, 1] }
        material = { young = 1e9, poisson = 0.3, density = 1.0 }
        contact = [
            { boundary = "bottom", friction = 0.8, obstacle = { kind = "plane" } },
            { boundary = "right", friction = 0.2, obstacle = { kind = "plane" } },
        ]
        load = [
            { acceleration = [8e5, -1e6], history = [[0, 0], [1, 1]] },
            { boundary = "right", traction = [7.5e5, 2.2e6], history = [[1, 0], [2, 1]] },
        ]
        time = { end = 2, increments = 8 }
    "#;
    let leaves = r#"
        mesh = { kind = "block", size = [1.0, 0.5], elements = [4, 2] }
        material = { young = 1e9, poisson = 0.3 }
        support = [{ boundary = "left", fix = ["x"] }]
        contact = [
            { boundary = "bottom", friction = 0.4, obstacle = { kind = "plane" } },
            { boundary = "right", friction = 0.4, obstacle = { kind = "plane", gap = 1e-3 } },
        ]
        load = [{ boundary = "top", traction = [0.0, 1e6], history = [[0, -1], [1, 1]] }]
        time = { end = 1, increments = 3 }
    "#;
    for (text, status) in [(turns, Status::Slips), (leaves, Status::NoEquilibrium)] {
        let mut between = [0.0_f64, f64::INFINITY];
        for solver in SOLVERS {
            for method in ["bn", "ip"] {
                let chosen = [format!("solver.method=\"{method}\""), format!("solver.linear=\"{solver}\"")];
                let report = run(text, &[&chosen[0], &chosen[1]]);
                assert_eq!(report.status, status, "{chosen:?}: {}", report.explanation.reason);
                if let Some(slip) = &report.explanation.slip {
                    assert_eq!(slip.motion, "the body turns about (0, 0) m", "{chosen:?}");
                    between = [between[0].max(slip.between[0]), between[1].min(slip.between[1])];
                }
            }
        }
        assert!(between[0] < between[1], "{between:?}");
    }
}

/// A pull takes pressure off a press fit, so that the friction of the last state would still suffice beyond the limit. All
/// ways to solve it find the slip, between the same times: for one element, at `t = 1 + 0.397727`.
#[test]
fn a_press_fit_that_is_pulled_out() {
    let fit = r#"
        mesh = { kind = "block", size = [1.0, 0.5], elements = [1, 1] }
        material = { young = 1000.0, poisson = 0.3 }
        contact = [
            { boundary = "bottom", friction = 0.3, obstacle = { kind = "plane", gap = -0.002 } },
            { boundary = "top", friction = 0.3, obstacle = { kind = "plane" } },
        ]
        load = [{ boundary = "right", traction = [10.54945054945055, 0.0], history = [[1, 0], [2, 1]] }]
        time = { end = 2, increments = 4 }
    "#;
    for elements in ["[1,1]", "[2,1]", "[3,2]"] {
        for solver in SOLVERS {
            for method in ["bn", "ip"] {
                let set = [
                    format!("solver.linear=\"{solver}\""),
                    format!("solver.method=\"{method}\""),
                    format!("mesh.elements={elements}"),
                ];
                let report = run(fit, &set.each_ref().map(String::as_str));
                assert_eq!(report.status, Status::Slips, "{set:?}: {}", report.explanation.reason);
                let [from, by] = report.explanation.slip.as_ref().unwrap().between;
                if elements == "[1,1]" {
                    assert!((from..by).contains(&1.397_727) && by - from < 0.1, "{set:?}: {from} {by}");
                }
            }
        }
    }
}

/// A press fit slips whatever another body does: that one slips in a part of its own contact.
#[test]
fn a_press_fit_beside_another_body() {
    let text = scene! { r#"
contact = [
{ boundary = "fit:bottom", friction = 0.1, obstacle = { kind = "plane", gap = -0.002 } },
{ boundary = "fit:top", friction = 0.1, obstacle = { kind = "plane" } },
{ boundary = "other:bottom", friction = 0.3, obstacle = { kind = "plane" } },
]
load = [
{ boundary = "fit:right", traction = [9.0, 0.0], history = [[1, 0], [2, 1]] },
{ boundary = "other:top", traction = [0.0, -1.0], history = [[0, 0], [1, 1]] },
{ boundary = "other:top", traction = [0.1, 0.0], history = [[1, 0], [2, 1]] },
]
time = { end = 2, increments = 8 }
[[body]] name = "fit", mesh = { kind = "block", size = [2.8, 0.5], elements = [8, 3] }
material = { young = 1000.0, poisson = 0.35 }
[[body]] name = "other", at = [30, 0], mesh = { kind = "block", size = [1, 1], elements = [2, 2] }
material = { young = 1000.0, poisson = 0.3 }
"# };
    for solver in SOLVERS {
        for method in ["bn", "ip"] {
            let set = [format!("solver.linear=\"{solver}\""), format!("solver.method=\"{method}\"")];
            let report = run(&text, &set.each_ref().map(String::as_str));
            assert_eq!(report.status, Status::Slips, "{set:?}: {}", report.explanation.reason);
        }
    }
}

/// A force that lifts is no slip, and one that tips neither.
#[test]
fn what_lifts_or_tips_does_not_slip() {
    for changes in
        [["contact.friction=0.4", "load[1].traction=[0, 12e6]"], ["contact.friction=10", "load[1].traction=[22e6, 0]"]]
    {
        let report = run(&floor(false), &changes);
        assert_eq!(report.status, Status::NoEquilibrium, "{changes:?}: {}", report.explanation.reason);
        assert!(report.explanation.slip.is_none());
    }
}

/// Two rings of quadrilaterals that share a circle: a shaft and a hub.
fn rings(around: usize, radial: usize) -> String {
    let (mut nodes, mut cells, mut count) = (String::new(), String::new(), 0);
    let mut elements = 0;
    for (of, [inner, outer]) in [[10.0, 20.0], [20.0, 40.0]].into_iter().enumerate() {
        let first = count;
        for j in 0..around {
            for i in 0..=radial {
                let r = inner + (outer - inner) * i as f64 / radial as f64;
                let (sin, cos) = (std::f64::consts::TAU * j as f64 / around as f64).sin_cos();
                count += 1;
                writeln!(nodes, "{count} {} {} 0", r * cos, r * sin).unwrap();
            }
        }
        let node = |i: usize, j: usize| first + 1 + (j % around) * (radial + 1) + i;
        let (bore, rim, body) = (1 + 2 * of, 2 + 2 * of, 5 + of);
        for j in 0..around {
            for (tag, i) in [(bore, 0), (rim, radial)] {
                elements += 1;
                writeln!(cells, "{elements} 1 2 {tag} {tag} {} {}", node(i, j), node(i, j + 1)).unwrap();
            }
            for i in 0..radial {
                elements += 1;
                let [a, b, c, d] = [node(i, j), node(i + 1, j), node(i + 1, j + 1), node(i, j + 1)];
                writeln!(cells, "{elements} 3 2 {body} {body} {a} {b} {c} {d}").unwrap();
            }
        }
    }
    format!(
        "$MeshFormat\n2.2 0 8\n$EndMeshFormat\n$PhysicalNames\n6\n1 1 \"shaft bore\"\n1 2 \"shaft rim\"\n1 3 \"hub \
         bore\"\n1 4 \"hub rim\"\n2 5 \"shaft\"\n2 6 \"hub\"\n$EndPhysicalNames\n$Nodes\n{count}\n{nodes}$EndNodes\n\
         $Elements\n{elements}\n{cells}$EndElements\n"
    )
}

/// The pressure comes from the interference, so that no rigid body tells the limit: μ Σ p_n r.
#[test]
fn a_press_fit_under_torque() {
    let mesh = Scratch::new("press-fit.msh", rings(24, 2).as_bytes());
    let text = format!(
        r#"
        units = {{ length = "mm", stress = "MPa" }}
        mesh = {{ kind = "gmsh", file = "{}" }}
        material = {{ young = 210e3, poisson = 0.3, plane = "stress" }}
        support = [{{ boundary = "shaft bore", fix = ["x", "y"] }}]
        contact = [{{ boundary = "hub bore", against = "shaft rim", friction = 0.12, gap = -0.02 }}]
        coupling = [{{ name = "arm", boundary = "hub rim", kind = "distributing" }}]
        load = [{{ coupling = "arm", moment = 40000, history = [[0, 0], [1, 0], [2, 1]] }}]
        time = {{ end = 2, increments = 10 }}
        "#,
        mesh.path()
    );
    let report = run(&text, &[]);
    assert_eq!(report.status, Status::Slips, "{}", report.explanation.reason);
    let slip = report.explanation.slip.as_ref().unwrap();
    assert_eq!(slip.motion, "`hub` turns about (0, 0) mm");
    let limit = slip.moment.unwrap() / 4e4;
    let [[from, by]] = slip.factors.iter().map(|changing| changing.between).collect::<Vec<_>>()[..] else {
        panic!("{slip:?}")
    };
    assert!(from < limit && limit < by && by - from < 0.03, "{from} {limit} {by}");
    // The pressure is about that of cylinders, 87 MPa on a circle of 20 mm.
    assert!(
        (slip.moment.unwrap() / (0.12 * 87e6 * std::f64::consts::TAU * 0.02 * 0.02) - 1.0).abs() < 0.05,
        "{slip:?}"
    );
    let [last, most] = iterations(&report);
    assert!(last <= 4 && most <= last, "{last} {most}");
    // The exact path ends where the increments stop.
    let exact = run(&text, &["solver.method=\"events\""]);
    assert_eq!(exact.status, Status::Slips);
    let end = exact.explanation.slip.as_ref().unwrap();
    assert_eq!(end.motion, slip.motion);
    assert!(
        (end.factors[0].between[0] / limit - 1.0).abs() < 1e-6 && (end.friction_used - 1.0).abs() < 1e-6,
        "{end:?}"
    );
    slips_beyond(&text, limit, 0.01, "load[0]", &SOLVERS);
}

/// A bracket that a bolt head presses on a wall: both sides of it slip.
const BRACKET: &str = r#"
    time = { end = 2.0, increments = 10 }
    units = { length = "mm", stress = "MPa" }
    body = [
        { name = "wall", mesh = { kind = "block", size = [60, 40, 20], elements = [4, 3, 1] }, material = { young = 210e3, poisson = 0.3 } },
        { name = "bracket", at = [10, 5, 20], mesh = { kind = "block", size = [60, 30, 8], elements = [5, 3, 1] }, material = { young = 70e3, poisson = 0.33 } },
        { name = "head", at = [20, 12, 28], mesh = { kind = "block", size = [16, 16, 8], elements = [2, 2, 1] }, material = { young = 210e3, poisson = 0.3 } },
    ]
    support = [
        { boundary = "wall:bottom", fix = ["x", "y", "z"] },
        { boundary = "head:top", fix = ["x", "y", "z"], displacement = [0, 0, -0.01], history = [[0, 0], [1, 1]] },
    ]
    contact = [
        { boundary = "bracket:bottom", against = "wall:top", friction = 0.2 },
        { boundary = "head:bottom", against = "bracket:top", friction = 0.15 },
    ]
    load = [{ boundary = "bracket:right", traction = [40, 4, 0], history = [[1, 0], [2, 1]] }]
"#;

#[test]
fn a_bolted_bracket_in_space() {
    for method in ["bn", "ip"] {
        let report = run(BRACKET, &[&format!("solver.method=\"{method}\""), &whole()]);
        assert_eq!(report.status, Status::Slips, "{}", report.explanation.reason);
        let slip = report.explanation.slip.as_ref().unwrap();
        assert!(slip.motion.starts_with("`bracket` turns about the axis through "), "{slip:?}");
        let [last, most] = iterations(&report);
        assert!(last <= 2 * most, "{last} {most}");
        let [from, by] = slip.factors[0].between;
        assert!(by - from < 0.03 && (0.9..=1.0).contains(&slip.friction_used), "{slip:?}");
        if method == "bn" {
            slips_beyond(BRACKET, 0.5 * (from + by), 0.03, "load[0]", &["umfpack", "condensed"]);
        }
    }
}

/// After all loads are gone nothing but rounding presses the block: that its place is not unique is told by all methods and
/// linear solvers alike.
#[test]
fn a_block_without_loads_is_free() {
    let text = "
        time = { end = 2.0, increments = 4 }
        mesh = { kind = \"block\", size = [1.0, 0.5], elements = [8, 4] }
        material = { young = 1e9, poisson = 0.3 }
        contact = [{ boundary = \"bottom\", friction = 0.4, obstacle = { kind = \"plane\" } }]
        load = [{ boundary = \"top\", traction = [1e5, -1e6], history = [[0, 0], [1, 1], [2, 0]] }]
        ";
    for method in ["bn", "ip", "events"] {
        for solver in SOLVERS {
            let report = run(text, &[&format!("solver.method=\"{method}\""), &format!("solver.linear=\"{solver}\"")]);
            let warnings: Vec<_> =
                report.warnings.iter().filter(|warning| warning.kind == WarningKind::NOT_UNIQUE).collect();
            assert!(warnings.len() == 1 && warnings[0].message.contains("t = 2 s"), "{method} {solver}: {warnings:?}");
        }
    }
}

/// Another joint holds beside the one that slips: its loads and its stiffness are as large or small as one likes.
#[test]
fn a_large_joint_beside_a_small_one() {
    for factor in [1e-12, 1e-6, 1.0, 1e6, 1e12] {
        let body = |name: &str, x: f64, size: f64, push: f64| {
            format!(
                "[[body]]\nname = \"{name}\"\nat = [{x:?}, 0.0]\nmaterial = {{ young = {:?}, poisson = 0.3 }}\n\
                 mesh = {{ kind = \"block\", size = [1.0, 0.5], elements = [6, 3] }}\n\
                 [[contact]]\nboundary = \"{name}:bottom\"\nfriction = 0.3\nobstacle = {{ kind = \"plane\" }}\n\
                 [[load]]\nboundary = \"{name}:top\"\ntraction = [0.0, {:?}]\nhistory = [[0, 0], [1, 1]]\n\
                 [[load]]\nboundary = \"{name}:top\"\ntraction = [{:?}, 0.0]\nhistory = [[1, 0], [2, 1]]\n",
                1e9 * size,
                -1e6 * size,
                push * 1e6 * size
            )
        };
        let time = "time = { end = 2.0, increments = 10 }\n".to_string();
        let text = [time, body("one", 0.0, 1.0, 0.35), body("other", 2.0, factor, 0.1)].concat();
        for method in ["bn", "ip"] {
            let report = run(&text, &[&format!("solver.method=\"{method}\"")]);
            let reason = &report.explanation.reason;
            assert!(report.status == Status::Slips && reason.contains("`one`"), "{factor:e} {method}: {reason}");
        }
    }
}
