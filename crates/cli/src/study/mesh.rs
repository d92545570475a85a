//! The meshes of a study: their names and how to generate them from a scene.

use std::fmt;
use std::str::FromStr;

use serde::de::IntoDeserializer;
use serde::{Deserialize, Serialize};

use super::{StudyError, distinct};
use stickslip::body::fem::Element;
use stickslip::body::mesh::{Body, CellKind, HalfPlane, MeshSource, Segment};
use stickslip::scene::Override;

/// A mesh of a study.
#[derive(Debug, Clone, PartialEq)]
pub struct MeshChoice {
    /// Its origin and refinement.
    pub size: MeshSize,
    /// Its elements; `None` for those of the scene.
    pub elements: Option<ElementChoice>,
}

/// The refinement of a mesh.
#[derive(Debug, Clone, PartialEq)]
pub enum MeshSize {
    /// The mesh of the scene.
    Own,
    /// A number of elements in the first direction. The other numbers follow in the proportions of the scene.
    Elements(usize),
    /// All numbers of elements of the scene times a factor.
    Times(f64),
    /// Another mesh file of the same format, named as in the scene.
    File(String),
}

/// The choice of elements of a mesh.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct ElementChoice {
    /// Their cell type; `None` for that of the scene.
    pub cells: Option<CellKind>,
    /// Their strain formulation.
    pub element: Element,
}

impl From<MeshSize> for MeshChoice {
    fn from(size: MeshSize) -> Self {
        MeshChoice { size, elements: None }
    }
}

impl fmt::Display for MeshChoice {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        self.elements.map_or(Ok(()), |elements| write!(f, "{elements}, "))?;
        match &self.size {
            MeshSize::Own => f.write_str("the scene's mesh"),
            MeshSize::Elements(n) => write!(f, "n = {n}"),
            MeshSize::Times(factor) => write!(f, "{factor} times the elements"),
            MeshSize::File(file) => f.write_str(file),
        }
    }
}

impl FromStr for MeshSize {
    type Err = String;

    /// Parses a number of elements, or the name of a file.
    fn from_str(text: &str) -> Result<Self, String> {
        match text.parse() {
            Ok(0) => Err("a mesh has at least one element".to_string()),
            Ok(n) => Ok(MeshSize::Elements(n)),
            Err(_) if text.starts_with('[') || text.ends_with(']') => {
                Err("give each mesh by its first number of elements alone, such as 40,80".to_string())
            }
            Err(_) if text.is_empty() => Err("give a number of elements, or a mesh file".to_string()),
            Err(_) => Ok(MeshSize::File(text.to_string())),
        }
    }
}

impl fmt::Display for ElementChoice {
    /// Writes it in the form in which it is parsed.
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match (self.cells, self.element) {
            (None, element) => element.serialize(f),
            (Some(cells), Element::Bilinear) => cells.serialize(f),
            (Some(cells), element) => {
                cells.serialize(&mut *f)?;
                f.write_str(":")?;
                element.serialize(f)
            }
        }
    }
}

impl FromStr for ElementChoice {
    type Err = String;

    /// Parses cells as named by `mesh.cells`, strains as named by `mesh.element`, or both separated by a colon:
    /// `triangle6`, `b-bar`, `quadrilateral:b-bar`. Cells alone take the strains of their displacements.
    fn from_str(text: &str) -> Result<Self, String> {
        fn named<'a, T: Deserialize<'a>>(text: &'a str) -> Result<T, serde::de::value::Error> {
            T::deserialize(text.into_deserializer())
        }
        if let Some((cells, element)) = text.split_once(':') {
            let message = |error: serde::de::value::Error| error.to_string();
            let cells = Some(named(cells).map_err(message)?);
            return Ok(ElementChoice { cells, element: named(element).map_err(message)? });
        }
        if let Ok(element) = named(text) {
            return Ok(ElementChoice { cells: None, element });
        }
        let cells = named(text).map_err(|error| format!("{error}, `bilinear`, `b-bar`, `nodal-volume`"))?;
        Ok(ElementChoice { cells: Some(cells), element: Element::Bilinear })
    }
}

impl MeshChoice {
    /// Returns the overrides that replace `mesh` by it.
    pub fn overrides(&self, mesh: &MeshSource) -> Vec<Override> {
        // A key without a number refers to all bodies.
        let key =
            |key: &str| if matches!(mesh, MeshSource::Bodies(_)) { format!("body.{key}") } else { key.to_string() };
        let mut overrides = match &self.size {
            MeshSize::Own => Vec::new(),
            MeshSize::Elements(n) => multiplied(mesh, *n as f64 / first_elements(mesh).unwrap_or(*n) as f64),
            MeshSize::Times(factor) => multiplied(mesh, *factor),
            MeshSize::File(file) => vec![Override::value("mesh.file", file.as_str())],
        };
        if let Some(ElementChoice { cells, element }) = self.elements {
            let cells_alone = |cells| ElementChoice { cells: Some(cells), element: Element::Bilinear }.to_string();
            overrides.extend(cells.map(|cells| Override::value(&key("mesh.cells"), cells_alone(cells))));
            let element = ElementChoice { cells: None, element }.to_string();
            overrides.push(Override::value(&key("mesh.element"), element));
        }
        overrides
    }
}

/// Returns each of the `choices` once, or an error if one cannot replace `mesh`.
pub(crate) fn each(mesh: &MeshSource, choices: &[MeshChoice]) -> Result<Vec<MeshChoice>, StudyError> {
    let sources: Vec<&MeshSource> = match mesh {
        MeshSource::Bodies(bodies) => bodies.iter().map(|body| &body.mesh).collect(),
        one => vec![one],
    };
    let fixed = sources.iter().any(|mesh| matches!(mesh, MeshSource::File { .. } | MeshSource::Given(_)));
    let blocks = sources.iter().all(|mesh| matches!(mesh, MeshSource::Block { .. }));
    for choice in choices {
        let cells = choice.elements.is_some_and(|elements| elements.cells.is_some());
        match &choice.size {
            MeshSize::Elements(_) | MeshSize::Times(_) if fixed => return Err(StudyError::FixedMesh),
            MeshSize::File(_) if !matches!(mesh, MeshSource::File { .. }) => return Err(StudyError::NoMeshFile),
            _ if cells && !blocks => return Err(StudyError::FixedCells),
            _ => {}
        }
    }
    if choices.is_empty() { Err(StudyError::NoMesh) } else { Ok(distinct(choices.to_vec())) }
}

/// Returns the number of elements in the first direction, or along the contact zone, of the first body. `None` for a
/// mesh that cannot be refined.
pub(crate) fn first_elements(mesh: &MeshSource) -> Option<usize> {
    match mesh {
        MeshSource::Block { axes, .. } => Some(axes[0].iter().map(|segment| segment.elements).sum()),
        MeshSource::HalfPlane(HalfPlane { contact_elements, .. }) => Some(*contact_elements),
        MeshSource::File { .. } | MeshSource::Given(_) => None,
        MeshSource::Bodies(bodies) => first_elements(&bodies.first()?.mesh),
    }
}

/// Returns the overrides that multiply all numbers of elements of the mesh by `share`.
pub(crate) fn multiplied(mesh: &MeshSource, share: f64) -> Vec<Override> {
    match mesh {
        MeshSource::Bodies(bodies) => {
            let body = |(k, body): (usize, &Body)| scaled(&body.mesh, share, &format!("body[{k}].mesh"));
            bodies.iter().enumerate().flat_map(body).collect()
        }
        one => scaled(one, share, "mesh"),
    }
}

/// Returns the overrides that multiply the elements along each axis of the mesh at `key` by `share`.
fn scaled(mesh: &MeshSource, share: f64, key: &str) -> Vec<Override> {
    let scaled = |count: usize| ((share * count as f64).round() as i64).max(1);
    let value = |name: &str, count: usize| Override::value(&format!("{key}.{name}"), scaled(count));
    match mesh {
        MeshSource::Block { axes, .. } => {
            let along = |axis: &Vec<Segment>| match axis[..] {
                [segment] => scaled(segment.elements).into(),
                _ => axis.iter().map(|segment| scaled(segment.elements)).collect::<toml_edit::Value>(),
            };
            let elements = axes.iter().map(along).collect::<toml_edit::Value>();
            vec![Override::value(&format!("{key}.elements"), elements)]
        }
        MeshSource::HalfPlane(HalfPlane { contact_elements, outer_elements, layers, .. }) => vec![
            value("contact_elements", *contact_elements),
            value("outer_elements", *outer_elements),
            value("layers", *layers),
        ],
        MeshSource::File { .. } | MeshSource::Given(_) | MeshSource::Bodies(_) => Vec::new(),
    }
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used)]

    use super::*;
    use stickslip::scene::Scene;

    #[test]
    fn all_directions_are_refined_in_proportion() {
        let punch = Scene::parse("punch.toml", include_str!("../../../../data/scenes/punch.toml"), &[]).unwrap();
        let MeshSource::HalfPlane(finer) = punch
            .with(&MeshChoice::from(MeshSize::Elements(60)).overrides(&punch.description.mesh))
            .unwrap()
            .description
            .mesh
        else {
            panic!()
        };
        assert_eq!((finer.contact_elements, finer.outer_elements, finer.layers), (60, 100, 22));
        let block = "mesh.elements=[40,8]".parse().unwrap();
        let block = Scene::parse("block.toml", include_str!("../../../../data/scenes/block.toml"), &[block]).unwrap();
        let elements = |mesh: MeshSource| -> Vec<usize> {
            let MeshSource::Block { axes, .. } = mesh else { panic!() };
            axes.concat().iter().map(|segment| segment.elements).collect()
        };
        assert_eq!(
            elements(
                block
                    .with(&MeshChoice::from(MeshSize::Elements(2)).overrides(&block.description.mesh))
                    .unwrap()
                    .description
                    .mesh
            ),
            [2, 1]
        );
        let segments = ["mesh.size=[[0.25,0.75],1]", "mesh.elements=[[2,4],4]"].map(|text| text.parse().unwrap());
        let block = block.with(&segments).unwrap();
        assert_eq!(
            elements(
                block
                    .with(&MeshChoice::from(MeshSize::Elements(12)).overrides(&block.description.mesh))
                    .unwrap()
                    .description
                    .mesh
            ),
            [4, 8, 8]
        );
    }
    #[test]
    fn elements_are_named_as_in_scenes() {
        for name in ["triangle6", "quadrilateral:b-bar", "nodal-volume", "bilinear", "tetrahedron:nodal-volume"] {
            assert_eq!(name.parse::<ElementChoice>().unwrap().to_string(), name);
        }
        let plain = ElementChoice { cells: Some(CellKind::Prism), element: Element::Bilinear };
        assert_eq!("prism:bilinear".parse::<ElementChoice>().unwrap(), plain);
        for (name, word) in [("triangel", "`triangle6`"), ("", "`b-bar`"), ("triangle:b_bar", "`nodal-volume`")] {
            assert!(name.parse::<ElementChoice>().unwrap_err().contains(word));
        }
        let block = Scene::parse("block.toml", include_str!("../../../../data/scenes/block.toml"), &[]).unwrap();
        let elements = Some("triangle6".parse().unwrap());
        let choice = MeshChoice { size: MeshSize::Elements(4), elements };
        let mesh = block.with(&choice.overrides(&block.description.mesh)).unwrap().description.mesh;
        let MeshSource::Block { axes, cells, .. } = mesh else { panic!() };
        assert_eq!((axes[0][0].elements, cells), (4, CellKind::Triangle6));
    }
}
