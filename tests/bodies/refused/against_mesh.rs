//! Keys of a scene that its mesh contradicts.

use crate::common::faults::line_at;
use crate::common::prelude::*;

const AGAINST_THE_MESH: &str = include_str!("tables/against_mesh_in_plane.txt");

const BOTTOM: &str = "boundary = \"bottom\"\nfriction = 0.4\nobstacle = { kind = \"plane\", gap = 1e-5 }";
const FREE: &str = "boundary = \"left\"\nfix = [\"x\", \"y\", \"z\"]";

/// Keys that the mesh of the cube contradicts, and keys of the plane.
const IN_SPACE: &str = include_str!("tables/against_mesh_in_space.txt");

/// Two contacts at the edge of the cube, which nothing holds: at its nodes the two obstacles have normals that contradict each
/// other.
#[test]
fn nodes_in_front_of_two_obstacles() {
    let cube = small_cube().replace(FREE, &FREE.replace("left", "right"));
    let two = |first: &str, second: &str| {
        let bottom = BOTTOM.replace("gap = 1e-5", first);
        let left = BOTTOM.replace("bottom", "left").replace("gap = 1e-5", second);
        edit(&cube, BOTTOM, &format!("{bottom}\n[[contact]]\n{left}"))
    };
    // A wall at right angles to the foundation contradicts nothing.
    assert!(discretise(&parsed(&two("gap = 0", "gap = 0"))).is_ok());
    // In front of the same normal they are one.
    assert!(discretise(&parsed(&two("normal = [-1, 0, -1]", "normal = [-1, 0, -1]"))).is_ok());
    let text = two("normal = [1, 0, -1]", "normal = [-1, 0, 1]");
    let place = text.rfind("normal = [-1, 0, 1]").unwrap();
    let says = "the node at (0, 0, 0) m of `left` lies in front of two obstacles & opposite normals";
    verify(&refused(&text), &text, line_at(&text, place), says, "let");
}

/// A boundary that a Gmsh file does not have.
#[test]
fn a_boundary_not_found_in_a_file() {
    let mesh = "kind = \"block\"\nsize = [1.0, 1.0, 1.0]          # m\nelements = [2, 2, 2]";
    let file = "kind = \"gmsh\"\nfile = \"data/meshes/cube_hexahedra.msh\"";
    let text = edit(&edit(&small_cube(), mesh, file), "\"right\"", "\"rihgt\"");
    verify(&refused(&text), &text, line_of(&text, "rihgt"), "the mesh has no boundary `rihgt`", "bottom, top");
}

fn small_cube() -> String {
    edit(CUBE, "[10, 10, 10]", "[2, 2, 2]")
}

#[test]
fn what_contradicts_the_mesh() {
    for (base, faults) in [(edit(BLOCK, "[100, 100]", "[1, 1]"), AGAINST_THE_MESH), (small_cube(), IN_SPACE)] {
        assert!(discretise(&parsed(&base)).is_ok());
        verify_all(&base, faults, refused);
    }
}
