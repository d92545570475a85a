//! Gmsh files are read whole, or refused with the line, the reason and the remedy.

use crate::common::faults::words;
use crate::common::mesh_files::{gmsh_type, in_gmsh_order};
use crate::common::prelude::*;

fn read(name: &str, scale: f64) -> Mesh {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("data/meshes").join(name);
    MeshFormat::Gmsh.read(&path, scale).unwrap()
}

/// The outward area vectors of a boundary, summed.
fn area(mesh: &Mesh, boundary: &str) -> [f64; 3] {
    let mut sum = [0.0; 3];
    for facet in &mesh.boundary(boundary).unwrap().facets {
        sum.iter_mut().zip(mesh.area_vector(facet)).for_each(|(sum, c)| *sum += c);
    }
    sum.map(|c| (c * 1e9).round() / 1e9 + 0.0)
}

#[test]
fn triangles_with_two_materials() {
    let mesh = read("square_triangles.msh", 1.0);
    assert_eq!((mesh.dimension, mesh.nodes.len(), mesh.cells.len()), (2, 25, 32));
    assert!(mesh.nodes.iter().all(|x| x[2] == 0.0) && mesh.cells.iter().all(|c| c.kind == CellKind::Triangle));
    assert_eq!(mesh.groups, ["soft", "hard layer"]);
    let hard = (0..32).filter(|&e| mesh.cells[e].group == 1);
    assert!(hard.clone().count() == 16 && hard.into_iter().all(|e| mesh.centre(e)[1] > 0.5));
    assert_eq!(mesh.boundary_names(), ["bottom", "right", "top", "left"]);
    // However an edge is drawn in the file, the outside is on its right.
    for (name, outwards) in [("bottom", [0.0, -1.0]), ("right", [1.0, 0.0]), ("top", [0.0, 1.0]), ("left", [-1.0, 0.0])]
    {
        assert_eq!(area(&mesh, name), [outwards[0], outwards[1], 0.0], "{name}");
        let facets = &mesh.boundary(name).unwrap().facets;
        assert!(facets.windows(2).all(|pair| pair[0][1] == pair[1][0]), "{name} in a row");
    }
}

#[test]
fn quadrilaterals_in_millimetres() {
    let mesh = read("plate_quads_mm.msh", 1e-3);
    assert_eq!((mesh.dimension, mesh.cells.len()), (2, 8));
    assert_eq!(area(&mesh, "bottom"), [0.0, -0.04, 0.0]);
    assert_eq!(mesh.nodes[14], [0.04, 0.02, 0.0]);
}

#[test]
fn hexahedra_and_tetrahedra() {
    for (name, kind, cells, facets) in
        [("cube_hexahedra.msh", CellKind::Hexahedron, 8, 4), ("cube_tetrahedra.msh", CellKind::Tetrahedron, 48, 8)]
    {
        let mesh = read(name, 1.0);
        assert_eq!((mesh.dimension, mesh.nodes.len(), mesh.cells.len()), (3, 27, cells));
        assert!(mesh.cells.iter().all(|cell| cell.kind == kind));
        assert_eq!(mesh.boundary("top").unwrap().facets.len(), facets);
        assert_eq!(area(&mesh, "bottom"), [0.0, 0.0, -1.0]);
        assert_eq!(area(&mesh, "top"), [0.0, 0.0, 1.0]);
        assert_eq!(area(&mesh, "left"), [-1.0, 0.0, 0.0]);
    }
}

const TRIANGLES: &str = include_str!("../../../data/meshes/square_triangles.msh");
const QUADS: &str = include_str!("../../../data/meshes/plate_quads_mm.msh");
const HEXAHEDRA: &str = include_str!("../../../data/meshes/cube_hexahedra.msh");

fn refused(text: &str) -> MeshFileError {
    from_gmsh("bad.msh", text.as_bytes(), 1.0).unwrap_err()
}

/// Checks what is said of a text.
fn assert_refused(text: &str, message: &str, help: &str) {
    let error = refused(text);
    assert!(error.to_string().starts_with("bad.msh:"), "{error}");
    says(&error, message, help);
}

/// The line of `text`, from 1, that begins with `start`.
fn line(text: &str, start: &str) -> usize {
    1 + text.lines().position(|line| line.starts_with(start)).unwrap()
}

/// Files of other kinds, with words of the message and of the help.
const OTHER_FILES: &str = r#"
- | bad.msh:1: the file does not begin with $MeshFormat | -format msh41
solid cube¶ | bad.msh:1: a section was expected, but there is `solid cube` | -format msh41
$NOD¶25¶ | it is no Gmsh mesh, or one of an older format | gmsh bad.msh -save -format msh41 -o new.msh
*HEADING¶*NODE¶ | bad.msh:1: it is an input of Abaqus or CalculiX | kind = "abaqus"
  -1¶  2411¶ | bad.msh:1: it is a mesh in the format UNV | kind = "unv"
ISO-10303-21;¶ | bad.msh:1: it is a geometry in the format STEP | has to be meshed
"#;

/// Faults of the triangles: what is replaced, by what, words of the message and of the help.
const OF_TRIANGLES: &str = include_str!("../refused/tables/gmsh.txt");

#[test]
fn what_is_no_such_file_is_refused_with_its_line() {
    let cut = |section: &str| TRIANGLES[..TRIANGLES.find(section).unwrap()].to_string();
    let without = |section: &str| {
        let end = format!("$End{section}\n");
        cut(&format!("${section}")) + &TRIANGLES[TRIANGLES.find(&end).unwrap() + end.len()..]
    };
    for [text, message, help] in rows(OTHER_FILES) {
        assert_refused(&text, &message, &help);
    }
    for (text, message, help) in [
        (without("Entities"), "the file has no section $Entities", "whole mesh"),
        (without("Elements"), "the file has no section $Elements", "whole mesh"),
        (without("Nodes"), "$Elements comes before $Nodes", "export"),
        (cut("$EndNodes"), "the file ends within $Nodes", "copy"),
        (cut("$EndElements"), "the file ends within $Elements", "copy"),
    ] {
        assert_refused(&text, message, help);
    }
    for [from, to, message, help] in rows(OF_TRIANGLES) {
        assert_refused(&edit(TRIANGLES, &from, &to), &message, &help);
    }
    // The commands that help have to write a mesh: with `-save` Gmsh converts a mesh, but passes over `-2`.
    for other in ["1 0 8", "2.1 0 8", "4 1 8"] {
        let (_, advice) = words(&refused(&TRIANGLES.replace("4.1 0 8", other)));
        let (convert, export) = advice.split_once(", or ").unwrap();
        assert!(convert.ends_with("gmsh bad.msh -save -format msh41 -o new.msh"), "{advice}");
        assert!(export.contains("gmsh -2 part.geo -format msh41") && !export.contains("-save"), "{advice}");
    }
    let place = line(TRIANGLES, "1 11 10");
    let missing = refused(&TRIANGLES.replace("1 11 10\n", "1 11 99\n"));
    assert!(missing.to_string().starts_with(&format!("bad.msh:{place}:")));
}

/// Changes that make the meshes unsound: the replaced text, the new one, words of the message and of the help.
const UNSOUND_QUADS: &str = r"
11 1 2 7 6 | 11 1 2 6 7 | element 11 is inverted | mesh it again
¶10 10 0¶ | ¶10 0 0¶ | the elements 11, 12 are degenerate | slivers
";
const UNSOUND_TRIANGLES: &str = r"
¶0.25 0.5 0.25¶ | ¶0.9 0.5 0.25¶ | are inverted: their corners run the wrong way round | mesh it again
1 1 0.25¶ | 1 1 0.5¶ | the mesh is a surface that is not plane: node 34 |
    gmsh -3 and put its volumes into a physical group, too
";
const UNSOUND_HEXAHEDRA: &str = r"
13 1 2 5 4 10 11 14 13 | 13 1 2 4 5 10 11 13 14 | element 13 is inverted | mesh it again
13 1 2 5 4 10 11 14 13 | 13 1 2 5 4 1 2 5 4 | element 13 is degenerate: without volume at a corner | slivers
¶1 0 0¶ | ¶0.5 0 0¶ | degenerate | slivers
";

#[test]
fn meshes_that_are_not_sound_are_refused_with_their_elements() {
    let more = |quads: &str, nodes: &str, coordinates: &str, elements: &str| {
        let (n, e) = (15 + nodes.lines().count(), elements.lines().count());
        (quads.replace("1 15 1 15\n2 1 0 15\n", &format!("1 {n} 1 {n}\n2 1 0 {n}\n")))
            .replace("\n15\n", &format!("\n15\n{nodes}"))
            .replace("$EndNodes", &format!("{coordinates}$EndNodes"))
            .replace("4 18 1 18", &format!("4 {} 1 18", 18 + e))
            .replace("2 1 3 8\n", &format!("2 1 3 {}\n", 8 + e))
            .replace("$EndElements", &format!("{elements}$EndElements"))
    };
    for (base, table) in [(QUADS, UNSOUND_QUADS), (TRIANGLES, UNSOUND_TRIANGLES), (HEXAHEDRA, UNSOUND_HEXAHEDRA)] {
        for [from, to, message, help] in rows(table) {
            assert_refused(&edit(base, &from, &to), &message, &help);
        }
    }
    let pieces = more(QUADS, "16\n17\n18\n", "50 20 0\n50 30 0\n40 30 0\n", "19 15 16 17 18\n");
    let apart = "in 2 pieces that share no whole side, an element of each: 11, 19; two of them only touch at node 15";
    assert_refused(&pieces, apart, "whole edges");
    let hexahedra = HEXAHEDRA.replace("4 20 1 20", "4 21 1 21").replace("3 1 5 8\n", "3 1 5 9\n");
    let hexahedra = hexahedra.replace("$EndElements", "21 14 17 16 13 23 26 25 22\n$EndElements");
    for (text, pairs) in [
        (more(QUADS, "", "", "19 1 2 7 6\n"), "11 and 19"),
        (more(QUADS, "", "", "19 3 8 7 2\n20 4 5 10 9\n"), "12 and 19, 14 and 20"),
        (hexahedra, "19 and 21"),
    ] {
        assert_refused(&text, &format!("elements lie on one another, in pairs: {pairs}"), "twice");
    }
}

/// Cells that are numbered the wrong way round are turned over: all of them, those of one body, or a single one.
#[test]
fn cells_of_the_wrong_orientation_are_turned_over() {
    // The nodes of the sides opposite to each other change places.
    let turned = |which: &dyn Fn(usize) -> bool, line: &str| match line.split_whitespace().collect::<Vec<_>>()[..] {
        [e, a, b, c, d] if e.parse().is_ok_and(|e| e > 10 && which(e)) => [e, d, c, b, a].join(" "),
        [e, a, b, c, d, f, g, h, i] if e.parse().is_ok_and(|e| e > 12 && which(e)) => {
            [e, d, c, b, a, i, h, g, f].join(" ")
        }
        _ => line.to_string(),
    };
    let cases: [&dyn Fn(usize) -> bool; 4] = [&|_| true, &|e| e == 13, &|e| e % 2 == 0, &|e| e > 14];
    for which in cases {
        for (right, outwards) in [(QUADS, [0.0, 40.0, 0.0]), (HEXAHEDRA, [0.0, 0.0, 1.0])] {
            let text = right.lines().map(|line| turned(which, line)).collect::<Vec<_>>().join("\n");
            assert_ne!(text, right.trim_end());
            let mesh = from_gmsh("turned.msh", text.as_bytes(), 1.0).unwrap();
            mesh.check().unwrap();
            assert_eq!(area(&mesh, "top"), outwards);
        }
    }
}

/// Cells of every kind keep their sides, and the nodes at the middles of their edges, when they are turned over.
#[test]
fn every_kind_of_cell_is_turned_over() {
    let (plane, space) = (block(&[2.0, 1.0], &[2, 1]), block(&[2.0, 1.0, 1.0], &[2, 1, 1]));
    let (triangles, tetrahedra) = (plane.clone().into_simplices(), space.clone().into_simplices());
    let nine =
        MeshSource::segmented(&[vec![2.0], vec![1.0]], &[vec![2], vec![1]], None, Some(CellKind::Quadrilateral9));
    let nine = (*nine.unwrap().build().unwrap()).clone();
    let linear = [plane, space.clone(), triangles, tetrahedra, space.into_prisms()];
    let second = linear.clone().map(Mesh::into_second_order);
    for mesh in linear.into_iter().chain(second).chain([nine]) {
        // In a mirror all cells are numbered the wrong way round.
        let numbers = |n: usize| (1..=n).map(|k| format!("{k}\n")).collect::<Vec<_>>().concat();
        let nodes = mesh.nodes.iter().map(|[x, y, z]| format!("{} {y} {z}\n", -x)).collect::<Vec<_>>().concat();
        let kind = mesh.cells[0].kind;
        let element = |(e, cell): (usize, &Cell)| {
            let nodes = in_gmsh_order(kind, &cell.nodes).into_iter().map(|node| (node + 1).to_string());
            format!("{} {}\n", e + 1, nodes.collect::<Vec<_>>().join(" "))
        };
        let elements: String = mesh.cells.iter().enumerate().map(element).collect();
        let (n, e, d) = (mesh.nodes.len(), mesh.cells.len(), mesh.dimension);
        let text = format!(
            "$MeshFormat\n4.1 0 8\n$EndMeshFormat\n$Entities\n0 0 0 0\n$EndEntities\n$Nodes\n1 {n} 1 {n}\n{d} 1 0 {n}\n\
             {}{nodes}$EndNodes\n$Elements\n1 {e} 1 {e}\n{d} 1 {} {e}\n{elements}$EndElements\n",
            numbers(n),
            gmsh_type(kind),
        );
        let read = from_gmsh("mirrored.msh", text.as_bytes(), 1.0).unwrap();
        read.check().unwrap();
        assert_eq!((read.cells.len(), read.surface().len()), (e, mesh.surface().len()), "{kind:?}");
    }
}

/// Nodes that only points or lines have, such as the centres of arcs, are left out.
#[test]
fn nodes_of_no_element_are_left_out() {
    let text = QUADS
        .replace("1 15 1 15\n2 1 0 15\n", "2 17 1 99\n0 9 0 2\n98\n99\n7 7 3\n8 8 4\n2 1 0 15\n")
        .replace("4 18 1 18\n", "5 20 1 20\n0 9 15 2\n19 98\n20 99\n");
    let (mesh, whole) = (from_gmsh("arcs.msh", text.as_bytes(), 1.0).unwrap(), read("plate_quads_mm.msh", 1.0));
    assert_eq!((&mesh.nodes, &mesh.cells, &mesh.boundaries), (&whole.nodes, &whole.cells, &whole.boundaries));
    assert_eq!(mesh.notes.remarks, ["2 nodes are left out: no element of the body has them"]);
    assert_eq!(whole.notes, Notes::default());
    // The boundary of a copy is that of the body in the same place.
    let copied = (QUADS.replace("1 15 1 15\n2 1 0 15\n", "2 17 1 99\n0 9 0 2\n98\n99\n30 0 0\n40 1e-9 0\n2 1 0 15\n"))
        .replace("\n4 4 5\n", "\n4 99 98\n");
    let mesh = from_gmsh("copied.msh", copied.as_bytes(), 1.0).unwrap();
    assert_eq!((&mesh.nodes, &mesh.boundaries), (&whole.nodes, &whole.boundaries));
    // A line that belongs to no element is no boundary, which matters only to a scene that names it.
    let loose = text.replace("\n4 4 5\n", "\n4 98 99\n");
    let mesh = from_gmsh("loose.msh", loose.as_bytes(), 1.0).unwrap();
    assert_eq!(mesh.boundary_names(), ["left", "top"]);
    let (name, fault) = &mesh.notes.unusable[0];
    assert_eq!((name.as_str(), fault), ("bottom", &MeshFault::LooseFacet { boundary: "bottom".into(), element: 4 }));
}

/// Groups that are no boundary: what is replaced, by what, words of the message and of the help.
const NO_BOUNDARIES: &str = r"
¶4 4 5¶ | ¶4 4 3¶ | the elements 3 and 4 of the boundary `bottom` are the same facet | twice
¶2 2 3¶ | ¶2 2 7¶ | element 2 of the boundary `bottom` lies inside the body | BooleanFragments
¶2 2 3¶ | ¶2 2 4¶ | element 2 of the boundary `bottom` is no side | outline
";
const NO_BOUNDARY_OF_CUBES: &str = r"
8 23 24 27 26 | 8 22 23 20 19 | the elements 5 and 8 of the boundary `top` are the same facet | twice
";

/// A group that cannot be a boundary is an error of the scene that names it, and of no other.
#[test]
fn groups_that_are_no_boundary() {
    for (base, group, [from, to, message, help]) in rows(NO_BOUNDARIES)
        .into_iter()
        .map(|row| (QUADS, "bottom", row))
        .chain(rows(NO_BOUNDARY_OF_CUBES).into_iter().map(|row| (HEXAHEDRA, "top", row)))
    {
        let text = edit(base, &from, &to);
        let mesh = from_gmsh("inside.msh", text.as_bytes(), 1.0).unwrap();
        assert!(mesh.boundary(group).is_none() && mesh.boundary("left").is_some());
        let held = Description::new(mesh, Material::new(1.0, 0.3), vec![1.0]).support("left", &[Axis::X, Axis::Y]);
        assert!(Model::build(&held).is_ok(), "{message}");
        let ModelError::Description(fault) = Model::build(&held.support(group, &[Axis::Y])).unwrap_err() else {
            panic!("{message}")
        };
        assert_eq!(fault.key, "support[1].boundary");
        assert!(fault.message.contains(&message) && fault.help.contains(&help), "{fault:?}");
    }
}

/// A plane mesh may lie in any coordinate plane of its file.
#[test]
fn other_planes() {
    type Place = dyn Fn(&str, &str) -> String;
    let there = |line: &str, place: &Place| match line.split_whitespace().collect::<Vec<_>>()[..] {
        [x, y, "0"] if x.ends_with('0') && y.ends_with('0') => place(x, y),
        _ => line.to_string(),
    };
    let straight = read("plate_quads_mm.msh", 1.0);
    let places: [(&Place, &str); 2] = [
        (&|x, y| format!("{x} 0 {y}"), "the mesh lies in the x-z plane of its file: x is x here, z is y"),
        (&|x, y| format!("5 {x} {y}"), "the mesh lies in the y-z plane of its file: y is x here, z is y"),
    ];
    for (place, remark) in places {
        let text = QUADS.lines().map(|line| there(line, place)).collect::<Vec<_>>().join("\n");
        let mesh = from_gmsh("elsewhere.msh", text.as_bytes(), 1.0).unwrap();
        assert_eq!((&mesh.nodes, &mesh.cells), (&straight.nodes, &straight.cells));
        assert_eq!(mesh.notes.remarks, [remark]);
    }
}

/// Gmsh fills the names of groups that it reads from a MED file up with spaces.
#[test]
fn names_from_med() {
    let filled = QUADS.replace("\"top\"", &format!("\"{:80}\"", "top"));
    assert!(filled != QUADS);
    assert_eq!(from_gmsh("med.msh", filled.as_bytes(), 1.0).unwrap(), read("plate_quads_mm.msh", 1.0));
}

/// The older formats of Gmsh list an element of several groups once for each of them, and so do files converted from these.
#[test]
fn elements_of_several_groups() {
    let text = QUADS
        .replace("$PhysicalNames\n4\n", "$PhysicalNames\n6\n1 8 \"outline\"\n2 9 \"all\"\n")
        .replace("3 0 0 0 1 1 1 1 3 0", "3 0 0 0 1 1 1 2 3 -8 0")
        .replacen("1 0 0 0 1 1 1 1 1 0\n$EndEntities", "1 0 0 0 1 1 1 2 1 9 0\n$EndEntities", 1)
        .replace("4 18 1 18", "4 21 1 21")
        .replace("1 3 1 4\n", "1 3 1 6\n19 12 11\n20 14 15\n")
        .replace("2 1 3 8\n", "2 1 3 9\n21 7 6 1 2\n");
    let mesh = from_gmsh("twice.msh", text.as_bytes(), 1.0).unwrap();
    assert_eq!((mesh.cells.len(), &mesh.groups[..]), (8, &["all+steel".to_string()][..]));
    assert_eq!((area(&mesh, "top"), area(&mesh, "outline")), ([0.0, 40.0, 0.0], [0.0, 40.0, 0.0]));
    // A material may belong to either of the groups, but not to both.
    let group =
        |name: &str, young| MaterialGroup { name: name.into(), young, poisson: 0.3, ..MaterialGroup::default() };
    for name in ["steel", "all", "all+steel"] {
        let material = Material { groups: vec![group(name, 2.0)], ..Material::new(1.0, 0.3) };
        let laws = material.laws(&mesh).unwrap();
        let expected = Material::new(2.0, 0.3).laws(&mesh).unwrap();
        assert_eq!(laws, expected, "{name}");
    }
    let material = Material { groups: vec![group("all", 2.0), group("steel", 3.0)], ..Material::new(1.0, 0.3) };
    let fault = material.laws(&mesh).unwrap_err();
    assert_eq!((fault.key.as_str(), fault.message.contains("`all` and `steel`")), ("material.group[1].name", true));
}

/// A name that ends nowhere is none.
#[test]
fn names_stand_in_quotes() {
    for name in ["\"top", "top\"", "top", "\""] {
        says(&refused(&QUADS.replace("\"top\"", name)), "a name in quotes", "");
    }
}

/// Groups without names are called by their numbers.
#[test]
fn groups_without_names() {
    let end = "$EndPhysicalNames\n";
    let rest = &QUADS[QUADS.find(end).unwrap() + end.len()..];
    let mesh = from_gmsh("numbers.msh", format!("$MeshFormat\n4.1 0 8\n$EndMeshFormat\n{rest}").as_bytes(), 1.0);
    assert_eq!(mesh.unwrap().boundary_names(), ["1", "2", "3"]);
}

/// Cubes that meet in a corner or along an edge would turn about it.
#[test]
fn joints_are_refused() {
    let cubes = |second: &str, count: usize, more: &str| {
        let nodes = (1..=count).map(|k| k.to_string()).collect::<Vec<_>>().join("\n");
        format!(
            "$MeshFormat\n4.1 0 8\n$EndMeshFormat\n$Entities\n0 0 0 1\n1 0 0 0 1 1 1 0 0\n$EndEntities\n\
             $Nodes\n1 {count} 1 {count}\n3 1 0 {count}\n{nodes}\n\
             0 0 0\n1 0 0\n1 1 0\n0 1 0\n0 0 1\n1 0 1\n1 1 1\n0 1 1\n{more}$EndNodes\n\
             $Elements\n1 2 10 11\n3 1 5 2\n10 1 2 3 4 5 6 7 8\n11 {second}\n$EndElements\n"
        )
    };
    let touching = "an element of each: 10, 11; two of them only touch at node";
    let corner = "2 1 1\n2 2 1\n1 2 1\n1 1 2\n2 1 2\n2 2 2\n1 2 2\n";
    says(&refused(&cubes("7 9 10 11 12 13 14 15", 15, corner)), &format!("{touching} 7"), "faces");
    let hinge = "2 0 1\n2 1 1\n1 0 2\n2 0 2\n2 1 2\n1 1 2\n";
    says(&refused(&cubes("6 9 10 7 11 12 13 14", 14, hinge)), &format!("{touching} 6"), "");
    let joined = "2 0 0\n2 1 0\n2 1 1\n2 0 1\n";
    assert!(from_gmsh("joined.msh", cubes("2 9 10 3 6 12 11 7", 12, joined).as_bytes(), 1.0).is_ok());
}

/// The least number there is has no positive counterpart.
#[test]
fn a_group_with_the_least_number() {
    let text = HEXAHEDRA.replace("2 0 0 0 1 1 1 1 2 0\n", &format!("2 0 0 0 1 1 1 1 {} 0\n", i64::MIN));
    assert_ne!(text, HEXAHEDRA);
    let mesh = from_gmsh("least.msh", text.as_bytes(), 1.0).unwrap();
    assert_eq!(mesh.boundary(&i64::MIN.to_string()).unwrap().facets.len(), 4);
}

/// Cells that share no node are bodies of their own, and a stack of nodes in one place is told by its neighbours, not by all of its pairs.
#[test]
fn a_stack_of_nodes() {
    let n = 2000;
    let lines = |line: &dyn Fn(usize) -> String, k: usize| (0..k).map(line).collect::<Vec<_>>().concat();
    let numbers = |k: usize| lines(&|i| format!("{}\n", i + 1), k);
    let elements = lines(&|i| format!("{} {} {} {}\n", i + 1, 3 * i + 1, 3 * i + 2, 3 * i + 3), n);
    let text = format!(
        "$MeshFormat\n4.1 0 8\n$EndMeshFormat\n$Entities\n0 0 1 0\n1 0 0 0 1 1 1 0 0\n$EndEntities\n\
         $Nodes\n1 {k} 1 {k}\n2 1 0 {k}\n{}{}$EndNodes\n$Elements\n1 {n} 1 {n}\n2 1 2 {n}\n{elements}$EndElements\n",
        numbers(3 * n),
        "0 0 0\n1 0 0\n0 1 0\n".repeat(n),
        k = 3 * n,
    );
    let mesh = from_gmsh("stack.msh", text.as_bytes(), 1.0).unwrap();
    let bodies = mesh.bodies();
    assert_eq!((bodies.count(), bodies.label(1)), (n, "`body 2`".to_string()));
    let touching = mesh.touching_nodes(&bodies);
    assert!(touching.len() == 3 * (n - 1) && touching.contains(&(0, 3)), "{touching:?}");
}

/// What is in two physical groups of one name belongs to it once.
#[test]
fn two_groups_of_one_name_are_one() {
    let text = HEXAHEDRA.replace("$PhysicalNames\n4\n", "$PhysicalNames\n5\n2 9 \"top\"\n");
    let twice = |line: &str| match line {
        "2 0 0 0 1 1 1 1 2 0" => "2 0 0 0 1 1 1 2 2 9 0".to_string(),
        _ => line.to_string(),
    };
    let text = text.lines().map(twice).collect::<Vec<_>>().join("\n");
    let mesh = from_gmsh("twice.msh", text.as_bytes(), 1.0).unwrap();
    assert_eq!((mesh.boundary("top").unwrap().facets.len(), area(&mesh, "top")), (4, [0.0, 0.0, 1.0]));
}
