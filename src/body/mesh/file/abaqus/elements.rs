//! The elements of Abaqus that are read, by the number of their nodes.

use crate::body::mesh::CellKind;
use crate::body::mesh::file::raw::ElementKind;

/// Returns the kind of elements of Abaqus's type `name`; `None` if it is not supported. Abaqus and
/// [`CellKind`] have the same orders of nodes and of sides. Gmsh writes lines as trusses.
pub(super) fn kind_of(name: &str) -> Option<ElementKind> {
    match name {
        "T2D2" | "T3D2" => return Some(ElementKind::Line),
        "T2D3" | "T3D3" => return Some(ElementKind::Line3),
        _ => {}
    }
    let (solid, rest) = match name.strip_prefix("C3D") {
        Some(rest) => (true, rest),
        None => (false, ["CPE", "CPS", "CAX"].iter().find_map(|family| name.strip_prefix(family))?),
    };
    let digits = rest.bytes().take_while(u8::is_ascii_digit).count();
    let (nodes, variant) = rest.split_at(digits);
    // Reduced, hybrid, incompatible modes, modified, thermal, and improved surface stress.
    if !variant.bytes().all(|letter| b"RHIMTS".contains(&letter)) {
        return None;
    }
    Some(ElementKind::Cell(match (solid, nodes) {
        (false, "3") => CellKind::Triangle,
        (false, "4") => CellKind::Quadrilateral,
        (false, "6") => CellKind::Triangle6,
        (false, "8") => CellKind::Quadrilateral8,
        (true, "4") => CellKind::Tetrahedron,
        (true, "6") => CellKind::Prism,
        (true, "8") => CellKind::Hexahedron,
        (true, "10") => CellKind::Tetrahedron10,
        (true, "15") => CellKind::Prism15,
        (true, "20") => CellKind::Hexahedron20,
        _ => return None,
    }))
}

/// Returns `true` for a type whose last letters choose a formulation, such as CPE4R.
pub(super) fn is_variant(name: &str) -> bool {
    name.ends_with(|last: char| last.is_ascii_alphabetic())
}
