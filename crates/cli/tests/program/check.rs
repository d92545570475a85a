//! `stickslip check`: describes a scene without solving it.

// Given values are read back exactly.
#![allow(clippy::unwrap_used, clippy::float_cmp)]

use std::path::Path;

use crate::common::edit;
use crate::program::{Folder, assert_exit, small, stickslip, unbroken, without};

#[test]
fn check_explains_without_solving() {
    let (folder, scene) = Folder::with_scene(&small());
    let output = stickslip(&["check", &scene]);
    assert_exit(&output, 0);
    for words in [
        "gaps along the normal n = (0, -1), slip along t = (1, 0)",
        "Elastic block on a frictional foundation",
        "4 x 4 elements (quadrilateral), 25 nodes",
        "left: x and y held",
        "bottom: plane at 10 µm, mu = 0.4",
        "40 displacements u",
        "4 normal forces p_n",
        "4 increments of 0.5 s",
        "memory       about ",
        "condensed: 8 contact displacements of 40",
        "held         by its supports",
        "theorem 3    holds: (a) every rigid motion moves a node towards an obstacle; (b) contact rows independent",
    ] {
        assert!(unbroken(&output).contains(words), "`{words}` is not in:\n{}", unbroken(&output));
    }
    assert_eq!(folder.names(""), ["scene.toml"]);
}

/// Elements have the right names, and no locking is reported where nothing locks.
#[test]
fn check_names_nodal_volumes() {
    let text = edit(&small(), "poisson = 0.3", "poisson = 0.4999");
    let output = |cells: &str, element: &str| {
        let text = edit(&text, "elements =", &format!("cells = \"{cells}\"\nelement = \"{element}\"\nelements ="));
        let (_folder, scene) = Folder::with_scene(&text);
        unbroken(&stickslip(&["check", &scene]))
    };
    let (plain, averaged) = (output("triangle", "bilinear"), output("triangle", "nodal-volume"));
    assert!(plain.contains("elements (triangle), 25 nodes") && plain.contains("too stiff"), "{plain}");
    assert!(plain.contains("use mesh.element = \"nodal-volume\""), "{plain}");
    assert!(averaged.contains("elements (triangle, nodal-volume), 25 nodes"), "{averaged}");
    assert!(!averaged.contains("too stiff"), "{averaged}");
    // Above 0.499, cells of second order lock too.
    let (plain, averaged) = (output("triangle6", "bilinear"), output("triangle6", "nodal-volume"));
    assert!(
        plain.contains("elements (triangle of six nodes), 81 nodes") && plain.contains("may be too stiff"),
        "{plain}"
    );
    assert!(plain.contains("use mesh.element = \"nodal-volume\""), "{plain}");
    assert!(averaged.contains("elements (triangle of six nodes, nodal-volume), 81 nodes"), "{averaged}");
    assert!(!averaged.contains("too stiff"), "{averaged}");
}

/// Several obstacles are listed one by one, with the number of nodes that meet each, and the number beyond the reach of
/// all.
#[test]
fn check_tells_every_obstacle() {
    let check = |obstacle: &str| {
        let text = edit(&small(), "obstacle = { kind = \"plane\", gap = 1e-5 }", obstacle);
        let (_folder, scene) = Folder::with_scene(&text);
        let output = stickslip(&["check", &scene]);
        assert_exit(&output, 0);
        unbroken(&output)
    };
    let rollers = "obstacle = [{ kind = \"cylinder\", radius = 0.2, apex = [0.5, -1e-5], approach = [[0, 0], [1, 1e-5]] }, \
                   { kind = \"bore\", radius = 90.0, apex = [1.0, -0.02], direction = \"nearest\" }]";
    let output = check(rollers);
    for words in [
        "contact      bottom: 2 obstacles, mu = 0.4\n",
        "             cylinder, radius 0.2 m, apex (0.5, -0.00001) m, moves in by 0 m at 0 s, 10 µm at 1 s, met by 1 node\n",
        "             bore, radius 90 m, apex (1, -0.02) m, met by 3 nodes\n             gaps to the nearest point",
    ] {
        assert!(output.contains(words), "{words}{output}");
    }
    let output = check("obstacle = { kind = \"cylinder\", radius = 0.2, apex = [0.5, -1e-5] }");
    assert!(output.contains("             4 nodes remain open because no obstacle ever reaches them\n"), "{output}");
    assert!(check("obstacle = { kind = \"plane\" }").contains("mu = 0.4"));
}

/// Every point of a motion is listed like that of a load, and points that coincide with no end of an increment are
/// reported.
#[test]
fn check_tells_histories() {
    let motion = "gap = 1e-5, approach = [[0, 0], [1, 1e-5], [2, 0]], motion = { \
                  translation = [[0, 0, 0], [0.5, 1e-3, 0], [2, 0, 0]], \
                  rotation = { through = [0, 0], history = [[0, 0], [1, 1e-6], [2, -1e-6]] } }";
    let text = edit(&without(&small(), "[[support]]", "[[contact]]"), "gap = 1e-5", motion);
    let check = |text: &str| {
        let (_folder, scene) = Folder::with_scene(text);
        let output = stickslip(&["check", &scene]);
        assert_exit(&output, 0);
        unbroken(&output)
    };
    let output = check(&text);
    let words = "moves in by 0 m at 0 s, 10 µm at 1 s, 0 m at 2 s, \
                 moves by (0, 0) m at 0 s, (0.001, 0) m at 0.5 s, (0, 0) m at 2 s, \
                 turns by 0 rad at 0 s, 1e-6 rad at 1 s, -1e-6 rad at 2 s, mu = 0.4";
    assert!(output.contains(words), "{output}");
    assert!(output.contains("factor 0 at 0 s, 1 at 1 s, 0 at 2 s\n"), "{output}");
    assert!(!output.contains("further ends"), "{output}");
    let output = check(&edit(&text, "history = [[0, 0], [1, 1], [2, 0]]", ""));
    assert!(output.contains("1 at 2 s: it has no history, as others have\n"), "{output}");

    let output = check(&edit(&text, "increments = 4", "increments = 6"));
    let further: Vec<&str> = output.lines().filter(|line| line.contains("further ends")).collect();
    let [line] = further[..] else { panic!("{output}") };
    assert_eq!(line.trim(), "further ends: the kink of the translation of the obstacle at bottom at 0.5 s");
    let output = check(&edit(&text, "increments = 4", "increments = 7"));
    assert_eq!(output.matches("further ends: the kink of ").count(), 5, "{output}");

    // Of ten points, three are omitted.
    let many: Vec<String> = (0..10).map(|k| format!("[{}, {}e-6]", 0.2 * f64::from(k), k % 2)).collect();
    let output = check(&edit(&small(), "gap = 1e-5", &format!("gap = 1e-5, approach = [{}]", many.join(", "))));
    assert!(output.contains("1 µm at 1 s, (3 more), 1 µm at 1.8 s"), "{output}");
}

#[test]
fn check_tells_the_size_of_a_mesh_file() {
    let mesh = Path::new(concat!(env!("CARGO_MANIFEST_DIR"), "/../..")).join("data/meshes/plate_quads_mm.msh");
    let text = edit(&without(&small(), "[mesh]", "[material]"), "\"right\"", "\"top\"");
    let at = text.find("[material]").unwrap();
    for (scale, size) in [("0.001", "0.04 m x 0.02 m over all"), ("1", "40 m x 20 m over all")] {
        let table = format!("[mesh]\nkind = \"gmsh\"\nfile = \"{}\"\nscale = {scale}\n", mesh.display());
        let (_folder, scene) = Folder::with_scene(&[&text[..at], &table, &text[at..]].concat());
        let output = stickslip(&["check", &scene]);
        assert_exit(&output, 0);
        assert!(unbroken(&output).contains(size), "{}", unbroken(&output));
    }
}

/// A coefficient of friction in percent causes a warning before and during a run, but no refusal.
#[test]
fn friction_beyond_what_surfaces_have_is_questioned() {
    let questioned = |friction: &str| {
        let (_folder, scene) = Folder::with_scene(&edit(&small(), "friction = 0.4", friction));
        ["check", "run"].map(|command| {
            let output = stickslip(&[command, &scene]);
            assert_exit(&output, 0);
            unbroken(&output).contains(
                "warning      large-friction: the friction of `bottom` is up to 40, but few surfaces exceed 2: is it in percent?",
            )
        })
    };
    assert_eq!(questioned("friction = 40"), [true; 2]);
    assert_eq!(questioned("friction = \"40 * x\""), [true; 2]);
    assert_eq!(questioned("friction = 1.5"), [false; 2]);
}

/// Changes made while a mesh is read are reported.
#[test]
fn check_tells_what_was_changed_in_a_mesh_file() {
    let upright = |line: &str| match line.split_whitespace().collect::<Vec<_>>()[..] {
        [x, y, "0"] if x.ends_with('0') && y.ends_with('0') => format!("{x} 0 {y}\n"),
        _ => format!("{line}\n"),
    };
    let quads: String = include_str!("../../../../data/meshes/plate_quads_mm.msh").lines().map(upright).collect();
    let with_centre = edit(&quads, "1 15 1 15\n", "2 16 1 16\n0 1 0 1\n16\n5 5 5\n");
    let text = edit(&without(&small(), "[mesh]", "[material]"), "\"right\"", "\"top\"");
    let at = text.find("[material]").unwrap();
    let table = "[mesh]\nkind = \"gmsh\"\nfile = \"upright.msh\"\nscale = 0.001\n";
    let (folder, scene) = Folder::with_scene(&[&text[..at], table, &text[at..]].concat());
    std::fs::write(folder.join("upright.msh"), with_centre).unwrap();
    let output = stickslip(&["check", &scene]);
    assert_exit(&output, 0);
    for words in [
        "0.04 m x 0.02 m over all",
        "\n             1 node is left out: no element of the body has it\n",
        "\n             the mesh lies in the x-z plane of its file: x is x here, z is y\n",
    ] {
        assert!(unbroken(&output).contains(words), "{}", unbroken(&output));
    }
}
