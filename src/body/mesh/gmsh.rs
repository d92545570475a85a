//! Meshes from Gmsh files in the format MSH 4.1 (ASCII).
//!
//! The dimension is that of the highest-dimensional elements. Physical groups of that dimension become material groups,
//! groups of one dimension less become boundaries; the name of a group without one is its number. The format: Gmsh
//! reference manual, "MSH file format", version 4.1.

mod groups;
mod lines;
mod read;

use std::fmt;
use std::io;
use std::path::Path;

use super::check::Numbers;
use super::{CellKind, Mesh, MeshFault};

/// The error of a mesh file that cannot be used.
#[derive(Debug, thiserror::Error, miette::Diagnostic)]
pub enum MeshFileError {
    /// The file cannot be read.
    #[error("{path}: the mesh cannot be read: {error}")]
    #[diagnostic(help("name an existing Gmsh file; paths are relative to the scene file"))]
    Io {
        /// The file.
        path: String,
        /// The error of the operating system; it is not a `source` because the message already contains it.
        error: io::Error,
    },
    /// The file is not a mesh in the format MSH 4.1.
    #[error(transparent)]
    #[diagnostic(transparent)]
    Format(#[from] GmshError),
    /// The mesh in the file is invalid.
    #[error("{file}: {fault}")]
    #[diagnostic(help("{}", fault.help()))]
    Unsound {
        /// The file.
        file: String,
        /// What is wrong with it.
        fault: MeshFault,
    },
}

/// An error at a line of a Gmsh file.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error, miette::Diagnostic)]
#[error("{file}:{line}: {message}")]
#[diagnostic(help("{help}"))]
pub struct GmshError {
    /// The file.
    pub file: String,
    /// The line, from 1.
    pub line: usize,
    /// What is wrong.
    pub message: String,
    /// The correction that the message proposes.
    pub help: String,
}

/// The supported kinds of elements.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum ElementKind {
    Point,
    Line,
    /// A line with a node at its middle.
    Line3,
    Cell(CellKind),
}

impl ElementKind {
    /// Returns the kind for Gmsh's number of the type. The error is the name of an unsupported type.
    fn from_gmsh(number: i64) -> Result<Self, String> {
        Ok(match number {
            15 => ElementKind::Point,
            1 => ElementKind::Line,
            8 => ElementKind::Line3,
            _ => match (CellKind::ALL.into_iter().find(|kind| kind.properties().gmsh == number), number) {
                (Some(kind), _) => ElementKind::Cell(kind),
                (None, 7) => return Err("7 (pyramid)".to_string()),
                (None, 10 | 16) => return Err(format!("{number} (quadrilateral of second order)")),
                (None, 12 | 17) => return Err(format!("{number} (hexahedron of second order)")),
                (None, 13 | 14 | 18 | 19) => return Err(format!("{number} (prism or pyramid of second order)")),
                (None, 20..) => return Err(format!("{number} (third order or higher)")),
                _ => return Err(number.to_string()),
            },
        })
    }

    fn dimension(self) -> usize {
        match self {
            ElementKind::Point => 0,
            ElementKind::Line | ElementKind::Line3 => 1,
            ElementKind::Cell(kind) => kind.dimension(),
        }
    }

    fn nodes(self) -> usize {
        match self {
            ElementKind::Point => 1,
            ElementKind::Line => 2,
            ElementKind::Line3 => 3,
            ElementKind::Cell(kind) => kind.nodes(),
        }
    }
}

impl fmt::Display for ElementKind {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            ElementKind::Point => "point",
            ElementKind::Line => "line",
            ElementKind::Line3 => "line of three nodes",
            ElementKind::Cell(kind) => kind.name(),
        })
    }
}

/// Reads the Gmsh file at `path`; `scale` is the length of the file's unit in m.
///
/// Cells with the wrong orientation are renumbered. Nodes that belong to no cell are left out. A plane mesh may lie in
/// any of the three coordinate planes. A physical group that cannot be a boundary, for example because it is inside the
/// body, is recorded in [`Mesh::notes`]. Inverted or degenerate cells are an error.
///
/// # Errors
/// If the file cannot be read, is not MSH 4.1 in ASCII, contains cells other than those of [`CellKind`], or is an
/// invalid mesh; with line or element numbers.
pub fn gmsh(path: &Path, scale: f64) -> Result<Mesh, MeshFileError> {
    let name = path.display().to_string();
    let bytes =
        crate::base::input::read_bytes(path).map_err(|error| MeshFileError::Io { path: name.clone(), error })?;
    from_gmsh(&name, &bytes, scale)
}

/// Reads the mesh in the text of a Gmsh file; messages name the file `name`.
///
/// # Errors
/// As [`gmsh`], except for reading the file.
pub fn from_gmsh(name: &str, bytes: &[u8], scale: f64) -> Result<Mesh, MeshFileError> {
    let mut file = read::read(name, bytes)?;
    let unsound = |fault| MeshFileError::Unsound { file: name.to_string(), fault };
    let (mut mesh, cells) = groups::mesh(&mut file, name)?;
    let numbers = Numbers { cells: &cells, nodes: &file.numbers };
    mesh.check_cells(&numbers).map_err(unsound)?;
    groups::boundaries(&mut mesh, &file);
    for x in mesh.nodes.iter_mut().flatten() {
        *x *= scale;
    }
    Ok(mesh)
}

/// Reads the corners of all faces, triangles and quadrilaterals, in the text of a Gmsh file, in its unit; triangles of
/// six nodes are divided into four flat ones. Messages name the file `name`.
pub(crate) fn faces(name: &str, bytes: &[u8]) -> Result<Vec<Vec<[f64; 3]>>, GmshError> {
    let file = read::read(name, bytes)?;
    let faces = file.blocks.iter().filter(|block| block.kind.dimension() == 2).flat_map(|block| {
        block.elements.iter().flat_map(|(_, nodes)| match nodes[..] {
            [a, b, c, ab, bc, ca] => vec![vec![a, ab, ca], vec![ab, b, bc], vec![bc, c, ca], vec![ab, bc, ca]],
            _ => vec![nodes.clone()],
        })
    });
    Ok(faces.map(|nodes| nodes.iter().map(|&node| file.nodes[node]).collect()).collect())
}
