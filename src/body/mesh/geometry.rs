//! The body that a two-dimensional mesh represents: a slice or a body of revolution.

use std::f64::consts::TAU;
use std::ops::Range;

use super::check::none;
use super::{Mesh, MeshFault};

/// The meaning of the coordinates of a mesh.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Geometry {
    /// Cartesian coordinates; in two dimensions the body is a slice of unit depth.
    #[default]
    Cartesian,
    /// A two-dimensional mesh is half the section of a body of revolution about the y axis; x is the distance from the
    /// axis.
    Axisymmetric,
    /// As [`Geometry::Axisymmetric`], with displacements around the axis, along z: the body may be twisted.
    Torsion,
}

impl Geometry {
    /// Returns the volume of the body per area of the section (or the area per length) at `x` (m): `2 π r` (m) for a
    /// body of revolution, otherwise 1.
    pub fn depth(self, x: [f64; 3]) -> f64 {
        match self {
            Geometry::Cartesian => 1.0,
            Geometry::Axisymmetric | Geometry::Torsion => TAU * x[0],
        }
    }

    /// Returns `true` for a body of revolution.
    pub fn is_revolved(self) -> bool {
        self != Geometry::Cartesian
    }

    /// Returns the number of components of displacements and forces of a mesh of this dimension.
    pub fn components(self, dimension: usize) -> usize {
        if self == Geometry::Torsion { 3 } else { dimension }
    }
}

/// Nodes within this distance from the axis, relative to the size of the body, count as on the axis, to allow for
/// rounding of coordinates.
const ON_AXIS: f64 = 1e-9;

impl Mesh {
    /// Makes this two-dimensional mesh the half section of a body of revolution about the y axis. Nodes beside the axis
    /// within rounding are moved to it.
    ///
    /// # Errors
    /// [`MeshFault::NoSection`] for a three-dimensional mesh, [`MeshFault::LeftOfAxis`] if x is negative.
    ///
    /// ```
    /// use stickslip::body::mesh::{Geometry, block};
    ///
    /// let cylinder = block(&[1.0, 2.0], &[4, 8]).into_axisymmetric()?;
    /// assert_eq!(cylinder.geometry, Geometry::Axisymmetric);
    /// # Ok::<(), stickslip::body::mesh::MeshFault>(())
    /// ```
    pub fn into_axisymmetric(self) -> Result<Mesh, MeshFault> {
        self.into_revolved(Geometry::Axisymmetric)
    }

    /// Makes this mesh a section as [`Mesh::into_axisymmetric`] does, of this `geometry`.
    pub(crate) fn into_revolved(mut self, geometry: Geometry) -> Result<Mesh, MeshFault> {
        let near = ON_AXIS * self.size();
        for x in self.nodes.iter_mut().filter(|x| x[0].abs() <= near) {
            x[0] = 0.0;
        }
        self.geometry = geometry;
        self.check_section()?;
        Ok(self)
    }

    /// Checks that the mesh of a body of revolution is two-dimensional and on one side of the axis.
    pub(super) fn check_section(&self) -> Result<(), MeshFault> {
        if self.geometry == Geometry::Cartesian {
            return Ok(());
        }
        if self.dimension != 2 {
            return Err(MeshFault::NoSection);
        }
        let left: Vec<usize> = (0..self.nodes.len()).filter(|&node| self.nodes[node][0] < 0.0).collect();
        none(left, MeshFault::LeftOfAxis)
    }

    /// Returns the number of components of displacements and forces: the dimension, and 3 with torsion.
    pub fn components(&self) -> usize {
        self.geometry.components(self.dimension)
    }

    /// Returns the axes about which the body can turn: z in the plane, all in space, with torsion y; a body of revolution
    /// without torsion does not turn.
    pub fn rotation_axes(&self) -> Range<usize> {
        match (self.geometry, self.dimension) {
            (Geometry::Axisymmetric, _) => 0..0,
            (Geometry::Torsion, _) => 1..2,
            (Geometry::Cartesian, 2) => 2..3,
            (Geometry::Cartesian, _) => 0..3,
        }
    }

    /// Returns `true` if `node` is on the axis of a body of revolution, where displacements across it are 0.
    pub fn is_on_axis(&self, node: usize) -> bool {
        self.geometry.is_revolved() && self.nodes[node][0] == 0.0
    }
}

#[cfg(test)]
mod tests {
    use super::super::block;
    use super::*;

    #[test]
    fn the_section_is_on_one_side_of_the_axis() {
        let moved = |x: f64| {
            let mut mesh = block(&[1.0, 2.0], &[2, 2]);
            mesh.nodes.iter_mut().for_each(|node| node[0] += x);
            mesh.into_axisymmetric()
        };
        for x in [0.0, 1e-12, -1e-12] {
            let mesh = moved(x).unwrap();
            let on_axis: Vec<usize> = (0..mesh.nodes.len()).filter(|&node| mesh.is_on_axis(node)).collect();
            assert_eq!(on_axis, [0, 3, 6], "{x}");
            assert!(mesh.check().is_ok());
        }
        assert!((0..9).all(|node| !moved(1e-3).unwrap().is_on_axis(node)));
        assert_eq!(moved(-1e-6).unwrap_err(), MeshFault::LeftOfAxis(vec![0, 3, 6]));
        assert_eq!(block(&[1.0; 3], &[1; 3]).into_axisymmetric().unwrap_err(), MeshFault::NoSection);
        // A mesh put together by hand.
        let mut by_hand = moved(0.0).unwrap();
        by_hand.nodes[0][0] = -1e-3;
        assert_eq!(by_hand.check().unwrap_err(), MeshFault::LeftOfAxis(vec![0]));
    }
}
