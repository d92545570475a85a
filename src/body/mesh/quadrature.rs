//! Integration points of the kinds of cells.

use super::{CellKind, Geometry};

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

/// Those that integrate the stiffness of the cell with these `nodes`: more than [`quadrature`] has where a tetrahedron is curved. In
/// a body of revolution all is multiplied by the distance from the axis, and the hoop strain is divided by it: a linear triangle has
/// three points, for one point would leave it a motion without energy, and one of second order more than three where it is curved.
pub fn quadrature_of(kind: CellKind, geometry: Geometry, nodes: &[[f64; 3]]) -> Vec<([f64; 3], f64)> {
    stiffness_rule(kind, geometry, kind.is_curved(nodes))
}

/// The same of a cell that is `curved`, or is not.
pub(crate) fn stiffness_rule(kind: CellKind, geometry: Geometry, curved: bool) -> Vec<([f64; 3], f64)> {
    let properties = kind.properties();
    match (geometry, curved) {
        (Geometry::Cartesian, false) => (properties.rule)(),
        (Geometry::Cartesian, true) => (properties.curved_rule)(),
        (Geometry::Axisymmetric, false) if kind.is_quadratic() => (properties.rule)(),
        (Geometry::Axisymmetric, _) => (properties.fine_rule)(),
    }
}
