//! Sources of meshes: generated, read from a file, or given.

use std::collections::BTreeMap;
use std::fmt::{self, Write};
use std::path::PathBuf;
use std::sync::Arc;

use super::block::{graded_block, half_plane, progression};
use super::bodies::{append, of_body};
use super::{Boundary, CellKind, Facet, Mesh, MeshFileError, MeshFormat};
use crate::algebra::vector::{Vector, plus};
use crate::base::input_error::{InputError, ensure, finite, in_one_line, not_huge, positive};

/// The source of a mesh. Lengths are in m.
#[derive(Debug, Clone, PartialEq)]
pub enum MeshSource {
    /// A rectangle or box.
    Block {
        /// The segments along x, y and, in three dimensions, z.
        axes: Vec<Vec<Segment>>,
        /// The kind of the cells; triangles and tetrahedra divide the elements.
        cells: CellKind,
        /// The lowest corner, m, such as `[r, 0]` for a ring of the inner radius r; default: the origin.
        origin: Option<Vector>,
    },
    /// A rectangle that approximates a half-plane pressed at the left end of its top.
    HalfPlane(HalfPlane),
    /// A mesh from a file.
    File {
        /// The format of the file.
        format: MeshFormat,
        /// The file.
        file: PathBuf,
        /// The length of the file's unit, m.
        scale: f64,
    },
    /// A mesh in memory; see [`Mesh::new`].
    Given(Arc<Mesh>),
    /// Several bodies, each with its own mesh.
    Bodies(Vec<Body>),
}

/// A length divided into elements in geometric progression.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Segment {
    /// The length, m.
    pub length: f64,
    /// The number of elements.
    pub elements: usize,
    /// The size of the last element divided by that of the first.
    pub grading: f64,
}

/// A rectangle with a fine mesh under a contact zone at the left end of its top and a coarser mesh elsewhere: half of a
/// body that is symmetric about its left side.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct HalfPlane {
    /// Width and height, m.
    pub size: [f64; 2],
    /// Width of the contact zone, m.
    pub contact_width: f64,
    /// The number of equal elements along the contact zone.
    pub contact_elements: usize,
    /// The number of equal elements along the rest of the top.
    pub outer_elements: usize,
    /// The number of layers of elements, in geometric progression from the top layer, whose elements are square in the
    /// contact zone, to the bottom.
    pub layers: usize,
}

/// One of several bodies, with its own mesh.
#[derive(Debug, Clone, PartialEq)]
pub struct Body {
    /// The name of the body, without a colon. Its boundaries are called `name:boundary`, its groups `name:group`; the
    /// only group of a mesh without named groups is called `name`.
    pub name: String,
    /// Its mesh.
    pub mesh: MeshSource,
    /// The position of the origin of the mesh, m; default: not moved.
    pub at: Option<Vector>,
}

impl Body {
    /// Creates the body `name` at the position of its mesh.
    pub fn new(name: &str, mesh: impl Into<MeshSource>) -> Self {
        Body { name: name.to_string(), mesh: mesh.into(), at: None }
    }

    /// Sets the position of the origin of the mesh (m).
    #[must_use]
    pub fn at(self, at: impl Into<Vector>) -> Self {
        Body { at: Some(at.into()), ..self }
    }
}

/// The error of a source that yields no mesh.
#[derive(Debug, thiserror::Error, miette::Diagnostic)]
pub enum MeshError {
    /// A value of the source is invalid.
    #[error(transparent)]
    #[diagnostic(transparent)]
    Source(#[from] InputError),
    /// The mesh file is invalid.
    #[error(transparent)]
    #[diagnostic(transparent)]
    File(#[from] MeshFileError),
}

/// The largest number of elements; a larger mesh is an input error, since its matrix would not fit into memory.
const MAX_ELEMENTS: usize = 50_000_000;

/// The values of each axis, formatted as in a scene: a list only if there are several segments.
struct Axes<T>(Vec<Vec<T>>);

impl<T: fmt::Debug> fmt::Debug for Axes<T> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let mut list = f.debug_list();
        for axis in &self.0 {
            match &axis[..] {
                [one] => list.entry(one),
                all => list.entry(&all),
            };
        }
        list.finish()
    }
}

impl From<Mesh> for MeshSource {
    fn from(mesh: Mesh) -> Self {
        MeshSource::Given(Arc::new(mesh))
    }
}

impl MeshSource {
    /// Creates a rectangle or box of `size` (m) with `elements` equal quadrilaterals or hexahedra along each axis. Its
    /// boundaries are those of [`super::block`].
    pub fn block<const D: usize>(size: [f64; D], elements: [usize; D]) -> Self {
        let axis = |k: usize| vec![Segment { length: size[k], elements: elements[k], grading: 1.0 }];
        MeshSource::Block { axes: (0..D).map(axis).collect(), cells: CellKind::of_block(D), origin: None }
    }

    /// Creates a rectangle or box whose axes have segments of the lengths `size` (m) with `elements` elements each, in
    /// geometric progression by `grading` (default: equal); the default of `cells` is quadrilaterals or hexahedra.
    ///
    /// # Errors
    /// If the lists do not match, and as [`MeshSource::check`].
    pub fn segmented(
        size: &[Vec<f64>],
        elements: &[Vec<usize>],
        grading: Option<&[Vec<f64>]>,
        cells: Option<CellKind>,
    ) -> Result<Self, InputError> {
        check_size(size)?;
        like_size("mesh.elements", elements, size)?;
        let equal: Vec<Vec<f64>> = size.iter().map(|axis| vec![1.0; axis.len()]).collect();
        let grading = grading.unwrap_or(&equal);
        like_size("mesh.grading", grading, size)?;
        let axes = (size.iter().zip(elements).zip(grading)).map(|((lengths, elements), grading)| {
            let segments = lengths.iter().zip(elements).zip(grading);
            segments.map(|((&length, &elements), &grading)| Segment { length, elements, grading }).collect()
        });
        let cells = cells.unwrap_or(CellKind::of_block(size.len()));
        let source = MeshSource::Block { axes: axes.collect(), cells, origin: None };
        source.check()?;
        Ok(source)
    }

    /// Checks the source as far as possible without reading a file.
    ///
    /// # Errors
    /// [`InputError`] with the key of the wrong value, such as `mesh.size`; for a given mesh, `mesh`.
    pub fn check(&self) -> Result<(), InputError> {
        match self {
            MeshSource::Block { axes, cells, origin } => check_block(axes, *cells, *origin),
            MeshSource::HalfPlane(half_plane) => half_plane.check(),
            MeshSource::File { scale, .. } => {
                finite("mesh.scale", *scale)?;
                let help = "give the length of the file's unit in m, 0.001 for mm, or in the unit of [units]";
                ensure(*scale > 0.0, "mesh.scale", scale, "positive", help)
            }
            MeshSource::Given(mesh) => {
                mesh.check().map_err(|fault| InputError::new("mesh", fault.to_string(), fault.help()))
            }
            MeshSource::Bodies(bodies) => check_bodies(bodies),
        }
    }

    /// Generates or reads the mesh.
    ///
    /// # Errors
    /// As [`MeshSource::check`], and if the file cannot be read or its mesh is invalid.
    pub fn build(&self) -> Result<Arc<Mesh>, MeshError> {
        self.check()?;
        self.made()
    }

    /// Generates or reads the mesh of a checked source.
    pub(crate) fn made(&self) -> Result<Arc<Mesh>, MeshError> {
        let mesh = match self {
            MeshSource::Block { axes, cells, origin } => {
                let lines: Vec<Vec<f64>> = axes.iter().map(|segments| mesh_lines(segments)).collect();
                let mut mesh = match &lines[..] {
                    [xs, ys] => graded_block(xs, ys, None),
                    [xs, ys, zs] => graded_block(xs, ys, Some(zs)),
                    _ => return Err(MeshError::Source(no_dimension(&lines))),
                };
                add_parts_of_sides(&mut mesh, axes);
                if let Some(origin) = origin.map(Vector::components) {
                    mesh.nodes.iter_mut().for_each(|x| *x = plus(*x, 1.0, origin));
                }
                let mesh = match cells {
                    _ if cells.is_prism() => mesh.into_prisms(),
                    _ if cells.is_simplex() => mesh.into_simplices(),
                    _ => mesh,
                };
                match cells {
                    CellKind::Quadrilateral9 => mesh.with_centres(),
                    _ if cells.is_quadratic() => mesh.into_second_order(),
                    _ => mesh,
                }
            }
            MeshSource::HalfPlane(m) => {
                half_plane(m.size, m.contact_width, m.contact_elements, m.outer_elements, m.layers)
            }
            MeshSource::File { format, file, scale } => format.read(file, *scale)?,
            MeshSource::Given(mesh) => return Ok(Arc::clone(mesh)),
            MeshSource::Bodies(bodies) => joined(bodies)?,
        };
        Ok(Arc::new(mesh))
    }

    /// Returns the files that the mesh files include, as far as they can be read.
    pub(crate) fn includes(&self) -> Vec<PathBuf> {
        match self {
            MeshSource::File { format, file, .. } => format.includes(file),
            MeshSource::Bodies(bodies) => bodies.iter().flat_map(|body| body.mesh.includes()).collect(),
            MeshSource::Block { .. } | MeshSource::HalfPlane(_) | MeshSource::Given(_) => Vec::new(),
        }
    }

    /// Returns the number of nodes and the dimension; `None` if they are unknown before a file is read.
    pub fn nodes(&self) -> Option<(usize, usize)> {
        match self {
            MeshSource::Block { axes, cells, .. } => {
                let along = |axis: &Vec<Segment>| axis.iter().map(|segment| segment.elements).sum::<usize>();
                let elements: Vec<usize> = axes.iter().map(along).collect();
                let lattice = |each: usize| elements.iter().map(|n| 1 + each * n).product::<usize>();
                let nodes = match (cells, &elements[..]) {
                    _ if !cells.is_quadratic() => lattice(1),
                    // The points of a lattice twice as fine, but for the centres of elements and of their sides.
                    (CellKind::Quadrilateral8, _) => lattice(2) - elements.iter().product::<usize>(),
                    (CellKind::Hexahedron20 | CellKind::Prism15, &[x, y, z]) => {
                        let upright = x * z * (y + 1) + y * z * (x + 1);
                        let level = if *cells == CellKind::Prism15 { 0 } else { x * y * (z + 1) };
                        lattice(2) - x * y * z - upright - level
                    }
                    _ => lattice(2),
                };
                Some((nodes, axes.len()))
            }
            MeshSource::HalfPlane(m) => Some(((m.contact_elements + m.outer_elements + 1) * (m.layers + 1), 2)),
            MeshSource::File { .. } => None,
            MeshSource::Given(mesh) => Some((mesh.nodes.len(), mesh.dimension)),
            MeshSource::Bodies(bodies) => {
                let each: Option<Vec<(usize, usize)>> = bodies.iter().map(|body| body.mesh.nodes()).collect();
                let each = each?;
                Some((each.iter().map(|(nodes, _)| nodes).sum(), each.first()?.1))
            }
        }
    }
}

const LENGTHS: &str = "give width and height in m or as [units] says, in three dimensions the lengths along x, y and z";

fn check_size(size: &[Vec<f64>]) -> Result<(), InputError> {
    if !(2..=3).contains(&size.len()) {
        return Err(no_dimension(size));
    }
    let is_valid = size.iter().all(|axis| !axis.is_empty() && axis.iter().all(|&x| x > 0.0 && x.is_finite()));
    ensure(is_valid, "mesh.size", &Axes(size.to_vec()), "positive finite lengths", LENGTHS)?;
    size.iter().flatten().try_for_each(|&length| positive("mesh.size", length, LENGTHS))
}

/// Returns the error of a block with a wrong number of axes.
fn no_dimension(size: &[Vec<f64>]) -> InputError {
    let message = format!("mesh.size is {:?}, but must be two or three lengths", Axes(size.to_vec()));
    InputError::new("mesh.size", message, LENGTHS)
}

/// Checks that a list has a value for each length in `size`.
fn like_size<T: Clone + fmt::Debug>(key: &str, values: &[Vec<T>], size: &[Vec<f64>]) -> Result<(), InputError> {
    let is_valid = values.iter().map(Vec::len).eq(size.iter().map(Vec::len));
    let help = "mesh.size says how many segments there are along each axis";
    ensure(is_valid, key, &Axes(values.to_vec()), "a number for each length in mesh.size", help)
}

fn check_block(axes: &[Vec<Segment>], cells: CellKind, origin: Option<Vector>) -> Result<(), InputError> {
    fn each<T>(axes: &[Vec<Segment>], value: fn(&Segment) -> T) -> Vec<Vec<T>> {
        axes.iter().map(|axis| axis.iter().map(value).collect()).collect()
    }
    check_size(&each(axes, |segment| segment.length))?;
    let elements = Axes(each(axes, |segment| segment.elements));
    let help = "give the numbers of elements along each axis";
    let is_valid = elements.0.iter().flatten().all(|&n| n > 0);
    ensure(is_valid, "mesh.elements", &elements, "numbers of at least 1", help)?;
    let along = |axis: &Vec<usize>| axis.iter().try_fold(0_usize, |sum, &n| sum.checked_add(n));
    let all = elements.0.iter().try_fold(1_usize, |all, axis| all.checked_mul(along(axis)?));
    let few = all.is_some_and(|n| n <= MAX_ELEMENTS);
    ensure(few, "mesh.elements", &elements, "at most 50 million in all", "use a coarser mesh")?;
    let grading = Axes(each(axes, |segment| segment.grading));
    let help = "give the size of the last element over that of the first, along each axis";
    let is_valid = grading.0.iter().flatten().all(|ratio| (1e-6..=1e6).contains(ratio));
    ensure(is_valid, "mesh.grading", &grading, "ratios from 1e-6 to 1e6", help)?;
    if let Some(origin) = origin {
        let is_valid = origin.dimension() == axes.len() && origin.components().iter().all(|c| c.is_finite());
        let help = "give the lowest corner of the block, such as [0.1, 0]";
        ensure(is_valid, "mesh.origin", &origin, "a finite number for each axis of mesh.size", help)?;
        not_huge("mesh.origin", origin.components())?;
    }
    if cells.dimension() == axes.len() {
        return Ok(());
    }
    let message = format!("mesh.cells have {} dimensions, but mesh.size has {}", cells.dimension(), axes.len());
    let help = "use \"triangle\", \"triangle6\", \"quadrilateral\", \"quadrilateral8\" or \"quadrilateral9\" in two dimensions, \
                \"tetrahedron\", \"tetrahedron10\", \"prism\", \"prism15\", \"hexahedron\" or \"hexahedron20\" in three";
    Err(InputError::new("mesh.cells", message, help))
}

impl HalfPlane {
    fn check(&self) -> Result<(), InputError> {
        check_size(&self.size.map(|length| vec![length]))?;
        let (key, width) = ("mesh.contact_width", self.contact_width);
        finite(key, width)?;
        let must = "positive and less than the width of the mesh";
        let help = "give the contact zone in m or as [units] says";
        ensure(width > 0.0 && width < self.size[0], key, &width, must, help)?;
        let (contact, outer, layers) = (self.contact_elements, self.outer_elements, self.layers);
        for (key, n) in [("mesh.contact_elements", contact), ("mesh.outer_elements", outer), ("mesh.layers", layers)] {
            let must = "at least 1 and at most 50 million";
            ensure((1..=MAX_ELEMENTS).contains(&n), key, &n, must, "give a number of elements")?;
        }
        if (contact + outer).checked_mul(layers).is_none_or(|n| n > MAX_ELEMENTS) {
            return Err(InputError::new("mesh", "the mesh has more than 50 million elements", "use a coarser mesh"));
        }
        Ok(())
    }
}

/// Returns the ends of the elements of consecutive `segments`, m.
fn mesh_lines(segments: &[Segment]) -> Vec<f64> {
    let mut lines = vec![0.0];
    let mut end = 0.0;
    for &Segment { length, elements, grading } in segments {
        lines.extend(progression(length, elements, grading)[1..].iter().map(|x| end + x));
        end += length;
    }
    lines
}

/// Adds the parts of the sides of a block between ends of segments as boundaries: `top-1`, `top-2` and so on along an axis
/// with several segments, `top-1-2` along two such axes. The lowest corner of the block is the origin.
fn add_parts_of_sides(mesh: &mut Mesh, axes: &[Vec<Segment>]) {
    let mut parts = BTreeMap::<String, Vec<Facet>>::new();
    for Boundary { name, facets } in &mesh.boundaries {
        for facet in facets {
            let mut part = name.clone();
            for (k, segments) in axes.iter().enumerate().filter(|(_, segments)| segments.len() > 1) {
                let coordinates = || facet.iter().map(|&node| mesh.nodes[node][k]);
                let (low, high) = (coordinates().fold(f64::INFINITY, f64::min), coordinates().fold(0.0, f64::max));
                if low < high {
                    let ends = segments.iter().scan(0.0, |end, segment| {
                        *end += segment.length;
                        Some(*end)
                    });
                    let _ = write!(part, "-{}", 1 + ends.filter(|end| *end <= low).count());
                }
            }
            if part != *name {
                parts.entry(part).or_default().push(facet.clone());
            }
        }
    }
    mesh.boundaries.extend(parts.into_iter().map(|(name, facets)| Boundary { name, facets }));
}

fn no_body() -> InputError {
    InputError::new("body", "there is no body", "give one at least")
}

/// Checks that `bodies` can be joined in one mesh, as far as possible without reading files.
fn check_bodies(bodies: &[Body]) -> Result<(), InputError> {
    if bodies.is_empty() {
        return Err(no_body());
    }
    let mut plane_or_not: Option<(usize, &str)> = None;
    for (k, Body { name, mesh, at }) in bodies.iter().enumerate() {
        let key = |what: &str| format!("body[{k}].{what}");
        in_one_line("a body", name, "give a name such as \"ring\"")
            .map_err(|fault| fault.with_key(&format!("body[{k}]")))?;
        if name.contains(':') {
            let message = format!("the name of the body is {name:?}, but must have no colon");
            return Err(InputError::new(key("name"), message, "its boundaries will be called `name:boundary`"));
        }
        if bodies[..k].iter().any(|other| other.name == *name) {
            let message = format!("another body is called `{name}`");
            return Err(InputError::new(key("name"), message, "give every body a name of its own"));
        }
        if let MeshSource::Bodies(_) = mesh {
            let message = format!("the body `{name}` is made of bodies");
            return Err(InputError::new(key("mesh"), message, "list all bodies side by side"));
        }
        mesh.check().map_err(|fault| fault.with_key(&format!("body[{k}]")))?;
        let dimension = mesh.nodes().map(|(_, dimension)| dimension);
        if let Some(at) = at {
            let is_valid = at.components().iter().all(|c| c.is_finite());
            let is_valid = is_valid && dimension.is_none_or(|dimension| dimension == at.dimension());
            let help = "give where the origin of the body's mesh is put, such as [0, 0.5]";
            ensure(is_valid, &key("at"), at, "a finite number for each dimension of the body", help)?;
            not_huge(&key("at"), at.components())?;
        }
        let known = dimension.or(at.map(Vector::dimension));
        match (plane_or_not, known) {
            (Some((first, of)), Some(other)) if first != other => {
                let message = format!("`{name}` has {other} dimensions, but `{of}` has {first}");
                return Err(InputError::new(key("mesh"), message, "let all bodies be plane, or all have a volume"));
            }
            (None, Some(dimension)) => plane_or_not = Some((dimension, name)),
            _ => {}
        }
    }
    Ok(())
}

/// Joins checked `bodies` in one mesh.
fn joined(bodies: &[Body]) -> Result<Mesh, MeshError> {
    let mut all: Option<Mesh> = None;
    for (k, Body { name, mesh, at }) in bodies.iter().enumerate() {
        let under = |fault: InputError| MeshError::Source(fault.with_key(&format!("body[{k}]")));
        let mesh = mesh.made().map_err(|error| match error {
            MeshError::Source(fault) => under(fault),
            file @ MeshError::File(_) => file,
        })?;
        let mesh = of_body(Arc::unwrap_or_clone(mesh), name, *at);
        match &mut all {
            None => all = Some(mesh),
            Some(all) => append(all, name, mesh).map_err(under)?,
        }
    }
    Ok(all.ok_or_else(no_body)?)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::algebra::vector::norm;

    /// The areas of the parts of a side, by name; of hexahedra, tetrahedra and elements of second order.
    #[test]
    fn parts_of_sides_lie_between_the_ends_of_segments() {
        let segments = |lengths: &[f64]| {
            let segment = |length: &f64| Segment { length: *length, elements: 2, grading: 1.5 };
            lengths.iter().map(segment).collect::<Vec<_>>()
        };
        let axes = vec![segments(&[0.1, 0.2]), segments(&[0.4]), segments(&[0.3, 0.1, 0.7])];
        for cells in [CellKind::Hexahedron, CellKind::Tetrahedron10] {
            let source = MeshSource::Block { axes: axes.clone(), cells, origin: Some([1.0, 2.0, 3.0].into()) };
            let mesh = source.build().unwrap();
            let area = |name: &str| {
                let facets = &mesh.boundary(name).unwrap().facets;
                facets.iter().map(|facet| norm(mesh.area_vector(facet))).sum::<f64>()
            };
            let parts = [("top-1", 0.1, 0.4), ("top-2", 0.2, 0.4), ("left-3", 0.4, 0.7), ("front-2-1", 0.2, 0.3)];
            for (name, a, b) in parts {
                assert!((area(name) - a * b).abs() < 1e-15, "{name}");
            }
            let of = |name: &str| mesh.boundaries.iter().filter(|part| part.name.starts_with(name)).count();
            assert_eq!(["bottom", "right", "back"].map(of), [3, 4, 7]);
        }
        let plain = MeshSource::block([1.0, 2.0], [2, 3]).build().unwrap();
        assert_eq!(plain.boundaries.len(), 4);
    }
}
