//! Integration points of the kinds of cells.

use super::CellKind;

/// The points and weights that integrate the stiffness of a cell with straight edges: Gauss points of weight 1, which are exact for
/// cubic polynomials in each of [ξ, η, ζ], two along each axis of a square or cube; the centre of a triangle or
/// tetrahedron, exact for linear polynomials; of those of second order three and four points, exact for quadratic ones.
pub fn quadrature(kind: CellKind) -> Vec<([f64; 3], f64)> {
    (kind.properties().rule)()
}

/// Those that are exact for polynomials of one degree more on triangles and tetrahedra, of two degrees more on those of second order.
pub fn fine_quadrature(kind: CellKind) -> Vec<([f64; 3], f64)> {
    (kind.properties().fine_rule)()
}

/// Those that integrate the stiffness of the cell with these `nodes`: more than [`quadrature`] has where a tetrahedron is curved.
pub fn quadrature_of(kind: CellKind, nodes: &[[f64; 3]]) -> Vec<([f64; 3], f64)> {
    let properties = kind.properties();
    if kind.is_curved(nodes) { (properties.curved_rule)() } else { (properties.rule)() }
}
