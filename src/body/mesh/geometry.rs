//! What a mesh of the plane stands for in space: a slice, or a body of revolution.

use std::f64::consts::TAU;

/// The coordinates of a mesh.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Geometry {
    /// Those of space; in two dimensions the body is a slice of unit depth.
    #[default]
    Cartesian,
    /// A mesh of two dimensions is half the section of a body of revolution: x is the distance from the axis, which is y.
    Axisymmetric,
}

impl Geometry {
    /// What an area (m²) or a length (m) of the section at `x` (m) stands for in the body, by itself: `2 π r` (m) where it goes round
    /// the axis, 1 elsewhere.
    pub fn depth(self, x: [f64; 3]) -> f64 {
        match self {
            Geometry::Cartesian => 1.0,
            Geometry::Axisymmetric => TAU * x[0],
        }
    }
}
