//! Integration rules of the kinds of cells.

use super::{CellKind, Geometry};

/// Returns the points and weights of the rule for the stiffness of a cell with straight edges.
///
/// Squares and cubes have two Gauss points of weight 1 along each axis, exact for cubic polynomials in each of
/// [ξ, η, ζ]; triangles and tetrahedra have their centre, exact for linear polynomials; those of second order have
/// three and four points, exact for quadratic polynomials.
pub fn quadrature(kind: CellKind) -> Vec<([f64; 3], f64)> {
    (kind.properties().rule)()
}

/// Returns the rule that is exact for polynomials of one degree more on triangles and tetrahedra, and of two degrees
/// more on those of second order.
pub fn fine_quadrature(kind: CellKind) -> Vec<([f64; 3], f64)> {
    (kind.properties().fine_rule)()
}

/// Returns the rule for the stiffness of the cell with these `nodes`: a curved tetrahedron has more points than in
/// [`quadrature`]. In a body of revolution, integrands are multiplied by the distance from the axis, and the hoop
/// strain is divided by it. There a linear triangle has three points, since one point would leave a zero-energy mode,
/// and a curved triangle of second order has more than three.
pub fn quadrature_of(kind: CellKind, geometry: Geometry, nodes: &[[f64; 3]]) -> Vec<([f64; 3], f64)> {
    stiffness_rule(kind, geometry, kind.is_curved(nodes))
}

/// Returns the rule for the stiffness of a cell that is `curved` or not.
pub(crate) fn stiffness_rule(kind: CellKind, geometry: Geometry, curved: bool) -> Vec<([f64; 3], f64)> {
    let properties = kind.properties();
    match (geometry, curved) {
        (Geometry::Cartesian, false) => (properties.rule)(),
        (Geometry::Cartesian, true) => (properties.curved_rule)(),
        (Geometry::Axisymmetric, false) if kind.is_quadratic() => (properties.rule)(),
        (Geometry::Axisymmetric, _) => (properties.fine_rule)(),
    }
}
