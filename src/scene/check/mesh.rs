//! Checks of `[mesh]`.

use toml::Spanned;

use super::Check;
use crate::scene::document::{self, MeshKind};
use crate::scene::{CellShape, Element, HalfPlane, Material, Mesh, Plane, SceneError};

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
        self.foreign("mesh.contact_width", mesh.contact_width.as_ref(), kind)?;
        for (name, value) in [
            ("mesh.contact_elements", &mesh.contact_elements),
            ("mesh.outer_elements", &mesh.outer_elements),
            ("mesh.layers", &mesh.layers),
        ] {
            self.foreign(name, value.as_ref(), kind)?;
        }
        let given = self.needed("mesh.elements", mesh.elements.as_ref(), &mesh.kind.span(), kind)?;
        let elements = given.get_ref();
        let axes = size.len();
        let sound = elements.len() == axes && elements.iter().all(|&n| n > 0);
        let must = format!("{axes} numbers of at least 1, as mesh.size has {axes} lengths");
        self.demand(sound, "mesh.elements", given, &must, "give the numbers of elements along each axis")?;
        let all = elements.iter().try_fold(1_i64, |all, &n| all.checked_mul(n));
        let few = all.is_some_and(|n| n <= MOST_ELEMENTS);
        self.demand(few, "mesh.elements", given, "at most 50 million in all", "use a coarser mesh")?;
        let elements = elements.iter().map(|&n| n as usize).collect();
        Ok(Mesh::Block { elements, grading: self.grading(mesh, axes)?, cells: self.cells(mesh, axes)?, size })
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

    /// The size of a mesh that is made here.
    fn size(&self, mesh: &document::Mesh, kind: &str) -> Result<Vec<f64>, SceneError> {
        self.foreign("mesh.file", mesh.file.as_ref(), kind)?;
        self.foreign("mesh.scale", mesh.scale.as_ref(), kind)?;
        let given = self.needed("mesh.size", mesh.size.as_ref(), &mesh.kind.span(), kind)?;
        let size = self.components("mesh.size", given)?;
        let sound = size.iter().all(|&x| x > 0.0);
        let help = "give width and height in m, in three dimensions the lengths along x, y and z";
        self.demand(sound, "mesh.size", given, "positive lengths", help)?;
        Ok(size)
    }

    fn gmsh(&self, mesh: &document::Mesh) -> Result<Mesh, SceneError> {
        let kind = "a mesh from Gmsh";
        self.foreign("mesh.size", mesh.size.as_ref(), kind)?;
        self.foreign("mesh.elements", mesh.elements.as_ref(), kind)?;
        self.foreign("mesh.cells", mesh.cells.as_ref(), kind)?;
        self.foreign("mesh.grading", mesh.grading.as_ref(), kind)?;
        self.foreign("mesh.contact_width", mesh.contact_width.as_ref(), kind)?;
        for (name, value) in [
            ("mesh.contact_elements", &mesh.contact_elements),
            ("mesh.outer_elements", &mesh.outer_elements),
            ("mesh.layers", &mesh.layers),
        ] {
            self.foreign(name, value.as_ref(), kind)?;
        }
        let file = self.needed("mesh.file", mesh.file.as_ref(), &mesh.kind.span(), kind)?;
        let Some(given) = &mesh.scale else {
            return Ok(Mesh::Gmsh { file: self.source.beside(file.get_ref()), scale: 1.0 });
        };
        let scale = self.finite("mesh.scale", given)?;
        let help = "give the length of the file's unit in m, 0.001 for mm";
        self.demand(scale > 0.0, "mesh.scale", given, "positive", help)?;
        Ok(Mesh::Gmsh { file: self.source.beside(file.get_ref()), scale })
    }

    fn grading(&self, mesh: &document::Mesh, axes: usize) -> Result<Vec<f64>, SceneError> {
        let Some(given) = &mesh.grading else { return Ok(vec![1.0; axes]) };
        let grading = given.get_ref();
        let sound = grading.len() == axes && grading.iter().all(|ratio| (1e-6..=1e6).contains(ratio));
        let help = "give the size of the last element over that of the first, along each axis";
        self.demand(sound, "mesh.grading", given, &format!("{axes} ratios from 1e-6 to 1e6"), help)?;
        Ok(grading.clone())
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
        let [width, height] = self.size(mesh, kind)?[..] else {
            return self.fail(mesh.kind.span(), "a half-plane has two dimensions", "give mesh.size as [width, height]");
        };
        let size = [width, height];
        self.foreign("mesh.elements", mesh.elements.as_ref(), kind)?;
        self.foreign("mesh.cells", mesh.cells.as_ref(), kind)?;
        self.foreign("mesh.grading", mesh.grading.as_ref(), kind)?;
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
