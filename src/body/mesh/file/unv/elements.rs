//! The elements of universal files, by their finite element descriptor.

use crate::body::mesh::CellKind;

/// Returns `true` for rods and beams, which have a record of their own before their nodes.
pub(super) fn is_beam(descriptor: usize) -> bool {
    matches!(descriptor, 11 | 21..=25)
}

/// Returns the kind of cells of a `descriptor`. The error is the name of an unsupported element.
pub(super) fn kind_of(descriptor: usize) -> Result<CellKind, &'static str> {
    Ok(match descriptor {
        41 | 51 | 61 | 74 | 81 | 91 => CellKind::Triangle,
        42 | 52 | 62 | 72 | 82 | 92 => CellKind::Triangle6,
        44 | 54 | 64 | 71 | 84 | 94 => CellKind::Quadrilateral,
        45 | 55 | 65 | 75 | 85 | 95 => CellKind::Quadrilateral8,
        111 => CellKind::Tetrahedron,
        112 => CellKind::Prism,
        115 => CellKind::Hexahedron,
        113 => CellKind::Prism15,
        116 => CellKind::Hexahedron20,
        118 => CellKind::Tetrahedron10,
        114 => return Err("pyramid of second order, or prism of third order"),
        43 | 46 | 53 | 56 | 63 | 66 | 73 | 76 | 93 | 96 | 117 => return Err("third order"),
        31 | 32 => return Err("pipe"),
        101..=106 => return Err("thick shell"),
        121 | 122 => return Err("rigid element"),
        136..=142 => return Err("spring or damper"),
        151..=152 => return Err("gap"),
        161 => return Err("mass"),
        _ => return Err("unknown"),
    })
}

/// Returns the place in the file of each node of a cell in the order of [`CellKind`]. Nodes at the middles of edges come
/// between the corners.
pub(super) fn order(kind: CellKind) -> Vec<usize> {
    match kind {
        CellKind::Triangle6 => vec![0, 2, 4, 1, 3, 5],
        CellKind::Quadrilateral8 => vec![0, 2, 4, 6, 1, 3, 5, 7],
        CellKind::Prism15 => vec![0, 2, 4, 9, 11, 13, 1, 3, 5, 10, 12, 14, 6, 7, 8],
        CellKind::Hexahedron20 => vec![0, 2, 4, 6, 12, 14, 16, 18, 1, 3, 5, 7, 13, 15, 17, 19, 8, 9, 10, 11],
        CellKind::Tetrahedron10 => vec![0, 2, 4, 9, 1, 3, 5, 6, 7, 8],
        _ => (0..kind.nodes()).collect(),
    }
}
