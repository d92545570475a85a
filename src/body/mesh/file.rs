//! Meshes from files: Gmsh, Abaqus and CalculiX, and the universal format (UNV).
//!
//! Each format is parsed to one [`raw::RawMesh`] of nodes, elements and named groups. The dimension is that of the
//! highest-dimensional elements. Groups of that dimension become material groups, groups of one dimension less become
//! boundaries.
//!
//! The readers are written here because those of crates (mshio 0.4) panic or take memory without bound on damaged files.

mod abaqus;
mod gmsh;
mod groups;
mod raw;
mod sides;
mod unv;

use std::fmt;
use std::io;
use std::path::{Path, PathBuf};

use super::check::Numbers;
use super::{Mesh, MeshFault};
use raw::RawMesh;

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
        let (mut mesh, cells) = groups::mesh(&mut raw, name, self)?;
        let numbers = Numbers { cells: &cells, nodes: &raw.numbers };
        mesh.check_cells(&numbers).map_err(unsound)?;
        groups::boundaries(&mut mesh, &raw);
        for x in mesh.nodes.iter_mut().flatten() {
            *x *= scale;
        }
        Ok(mesh)
    }

    fn raw(self, name: &str, bytes: &[u8]) -> Result<RawMesh, MeshFormatError> {
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
pub(crate) fn faces(name: &str, bytes: &[u8]) -> Result<Vec<Vec<[f64; 3]>>, MeshFormatError> {
    let file = gmsh::read(name, bytes)?;
    let faces = file.blocks.iter().filter(|block| block.kind.dimension() == 2).flat_map(|block| {
        block.elements.iter().flat_map(|(_, nodes)| match nodes[..] {
            [a, b, c, ab, bc, ca] => vec![vec![a, ab, ca], vec![ab, b, bc], vec![bc, c, ca], vec![ab, bc, ca]],
            _ => vec![nodes.clone()],
        })
    });
    Ok(faces.map(|nodes| nodes.iter().map(|&node| file.nodes[node]).collect()).collect())
}
