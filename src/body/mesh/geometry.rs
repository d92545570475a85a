//! The body that a two-dimensional mesh represents: a slice or a body of revolution.

use std::f64::consts::TAU;

/// The meaning of the coordinates of a mesh.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Geometry {
    /// Cartesian coordinates; in two dimensions the body is a slice of unit depth.
    #[default]
    Cartesian,
    /// A two-dimensional mesh is half the section of a body of revolution about the y axis; x is the distance from the
    /// axis.
    Axisymmetric,
}

impl Geometry {
    /// Returns the volume of the body per area of the section (or the area per length) at `x` (m): `2 π r` (m) for a
    /// body of revolution, otherwise 1.
    pub fn depth(self, x: [f64; 3]) -> f64 {
        match self {
            Geometry::Cartesian => 1.0,
            Geometry::Axisymmetric => TAU * x[0],
        }
    }
}
