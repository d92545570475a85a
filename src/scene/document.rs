//! The tables of a scene file as they are deserialised.

use std::fmt;
use std::marker::PhantomData;

use serde::de::value::{MapAccessDeserializer, SeqAccessDeserializer};
use serde::de::{IntoDeserializer, MapAccess, SeqAccess, Visitor};
use serde::{Deserialize, Deserializer, de};

use super::error::Source;
use super::{SceneError, syntax};
use crate::algebra::vector::Vector;
use crate::base::units::Units;
use crate::body::contact::GapDirection;
use crate::body::description::{CouplingKind, Slave};
use crate::body::fem::{Element, MaterialGroup, Plane};
use crate::body::mesh::CellKind;
use crate::solver::formulation::Partition;
use crate::solver::history::{LinearAlgebra, UnknownLinearAlgebra};

/// `N` values, by default two. A plain array would not do because the TOML reader ignores surplus values.
#[derive(Clone, Copy, Deserialize)]
#[serde(try_from = "Vec<T>")]
pub(super) struct Tuple<T, const N: usize = 2>(pub [T; N]);

impl<T: fmt::Debug, const N: usize> fmt::Debug for Tuple<T, N> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        self.0.fmt(f)
    }
}

impl<T, const N: usize> TryFrom<Vec<T>> for Tuple<T, N> {
    type Error = String;

    fn try_from(values: Vec<T>) -> Result<Self, String> {
        let count = values.len();
        values.try_into().map(Tuple).map_err(|_| format!("invalid length {count}, expected {N} values"))
    }
}

/// One value, or a list of several.
#[derive(Clone)]
pub(super) enum OneOrMany<T> {
    One(T),
    Many(Vec<T>),
}

impl<T> OneOrMany<T> {
    /// Returns the values as a list.
    pub fn into_vec(self) -> Vec<T> {
        match self {
            OneOrMany::One(one) => vec![one],
            OneOrMany::Many(all) => all,
        }
    }
}

impl<T: fmt::Debug> fmt::Debug for OneOrMany<T> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            OneOrMany::One(one) => one.fmt(f),
            OneOrMany::Many(all) => all.fmt(f),
        }
    }
}

impl<'de, T: Deserialize<'de>> Deserialize<'de> for OneOrMany<T> {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        deserializer.deserialize_any(OneOrManyVisitor(PhantomData))
    }
}

/// Reads one value or a list with the errors of the values themselves, which an untagged enum would hide.
struct OneOrManyVisitor<T>(PhantomData<T>);

impl<'de, T: Deserialize<'de>> Visitor<'de> for OneOrManyVisitor<T> {
    type Value = OneOrMany<T>;

    fn expecting(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str("one value or a list of them")
    }

    fn visit_i64<E: de::Error>(self, value: i64) -> Result<Self::Value, E> {
        T::deserialize(value.into_deserializer()).map(OneOrMany::One)
    }

    fn visit_f64<E: de::Error>(self, value: f64) -> Result<Self::Value, E> {
        T::deserialize(value.into_deserializer()).map(OneOrMany::One)
    }

    fn visit_str<E: de::Error>(self, value: &str) -> Result<Self::Value, E> {
        T::deserialize(value.into_deserializer()).map(OneOrMany::One)
    }

    fn visit_map<A: MapAccess<'de>>(self, map: A) -> Result<Self::Value, A::Error> {
        T::deserialize(MapAccessDeserializer::new(map)).map(OneOrMany::One)
    }

    fn visit_seq<A: SeqAccess<'de>>(self, values: A) -> Result<Self::Value, A::Error> {
        Vec::deserialize(SeqAccessDeserializer::new(values)).map(OneOrMany::Many)
    }
}

/// A number, or the text of a formula.
#[derive(Clone)]
pub(super) enum Scalar {
    Number(f64),
    Text(String),
}

impl<'de> Deserialize<'de> for Scalar {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        deserializer.deserialize_any(ScalarVisitor)
    }
}

struct ScalarVisitor;

impl Visitor<'_> for ScalarVisitor {
    type Value = Scalar;

    fn expecting(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str("a number or a formula in quotes, of x, y and z")
    }

    fn visit_i64<E: de::Error>(self, value: i64) -> Result<Scalar, E> {
        Ok(Scalar::Number(value as f64))
    }

    fn visit_f64<E: de::Error>(self, value: f64) -> Result<Scalar, E> {
        Ok(Scalar::Number(value))
    }

    fn visit_str<E: de::Error>(self, value: &str) -> Result<Scalar, E> {
        Ok(Scalar::Text(value.to_string()))
    }
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct Document {
    pub title: Option<String>,
    #[serde(default)]
    pub units: Units,
    pub mesh: Option<Mesh>,
    pub material: Option<Material>,
    #[serde(default)]
    pub body: Vec<BodyTable>,
    #[serde(default)]
    pub coupling: Vec<Coupling>,
    #[serde(default)]
    pub support: Vec<Support>,
    #[serde(default)]
    pub contact: Vec<ContactTable>,
    #[serde(default)]
    pub pretension: Vec<Pretension>,
    #[serde(default)]
    pub spring: Vec<Spring>,
    #[serde(default)]
    pub load: Vec<Load>,
    pub time: Time,
    #[serde(default)]
    pub solver: SolverTable,
    #[serde(default)]
    pub output: Output,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct Coupling {
    pub name: String,
    pub boundary: Option<String>,
    pub body: Option<String>,
    pub point: Option<Vector>,
    #[serde(default)]
    pub kind: CouplingKind,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct Support {
    pub boundary: Option<String>,
    pub point: Option<Vector>,
    pub coupling: Option<String>,
    pub fix: Option<Vec<Fix>>,
    pub direction: Option<Vector>,
    pub displacement: Option<OneOrMany<f64>>,
    pub history: Option<Vec<Tuple<f64>>>,
}

/// A direction along which a support fixes displacements.
#[derive(Clone, Copy, Deserialize)]
#[serde(rename_all = "snake_case")]
pub(super) enum Fix {
    X,
    Y,
    Z,
    Normal,
    RotationX,
    RotationY,
    RotationZ,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct Spring {
    pub boundary: Option<String>,
    pub point: Option<Vector>,
    pub coupling: Option<String>,
    pub stiffness: Option<Vec<f64>>,
    pub rotational: Option<OneOrMany<f64>>,
    pub normal: Option<f64>,
    pub tangential: Option<f64>,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct ContactTable {
    pub boundary: String,
    pub friction: Option<Scalar>,
    pub friction_history: Option<Vec<Tuple<f64>>>,
    pub obstacle: Option<OneOrMany<Obstacle>>,
    pub against: Option<OneOrMany<String>>,
    pub glue: Option<bool>,
    pub shift: Option<Vector>,
    pub search: Option<f64>,
    pub gap: Option<Scalar>,
    pub adjust: Option<f64>,
    pub direction: Option<Vector>,
    pub slave: Option<Slave>,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct Pretension {
    pub name: String,
    pub boundary: String,
    pub force: Option<f64>,
    pub shortening: Option<f64>,
    pub history: Option<Vec<Tuple<f64>>>,
    pub lock: Option<f64>,
}

#[derive(Deserialize)]
#[serde(rename_all = "lowercase")]
pub(super) enum ObstacleKind {
    Plane,
    Cylinder,
    Bore,
    Sphere,
    Socket,
    Cone,
    Wedge,
    Formula,
    Table,
    Surface,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct Obstacle {
    pub kind: ObstacleKind,
    pub gap: Option<f64>,
    pub through: Option<Vector>,
    pub radius: Option<f64>,
    pub apex: Option<Vector>,
    pub center: Option<Vector>,
    pub axis: Option<Vector>,
    pub angle: Option<f64>,
    pub half_angle: Option<f64>,
    pub formula: Option<String>,
    pub file: Option<String>,
    pub scale: Option<f64>,
    pub direction: Option<GapDirection>,
    pub approach: Option<Vec<Tuple<f64>>>,
    pub motion: Option<Motion>,
    pub normal: Option<Vector>,
    pub tangent: Option<Vector>,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct Motion {
    pub translation: Option<Vec<Vec<f64>>>,
    pub rotation: Option<Rotation>,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct Rotation {
    pub axis: Option<Vector>,
    pub through: Vector,
    pub history: Vec<Tuple<f64>>,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct Load {
    pub boundary: Option<String>,
    pub point: Option<Vector>,
    pub coupling: Option<String>,
    pub traction: Option<Vec<Scalar>>,
    pub pressure: Option<Scalar>,
    pub force: Option<Vec<f64>>,
    pub moment: Option<OneOrMany<f64>>,
    pub acceleration: Option<Vec<f64>>,
    pub rotation: Option<Spin>,
    pub temperature: Option<Scalar>,
    pub history: Option<Vec<Tuple<f64>>>,
}

#[derive(Clone, Copy, Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct Spin {
    pub axis: Option<Vector>,
    pub through: Option<Vector>,
    pub speed: f64,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct Time {
    pub end: f64,
    pub increments: i64,
}

#[derive(Deserialize, Default)]
#[serde(deny_unknown_fields)]
pub(super) struct SolverTable {
    #[serde(default)]
    pub method: MethodName,
    pub setting: Option<Setting>,
    pub linear: Option<Linear>,
    pub petsc: Option<String>,
    pub start: Option<Start>,
    pub partition: Option<Partition>,
    pub r_factor: Option<f64>,
    pub max_iterations: Option<i64>,
    pub tolerance: Option<f64>,
}

#[derive(Clone, Copy, Default, Deserialize)]
#[serde(rename_all = "lowercase")]
pub(super) enum MethodName {
    #[default]
    Bn,
    Ip,
    Events,
}

#[derive(Clone, Copy, Default, Deserialize)]
#[serde(rename_all = "lowercase")]
pub(super) enum Setting {
    Paper,
    #[default]
    Default,
}

#[derive(Clone, Copy, Deserialize)]
#[serde(rename_all = "lowercase")]
pub(super) enum Start {
    Safe,
    Prev,
}

/// The linear algebra; `None` for `auto`.
#[derive(Clone, Copy)]
pub(super) struct Linear(pub Option<LinearAlgebra>);

impl<'de> Deserialize<'de> for Linear {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        let word = String::deserialize(deserializer)?;
        if word == "auto" {
            return Ok(Linear(None));
        }
        let known = word.parse().map(|linear| Linear(Some(linear)));
        known.map_err(|UnknownLinearAlgebra| de::Error::unknown_variant(&word, &LINEAR))
    }
}

/// The words of `solver.linear`.
const LINEAR: [&str; 10] = [
    "umfpack",
    "mumps",
    "faer",
    "partial",
    "condensed",
    "condensed-cholmod",
    "condensed-faer",
    "multigrid",
    "petsc",
    "auto",
];

impl Document {
    pub(super) fn parse(source: &Source) -> Result<Self, SceneError> {
        toml::from_str(&source.text).map_err(|error| syntax::error(error, source))
    }
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct BodyTable {
    pub name: String,
    pub at: Option<Vector>,
    pub mesh: Mesh,
    pub material: Material,
}

#[derive(Deserialize)]
#[serde(rename_all = "kebab-case")]
pub(super) enum MeshKind {
    Block,
    HalfPlane,
    Gmsh,
    Abaqus,
    Unv,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct Mesh {
    pub kind: MeshKind,
    pub size: Option<Vec<OneOrMany<f64>>>,
    pub cells: Option<CellKind>,
    pub file: Option<String>,
    pub scale: Option<f64>,
    pub element: Option<Element>,
    pub elements: Option<Vec<OneOrMany<i64>>>,
    pub grading: Option<Vec<OneOrMany<f64>>>,
    pub origin: Option<Vector>,
    pub contact_width: Option<f64>,
    pub contact_elements: Option<i64>,
    pub outer_elements: Option<i64>,
    pub layers: Option<i64>,
    pub refine: Option<f64>,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct Material {
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

#[derive(Deserialize, Default)]
#[serde(deny_unknown_fields)]
pub(super) struct Output {
    pub times: Option<Times>,
    pub every: Option<i64>,
    #[serde(default)]
    pub fields: bool,
    #[serde(default)]
    pub deformed: bool,
    pub magnification: Option<f64>,
    pub cycle: Option<Cycle>,
    pub wear_coefficient: Option<f64>,
    #[serde(default)]
    pub probe: Vec<Probe>,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct Probe {
    pub name: String,
    pub point: Option<Vector>,
    pub from: Option<Vector>,
    pub to: Option<Vector>,
    pub points: Option<i64>,
}

/// A load cycle.
pub(super) enum Cycle {
    /// The last one.
    Last,
    /// The one between these times, s.
    Between(Vec<f64>),
}

/// Times of output.
pub(super) enum Times {
    /// The beginning and the end of each increment.
    All,
    /// The end of the first increment that reaches each of these times, s.
    These(Vec<f64>),
}

impl<'de> Deserialize<'de> for Times {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        let visitor = WordOrTimes { word: "all", expected: "a list of times or \"all\"" };
        Ok(deserializer.deserialize_any(visitor)?.map_or(Times::All, Times::These))
    }
}

impl<'de> Deserialize<'de> for Cycle {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        let visitor = WordOrTimes { word: "last", expected: "the times of its beginning and its end, or \"last\"" };
        Ok(deserializer.deserialize_any(visitor)?.map_or(Cycle::Last, Cycle::Between))
    }
}

/// Reads a list of times, or one word: `None`.
struct WordOrTimes {
    word: &'static str,
    expected: &'static str,
}

impl<'de> Visitor<'de> for WordOrTimes {
    type Value = Option<Vec<f64>>;

    fn expecting(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(self.expected)
    }

    fn visit_str<E: de::Error>(self, word: &str) -> Result<Self::Value, E> {
        if word == self.word { Ok(None) } else { Err(E::invalid_value(de::Unexpected::Str(word), &self)) }
    }

    fn visit_seq<A: SeqAccess<'de>>(self, values: A) -> Result<Self::Value, A::Error> {
        Vec::deserialize(SeqAccessDeserializer::new(values)).map(Some)
    }
}
