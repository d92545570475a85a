//! The exact path in the program: its table of events, and its end.

#![allow(clippy::unwrap_used)]

use std::fs;

use crate::program::{Folder, WHOLE, assert_exit, json, small, stickslip};

/// A beam that is pressed against a wall at 45 degrees and then drawn along it. The beam is much softer across its axis
/// than along it, so it moves off the wall when it slides in one direction. With friction above 1 no quasi-static
/// motion continues.
pub const OBLIQUE_BEAM: &str = r#"
[mesh]
kind = "block"
size = [1.0, 0.05]
elements = [20, 1]
[material]
young = 210e9
poisson = 0.3
[[support]]
boundary = "left"
fix = ["x", "y"]
[[contact]]
boundary = "right"
friction = 3.0
obstacle = { kind = "formula", formula = "0 * y", normal = [0.7071067811865475, -0.7071067811865475] }
[[load]]
boundary = "right"
traction = [2e6, -2e6]
history = [[0, 0], [1, 1], [3, 1]]
[[load]]
boundary = "right"
traction = [12e6, 12e6]
history = [[0, 0], [1, 0], [3, 1]]
[time]
end = 3.0
increments = 5
[solver]
method = "events"
"#;

/// Returns the columns of a table of events without the position, and each line.
fn events(folder: &Folder) -> Vec<Vec<String>> {
    let table = fs::read_to_string(folder.join("out/events.csv")).unwrap();
    table.lines().map(|line| line.split(',').map(str::to_string).collect()).collect()
}

#[test]
fn each_change_of_status_is_a_line() {
    let (folder, scene) = Folder::with_scene(&small());
    let out = folder.join("out");
    for linear in [WHOLE, "condensed"] {
        let run = stickslip(&["run", &scene, "--method", "events", "--solver", linear, "--out", &out, "--json"]);
        assert_exit(&run, 0);
        let report = json(&run);
        let [header, lines @ ..] = &events(&folder)[..] else { panic!("no table") };
        assert_eq!(header[..2], ["time", "index"]);
        assert_eq!(Some(lines.len() as u64), report["exact_path"]["events"].as_u64());
        assert!(lines.len() > 3, "{lines:?}");
        let column = |name: &str| header.iter().position(|column| column == name).unwrap();
        let times: Vec<f64> = lines.iter().map(|line| line[0].parse().unwrap()).collect();
        assert!(times.is_sorted(), "{times:?}");
        for line in lines {
            assert_ne!(line[column("from")], line[column("to")], "{line:?}");
            let increment = &report["increments"][line[1].parse::<usize>().unwrap() - 1];
            assert!(line[0].parse::<f64>().unwrap() <= increment["time"].as_f64().unwrap() + 1e-12);
        }
    }
}

#[test]
fn a_lost_path_tells_how_far_friction_is_beyond_its_critical_value_and_bn_jumps_there() {
    let (_folder, scene) = Folder::with_scene(OBLIQUE_BEAM);
    for linear in [WHOLE, "condensed"] {
        let run = stickslip(&["run", &scene, "--solver", linear, "--json"]);
        assert_exit(&run, 1);
        let report = json(&run);
        assert_eq!(report["status"], "no-continuation");
        // At half of the time, f_t is three times f_n, and p_t = 3 p_n.
        assert!((report["exact_path"]["lost"]["time"].as_f64().unwrap() - 2.0).abs() < 1e-9);
        // With axial stiffness only, k_nn = k_tt, and k_tn is nearly as large.
        let critical = 3.0 * report["critical_friction"]["factor"].as_f64().unwrap();
        assert!((1.0..1.05).contains(&critical), "{critical}");

        // BN goes on to a state that the laws of an increment allow, and says where it jumps.
        let run = stickslip(&["run", &scene, "--solver", linear, "--method", "bn", "--json"]);
        assert_exit(&run, 0);
        let report = json(&run);
        let warned = report["warnings"].as_array().unwrap().iter().find(|warning| warning["kind"] == "jump").unwrap();
        assert!(warned["message"].as_str().unwrap().contains("between t = 2 s and t = 2.00001 s"), "{warned}");
    }
}

/// A block that is pulled to and fro with a friction beyond the critical value.
const TO_AND_FRO: &str = r#"
    [mesh]
    kind = "block"
    size = [1.0, 1.0]
    elements = [10, 10]
    [material]
    young = 210e9
    poisson = 0.3
    [[support]]
    boundary = "left"
    fix = ["x", "y"]
    [[contact]]
    boundary = "bottom"
    friction = 5.5
    obstacle = { kind = "plane", gap = 1e-5 }
    [[load]]
    boundary = "top"
    traction = [0.0, -1e7]
    history = [[0, 0], [0.5, 6], [2, 1]]
    [[load]]
    boundary = "right"
    traction = [1e7, 0.0]
    history = [[0, 0], [0.5, 6], [1, -6], [1.5, 6], [2, -3]]
    [time]
    end = 2.0
    increments = 300
"#;

/// An increment across the end of the motion is halved, and the jump is in one of its substeps. It is told with any number
/// of increments.
#[test]
fn a_jump_in_a_substep_is_told() {
    let (_folder, scene) = Folder::with_scene(TO_AND_FRO);
    for increments in [300, 500] {
        let increments = format!("time.increments={increments}");
        let report = json(&stickslip(&["run", &scene, "--set", &increments, "--json"]));
        assert_eq!(report["status"], "converged");
        let kinds = report["warnings"].as_array().unwrap().iter().map(|warning| warning["kind"].as_str().unwrap());
        assert_eq!(kinds.filter(|kind| *kind == "jump").count(), 1, "{increments}");
    }
}

/// Increments of BN and IP, however short, lead across the end of the quasi-static motion, which is reported. With less
/// friction there is no such end.
#[test]
fn an_increment_that_leads_over_the_end_of_the_motion_is_told() {
    let (_folder, scene) = Folder::with_scene(OBLIQUE_BEAM);
    let jumps = |method: &str, increments: usize, friction: f64| {
        let set = [format!("time.increments={increments}"), format!("contact.friction={friction}")];
        let run = ["run", &scene, "--method", method, "--set", &set[0], "--set", &set[1], "--json"];
        let report = json(&stickslip(&run));
        assert_eq!(report["status"], "converged");
        let warnings = report["warnings"].as_array().unwrap().iter();
        warnings.filter(|warning| warning["kind"] == "jump").map(|warning| warning["message"].to_string()).collect()
    };
    for (method, increments) in [("bn", 6), ("bn", 300), ("ip", 30)] {
        let messages: Vec<String> = jumps(method, increments, 3.0);
        assert!(
            messages.len() == 1 && messages[0].contains("jump by 100 % of their largest value between t = 2 s"),
            "{messages:?}"
        );
    }
    let none: Vec<String> = jumps("bn", 60, 0.9);
    assert!(none.is_empty(), "{none:?}");
}
