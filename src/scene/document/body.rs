//! The tables of one body in a scene file: mesh, elements and material.

use serde::Deserialize;

use super::{Segments, Tuple};
use crate::algebra::vector::Vector;
use crate::body::fem::{Element, MaterialGroup, Plane};
use crate::body::mesh::CellKind;

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
pub(in crate::scene) struct BodyTable {
    pub name: String,
    pub at: Option<Vector>,
    pub mesh: Mesh,
    pub material: Material,
}

#[derive(Deserialize)]
#[serde(rename_all = "kebab-case")]
pub(in crate::scene) enum MeshKind {
    Block,
    HalfPlane,
    Gmsh,
    Abaqus,
    Unv,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
pub(in crate::scene) struct Mesh {
    pub kind: MeshKind,
    pub size: Option<Vec<Segments<f64>>>,
    pub cells: Option<CellKind>,
    pub file: Option<String>,
    pub scale: Option<f64>,
    pub element: Option<Element>,
    pub elements: Option<Vec<Segments<i64>>>,
    pub grading: Option<Vec<Segments<f64>>>,
    pub origin: Option<Vector>,
    pub contact_width: Option<f64>,
    pub contact_elements: Option<i64>,
    pub outer_elements: Option<i64>,
    pub layers: Option<i64>,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
pub(in crate::scene) struct Material {
    pub young: f64,
    pub poisson: f64,
    pub plane: Option<Plane>,
    pub thickness: Option<f64>,
    pub density: Option<f64>,
    pub expansion: Option<f64>,
    #[serde(default)]
    pub layers: Vec<Tuple<f64, 3>>,
    #[serde(default)]
    pub group: Vec<MaterialGroup>,
}
