//! Checks of `[mesh]`.

use std::fmt;

use toml::Spanned;

use super::Check;
use crate::scene::document::{self, MeshKind, Segments};
use crate::scene::{CellShape, Element, HalfPlane, Material, Mesh, Plane, SceneError, Segment};

/// Beyond this a mesh is a slip of the pen, not a model: no matrix of it would fit into memory.
const MOST_ELEMENTS: i64 = 50_000_000;

impl Check<'_> {
    pub(super) fn mesh(&self, mesh: &document::Mesh) -> Result<Mesh, SceneError> {
        match mesh.kind.get_ref() {
            MeshKind::Block => self.block(mesh),
            MeshKind::HalfPlane => self.half_plane(mesh),
            MeshKind::Gmsh => self.gmsh(mesh),
        }
    }

    fn block(&self, mesh: &document::Mesh) -> Result<Mesh, SceneError> {
        let kind = "a block";
        let size = self.size(mesh, kind)?;
        self.no_half_plane(mesh, kind)?;
        let given = self.needed("mesh.elements", mesh.elements.as_ref(), &mesh.kind.span(), kind)?;
        let elements = self.segments("mesh.elements", given, &size)?;
        let sound = elements.iter().flatten().all(|&n| n > 0);
        let help = "give the numbers of elements along each axis";
        self.demand(sound, "mesh.elements", given, "numbers of at least 1", help)?;
        let along = |axis: &Vec<i64>| axis.iter().try_fold(0_i64, |sum, &n| sum.checked_add(n));
        let all = elements.iter().try_fold(1_i64, |all, axis| all.checked_mul(along(axis)?));
        let few = all.is_some_and(|n| n <= MOST_ELEMENTS);
        self.demand(few, "mesh.elements", given, "at most 50 million in all", "use a coarser mesh")?;
        let grading = self.grading(mesh, &size)?;
        let axes: Vec<Vec<Segment>> = (size.iter().zip(&elements).zip(&grading))
            .map(|((lengths, elements), grading)| {
                let segments = lengths.iter().zip(elements).zip(grading);
                segments.map(|((&length, &n), &grading)| Segment { length, elements: n as usize, grading }).collect()
            })
            .collect();
        Ok(Mesh::Block { cells: self.cells(mesh, axes.len())?, axes })
    }

    /// The values of a list with one for each length in `size`.
    fn segments<T: Clone + fmt::Debug>(
        &self,
        name: &str,
        given: &Spanned<Vec<Segments<T>>>,
        size: &[Vec<f64>],
    ) -> Result<Vec<Vec<T>>, SceneError> {
        let values: Vec<Vec<T>> = given.get_ref().iter().map(|Segments(values)| values.clone()).collect();
        let sound = values.iter().map(Vec::len).eq(size.iter().map(Vec::len));
        let help = "mesh.size says how many segments there are along each axis";
        self.demand(sound, name, given, "a number for each length in mesh.size", help)?;
        Ok(values)
    }

    /// The cells of a block with so many axes.
    fn cells(&self, mesh: &document::Mesh, axes: usize) -> Result<CellShape, SceneError> {
        let Some(given) = &mesh.cells else {
            return Ok(if axes == 2 { CellShape::Quadrilateral } else { CellShape::Hexahedron });
        };
        let cells = *given.get_ref();
        if cells.dimension() != axes {
            let message = format!("mesh.cells have {} dimensions, but mesh.size has {axes}", cells.dimension());
            let help =
                "use \"triangle\" or \"quadrilateral\" in two dimensions, \"tetrahedron\" or \"hexahedron\" in three";
            return self.fail(given.span(), message, help);
        }
        Ok(cells)
    }

    /// The lengths of the segments along each axis of a mesh that is made here.
    fn size(&self, mesh: &document::Mesh, kind: &str) -> Result<Vec<Vec<f64>>, SceneError> {
        self.foreign("mesh.file", mesh.file.as_ref(), kind)?;
        self.foreign("mesh.scale", mesh.scale.as_ref(), kind)?;
        let given = self.needed("mesh.size", mesh.size.as_ref(), &mesh.kind.span(), kind)?;
        let size: Vec<Vec<f64>> = given.get_ref().iter().map(|Segments(lengths)| lengths.clone()).collect();
        let axes = (2..=3).contains(&size.len());
        let help = "give width and height in m, in three dimensions the lengths along x, y and z";
        self.demand(axes, "mesh.size", given, "two or three lengths", help)?;
        let sound = size.iter().all(|axis| !axis.is_empty() && axis.iter().all(|&x| x > 0.0 && x.is_finite()));
        self.demand(sound, "mesh.size", given, "positive finite lengths", help)?;
        Ok(size)
    }

    fn gmsh(&self, mesh: &document::Mesh) -> Result<Mesh, SceneError> {
        let kind = "a mesh from Gmsh";
        self.foreign("mesh.size", mesh.size.as_ref(), kind)?;
        self.no_block(mesh, kind)?;
        self.no_half_plane(mesh, kind)?;
        let file = self.needed("mesh.file", mesh.file.as_ref(), &mesh.kind.span(), kind)?;
        let Some(given) = &mesh.scale else {
            return Ok(Mesh::Gmsh { file: self.source.beside(file.get_ref()), scale: 1.0 });
        };
        let scale = self.finite("mesh.scale", given)?;
        let help = "give the length of the file's unit in m, 0.001 for mm";
        self.demand(scale > 0.0, "mesh.scale", given, "positive", help)?;
        Ok(Mesh::Gmsh { file: self.source.beside(file.get_ref()), scale })
    }

    /// Refuses the keys of a block.
    fn no_block(&self, mesh: &document::Mesh, kind: &str) -> Result<(), SceneError> {
        self.foreign("mesh.elements", mesh.elements.as_ref(), kind)?;
        self.foreign("mesh.cells", mesh.cells.as_ref(), kind)?;
        self.foreign("mesh.grading", mesh.grading.as_ref(), kind)
    }

    /// Refuses the keys of a half-plane.
    fn no_half_plane(&self, mesh: &document::Mesh, kind: &str) -> Result<(), SceneError> {
        self.foreign("mesh.contact_width", mesh.contact_width.as_ref(), kind)?;
        self.foreign("mesh.contact_elements", mesh.contact_elements.as_ref(), kind)?;
        self.foreign("mesh.outer_elements", mesh.outer_elements.as_ref(), kind)?;
        self.foreign("mesh.layers", mesh.layers.as_ref(), kind)
    }

    fn grading(&self, mesh: &document::Mesh, size: &[Vec<f64>]) -> Result<Vec<Vec<f64>>, SceneError> {
        let name = "mesh.grading";
        let Some(given) = &mesh.grading else {
            return Ok(size.iter().map(|axis| vec![1.0; axis.len()]).collect());
        };
        let grading = self.segments(name, given, size)?;
        let sound = grading.iter().flatten().all(|ratio| (1e-6..=1e6).contains(ratio));
        let help = "give the size of the last element over that of the first, along each axis";
        self.demand(sound, name, given, "ratios from 1e-6 to 1e6", help)?;
        Ok(grading)
    }

    /// The elements of the mesh, for a body of `material`.
    pub(super) fn element(&self, mesh: &document::Mesh, material: &Material) -> Result<Element, SceneError> {
        let Some(given) = &mesh.element else { return Ok(Element::default()) };
        let element = *given.get_ref();
        if element == Element::BBar && material.plane == Plane::Stress {
            let message = "mesh.element is \"b-bar\", but material.plane is \"stress\"";
            let help = "plane stress does not constrain the volume, so nothing locks: use \"bilinear\"";
            return self.fail(given.span(), message, help);
        }
        Ok(element)
    }

    fn half_plane(&self, mesh: &document::Mesh) -> Result<Mesh, SceneError> {
        let kind = "a half-plane";
        let lengths = self.size(mesh, kind)?.concat();
        let Ok(size) = <[f64; 2]>::try_from(lengths) else {
            return self.fail(mesh.kind.span(), "a half-plane has two lengths", "give mesh.size as [width, height]");
        };
        self.no_block(mesh, kind)?;
        let name = "mesh.contact_width";
        let given = self.needed(name, mesh.contact_width.as_ref(), &mesh.kind.span(), kind)?;
        let contact_width = self.finite(name, given)?;
        let sound = contact_width > 0.0 && contact_width < size[0];
        self.demand(sound, name, given, "positive and less than the width of the mesh", "give the contact zone in m")?;
        let count = |name: &str, given: &Option<Spanned<i64>>| {
            let given = self.needed(name, given.as_ref(), &mesh.kind.span(), kind)?;
            let sound = (1..=MOST_ELEMENTS).contains(given.get_ref());
            self.demand(sound, name, given, "at least 1 and at most 50 million", "give a number of elements")?;
            Ok(*given.get_ref())
        };
        let contact_elements = count("mesh.contact_elements", &mesh.contact_elements)?;
        let outer_elements = count("mesh.outer_elements", &mesh.outer_elements)?;
        let layers = count("mesh.layers", &mesh.layers)?;
        if (contact_elements + outer_elements).checked_mul(layers).is_none_or(|n| n > MOST_ELEMENTS) {
            return self.fail(mesh.kind.span(), "the mesh has more than 50 million elements", "use a coarser mesh");
        }
        Ok(Mesh::HalfPlane(HalfPlane {
            size,
            contact_width,
            contact_elements: contact_elements as usize,
            outer_elements: outer_elements as usize,
            layers: layers as usize,
        }))
    }
}
