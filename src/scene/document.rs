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
use crate::solver::history::{LinearAlgebra, Start};

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
    /// Name of the reference point.
    /// Example: `name = "handle"`. Value: name.
    pub name: String,
    /// Boundary that is coupled.
    /// Example: `boundary = "top"`. Value: name. Default: this or `body`.
    pub boundary: Option<String>,
    /// Body that is rigid.
    /// Example: `body = "punch"`. Value: name. Default: this or `boundary`.
    pub body: Option<String>,
    /// Position of the reference point; it need not be in the body.
    /// Example: `point = [0, 0.1]`. Value: point, m. Default: centroid of boundary or body.
    pub point: Option<Vector>,
    /// Kind of the coupling: the nodes move with the point as a rigid body, or forces at the point are distributed
    /// over the boundary.
    /// Example: `kind = "rigid"`. Default: `"rigid"`.
    #[serde(default)]
    pub kind: CouplingKind,
}

/// Displacements of a boundary, of the node at a point, or of the reference point of a coupling, zero or prescribed.
#[derive(Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, rename = "support")]
pub(super) struct Support {
    /// Boundary that is held.
    /// Example: `boundary = "top"`. Value: name. Default: one of three.
    pub boundary: Option<String>,
    /// Node that is held, exact to a millionth of the body's size.
    /// Example: `point = [0, 0.1]`. Value: point, m. Default: one of three.
    pub point: Option<Vector>,
    /// Reference point of a [coupling](coupling.md) that is held.
    /// Example: `coupling = "handle"`. Value: name. Default: one of three.
    pub coupling: Option<String>,
    /// Directions that are held: axes, the outward normal of the boundary, or rotations of a coupling.
    /// Example: `fix = ["x", "y"]`. Value: list of `"x"`, `"y"`, `"z"`, `"normal"`; for a coupling also
    /// `"rotation_x"`, `"rotation_y"`, `"rotation_z"`. Default: this or `direction`.
    pub fix: Option<Vec<Fix>>,
    /// The one direction that is held.
    /// Example: `direction = [1, 1]`. Value: vector of any length. Default: this or `fix`.
    pub direction: Option<Vector>,
    /// Prescribed displacement or rotation for each direction, in the order of `fix`.
    /// Example: `displacement = [0, -1e-4]`. Value: number or list, m; rad for rotations. Default: 0.
    pub displacement: Option<OneOrMany<f64>>,
    /// [History](time.md#histories) of the displacement.
    /// Example: `history = [[0, 0], [0.5, 1], [1, 1]]`. Value: points `[time, factor]`, s. Default: from 0 at 0 to
    /// 1 at `time.end`.
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
    /// Boundary on a foundation.
    /// Example: `boundary = "bottom"`. Value: name. Default: one of three.
    pub boundary: Option<String>,
    /// Node with a spring.
    /// Example: `point = [0, 0.1]`. Value: point, m. Default: one of three.
    pub point: Option<Vector>,
    /// Reference point of a [coupling](coupling.md) with a spring.
    /// Example: `coupling = "handle"`. Value: name. Default: one of three.
    pub coupling: Option<String>,
    /// Stiffness along the normal of the boundary.
    /// Example: `normal = 1e9`. Value: number, N/m³. Default: 0.
    #[schemars(extend("minimum" = 0))]
    pub normal: Option<f64>,
    /// Stiffness across the normal of the boundary.
    /// Example: `tangential = 1e8`. Value: number, N/m³. Default: 0.
    #[schemars(extend("minimum" = 0))]
    pub tangential: Option<f64>,
    /// Stiffness against the rotation of a coupling, moment per angle: about z in the plane, about x, y, z in
    /// space.
    /// Example: `rotational = 1e4`. Value: number, N m; in space a vector.
    #[schemars(extend("minimum" = 0))]
    pub rotational: Option<OneOrMany<f64>>,
    /// Stiffness along the axes, in place of `normal` and `tangential`.
    /// Example: `stiffness = [1e6, 0]`. Value: vector, N/m³ (boundary) or N/m (point, coupling).
    #[schemars(length(min = 2, max = 3))]
    pub stiffness: Option<Vec<f64>>,
}

/// A boundary that can touch an obstacle, or another boundary (against).
#[derive(Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, rename = "contact")]
pub(super) struct ContactTable {
    /// Boundary that can touch, between bodies the slave; once in all contacts.
    /// Example: `boundary = "bottom"`. Value: name.
    pub boundary: String,
    /// Coulomb's coefficient μ, such as `"0.1 + 0.2 * x"`.
    /// Example: `friction = 0.3`. Value: number, or a [formula](formulas.md) of x, y, z. Default:
    /// required unless glued.
    #[schemars(extend("minimum" = 0))]
    pub friction: Option<Scalar>,
    /// Factor on the friction, as for a contact that is greased at first: `[[0, 0], [1, 0], [2, 1]]`.
    /// Example: `friction_history = [[0, 0.1], [1, 1]]`. Value: points `[time, factor]`, s, factors ≥ 0. Default:
    /// constant.
    pub friction_history: Option<Vec<Tuple<f64>>>,
    /// Rigid [obstacle](obstacle.md) in front of it. Of several, each node meets the one that is nearest at first,
    /// and of those with one normal the one that is nearest at the time.
    /// Example: `obstacle = { kind = "plane" }`. Value: table or list of tables. Default: this or `against`.
    pub obstacle: Option<OneOrMany<Obstacle>>,
    /// Boundary of another body in front of it, the master; several count as one.
    /// Example: `against = "lower:top"`. Value: name or list of names. Default: this or `obstacle`.
    pub against: Option<OneOrMany<String>>,
    /// against: Neither part nor slide; without friction.
    /// Example: `glue = true`. Default: `false`.
    pub glue: Option<bool>,
    /// against: With `glue`: vector that moves `against` in front of `boundary`, such as the
    /// [period](#periodic-boundaries).
    /// Example: `shift = [0.3, 0]`. Value: vector, m. Default: none.
    pub shift: Option<Vector>,
    /// against: Gap at the beginning, negative for interference; `"measured"`: between the meshes, or between the
    /// [curved surfaces](#press-fit) that they approximate.
    /// Example: `gap = -2e-5`. Value: number or formula, m, or `"measured"`. Default: `"measured"`.
    pub gap: Option<Scalar>,
    /// against: Measured gaps and overlaps up to this count as 0, and always those up to 8 roundings of the largest
    /// coordinate.
    /// Example: `adjust = 1e-6`. Value: length, m. Default: 0.
    #[schemars(extend("minimum" = 0))]
    pub adjust: Option<f64>,
    /// against: Largest distance at which parts of the two are paired.
    /// Example: `search = 0.01`. Value: length, m. Default: a tenth of the longest side of the box around the
    /// smaller boundary.
    pub search: Option<f64>,
    /// against: One normal for all, out of `boundary`.
    /// Example: `direction = [0, -1]`. Value: vector. Default: at each node, between the normals of both sides.
    pub direction: Option<Vector>,
    /// against: Side whose nodes carry the contact forces.
    /// Example: `slave = "automatic"`. Default: `"boundary"`.
    pub slave: Option<Slave>,
}

/// A glued contact, such as the section of a bolt, whose sides a force or a shortening pulls towards each other.
#[derive(Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, rename = "pretension")]
pub(super) struct Pretension {
    /// Name of the section in results.
    /// Example: `name = "bolt"`. Value: name.
    pub name: String,
    /// `boundary` of a contact with `glue = true`.
    /// Example: `boundary = "shank:top"`. Value: name.
    pub boundary: String,
    /// Force across the section, positive for tension. Plane bodies without thickness: N per m of depth; bodies of
    /// revolution: over the full circumference.
    /// Example: `force = 10e3`. Value: number, N. Default: this or `shortening`.
    pub force: Option<f64>,
    /// Length by which the bolt is shortened: its boundary moves so far beyond the other side.
    /// Example: `shortening = 2e-5`. Value: number, m. Default: this or `force`.
    pub shortening: Option<f64>,
    /// Factor on force or shortening.
    /// Example: `history = [[0, 0], [1, 1]]`. Value: points `[time, factor]`, s. Default: from 0 at 0 to 1 at
    /// `time.end`.
    pub history: Option<Vec<Tuple<f64>>>,
    /// Time from which the shortening stays as the `force` made it. An increment ends there.
    /// Example: `lock = 1`. Value: time, s, below `time.end`. Default: never.
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
    /// Shape.
    /// Example: `kind = "plane"`.
    pub kind: ObstacleKind,
    /// plane: Distance from the nearest point of the boundary; negative for interference.
    /// Example: `gap = 1e-4`. Value: number, m. Default: 0.
    pub gap: Option<f64>,
    /// plane: A point of the plane, in place of `gap`.
    /// Example: `through = [0, -0.1]`. Value: point, m.
    pub through: Option<Vector>,
    /// cylinder, bore, sphere, socket: Radius. Bore and socket are around the body.
    /// Example: `radius = 0.05`. Value: length, m, > 0. Default: required.
    pub radius: Option<f64>,
    /// cylinder, sphere: Point nearest to the body.
    /// Example: `apex = [0, 0]`. Value: point, m. Default: this or `center`.
    ///
    /// bore, socket: Point that the normal points to from the axis or centre.
    /// Example: `apex = [0, 0]`. Value: point, m. Default: this or `center`.
    ///
    /// cone: Tip. In space, or about the axis of a body of revolution.
    /// Example: `apex = [0, 0]`. Value: point, m. Default: required.
    ///
    /// wedge: Point of the ridge.
    /// Example: `apex = [0, 0]`. Value: point, m. Default: required.
    pub apex: Option<Vector>,
    /// cylinder, bore, sphere, socket: Centre or a point of the axis; use it in studies of the radius.
    /// Example: `center = [0, -0.05]`. Value: point, m. Default: this or `apex`.
    pub center: Option<Vector>,
    /// cylinder, bore, wedge: Axis or ridge, at right angles to the normal.
    /// Example: `axis = [0, 1, 0]`. Value: vector. Default: required in space.
    ///
    /// cone: From the tip into it.
    /// Example: `axis = [0, 0, -1]`. Value: vector. Default: the normal.
    pub axis: Option<Vector>,
    /// wedge: Angle by which each plane leans away from the body.
    /// Example: `angle = 0.1`. Value: number, rad. Default: required.
    pub angle: Option<f64>,
    /// cone: Angle between axis and surface.
    /// Example: `half_angle = 0.5`. Value: number, rad. Default: required.
    pub half_angle: Option<f64>,
    /// formula: Gap at the position of a node.
    /// Example: `formula = "0.5 * x^2 / 0.1"`. Value: [formula](formulas.md) of x, y, z, m. Default: required.
    pub formula: Option<String>,
    /// table: [Table of gaps](#tables-of-gaps), a CSV file, relative to the scene file.
    /// Example: `file = "gaps.csv"`. Value: path. Default: required.
    ///
    /// surface: [STL or Gmsh file](#surfaces), relative to the scene file.
    /// Example: `file = "die.stl"`. Value: path. Default: required.
    pub file: Option<String>,
    /// surface: Length of the file's unit; 0.001 for mm.
    /// Example: `scale = 0.001`. Value: length, m. Default: 1, or `[units]`.
    pub scale: Option<f64>,
    /// Gaps along one normal, or to the nearest point (not plane, formula, table).
    /// Example: `direction = "nearest"`. Default: `"normal"`.
    pub direction: Option<GapDirection>,
    /// Out of the body, towards the obstacle. A closed rim has no mean normal.
    /// Example: `normal = [0, -1]`. Value: vector. Default: mean outward normal of the boundary.
    pub normal: Option<Vector>,
    /// Direction of positive slip; needs `normal`.
    /// Example: `tangent = [1, 0]`. Value: vector across `normal`. Default: see
    /// [signs](../results.md#signs-and-directions).
    pub tangent: Option<Vector>,
    /// Motion against the normal, into the body.
    /// Example: `approach = [[0, 0], [1, 1e-3]]`. Value: points `[time, distance]`, s, m. Default: at rest.
    pub approach: Option<Vec<Tuple<f64>>>,
    pub motion: Option<Motion>,
}

/// The motion of an obstacle, as a rigid body.
#[derive(Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, rename = "motion")]
pub(super) struct Motion {
    /// Displacement.
    /// Example: `motion.translation = [[1, 0, 0], [2, 1e-3, 0]]`. Value: points `[time, x, y]`, in space `[time, x,
    /// y, z]`, s, m. Default: at rest.
    #[schemars(inner(length(min = 3, max = 4)))]
    pub translation: Option<Vec<Vec<f64>>>,
    /// Rotation about an axis.
    /// Example: `motion.rotation = { through = [0, 0], history = [[0, 0], [1, 0.1]] }`. Value: table, below.
    /// Default: at rest.
    pub rotation: Option<Rotation>,
}

/// The rotation about an axis.
#[derive(Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, rename = "rotation")]
pub(super) struct Rotation {
    /// Direction of the axis; in two dimensions across the plane.
    /// Example: `axis = [0, 0, 1]`. Value: vector. Default: required in space.
    pub axis: Option<Vector>,
    /// A point of the axis.
    /// Example: `through = [0, 0, 0]`. Value: point, m.
    pub through: Vector,
    /// Angle.
    /// Example: `history = [[0, 0], [1, 0.1]]`. Value: points `[time, angle]`, s, rad.
    pub history: Vec<Tuple<f64>>,
}

/// A load of the body, one of traction, pressure, force, moment, acceleration, rotation and temperature, times a
/// factor that changes in time.
#[derive(Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, rename = "load")]
pub(super) struct Load {
    /// Force per area on `boundary`.
    /// Example: `traction = [0, -5e6]`. Value: vector of numbers or [formulas](formulas.md) of x, y, z, N/m².
    #[schemars(length(min = 2, max = 3))]
    pub traction: Option<Vec<Scalar>>,
    /// Pressure on `boundary`, against the outward normal of each facet.
    /// Example: `pressure = "5e6 * (1 - y / 0.2)"`. Value: number or formula, N/m².
    pub pressure: Option<Scalar>,
    /// Force spread evenly over `boundary`, at the node at `point`, or at the reference point of `coupling`.
    /// Example: `force = [0, -1000]`. Value: vector, N.
    #[schemars(length(min = 2, max = 3))]
    pub force: Option<Vec<f64>>,
    /// Moment at the reference point of `coupling`: about z in the plane, about x, y, z in space.
    /// Example: `moment = 50`. Value: number, N m; in space a vector.
    pub moment: Option<OneOrMany<f64>>,
    /// Gravity, or acceleration of the ground; needs `density`.
    /// Example: `acceleration = [0, -9.81]`. Value: vector, m/s².
    #[schemars(length(min = 2, max = 3))]
    pub acceleration: Option<Vec<f64>>,
    /// Steady spin about an axis, with the force `density · speed² · r`.
    /// Example: `rotation = { through = [0, 0], speed = 300 }`. Value: table, below.
    pub rotation: Option<Spin>,
    /// Temperature above that of the stress-free body, with the strain `expansion · temperature`.
    /// Example: `temperature = 80`. Value: number or formula, K.
    pub temperature: Option<Scalar>,
    /// Where a traction, pressure or force acts.
    /// Example: `boundary = "top"`. Value: name.
    pub boundary: Option<String>,
    /// Node at which a force acts.
    /// Example: `point = [0.2, 0.1]`. Value: point, m.
    pub point: Option<Vector>,
    /// [Coupling](coupling.md) on which a force or a moment acts.
    /// Example: `coupling = "handle"`. Value: name.
    pub coupling: Option<String>,
    /// [History](time.md#histories) of the whole load; of `rotation` it multiplies the square of the speed.
    /// Example: `history = [[0, 1]]`. Value: points `[time, factor]`, s. Default: from 0 at 0 to 1 at `time.end`.
    pub history: Option<Vec<Tuple<f64>>>,
}

/// Steady spin about an axis; a history multiplies the force, the square of the speed.
#[derive(Clone, Copy, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, rename = "spin")]
pub(super) struct Spin {
    /// Direction of the axis; in two dimensions across the plane, or the axis of revolution.
    /// Example: `axis = [0, 0, 1]`. Value: vector. Default: required in space.
    pub axis: Option<Vector>,
    /// A point of the axis.
    /// Example: `through = [0, 0, 0]`. Value: point, m. Default: required, except for bodies of revolution.
    pub through: Option<Vector>,
    /// Angular speed.
    /// Example: `speed = 300`. Value: number, rad/s.
    pub speed: f64,
}

/// The history, which starts at 0.
#[derive(Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, rename = "time")]
pub(super) struct Time {
    /// End of the history, which begins at 0.
    /// Example: `end = 2.0`. Value: number, s.
    #[schemars(extend("exclusiveMinimum" = 0))]
    pub end: f64,
    /// Number of equal increments.
    /// Example: `increments = 20`. Value: integer.
    #[schemars(extend("minimum" = 1))]
    pub increments: i64,
}

/// The solver.
#[derive(Deserialize, JsonSchema, Default)]
#[serde(default, deny_unknown_fields, rename = "solver")]
pub(super) struct SolverTable {
    /// [Which to take](../../howto/choose-a-method.md): the B-differentiable Newton method `bn`, the interior point
    /// method `ip`, or the [exact path in time](../../method/exact-path.md) `events`, in which increments are
    /// output times.
    /// Example: `method = "ip"`. Default: `"bn"`.
    pub method: MethodName,
    /// Linear solver; `"auto"` takes the one estimated to be the fastest.
    /// Example: `linear = "auto"`. Value: see below. Default: see below.
    #[serde(deserialize_with = "linear")]
    #[schemars(with = "String", extend("enum" = LINEAR))]
    #[allow(clippy::option_option)]
    pub linear: Option<Option<LinearAlgebra>>,
    /// `linear = "petsc"`: [options of PETSc](../../howto/large-bodies.md#options-of-petsc), as on its command
    /// line.
    /// Example: `petsc = "-ksp_monitor"`. Value: text. Default: none.
    pub petsc: Option<String>,
    /// Limit for each relative error of the error measure.
    /// Example: `tolerance = 1e-8`. Default: 1e-10; `ip` with `paper`: 1e-6.
    #[schemars(extend("exclusiveMinimum" = 0, "exclusiveMaximum" = 1))]
    pub tolerance: Option<f64>,
    /// Limit in an increment, or a substep.
    /// Example: `max_iterations = 500`. Value: integer. Default: 200.
    #[schemars(extend("minimum" = 1, "maximum" = 1_000_000))]
    pub max_iterations: Option<i64>,
    /// Constants that adapt to the scene, or those of the [paper](../../method/theory.md).
    /// Example: `setting = "paper"`. Default: `"default"`.
    pub setting: Option<Setting>,
    /// `bn`, `default`: factor on r, which comes from the problem, for studies.
    /// Example: `r_factor = 10`. Default: 1.
    #[schemars(extend("exclusiveMinimum" = 0))]
    pub r_factor: Option<f64>,
    /// `ip`, `paper`: start of an increment.
    /// Example: `start = "prev"`. Default: `"safe"`.
    #[serde(deserialize_with = "start")]
    #[schemars(with = "String", extend("enum" = STARTS))]
    pub start: Option<Start>,
    /// `ip`, `paper`: equations that stay positive, (29)–(31) or (26)–(28).
    /// Example: `partition = "cone"`. Default: `"products"`.
    pub partition: Option<Partition>,
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

/// Reads `solver.start`.
fn start<'de, D: Deserializer<'de>>(deserializer: D) -> Result<Option<Start>, D::Error> {
    match &*String::deserialize(deserializer)? {
        "safe" => Ok(Some(Start::Safe)),
        "prev" => Ok(Some(Start::PREV)),
        other => Err(de::Error::unknown_variant(other, &STARTS)),
    }
}

/// The words of `solver.start`.
const STARTS: [&str; 2] = ["safe", "prev"];

/// Reads `solver.linear`; `None` in it for `auto`.
#[allow(clippy::option_option)] // The outer one tells whether the key is given.
fn linear<'de, D: Deserializer<'de>>(deserializer: D) -> Result<Option<Option<LinearAlgebra>>, D::Error> {
    let word = String::deserialize(deserializer)?;
    let known = if word == "auto" { Ok(None) } else { word.parse().map(Some) };
    known.map(Some).map_err(|_| de::Error::unknown_variant(&word, &LINEAR))
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
    /// Name of the body; its boundaries are called `roller:hub`.
    /// Example: `name = "roller"`. Value: name without a colon.
    pub name: String,
    /// Where the origin of its mesh is placed.
    /// Example: `at = [0.1, 0.15]`. Value: point, m. Default: origin.
    pub at: Option<Vector>,
    /// Mesh of the body, with all keys of [`[mesh]`](mesh.md); equal `element` in all bodies.
    /// Example: `mesh = { kind = "gmsh", file = "roller.msh" }`. Value: table.
    pub mesh: Mesh,
    /// Material of the body, with all keys of [`[material]`](material.md) except `layers`; equal `plane` in all
    /// bodies.
    /// Example: `material = { young = 210e9, poisson = 0.3 }`. Value: table.
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
    /// Rectangle or box; rectangle that is fine at the left end of its top; [mesh file](#mesh-files) of Gmsh; mesh
    /// of an input file of Abaqus or CalculiX; universal file of Salome or I-DEAS.
    /// Example: `kind = "block"`.
    pub kind: MeshKind,
    /// Error of the stresses in the energy norm up to which a mesh [refines
    /// itself](#meshes-that-refine-themselves), where it has triangles or tetrahedra; 0.02 for 2 %.
    /// Example: `refine = 0.05`.
    #[schemars(extend("exclusiveMinimum" = 0, "exclusiveMaximum" = 1))]
    pub refine: Option<f64>,
    /// Strains of the elements, see [nearly incompressible materials](#nearly-incompressible-materials): for
    /// `poisson` close to 0.5 `b-bar`, and for triangles, tetrahedra, prisms and cells of second order
    /// `nodal-volume`.
    /// Example: `element = "b-bar"`. Default: `"bilinear"`.
    pub element: Option<Element>,
    /// block: Lengths along x, y and z. A list in place of a length gives segments.
    /// Example: `size = [0.2, 0.1]`. Value: 2 or 3 lengths, m. Default: required.
    ///
    /// half-plane: Width and height.
    /// Example: `size = [1.0, 1.0]`. Value: 2 lengths, m. Default: required.
    #[schemars(length(min = 2, max = 3))]
    pub size: Option<Vec<OneOrMany<f64>>>,
    /// block: Elements along each length or segment.
    /// Example: `elements = [40, 20]`. Value: 2 or 3 integers. Default: required.
    #[schemars(length(min = 2, max = 3))]
    pub elements: Option<Vec<OneOrMany<i64>>>,
    /// block: Size of the last element over that of the first, in geometric progression.
    /// Example: `grading = [1, 0.2]`. Value: 2 or 3 numbers, 1e-6 to 1e6. Default: 1.
    #[schemars(length(min = 2, max = 3))]
    pub grading: Option<Vec<OneOrMany<f64>>>,
    /// block: Lowest corner, such as `[r, 0]` of a ring with the inner radius r.
    /// Example: `origin = [0.1, 0]`. Value: point, m. Default: origin.
    pub origin: Option<Vector>,
    /// block: Shape of the elements; names with a number of nodes are of second order.
    /// Example: `cells = "triangle6"`. Value: see below. Default: quadrilaterals, hexahedra.
    pub cells: Option<CellKind>,
    /// half-plane: Width of `contact`, from x = 0.
    /// Example: `contact_width = 0.1`. Value: length, m. Default: required.
    pub contact_width: Option<f64>,
    /// half-plane: Equal elements along `contact`.
    /// Example: `contact_elements = 40`. Value: integer. Default: required.
    pub contact_elements: Option<i64>,
    /// half-plane: Equal elements along the rest of the top.
    /// Example: `outer_elements = 20`. Value: integer. Default: required.
    pub outer_elements: Option<i64>,
    /// half-plane: Layers in geometric progression downwards, the top one square in the contact zone.
    /// Example: `layers = 30`. Value: integer. Default: required.
    pub layers: Option<i64>,
    /// gmsh, abaqus, unv: Mesh file, relative to the scene file.
    /// Example: `file = "part.msh"`. Value: path. Default: required.
    pub file: Option<String>,
    /// gmsh, abaqus, unv: Length of the file's unit; 0.001 for mm.
    /// Example: `scale = 0.001`. Value: length, m. Default: 1, or `[units]`.
    pub scale: Option<f64>,
}

/// The isotropic linear elastic material; in two dimensions of unit thickness.
#[derive(Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, rename = "material")]
pub(super) struct Material {
    /// Young's modulus.
    /// Example: `young = 210e9`. Value: number, Pa.
    #[schemars(extend("exclusiveMinimum" = 0))]
    pub young: f64,
    /// Poisson's ratio.
    /// Example: `poisson = 0.3`.
    #[schemars(extend("exclusiveMinimum" = -1, "exclusiveMaximum" = 0.5))]
    pub poisson: f64,
    /// Plane body, or half the section of a body of revolution about x = 0.
    /// Example: `plane = "stress"`. Default: `"strain"`.
    pub plane: Option<Plane>,
    /// Thickness of a plane body, equal in all bodies. Forces, moments, point springs and energies of scene and
    /// results are then those of the whole body.
    /// Example: `thickness = 0.02`. Value: length, m. Default: unit depth.
    #[schemars(extend("exclusiveMinimum" = 0))]
    pub thickness: Option<f64>,
    /// Mass density, for the loads `acceleration` and `rotation`.
    /// Example: `density = 7850`. Value: number, kg/m³.
    #[schemars(extend("exclusiveMinimum" = 0))]
    pub density: Option<f64>,
    /// Coefficient of thermal expansion, for the load `temperature`; bodies that stay cold need none.
    /// Example: `expansion = 12e-6`. Value: number, 1/K.
    pub expansion: Option<f64>,
    /// Layers from the bottom up (along y, in space z). An element belongs to the layer at its centre; above them
    /// is the material itself.
    /// Example: `layers = [[0.01, 70e9, 0.33]]`. Value: list of `[thickness, young, poisson]`, m, Pa, –.
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
    /// Times of contact tables and pictures, at the first increment that reaches each; 0 is the undeformed body;
    /// `"all"`: 0 and every increment.
    /// Example: `times = [0, 1.0, 2.0]`. Value: list of times, s, or `"all"`. Default: `[end]`; none with `every`.
    #[schemars(with = "Value", extend("anyOf" = [{"const": "all"}, {"type": "array", "items": {"type": "number", "minimum": 0}}]))]
    pub times: Option<Times>,
    /// Also every so many increments, and the last. Not with `"all"`.
    /// Example: `every = 10`. Value: integer.
    #[schemars(extend("minimum" = 1))]
    pub every: Option<i64>,
    /// Fields for ParaView at these times.
    /// Example: `fields = true`. Default: `false`.
    pub fields: bool,
    /// Pictures of the deformed body at these times.
    /// Example: `deformed = true`. Default: `false`.
    pub deformed: bool,
    /// Their factor on displacements. Automatic: 1, 2 or 5 times a power of ten, at least 1, with which the longest
    /// is at most a twentieth of the body.
    /// Example: `magnification = 100`. Default: automatic.
    #[schemars(extend("minimum" = 0))]
    pub magnification: Option<f64>,
    /// Load cycle whose slip, friction work and stresses are written to [`cycle.csv`](../results.md#columns) and
    /// `run.json`. Increments end at both times. `"last"`: the last whole cycle. It ends with the last increment in
    /// which a load changes, and begins one period earlier: loads, motions and friction factors have the same
    /// values there, and change in the same direction.
    /// Example: `cycle = [1.0, 2.0]`. Value: two times, s, or `"last"`.
    #[schemars(with = "Value", extend("anyOf" = [{"const": "last"}, {"type": "array", "minItems": 2, "maxItems": 2, "items": {"type": "number", "minimum": 0}}]))]
    pub cycle: Option<Cycle>,
    /// Archard's coefficient k: `cycle.csv` has the wear depth of the cycle, k ∫ pressure d(slip path).
    /// Example: `wear_coefficient = 1e-14`. Value: number, 1/Pa.
    #[schemars(extend("exclusiveMinimum" = 0))]
    pub wear_coefficient: Option<f64>,
    /// Points whose displacements and stresses are written in every increment.
    pub probe: Vec<Probe>,
}

/// A point of the body, or a row of them on a line.
#[derive(Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, rename = "probe")]
pub(super) struct Probe {
    /// Part of the file name, `probe_root.csv`.
    /// Example: `name = "root"`. Value: text.
    pub name: String,
    /// The point.
    /// Example: `point = [0.1, 0.05]`. Value: point, m. Default: this or a line.
    pub point: Option<Vector>,
    /// First point of a line.
    /// Example: `from = [0, 0.05]`. Value: point, m.
    pub from: Option<Vector>,
    /// Last point of the line.
    /// Example: `to = [0.2, 0.05]`. Value: point, m.
    pub to: Option<Vector>,
    /// Equally spaced points, ends included.
    /// Example: `points = 21`. Value: integer.
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
