//! Triangles from files: STL, ASCII or binary, and the faces of a Gmsh file.

use std::io;
use std::path::Path;

use crate::base::input::FileKind;
use crate::body::mesh::{MeshFormatError, faces};

/// The error of a surface file that cannot be used.
#[derive(Debug, thiserror::Error)]
pub enum SurfaceError {
    /// The file cannot be read.
    #[error("{file}: the surface cannot be read: {error}")]
    Io {
        /// The file.
        file: String,
        /// The error of the operating system.
        error: io::Error,
    },
    /// A line of an STL file is invalid.
    #[error("{file}:{line}: {message}")]
    Line {
        /// The file.
        file: String,
        /// The line, from 1.
        line: usize,
        /// The fault.
        message: String,
    },
    /// The Gmsh file cannot be read.
    #[error(transparent)]
    Gmsh(#[from] MeshFormatError),
    /// The triangles do not form a surface.
    #[error("{file}: {message}")]
    Unsound {
        /// The file.
        file: String,
        /// The fault.
        message: String,
    },
}

type Corners = [[f64; 3]; 3];

/// Reads the corners of all triangles of the file at `path`, in the unit of the file.
pub(super) fn corners(path: &Path) -> Result<Vec<Corners>, SurfaceError> {
    let file = path.display().to_string();
    let bytes = crate::base::input::read_bytes(path).map_err(|error| SurfaceError::Io { file: file.clone(), error })?;
    parse(&file, &bytes)
}

/// Reads the corners of all triangles from the `bytes` of a file.
fn parse(file: &str, bytes: &[u8]) -> Result<Vec<Corners>, SurfaceError> {
    let text = bytes.trim_ascii_start();
    if text.starts_with(b"$MeshFormat") {
        let halves = |face: Vec<[f64; 3]>| (2..face.len()).map(move |k| [face[0], face[k - 1], face[k]]);
        return Ok(faces(file, bytes)?.into_iter().flat_map(halves).collect());
    }
    let unsound = |message: String| SurfaceError::Unsound { file: file.to_string(), message };
    // Some programs begin binary files with the word `solid`, too; only the length distinguishes them.
    let count = bytes.get(HEADER - 4..HEADER).map(|count| [0, 1, 2, 3].map(|k| count[k])).map(u32::from_le_bytes);
    match count {
        Some(count) if bytes.len() as u64 == HEADER as u64 + RECORD as u64 * u64::from(count) => {
            let corners: Vec<Corners> = bytes[HEADER..].chunks_exact(RECORD).map(binary).collect();
            if corners.as_flattened().as_flattened().iter().all(|c| c.is_finite()) {
                return Ok(corners);
            }
            Err(unsound("a triangle has a coordinate that is no finite number".to_string()))
        }
        _ if text.get(..5).is_some_and(|word| word.eq_ignore_ascii_case(b"solid")) => {
            ascii(&String::from_utf8_lossy(bytes)).map_err(|(line, message)| SurfaceError::Line {
                file: file.to_string(),
                line,
                message,
            })
        }
        _ => {
            let it = FileKind::of(bytes).map_or(String::new(), |kind| format!("{}: ", kind.name()));
            Err(unsound(format!("the file is {it}neither STL, ASCII or binary and complete, nor of Gmsh")))
        }
    }
}

/// The sizes in a binary file, in bytes: the header, a comment and the number of triangles, and the record of each
/// triangle, a normal, the corners and two further bytes.
const HEADER: usize = 84;
const RECORD: usize = 50;

fn binary(record: &[u8]) -> Corners {
    let number = |k: usize| f64::from(f32::from_le_bytes([0, 1, 2, 3].map(|byte| record[12 + 4 * k + byte])));
    [0, 1, 2].map(|corner| [0, 1, 2].map(|c| number(3 * corner + c)))
}

/// Reads the triangles of an ASCII file. The error is the number of the wrong line and the reason.
fn ascii(text: &str) -> Result<Vec<Corners>, (usize, String)> {
    let (mut all, mut corners, mut open) = (Vec::new(), Vec::new(), false);
    for (k, line) in text.lines().enumerate() {
        let mut words = line.split_whitespace();
        let wrong = |message: &str| (k + 1, message.to_string());
        match words.next().unwrap_or_default().to_ascii_lowercase().as_str() {
            "vertex" => {
                let numbers: Option<Vec<f64>> = words.map(|word| word.parse().ok()).collect();
                match numbers.as_deref() {
                    Some(&[x, y, z]) if [x, y, z].iter().all(|c| c.is_finite()) => corners.push([x, y, z]),
                    _ => return Err(wrong("a vertex needs three finite numbers")),
                }
            }
            "endfacet" => match corners[..] {
                [a, b, c] => {
                    all.push([a, b, c]);
                    corners.clear();
                }
                _ => return Err(wrong("a facet needs three vertices")),
            },
            "solid" => open = true,
            "endsolid" => open = false,
            "facet" | "outer" | "endloop" | "" => {}
            word => return Err((k + 1, format!("`{word}` is no word of an STL file"))),
        }
    }
    let within = |what: &str| Err((text.lines().count(), format!("the file ends within a {what}")));
    match (corners.is_empty(), open) {
        (false, _) => within("facet"),
        (true, true) => within("solid"),
        (true, false) => Ok(all),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const FACET: &str = "solid a b\n facet normal 0 0 1\n  outer loop\n   vertex 0 0 0\n   vertex 1 0 0\n   vertex 0 1e0 0.5\n  endloop\n endfacet\nendsolid a b\n";
    const CORNERS: Corners = [[0.0; 3], [1.0, 0.0, 0.0], [0.0, 1.0, 0.5]];

    /// All formats give the same triangle, including a binary file that begins like an ASCII file.
    #[test]
    fn all_formats() {
        assert_eq!(parse("f", FACET.as_bytes()).unwrap(), [CORNERS]);
        let mut bytes = b"solid".to_vec();
        bytes.resize(80, b' ');
        bytes.extend(1_u32.to_le_bytes());
        for c in [[0.0; 3]].iter().chain(&CORNERS).flatten() {
            bytes.extend((*c as f32).to_le_bytes());
        }
        bytes.extend([0, 0]);
        assert_eq!(parse("f", &bytes).unwrap(), [CORNERS]);
        let square = "$MeshFormat\n4.1 0 8\n$EndMeshFormat\n$Entities\n0 0 1 0\n1 0 0 0 1 1 0 0 0\n$EndEntities\n\
            $Nodes\n1 4 1 4\n2 1 0 4\n1\n2\n3\n4\n0 0 0\n1 0 0\n1 1 0\n0 1 0\n$EndNodes\n\
            $Elements\n1 1 1 1\n2 1 3 1\n1 1 2 3 4\n$EndElements\n";
        let halves = parse("f", square.as_bytes()).unwrap();
        assert_eq!((halves.len(), halves[1]), (2, [[0.0; 3], [1.0, 1.0, 0.0], [0.0, 1.0, 0.0]]));
        bytes.pop();
        bytes[..5].fill(0);
        assert!(parse("f", &bytes).unwrap_err().to_string().contains("f: the file is neither STL"));
    }

    #[test]
    fn what_is_no_stl_is_refused_with_its_line() {
        for (from, to, said) in [
            ("1 0 0", "1 0", "f:5: a vertex needs three finite numbers"),
            ("1 0 0", "1 nan 0", "f:5: a vertex needs three finite numbers"),
            ("   vertex 1 0 0\n", "", "f:7: a facet needs three vertices"),
            ("outer", "inner", "f:3: `inner` is no word of an STL file"),
            (" endfacet\n", "", "f:8: the file ends within a facet"),
            ("endsolid a b\n", "", "f:8: the file ends within a solid"),
        ] {
            let error = parse("f", FACET.replacen(from, to, 1).as_bytes()).unwrap_err();
            assert_eq!(error.to_string(), said);
        }
        assert!([&b""[..], b"sol", b"\x00"].iter().all(|bytes| parse("f", bytes).is_err()));
    }
}
