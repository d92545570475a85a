//! Universal files (UNV): their nodes, elements and groups, and what is refused.

use crate::common::prelude::*;
use std::fmt::Write as _;

use crate::common::mesh_files::unv;
use crate::files::mesh_formats::{from_least, of_all_kinds};

fn read(text: &str) -> Mesh {
    MeshFormat::Unv.parse("part.unv", text.as_bytes(), 1.0).unwrap()
}

fn refused(text: &str) -> MeshFileError {
    MeshFormat::Unv.parse("bad.unv", text.as_bytes(), 1.0).unwrap_err()
}

/// Every kind of elements has its nodes in the right order, and every boundary its sides.
#[test]
fn all_kinds_of_elements() {
    // A universal file has no quadrilaterals of nine nodes.
    let kinds = of_all_kinds().into_iter().filter(|mesh| mesh.cells[0].kind != CellKind::Quadrilateral9);
    for mesh in kinds {
        assert_eq!(from_least(read(&unv(&mesh))), from_least(mesh));
    }
}

/// Files of Gmsh 4.15.2, `gmsh plates_41_text.msh -save -o plates.unv` with `Mesh.SaveGroupsOfElements = 1`: curved
/// elements of second order, elements of several groups, a group without a name.
#[test]
fn files_of_gmsh() {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("data/meshes/formats");
    for name in ["plates", "rod"] {
        let mesh = MeshFormat::Unv.read(&folder.join(format!("{name}.unv")), 1.0).unwrap();
        let expected = MeshFormat::Gmsh.read(&folder.join(format!("{name}_41_text.msh")), 1.0).unwrap();
        let named = |name: &str| if name == "3" { "PhysicalLine3".to_string() } else { name.to_string() };
        assert_eq!(mesh.groups, expected.groups);
        assert_eq!(mesh.cells, expected.cells);
        assert_eq!(mesh.nodes.len(), expected.nodes.len());
        for (x, y) in mesh.nodes.iter().flatten().zip(expected.nodes.iter().flatten()) {
            assert!((x - y).abs() < 1e-14, "{x}, {y}");
        }
        let boundaries = expected.boundaries.into_iter().map(|boundary| (named(&boundary.name), boundary.facets));
        let read = mesh.boundaries.into_iter().map(|boundary| (boundary.name, boundary.facets));
        assert_eq!(read.collect::<Vec<_>>(), boundaries.collect::<Vec<_>>(), "{name}");
    }
}

/// Two quadrilaterals above each other, 1 by 1 each, in columns as Salome writes them, and a group of each form.
const TOWER: &str = include_str!("data/tower.unv");

#[test]
fn groups_are_materials_and_boundaries() {
    let mesh = read(TOWER);
    assert_eq!((mesh.dimension, mesh.nodes.len(), mesh.cells.len()), (2, 6, 2));
    assert_eq!(mesh.nodes[5], [1.0, 2.0, 0.0]);
    assert_eq!(mesh.groups, ["whole body", "2+whole body"]);
    assert_eq!(mesh.boundary_names(), ["foot", "roof", "side"]);
    let facets = |name: &str| &mesh.boundary(name).unwrap().facets;
    assert_eq!((facets("foot"), facets("roof")), (&vec![vec![0, 1]], &vec![vec![5, 4]]));
    assert_eq!(facets("side"), &[[4, 2], [2, 0]]);
    assert_eq!(
        mesh.notes.remarks,
        [
            "the units of the file, `SI: Meter (newton)`, are left aside: mesh.scale or [units] gives its unit of length",
            "left aside, as no part of the mesh: the datasets 2414, 58b",
            "the node set tip has no whole side, so that it is no boundary; its nodes: (1, 2)",
            "1 node is left out: no element of the body has it",
        ]
    );
    // Windows ends lines otherwise; the newer form of groups has the same columns.
    let other = TOWER.replace("  2467\n", "  2477\n").replace('\n', "\r\n");
    assert_eq!(read(&other), mesh);
}

/// A plane mesh may lie in any coordinate plane of its file.
#[test]
fn other_planes() {
    let mesh = block(&[2.0, 1.0], &[3, 2]).into_simplices();
    for (axes, remark) in [
        ([0, 2], "the mesh lies in the x-z plane of its file: x is x here, z is y"),
        ([1, 2], "the mesh lies in the y-z plane of its file: y is x here, z is y"),
    ] {
        let mut placed = mesh.clone();
        for x in &mut placed.nodes {
            let mut place = [5.0; 3];
            place[axes[0]] = x[0];
            place[axes[1]] = x[1];
            *x = place;
        }
        let mut read = read(&unv(&placed));
        assert_eq!(std::mem::take(&mut read.notes.remarks), [remark]);
        assert_eq!(read, mesh);
    }
}

/// Faults of the tower: what is replaced, by what, words of the message and of the help.
const FAULTS: &str = include_str!("../refused/tables/unv.txt");

#[test]
fn what_is_no_mesh_is_refused_with_its_line() {
    for [from, to, message, help] in rows(FAULTS) {
        let error = refused(&edit(TOWER, &from, &to));
        assert!(error.to_string().starts_with("bad.unv:"), "{error}");
        says(&error, &message, &help);
    }
}

#[test]
fn what_is_no_universal_file_is_refused() {
    says(&refused("$MeshFormat\n4.1 0 8\n"), "it is a mesh of Gmsh", "kind = \"gmsh\"");
    says(&refused("\u{89}HDF\r\n\u{1a}\n"), "begins with -1", "");
    for text in ["", "    -1\n  2411\n    -1\n"] {
        says(&refused(text), "no elements of two or three dimensions", "2412");
    }
    let long = refused(&TOWER.replace("whole body", &"long".repeat(51)));
    says(&long, "bad.unv:51: the name of the group 1 has more than 200 letters", "shorter");
}

/// A file that is cut off anywhere, or with another byte anywhere, is read or refused with a place and a cure.
#[test]
fn damaged_files() {
    let solid = unv(&block(&[2.0, 1.0, 1.0], &[1, 1, 1]).into_simplices().into_second_order());
    for whole in [TOWER.as_bytes(), solid.as_bytes()] {
        let refuse = |bytes: &[u8]| {
            let error = MeshFormat::Unv.parse("bad.unv", bytes, 1.0).err()?;
            assert!(error.to_string().starts_with("bad.unv:") && error.help().is_some(), "{error}");
            Some(error)
        };
        let elements = whole.windows(6).position(|part| part == b"  2412").unwrap();
        let end = elements + whole[elements..].windows(6).position(|part| part == b"    -1").unwrap();
        for cut in 0..whole.len() {
            assert!(refuse(&whole[..cut]).is_some() || cut >= end, "{cut}");
        }
        for k in 0..whole.len() {
            for byte in [0, b'9', b'-', b'\n', 0xff, whole[k] ^ 1] {
                let mut bytes = whole.to_vec();
                bytes[k] = byte;
                refuse(&bytes);
            }
        }
    }
}

/// Numbers of nodes and members that the file does not have take no memory, and neither do node sets that repeat one
/// another.
#[test]
fn memory_is_bounded_by_the_file() {
    let many = TOWER.replace("         0         2\nwhole", "         0 999999999999999999\nwhole");
    assert!(many != TOWER);
    says(&refused(&many), "expected in this line", "");
    let many = TOWER.replace("11         2         1         7         2", "11 2 1 7 999999999999999999");
    assert!(many != TOWER);
    says(&refused(&many), "has 999999999999999999 nodes", "");
    let mut text = unv(&block(&[1.0, 1.0], &[100, 1]));
    for k in 0..3000 {
        write!(text, "    -1\n  2467\n{k} 0 0 0 0 0 0 202\nset{k}\n").unwrap();
        let members: Vec<String> = (1..=202).map(|node| format!("7 {node} 0 0")).collect();
        write!(text, "{}\n    -1\n", members.join(" ")).unwrap();
    }
    says(&refused(&text), "the groups of nodes repeat one another", "fewer");
}
