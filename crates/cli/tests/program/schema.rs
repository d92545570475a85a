//! The contracts: JSON Schemas of scenes and runs, and the keys documented in doc/reference/results.md.

#![allow(clippy::unwrap_used)]

use std::collections::BTreeSet;
use std::fs;
use std::path::Path;

use serde_json::Value;
use stickslip::scene::Scene;

use crate::common::edit;
use crate::events::OBLIQUE_BEAM;
use crate::program::{Folder, assert_exit, json, report, small, stickslip, without};

fn schema(of: &str) -> Value {
    let output = stickslip(&["schema", of]);
    assert_exit(&output, 0);
    json(&output)
}

/// The keywords that the validator checks.
const CHECKED: [&str; 16] = [
    "type",
    "enum",
    "const",
    "minimum",
    "exclusiveMinimum",
    "maximum",
    "exclusiveMaximum",
    "minItems",
    "maxItems",
    "required",
    "properties",
    "additionalProperties",
    "items",
    "$ref",
    "anyOf",
    "oneOf",
];
/// Keywords without meaning for validation, and `allOf`.
const REMARKS: [&str; 9] =
    ["$schema", "$id", "$defs", "$comment", "title", "description", "default", "format", "allOf"];

/// A validator sufficient for the two schemas. Returns the errors of `value`, each with its position.
fn faults(root: &Value, schema: &Value, value: &Value, at: &str) -> Vec<String> {
    let mut found = Vec::new();
    // A keyword that is neither checked below nor a remark would accept everything.
    for keyword in schema.as_object().into_iter().flatten().map(|(keyword, _)| keyword) {
        let is_known = CHECKED.contains(&keyword.as_str()) || REMARKS.contains(&keyword.as_str());
        assert!(is_known, "the schema has the keyword `{keyword}`, which is not checked");
    }
    let mut fault = |what: &str| found.push(format!("{at}: {what}"));
    let within = |key: &str, good: fn(f64, f64) -> bool| match (schema.get(key), value.as_f64()) {
        (Some(bound), Some(number)) => good(number, bound.as_f64().unwrap()),
        _ => true,
    };
    let has_type = |name: &str| match name {
        "object" => value.is_object(),
        "array" => value.is_array(),
        "string" => value.is_string(),
        "boolean" => value.is_boolean(),
        "integer" => value.is_i64() || value.is_u64(),
        "number" => value.is_number(),
        "null" => value.is_null(),
        other => panic!("{other}"),
    };
    let types: Vec<&str> = match schema.get("type") {
        None => Vec::new(),
        Some(Value::Array(all)) => all.iter().map(|name| name.as_str().unwrap()).collect(),
        Some(one) => vec![one.as_str().unwrap()],
    };
    if !types.is_empty() && !types.iter().any(|name| has_type(name)) {
        fault(&format!("not of the type {types:?}"));
    }
    if schema.get("enum").is_some_and(|all| !all.as_array().unwrap().contains(value))
        || schema.get("const").is_some_and(|one| one != value)
    {
        fault(&format!("{value} is none of the values"));
    }
    if !within("minimum", |x, bound| x >= bound)
        || !within("exclusiveMinimum", |x, bound| x > bound)
        || !within("maximum", |x, bound| x <= bound)
        || !within("exclusiveMaximum", |x, bound| x < bound)
    {
        fault("out of range");
    }
    if let Some(items) = value.as_array() {
        let count = items.len() as u64;
        if schema.get("minItems").is_some_and(|least| count < least.as_u64().unwrap())
            || schema.get("maxItems").is_some_and(|most| count > most.as_u64().unwrap())
        {
            fault("wrong length");
        }
    }
    for key in schema.get("required").and_then(Value::as_array).into_iter().flatten() {
        if value.is_object() && value.get(key.as_str().unwrap()).is_none() {
            fault(&format!("no {key}"));
        }
    }
    for (key, value) in value.as_object().into_iter().flatten() {
        match schema.get("properties").and_then(|all| all.get(key)) {
            Some(schema) => found.extend(faults(root, schema, value, &format!("{at}.{key}"))),
            None if schema.get("additionalProperties") == Some(&Value::Bool(false)) => {
                found.push(format!("{at}: unknown key {key}"));
            }
            None => {}
        }
    }
    if let (Some(items), Some(schema)) = (value.as_array(), schema.get("items")) {
        found.extend(items.iter().enumerate().flat_map(|(k, item)| faults(root, schema, item, &format!("{at}[{k}]"))));
    }
    if let Some(name) = schema.get("$ref") {
        found.extend(faults(root, target(root, name), value, at));
    }
    for one_of in ["anyOf", "oneOf"] {
        if let Some(all) = schema.get(one_of).and_then(Value::as_array)
            && !all.iter().any(|schema| faults(root, schema, value, at).is_empty())
        {
            found.push(format!("{at}: fits none of {one_of}"));
        }
    }
    found.extend(subschemas(schema).flat_map(|part| faults(root, part, value, at)));
    found
}

fn target<'a>(root: &'a Value, name: &Value) -> &'a Value {
    root.pointer(name.as_str().unwrap().strip_prefix('#').unwrap()).unwrap()
}

fn subschemas(schema: &Value) -> impl Iterator<Item = &Value> {
    schema.get("allOf").and_then(Value::as_array).into_iter().flatten()
}

/// Collects every key of a schema, with its path; `[]` stands for the elements of a list.
fn keys(root: &Value, schema: &Value, at: &str, into: &mut BTreeSet<String>) {
    for (key, schema) in schema.get("properties").and_then(Value::as_object).into_iter().flatten() {
        let path = if at.is_empty() { key.clone() } else { format!("{at}.{key}") };
        keys(root, schema, &path, into);
        into.insert(path);
    }
    if let Some(schema) = schema.get("items") {
        keys(root, schema, &format!("{at}[]"), into);
    }
    if let Some(name) = schema.get("$ref") {
        keys(root, target(root, name), at, into);
    }
    let either = schema.get("anyOf").and_then(Value::as_array).into_iter().flatten();
    either.chain(subschemas(schema)).for_each(|schema| keys(root, schema, at, into));
}

/// Collects every key of a JSON value, with its path.
fn keys_of(value: &Value, at: &str, into: &mut BTreeSet<String>) {
    for (key, value) in value.as_object().into_iter().flatten() {
        let path = if at.is_empty() { key.clone() } else { format!("{at}.{key}") };
        keys_of(value, &path, into);
        into.insert(path);
    }
    value.as_array().into_iter().flatten().for_each(|value| keys_of(value, &format!("{at}[]"), into));
}

/// A ball under the middle of a face, and a plane under the rest.
const ON_A_BALL: &str = "[{ kind = \"sphere\", radius = 50, apex = [0.5, 0.5, 0] }, { kind = \"plane\", gap = 1e-5 }]";

/// Returns the block with another one on it, both supported at their tops.
fn two_bodies() -> String {
    let one = |name: &str, at: &str| {
        format!(
            "[[body]]\nname = \"{name}\"\nat = {at}\n[body.mesh]\nkind = \"block\"\nsize = [1, 1]\nelements = [2, 2]\n\
             [body.material]\nyoung = 1e9\npoisson = 0.3\n[[support]]\nboundary = \"{name}:top\"\nfix = [\"x\", \"y\"]\n"
        )
    };
    let between = "[[contact]]\nboundary = \"upper:bottom\"\nagainst = \"lower:top\"\nfriction = 0.3\nslave = \"automatic\"\n\
                   [[load]]\nboundary = \"upper:right\"\ntraction = [0, -1e5]\n";
    [&one("lower", "[0, 0]"), &one("upper", "[0, 1]"), between, "[time]\nend = 1\nincrements = 1\n"].concat()
}

/// Changes of the block that make increments be halved.
const HALVED: [&str; 12] = [
    "--setting",
    "default",
    "--set",
    "mesh.elements=[20,20]",
    "--set",
    "material.poisson=0.49",
    "--set",
    "time.increments=2",
    "--set",
    "solver.max_iterations=3",
    "--set",
    "contact.friction=0.8",
];

/// A plate on soft springs. A ball presses down its right end, which meets a plane that few nodes seem to reach.
const LEVER: &str = r#"
[mesh]
kind = "block"
size = [0.08, 0.04, 0.004]
elements = [20, 12, 1]
[material]
young = 210e9
poisson = 0.3
[[spring]]
boundary = "bottom"
normal = 1e8
tangential = 1e8
[[contact]]
boundary = "top"
friction = 0.3
obstacle = { kind = "sphere", radius = 0.1, apex = [0.06, 0.02, 0.004], approach = [[0, 0], [1, 2e-4]] }
[[contact]]
boundary = "bottom"
friction = 0.3
obstacle = { kind = "plane", gap = 2.2e-4 }
[solver]
linear = "condensed"
[time]
end = 1.0
increments = 2
"#;

/// Returns a block held only by friction, pressed and then pushed beyond the friction limit.
fn lost_path() -> String {
    let on_the_plane = edit(&without(&small(), "[[support]]", "[[contact]]"), "gap = 1e-5", "gap = 0.0");
    edit(&on_the_plane, "[[0, 0], [1, 1], [2, 0]]", "[[0, 0], [1, 0], [2, 1]]")
}

/// Returns reports of many kinds: in the plane and in space, failed, with warnings, with all optional results.
fn reports() -> Vec<Value> {
    let cube = edit(include_str!("../../../../data/scenes/cube.toml"), "[10, 10, 10]", "[2, 2, 2]");
    let json_of = |scene: &str, args: &[&str]| {
        let (_folder, scene) = Folder::with_scene(scene);
        json(&stickslip(&[&["run", &scene, "--json"], args].concat()))
    };
    vec![
        json_of(&small(), &["--uniqueness"]),
        json_of(&small(), &["--solver", "auto"]),
        json_of(&small(), &["--set", "contact.friction=0.0", "--uniqueness"]),
        // Loads that are there at t = 0 and change at once.
        json_of(&small(), &["--setting", "default", "--set", "load[0].history=[[0,1],[2,0.25]]", "--increments", "1"]),
        json_of(&edit(&small(), "young = 210e9", "young = 210e5"), &["--setting", "default"]),
        json_of(&cube, &["--method", "ip"]),
        json_of(&small(), &["--set", "mesh.cells=\"triangle\"", "--set", "mesh.refine=0.1"]),
        json_of(&edit(&cube, "{ kind = \"plane\", gap = 1e-5 }", ON_A_BALL), &[]),
        json_of(&small(), &HALVED),
        json_of(&[&small(), "\n[[spring]]\nboundary = \"right\"\nnormal = 1e9\n"].concat(), &[]),
        json_of(&[&small(), "\n[[coupling]]\nname = \"end\"\nboundary = \"right\"\n"].concat(), &[]),
        json_of(include_str!("../../../../data/scenes/bolt.toml"), &[]),
        report(&edit(&small(), "[solver]", "[solver]\nmax_iterations = 1"), 1),
        json_of(
            &edit(
                &small(),
                "{ kind = \"plane\", gap = 1e-5 }",
                "{ kind = \"cylinder\", radius = 9, apex = [0.5, -1e-6] }",
            ),
            &[],
        ),
        json_of(&small(), &["--set", "units.length=ft", "--set", "units.stress=psi"]),
        report(&without(&small(), "[[support]]", "[[load]]"), 1),
        json_of(&two_bodies(), &[]),
        #[cfg(feature = "petsc")]
        json_of(&small(), &["--setting", "default", "--solver", "multigrid"]),
        json_of(include_str!("../../../../data/scenes/two_blocks.toml"), &["--set", "contact.slave=\"automatic\""]),
        json_of(LEVER, &[]),
        json_of(
            &small(),
            &[
                "--set",
                "output.cycle=[1.5,2]",
                "--set",
                "load[1].history=[[0,0],[1,0],[1.25,1],[1.5,0],[1.75,1],[2,0]]",
            ],
        ),
        json_of(&lost_path(), &["--method", "events"]),
        json_of(OBLIQUE_BEAM, &["--method", "bn"]),
    ]
}

/// A report with all entries for a BLAS, if available.
#[cfg(feature = "umfpack")]
use crate::blas_kernel::on_a_slow_kernel;

#[cfg(not(feature = "umfpack"))]
fn on_a_slow_kernel() -> Option<Value> {
    None
}

#[test]
fn reports_are_as_their_schema_says() {
    let schema = schema("run");
    let mut known = BTreeSet::new();
    keys(&schema, &schema, "", &mut known);
    let mut found = BTreeSet::new();
    let on_a_slow_kernel = on_a_slow_kernel();
    for report in reports().into_iter().chain(on_a_slow_kernel.clone()) {
        assert_eq!(faults(&schema, &schema, &report, "run"), [""; 0]);
        keys_of(&report, "", &mut found);
    }
    assert_eq!(found.difference(&known).collect::<Vec<_>>(), [""; 0], "in a report, not in the schema");
    let excused = |key: &str| {
        key.starts_with("range_left")
            || (key.starts_with("blas") && on_a_slow_kernel.is_none())
            // MPI processes, which tests/large covers.
            || key.starts_with("totals.ranks")
            || (key == "totals.krylov_iterations" && cfg!(not(feature = "petsc")))
    };
    let missing: Vec<_> = known.difference(&found).filter(|key| !excused(key)).collect();
    assert_eq!(missing, [""; 0], "in the schema, in no report");
    let broken = serde_json::json!({ "schema_version": "one" });
    assert!(faults(&schema, &schema, &broken, "run").len() > 5);
}

/// The table of doc/reference/results.md contains exactly the keys of reports.
#[test]
fn every_key_of_a_report_is_documented() {
    let page =
        fs::read_to_string(Path::new(concat!(env!("CARGO_MANIFEST_DIR"), "/../..")).join("doc/reference/results.md"))
            .unwrap();
    let table = &page[page.find("| key |").unwrap()..page.find("## Verdicts").unwrap()];
    let first_cells = table.lines().filter_map(|line| line.strip_prefix("| `")?.split(" | ").next());
    let documented: Vec<&str> = first_cells.flat_map(|cell| cell.trim_end_matches('`').split("`, `")).collect();
    let once: BTreeSet<String> = documented.iter().map(ToString::to_string).collect();
    assert_eq!(once.len(), documented.len());
    let (schema, mut known) = (schema("run"), BTreeSet::new());
    keys(&schema, &schema, "", &mut known);
    assert_eq!(once, known);
}

/// Reports on exchange files follow their schema, and every key of the schema occurs.
#[test]
fn problems_are_told_as_their_schemas_say() {
    let file = |name: &str| {
        Path::new(concat!(env!("CARGO_MANIFEST_DIR"), "/../..")).join("data/problems").join(name).display().to_string()
    };
    let folder = Folder::new();
    let solved = folder.join("solved.hdf5");
    fs::write(folder.join("bad.dat"), "5").unwrap();
    fs::copy(file("sliding.dat"), folder.join("sliding.dat")).unwrap();
    let output = |args: &[&str]| json(&stickslip(args));
    let problems = [
        output(&["solve", &file("global.hdf5"), "--out", &solved, "--json"]),
        output(&["judge", &solved, "--json"]),
        output(&["solve", &file("printed.dat"), "--json"]),
    ];
    let collections = [output(&["collection", &folder.join(""), "--json"])];
    for (of, reports) in [("problem", &problems[..]), ("collection", &collections)] {
        let schema = schema(of);
        let (mut known, mut found) = (BTreeSet::new(), BTreeSet::new());
        keys(&schema, &schema, "", &mut known);
        for report in reports {
            assert_eq!(faults(&schema, &schema, report, of), [""; 0]);
            keys_of(report, "", &mut found);
        }
        assert_eq!(found, known, "{of}");
        let page =
            fs::read_to_string(Path::new(concat!(env!("CARGO_MANIFEST_DIR"), "/../..")).join("doc/howto/exchange.md"))
                .unwrap();
        for key in &known {
            let last = key.rsplit(['.', ']']).next().unwrap();
            assert!(last.is_empty() || page.contains(&format!("`{last}`")), "doc/howto/exchange.md lacks {last}");
        }
    }
}

fn as_json(text: &str) -> Value {
    serde_json::to_value(toml::from_str::<toml::Table>(text).unwrap()).unwrap()
}

#[test]
fn scenes_are_as_their_schema_says() {
    let schema = schema("scene");
    let folder = Path::new(concat!(env!("CARGO_MANIFEST_DIR"), "/../..")).join("data/scenes");
    for entry in fs::read_dir(folder).unwrap() {
        let path = entry.unwrap().path();
        let scene = as_json(&fs::read_to_string(&path).unwrap());
        assert_eq!(faults(&schema, &schema, &scene, "scene"), [""; 0], "{}", path.display());
    }
    let bodies = as_json(&two_bodies());
    assert_eq!(faults(&schema, &schema, &bodies, "scene"), [""; 0]);
    for (from, to, fault) in [
        ("poisson", "poison", "scene.material: unknown key poison"),
        ("\"plane\"", "\"plain\"", "scene.contact[0].obstacle: fits none"),
        ("friction = 0.4", "friction = -0.4", "scene.contact[0].friction: out of range"),
        ("[time]", "[times]", "scene: unknown key times"),
        ("end = 2.0", "end = \"2\"", "scene.time.end: not of the type"),
    ] {
        let found = faults(&schema, &schema, &as_json(&edit(&small(), from, to)), "scene");
        assert!(found.iter().any(|found| found.contains(fault)), "{fault}: {found:?}");
    }
}

/// Returns the words that an error of the reader lists.
fn expected(error: &str) -> BTreeSet<&str> {
    let list = error.split_once("expected ").unwrap_or_else(|| panic!("{error}")).1;
    // The name of the table is no part of the list.
    let list = list.split(" in `").next().unwrap();
    list.split('`').skip(1).step_by(2).collect()
}

/// The schema has the same keys as the reader, table by table, as listed in the reader's error for an unknown key.
#[test]
fn the_schema_of_scenes_has_the_keys_of_the_reader() {
    let schema = schema("scene");
    let motion = "contact.obstacle.motion={rotation={through=[0,0],history=[[0,0]]}}".parse().unwrap();
    let base = Scene::parse("scene.toml", &small(), &[motion]).unwrap();
    for (path, place) in [
        ("{}", ""),
        ("units.{}", "units"),
        ("mesh.{}", "mesh"),
        ("material.{}", "material"),
        ("material.group=[{name=\"body\",young=1,poisson=0,{}}]", "material_group"),
        ("body=[{name=\"a\",mesh={kind=\"block\",size=[1,1],elements=[1,1]},material={young=1,poisson=0},{}}]", "body"),
        ("support.{}", "support"),
        ("contact.{}", "contact"),
        ("contact.obstacle.{}", "obstacle"),
        ("contact.obstacle.motion.{}", "motion"),
        ("contact.obstacle.motion.rotation.{}", "rotation"),
        ("load.{}", "load"),
        ("time.{}", "time"),
        ("solver.{}", "solver"),
        ("output.{}", "output"),
        ("output.probe=[{name=\"a\",point=[0,0],{}}]", "probe"),
    ] {
        let refused = |key: &str| base.with(&[path.replace("{}", key).parse().unwrap()]).unwrap_err().to_string();
        let error = refused("nonsense=1");
        let reader = expected(&error);
        let table = if place.is_empty() { &schema } else { &schema["$defs"][place] };
        let known: BTreeSet<&str> = table["properties"].as_object().unwrap().keys().map(String::as_str).collect();
        assert_eq!(known, reader, "{path}");
        for (key, of) in table["properties"].as_object().unwrap() {
            let of = of.get("$ref").map_or(of, |name| target(&schema, name));
            let Some(words) = of.get("enum") else { continue };
            let error = refused(&format!("{key}=\"nonsense\""));
            let reader = expected(&error);
            let known: BTreeSet<&str> = words.as_array().unwrap().iter().map(|word| word.as_str().unwrap()).collect();
            assert_eq!(known, reader, "{path}: {key}");
        }
    }
}
