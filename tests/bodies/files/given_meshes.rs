//! Meshes from arrays: the block by its arrays is the block, and what is no mesh is refused.

use crate::common::prelude::*;
use crate::refused::descriptions::{paper_block, refused};

/// A block by its arrays, with the facets of its boundaries turned and in disorder, is the block.
#[test]
fn a_mesh_from_arrays() {
    let made = block(&[1.0, 1.0], &[4, 4]);
    let mut boundaries = made.boundaries.clone();
    for facets in boundaries.iter_mut().map(|boundary| &mut boundary.facets) {
        facets.iter_mut().step_by(2).for_each(|facet| facet.reverse());
        facets.rotate_left(2);
    }
    let given = Mesh::new(made.nodes.clone(), made.cells.clone(), Vec::new(), boundaries).unwrap();
    assert_eq!(given, made);
    let of_arrays = Model::build(&Description { mesh: given.into(), ..paper_block() }).unwrap();
    let model = Model::build(&paper_block()).unwrap();
    assert_eq!(format!("{:?}", of_arrays.problem), format!("{:?}", model.problem));
    // A face may begin with another corner, but has the same outside.
    let cube = block(&[1.0; 3], &[2; 3]).into_simplices();
    let given = Mesh::new(cube.nodes.clone(), cube.cells.clone(), Vec::new(), cube.boundaries.clone()).unwrap();
    assert_eq!((&given.nodes, &given.cells, given.check()), (&cube.nodes, &cube.cells, Ok(())));
    for (boundary, of_cube) in given.boundaries.iter().zip(&cube.boundaries) {
        let areas = |mesh: &Mesh, boundary: &Boundary| -> Vec<_> {
            boundary.facets.iter().map(|facet| mesh.area_vector(facet)).collect()
        };
        assert_eq!(areas(&given, boundary), areas(&cube, of_cube), "{}", boundary.name);
    }
}

#[test]
fn meshes_that_are_none() {
    let mesh = block(&[1.0, 1.0], &[2, 2]);
    let new = |mesh: Mesh| Mesh::new(mesh.nodes, mesh.cells, mesh.groups, mesh.boundaries).unwrap_err();
    let with = |change: &dyn Fn(&mut Mesh)| {
        let mut mesh = mesh.clone();
        change(&mut mesh);
        mesh
    };
    let facet = |nodes: &[usize]| Boundary { name: "odd".into(), facets: vec![nodes.to_vec()] };
    let brick = Cell { kind: CellKind::Hexahedron, nodes: (0..8).collect(), group: 0 };
    let faults: [(Mesh, MeshFault); 13] = [
        (with(&|m| m.cells.clear()), MeshFault::Empty),
        (with(&|m| m.nodes[3][1] = f64::NAN), MeshFault::NotFinite(vec![3])),
        (with(&|m| m.nodes[2][2] = 0.1), MeshFault::OutOfPlane(vec![2])),
        (with(&|m| m.cells[1] = brick.clone()), MeshFault::Dimensions { element: 1, cell: 3, mesh: 2 }),
        (with(&|m| m.cells[1].nodes.truncate(3)), MeshFault::Corners { element: 1, given: 3, needed: 4 }),
        (with(&|m| m.cells[3].nodes[2] = 9), MeshFault::NoNode { element: 3, node: 9, nodes: 9 }),
        (with(&|m| m.cells[2].group = 1), MeshFault::NoGroup { element: 2, group: 1, groups: 1 }),
        (with(&|m| m.cells[0].nodes.reverse()), MeshFault::Inverted(vec![0])),
        (with(&|m| m.nodes.push([5.0, 5.0, 0.0])), MeshFault::UnusedNodes(vec![9])),
        (with(&|m| m.boundaries.push(facet(&[1, 4]))), MeshFault::InnerFacet { boundary: "odd".into(), element: 0 }),
        (with(&|m| m.boundaries.push(facet(&[0, 77]))), MeshFault::LooseFacet { boundary: "odd".into(), element: 0 }),
        (
            with(&|m| m.boundaries[0].facets.push(vec![0, 1])),
            MeshFault::RepeatedFacet { boundary: "bottom".into(), elements: (0, 2) },
        ),
        (with(&|m| m.boundaries[1].name = "top".into()), MeshFault::RepeatedName("top".into())),
    ];
    for (mesh, fault) in faults {
        assert!(!fault.help().is_empty());
        assert_eq!(new(mesh.clone()), fault);
        // The same of a mesh that was put together without `Mesh::new`.
        let says = fault.to_string();
        refused(&Description { mesh: mesh.into(), ..paper_block() }, "mesh", &says);
    }
    let turned = with(&|m| m.boundaries[0].facets[1].reverse());
    refused(&Description { mesh: turned.into(), ..paper_block() }, "mesh", "the wrong way round");
}

/// Gmsh leaves out what is in no physical group, if there are any.
#[test]
fn a_mesh_without_boundaries() {
    let mut mesh = block(&[1.0, 1.0], &[4, 4]);
    mesh.boundaries.clear();
    let error = Model::build(&Description { mesh: mesh.into(), ..paper_block() }).unwrap_err();
    assert!(error.to_string().contains("the mesh has no boundary `left`"), "{error}");
    let help = error.help().unwrap().to_string();
    assert!(help.contains("has no boundaries: put its outer curves into physical groups"), "{help}");
    assert!(help.contains("*NSET with all their nodes (Abaqus)"), "{help}");
}
