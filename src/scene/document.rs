//! The tables of a scene file as they are deserialised.

use std::fmt;

use schemars::JsonSchema;
use serde::de::value::SeqAccessDeserializer;
use serde::de::{SeqAccess, Visitor};
use serde::{Deserialize, Deserializer, de};
use serde_json::Value;

pub(super) use super::values::{OneOrMany, Scalar, Tuple};

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

/// An elastic body, its supports, obstacles and loads, and how to solve it. SI units, unless units says otherwise.
#[derive(Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
#[schemars(title = "A scene of stickslip", extend("oneOf" = [{"required": ["mesh", "material"]}, {"required": ["body"]}]))]
pub(super) struct Document {
    /// A line for headings; the file's name unless given.
    pub title: Option<String>,
    /// The units of all numbers of the scene, its meshes and tables, and of its results, in place of those named below:
    /// others follow from these, force as stress · length². Time is in s, temperature in K, angles are in rad.
    #[serde(default)]
    pub units: Units,
    pub mesh: Option<Mesh>,
    pub material: Option<Material>,
    /// Several bodies, in place of mesh and material; boundaries are called name:boundary.
    #[serde(default)]
    #[schemars(length(min = 1))]
    pub body: Vec<BodyTable>,
    /// Reference points that move with a boundary or a body.
    #[serde(default)]
    pub coupling: Vec<Coupling>,
    /// Where the body is held.
    #[serde(default)]
    pub support: Vec<Support>,
    /// Boundaries that can touch an obstacle, each at most once, or another boundary.
    #[serde(default)]
    pub contact: Vec<ContactTable>,
    /// Bolts that are tightened across a section between two glued parts.
    #[serde(default)]
    pub pretension: Vec<Pretension>,
    /// Springs and elastic foundations.
    #[serde(default)]
    pub spring: Vec<Spring>,
    /// The loads of the body, which add up.
    #[serde(default)]
    pub load: Vec<Load>,
    pub time: Time,
    #[serde(default)]
    pub solver: SolverTable,
    #[serde(default)]
    pub output: Output,
}

/// A boundary or a body coupled to a reference point, on which loads, supports and springs act by its name.
#[derive(Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, rename = "coupling")]
pub(super) struct Coupling {
    /// The name of the reference point.
    pub name: String,
    /// A boundary of the mesh.
    pub boundary: Option<String>,
    /// The body that is rigid, in place of a boundary.
    pub body: Option<String>,
    /// The place of the reference point, m; the centroid of boundary or body unless given.
    pub point: Option<Vector>,
    /// The kind: the nodes move with the point as a rigid body, or forces at the point are distributed over the boundary;
    /// rigid unless given.
    #[serde(default)]
    pub kind: CouplingKind,
}

/// Displacements of a boundary, of the node at a point, or of the reference point of a coupling, zero or prescribed.
#[derive(Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, rename = "support")]
pub(super) struct Support {
    /// A boundary of the mesh.
    pub boundary: Option<String>,
    /// The place of a node, m, in place of a boundary.
    pub point: Option<Vector>,
    /// The name of a coupling, in place of a boundary.
    pub coupling: Option<String>,
    /// The directions that are held: components, the outward normal of the boundary, or rotations of a coupling.
    pub fix: Option<Vec<Fix>>,
    /// The one direction that is held, in place of fix.
    pub direction: Option<Vector>,
    /// Where that is moved: one length (m) or angle (rad) for each direction, in the order of fix. 0 unless given.
    pub displacement: Option<OneOrMany<f64>>,
    /// Points [time (s), factor] of the displacements; from 0 at 0 to 1 at time.end unless given.
    pub history: Option<Vec<Tuple<f64>>>,
}

/// A direction along which a support fixes displacements.
#[derive(Clone, Copy, Deserialize, JsonSchema)]
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

/// An elastic foundation of a boundary, or a spring at the node at a point or at the reference point of a coupling.
#[derive(Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, rename = "spring")]
pub(super) struct Spring {
    /// A boundary of the mesh.
    pub boundary: Option<String>,
    /// The place of a node, m, in place of a boundary.
    pub point: Option<Vector>,
    /// The name of a coupling, in place of a boundary.
    pub coupling: Option<String>,
    /// Along the axes: N/m³ of a boundary, N/m at a point or coupling.
    #[schemars(length(min = 2, max = 3))]
    pub stiffness: Option<Vec<f64>>,
    /// coupling: against its rotation, N m: a number about z in the plane, [x, y, z] in space.
    #[schemars(extend("minimum" = 0))]
    pub rotational: Option<OneOrMany<f64>>,
    /// boundary: along its normal, N/m³. 0 unless given.
    #[schemars(extend("minimum" = 0))]
    pub normal: Option<f64>,
    /// boundary: across its normal, N/m³. 0 unless given.
    #[schemars(extend("minimum" = 0))]
    pub tangential: Option<f64>,
}

/// A boundary that can touch an obstacle, or another boundary (against).
#[derive(Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, rename = "contact")]
pub(super) struct ContactTable {
    /// A boundary of the mesh.
    pub boundary: String,
    /// Coulomb's coefficient, or a formula of x, y, z (m) for it.
    #[schemars(extend("minimum" = 0))]
    pub friction: Option<Scalar>,
    /// Points [time (s), factor], factors of 0 or more, by which it is multiplied.
    pub friction_history: Option<Vec<Tuple<f64>>>,
    /// The obstacles in front of it; of several, each node meets the one that is nearest at first, and of those with one
    /// normal the one that is nearest at the time.
    pub obstacle: Option<OneOrMany<Obstacle>>,
    /// The boundary of another body in front of it, or a list of boundaries, in place of an obstacle.
    pub against: Option<OneOrMany<String>>,
    /// against: whether the two are glued, without friction; false unless given.
    pub glue: Option<bool>,
    /// glue: the vector that moves the opposite boundary in front of the boundary, m, such as the period.
    pub shift: Option<Vector>,
    /// against: how far apart parts of the two may be that belong to each other, m; a tenth of the size of the smaller
    /// one unless given.
    pub search: Option<f64>,
    /// against: the gap when the history begins, m, negative for interference: a number, a formula of x, y, z (m), or
    /// "measured", which it is unless given: between the curved surfaces that facets approximate.
    pub gap: Option<Scalar>,
    /// against: measured gaps and overlaps up to this count as 0, m; 0 unless given.
    #[schemars(extend("minimum" = 0))]
    pub adjust: Option<f64>,
    /// against: the normal for the whole of it, out of the boundary; normals between those of both sides unless given.
    pub direction: Option<Vector>,
    /// against: whose nodes carry the contact forces; those of the boundary unless given.
    pub slave: Option<Slave>,
}

/// A glued contact, such as the section of a bolt, whose sides a force or a shortening pulls towards each other.
#[derive(Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, rename = "pretension")]
pub(super) struct Pretension {
    /// The name of the section.
    pub name: String,
    /// The boundary of a contact with glue = true.
    pub boundary: String,
    /// The force across the section, N, positive for tension.
    pub force: Option<f64>,
    /// The length by which the boundary moves beyond the other side, m, in place of force.
    pub shortening: Option<f64>,
    /// Points [time (s), factor]; from 0 at 0 to 1 at time.end unless given.
    pub history: Option<Vec<Tuple<f64>>>,
    /// force: the time, s, from which the shortening stays as the force made it.
    #[schemars(extend("exclusiveMinimum" = 0))]
    pub lock: Option<f64>,
}

#[derive(Deserialize, JsonSchema)]
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

/// A rigid obstacle.
#[derive(Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, rename = "obstacle")]
pub(super) struct Obstacle {
    /// Its shape.
    pub kind: ObstacleKind,
    /// plane: distance from the nearest point of the boundary, m; negative for interference. 0 unless given.
    pub gap: Option<f64>,
    /// plane: a point of it, m, in place of gap.
    pub through: Option<Vector>,
    /// cylinder, bore, sphere, socket: radius, m.
    pub radius: Option<f64>,
    /// cylinder, sphere: the point nearest to the body; bore, socket: the point that the normal points to from its axis
    /// or centre; cone: its tip; wedge: a point of its ridge, m.
    pub apex: Option<Vector>,
    /// cylinder, bore, sphere, socket: the centre, or a point of the axis, m, in place of apex.
    pub center: Option<Vector>,
    /// cylinder, bore, wedge: direction of the axis or ridge, at right angles to the normal; cone: from the tip into
    /// it, the normal unless given.
    pub axis: Option<Vector>,
    /// wedge: the angle by which each of its planes leans away from the body, rad.
    pub angle: Option<f64>,
    /// cone: the angle between its axis and its surface, rad.
    pub half_angle: Option<f64>,
    /// formula: the gap, m, as a formula of x, y, z (m).
    pub formula: Option<String>,
    /// table: a CSV file; surface: an STL file or a Gmsh file; relative to the scene file.
    pub file: Option<String>,
    /// surface: the length of the file's unit, m; 0.001 for mm. 1 unless given.
    pub scale: Option<f64>,
    /// Gaps along one normal, unless given, or from each node to the nearest point.
    pub direction: Option<GapDirection>,
    /// The distance that it has moved against the normal: points [time (s), distance (m)].
    pub approach: Option<Vec<Tuple<f64>>>,
    pub motion: Option<Motion>,
    /// Direction out of the body towards the obstacle; the boundary's mean outward normal unless given.
    pub normal: Option<Vector>,
    /// Direction of positive slip, at right angles to the normal.
    pub tangent: Option<Vector>,
}

/// The motion of an obstacle, as a rigid body.
#[derive(Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, rename = "motion")]
pub(super) struct Motion {
    /// The translation: points [time, x, y] or [time, x, y, z], s and m.
    #[schemars(inner(length(min = 3, max = 4)))]
    pub translation: Option<Vec<Vec<f64>>>,
    pub rotation: Option<Rotation>,
}

/// The rotation about an axis.
#[derive(Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, rename = "rotation")]
pub(super) struct Rotation {
    /// Direction of the axis; in two dimensions across the plane.
    pub axis: Option<Vector>,
    /// A point of the axis, m.
    pub through: Vector,
    /// Points [time (s), angle (rad)].
    pub history: Vec<Tuple<f64>>,
}

/// A load of the body, one of traction, pressure, force, moment, acceleration, rotation and temperature, times a
/// factor that changes in time.
#[derive(Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, rename = "load")]
pub(super) struct Load {
    /// A boundary of the mesh.
    pub boundary: Option<String>,
    /// force: the place of a node, m, in place of a boundary.
    pub point: Option<Vector>,
    /// The name of a coupling, in place of a boundary.
    pub coupling: Option<String>,
    /// [x, y], in three dimensions [x, y, z], N/m², numbers or formulas of x, y, z (m).
    #[schemars(length(min = 2, max = 3))]
    pub traction: Option<Vec<Scalar>>,
    /// Against the outward normal of each facet, N/m².
    pub pressure: Option<Scalar>,
    /// Spread evenly over the boundary, at the node at the point, or at the reference point of the coupling, N.
    #[schemars(length(min = 2, max = 3))]
    pub force: Option<Vec<f64>>,
    /// coupling: moment at its reference point, N m: a number about z in the plane, [x, y, z] in space.
    pub moment: Option<OneOrMany<f64>>,
    /// Gravity, or the acceleration of the ground, m/s².
    #[schemars(length(min = 2, max = 3))]
    pub acceleration: Option<Vec<f64>>,
    pub rotation: Option<Spin>,
    /// Above that at which the body is free of stress, K.
    pub temperature: Option<Scalar>,
    /// Points [time (s), factor]; from 0 at 0 to 1 at time.end unless given.
    pub history: Option<Vec<Tuple<f64>>>,
}

/// Steady spin about an axis; a history multiplies the force, the square of the speed.
#[derive(Clone, Copy, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, rename = "spin")]
pub(super) struct Spin {
    /// Direction of the axis; in two dimensions across the plane.
    pub axis: Option<Vector>,
    /// A point of the axis, m; that of a body of revolution unless given.
    pub through: Option<Vector>,
    /// Angular speed, rad/s.
    pub speed: f64,
}

/// The history, which starts at 0.
#[derive(Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, rename = "time")]
pub(super) struct Time {
    /// Its end, s.
    #[schemars(extend("exclusiveMinimum" = 0))]
    pub end: f64,
    /// The number of equal increments.
    #[schemars(extend("minimum" = 1))]
    pub increments: i64,
}

/// The solver.
#[derive(Deserialize, JsonSchema, Default)]
#[serde(default, deny_unknown_fields, rename = "solver")]
pub(super) struct SolverTable {
    /// The B-differentiable Newton method, unless given, an interior point method, or the exact path in time.
    pub method: MethodName,
    /// Constants that fit themselves to the scene, unless given, or those of the paper.
    pub setting: Option<Setting>,
    /// The linear algebra; auto, unless given, takes what suits the sizes of body and contact.
    #[schemars(with = "String", extend("enum" = LINEAR))]
    pub linear: Option<Linear>,
    /// linear petsc: options of PETSc, as on its command line.
    pub petsc: Option<String>,
    /// ip, paper: where an increment starts. safe unless given.
    pub start: Option<Start>,
    /// ip, paper: which equations stay positive. products unless given.
    pub partition: Option<Partition>,
    /// bn, default: what r, which comes from the problem, is multiplied by. 1 unless given.
    #[schemars(extend("exclusiveMinimum" = 0))]
    pub r_factor: Option<f64>,
    /// The most iterations an increment may take. 200 unless given.
    #[schemars(extend("minimum" = 1, "maximum" = 1_000_000))]
    pub max_iterations: Option<i64>,
    /// The bound that every component of the error measure must reach. 1e-10 unless given; ip, paper: 1e-6.
    #[schemars(extend("exclusiveMinimum" = 0, "exclusiveMaximum" = 1))]
    pub tolerance: Option<f64>,
}

#[derive(Clone, Copy, Default, Deserialize, JsonSchema)]
#[serde(rename_all = "lowercase")]
pub(super) enum MethodName {
    #[default]
    Bn,
    Ip,
    Events,
}

#[derive(Clone, Copy, Default, Deserialize, JsonSchema)]
#[serde(rename_all = "lowercase")]
pub(super) enum Setting {
    Paper,
    #[default]
    Default,
}

#[derive(Clone, Copy, Deserialize, JsonSchema)]
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

/// A body of several, with a mesh and a material of its own; mesh.element and material.plane are the same in all.
#[derive(Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, rename = "body")]
pub(super) struct BodyTable {
    /// Its name, without a colon: its boundaries are called name:boundary.
    pub name: String,
    /// Where the origin of its mesh is put, m; the origin unless given.
    pub at: Option<Vector>,
    pub mesh: Mesh,
    pub material: Material,
}

#[derive(Deserialize, JsonSchema)]
#[serde(rename_all = "kebab-case")]
pub(super) enum MeshKind {
    Block,
    HalfPlane,
    Gmsh,
    Abaqus,
    Unv,
}

/// The body's mesh.
#[derive(Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, rename = "mesh")]
pub(super) struct Mesh {
    /// A rectangle or a box, a rectangle that is fine at the left end of its top, a file of Gmsh, the mesh in an input
    /// file of Abaqus or CalculiX, or a universal file (UNV) of Salome or I-DEAS.
    pub kind: MeshKind,
    /// block: the lengths along x, y and, for a box, z, m, or a list of the lengths of its segments in place of one.
    /// half-plane: [width, height], m.
    #[schemars(length(min = 2, max = 3))]
    pub size: Option<Vec<OneOrMany<f64>>>,
    /// block: quadrilaterals or triangles, hexahedra, tetrahedra or prisms; names with a number of nodes are of second
    /// order.
    pub cells: Option<CellKind>,
    /// gmsh, abaqus, unv: the mesh file, relative to the scene file.
    pub file: Option<String>,
    /// gmsh, abaqus, unv: the length of the file's unit, m; 0.001 for mm. 1 unless given.
    pub scale: Option<f64>,
    /// The strains of the elements: for poisson close to 0.5 b-bar, and for triangles, tetrahedra, prisms and cells of
    /// second order nodal-volume. bilinear unless given.
    pub element: Option<Element>,
    /// block: numbers of elements for each length in size.
    #[schemars(length(min = 2, max = 3))]
    pub elements: Option<Vec<OneOrMany<i64>>>,
    /// block: size of the last element over that of the first, for each length in size, 1e-6 to 1e6.
    #[schemars(length(min = 2, max = 3))]
    pub grading: Option<Vec<OneOrMany<f64>>>,
    /// block: its lowest corner, m, such as [r, 0] of a ring of the inner radius r; the origin unless given.
    pub origin: Option<Vector>,
    /// half-plane: width of the boundary contact from x = 0, m.
    pub contact_width: Option<f64>,
    /// half-plane: equal elements along contact.
    pub contact_elements: Option<i64>,
    /// half-plane: equal elements along the rest of the top.
    pub outer_elements: Option<i64>,
    /// half-plane: layers, in geometric progression downwards.
    pub layers: Option<i64>,
    /// The error of the stresses in the energy norm up to which a mesh of triangles or tetrahedra refines itself; 0.02 for 2 %.
    #[schemars(extend("exclusiveMinimum" = 0, "exclusiveMaximum" = 1))]
    pub refine: Option<f64>,
}

/// The isotropic linear elastic material; in two dimensions of unit thickness.
#[derive(Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, rename = "material")]
pub(super) struct Material {
    /// Young's modulus, Pa.
    #[schemars(extend("exclusiveMinimum" = 0))]
    pub young: f64,
    /// Poisson's ratio.
    #[schemars(extend("exclusiveMinimum" = -1, "exclusiveMaximum" = 0.5))]
    pub poisson: f64,
    /// Two dimensions: plane strain, unless given, plane stress, or half the section of a body of revolution about x =
    /// 0.
    pub plane: Option<Plane>,
    /// Plane bodies: the thickness, m; forces, moments and energies are then those of the whole body, otherwise per
    /// unit of depth.
    #[schemars(extend("exclusiveMinimum" = 0))]
    pub thickness: Option<f64>,
    /// Mass density, kg/m³; needed by loads that act on the mass.
    #[schemars(extend("exclusiveMinimum" = 0))]
    pub density: Option<f64>,
    /// Coefficient of thermal expansion, 1/K; needed by loads by temperature.
    pub expansion: Option<f64>,
    /// Horizontal layers from the bottom up, each [thickness (m), young (Pa), poisson].
    #[serde(default)]
    pub layers: Vec<Tuple<f64, 3>>,
    /// The materials of groups of elements; other groups are of the material itself.
    #[serde(default)]
    pub group: Vec<MaterialGroup>,
}

/// The output.
#[derive(Deserialize, JsonSchema, Default)]
#[serde(default, deny_unknown_fields, rename = "output")]
pub(super) struct Output {
    /// Times (s) whose contact lines or surfaces are written, each at the first increment that reaches it, 0 before the
    /// first; or all, the beginning and every increment. The end unless given.
    #[schemars(with = "Value", extend("anyOf" = [{"const": "all"}, {"type": "array", "items": {"type": "number", "minimum": 0}}]))]
    pub times: Option<Times>,
    /// Every so many increments, and the last, are written besides.
    #[schemars(extend("minimum" = 1))]
    pub every: Option<i64>,
    /// true if the fields of the body are written for the same times.
    pub fields: bool,
    /// true if pictures of the deformed body are drawn for the same times.
    pub deformed: bool,
    /// The magnification of displacements there; chosen unless given.
    #[schemars(extend("minimum" = 0))]
    pub magnification: Option<f64>,
    /// The load cycle whose slip, friction work and stresses are written: the times of its beginning and its end, s, or
    /// last, the one that ends with the history.
    #[schemars(with = "Value", extend("anyOf" = [{"const": "last"}, {"type": "array", "minItems": 2, "maxItems": 2, "items": {"type": "number", "minimum": 0}}]))]
    pub cycle: Option<Cycle>,
    /// Archard's coefficient for the wear depth of the cycle, 1/Pa: depth = coefficient · ∫ pressure d(slip path).
    #[schemars(extend("exclusiveMinimum" = 0))]
    pub wear_coefficient: Option<f64>,
    /// Points whose displacements and stresses are written in every increment.
    pub probe: Vec<Probe>,
}

/// A point of the body, or a row of them on a line.
#[derive(Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, rename = "probe")]
pub(super) struct Probe {
    /// The name of its file.
    pub name: String,
    /// The point, m.
    pub point: Option<Vector>,
    /// The first point of a line, m.
    pub from: Option<Vector>,
    /// The last point of a line, m.
    pub to: Option<Vector>,
    /// The number of points on the line, its ends included.
    #[schemars(extend("minimum" = 2, "maximum" = 10_000))]
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
