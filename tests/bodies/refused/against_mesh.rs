//! What a scene says that its mesh contradicts.

use crate::common::faults::line_at;
use crate::common::prelude::*;

const AGAINST_THE_MESH: &str = r#"
poisson = | layers = [[0.1, 1e9, 0.3]]¶poisson = | layers = | in material.layers[0] | more elements
poisson = | layers = [[1.0, 1e9, 0.3],¶[10.0, 1e9, 0.2]]¶poisson = | [10.0, 1e9 | no element & in material.layers[1] |
    thicknesses are in m
"left" | "lft" | "lft" | no boundary `lft` | bottom, right, top, left
"bottom" | "Bottom" | "Bottom" | no boundary `Bottom` | bottom, right, top, left
"top" | "roof" | "roof" | no boundary `roof` | bottom, right, top, left
gap = 1e-5 | gap = -1e-6 | "bottom" | hold the body where the obstacle is & (0, 0) m | gap of at least 0
[[support]] | [[support]]¶boundary = "right"¶fix = ["x", "y"]¶[[support]] | "right"¶fix | fix every node |
    fewer boundaries
["x", "y"] | ["z"] | fix = | the support of `left` holds z & two dimensions | leave out "z"
"y"] | "y", "z"] | fix = | the support of `left` holds z & two dimensions | leave out "z"
[0.0, -10e6] | [0.0, -10e6, 0.0] | traction = [0.0 | the traction on `top` has 3 components & 2 dimensions | [x, y]
[1.0, 1.0]               # m¶elements = [1, 1] | [1.0, 1.0, 1.0]¶elements = [1, 1, 1] | plane = "strain" |
    plane state & three dimensions | remove material.plane
elements = | cells = "triangle6"¶element = "b-bar"¶elements = | element = "b-bar" |
    mesh.element is "b-bar" & triangles | triangles of six
elements = | cells = "triangle"¶element = "b-bar"¶elements = | element = "b-bar" | mesh.element is "b-bar" & triangles |
    "nodal-volume"
elements = | element = "nodal-volume"¶elements = | element = "nodal-volume" |
    mesh.element is "nodal-volume" & a quadrilateral | use "b-bar"
poisson = 0.3¶ | poisson = 0.3¶group = [{ name = "core", young = 1e9, poisson = 0.3 }]¶ | group = |
    no material group `core` | the groups body
"#;

const BOTTOM: &str = "boundary = \"bottom\"\nfriction = 0.4\nobstacle = { kind = \"plane\", gap = 1e-5 }";
const FREE: &str = "boundary = \"left\"\nfix = [\"x\", \"y\", \"z\"]";

/// The same of the cube, and what belongs to the plane.
const IN_SPACE: &str = r#"
[0.0, 0.0, -10e6] | [0.0, -10e6] | traction = [0.0, -10e6] | the traction on `top` has 2 components & 3 dimensions |
    [x, y, z]
poisson = 0.3 | poisson = 0.3¶plane = "stress" | plane = | plane state | remove material.plane
elements = | cells = "triangle"¶elements = | cells = | 2 dimensions & has 3 | "tetrahedron"
elements = | element = "nodal-volume"¶elements = | element = "nodal-volume" |
    mesh.element is "nodal-volume" & a hexahedron | use "b-bar"
"bottom" | "botom" | "botom" | no boundary `botom` | bottom, top, left, right, front, back
gap = 1e-5 | gap = 1e-5, normal = [0, -1] | obstacle = | normal of the obstacle has two | [x, y, z]
"plane", gap = 1e-5 | "sphere", radius = 9.0, apex = [0.5, 0.5] | obstacle = |
    apex of the obstacle has two components & three dimensions | [x, y, z]
gap = 1e-5 | motion.translation = [[0, 0, 0], [1, 1e-3, 0]] | obstacle = |
    translation of the obstacle has two components | [time, x, y, z]
"plane", gap = 1e-5 | "cylinder", radius = 9.0, apex = [0.5, 0.5, 0] | obstacle = | in three dimensions needs an axis |
    [0, 1, 0]
gap = 1e-5 | gap = -0.3 | obstacle = | the obstacle starts 300 mm inside the body & which is 1.00 m thick there |
    move the obstacle out
"plane", gap = 1e-5 | "sphere", radius = 9.0, apex = [0.5, 0.5, 0.4] | obstacle = |
    the obstacle starts 400 mm inside the body at (0.5, 0.5, 0) m | move the obstacle out
gap = 1e-5 | gap = 1e-5, normal = [0, 0, 1] | obstacle = | normal of the obstacle points into the body at `bottom` |
    out of the body
"#;

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
