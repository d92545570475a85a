//! The output files requested by a scene.

#![allow(clippy::unwrap_used)]

use std::fs;

use crate::program::{Folder, assert_exit, csv, small, stderr, stdout, stickslip};

const PROBES: &str = "
every = 3
fields = true
deformed = true
[[output.probe]]
name = 'top corner'
point = [1, 1]
[[output.probe]]
name = 'top/corner'
from = [0, 1]
to = [1, 1]
points = 3
";

/// Every increment of the small block, with all outputs.
#[test]
fn a_scene_gets_what_it_asks_for() {
    let text = small().replace("times = [1.0, 2.0]", "times = [0.0, 0.5]");
    let (folder, scene) = Folder::with_scene(&[&text, PROBES].concat());
    let out = folder.join("out");
    assert_exit(&stickslip(&["run", &scene, "--out", &out, "--json"]), 0);
    let numbered = |prefix: &str, suffix: &str| [0, 1, 3, 4].map(|k| format!("{prefix}_000{k}.{suffix}"));
    let mut expected: Vec<String> = [("contact", "csv"), ("contact", "svg"), ("deformed", "svg"), ("fields", "vtu")]
        .into_iter()
        .flat_map(|(prefix, suffix)| numbered(prefix, suffix))
        .collect();
    let others =
        ["fields.pvd", "forces.csv", "forces.svg", "increments.csv", "iterations.svg", "report.html", "run.json"];
    expected.extend(others.map(String::from));
    expected.extend(["probe_top_corner.csv", "probe_top_corner-2.csv"].map(String::from));
    expected.sort();
    assert_eq!(folder.names("out"), expected);

    let (header, rows) = csv(&folder.0.join("out/probe_top_corner-2.csv"));
    assert_eq!(header, "index,time,point,x,y,u_x,u_y,s_xx,s_yy,s_zz,s_xy,von_mises");
    let places: Vec<String> = rows.iter().map(|row| row[..5].join(" ")).collect();
    assert_eq!(places[..4], ["0 0 1 0 1", "0 0 2 0.5 1", "0 0 3 1 1", "1 0.5 1 0 1"]);
    assert_eq!(rows.len(), 3 * 5);
    assert!(rows[..3].iter().all(|row| row[5..].iter().all(|field| field == "0")));
    let (_, corner) = csv(&folder.0.join("out/probe_top_corner.csv"));
    let moved = |row: &[String]| row[5..].iter().map(|field| field.parse::<f64>().unwrap()).collect::<Vec<_>>();
    assert_eq!(moved(&corner[4]), moved(&rows[14]));
    assert!(moved(&corner[4])[1] < -1e-6, "pressed down: {:?}", corner[4]);
    let series = fs::read_to_string(folder.0.join("out/fields.pvd")).unwrap();
    assert!(series.contains("timestep=\"0\" group=\"\" part=\"0\" file=\"fields_0000.vtu\""), "{series}");
    let (_, before) = csv(&folder.0.join("out/contact_0000.csv"));
    assert!(before.iter().all(|row| row[8] == "1e-5" && row[12] == "open"), "{before:?}");
    let (header, increments) = csv(&folder.0.join("out/increments.csv"));
    assert!(header.ends_with(",friction_work,strain_energy"));
    assert!(increments.iter().all(|row| row.last().unwrap().parse::<f64>().unwrap() > 0.0));

    // Another run removes all of them.
    let (_other, plain) = Folder::with_scene(&small());
    assert_exit(&stickslip(&["run", &plain, "--out", &out]), 0);
    let names = folder.names("out");
    assert!(names.iter().all(|name| !name.starts_with("probe") && !name.starts_with("deformed")), "{names:?}");
    assert_eq!(names.len(), 4 + 6);
}

/// The substeps of a halved increment for which contact nodes are requested.
#[test]
fn parts_of_increments_are_written() {
    let (folder, scene) = Folder::with_scene(&small());
    let out = folder.join("out");
    let arguments = ["material.poisson=0.49", "time.increments=2", "solver.max_iterations=5", "output.times=[1.0]"];
    let set = arguments.iter().flat_map(|set| ["--set", *set]);
    let set: Vec<&str> = set.chain(["--set", "mesh.elements=[20,20]", "--setting", "default", "--out", &out]).collect();
    let output = stickslip(&[&["run", &scene], &set[..]].concat());
    assert_exit(&output, 0);
    let report: serde_json::Value =
        serde_json::from_str(&fs::read_to_string(folder.0.join("out/run.json")).unwrap()).unwrap();
    let ends = |k: usize| report["increments"][k]["part_ends"].as_array().map_or(1, Vec::len);
    assert!(ends(0) > 1, "nothing was halved: the test has lost its case\n{}", stdout(&output));
    assert_eq!(report["increments"][0]["part_ends"].as_array().unwrap().last().unwrap(), 1.0);
    let written = |increment: usize| {
        let prefix = format!("contact_000{increment}-");
        folder.names("out").into_iter().filter(|name| name.starts_with(&prefix)).count()
    };
    assert_eq!((written(1), written(2)), (ends(0) - 1, 0));
    assert_eq!(csv(&folder.0.join("out/contact_0001-1.csv")).0, csv(&folder.0.join("out/contact_0001.csv")).0);
}

#[test]
fn a_probe_beside_the_body_is_told_by_check_and_run() {
    let (folder, scene) = Folder::with_scene(&[&small(), "[[output.probe]]\nname = 'a'\npoint = [2, 0]\n"].concat());
    for command in [&["check", &scene][..], &["run", &scene, "--out", &folder.join("out")]] {
        let output = stickslip(command);
        assert_exit(&output, 2);
        let text = stderr(&output).replace("\n  │ ", " ");
        assert!(text.contains("scene.toml:47: the point (2, 0) m is outside of the body"), "{text}");
        assert!(text.contains("the nearest node is at (1, 0)"), "{text}");
    }
    assert!(!folder.0.join("out").exists());
}

/// With several obstacles in front of a boundary, the force on each and the obstacle that each node meets are reported.
/// With one obstacle, neither is.
#[test]
fn several_obstacles_are_told_apart() {
    let rollers = "[{ kind = \"cylinder\", radius = 50.0, apex = [0.5, 0] }, { kind = \"plane\", gap = 1e-5 }]";
    let text = small().replace("{ kind = \"plane\", gap = 1e-5 }", rollers).replace("\"paper\"", "\"default\"");
    let (folder, scene) = Folder::with_scene(&text);
    let (out, report) = (folder.join("out"), folder.join("out/run.json"));
    let said = stickslip(&["run", &scene, "--out", &out]);
    assert_exit(&said, 0);
    assert!(stdout(&said).contains(" of it on contact[0].obstacle[1]\n"), "{}", stdout(&said));
    let report: serde_json::Value = serde_json::from_str(&fs::read_to_string(report).unwrap()).unwrap();
    let (header, rows) = csv(&folder.0.join("out/forces.csv"));
    assert_eq!(
        header,
        "index,time,boundary,f_x,f_y,m_z,sum_p_n,sum_p_t,kind,balance,obstacle,u_x,u_y,slip_state,friction_used"
    );
    let (head, nodes) = csv(&folder.0.join("out/contact_0004.csv"));
    assert!(head.ends_with(",t_x,t_y,sigma_along,sigma_across,von_mises,obstacle"), "{head}");
    let column = |name: &str| head.split(',').position(|column| column == name).unwrap();
    let number = |text: &String| text.parse::<f64>().unwrap();
    let mut sums = [0.0; 5];
    for (k, key) in ["contact[0].obstacle[0]", "contact[0].obstacle[1]"].into_iter().enumerate() {
        let own: Vec<_> = nodes.iter().filter(|node| node.last().unwrap() == key).collect();
        assert!(!own.is_empty() && own.len() < nodes.len());
        let line = rows.iter().rfind(|row| row[10] == key).unwrap();
        assert_eq!((line[0].as_str(), line[2].as_str(), line[8].as_str()), ("4", "bottom", "obstacle"));
        let of = |node: &[String]| {
            let [x, y, f_x, f_y, p_n, p_t] = ["x", "y", "f_x", "f_y", "p_n", "p_t"].map(|c| number(&node[column(c)]));
            [f_x, f_y, x * f_y - y * f_x, p_n, p_t]
        };
        let expected =
            own.iter().map(|node| of(node)).fold([0.0; 5], |sum, of| [0, 1, 2, 3, 4].map(|c| sum[c] + of[c]));
        let found = [3, 4, 5, 6, 7].map(|c| number(&line[c]));
        let on = &report["boundaries"][0]["obstacles"][k];
        assert_eq!(on["obstacle"], key);
        let reported = [&on["force"][0], &on["force"][1], &on["moment"][0], &on["sum_p_n"], &on["sum_p_t"]];
        assert!(expected[3] > 1e4, "{expected:?}");
        for c in 0..5 {
            assert!((found[c] - expected[c]).abs() < 1e-9 * expected[3], "{found:?} {expected:?}");
            assert!((reported[c].as_f64().unwrap() - found[c]).abs() <= 1e-15 * found[c].abs(), "{on}");
            sums[c] += found[c];
        }
    }
    let whole = rows.iter().rfind(|row| row[8] == "contact").unwrap();
    assert!([0, 1, 2, 3, 4].iter().all(|&c| (number(&whole[3 + c]) - sums[c]).abs() < 1e-9 * sums[3]), "{whole:?}");
    assert_eq!((whole[10].as_str(), &report["forces"][3]["obstacles"]), ("", &report["boundaries"][0]["obstacles"]));

    let (folder, scene) = Folder::with_scene(&small());
    assert_exit(&stickslip(&["run", &scene, "--out", &folder.join("out")]), 0);
    for file in ["forces.csv", "contact_0004.csv", "run.json"] {
        assert!(!fs::read_to_string(folder.0.join("out").join(file)).unwrap().contains("obstacles"), "{file}");
        assert!(!fs::read_to_string(folder.0.join("out").join(file)).unwrap().contains(",obstacle"), "{file}");
    }
}
