//! Input files of Abaqus and CalculiX: their meshes, sets and surfaces, and what is refused.

use crate::common::prelude::*;
use std::fmt::Write as _;

use crate::common::mesh_files::inp;
use crate::files::mesh_formats::{from_least, of_all_kinds};

fn read(text: &str) -> Mesh {
    MeshFormat::Abaqus.parse("part.inp", text.as_bytes(), 1.0).unwrap()
}

fn refused(text: &str) -> MeshFileError {
    MeshFormat::Abaqus.parse("bad.inp", text.as_bytes(), 1.0).unwrap_err()
}

/// The mesh with names in capitals.
fn in_capitals(mut mesh: Mesh) -> Mesh {
    for name in mesh.groups.iter_mut().chain(mesh.boundaries.iter_mut().map(|boundary| &mut boundary.name)) {
        *name = name.to_uppercase();
    }
    mesh
}

/// Every kind of elements has its nodes in the right order, and its sides S1, S2, ... of Abaqus's manual.
#[test]
fn all_kinds_of_elements_with_their_sides() {
    // Abaqus has no quadrilateral of nine nodes.
    for mesh in of_all_kinds().into_iter().filter(|mesh| mesh.cells[0].kind != CellKind::Quadrilateral9) {
        let written = inp(&mesh);
        // Nall is a node set with all sides.
        let mut read = read(&written);
        assert_eq!(read.boundaries.pop().unwrap().name, "NALL");
        read.notes = Notes::default();
        assert_eq!(from_least(read), from_least(in_capitals(mesh)));
    }
}

/// A hexahedron with curved edges, and a quadrilateral.
const BENT: [&str; 2] = [include_str!("data/bent_hexahedron.inp"), include_str!("data/bent_quadrilateral.inp")];

/// The forces that move one side of an element of second order are those of CalculiX 2.20 for the same file.
#[test]
fn forces_of_calculix() {
    let cases = [
        ("x y z", "[0.01, 0.005, -0.02]", [4.511_715e-3, 1.899_144e-3, -4.322_054e-2]),
        ("x y", "[0.01, 0.005]", [4.681_195e-3, 7.984_919e-3, 0.0]),
    ];
    for (text, (axes, moved, expected)) in BENT.into_iter().zip(cases) {
        let fix: Vec<&str> = axes.split(' ').collect();
        let scene = format!(
            "[mesh]\nkind = \"block\"\nsize = [1, 1]\nelements = [1, 1]\n[material]\nyoung = 1.0\npoisson = 0.3\n\
             [[support]]\nboundary = \"LOW\"\nfix = {fix:?}\n\
             [[support]]\nboundary = \"HIGH\"\nfix = {fix:?}\ndisplacement = {moved}\n\
             [time]\nend = 1\nincrements = 1\n"
        );
        let mut scene = parsed(&scene);
        scene.description.mesh = read(text).into();
        let report = Run::new(&scene).unwrap().solve(&mut ()).unwrap();
        let force = &report.reactions[0].supports[1].force;
        for c in 0..fix.len() {
            assert!((force[c] / expected[c] - 1.0).abs() < 2e-7, "{axes}: {force:?}");
        }
    }
}

/// Two quadrilaterals above each other, 1 by 1 each.
const TOWER: &str = include_str!("data/tower.inp");

#[test]
fn sets_and_surfaces_are_groups_and_boundaries() {
    let mesh = read(TOWER);
    assert_eq!((mesh.dimension, mesh.nodes.len(), mesh.cells.len()), (2, 6, 2));
    assert_eq!(mesh.nodes[2], [0.0, 1.0, 0.0]);
    assert_eq!(mesh.groups, ["LOWER", "UPPER"]);
    assert_eq!(mesh.boundary_names(), ["LEFT", "OUTER", "ALL", "FOOT", "RIGHT", "ROOF", "NODES"]);
    let facets = |name: &str| &mesh.boundary(name).unwrap().facets;
    assert_eq!(facets("LEFT"), &[[4, 2], [2, 0]]);
    assert_eq!((facets("FOOT"), facets("NODES")), (&vec![vec![0, 1]], &vec![vec![0, 1]]));
    assert_eq!(facets("RIGHT"), &[[1, 3], [3, 5]]);
    assert_eq!((facets("ROOF").len(), facets("OUTER").len(), facets("ALL").len()), (3, 6, 6));
    assert_eq!(
        mesh.notes.remarks,
        [
            "left aside, as no part of the mesh: *SURFACE, NAME=ROLLER; *MATERIAL; *ELASTIC; *STEP",
            "of the elements CPE4R the nodes are read; `element` chooses the strains",
            "the node set TIP has no whole side, so that it is no boundary; its nodes: (1, 2)",
            "1 node is left out: no element of the body has it",
        ]
    );
    // Without sections all ELSETs are groups.
    let without = &TOWER[..TOWER.find("*SOLID SECTION").unwrap()];
    assert_eq!(read(without).groups, ["AGAIN+BOTH+LOWER", "AGAIN+BOTH+UPPER"]);
}

/// A scene names sets as the file does, in capitals or small letters.
#[test]
fn names_of_sets_in_small_letters() {
    let run = |names: [&str; 4]| {
        let [foot, roof, lower, upper] = names;
        let text = format!(
            "mesh = {{ kind = 'block', size = [1, 1], elements = [1, 1] }}\n\
             material = {{ young = 1e9, poisson = 0.3, group = [{{ name = '{lower}', young = 1e9, poisson = 0.3 }}, \
             {{ name = '{upper}', young = 2e9, poisson = 0.3 }}] }}\n\
             support = [{{ boundary = '{roof}', fix = ['x'], displacement = [0] }}, \
             {{ boundary = '{foot}', fix = ['x', 'y'] }}]\n\
             load = [{{ boundary = '{roof}', traction = [0, -1e6] }}]\ntime = {{ end = 1, increments = 1 }}\n"
        );
        let mut scene = parsed(&text);
        scene.description.mesh = read(TOWER).into();
        let report = Run::new(&scene).unwrap().solve(&mut ()).unwrap();
        report.increments[0].strain_energy
    };
    let capitals = run(["FOOT", "ROOF", "LOWER", "UPPER"]);
    assert_eq!(run(["foot", "Roof", "Lower", "UPPER"]).to_bits(), capitals.to_bits());
    // Where two names differ by their capitals alone, they are two.
    let mut mesh = read(TOWER);
    mesh.boundaries[0].name = "foot".to_string();
    assert_eq!(mesh.boundary("foot").unwrap().facets, [[4, 2], [2, 0]]);
    assert!(mesh.boundary("Foot").unwrap().name == "FOOT" && mesh.boundary("Left").is_none());
}

/// Plane elements on the faces of solid ones are boundaries.
#[test]
fn skins() {
    let cube = inp(&block(&[1.0; 3], &[1; 3]));
    let skin = "*ELEMENT, TYPE=CPS4, ELSET=SKIN\n7, 1, 2, 4, 3\n";
    let mesh = read(&cube.replacen("*SURFACE", &format!("{skin}*SURFACE"), 1));
    assert_eq!((mesh.dimension, mesh.cells.len()), (3, 1));
    assert_eq!(mesh.boundary("SKIN").unwrap().facets.len(), 1);
}

/// Lines on the sides of plane elements are boundaries, and so are a skin and a node set of the same name.
#[test]
fn lines_and_sets_of_one_name() {
    let lines = |kind: &str, rows: &str, text: &str| {
        text.replacen("*ELEMENT", &format!("*ELEMENT, TYPE={kind}, ELSET=foot\n{rows}\n*ELEMENT"), 1)
    };
    for name in ["T3D2", "T2D2"] {
        let mesh = read(&lines(name, "7, 1, 2\n8, 2, 4", &TOWER.replace("*Element", "*ELEMENT")));
        assert_eq!((mesh.dimension, mesh.boundary("FOOT").unwrap().facets.len()), (2, 2));
    }
    // The node at the middle may be in any place.
    for row in ["7, 3, 4, 7", "7, 3, 7, 4"] {
        let mesh = read(&lines("T3D3", row, BENT[1]));
        assert_eq!(mesh.boundary("FOOT").unwrap().facets, [[2, 6, 3]]);
        let mesh = read(&lines("T3D3", row, BENT[1]).replace("NSET=HIGH", "NSET=FOOT"));
        assert_eq!(mesh.boundary("FOOT").unwrap().facets, [[2, 6, 3]]);
    }
    let cube = inp(&block(&[1.0; 3], &[2, 1, 1]));
    let skin = "*ELEMENT, TYPE=CPS4, ELSET=SKIN\n7, 1, 2, 5, 4\n*NSET, NSET=SKIN\n1, 2, 3, 4, 5, 6\n";
    let mesh = read(&cube.replacen("*SURFACE", &format!("{skin}*SURFACE"), 1));
    assert_eq!(mesh.boundary("SKIN").unwrap().facets.len(), 2, "{:?}", mesh.notes);
    // With a section of their own, lines would carry forces.
    let trusses =
        TOWER.replace("*Element", "*ELEMENT").replace("*SOLIDSECTION, ELSET=UPPER", "*SOLIDSECTION, ELSET=FOOT");
    says(&refused(&lines("T3D2", "7, 1, 2", &trusses)), "trusses", "");
}

/// Faults of the tower: what is replaced, by what, words of the message and of the help.
const FAULTS: &str = include_str!("../refused/tables/abaqus.txt");

#[test]
fn what_is_no_mesh_is_refused_with_its_line() {
    for [from, to, message, help] in rows(FAULTS) {
        let error = refused(&edit(TOWER, &from, &to));
        assert!(error.to_string().starts_with("bad.inp:"), "{error}");
        says(&error, &message, &help);
    }
    says(&refused("$MeshFormat\n4.1 0 8\n"), "it is a mesh of Gmsh", "kind = \"gmsh\"");
    says(&refused(""), "no elements", "");
}

/// Each element has the names of its groups: long names of large sets could take far more memory than the file.
#[test]
fn long_names_of_many_sets() {
    let plate = inp(&block(&[1.0, 1.0], &[20, 20]));
    let with_names_of = |letters: usize| {
        let sets = (0..100).map(|k| format!("*ELSET, ELSET={k:A>letters$}, GENERATE\n1, 400, 1\n"));
        plate.replacen("*SURFACE", &format!("{}*SURFACE", sets.collect::<String>()), 1)
    };
    assert!(plate.contains("*SURFACE") && !plate.contains("*SOLID SECTION"));
    assert!(read(&with_names_of(8)).notes.combined[0].1.len() >= 100);
    let long = refused(&with_names_of(4000));
    says(&long, "names and members that are far longer than the file", "shorter names");
}

/// A file that is damaged anywhere is read or refused with a message and a cure.
#[test]
fn damaged_files() {
    for k in 0..TOWER.len() {
        let parts = [TOWER[..k].to_string(), format!("{},{}", &TOWER[..k], &TOWER[k..])];
        let removed = format!("{}{}", &TOWER[..k], &TOWER[k + 1..]);
        for text in parts.into_iter().chain([removed]) {
            if let Err(error) = MeshFormat::Abaqus.parse("bad.inp", text.as_bytes(), 1.0) {
                assert!(error.to_string().starts_with("bad.inp") && error.help().is_some(), "{error}");
            }
        }
    }
}

/// Sets that repeat one another, and ranges of any length, take no more memory than the file justifies.
#[test]
fn sets_do_not_grow_without_bound() {
    let long = TOWER.replace(" 10, 20, 10", " 10, 18446744073709551615");
    assert_eq!(read(&long).boundary("LEFT").unwrap().facets.len(), 2);
    let mut node_sets = String::new();
    for k in 0..6000 {
        writeln!(node_sets, "*NSET, NSET=N{k}, ELSET=BOTH").unwrap();
    }
    says(&refused(&TOWER.replace("*STEP\n", &node_sets)), "the sets repeat one another", "");
    let mut sets = "*ELSET, ELSET=S0\n10, 20\n".to_string();
    for k in 1..2000 {
        writeln!(sets, "*ELSET, ELSET=S{k}\nS{}, {k}", k - 1).unwrap();
    }
    says(&refused(&TOWER.replace("*STEP\n", &sets)), "the sets repeat one another", "fewer");
}

/// Included files are relative to the file that includes them, and belong to the files of the scene.
#[test]
fn includes() {
    let folder = std::env::temp_dir().join(format!("stickslip-includes-{}", std::process::id()));
    fs::create_dir_all(folder.join("parts")).unwrap();
    let (head, tail) = TOWER.split_at(TOWER.find("*Element").unwrap());
    let whole = read(TOWER);
    fs::write(folder.join("all.inp"), format!("*Include, Input=parts/nodes.inp\n{tail}")).unwrap();
    fs::write(folder.join("parts/nodes.inp"), "*INCLUDE, INPUT=more.inp\n").unwrap();
    fs::write(folder.join("parts/more.inp"), head).unwrap();
    assert_eq!(MeshFormat::Abaqus.read(&folder.join("all.inp"), 1.0).unwrap(), whole);
    let text = "mesh = { kind = 'abaqus', file = 'all.inp' }\nmaterial = { young = 1e9, poisson = 0.3 }\n\
        support = [{ boundary = 'FOOT', fix = ['x', 'y'] }]\ntime = { end = 1, increments = 1 }\n";
    let scene = Scene::parse(&folder.join("scene.toml").display().to_string(), text, &[]).unwrap();
    let files = ["all.inp", "parts/nodes.inp", "parts/more.inp"].map(|file| folder.join(file));
    assert_eq!(scene.files(), files);
    fs::write(folder.join("parts/more.inp"), "*INCLUDE, INPUT=nodes.inp\n").unwrap();
    let error = MeshFormat::Abaqus.read(&folder.join("all.inp"), 1.0).unwrap_err().to_string();
    fs::remove_dir_all(&folder).unwrap();
    assert!(error.contains("more.inp:1: ") && error.contains("nodes.inp is included twice"), "{error}");
}
