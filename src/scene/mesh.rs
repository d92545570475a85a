//! What a scene says of its mesh.

use std::path::PathBuf;

use serde::{Deserialize, Serialize};

/// How the mesh is made.
#[derive(Debug, Clone, PartialEq)]
pub enum Mesh {
    /// A rectangle or box with its lowest corner in the origin.
    Block {
        /// The segments that x, y and, in three dimensions, z are made of.
        axes: Vec<Vec<Segment>>,
        /// The cells; triangles and tetrahedra divide the elements.
        cells: CellShape,
    },
    /// A rectangle that stands for a half-plane pressed at the left end of its top.
    HalfPlane(HalfPlane),
    /// From a file in the format MSH 4.1 of Gmsh.
    Gmsh {
        /// The file.
        file: PathBuf,
        /// The length of the file's unit, m.
        scale: f64,
    },
}

/// A length with elements in geometric progression.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Segment {
    /// The length, m.
    pub length: f64,
    /// The elements along it.
    pub elements: usize,
    /// Size of the last element over that of the first.
    pub grading: f64,
}

/// The shape of cells.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum CellShape {
    /// Two to a quadrilateral.
    Triangle,
    /// In two dimensions, if the scene does not say otherwise.
    Quadrilateral,
    /// Six to a hexahedron.
    Tetrahedron,
    /// In three dimensions, if the scene does not say otherwise.
    Hexahedron,
}

/// How the strain of an element follows from its corner displacements.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Element {
    /// As that of linear, bilinear or trilinear displacements; too stiff (it locks) when Poisson's ratio
    /// is close to 0.5, except in plane stress.
    #[default]
    Bilinear,
    /// With the mean dilatation of the element in place of the local one: does not lock. For quadrilaterals in
    /// plane strain and hexahedra.
    BBar,
}

/// A rectangle, fine under a contact zone at the left end of its top and coarser away from it:
/// half of a body that is symmetric about its left side.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct HalfPlane {
    /// Width and height, m.
    pub size: [f64; 2],
    /// Width of the contact zone, m.
    pub contact_width: f64,
    /// Equal elements along the contact zone.
    pub contact_elements: usize,
    /// Equal elements along the rest of the top.
    pub outer_elements: usize,
    /// Layers of elements, in geometric progression from the top one, whose elements are square in
    /// the contact zone, to the bottom.
    pub layers: usize,
}

impl CellShape {
    /// 2 or 3.
    pub fn dimension(self) -> usize {
        match self {
            CellShape::Triangle | CellShape::Quadrilateral => 2,
            CellShape::Tetrahedron | CellShape::Hexahedron => 3,
        }
    }

    /// Whether it is a triangle or a tetrahedron.
    pub fn is_simplex(self) -> bool {
        matches!(self, CellShape::Triangle | CellShape::Tetrahedron)
    }
}

impl Mesh {
    /// The number of nodes and the dimension; `None` if they are not known before a file is read.
    pub fn nodes(&self) -> Option<(usize, usize)> {
        match self {
            Mesh::Block { axes, .. } => {
                let nodes = axes.iter().map(|axis| 1 + axis.iter().map(|segment| segment.elements).sum::<usize>());
                Some((nodes.product(), axes.len()))
            }
            Mesh::HalfPlane(m) => Some(((m.contact_elements + m.outer_elements + 1) * (m.layers + 1), 2)),
            Mesh::Gmsh { .. } => None,
        }
    }
}
