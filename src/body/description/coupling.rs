//! Couplings of a boundary or a body to a reference point.

use serde::Deserialize;

use super::load::components;
use crate::algebra::vector::Vector;
use crate::base::input_error::{InputError, in_one_line};

/// A boundary or a body coupled to a reference point.
///
/// Loads, supports and springs act on the point by its name ([`Where::Coupling`](super::Where::Coupling)).
#[derive(Debug, Clone, PartialEq)]
pub struct Coupling {
    /// The name of the point.
    pub name: String,
    /// The coupled part of the mesh.
    pub part: Part,
    /// The position of the point, m. Default: the centroid of the part.
    pub point: Option<Vector>,
    /// The kind of the coupling.
    pub kind: CouplingKind,
}

/// A part of a mesh.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum Part {
    /// The nodes of the boundary of this name.
    Boundary(String),
    /// The nodes of the body of this name.
    Body(String),
}

impl Part {
    /// Returns the name of the boundary or body.
    pub fn name(&self) -> &str {
        match self {
            Part::Boundary(name) | Part::Body(name) => name,
        }
    }

    /// Returns the key of the name in the table of a coupling.
    pub(crate) fn key(&self) -> &'static str {
        match self {
            Part::Boundary(_) => "boundary",
            Part::Body(_) => "body",
        }
    }
}

/// The kind of a coupling.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Deserialize, schemars::JsonSchema)]
#[serde(rename_all = "lowercase")]
pub enum CouplingKind {
    /// The nodes move with the point as a rigid body, `u(x) = U + θ × (x - p)`. Abaqus: kinematic coupling; Nastran:
    /// RBE2.
    #[default]
    Rigid,
    /// The nodes move freely. A force and a moment at the point are distributed over the boundary as
    /// tractions that change linearly; the motion of the point is the mean of that of the boundary in the least-squares sense. Abaqus: distributing
    /// coupling; Nastran: RBE3.
    Distributing,
}

impl Coupling {
    /// Creates a rigid coupling of `boundary` to the point `name` at its centroid.
    pub fn rigid(name: &str, boundary: &str) -> Self {
        let part = Part::Boundary(boundary.to_string());
        Coupling { name: name.to_string(), part, point: None, kind: CouplingKind::Rigid }
    }

    /// Creates a distributing coupling of `boundary` to the point `name` at its centroid.
    pub fn distributing(name: &str, boundary: &str) -> Self {
        Coupling { kind: CouplingKind::Distributing, ..Coupling::rigid(name, boundary) }
    }

    /// Sets the position of the point, m.
    #[must_use]
    pub fn at(self, point: impl Into<Vector>) -> Self {
        Coupling { point: Some(point.into()), ..self }
    }

    /// Checks a coupling, also against the `earlier` ones.
    pub(super) fn check(&self, earlier: &[Coupling]) -> Result<(), InputError> {
        if earlier.iter().any(|other| other.name == self.name) {
            let message = format!("two couplings are called `{}`", self.name);
            return Err(InputError::new("name", message, "give each coupling a name of its own"));
        }
        in_one_line("a coupling", &self.name, "give a name such as \"handle\"")?;
        if self.kind == CouplingKind::Distributing && matches!(self.part, Part::Body(_)) {
            let help = "name a boundary, or couple the body with kind = \"rigid\"";
            return Err(InputError::new("body", "a distributing coupling needs a boundary", help));
        }
        self.point.map_or(Ok(()), |point| components("point", &point.components()))
    }
}
