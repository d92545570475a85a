//! `--set` changes what it names and nothing else, and what it cannot change it refuses.

use crate::common::prelude::*;

/// A second contact, with its obstacle as a table of its own.
const SECOND: &str =
    "\n[[contact]]\nboundary = \"top\"\nfriction = 0.2\n[contact.obstacle]\nkind = \"plane\"\ngap = 2e-5\n";

fn parse(text: &str, sets: &[&str]) -> Result<Scene, SceneError> {
    let overrides: Vec<Override> = sets.iter().map(|set| set.parse().unwrap()).collect();
    Scene::parse("block.toml", text, &overrides)
}

fn scene(sets: &[&str]) -> Scene {
    parse(BLOCK, sets).unwrap()
}

fn two_contacts(sets: &[&str]) -> Scene {
    parse(&[BLOCK, SECOND].concat(), sets).unwrap()
}

/// The scene without the tables from `from` to `to`, or to its end.
fn without(from: &str, to: Option<&str>) -> String {
    let rest = to.map_or("", |to| &BLOCK[BLOCK.find(to).unwrap()..]);
    [&BLOCK[..BLOCK.find(from).unwrap()], rest].concat()
}

fn line_of(marker: &str) -> usize {
    1 + BLOCK[..BLOCK.find(marker).unwrap()].matches('\n').count()
}

fn gap(obstacle: &Obstacle) -> f64 {
    let Shape::Plane { gap } = obstacle.shape else { panic!("not a plane") };
    gap
}

/// A list of tables may be given whole, and a number that TOML does not know is one all the same.
#[test]
fn lists_and_numbers() {
    let whole = "contact=[{boundary=\"top\", friction=0.25, obstacle={kind=\"plane\", gap=0}}]";
    let contact = &scene(&[whole]).description.contacts[0];
    assert_eq!((contact.boundary.as_str(), &contact.friction), ("top", &0.25.into()));
    assert_eq!(scene(&["contact.friction=.5"]).description.contacts[0].friction, 0.5.into());
    for (set, says) in [("material.young=1e400", "young"), ("time.increments=99999999999999999999", "increments")] {
        let error = parse(BLOCK, &[set]).unwrap_err().to_string();
        assert!(error.contains(says) && !error.contains("string"), "{error}");
    }
}

#[test]
fn what_is_not_key_equals_value_is_refused() {
    let faulty = [
        "",
        "mesh.elements",
        "=3",
        "mesh..elements=3",
        ".mesh=3",
        "mesh.=3",
        "mesh elements=3",
        "contact[].friction=1",
        "contact[x].friction=1",
        "contact[-1].friction=1",
        "contact[0.friction=1",
        "contact0].friction=1",
        "[0].friction=1",
    ];
    for text in faulty {
        let error = text.parse::<Override>().err().unwrap_or_else(|| panic!("accepted: {text}"));
        let message = error.to_string();
        assert!(message.starts_with(&format!("`{text}` is not of the form key=value, such as ")), "{message}");
    }
}

#[test]
fn a_value_is_replaced() {
    assert_eq!(
        scene(&["mesh.elements=[7, 8]"]).description.mesh,
        MeshSource::Block {
            axes: [7, 8].map(|elements| vec![Segment { length: 1.0, elements, grading: 1.0 }]).to_vec(),
            cells: CellKind::Quadrilateral,
            origin: None
        }
    );
    assert_eq!(scene(&[" material.poisson = 0.25 "]).description.material.poisson, 0.25);
    assert_eq!(scene(&["time.end=3", "time.end=4"]).time.end, 4.0);
    let changed = scene(&["time.increments=3"]);
    assert_eq!((changed.time.increments, changed.description.material), (3, scene(&[]).description.material));
}

#[test]
fn bare_words_are_strings() {
    assert_eq!(scene(&["material.plane=stress"]).description.material.plane, Some(Plane::Stress));
    assert_eq!(scene(&["material.plane=\"stress\""]).description.material.plane, Some(Plane::Stress));
    assert_eq!(scene(&["title=A = b, \"c\""]).title, "A = b, \"c\"");
}

#[test]
fn one_contact_or_all() {
    let frictions =
        |sets: &[&str]| two_contacts(sets).description.contacts.into_iter().map(|c| c.friction).collect::<Vec<_>>();
    let of = |mu: [f64; 2]| mu.map(Field::Uniform);
    assert_eq!(frictions(&[]), of([0.4, 0.2]));
    assert_eq!(frictions(&["contact.friction=0.7"]), of([0.7, 0.7]));
    assert_eq!(frictions(&["contact[0].friction=0.7"]), of([0.7, 0.2]));
    assert_eq!(frictions(&["contact[1].friction=0.7"]), of([0.4, 0.7]));
    let gaps = |sets: &[&str]| {
        two_contacts(sets).description.contacts.iter().map(|c| gap(&c.obstacles()[0])).collect::<Vec<_>>()
    };
    assert_eq!(gaps(&["contact.obstacle.gap=3e-5"]), [3e-5, 3e-5]);
    assert_eq!(gaps(&["contact[0].obstacle.gap=3e-5"]), [3e-5, 2e-5]);
    let loads = scene(&["load[1].traction=[1, 2]"]).description.loads;
    let expected =
        [("top", [0.0, -10e6]), ("right", [1.0, 2.0])].map(|(boundary, traction)| Load::new(boundary, &traction));
    assert_eq!([&loads[0].action, &loads[1].action], expected.each_ref().map(|load| &load.action));
}

#[test]
fn contacts_in_one_line_are_a_list_too() {
    let inline = "contact = [{ boundary = \"bottom\", friction = 0.4, obstacle = { kind = \"plane\" } }]\n";
    let text = [inline, &without("[[contact]]", Some("[[load]]"))].concat();
    for set in ["contact.friction=0.7", "contact[0].friction=0.7"] {
        assert_eq!(parse(&text, &[set]).unwrap().description.contacts[0].friction, 0.7.into());
    }
    let error = parse(&text, &["contact[1].friction=0.7"]).unwrap_err().to_string();
    assert!(error.contains("has 1 [[contact]]"), "{error}");
}

#[test]
fn what_the_scene_leaves_out_is_added() {
    let bare = without("[solver]", None);
    assert_eq!(parse(&bare, &["output.times=[1.0]"]).unwrap().output.times, [1.0]);
    let solver = parse(&bare, &["solver.max_iterations=7", "solver.tolerance=1e-6"]).unwrap().solver;
    assert_eq!((solver.max_iterations, solver.tolerance), (7, 1e-6));
    let changed = scene(&["contact.obstacle.normal=[0, -2]"]);
    let obstacle = &changed.description.contacts[0].obstacles()[0];
    assert_eq!((gap(obstacle), obstacle.normal), (1e-5, Some([0.0, -2.0].into())));
    // An added table is checked as any other.
    let error = parse(&bare, &["output.times=[5]"]).unwrap_err().to_string();
    assert!(error.contains("output.times holds 5"), "{error}");
}

#[test]
fn an_unknown_key_is_reported_as_such() {
    for (set, key) in [
        ("material.youngs=1", "youngs"),
        ("mat.young=1", "mat"),
        ("contact.obstacle.hole=1", "hole"),
        ("contact[0].mu=1", "mu"),
        ("output.time=[1.0]", "time"),
        ("colour=red", "colour"),
    ] {
        let error = parse(BLOCK, &[set]).unwrap_err();
        let message = error.to_string();
        assert!(message.contains(&format!("unknown field `{key}`, expected ")), "{set}: {message}");
        assert!(error.help().unwrap().to_string().contains("spelling"));
    }
}

/// An index at the end of a key is that of one entry of a list. The other entries stay.
#[test]
fn an_index_sets_one_entry_of_a_list() {
    let changed = scene(&["load[1].traction[0]=123", "mesh.elements[1]=7", "load[0].history[1][1]=0.5"]);
    let whole = ["load[1].traction=[123, 0.0]", "mesh.elements=[100, 7]", "load[0].history=[[0, 0], [1, 0.5], [2, 1]]"];
    let whole = scene(&whole);
    assert_eq!(changed.description.loads, whole.description.loads);
    assert_eq!(changed.description.mesh, whole.description.mesh);
    assert_ne!(changed.description.loads, scene(&[]).description.loads);
    // Lines and comments stay.
    for mark in ['\n', '#'] {
        assert_eq!(changed.text().matches(mark).count(), BLOCK.matches(mark).count());
    }
}

#[test]
fn what_cannot_be_set_is_refused() {
    let no_contact = without("[[contact]]", Some("[[load]]"));
    for (text, set, says, remedy) in [
        (BLOCK, "contact[1].friction=1", "has 1 [[contact]], so there is no contact[1]", "from 0"),
        (BLOCK, "load[2].history=[]", "has 2 [[load]], so there is no load[2]", "from 0"),
        (&no_contact, "contact.friction=1", "no [[contact]]", "add one"),
        (&no_contact, "contact[0].friction=1", "no [[contact]]", "add one"),
        (BLOCK, "material=3", "`material` is a table", "one of its keys"),
        (BLOCK, "contact=3", "`contact` is a table", "one of its keys"),
        (BLOCK, "contact[0]=3", "whole table", "one of its keys"),
        (BLOCK, "time[0].end=1", "`time` is not a list of tables", "leave the [index] out"),
        (BLOCK, "time.end[0]=1", "`end` is not a list", "leave the [index] out"),
        (BLOCK, "mesh[0]=1", "`mesh` is not a list", "leave the [index] out"),
        (BLOCK, "mesh.elements[2]=1", "`elements` has 2 entries, so there is no elements[2]", "from 0"),
        (BLOCK, "load[0].history[1][2]=1", "`history[1]` has 2 entries, so there is no history[1][2]", "from 0"),
        (BLOCK, "mesh.elements[0][0]=1", "`elements[0]` is not a list", "leave the [index] out"),
        (BLOCK, "load[0].force[0]=1", "the scene has no list `force` there", "set the whole list, force=[...]"),
        (BLOCK, "contact[0][0].friction=1", "contact[0] is a table", "leave the second [index] out"),
        (BLOCK, "time.end.x=1", "`end` is not a table", "look the key up"),
    ] {
        let error = parse(text, &[set]).err().unwrap_or_else(|| panic!("accepted: {set}"));
        let message = error.to_string();
        assert!(message.starts_with(&format!("--set {set}: ")), "{message}");
        assert!(message.contains(says), "`{says}` is not in: {message}");
        let help = error.help().unwrap().to_string();
        assert!(help.contains(remedy), "`{remedy}` is not in: {help}");
    }
}

#[test]
fn values_are_checked_where_they_stand() {
    for (set, marker, says) in [
        ("mesh.elements=[5,5", "elements =", "string \"[5,5\", expected a list"),
        ("mesh.elements=[5, 5, 5]", "elements =", "mesh.elements is [5, 5, 5]"),
        ("material.poisson=0.7", "poisson =", "material.poisson is 0.7"),
        ("material.plane=sress", "plane =", "unknown variant `sress`"),
        ("contact.friction=-1", "friction =", "friction is -1.0"),
        ("contact.obstacle.gap=nan", "gap =", "gap is NaN"),
        ("load[1].history=[]", "[2, 0]]", "history is empty"),
        ("solver.method=newton", "method =", "unknown variant `newton`"),
        ("output.times=[9.0]", "times =", "output.times holds 9"),
    ] {
        let message = parse(BLOCK, &[set]).unwrap_err().to_string();
        let place = format!("block.toml (with --set):{}: ", line_of(marker));
        assert!(message.starts_with(&place), "{set}: not {place}: {message}");
        assert!(message.contains(says), "`{says}` is not in: {message}");
    }
}

#[test]
fn comments_and_lines_stay() {
    let faulty = BLOCK.replace("times = [1.0, 2.0]", "times = [9.0]");
    let sets = ["mesh.elements=[4, 4]", "contact.friction=0.1", "contact.obstacle.gap=2e-5", "time.end=2.5"];
    let error = parse(&faulty, &sets).unwrap_err();
    let message = error.to_string();
    assert!(message.starts_with(&format!("block.toml (with --set):{}: ", line_of("times ="))), "{message}");
    // The text that the message quotes is the scene with only these values changed.
    let expected = faulty
        .replace("[100, 100]", "[4, 4]")
        .replace("friction = 0.4", "friction = 0.1")
        .replace("gap = 1e-5", "gap = 2e-5")
        .replace("end = 2.0", "end = 2.5");
    let quoted = error.source_code().unwrap().read_span(&(0, expected.len()).into(), 0, 0).unwrap();
    assert_eq!(std::str::from_utf8(quoted.data()).unwrap(), expected);
}

/// A key of any length is an error, not a deep recursion, also one made in Rust.
#[test]
fn keys_of_many_parts_are_refused() {
    let key = "a.".repeat(20_000) + "a";
    let made = stickslip::scene::Override::value(&key, 1);
    for set in [made, format!("{key}=1").parse().unwrap(), "a.b.c.d.e.f.g.h.i=1".parse().unwrap()] {
        let error = Scene::parse("block.toml", BLOCK, &[set]).unwrap_err().to_string();
        assert!(error.contains("parts, but no key of a scene has more than 8") && error.len() < 400, "{error}");
    }
}

#[test]
fn a_syntax_error_is_found_in_the_file_itself() {
    let faulty = BLOCK.replace("young = 210e9", "young = ");
    let error = parse(&faulty, &["mesh.elements=[4, 4]"]).unwrap_err();
    assert!(error.to_string().starts_with(&format!("block.toml:{}: ", line_of("young ="))), "{error}");
    assert_eq!(error.help().unwrap().to_string(), "mend the TOML here");
}
