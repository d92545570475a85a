//! One mesh in every format of Gmsh: text and binary, old and new, whole, damaged and partitioned.

use crate::common::mesh_files::{Msh, msh};
use crate::common::prelude::*;

/// Returns a mesh of each kind of cells, with boundaries.
pub(super) fn of_all_kinds() -> Vec<Mesh> {
    let (plane, space) = (block(&[2.0, 1.0], &[3, 2]), block(&[2.0, 1.0, 1.5], &[2, 2, 1]));
    let (triangles, tetrahedra) = (plane.clone().into_simplices(), space.clone().into_simplices());
    let all = [plane, space.clone(), triangles, tetrahedra, space.into_prisms()];
    let second = all.clone().map(Mesh::into_second_order);
    let nine =
        MeshSource::segmented(&[vec![2.0], vec![1.0]], &[vec![3], vec![2]], None, Some(CellKind::Quadrilateral9));
    let nine = (*nine.unwrap().build().unwrap()).clone();
    all.into_iter().chain(second).chain([nine]).map(skewed).collect()
}

/// Moves the nodes so that no coordinate is round, and an element of wrong node order has another volume.
fn skewed(mut mesh: Mesh) -> Mesh {
    for x in &mut mesh.nodes {
        let [a, b, c] = *x;
        *x = [a + 0.1 * b + 0.03 * c, b - 0.07 * a, if mesh.dimension == 2 { 0.0 } else { c + 0.05 * a / 3.0 }];
    }
    mesh
}

/// The mesh with faces that begin with their least node.
pub(super) fn from_least(mut mesh: Mesh) -> Mesh {
    let faces = mesh.boundaries.iter_mut().flat_map(|boundary| &mut boundary.facets).filter(|_| mesh.dimension == 3);
    for face in faces {
        let least = (0..face.len()).min_by_key(|&k| face[k]).unwrap();
        face.rotate_left(least);
    }
    mesh
}

/// Meshes as Gmsh wrote them: groups of both dimensions, two bodies.
fn of_gmsh() -> Vec<Mesh> {
    let files = ["meshes/square_triangles.msh", "meshes/cube_tetrahedra.msh", "tutorials/lap-joint-coarse.msh"];
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("data");
    files.map(|file| MeshFormat::Gmsh.read(&folder.join(file), 1.0).unwrap()).to_vec()
}

/// Every version has the mesh to the last bit.
#[test]
fn all_versions_of_gmsh_are_one_mesh() {
    for mesh in of_all_kinds().into_iter().chain(of_gmsh()) {
        for version in Msh::ALL {
            let read = from_gmsh("written.msh", &msh(&mesh, version), 1.0).unwrap();
            assert_eq!(from_least(read), from_least(mesh.clone()), "{version:?}");
        }
    }
}

/// Stiffness and all else of a problem are those of the mesh in memory, to the last bit.
#[test]
fn the_problem_does_not_depend_on_the_version() {
    for mesh in of_all_kinds() {
        let of = |mesh: Mesh| {
            let bottom = mesh.boundaries[0].name.clone();
            let axes = &[Axis::X, Axis::Y, Axis::Z][..mesh.dimension];
            let held = Description::new(mesh, Material::new(7.0, 0.3), vec![1.0]).support(&bottom, axes);
            format!("{:?}", Model::build(&held).unwrap().problem)
        };
        let expected = of(mesh.clone());
        for version in Msh::ALL {
            assert_eq!(of(from_gmsh("written.msh", &msh(&mesh, version), 1.0).unwrap()), expected, "{version:?}");
        }
    }
}

/// A file that is cut off anywhere, or with another byte anywhere, is read or refused with a place and a cure.
#[test]
fn damaged_files_are_refused() {
    let mesh = skewed(block(&[2.0, 1.0], &[2, 1]).into_simplices());
    for version in Msh::ALL {
        let whole = msh(&mesh, version);
        let end = whole.len() - "$EndElements\n".len();
        for cut in 0..end {
            let error = from_gmsh("cut.msh", &whole[..cut], 1.0).unwrap_err();
            assert!(error.to_string().starts_with("cut.msh:") && error.help().is_some(), "{cut}: {error}");
        }
        for k in 0..whole.len() {
            for byte in [0, b'9', 0x7f, 0xff, whole[k] ^ 1] {
                let mut bytes = whole.clone();
                bytes[k] = byte;
                if let Err(error) = from_gmsh("changed.msh", &bytes, 1.0) {
                    assert!(!error.to_string().is_empty() && error.help().is_some(), "{k}: {error}");
                }
            }
        }
    }
}

fn refused(bytes: &[u8]) -> (String, String) {
    let error = from_gmsh("bad.msh", bytes, 1.0).unwrap_err();
    (error.to_string(), error.help().unwrap().to_string())
}

#[test]
fn what_is_wrong_in_a_binary_file_is_named_with_its_byte() {
    let mesh = block(&[1.0, 1.0], &[1, 1]);
    let replaced = |version: Msh, from: &[u8], to: &[u8]| {
        let bytes = msh(&mesh, version);
        let at = bytes.windows(from.len()).position(|part| part == from).unwrap();
        [&bytes[..at], to, &bytes[at + from.len()..]].concat()
    };
    for version in [Msh::Binary22, Msh::Binary41] {
        let (said, help) = refused(&replaced(version, b"\x01\0\0\0\n", b"\0\0\0\x01\n"));
        assert!(said.contains("bad.msh:2: the file is binary and big-endian"), "{said}");
        assert!(help.contains("-save -format msh41"), "{help}");
    }
    // More nodes than the file has bytes for take no memory.
    let many = [&b"$Nodes\n"[..], &1_u64.to_le_bytes(), &(1_u64 << 60).to_le_bytes(), &1_u64.to_le_bytes()].concat();
    let four = [&b"$Nodes\n"[..], &1_u64.to_le_bytes(), &4_u64.to_le_bytes(), &1_u64.to_le_bytes()].concat();
    let (said, _) = refused(&replaced(Msh::Binary41, &four, &many));
    assert!(said.contains("$Nodes announces 1152921504606846976 nodes, but has 4"), "{said}");
    let (said, help) = refused(&replaced(Msh::Binary22, b"$Nodes\n4\n", b"$Nodes\n4000000000000\n"));
    assert!(said.starts_with("bad.msh:byte "), "{said}");
    assert!(help.contains("export"), "{help}");
    let (said, _) = refused(&replaced(Msh::Binary22, b"$Elements\n5\n", b"$Elements\n6\n"));
    assert!(said.starts_with("bad.msh:byte "), "{said}");
}

/// MSH 2.2 lists an element of several groups once for each, and has partitions among the tags.
#[test]
fn tags_of_msh_2() {
    let text = "$MeshFormat\n2.2 0 8\n$EndMeshFormat\n$PhysicalNames\n3\n1 1 \"foot\"\n2 2 \"steel\"\n2 3 \"all\"\n$EndPhysicalNames\n\
        $Nodes\n4\n1 0 0 0\n2 1 0 0\n3 1 1 0\n4 0 1 0\n$EndNodes\n\
        $Elements\n5\n1 1 2 -1 1 1 2\n2 2 4 2 1 1 1 1 2 3\n3 2 5 2 1 2 1 -2 1 3 4\n4 2 2 3 1 1 2 3\n5 1 2 9 5 3 4\n$EndElements\n";
    let mesh = from_gmsh("tags.msh", text.as_bytes(), 1.0).unwrap();
    assert_eq!((mesh.cells.len(), mesh.boundary_names()), (2, vec!["foot", "9"]));
    assert_eq!(mesh.groups, ["all+steel", "steel"]);
    // An element that is there twice in one group lies on itself.
    let twice = text.replace("4 2 2 3 1 1 2 3", "4 2 2 2 1 1 2 3");
    assert!(refused(twice.as_bytes()).0.contains("elements lie on one another"));
    // Elements of no group, and nodes with parameters.
    let loose = text.replace("2 2 4 2 1 1 1", "2 2 4 0 1 1 1").replace("4 2 2 3 1 1 2 3", "4 15 2 0 1 2");
    let parametric = loose.replace("Nodes\n", "ParametricNodes\n").replace("2 1 0 0\n", "2 1 0 0 1 4 0.5\n");
    for text in [loose, parametric] {
        let mesh = from_gmsh("loose.msh", text.as_bytes(), 1.0).unwrap();
        assert_eq!((&mesh.groups[..], mesh.nodes[1]), (&[String::new(), "steel".into()][..], [1.0, 0.0, 0.0]));
    }
}

/// The entities of partitions have groups of their own in MSH 4.1.
#[test]
fn partitions() {
    let text = include_str!("../../../data/meshes/plate_quads_mm.msh");
    let whole = from_gmsh("whole.msh", text.as_bytes(), 1.0).unwrap();
    let entities =
        "$PartitionedEntities\n2\n1\n9 2\n0 0 0 1\n7 2 1 1 2 0 0 0 1 1 1 1 1 0\n$EndPartitionedEntities\n$Nodes";
    let cells = text.lines().find(|line| line.starts_with("2 1 3 ")).unwrap();
    let moved = text.replace(cells, &cells.replacen("2 1 3", "2 7 3", 1)).replace("$Nodes", entities);
    let partitioned = from_gmsh("parts.msh", moved.as_bytes(), 1.0).unwrap();
    assert_eq!((&partitioned.cells, &partitioned.boundaries), (&whole.cells, &whole.boundaries));
}

/// Returns the file of data/meshes/formats, which Gmsh 4.15.2 wrote.
fn written(name: &str) -> Mesh {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("data/meshes/formats");
    MeshFormat::Gmsh.read(&folder.join(format!("{name}.msh")), 1.0).unwrap()
}

/// The sum of the areas of the plane cells of a group, with straight lines between all nodes.
fn area(mesh: &Mesh, group: &str) -> f64 {
    let of_cell = |cell: &Cell| {
        let around = mesh.points(&cell.around());
        let pairs = around.iter().zip(around.iter().cycle().skip(1));
        pairs.map(|(a, b)| 0.5 * (a[0] * b[1] - a[1] * b[0])).sum::<f64>()
    };
    mesh.cells.iter().filter(|cell| mesh.groups[cell.group] == group).map(of_cell).sum()
}

/// Files of Gmsh in all versions: curved elements of second order, groups with and without names, elements of several
/// groups, nodes with parameters.
#[test]
fn files_of_gmsh_in_all_versions() {
    for name in ["plates", "rod"] {
        let expected = written(&format!("{name}_41_text"));
        for version in ["22_text", "22_binary", "40_text", "41_binary"] {
            let mesh = written(&format!("{name}_{version}"));
            assert_eq!(mesh.groups, expected.groups, "{version}");
            assert_eq!(mesh.boundary_names(), expected.boundary_names(), "{version}");
            assert_eq!(mesh.cells, expected.cells, "{version}");
            assert_eq!(mesh.boundaries, expected.boundaries, "{version}");
            // Gmsh writes sixteen digits into a text, which is not always all of a number.
            for (x, y) in mesh.nodes.iter().flatten().zip(expected.nodes.iter().flatten()) {
                assert!((x - y).abs() < 1e-14, "{version}: {x}, {y}");
            }
        }
    }
    let plates = written("plates_41_text");
    assert_eq!(plates.groups, ["all+disk", "all+block"]);
    assert_eq!(plates.boundary_names(), ["rim", "wall", "3"]);
    assert!((area(&plates, "all+block") - 2.0).abs() < 1e-14);
    // A polygon of sixteen corners is close to the ellipse.
    let disk = area(&plates, "all+disk");
    assert!((disk / (2.0 * std::f64::consts::PI) - 1.0).abs() < 0.03, "{disk}");
}

/// Partitions do not change the mesh.
#[test]
fn files_of_gmsh_with_partitions() {
    for version in ["22_text", "22_binary", "41_text", "41_binary"] {
        let mesh = written(&format!("halves_{version}"));
        assert_eq!(
            (&mesh.groups[..], mesh.boundary_names()),
            (&["rod".to_string()][..], vec!["side", "top", "bottom"])
        );
        let rod = written("rod_41_text");
        assert_eq!((mesh.cells.len(), mesh.surface().len()), (rod.cells.len(), rod.surface().len()), "{version}");
        mesh.check().unwrap();
    }
}
