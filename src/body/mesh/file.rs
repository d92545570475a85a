//! Meshes from files: Gmsh, Abaqus and CalculiX, and the universal format (UNV).
//!
//! Each format is parsed to one [`raw::RawMesh`] of nodes, elements and named groups. The dimension is that of the
//! highest-dimensional elements. Groups of that dimension become material groups, groups of one dimension less become
//! boundaries.
//!
//! The readers are written here because those of crates (mshio 0.4) panic or take memory without bound on damaged files.

mod abaqus;
mod gmsh;
mod raw;
mod unv;

use std::collections::{HashMap, HashSet};
use std::path::{Path, PathBuf};
use std::{fmt, io};

use super::check::Numbers;
use super::sides::Outline;
use super::{Cell, Facet, Geometry, Mesh, MeshFault, Notes};
use crate::base::input::FileKind;
pub(crate) use abaqus::{Data as AbaqusData, Keyword as AbaqusKeyword, keywords as abaqus_keywords};
use raw::{Block, ElementKind, RawMesh, SAME_PLACE};

/// The formats of mesh files.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum MeshFormat {
    /// Gmsh: MSH 2.2 and 4.1, text and binary, and MSH 4.0, text.
    Gmsh,
    /// The input file of Abaqus and CalculiX.
    Abaqus,
    /// The universal format of I-DEAS and Salome, text.
    Unv,
}

/// The error of a mesh file that cannot be used.
#[derive(Debug, thiserror::Error, miette::Diagnostic)]
pub enum MeshFileError {
    /// The file cannot be read.
    #[error("{path}: the mesh cannot be read: {error}")]
    #[diagnostic(help("name an existing mesh file; paths are relative to the scene file"))]
    Io {
        /// The file.
        path: String,
        /// The error of the operating system; it is not a `source` because the message already contains it.
        error: io::Error,
    },
    /// The file is not a mesh in the expected format.
    #[error(transparent)]
    #[diagnostic(transparent)]
    Format(#[from] MeshFormatError),
    /// The mesh in the file is invalid.
    #[error("{file}: {fault}")]
    #[diagnostic(help("{}", fault.help()))]
    Unsound {
        /// The file.
        file: String,
        /// The fault.
        fault: MeshFault,
    },
}

/// The content of a mesh file, or the fault in it.
pub(crate) type Parsed<T> = Result<T, MeshFormatError>;

/// An error at a place in a mesh file.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error, miette::Diagnostic)]
#[error("{file}:{place}: {message}")]
#[diagnostic(help("{help}"))]
pub struct MeshFormatError {
    /// The file.
    pub file: String,
    /// The place in it.
    pub place: Place,
    /// The fault.
    pub message: String,
    /// The correction that the message proposes.
    pub help: String,
}

/// A place in a file.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Place {
    /// A line of a text, from 1.
    Line(usize),
    /// A byte of a binary file, from 0.
    Byte(usize),
}

impl MeshFormatError {
    fn new(file: &str, place: Place, message: impl Into<String>, help: impl Into<String>) -> Self {
        MeshFormatError { file: file.to_string(), place, message: message.into(), help: help.into() }
    }
}

/// Fails if the `bytes` of the file `name` are of another kind than the one `needed`.
fn expect(name: &str, bytes: &[u8], needed: FileKind) -> Parsed<()> {
    let Some(kind) = FileKind::of(bytes).filter(|kind| *kind != needed) else { return Ok(()) };
    let message = format!("it is {}, but {} is needed", kind.name(), needed.name());
    Err(MeshFormatError::new(name, Place::Line(1), message, kind.as_mesh()))
}

impl fmt::Display for Place {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Place::Line(line) => write!(f, "{line}"),
            Place::Byte(byte) => write!(f, "byte {byte}"),
        }
    }
}

impl MeshFormat {
    /// Reads the file at `path`; `scale` is the length of the file's unit in m.
    ///
    /// Cells with the wrong orientation are renumbered. Nodes that belong to no cell are left out. A plane mesh may lie
    /// in any of the three coordinate planes. A group that cannot be a boundary, for example because it is inside the
    /// body, is recorded in [`Mesh::notes`]. Inverted or degenerate cells are an error.
    ///
    /// # Errors
    /// If the file cannot be read, is not in this format, contains cells other than those of [`super::CellKind`], or is
    /// an invalid mesh; with line, byte or element numbers.
    pub fn read(self, path: &Path, scale: f64) -> Result<Mesh, MeshFileError> {
        let name = path.display().to_string();
        let bytes =
            crate::base::input::read_bytes(path).map_err(|error| MeshFileError::Io { path: name.clone(), error })?;
        self.parse(&name, &bytes, scale)
    }

    /// Reads the mesh in the `bytes` of a file; messages name the file `name`. Files that it includes are read from the
    /// folder of `name`.
    ///
    /// # Errors
    /// As [`MeshFormat::read`], except for reading the file.
    pub fn parse(self, name: &str, bytes: &[u8], scale: f64) -> Result<Mesh, MeshFileError> {
        let mut raw = self.raw(name, bytes)?;
        let unsound = |fault| MeshFileError::Unsound { file: name.to_string(), fault };
        let (mut mesh, cells) = mesh(&mut raw, name, self)?;
        let numbers = Numbers { cells: &cells, nodes: &raw.numbers };
        mesh.check_cells(&numbers).map_err(unsound)?;
        boundaries(&mut mesh, &raw);
        for x in mesh.nodes.iter_mut().flatten() {
            *x *= scale;
        }
        Ok(mesh)
    }

    fn raw(self, name: &str, bytes: &[u8]) -> Parsed<RawMesh> {
        match self {
            MeshFormat::Gmsh => gmsh::read(name, bytes),
            MeshFormat::Abaqus => abaqus::read(name, bytes),
            MeshFormat::Unv => unv::read(name, bytes),
        }
    }

    /// Returns the files that the mesh file at `path` includes, as far as they can be read.
    pub(super) fn includes(self, path: &Path) -> Vec<PathBuf> {
        match self {
            MeshFormat::Gmsh | MeshFormat::Unv => Vec::new(),
            MeshFormat::Abaqus => abaqus::includes(path),
        }
    }
}

/// Reads the mesh in the bytes of a Gmsh file; see [`MeshFormat::parse`].
///
/// # Errors
/// As [`MeshFormat::parse`].
pub fn from_gmsh(name: &str, bytes: &[u8], scale: f64) -> Result<Mesh, MeshFileError> {
    MeshFormat::Gmsh.parse(name, bytes, scale)
}

/// Reads the corners of all faces, triangles and quadrilaterals, in the bytes of a Gmsh file, in its unit; triangles of
/// six nodes are divided into four flat ones. Messages name the file `name`.
pub(crate) fn faces(name: &str, bytes: &[u8]) -> Parsed<Vec<Vec<[f64; 3]>>> {
    let file = gmsh::read(name, bytes)?;
    let faces = file.blocks.iter().filter(|block| block.kind.dimension() == 2).flat_map(|block| {
        block.elements.iter().flat_map(|(_, nodes)| match nodes[..] {
            [a, b, c, ab, bc, ca] => vec![vec![a, ab, ca], vec![ab, b, bc], vec![bc, c, ca], vec![ab, bc, ca]],
            _ => vec![nodes.clone()],
        })
    });
    Ok(faces.map(|nodes| nodes.iter().map(|&node| file.nodes[node]).collect()).collect())
}

/// Creates the mesh without its boundaries; returns also the number of each cell in the file, whose name and format are
/// for messages.
fn mesh(file: &mut RawMesh, name: &str, format: MeshFormat) -> Parsed<(Mesh, Vec<usize>)> {
    let error = |message: String, help: &str| MeshFormatError::new(name, Place::Line(1), message, help);
    let dimension = file.blocks.iter().map(|block| block.kind.dimension()).max().unwrap_or(0);
    if dimension < 2 {
        let help = match format {
            MeshFormat::Gmsh => {
                "mesh the surfaces (gmsh -2) or volumes (gmsh -3), and put them in a physical group: where there are any \
                 groups, Gmsh writes nothing else"
            }
            MeshFormat::Abaqus => "let the file, or one that it includes, have *NODE and *ELEMENT",
            MeshFormat::Unv => "export the faces of a plane mesh, the volumes of a body in space, in the dataset 2412",
        };
        return Err(error("the file has no elements of two or three dimensions".to_string(), help));
    }
    let mut notes = Notes { remarks: std::mem::take(&mut file.remarks), ..Notes::default() };
    let unused = file.leave_out_unused_nodes(dimension);
    if unused > 0 {
        notes.remarks.push(match unused {
            1 => "1 node is left out: no element of the body has it".to_string(),
            _ => format!("{unused} nodes are left out: no element of the body has them"),
        });
    }
    let (mut cells, mut numbers, mut groups) = (Vec::new(), Vec::new(), Vec::<String>::new());
    let mut index_of = HashMap::new();
    for Block { kind, groups: names, elements } in &file.blocks {
        let ElementKind::Cell(kind) = *kind else { continue };
        if kind.dimension() < dimension {
            continue;
        }
        // Cells in no group form a group without a name.
        let mut names = names.clone();
        names.sort();
        let group = names.join("+");
        if names.len() > 1 && !notes.combined.iter().any(|(known, _)| *known == group) {
            notes.combined.push((group.clone(), names.clone()));
        }
        let group = *index_of.entry(group).or_insert_with_key(|group| {
            groups.push(group.clone());
            groups.len() - 1
        });
        for (number, nodes) in elements {
            cells.push(Cell { kind, nodes: nodes.clone(), group });
            numbers.push(*number);
        }
    }
    let mut nodes = file.nodes.clone();
    if dimension == 2 {
        let help = match format {
            MeshFormat::Gmsh => {
                "turn a plane mesh into the x-y plane of the file (x-z and y-z are read, too); a body in space needs volume \
                 elements: mesh it with gmsh -3 and put its volumes into a physical group, too, for where there are any \
                 groups, Gmsh writes nothing else"
            }
            MeshFormat::Abaqus => {
                "turn a plane mesh into the x-y plane of the file (x-z and y-z are read, too); a body in space needs volume \
                 elements, C3D4 or others"
            }
            MeshFormat::Unv => {
                "turn a plane mesh into the x-y plane of the file (x-z and y-z are read, too); a body in space needs volumes: \
                 mesh it in three dimensions and export it again"
            }
        };
        let axes = plane(file).map_err(|message| error(message, help))?;
        for x in &mut nodes {
            *x = [x[axes[0]], x[axes[1]], 0.0];
        }
        if axes != [0, 1] {
            let [first, second] = axes.map(|axis| ["x", "y", "z"][axis]);
            let remark =
                format!("the mesh lies in the {first}-{second} plane of its file: {first} is x here, {second} is y");
            notes.remarks.push(remark);
        }
    }
    let boundaries = Vec::new();
    let mut mesh = Mesh { dimension, geometry: Geometry::Cartesian, nodes, cells, groups, boundaries, notes };
    turn_over(&mut mesh);
    Ok((mesh, numbers))
}

/// Returns the axes of the coordinate plane that contains all nodes. The error is the reason, in words, why there is
/// none.
fn plane(file: &RawMesh) -> Result<[usize; 2], String> {
    let extent = file.nodes.iter().flatten().fold(0.0_f64, |m, x| m.max(x.abs()));
    let origin = file.nodes.first().copied().unwrap_or_default();
    let off = |axis: usize| file.nodes.iter().position(|x| (x[axis] - origin[axis]).abs() > SAME_PLACE * extent);
    match (off(2), off(1), off(0)) {
        (None, ..) => Ok([0, 1]),
        (_, None, _) => Ok([0, 2]),
        (.., None) => Ok([1, 2]),
        (Some(k), ..) => {
            let (node, z) = (file.numbers[k], file.nodes[k][2]);
            Err(format!("the mesh is a surface that is not plane: node {node} has z = {z}"))
        }
    }
}

/// Renumbers the cells with the wrong orientation. If a renumbered cell would overlap a neighbour, its node positions
/// are wrong instead of the order, and it remains as it was.
fn turn_over(mesh: &mut Mesh) {
    let inverted = |cell: &Cell| mesh.corner_volumes(cell).iter().all(|&(volume, _)| volume < 0.0);
    let turned: Vec<bool> = mesh.cells.iter().map(inverted).collect();
    let turn = |cells: &mut [Cell], which: &dyn Fn(usize) -> bool| {
        cells.iter_mut().enumerate().filter(|(e, _)| which(*e)).for_each(|(_, cell)| cell.turn_over());
    };
    turn(&mut mesh.cells, &|e| turned[e]);
    // If all cells are renumbered, no new overlaps arise.
    if turned.contains(&true) && turned.contains(&false) {
        let pairs = mesh.sides().err().unwrap_or_default();
        let overlapping: HashSet<usize> = pairs.into_iter().flat_map(|(a, b)| [a, b]).collect();
        turn(&mut mesh.cells, &|e| turned[e] && overlapping.contains(&e));
    }
}

/// Adds a boundary for each group of facets that can be a boundary.
fn boundaries(mesh: &mut Mesh, file: &RawMesh) {
    let mut named: Vec<(String, Vec<(usize, Facet)>)> = Vec::new();
    let mut index_of = HashMap::new();
    for block in file.blocks.iter().filter(|block| block.kind.dimension() + 1 == mesh.dimension) {
        for name in &block.groups {
            let k = *index_of.entry(name).or_insert_with(|| {
                named.push((name.clone(), Vec::new()));
                named.len() - 1
            });
            named[k].1.extend(block.elements.iter().cloned());
        }
    }
    let outline = Outline::new(&mesh.cells);
    for (name, facets) in named {
        match outline.boundary(&name, &facets) {
            Ok(boundary) => mesh.boundaries.push(boundary),
            Err(fault) => mesh.notes.unusable.push((name, fault)),
        }
    }
}
