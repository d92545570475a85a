//! `stickslip capacity` against closed forms.

use serde_json::Value;

use crate::program::{Folder, stickslip};

/// A body on a plane, pressed by the first load and pushed by the second one.
fn scene(size: &str, elements: &str, against: &str, loads: [&str; 2], more: &str) -> String {
    let [press, push] = loads;
    format!(
        "mesh = {{ kind = \"block\", size = {size}, elements = {elements} }}\n\
         material = {{ young = 210e9, poisson = 0.3 }}\n\
         {more}\n\
         [[contact]]\nboundary = \"bottom\"\nfriction = 0.3\nobstacle = {against}\n\
         [[load]]\nboundary = \"top\"\n{press}\nhistory = [[0, 0], [1, 1]]\n\
         [[load]]\nboundary = \"left\"\n{push}\nhistory = [[1, 0], [2, 1]]\n\
         [time]\nend = 2\nincrements = 4\n"
    )
}

fn capacity(text: &str, load: usize, more: &[&str]) -> (Option<i32>, Value) {
    let (_folder, path) = Folder::with_scene(text);
    let output = stickslip(&[&["capacity", &path, "--json", "--load", &load.to_string()], more].concat());
    let error = String::from_utf8_lossy(&output.stderr).replace('│', "");
    let error = Value::from(error.split_whitespace().collect::<Vec<_>>().join(" "));
    (output.status.code(), serde_json::from_slice(&output.stdout).unwrap_or(error))
}

#[test]
fn capacities_are_those_of_closed_forms() {
    let plane = "{ kind = \"plane\" }";
    let flat = |press, push, more| scene("[2, 1]", "[8, 4]", plane, [press, push], more);
    // A plane that rises by 0.1 rad along x: the weight drives the body down, against the push.
    let [sin, cos] = [0.1_f64.sin(), 0.1_f64.cos()];
    let inclined = format!("{{ kind = \"formula\", formula = \"0 * x\", normal = [{sin}, {}] }}", -cos);
    let solid = |push| scene("[2, 2, 1]", "[4, 4, 2]", plane, ["force = [0, 0, -1000]", push], "");
    let cases = [
        ("pushed", flat("force = [0, -1000]", "force = [100, 0]", ""), 3.0),
        ("pulled", flat("force = [0, -1000]", "force = [-100, 0]", ""), 3.0),
        ("pushed too much", flat("force = [0, -1000]", "force = [400, 0]", ""), 0.75),
        // A push of 30 s that lifts by 10 s: 30 s = 0.3 (1000 - 10 s).
        // A push that has grown before the end of the history.
        ("pushed early", flat("force = [0, -1000]", "force = [100, 0]", "").replace("[2, 1]]", "[1.5, 1]]"), 3.0),
        ("lifted", flat("force = [0, -1000]", "force = [30, 10]", ""), 0.3 * 1000.0 / (30.0 + 0.3 * 10.0)),
        ("pressed besides", flat("force = [0, -1000]", "force = [30, -10]", ""), 0.3 * 1000.0 / (30.0 - 0.3 * 10.0)),
        (
            "up the slope",
            scene("[2, 1]", "[8, 4]", &inclined, ["force = [0, -1000]", "force = [100, 0]"], ""),
            10.0 * (sin + 0.3 * cos) / (cos - 0.3 * sin),
        ),
        (
            "down the slope",
            scene("[2, 1]", "[8, 4]", &inclined, ["force = [0, -1000]", "force = [-100, 0]"], ""),
            10.0 * (0.3 * cos - sin) / (cos + 0.3 * sin),
        ),
        ("along x", solid("force = [50, 0, 0]"), 6.0),
    ];
    for (name, text, expected) in cases {
        let (status, found) = capacity(&text, 1, &[]);
        let [holds, slips] = [0, 1].map(|k| found["between"][k].as_f64().unwrap_or(f64::NAN));
        assert!(holds <= expected * 1.001 && slips >= expected * 0.999 && slips / holds < 1.003, "{name}: {found}");
        assert_eq!(status, Some(i32::from(expected < 1.0)), "{name}");
    }
    // The exact path finds the very load.
    let (_, found) = capacity(&flat("force = [0, -1000]", "force = [100, 0]", ""), 1, &["--method", "events"]);
    assert!(found["safety"].as_f64().is_some_and(|safety| (safety - 3.0).abs() < 1e-9), "{found}");
    // More pressure never lets it slip.
    let (status, found) = capacity(&flat("force = [0, -1000]", "force = [100, 0]", ""), 0, &[]);
    assert_eq!((status, &found["between"]), (Some(0), &Value::Null), "{found}");
    for (load, more, message) in [
        (2, &[][..], "there is no load[2]: the scene has 2 loads"),
        (1, &["--set", "load[1].history=[[1,0],[1.5,1],[2,0]]"], "load[1] is 0 at the end"),
    ] {
        let (status, error) = capacity(&flat("force = [0, -1000]", "force = [100, 0]", ""), load, more);
        assert!(status == Some(2) && error.to_string().contains(message), "{error}");
    }
}

/// Points of histories after the end of the scene do not count.
#[test]
fn friction_and_obstacles_stay_as_they_are_at_the_end() {
    let text = scene("[2, 1]", "[8, 4]", "{ kind = \"plane\" }", ["force = [0, -1000]", "force = [100, 0]"], "");
    for later in [
        "contact.friction_history=[[0,1],[2,1],[4,0.5]]",
        "contact.obstacle.approach=[[0,0],[2,0],[4,0.1]]",
        "contact.obstacle.motion.translation=[[2,0,0],[4,0.1,0]]",
    ] {
        let (_, found) = capacity(&text, 1, &["--set", later]);
        let [holds, slips] = [0, 1].map(|k| found["between"][k].as_f64().unwrap_or(f64::NAN));
        assert!(holds <= 3.003 && slips >= 2.997 && slips / holds < 1.003, "{later}: {found}");
    }
}

/// A press fit under a pull, of which less than the friction is left for the torque, also if the torque makes it slip before
/// the whole pull is there; close to the capacity a run may fail.
#[test]
fn a_fit_under_torque_has_a_capacity() {
    let fit = concat!(env!("CARGO_MANIFEST_DIR"), "/../../data/tutorials/press-fit-torque.toml");
    let growing = "contact.friction_history=[[0,1e-3],[0.9,1e-3],[1,1]]";
    let full = "contact.friction_history=[[0,1]]";
    for (pull, torque, friction, expected) in [
        ("load[1].force=[0,20e3,0]", 500.0, growing, 873.5),
        ("load[1].force=[0,20e3,0]", 500.0, full, 873.5),
        ("load[1].force=[0,20e3,0]", 2000.0, growing, 873.5),
        ("load[1].force=[0,0,0]", 500.0, growing, 975.3),
        ("load[1].force=[0,0,0]", 500.0, full, 975.3),
    ] {
        let moment = format!("load[0].moment={torque}e3");
        let options = ["capacity", fit, "--json", "--load", "0", "--set", pull, "--set", friction, "--set", &moment];
        let found: Value = serde_json::from_slice(&stickslip(&options).stdout).unwrap();
        let [holds, slips] = [0, 1].map(|k| torque * found["between"][k].as_f64().unwrap_or(f64::NAN));
        let close = holds < 1.002 * expected && slips > 0.998 * expected && slips / holds < 1.02;
        assert!(close, "{pull}, {torque} N m: {found}");
    }
}

/// A body that a force in its middle holds down tips over where half of it pulls at an edge; numbers are in the units of
/// the scene.
#[test]
fn a_body_that_tips_over_has_a_capacity() {
    let text = scene(
        "[20, 10]",
        "[4, 2]",
        "{ kind = \"plane\" }",
        ["force = [0, -1000]", "force = [0, 250]"],
        "thickness = 8",
    );
    let mm = "units = { length = \"mm\", stress = \"MPa\" }\n";
    let text =
        text.replace("poisson = 0.3 }\nthickness = 8", "poisson = 0.3, thickness = 8 }").replace("210e9", "210e3");
    let (_, found) = capacity(&format!("{mm}{text}"), 1, &[]);
    let [holds, gives_way] = [0, 1].map(|k| found["between"][k].as_f64().unwrap_or(f64::NAN));
    assert!(holds <= 2.0 && gives_way >= 2.0 && gives_way / holds < 1.003, "{found}");
    assert!(found["held"].as_str().unwrap().ends_with(" N") && found["units"]["force"]["name"] == "N", "{found}");
    let text = text.replace("force = [0, 250]", "force = [100, 0]");
    let (_, found) = capacity(&format!("{mm}{text}"), 1, &[]);
    let force = found["slip"]["force"].as_f64().unwrap_or(f64::NAN);
    assert!((force / 300.0 - 1.0).abs() < 5e-3 && found["held"].as_str().unwrap().starts_with('('), "{found}");
}

/// A bolt does not slip, but its plates part.
#[test]
fn a_joint_that_opens_is_told() {
    let bolt = concat!(env!("CARGO_MANIFEST_DIR"), "/../../data/scenes/bolt.toml");
    let output = stickslip(&["capacity", bolt, "--json"]);
    let found: Value = serde_json::from_slice(&output.stdout).unwrap();
    assert_eq!(found["opens"]["boundary"], "plate:bottom");
    let by_name = stickslip(&["capacity", bolt, "--json", "--load", "plate:right"]);
    let by_name: Value = serde_json::from_slice(&by_name.stdout).unwrap();
    assert_eq!(by_name["opens"], found["opens"]);
    let wrong = stickslip(&["capacity", bolt, "--load", "plate"]);
    assert!(wrong.status.code() == Some(2) && String::from_utf8_lossy(&wrong.stderr).contains("plate:right"));
    let opens = [0, 1].map(|k| found["opens"]["between"][k].as_f64().unwrap());
    assert!(1.2 < opens[0] && opens[0] < 1.34 && 1.34 < opens[1] && opens[1] < 1.4, "{found}");
}

/// A block on a floor that a spring holds at last: it slips at 0.3 times its weight, and the increments in which that is found are
/// a quarter of the push long.
#[test]
fn a_contact_that_slips_wholly_before_is_told() {
    let spring = "[[spring]]\nboundary = \"right\"\nnormal = 1e7";
    let text = scene("[2, 1]", "[8, 4]", "{ kind = \"plane\" }", ["force = [0, -1000]", "force = [100, 0]"], spring);
    let (status, found) = capacity(&text, 1, &[]);
    let factors = &found["slips_before"][0]["between"];
    let [sticks, slips] = [0, 1].map(|k| factors[k].as_f64().unwrap());
    assert!(
        status == Some(0) && found["safety"].is_null() && found["slips_before"][0]["boundary"] == "bottom",
        "{found}"
    );
    assert!(sticks < 3.0 + 1e-9 && 3.0 <= slips + 1e-9 && slips - sticks < 0.51, "{found}");
    let said = format!("`bottom` begins to slip wholly between load[1] times {sticks:.4} and {slips:.4}");
    assert!(found["message"].as_str().unwrap().ends_with(&said), "{found}");
}
