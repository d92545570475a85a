//! Parser of the mesh in input files of Abaqus and CalculiX.
//!
//! Names are in capitals, as Abaqus does not tell capitals from small letters. The ELSETs of `*SOLID SECTION` are groups
//! of elements, without any section all ELSETs are. A `*SURFACE` is a boundary, and so is a node set with all nodes of a
//! side that belongs to one element only. Sources: Abaqus keywords reference manual; G. Dhondt, CalculiX CrunchiX user's
//! manual, version 2.20, chapters 6 and 7.

mod elements;
mod keywords;
mod model;
mod sets;

use std::path::{Path, PathBuf};

use super::raw::RawMesh;
use super::{MeshFormatError, Place};
use crate::base::input::FileKind;
use keywords::Keywords;
use model::Model;

/// Parses `bytes`; messages name the file `name`, and files that it includes are read from its folder.
pub(super) fn read(name: &str, bytes: &[u8]) -> Result<RawMesh, MeshFormatError> {
    if let Some(kind) = FileKind::of(bytes).filter(|kind| *kind != FileKind::Abaqus) {
        let message = format!("it is {}, but an input of Abaqus or CalculiX is needed", kind.name());
        let help = kind.as_mesh().to_string();
        return Err(MeshFormatError { file: name.to_string(), place: Place::Line(1), message, help });
    }
    let mut keywords = Keywords::default();
    let mut model = Model::default();
    keywords.read(Path::new(name), bytes, &mut |keyword, data| model.take(keyword, data))?;
    model.finish(name)
}

/// Returns the files that the file at `path` includes, as far as they can be read.
pub(super) fn includes(path: &Path) -> Vec<PathBuf> {
    let mut keywords = Keywords::default();
    if let Ok(bytes) = crate::base::input::read_bytes(path) {
        // A fault is reported when the mesh is read.
        let _ = keywords.read(path, &bytes, &mut |_, _| Ok(()));
    }
    keywords.into_included()
}
