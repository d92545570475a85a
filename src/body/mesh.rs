//! Meshes in two and three dimensions with named boundaries and material groups. A mesh may consist of several bodies.

mod bisection;
mod block;
mod bodies;
mod check;
mod file;
mod geometry;
mod interpolation;
mod kind;
mod midsides;
mod rules;
mod sides;
mod source;

pub(crate) use bisection::{Bisection, Round};
pub use block::block;
pub use bodies::Bodies;
pub use check::MeshFault;
pub(crate) use file::{AbaqusData, AbaqusKeyword, abaqus_keywords, faces};
pub use file::{MeshFileError, MeshFormat, MeshFormatError, Place, from_gmsh};
pub use geometry::Geometry;
pub(crate) use interpolation::{
    Jacobian, MAX_NODES, ReferenceCell, ReferenceCells, ReferencePoint, corner_shape, local_gradients, stiffness_rule,
};
pub use interpolation::{fine_quadrature, quadrature, quadrature_of, shape};
pub use kind::CellKind;
pub(crate) use rules::{GAUSS3, UNIT_GAUSS3};
pub(crate) use sides::sorted;
pub use source::{Body, HalfPlane, MeshError, MeshSource, Segment};

use crate::algebra::vector::{cross, minus};

/// A mesh in two or three dimensions. Points always have three coordinates.
#[derive(Debug, Clone, PartialEq)]
pub struct Mesh {
    /// The dimension, 2 or 3.
    pub dimension: usize,
    /// The meaning of the coordinates.
    pub geometry: Geometry,
    /// Node coordinates, m; z = 0 in two dimensions.
    pub nodes: Vec<[f64; 3]>,
    /// The cells; each has the dimension of the mesh.
    pub cells: Vec<Cell>,
    /// The names of the material groups.
    pub groups: Vec<String>,
    /// The named boundaries.
    pub boundaries: Vec<Boundary>,
    /// Further information from the mesh file.
    pub notes: Notes,
}

/// A cell of a mesh.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Cell {
    /// The kind of the cell.
    pub kind: CellKind,
    /// The nodes of the cell, as many as the kind has, in the order of [`CellKind`].
    pub nodes: Vec<usize>,
    /// The material group of the cell, an index of [`Mesh::groups`].
    pub group: usize,
}

/// The nodes of a boundary facet in order: an edge in two dimensions from end to end, a triangle or a quadrilateral in
/// three dimensions all around.
///
/// The body is on the left of an edge; a face is counterclockwise seen from outside. In cells of second order a node
/// between corners is listed between them: an edge has three nodes, a triangle six.
pub type Facet = Vec<usize>;

/// A named part of the boundary.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Boundary {
    /// The name a scene uses.
    pub name: String,
    /// The facets of the boundary; in two dimensions consecutive edges.
    pub facets: Vec<Facet>,
}

/// Returns `true` if `own` is the `name`, or the name in capitals, as those of Abaqus are.
pub(super) fn is_called(own: &str, name: &str) -> bool {
    let in_capitals = || !own.rsplit(':').next().unwrap_or(own).contains(char::is_lowercase);
    own == name || own.eq_ignore_ascii_case(name) && in_capitals()
}

impl Mesh {
    /// Returns the boundary called `name`.
    pub fn boundary(&self, name: &str) -> Option<&Boundary> {
        let exact = self.boundaries.iter().find(|boundary| boundary.name == name);
        exact.or_else(|| self.boundaries.iter().find(|boundary| is_called(&boundary.name, name)))
    }

    /// Returns the facets of the boundary called `name`; none if there is no such boundary.
    pub(super) fn facets_of(&self, name: &str) -> &[Facet] {
        self.boundary(name).map_or(&[], |boundary| &boundary.facets)
    }

    /// Returns the names of all boundaries.
    pub fn boundary_names(&self) -> Vec<&str> {
        self.boundaries.iter().map(|boundary| boundary.name.as_str()).collect()
    }

    /// Returns the coordinates of `nodes`, m.
    pub fn points(&self, nodes: &[usize]) -> Vec<[f64; 3]> {
        nodes.iter().map(|&node| self.nodes[node]).collect()
    }

    /// Returns the smallest and the largest coordinate along each axis, m.
    pub fn bounds(&self) -> [(f64, f64); 3] {
        self.bounds_of(0..self.nodes.len())
    }

    /// Returns the smallest and the largest coordinate of `nodes` along each axis, m.
    pub fn bounds_of(&self, nodes: impl IntoIterator<Item = usize>) -> [(f64, f64); 3] {
        let wider = |bounds: [(f64, f64); 3], node: usize| {
            let x = self.nodes[node];
            [0, 1, 2].map(|c| (bounds[c].0.min(x[c]), bounds[c].1.max(x[c])))
        };
        nodes.into_iter().fold([(f64::INFINITY, f64::NEG_INFINITY); 3], wider)
    }

    /// Returns the centre of cell `e`, the mean of its corners, m.
    pub fn centre(&self, e: usize) -> [f64; 3] {
        let cell = &self.cells[e];
        let corners = self.points(&cell.nodes[..cell.kind.corners()]);
        [0, 1, 2].map(|c| corners.iter().map(|x| x[c]).sum::<f64>() / corners.len() as f64)
    }

    /// Returns the side lengths of the bounding box of the mesh, m.
    pub fn extent(&self) -> [f64; 3] {
        self.bounds().map(|(lowest, highest)| highest - lowest)
    }

    /// Returns the longest side of the bounding box of the mesh, m.
    pub fn size(&self) -> f64 {
        self.extent().into_iter().fold(0.0, f64::max)
    }

    /// Returns the outward normal of a facet times its length (m) or area (m²). The result is exact for curved facets,
    /// too, since the integral of the normal depends only on the ends or edges.
    pub fn area_vector(&self, facet: &[usize]) -> [f64; 3] {
        let points = self.points(facet);
        if self.dimension == 2 {
            let [dx, dy, _] = minus(points[points.len() - 1], points[0]);
            return [dy, -dx, 0.0];
        }
        let polygon = |points: &mut dyn Iterator<Item = [f64; 3]>| {
            let (mut sum, mut last) = ([0.0; 3], None::<[f64; 3]>);
            let Some(first) = points.next() else { return sum };
            for point in points {
                let from = minus(point, first);
                if let Some(last) = last.replace(from) {
                    sum.iter_mut().zip(cross(last, from)).for_each(|(sum, c)| *sum += 0.5 * c);
                }
            }
            sum
        };
        let all = polygon(&mut points.iter().copied());
        if !self.is_quadratic(facet) {
            return all;
        }
        // Simpson's rule, as edges are parabolas.
        let corners = polygon(&mut points.iter().copied().step_by(2));
        [0, 1, 2].map(|c| (4.0 * all[c] - corners[c]) / 3.0)
    }
}

impl Boundary {
    /// Returns the nodes of the boundary, each once, in the order of its facets. The list of edges may run along their
    /// direction or against it.
    pub fn nodes(&self) -> Vec<usize> {
        let mut visited = std::collections::HashSet::new();
        let against = self.facets.windows(2).any(|pair| pair[0].len() == 2 && pair[0][0] == pair[1][1]);
        let mut nodes = Vec::new();
        for facet in &self.facets {
            let in_order: &mut dyn Iterator<Item = &usize> =
                if against { &mut facet.iter().rev() } else { &mut facet.iter() };
            nodes.extend(in_order.copied().filter(|&node| visited.insert(node)));
        }
        nodes
    }
}

/// Notes on the file of a mesh; empty for a mesh that was not read from a file.
#[derive(Debug, Clone, Default, PartialEq, Eq)]
pub struct Notes {
    /// Changes and omissions when the file was read, in words.
    pub remarks: Vec<String>,
    /// Named groups that cannot be boundaries, each with the reason. Such a group is an error only if a scene names it.
    pub unusable: Vec<(String, MeshFault)>,
    /// The entries of [`Mesh::groups`] for cells in several groups of the file, each with the names of these
    /// groups.
    pub combined: Vec<(String, Vec<String>)>,
}

impl Notes {
    /// Returns the groups of the file that contain the cells of `group`.
    pub fn members<'a>(&'a self, group: &'a String) -> &'a [String] {
        let combined = self.combined.iter().find(|(name, _)| name == group);
        combined.map_or(std::slice::from_ref(group), |(_, members)| members)
    }

    /// Adds the name of the body `name` to the groups.
    fn of_body(self, name: &str) -> Self {
        let full = |group: String| format!("{name}:{group}");
        Notes {
            remarks: self.remarks.into_iter().map(|remark| format!("{name}: {remark}")).collect(),
            unusable: self.unusable.into_iter().map(|(group, fault)| (full(group), fault)).collect(),
            combined: (self.combined.into_iter())
                .map(|(group, members)| (full(group), members.into_iter().map(full).collect()))
                .collect(),
        }
    }

    /// Adds the notes of another mesh.
    fn append(&mut self, Notes { remarks, unusable, combined }: Notes) {
        self.remarks.extend(remarks);
        self.unusable.extend(unusable);
        self.combined.extend(combined);
    }
}
