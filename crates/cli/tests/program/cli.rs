//! The program from a user's view: its output and its files.

// Given values are read back exactly.
#![allow(clippy::unwrap_used, clippy::float_cmp)]

use std::fs;
use std::path::Path;

use crate::common::edit;
use crate::program::{
    Folder, assert_exit, count, csv, json, number, report, small, stdout, stickslip, unbroken, without,
};
use serde_json::Value;

/// The verdict is last, before the place of the results; with --quiet little else is printed.
#[test]
fn the_verdict_is_where_the_eye_is() {
    let (folder, scene) = Folder::with_scene(&small());
    let long = stickslip(&["run", &scene]);
    let quiet = stickslip(&["run", &scene, "--quiet", "--out", &folder.join("out")]);
    for (output, results) in [(&long, "results      not written: --out FOLDER writes them"), (&quiet, "results      ")]
    {
        assert_exit(output, 0);
        let lines: Vec<&str> = stdout(output).lines().collect();
        let [.., verdict, last] = lines[..] else { panic!("{lines:?}") };
        assert!(verdict.starts_with("verdict      converged, 4 of 4 increments"), "{verdict}");
        assert!(last.starts_with(results), "{last}");
        assert!(lines.iter().any(|line| line.starts_with("pressure     ") && line.contains("MPa at most, ")));
    }
    // The title and warnings, then few lines.
    let text = unbroken(&quiet);
    let (head, results) = text.split_once("\n\n").unwrap();
    assert!(
        head.lines().skip(1).all(|line| line.starts_with("warning ") || line.starts_with("             ")),
        "{head}"
    );
    assert!(results.lines().count() <= 8, "{results}");
    assert!(stdout(&long).contains("\nlaws         error ") && !stdout(&quiet).contains("laws "));
}

#[test]
fn a_good_run_fills_its_folder() {
    let (folder, scene) = Folder::with_scene(&small());
    let out = folder.join("new/out");
    let output = stickslip(&["run", &scene, "--json", "--out", &out]);
    assert_exit(&output, 0);
    let lines = ["contact_0002.csv", "contact_0002.svg", "contact_0004.csv", "contact_0004.svg"];
    assert_eq!(
        folder.names("new/out"),
        [&lines[..], &["forces.csv", "forces.svg", "increments.csv", "iterations.svg", "report.html", "run.json"]]
            .concat()
    );

    let out = Path::new(&out);
    let (header, rows) = csv(&out.join("increments.csv"));
    assert!(header.starts_with("index,time,status,iterations,backtracks,theta,equilibrium,penetration,"), "{header}");
    assert!(header.contains(",backward_error,open,stick,slip,"), "{header}");
    assert_eq!(rows.len(), 4);
    for (k, row) in rows.iter().enumerate() {
        assert_eq!((&row[0], &row[2]), (&(k + 1).to_string(), &"converged".to_string()));
        assert_eq!(row[1].parse::<f64>().unwrap(), 0.5 * (k + 1) as f64);
    }

    for name in ["contact_0002", "contact_0004"] {
        let (header, rows) = csv(&out.join(name).with_extension("csv"));
        assert_eq!(
            header,
            "x,y,p_n,p_t,sigma_n,sigma_t,w_n,w_t,gap,slip_t,f_x,f_y,status,node,n_x,n_y,t_x,t_y,sigma_along,sigma_across,von_mises"
        );
        assert_eq!(rows.len(), 4);
        for row in &rows {
            assert!(["open", "stick", "slip"].contains(&row[12].as_str()), "{row:?}");
            assert!(row[..12].iter().all(|field| field.parse::<f64>().unwrap().is_finite()), "{row:?}");
        }
        let svg = fs::read_to_string(out.join(name).with_extension("svg")).unwrap();
        assert!(svg.starts_with("<svg") && svg.trim_end().ends_with("</svg>"), "{name}");
        assert!(svg.contains("<polyline") || svg.contains("<line") || svg.contains("<path"), "{name} shows no line");
        assert_eq!(svg.matches("<text").count(), svg.matches("</text>").count());
        assert!(!svg.contains("NaN"));
    }
    let written: Value = serde_json::from_str(&fs::read_to_string(out.join("run.json")).unwrap()).unwrap();
    assert_eq!(written, json(&output));

    // The forces of each increment. The final ones agree with those of the contact nodes and balance the loads and the
    // wall.
    let (header, forces) = csv(&out.join("forces.csv"));
    assert_eq!(header, "index,time,boundary,f_x,f_y,m_z,sum_p_n,sum_p_t,kind,balance,u_x,u_y,slip_state,friction_used");
    let kinds: Vec<&str> = forces.iter().map(|row| row[8].as_str()).collect();
    assert_eq!(kinds, ["contact", "support", "load", "load"].repeat(4));
    let forces: Vec<Vec<String>> = forces.into_iter().filter(|row| row[8] == "contact").collect();
    let (_, nodes) = csv(&out.join("contact_0004.csv"));
    let value = |row: &[String], k: usize| row[k].parse::<f64>().unwrap();
    let total = |of: &dyn Fn(&[String]) -> f64| nodes.iter().map(|row| of(row)).sum::<f64>();
    let moment = |row: &[String]| value(row, 0) * value(row, 11) - value(row, 1) * value(row, 10);
    for (k, expected) in [(3, total(&|row| value(row, 10))), (4, total(&|row| value(row, 11))), (5, total(&moment))] {
        assert!((value(&forces[3], k) - expected).abs() < 1e-9 * value(&forces[3], 6), "{k}: {expected}");
    }
    // The friction in use, and the slip as the statuses of the nodes say.
    let (mu, row) = (0.4, &forces[3]);
    assert!((value(row, 13) - value(row, 7).abs() / (mu * value(row, 6))).abs() < 1e-12);
    let statuses = |status: &str| nodes.iter().any(|row| row[12] == status);
    let slip = match (statuses("stick"), statuses("slip")) {
        (true, true) => "partial",
        (true, false) => "stick",
        (false, _) => "whole",
    };
    let used = &written["friction_use"][0];
    assert_eq!((&row[12], &used["end"]), (&slip.to_string(), &Value::from(slip)));
    let largest = forces.iter().map(|row| value(row, 13)).fold(0.0, f64::max);
    assert!((number(&used["largest"]) - largest).abs() < 1e-12);
    // Both loads are proportional to the time up to 1 s, when all nodes slip, and the second falls from there on.
    let times = ["slips_from", "slips_wholly_from"].map(|key| number(&used[key]));
    assert!(times[0] <= times[1] && times[1] <= 1.0, "{times:?}");
    let factors = |load: usize| serde_json::json!({ "load": load, "between": times });
    assert_eq!(used["factors"], serde_json::json!([factors(0), factors(1)]));
    let end = &written["boundaries"][0];
    assert_eq!((number(&end["force"][0]), number(&end["moment"][0])), (value(&forces[3], 3), value(&forces[3], 5)));
    assert_eq!(written["forces"][3]["force"], end["force"]);
    assert!(number(&written["increments"][1]["friction_work"]) > 0.0);
    // Four elements along the contact and four increments are few.
    assert_eq!(self::kinds(&written), ["contact-unresolved", "increments-work"]);
}

/// Returns the kinds of the warnings of a report, without those of the machine's BLAS.
fn kinds(report: &Value) -> Vec<&str> {
    let kinds = report["warnings"].as_array().unwrap().iter().map(|warning| warning["kind"].as_str().unwrap());
    kinds.filter(|kind| *kind != "slow-blas").collect()
}

/// Returns the kinds without those of the contact mesh and of the increments: the scenes here have few elements and few
/// increments.
fn kinds_but_of_the_mesh(report: &Value) -> Vec<&str> {
    let of_the_mesh = [
        "contact-unresolved",
        "contact-coarse",
        "singular-edge",
        "locking",
        "coarse-mesh",
        "slip-zone-coarse",
        "tangential-coarse",
    ];
    let others = kinds(report).into_iter().filter(|kind| !of_the_mesh.contains(kind));
    others.filter(|kind| !kind.starts_with("increments-")).collect()
}

/// Warnings appear beside the verdict and in the report, and do not change the exit status.
#[test]
fn warnings() {
    let layers = "poisson = 0.3\nlayers = [[0.3, 70e9, 0.3]]";
    let leaning = "{ kind = \"wedge\", angle = 0.2, apex = [0.75, -1e-5] }";
    let idle =
        "[[support]]\nboundary = \"right\"\nfix = [\"x\"]\n\n[[load]]\nboundary = \"right\"\ntraction = [1e5, 0.0]\n";
    for (scene, kind, words) in [
        (edit(&small(), "poisson = 0.3", "poisson = 0.4999"), "locking", "use mesh.element = \"b-bar\""),
        (edit(&small(), "poisson = 0.3", layers), "layers-through-elements", "y = 0.3 m cuts 4 elements"),
        (small() + idle, "idle-load", "the load on `right` does nothing"),
        (edit(&small(), "{ kind = \"plane\", gap = 1e-5 }", leaning), "leaning-obstacle", "inclined by 11 degrees"),
        (edit(&small(), "gap = 1e-5", "gap = 0.01"), "no-contact", "`bottom` never touched its obstacle"),
        (
            edit(&edit(&small(), "young = 210e9", "young = 210e5"), "\"paper\"", "\"default\""),
            "large-displacements",
            "of the body's size",
        ),
        (
            edit(&edit(&small(), "young = 210e9", "young = 210e6"), "\"paper\"", "\"default\""),
            "large-strains",
            "their mean is",
        ),
    ] {
        let report = report(&scene, 0);
        let mut warnings = report["warnings"].as_array().unwrap().iter().filter(|warning| warning["kind"] == kind);
        assert!(warnings.any(|warning| warning["message"].as_str().unwrap().contains(words)), "{}", report["warnings"]);
        // The contact also leaves a wedge sideways.
        let more = (kind == "leaning-obstacle").then_some("gaps-out-of-range");
        let others = kinds_but_of_the_mesh(&report).into_iter().filter(|other| *other != kind);
        assert!(others.eq(more), "{}", report["warnings"]);
        let (_folder, scene) = Folder::with_scene(&scene);
        let output = stickslip(&["run", &scene]);
        assert!(stdout(&output).contains(words), "{kind}");
        // The cure has a line of its own.
        assert_eq!(stdout(&output).contains("\n             press less"), kind == "large-strains", "{kind}");
        let before = ["locking", "layers-through-elements", "idle-load"].contains(&kind);
        assert_eq!(stdout(&stickslip(&["check", &scene])).contains(words), before, "{kind}");
    }
}

/// A block on the crest of a cylinder is in equilibrium, but may turn. Until its next node touches, 1 / 32 m below, its
/// far corners move four times as far.
#[test]
fn a_solution_that_is_one_of_many_is_told() {
    let scene = r#"
mesh = { kind = "block", size = [1.0, 1.0], elements = [4, 4] }
material = { young = 1e9, poisson = 0.3 }
contact = [{ boundary = "bottom", friction = 0.5, obstacle = { kind = "cylinder", radius = 1.0, apex = [0.5, 0] } }]
load = [{ boundary = "top", traction = [0, -1e3] }]
time = { end = 1, increments = 2 }
"#;
    let report = report(scene, 0);
    let warning =
        report["warnings"].as_array().unwrap().iter().find(|warning| warning["kind"] == "not-unique").unwrap();
    let message = warning["message"].as_str().unwrap();
    assert!(message.contains("at t = 0.5 s") && message.contains("a rotation about (0.5, 0) m"), "{message}");
    assert!(message.contains("differ by up to 127 mm"), "{message}");
    // With a support the solution is unique.
    let held = format!("{scene}support = [{{ boundary = \"left\", fix = [\"x\"] }}]\n");
    assert_eq!(kinds_but_of_the_mesh(&self::report(&held, 0)), [""; 0]);
}

/// A support rotates a body by 1e-3 m, so a few newtons on it are lost in the rounding of its stiffness. An increment
/// that did not converge is not balanced anyway, and needs no warning.
#[test]
fn forces_that_are_lost_in_rounding_are_told() {
    let turned = |young: &str| {
        let scene = r#"
mesh = { kind = "block", size = [0.2, 0.2], elements = [4, 4] }
material = { young = YOUNG, poisson = 0.3 }
support = [{ point = [0, 0], fix = ["x", "y"] }, { point = [0.2, 0], fix = ["y"], displacement = [0.001] }]
load = [{ boundary = "right", force = [1, -1] }]
time = { end = 1, increments = 1 }
"#;
        report(&edit(scene, "YOUNG", young), 0)
    };
    assert_eq!(kinds_but_of_the_mesh(&turned("1e9")), [""; 0]);
    let stiff = turned("1e16");
    let balance = stiff["reactions"][0]["balance"].as_f64().unwrap();
    assert!((1e-5..0.1).contains(&balance), "{balance}");
    let warning = stiff["warnings"].as_array().unwrap().iter().find(|warning| warning["kind"] == "unbalanced").unwrap();
    let message = warning["message"].as_str().unwrap();
    assert!(message.contains(&format!("do not balance, by {balance:.1e} of their sizes")), "{message}");

    let lifted = r#"
mesh = { kind = "block", size = [1.0, 1.0], elements = [4, 4] }
material = { young = 1e9, poisson = 0.3 }
contact = [{ boundary = "bottom", friction = 0.5, obstacle = { kind = "plane" } }]
load = [{ boundary = "top", traction = [0, 1e3] }]
time = { end = 1, increments = 1 }
"#;
    let report = report(lifted, 1);
    assert_eq!((report["status"].as_str(), kinds(&report)), (Some("no-equilibrium"), Vec::new()));
}

/// Planes that touch from the start: there is no indentation, and the rounding of gaps is no error.
#[test]
fn planes_that_touch_have_no_warning() {
    let touching = edit(&small(), "gap = 1e-5", "normal = [0.001, -1]");
    let upright = "[[support]]\nboundary = \"left\"\nfix = [\"x\"]";
    let clamped = "[[support]]\nboundary = \"left\"\nfix = [\"x\", \"y\"]";
    for scene in [edit(&touching, clamped, upright), touching] {
        let report = report(&edit(&scene, "\"paper\"", "\"default\""), 0);
        assert_eq!(kinds_but_of_the_mesh(&report), [""; 0]);
    }
}

#[test]
fn the_report_has_every_field() {
    let report = report(&small(), 0);
    assert!(report["scene"].as_str().unwrap().ends_with("scene.toml"));
    assert_eq!(report["title"], "Elastic block on a frictional foundation");
    for (key, value) in [("method", "bn"), ("setting", "paper"), ("solver", "condensed"), ("status", "converged")] {
        assert_eq!(report[key], value, "{key}");
    }
    assert_eq!(report["reason"], "");
    let unknowns = &report["unknowns"];
    assert_eq!([&unknowns["u"], &unknowns["p_t"], &unknowns["p_n"]].map(count), [40, 4, 4]);

    let increments = report["increments"].as_array().unwrap();
    assert_eq!(increments.len(), 4);
    for (k, increment) in increments.iter().enumerate() {
        assert_eq!((count(&increment["index"]), number(&increment["time"])), (k as u64 + 1, 0.5 * (k + 1) as f64));
        assert_eq!(increment["status"], "converged");
        assert!(count(&increment["iterations"]) >= 1);
        count(&increment["backtracks"]);
        assert!(number(&increment["theta"]) >= 0.0);
        for law in ["equilibrium", "penetration", "tension", "complementarity", "cone", "dissipation"] {
            assert!((0.0..=1e-10).contains(&number(&increment["kkt"][law])), "{law}: {increment}");
        }
        let contact = &increment["contact"];
        assert_eq!(count(&contact["open"]) + count(&contact["stick"]) + count(&contact["slip"]), 4);
        for part in ["assembly", "factorization", "solve", "rest"] {
            assert!(number(&increment["seconds"][part]).abs() < 600.0, "{part}");
        }
    }

    let totals = &report["totals"];
    let iterations: u64 = increments.iter().map(|increment| count(&increment["iterations"])).sum();
    assert_eq!(count(&totals["iterations"]), iterations);
    // One for the interior's response to the loads, one for the initial gaps of open nodes, and one per iteration
    // unless the last one is reused. One pattern serves the whole run.
    assert!((3..=iterations + 2).contains(&count(&totals["factorizations"])), "{totals}");
    assert_eq!(count(&totals["symbolic_analyses"]), 1);
    assert!(number(&totals["cpu_seconds"]) > 0.0 && number(&totals["wall_seconds"]) > 0.0);
    assert!(!cfg!(target_os = "linux") || count(&totals["peak_rss_bytes"]) > 1 << 20);
    assert!(count(&totals["nnz_factors"]) > 48);
    let end = &report["final"];
    assert!(number(&end["sum_p_n"]) > 0.0);
    assert!(number(&end["sum_p_t"]).abs() <= 0.4 * number(&end["sum_p_n"]) * (1.0 + 1e-9));
}

/// A report names the program version and contains the scene. Its text alone repeats the run.
#[test]
fn a_report_can_be_run_again() {
    let (_folder, scene) = Folder::with_scene(&small());
    let first = json(&stickslip(&["run", &scene, "--json", "--set", "contact.friction=0.2", "--setting", "default"]));
    assert_eq!(count(&first["schema_version"]), 1);
    assert_eq!(first["program_version"], env!("CARGO_PKG_VERSION"));
    let text = first["scene_text"].as_str().unwrap();
    assert!(text.contains("friction = 0.2") && text.contains("setting = \"default\""), "{text}");
    let again = report(text, 0);
    for key in ["title", "setting", "unknowns", "final", "forces"] {
        assert_eq!(again[key], first[key], "{key}");
    }
}

#[test]
fn without_friction_there_are_no_tangential_unknowns() {
    let report = report(&edit(&small(), "friction = 0.4", "friction = 0"), 0);
    assert_eq!((count(&report["unknowns"]["p_t"]), count(&report["unknowns"]["p_n"])), (0, 4));
    assert_eq!(number(&report["final"]["sum_p_t"]), 0.0);
}

#[test]
fn without_contact_an_increment_is_one_linear_solve() {
    let report = report(&without(&small(), "[[contact]]", "[[load]]"), 0);
    assert_eq!((count(&report["unknowns"]["p_t"]), count(&report["unknowns"]["p_n"])), (0, 0));
    for increment in report["increments"].as_array().unwrap() {
        assert_eq!(count(&increment["iterations"]), 1);
    }
    assert_eq!((count(&report["totals"]["iterations"]), count(&report["totals"]["factorizations"])), (4, 1));
}

#[test]
fn the_version_names_the_solver_in_use() {
    let output = stickslip(&["--version"]);
    assert_exit(&output, 0);
    let line = stdout(&output);
    let after = line.strip_prefix(concat!("stickslip ", env!("CARGO_PKG_VERSION"), " ")).unwrap();
    if cfg!(feature = "umfpack") {
        assert!(after.starts_with("(SuiteSparse ") && after.contains("UMFPACK "), "{line}");
    } else {
        assert_eq!(after.trim(), "(without UMFPACK)");
    }
}

/// If the block is pulled away from the wall, uniqueness is in danger. If it is pushed towards the wall, as in the
/// scene, it is not.
#[test]
fn the_uniqueness_is_told_where_it_is_asked_for() {
    let (folder, scene) = Folder::with_scene(&small());
    let pull = ["load[1].traction=[50e6,0.0]", "time.end=1.0", "output.times=[1.0]"];
    let set = pull.iter().flat_map(|text| ["--set", text]);
    let args: Vec<&str> = ["run", &scene, "--uniqueness"].into_iter().chain(set).collect();
    let output = stickslip(&args);
    assert_exit(&output, 0);
    let start = "uniqueness   rates are unique up to ";
    let text = unbroken(&output);
    let line = text.lines().find(|line| line.starts_with(start)).unwrap();
    assert!(line.contains(" times this friction for the present contact statuses (mu "), "{line}");

    let out = folder.join("out");
    for options in [&["--json"][..], &["--json", "--method", "ip", "--solver", "condensed", "--out", &out]] {
        let output = stickslip(&[&args[..], options].concat());
        assert_exit(&output, 0);
        let critical = &json(&output)["critical_friction"];
        assert!(count(&critical["slipping"]) > 0);
        assert!((6.0..7.0).contains(&number(&critical["factor"])), "{critical}");
        assert!(line.contains(&format!("{:.3}", number(&critical["factor"]))), "{line} {critical}");
    }
    let written: Value = serde_json::from_str(&fs::read_to_string(Path::new(&out).join("run.json")).unwrap()).unwrap();
    assert!((6.0..7.0).contains(&number(&written["critical_friction"]["factor"])), "{written}");

    let output = stickslip(&["run", &scene, "--json"]);
    assert!(json(&output).get("critical_friction").is_none());
    // Without friction the factor is infinite, which JSON cannot represent. Without an increment there is none.
    let output = stickslip(&["run", &scene, "--set", "contact.friction=0.0", "--json", "--uniqueness"]);
    assert!(json(&output)["critical_friction"]["factor"].is_null());
    let output = stickslip(&["run", &scene, "--set", "solver.max_iterations=1", "--json", "--uniqueness"]);
    assert_exit(&output, 1);
    assert!(json(&output).get("critical_friction").is_none());
}

/// A file in place of a command causes a suggestion of the command.
#[test]
fn a_file_without_a_command() {
    for (file, tip) in [
        ("part.toml", Some("did you mean: stickslip run part.toml")),
        ("contacts.hdf5", Some("did you mean: stickslip solve contacts.hdf5")),
        ("part.step", None),
    ] {
        let output = stickslip(&[file, "--json"]);
        assert_exit(&output, 2);
        let said = json(&output)["message"].as_str().unwrap().to_string();
        assert!(said.contains("unrecognized subcommand"), "{said}");
        assert_eq!(said.contains("did you mean"), tip.is_some(), "{said}");
        assert!(tip.is_none_or(|tip| said.contains(tip)), "{said}");
    }
}

/// The chosen linear solver is reported, and gives the same results as if it had been named.
#[test]
fn the_linear_algebra_is_chosen_unless_it_is_named() {
    let (_folder, scene) = Folder::with_scene(&small());
    let output = stickslip(&["run", &scene]);
    assert_exit(&output, 0);
    let line = stdout(&output).lines().find(|line| line.starts_with("solver       ")).unwrap();
    let open = json(&stickslip(&["run", &scene, "--json"]));
    let chosen = open["solver"].as_str().unwrap();
    assert_eq!(line, format!("solver       {}", open["solver_choice"].as_str().unwrap()));
    assert_eq!(line, format!("solver       {chosen}: 8 contact displacements of 40"));
    let auto = json(&stickslip(&["run", &scene, "--solver", "auto", "--json"]));
    assert_eq!(auto["solver_choice"], open["solver_choice"]);
    let named = json(&stickslip(&["run", &scene, "--solver", chosen, "--json"]));
    assert!(named.get("solver_choice").is_none());
    for field in ["solver", "final"] {
        assert_eq!(open[field], named[field]);
    }
    assert_eq!(open["totals"]["iterations"], named["totals"]["iterations"]);
}
