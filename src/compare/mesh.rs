//! The meshes of a comparison: what they are called, and how a scene comes by them.

use std::fmt;
use std::str::FromStr;

use super::CompareError;
use crate::mesh::{HalfPlane, MeshSource, Segment};
use crate::scene::Override;

/// A mesh of a comparison.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum MeshChoice {
    /// That of the scene.
    Own,
    /// So many elements in the first direction; the other numbers follow in the proportions of the scene.
    Elements(usize),
    /// From another file of Gmsh, named as in the scene.
    File(String),
}

impl fmt::Display for MeshChoice {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            MeshChoice::Own => f.write_str("the scene's mesh"),
            MeshChoice::Elements(n) => write!(f, "n = {n}"),
            MeshChoice::File(file) => f.write_str(file),
        }
    }
}

impl FromStr for MeshChoice {
    type Err = String;

    /// A number of elements, or the name of a file.
    fn from_str(text: &str) -> Result<Self, String> {
        match text.parse() {
            Ok(0) => Err("a mesh has one element at least".to_string()),
            Ok(n) => Ok(MeshChoice::Elements(n)),
            Err(_) if text.is_empty() => Err("give a number of elements, or a mesh file".to_string()),
            Err(_) => Ok(MeshChoice::File(text.to_string())),
        }
    }
}

impl MeshChoice {
    /// What puts it in the place of `mesh`.
    pub(super) fn overrides(&self, mesh: &MeshSource) -> Vec<Override> {
        match self {
            MeshChoice::Own => Vec::new(),
            MeshChoice::Elements(n) => refined(mesh, *n),
            MeshChoice::File(file) => vec![Override::value("mesh.file", file.as_str())],
        }
    }
}

/// Each of the `choices` once, if they can take the place of `mesh`.
pub(super) fn each(mesh: &MeshSource, choices: &[MeshChoice]) -> Result<Vec<MeshChoice>, CompareError> {
    let mut each: Vec<MeshChoice> = Vec::new();
    for choice in choices {
        match (choice, mesh) {
            (MeshChoice::Elements(_), MeshSource::Gmsh { .. } | MeshSource::Given(_)) => {
                return Err(CompareError::FixedMesh);
            }
            (MeshChoice::File(_), MeshSource::Block { .. } | MeshSource::HalfPlane(_) | MeshSource::Given(_)) => {
                return Err(CompareError::NoMeshFile);
            }
            _ if each.contains(choice) => {}
            _ => each.push(choice.clone()),
        }
    }
    if each.is_empty() { Err(CompareError::NoMesh) } else { Ok(each) }
}

/// The elements in the first direction, or along the contact zone; none for a mesh that is what it is.
pub(super) fn first_elements(mesh: &MeshSource) -> Option<usize> {
    match mesh {
        MeshSource::Block { axes, .. } => Some(axes[0].iter().map(|segment| segment.elements).sum()),
        MeshSource::HalfPlane(HalfPlane { contact_elements, .. }) => Some(*contact_elements),
        MeshSource::Gmsh { .. } | MeshSource::Given(_) => None,
    }
}

/// What makes a mesh with `first` of them of this one, the other numbers in proportion.
fn refined(mesh: &MeshSource, first: usize) -> Vec<Override> {
    let share = first as f64 / first_elements(mesh).unwrap_or(first) as f64;
    let scaled = |count: usize| ((share * count as f64).round() as i64).max(1);
    match mesh {
        MeshSource::Block { axes, .. } => {
            let along = |axis: &Vec<Segment>| match axis[..] {
                [segment] => scaled(segment.elements).into(),
                _ => axis.iter().map(|segment| scaled(segment.elements)).collect::<toml_edit::Value>(),
            };
            vec![Override::value("mesh.elements", axes.iter().map(along).collect::<toml_edit::Value>())]
        }
        MeshSource::HalfPlane(HalfPlane { contact_elements, outer_elements, layers, .. }) => vec![
            Override::value("mesh.contact_elements", scaled(*contact_elements)),
            Override::value("mesh.outer_elements", scaled(*outer_elements)),
            Override::value("mesh.layers", scaled(*layers)),
        ],
        MeshSource::Gmsh { .. } | MeshSource::Given(_) => Vec::new(),
    }
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used)]

    use super::*;
    use crate::scene::Scene;

    #[test]
    fn all_directions_are_refined_in_proportion() {
        let punch = Scene::parse("punch.toml", include_str!("../../data/scenes/punch.toml"), &[]).unwrap();
        let MeshSource::HalfPlane(finer) =
            punch.with(&MeshChoice::Elements(60).overrides(&punch.description.mesh)).unwrap().description.mesh
        else {
            panic!()
        };
        assert_eq!((finer.contact_elements, finer.outer_elements, finer.layers), (60, 100, 22));
        let block = "mesh.elements=[40,8]".parse().unwrap();
        let block = Scene::parse("block.toml", include_str!("../../data/scenes/block.toml"), &[block]).unwrap();
        let elements = |mesh: MeshSource| -> Vec<usize> {
            let MeshSource::Block { axes, .. } = mesh else { panic!() };
            axes.concat().iter().map(|segment| segment.elements).collect()
        };
        assert_eq!(
            elements(block.with(&MeshChoice::Elements(2).overrides(&block.description.mesh)).unwrap().description.mesh),
            [2, 1]
        );
        let segments = ["mesh.size=[[0.25,0.75],1]", "mesh.elements=[[2,4],4]"].map(|text| text.parse().unwrap());
        let block = block.with(&segments).unwrap();
        assert_eq!(
            elements(
                block.with(&MeshChoice::Elements(12).overrides(&block.description.mesh)).unwrap().description.mesh
            ),
            [4, 8, 8]
        );
    }
}
