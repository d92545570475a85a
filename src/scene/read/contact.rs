//! The contacts of a scene, boundaries in front of obstacles or of each other, and the obstacles: their tables, and what
//! they become.

use super::{
    Deserialize, JsonSchema, KEEP_ONE, OneOrMany, Reader, Scalar, Tuple, at_most_one, given, needed, only, points,
    reject_keys,
};
use crate::algebra::vector::Vector;
use crate::base::input_error::{InputError, each};
use crate::base::units::Quantity;
use crate::body::contact::{GapDirection, Obstacle, Place, Rotation, Shape};
use crate::body::description::{Against, Contact, Opposite, Slave};

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
    pub obstacle: Option<OneOrMany<ObstacleTable>>,
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

/// Converts a contact.
pub(super) fn contact(mut given: ContactTable, reader: Reader<'_>) -> Result<Contact, InputError> {
    let help = "give Coulomb's coefficient, or a formula of x, y and z for it, in m or as [units] says, such as \"0.1 + 0.2 * x\"";
    let friction = given.friction.take().map(|x| reader.field(Quantity::Number, "friction", x, help)).transpose()?;
    let is_glued = given.glue.unwrap_or(false);
    let against = match (given.obstacle.take(), given.against.take()) {
        (Some(_), Some(_)) => {
            let help = "keep one of them; a boundary that meets both takes two [[contact]]s with parts of it";
            let message = "a contact has both an obstacle and a boundary that it is against";
            return Err(InputError::new("against", message, help));
        }
        (None, None) => {
            let help = "add [contact.obstacle], or against = \"name of a boundary\"";
            return Err(InputError::new("", "a contact needs an obstacle or a boundary that it is against", help));
        }
        (Some(obstacles), None) => {
            let keys = given!(given; glue shift search gap adjust direction slave);
            reject_keys("a contact with an obstacle", keys)?;
            Against::Obstacles(match obstacles {
                OneOrMany::One(one) => {
                    vec![self::obstacle(one, reader).map_err(|fault| fault.with_key("obstacle"))?]
                }
                OneOrMany::Many(all) => each("obstacle", all, |_, one| self::obstacle(one, reader))?,
            })
        }
        (None, Some(names)) => {
            if is_glued {
                let keys = [("friction", friction.is_some()), ("friction_history", given.friction_history.is_some())];
                reject_keys("what is glued", &keys)?;
            }
            Against::Boundary(opposite(names, &given, reader)?)
        }
    };
    let help = "add friction = 0.3, or 0 without friction";
    let missing = || InputError::new("friction", "a contact needs its friction", help);
    let friction = if is_glued { 0.0.into() } else { friction.ok_or_else(missing)? };
    let friction_history = given.friction_history.map(points);
    Ok(Contact { boundary: given.boundary, friction, friction_history, against })
}

fn opposite(names: OneOrMany<String>, given: &ContactTable, reader: Reader<'_>) -> Result<Opposite, InputError> {
    let help = "give \"measured\", a number, or a formula of x, y and z, in m or as [units] says";
    Ok(Opposite {
        boundaries: names.into_vec(),
        glued: given.glue.unwrap_or(false),
        shift: given.shift.map(|shift| reader.point(shift)),
        search: given.search.map(|search| reader.length(search)),
        gap: match &given.gap {
            Some(Scalar::Text(text)) if text == "measured" || text == "curved" => None,
            given => given.clone().map(|gap| reader.field(Quantity::Length, "gap", gap, help)).transpose()?,
        },
        adjust: reader.length(given.adjust.unwrap_or(0.0)),
        direction: given.direction,
        slave: given.slave.unwrap_or_default(),
    })
}

/// A rigid obstacle.
#[derive(Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, rename = "obstacle")]
pub(super) struct ObstacleTable {
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
    pub motion: Option<MotionTable>,
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

/// The motion of an obstacle, as a rigid body.
#[derive(Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, rename = "motion")]
pub(super) struct MotionTable {
    /// Displacement.
    /// Example: `motion.translation = [[1, 0, 0], [2, 1e-3, 0]]`. Value: points `[time, x, y]`, in space `[time, x,
    /// y, z]`, s, m. Default: at rest.
    #[schemars(inner(length(min = 3, max = 4)))]
    pub translation: Option<Vec<Vec<f64>>>,
    /// Rotation about an axis.
    /// Example: `motion.rotation = { through = [0, 0], history = [[0, 0], [1, 0.1]] }`. Value: table, below.
    /// Default: at rest.
    pub rotation: Option<RotationTable>,
}

/// The rotation about an axis.
#[derive(Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, rename = "rotation")]
pub(super) struct RotationTable {
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

/// Converts an obstacle.
pub(super) fn obstacle(given: ObstacleTable, reader: Reader<'_>) -> Result<Obstacle, InputError> {
    let shape = shape(&given, reader)?;
    let ObstacleTable { normal, tangent, direction, approach, motion, .. } = given;
    let (translation, rotation) = motion.map_or((None, None), |motion| (motion.translation, motion.rotation));
    let distance = |[time, distance]: [f64; 2]| [time, reader.length(distance)];
    Ok(Obstacle {
        shape,
        normal,
        tangent,
        direction: direction.unwrap_or_default(),
        approach: approach.map(|given| points(given).into_iter().map(distance).collect()),
        translation: translation.map(|given| path(given, reader)).transpose()?,
        rotation: rotation.map(|RotationTable { axis, through, history }| Rotation {
            axis,
            through: reader.point(through),
            history: points(history),
        }),
    })
}

fn shape(obstacle: &ObstacleTable, reader: Reader<'_>) -> Result<Shape, InputError> {
    let (whose, keys): (&str, &[&str]) = match obstacle.kind {
        ObstacleKind::Plane => ("a plane", &["gap", "through"]),
        ObstacleKind::Cylinder => ("a cylinder", &["radius", "apex", "center", "axis"]),
        ObstacleKind::Bore => ("a bore", &["radius", "apex", "center", "axis"]),
        ObstacleKind::Sphere => ("a sphere", &["radius", "apex", "center"]),
        ObstacleKind::Socket => ("a socket", &["radius", "apex", "center"]),
        ObstacleKind::Cone => ("a cone", &["apex", "half_angle", "axis"]),
        ObstacleKind::Wedge => ("a wedge", &["apex", "angle", "axis"]),
        ObstacleKind::Formula => ("a formula", &["formula"]),
        ObstacleKind::Table => ("a table", &["file"]),
        ObstacleKind::Surface => ("a surface", &["file", "scale"]),
    };
    let given = given!(obstacle; gap radius angle half_angle through apex center axis formula file scale);
    only(whose, keys, given)?;
    at_most_one(whose, given!(obstacle; gap through), KEEP_ONE)?;
    at_most_one(whose, given!(obstacle; apex center), KEEP_ONE)?;
    let ObstacleTable { kind, gap, through, radius, apex, center, axis, .. } = obstacle;
    let ObstacleTable { angle, half_angle, formula, file, scale, .. } = obstacle;
    let number = |key: &str, value: &Option<f64>| needed(key, *value, "kind", whose);
    let radius = || Ok(reader.length(number("radius", radius)?));
    let place = || {
        let help = "add one of them: a point of the surface, or its centre or a point of its axis";
        let missing = || InputError::new("kind", format!("{whose} needs apex or center"), help);
        let [apex, center] = [apex, center].map(|point| point.map(|point| reader.point(point)));
        apex.map(Place::Apex).or(center.map(Place::Center)).ok_or_else(missing)
    };
    let apex = || Ok(reader.point(needed("apex", *apex, "kind", whose)?));
    let file = || Ok(reader.source.beside(needed("file", file.as_ref(), "kind", whose)?));
    let (axis, scale) = (*axis, reader.length(scale.unwrap_or(1.0)));
    Ok(match kind {
        ObstacleKind::Plane => match through {
            Some(through) => Shape::PlaneThrough { through: reader.point(*through) },
            None => Shape::Plane { gap: reader.length(gap.unwrap_or(0.0)) },
        },
        ObstacleKind::Cylinder => Shape::Cylinder { radius: radius()?, place: place()?, axis },
        ObstacleKind::Bore => Shape::Bore { radius: radius()?, place: place()?, axis },
        ObstacleKind::Sphere => Shape::Sphere { radius: radius()?, place: place()? },
        ObstacleKind::Socket => Shape::Socket { radius: radius()?, place: place()? },
        ObstacleKind::Cone => Shape::Cone { apex: apex()?, half_angle: number("half_angle", half_angle)?, axis },
        ObstacleKind::Wedge => Shape::Wedge { angle: number("angle", angle)?, apex: apex()?, axis },
        ObstacleKind::Formula => {
            let text = needed("formula", formula.as_ref(), "kind", whose)?;
            let help = "give the gap as a formula of x, y and z, in m or as [units] says, such as \"0.5 * x^2 / 0.1\"";
            Shape::Formula(reader.formula(Quantity::Length, "formula", text, help)?)
        }
        ObstacleKind::Table => Shape::Table { file: file()?, scale },
        ObstacleKind::Surface => Shape::Surface { file: file()?, scale },
    })
}

/// Converts the points of a translation: a time and two or three coordinates each.
fn path(given: Vec<Vec<f64>>, reader: Reader<'_>) -> Result<Vec<(f64, Vector)>, InputError> {
    let point = |point: Vec<f64>| {
        let (time, to) = point.split_first()?;
        Some((*time, reader.point(to.to_vec().try_into().ok()?)))
    };
    let help = "give points [time, x, y] or [time, x, y, z], s and m, ordered by time";
    let wrong = || InputError::new("motion.translation", "translation is not a list of points", help);
    given.into_iter().map(point).collect::<Option<_>>().ok_or_else(wrong)
}
