//! `stickslip sweep`: every combination is run once, whatever happens in between.

#![allow(clippy::unwrap_used)]

use std::collections::BTreeSet;
use std::fs;
use std::path::Path;
use std::process::{Command, Stdio};
use std::time::{Duration, Instant};

use serde_json::Value;

use crate::program::{Folder, assert_exit, children, csv, flat, json, number, send, small, stderr, stdout, stickslip};

/// Returns the names of the complete and of the incomplete results.
fn results(folder: &Folder) -> (BTreeSet<String>, Vec<String>) {
    let (partial, whole): (Vec<_>, Vec<_>) =
        folder.names("out/variants").into_iter().partition(|name| name.starts_with('.'));
    (whole.into_iter().collect(), partial)
}

fn sweep<'a>(scene: &'a str, out: &'a str, more: &[&'a str]) -> Vec<&'a str> {
    [&["sweep", scene, "--set", "solver.setting=default", "--out", out], more].concat()
}

#[test]
fn every_combination_is_a_row_and_a_folder() {
    let (folder, scene) = Folder::with_scene(&small());
    let out = folder.join("out");
    let friction = ["--vary", "contact.friction=0.2:0.6:3"];
    let arguments = sweep(&scene, &out, &[&friction[..], &["--vary", "time.increments=2,4", "--json"]].concat());
    let output = stickslip(&arguments);
    assert_exit(&output, 0);
    assert_eq!(folder.names("out"), ["sweep.csv", "sweep.html", "sweep.json", "sweep.svg", "sweep.txt", "variants"]);
    let table = json(&output);
    let written: Value = serde_json::from_str(&fs::read_to_string(folder.0.join("out/sweep.json")).unwrap()).unwrap();
    assert_eq!(table, written);
    let rows = table["variants"].as_array().unwrap();
    let values: Vec<String> = rows.iter().map(|row| row["values"].to_string()).collect();
    assert_eq!(values[..3], ["[0.2,2.0]", "[0.2,4.0]", "[0.4,2.0]"]);
    assert_eq!(rows.len(), 6);
    assert_eq!(table["overrides"], serde_json::json!(["solver.setting=default"]));
    assert!(table["command"].as_str().unwrap().starts_with("stickslip sweep "));

    // Each result agrees with that of a single run to the last bit.
    let run = stickslip(&[
        "run",
        &scene,
        "--json",
        "--set",
        "solver.setting=default",
        "--set",
        "contact.friction=0.4",
        "--set",
        "time.increments=4",
    ]);
    let (row, report) = (&rows[3], json(&run));
    assert_eq!(row["boundaries"], report["boundaries"]);
    assert_eq!(row["largest_pressure"], report["largest_pressure"]);
    assert_eq!(row["iterations"], report["totals"]["iterations"]);
    assert_eq!(row["warnings"], serde_json::json!(["contact-unresolved", "increments-work"]));
    assert_eq!((row["status"].as_str(), row["converged"].as_u64()), (Some("converged"), Some(4)));
    assert!(number(&row["error"]) < 1e-10 && number(&row["seconds"]) > 0.0);
    for row in rows {
        let results = Path::new(&out).join(row["results"].as_str().unwrap());
        assert!(results.join("contact_0002.csv").is_file() && results.join("run.json").is_file());
    }
    let (header, lines) = csv(&folder.0.join("out/sweep.csv"));
    assert!(
        header.starts_with("contact.friction,time.increments,status,converged,iterations,seconds,largest_pressure,")
    );
    assert!(header.contains(",bottom.f_x,bottom.f_y,bottom.sum_p_n,bottom.sum_p_t,error,warnings,results,reason"));
    assert_eq!(header.matches("largest_pressure").count(), 1, "{header}");
    assert_eq!(lines.len(), 6);
    let svg = fs::read_to_string(folder.0.join("out/sweep.svg")).unwrap();
    for text in ["contact friction", "time increments = 2", "largest contact pressure [MPa]", "6 variants"] {
        assert!(svg.lines().any(|line| line == text), "{text}");
    }
}

/// Quantities of the reports are columns after the others, and one of them is the chart.
#[test]
fn any_quantity_of_a_report_is_shown() {
    let (folder, scene) = Folder::with_scene(&small());
    let out = folder.join("out");
    let asked = "max:bottom.f_x,last:top.u_y,max:load:top.f_y,friction.friction_work,size:largest_force.force,\
                 holding_force.magnitude,status";
    let variations = ["--vary", "contact.friction=0.2,0.4", "--vary", "time.increments=2,4"];
    let shown = ["--table", asked, "--plot", "min:support:left.f_x"];
    let output = stickslip(&sweep(&scene, &out, &[&variations[..], &shown].concat()));
    assert_exit(&output, 0);
    let (header, lines) = csv(&folder.0.join("out/sweep.csv"));
    assert!(header.ends_with(&format!(",results,reason,{asked},min:support:left.f_x")), "{header}");
    let table: Value = serde_json::from_str(&fs::read_to_string(folder.0.join("out/sweep.json")).unwrap()).unwrap();
    assert_eq!(table["quantities"][1], serde_json::json!({ "quantity": "last:top.u_y", "unit": "m" }));
    assert_eq!(table["plotted"], "min:support:left.f_x");
    for (row, line) in table["variants"].as_array().unwrap().iter().zip(&lines) {
        let results = Path::new(&out).join(row["results"].as_str().unwrap());
        let report: Value = serde_json::from_str(&fs::read_to_string(results.join("run.json")).unwrap()).unwrap();
        let (names, forces) = csv(&results.join("forces.csv"));
        let column = |kind: &str, place: &str, name: &str| {
            let [of_kind, of_place, of_name] =
                ["kind", "boundary", name].map(|name| names.split(',').position(|other| other == name).unwrap());
            let lines = forces.iter().filter(|line| line[of_kind] == kind && line[of_place] == place);
            lines.map(|line| line[of_name].parse::<f64>().unwrap()).collect::<Vec<_>>()
        };
        let force = report["largest_force"]["force"].as_array().unwrap();
        let expected = [
            column("contact", "bottom", "f_x").into_iter().reduce(f64::max).unwrap(),
            *column("load", "top", "u_y").last().unwrap(),
            column("load", "top", "f_y").into_iter().reduce(f64::max).unwrap(),
            number(&report["friction"]["friction_work"]),
            force.iter().map(|f| number(f).powi(2)).sum::<f64>().sqrt(),
            column("contact", "bottom", "sum_p_t").into_iter().map(f64::abs).reduce(f64::max).unwrap(),
        ];
        for (name, value) in asked.split(',').zip(expected) {
            assert_eq!(number(&row["quantities"][name]), value, "{name}");
        }
        assert_eq!(line[line.len() - 2], "converged");
        let least = column("support", "left", "f_x").into_iter().reduce(f64::min).unwrap();
        assert_eq!(number(&row["quantities"]["min:support:left.f_x"]), least);
        assert_eq!(line[line.len() - 1].parse(), Ok(least));
    }
    let svg = fs::read_to_string(folder.0.join("out/sweep.svg")).unwrap();
    for text in ["min f_x of support left [N/m]", "time increments = 2", "time increments = 4", "contact friction"] {
        assert!(svg.lines().any(|line| line == text), "{text}");
    }
    // The page holds table and chart, and leads to the reports of the variants.
    let page = fs::read_to_string(folder.0.join("out/sweep.html")).unwrap();
    assert!(page.contains("last u_y of top [m]") && page.contains(">4 variants, 4 converged<"));
    let data = page.split("type=\"application/json\">").nth(1).unwrap().split("</script>").next().unwrap();
    let chart: Value = serde_json::from_str(data).unwrap();
    assert_eq!(chart["titles"], serde_json::json!(["contact friction", "min f_x of support left [N/m]"]));
    assert_eq!(chart["curves"][1]["name"], "time increments = 4");
    assert_eq!(chart["curves"][1]["points"].as_array().unwrap().len(), 2);
    let links: Vec<&str> =
        page.split("href=\"").filter_map(|rest| rest.split('"').next()).filter(|link| link.contains('/')).collect();
    assert_eq!(links.len(), 4);
    assert!(links.iter().all(|link| Path::new(&out).join(link).is_file()), "{links:?}");
    assert_eq!(page.matches("http").count(), page.matches("http://www.w3.org/").count());
}

/// Without --table the columns are the key results that there are.
#[test]
fn key_results_are_shown() {
    let (folder, scene) = Folder::with_scene(&small());
    // Heads of a table wider than a screen are broken.
    let heads = |friction: &str| {
        let output = stickslip(&["sweep", &scene, "--vary", friction]);
        let heads = stdout(&output).split("\n-").next().unwrap().to_string();
        assert!(heads.contains("pressure") && heads.contains("force") && heads.contains("[MPa]"), "{heads}");
        assert!(heads.lines().all(|line| line.len() <= 100), "{heads}");
        heads
    };
    assert!(heads("contact.friction=0.2,0.4").contains("J/m"));
    assert!(!heads("contact.friction=50,60").contains("J/m"));
    // A quantity that no run has is reported, and so is its empty chart.
    let output = stickslip(&["sweep", &scene, "--vary", "contact.friction=0.2,0.4", "--plot", "slip.force"]);
    assert_exit(&output, 0);
    assert!(flat(&output).contains("slip.force: no variant has a value chart no point of force of slip [N/m]:"));
    drop(folder);
}

/// A table of many quantities fits a screen, names its quantities with their units, and has a letter for each kind of
/// warning, whose cure stands below once.
#[test]
fn a_wide_sweep_fits_a_screen() {
    let (folder, scene) = Folder::with_scene(&small());
    let asked = "peak,largest_pressure.mean_pressure,largest_pressure.position[0],boundaries[0].force[1],friction_work,\
                 holding_force.magnitude,holding_force.time_error,max:contact:bottom.sum_p_n,min:support:left.f_x,\
                 last:load:top.u_y,totals.cpu_seconds,stick_ratio";
    let vary = ["--vary", "contact.friction=0.2,0.4", "--vary", "load[1].traction=[1e3,0],[2e3,0]"];
    let output = stickslip(&[&["sweep", &scene, "--table", asked], &vary[..]].concat());
    assert_exit(&output, 0);
    let text = stdout(&output);
    assert!(text.lines().all(|line| line.chars().count() <= 100), "{text}");
    let named = |line: &&str| line.split_whitespace().take(2).eq(["0.4", "[2e3,0]"]);
    assert!(text.lines().filter(named).count() > 1, "{text}");
    for word in ["[MPa]", "[N/m]", "[J/m]", "[m]", "[s]", "[Pa]"] {
        assert!(text.contains(word) && !text.contains("largest_pressure"), "{word} {text}");
    }
    let flat = flat(&output);
    assert!(flat.contains("warning a contact-unresolved, 4 of 4 variants, in the first: "), "{text}");
    assert_eq!(flat.matches("contact-unresolved").count(), 1, "{text}");
    drop(folder);
}

#[test]
fn bad_quantities_are_told_before_anything_runs() {
    let (folder, scene) = Folder::with_scene(&small());
    let vary = ["--vary", "contact.friction=0.2,0.4", "--out", &folder.join("out")].map(String::from);
    for (option, quantity, words) in [
        ("--table", "frictionwork", "did you mean friction.friction_work or cycle.friction_work"),
        ("--plot", "tangential_force", "did you mean holding_force.magnitude"),
        ("--table", "friction.work", "the keys of friction are friction_work, time_error"),
        ("--table", "status,max:botom.f_x", "did you mean bottom?"),
        ("--table", "largest_force.force", "size:largest_force.force"),
        ("--plot", "status", "is no number; the table of a sweep shows it"),
        ("--table", "size:peak", "`largest_pressure.pressure` is no vector"),
        ("--table", "max:bottom.f_z", "the scene is plane"),
        ("--table", "boundaries[3].sum_p_t", "the number of boundaries with contact, from 0, is 1"),
        ("--plot", "max:bottom.fx", "did you mean f_x?"),
        ("--plot", "max:left.sum_p_n", "a support has no column `sum_p_n`"),
    ] {
        let mut arguments = vec!["sweep", &scene, option, quantity];
        arguments.extend(vary.iter().map(String::as_str));
        let output = stickslip(&arguments);
        assert_exit(&output, 2);
        let flat = stderr(&output).replace("\n  │ ", " ");
        assert!(flat.contains(words), "{quantity}: {flat}");
        assert!(!folder.0.join("out").exists(), "{quantity}");
    }
}

#[test]
fn increments_are_for_all_variants() {
    let (folder, scene) = Folder::with_scene(&small());
    let out = folder.join("out");
    let vary = ["--vary", "contact.friction=0.2,0.4", "--increments", "8"];
    for kept in ["", ", 2 of them already complete"] {
        let output = stickslip(&sweep(&scene, &out, &vary));
        assert_exit(&output, 0);
        assert!(stdout(&output).contains(&format!("variants     2{kept}\n")), "{}", stdout(&output));
        let (_, lines) = csv(&folder.0.join("out/sweep.csv"));
        assert!(lines.iter().all(|line| line[2] == "8"), "{lines:?}");
    }
    for (more, words) in [
        (["--vary", "time.increments=2,4", "--increments", "8"], "the increments are varied"),
        (["--vary", "contact.friction=0.2,0.4", "--increments", "auto"], "`stickslip converge` refines increments"),
        (["--vary", "contact.friction=0.2,0.4", "--json", "--companion"], "or stickslip converge"),
    ] {
        let output = stickslip(&[&["sweep", &scene], &more[..]].concat());
        assert_exit(&output, 2);
        assert!(stderr(&output).replace("\n  │ ", " ").contains(words), "{}", stderr(&output));
    }
}

/// A folder in place of a table is reported before anything runs.
#[test]
fn tables_have_their_place() {
    let (folder, scene) = Folder::with_scene(&small());
    let out = folder.join("out");
    fs::create_dir_all(folder.0.join("out/sweep.csv")).unwrap();
    let output = stickslip(&sweep(&scene, &out, &["--vary", "contact.friction=0.2,0.4"]));
    assert_exit(&output, 2);
    assert!(stderr(&output).contains("sweep.csv: results cannot be written"), "{}", stderr(&output));
    assert!(!folder.0.join("out/variants").exists());
}

/// Files of other programs stay as they are.
#[test]
fn foreign_files_are_not_replaced() {
    let (folder, scene) = Folder::with_scene(&small());
    let out = folder.join("out");
    fs::create_dir(&out).unwrap();
    let vary = ["--vary", "contact.friction=0.2,0.4"];
    for (name, command) in
        [("sweep.csv", sweep(&scene, &out, &vary)), ("compare.csv", vec!["compare", &scene, "--out", &out])]
    {
        let file = folder.0.join("out").join(name);
        fs::write(&file, "mine").unwrap();
        let output = stickslip(&command);
        assert_exit(&output, 2);
        assert!(stderr(&output).replace("\n  │ ", " ").contains("not written by stickslip"), "{}", stderr(&output));
        assert_eq!(fs::read_to_string(&file).unwrap(), "mine");
    }
    assert!(!folder.0.join("out/variants").exists());
}

/// The same command runs nothing again; a larger sweep runs new variants; a changed file runs the affected ones.
#[test]
fn what_is_done_is_kept() {
    let mesh = include_str!("../../../../data/meshes/square_triangles.msh");
    let scene = "mesh = { kind = 'gmsh', file = 'a.msh' }
        material = { young = 1e9, poisson = 0.3 }
        support = [{ boundary = 'top', fix = ['x', 'y'] }]
        contact = [
          { boundary = 'bottom', friction = 0.3, obstacle = { kind = 'plane', approach = [[0, 0], [1, 1e-3]] } },
        ]
        time = { end = 1, increments = 2 }";
    let (folder, scene) = Folder::with_scene(scene);
    let out = folder.join("out");
    for name in ["a.msh", "b.msh"] {
        fs::write(folder.join(name), mesh).unwrap();
    }
    let known = |variations: &[&str], known: usize, all: usize| {
        let output = stickslip(&sweep(&scene, &out, variations));
        assert_exit(&output, 0);
        let head = match known {
            0 => format!("variants     {all}\n"),
            _ => format!("variants     {all}, {known} of them already complete\n"),
        };
        assert!(stdout(&output).contains(&head), "{head}{}", stdout(&output));
        results(&folder).0
    };
    let meshes = "mesh.file=a.msh,b.msh";
    let first = known(&["--vary", meshes, "--vary", "contact.friction=0.1,0.2"], 0, 4);
    assert_eq!(known(&["--vary", "contact.friction=0.2,0.1", "--vary", meshes, "--jobs", "1"], 4, 4), first);
    assert_eq!(known(&["--vary", meshes, "--vary", "contact.friction=0.1,0.2,0.4"], 4, 6).len(), 6);
    // A changed mesh gives a new variant, and so does a changed scene.
    fs::write(folder.join("b.msh"), format!("{mesh}\n")).unwrap();
    assert_eq!(known(&["--vary", meshes, "--vary", "contact.friction=0.1,0.2"], 2, 4).len(), 8);
    let text = fs::read_to_string(&scene).unwrap();
    fs::write(&scene, text.replace("poisson = 0.3", "poisson = 0.2")).unwrap();
    known(&["--vary", meshes, "--vary", "contact.friction=0.1,0.2"], 0, 4);
    // A truncated report is no result.
    fs::write(&scene, text).unwrap();
    let cut = first.iter().next().unwrap();
    for name in &first {
        let report = folder.0.join("out/variants").join(name).join("run.json");
        let text = fs::read_to_string(&report).unwrap();
        if name == cut {
            fs::write(&report, &text[..text.len() / 2]).unwrap();
        }
    }
    fs::write(folder.join("b.msh"), mesh).unwrap();
    known(&["--vary", meshes, "--vary", "contact.friction=0.1,0.2"], 3, 4);
    known(&["--vary", meshes, "--vary", "contact.friction=0.1,0.2"], 4, 4);
    // A folder renamed to that of another variant is not its result.
    let of = |friction: &str| {
        let is_of = |name: &&String| {
            let report = fs::read_to_string(folder.0.join("out/variants").join(name).join("run.json")).unwrap();
            let report: Value = serde_json::from_str(&report).unwrap();
            report["scene_text"].as_str().unwrap().contains(friction)
        };
        folder.0.join("out/variants").join(first.iter().find(is_of).unwrap())
    };
    let (one, other) = (of("friction = 0.1"), of("friction = 0.2"));
    fs::remove_dir_all(&one).unwrap();
    fs::rename(other, one).unwrap();
    known(&["--vary", meshes, "--vary", "contact.friction=0.1,0.2"], 2, 4);
}

/// Bodies that slip as a whole have points, with a mark, as far as they have the quantity.
#[test]
fn slipping_variants_are_drawn() {
    let (folder, scene) = Folder::with_scene(include_str!("../../../../data/init/block.toml"));
    let few = ["--set", "mesh.elements=[8,4]", "--set", "time.increments=4", "--plot", "slip.force"];
    let output = stickslip(&sweep(
        &scene,
        &folder.join("out"),
        &[&few[..], &["--vary", "contact.friction=0.1,0.2,0.6"]].concat(),
    ));
    assert_exit(&output, 1);
    assert!(flat(&output).contains("ended early slips, 2 of 3 variants, the first contact.friction=0.1:"));
    let svg = fs::read_to_string(folder.0.join("out/sweep.svg")).unwrap();
    for text in ["2 variants, 1 without a value left out", "slips: the run ended early"] {
        assert!(svg.lines().any(|line| line == text), "{text}");
    }
    let few = ["--set", "mesh.elements=[8,4]", "--set", "contact.friction=0.2", "--meshes", "4,8,16"];
    let output = stickslip(&[&["converge", &scene, "--for", "slip.force"], &few[..]].concat());
    assert_exit(&output, 0);
    assert!(
        flat(&output).contains("the force of slip is 2.0000 kN/m") && !stdout(&output).contains("-0.00"),
        "{}",
        stdout(&output)
    );
}

/// All nodes slip, all stick, and there is no friction.
#[test]
fn the_stick_ratio_is_known_at_its_ends() {
    let driven = "[[support]]\nboundary = 'top'\nfix = ['x']\ndisplacement = [0.0005]\nhistory = [[1, 0], [2, 1]]";
    let text = [include_str!("../../../../data/init/block.toml"), driven].join("\n");
    let (_folder, scene) = Folder::with_scene(&text);
    let few = ["--set", "mesh.elements=[16,8]", "--set", "time.increments=4", "--json"];
    let output = stickslip(&[&["sweep", &scene, "--vary", "contact.friction=0.01,2,0"], &few[..]].concat());
    let ratios: Vec<Value> = json(&output)["variants"]
        .as_array()
        .unwrap()
        .iter()
        .map(|row| row["quantities"]["stick_zone.ratio"].clone())
        .collect();
    assert_eq!(serde_json::json!(ratios).to_string(), "[0.0,1.0,null]");
}

/// A failure is a row of the table, and changes the exit status.
#[test]
fn failures_are_rows() {
    let (folder, scene) = Folder::with_scene(&small());
    let out = folder.join("out");
    let variations = ["--vary", "support.boundary=left,nowhere", "--vary", "solver.tolerance=1e-30,1e-10"];
    let arguments = sweep(&scene, &out, &variations);
    let output = stickslip(&arguments);
    assert_exit(&output, 1);
    let table: Value = serde_json::from_str(&fs::read_to_string(folder.0.join("out/sweep.json")).unwrap()).unwrap();
    let statuses: Vec<&str> =
        table["variants"].as_array().unwrap().iter().map(|row| row["status"].as_str().unwrap()).collect();
    assert_eq!(statuses[1..], ["converged", "bad-input", "bad-input"]);
    assert_ne!(statuses[0], "converged");
    assert!(flat(&output).contains("the mesh has no boundary `nowhere`; the mesh has the boundaries"));
    assert!(flat(&output).contains(", 1 of 4 variants, the first support.boundary=left, solver.tolerance=1e-30: incr"));
    assert!(flat(&output).contains("bad-input, 2 of 4 variants, the first support.boundary=nowhere,"));
    // A verdict is kept, whatever it is. A scene that cannot be discretised has none.
    assert_eq!(results(&folder).0.len(), 2);
    let again = stickslip(&arguments);
    assert_exit(&again, 1);
    assert!(stdout(&again).contains("4, 2 of them already"), "{}", stdout(&again));
}

#[test]
fn bad_variations_are_told_before_anything_runs() {
    let (folder, scene) = Folder::with_scene(&small());
    for (variation, words) in [
        ("contact.friction", "is not of the form key=value"),
        ("contact.friction=0.3", "has one value only"),
        ("contact.friction=0.3,0.3", "has the value 0.3 twice"),
        ("contact.friction=0.1:0.2:0", "is no range"),
        ("contact.friction=0.2,-0.1", "--vary contact.friction=-0.1: friction is -0.1"),
        ("contact.friction=", "has no value"),
        ("contact.frictn=0.2,0.1", "--vary contact.frictn=0.2: unknown field `frictn`"),
        (
            "contact[1].friction=0.1,0.2",
            "--vary contact[1].friction=0.1: the scene has 1 [[contact]], so there is no contact[1]",
        ),
        ("friction=0.1,0.2", "unknown field `friction`"),
        ("load.traction=0:1:2", "expected a list"),
    ] {
        let output = stickslip(&["sweep", &scene, "--vary", variation, "--out", &folder.join("out")]);
        assert_exit(&output, 2);
        let flat = stderr(&output).replace("\n  │ ", " ");
        assert!(flat.contains(words), "{variation}: {flat}");
        assert!(!folder.0.join("out").exists(), "{variation}");
    }
    let twice = ["--vary", "contact.friction=0.1,0.2", "--vary", "contact.friction=0.3,0.4"];
    let output = stickslip(&[&["sweep", &scene], &twice[..]].concat());
    assert_exit(&output, 2);
    assert!(stderr(&output).contains("varied twice"));
    assert_exit(&stickslip(&["sweep", &scene]), 2);
    fs::write(folder.join("file"), "").unwrap();
    let output = stickslip(&["sweep", &scene, "--vary", "contact.friction=0.1,0.2", "--out", &folder.join("file")]);
    assert_exit(&output, 2);
    assert!(stderr(&output).contains("choose a writable folder"), "{}", stderr(&output));
}

/// Starts a sweep, kills it by `signal` once one variant is finished, and starts it again.
fn killed(signal: &str) {
    let (folder, scene) = Folder::with_scene(&small());
    let out = folder.join("out");
    // The second variant takes far longer than the test.
    let long = ["--vary", "time.increments=2,100000", "--vary", "contact.friction=0.1,0.3", "--jobs", "2"];
    let mut child = Command::new(env!("CARGO_BIN_EXE_stickslip"))
        .args(sweep(&scene, &out, &long))
        .stdout(Stdio::null())
        .stderr(Stdio::null())
        .spawn()
        .unwrap();
    let start = Instant::now();
    while !folder.0.join("out/variants").is_dir() || results(&folder).0.len() < 2 || results(&folder).1.len() < 3 {
        assert!(start.elapsed() < Duration::from_secs(60), "nothing is done");
        std::thread::sleep(Duration::from_millis(20));
    }
    let workers = children(child.id());
    assert!(!workers.is_empty());
    send(signal, child.id());
    let status = child.wait().unwrap();
    if signal == "KILL" {
        // The killed sweep cannot end its processes.
        let kill = |id: &u32| drop(Command::new("sh").args(["-c", &format!("kill -KILL {id}")]).status());
        workers.iter().for_each(kill);
        std::thread::sleep(Duration::from_millis(200));
    } else {
        assert_eq!(status.code(), Some(1));
        assert_eq!(results(&folder).1, [""; 0]);
        let (_, rows) = csv(&folder.0.join("out/sweep.csv"));
        let statuses: Vec<&str> = rows.iter().map(|row| row[2].as_str()).collect();
        assert_eq!(statuses, ["converged", "converged", "interrupted", "interrupted"]);
        assert!(workers.iter().all(|id| !Path::new("/proc").join(id.to_string()).exists()), "{workers:?}");
    }
    let short = ["--vary", "time.increments=2,4", "--vary", "contact.friction=0.1,0.3"];
    let output = stickslip(&sweep(&scene, &out, &short));
    assert_exit(&output, 0);
    assert!(stdout(&output).contains("4, 2 of them already"), "{}", stdout(&output));
    assert_eq!((results(&folder).0.len(), results(&folder).1.len()), (4, 0));
}

#[cfg(target_os = "linux")]
#[test]
fn ctrl_c_loses_nothing_that_is_done() {
    killed("INT");
}

#[cfg(target_os = "linux")]
#[test]
fn a_kill_loses_nothing_that_is_done() {
    killed("KILL");
}
