//! Couplings, supports, springs, loads and pretensions: their tables, and what they become.

use super::{
    Deserialize, JsonSchema, KEEP_ONE, OneOrMany, Reader, Scalar, Tuple, at_most_one, given, needed, points,
    reject_keys,
};
use crate::algebra::vector::Vector;
use crate::base::input_error::InputError;
use crate::base::units::Quantity;
use crate::body::description::{
    Action, Axis, Bed, Coupling, CouplingKind, Direction, Held, Load, Part, Pretension, Support, Tightening, Where,
};

/// A boundary or a body coupled to a reference point, on which loads, supports and springs act by its name.
#[derive(Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, rename = "coupling")]
pub(super) struct CouplingTable {
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

/// Converts a coupling.
pub(super) fn coupling(given: CouplingTable, reader: Reader<'_>) -> Result<Coupling, InputError> {
    at_most_one("a coupling", given!(given; boundary body), KEEP_ONE)?;
    let CouplingTable { name, boundary, body, point, kind } = given;
    let missing = || InputError::new("boundary", "a coupling needs a boundary or a body", "add one of the keys");
    let part = boundary.map(Part::Boundary).or(body.map(Part::Body)).ok_or_else(missing)?;
    Ok(Coupling { name, part, point: point.map(|point| reader.point(point)), kind })
}

/// Displacements of a boundary, of the node at a point, or of the reference point of a coupling, zero or prescribed.
#[derive(Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, rename = "support")]
pub(super) struct SupportTable {
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

/// Converts a support.
pub(super) fn support(given: SupportTable, reader: Reader<'_>) -> Result<Support, InputError> {
    at_most_one("a support", given!(given; fix direction), KEEP_ONE)?;
    let SupportTable { boundary, point, coupling, fix, direction, displacement, history } = given;
    let at = place((boundary, point, coupling), "a support", reader)?;
    let directions: Vec<Direction> = match (fix, direction) {
        (Some(fix), _) => fix.into_iter().map(held_along).collect(),
        (None, Some(along)) => vec![Direction::Along(along)],
        (None, None) => {
            let help = "add fix = [\"x\", \"y\"], fix = [\"normal\"] or a direction such as [1, 1]";
            return Err(InputError::new("", "a support needs fix or direction", help));
        }
    };
    let moves = displacement.is_some();
    let displacements = displacement.map_or(vec![0.0; directions.len()], OneOrMany::into_vec);
    let (n, d) = (displacements.len(), directions.len());
    if n != d {
        let message = format!("displacement has {n} values, but the support holds {d} directions");
        let help = "give one for each direction that is held, in the order of fix";
        return Err(InputError::new("displacement", message, help));
    }
    if history.is_some() && !moves {
        let help = "add a displacement, or remove the key";
        return Err(InputError::new("history", "a support that moves nothing has a history", help));
    }
    let held = directions.into_iter().zip(displacements).map(|(direction, x)| {
        let is_angle = matches!(direction, Direction::Rotation(_));
        Held { direction, displacement: if is_angle { x } else { reader.length(x) } }
    });
    Ok(Support { at, held: held.collect(), history: history.map(points) })
}

fn held_along(fix: Fix) -> Direction {
    match fix {
        Fix::X => Direction::Axis(Axis::X),
        Fix::Y => Direction::Axis(Axis::Y),
        Fix::Z => Direction::Axis(Axis::Z),
        Fix::Normal => Direction::Normal,
        Fix::RotationX => Direction::Rotation(Axis::X),
        Fix::RotationY => Direction::Rotation(Axis::Y),
        Fix::RotationZ => Direction::Rotation(Axis::Z),
    }
}

/// A boundary, a point and a coupling, of which one is given.
type Place = (Option<String>, Option<Vector>, Option<String>);

/// Returns the boundary, the point or the coupling that `whose` acts on.
fn place((boundary, point, coupling): Place, whose: &str, reader: Reader<'_>) -> Result<Where, InputError> {
    let keys = [("boundary", boundary.is_some()), ("point", point.is_some()), ("coupling", coupling.is_some())];
    at_most_one(whose, &keys, KEEP_ONE)?;
    let message = format!("{whose} needs a boundary, a point or a coupling");
    let at = boundary.map(Where::Boundary).or(point.map(|point| Where::Point(reader.point(point))));
    let missing = || InputError::new("boundary", message, "add one of the keys");
    at.or(coupling.map(Where::Coupling)).ok_or_else(missing)
}

/// An elastic foundation of a boundary, or a spring at the node at a point or at the reference point of a coupling.
#[derive(Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, rename = "spring")]
pub(super) struct SpringTable {
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

/// Converts a spring.
pub(super) fn spring(given: SpringTable, reader: Reader<'_>) -> Result<Bed, InputError> {
    if given.rotational.is_some() {
        let whose = "a rotational spring";
        reject_keys(whose, given!(given; boundary point))?;
        if given.stiffness.is_some() {
            let help = "make two springs of them, each with the coupling";
            return Err(InputError::new("stiffness", "a spring has both stiffness and rotational", help));
        }
        reject_keys(whose, given!(given; normal tangential))?;
    } else if given.stiffness.is_some() {
        reject_keys("a spring with a stiffness along the axes", given!(given; normal tangential))?;
    }
    let SpringTable { boundary, point, coupling, stiffness, rotational, normal, tangential } = given;
    if let Some(rotational) = rotational.map(OneOrMany::into_vec) {
        let coupling = needed("a coupling", coupling, "coupling", "a rotational spring")?;
        return Ok(Bed::Rotational { coupling, rotational: reader.components(Quantity::Moment, rotational) });
    }
    match (place((boundary, point, coupling), "a spring", reader)?, stiffness) {
        (at, Some(stiffness)) => {
            let per_area = matches!(at, Where::Boundary(_));
            let quantity = if per_area { Quantity::Foundation } else { Quantity::Spring };
            Ok(Bed::Axes { at, stiffness: reader.components(quantity, stiffness) })
        }
        (Where::Boundary(boundary), None) if normal.is_some() || tangential.is_some() => {
            let [normal, tangential] = [normal, tangential].map(|x| reader.si(Quantity::Foundation, x.unwrap_or(0.0)));
            Ok(Bed::Surface { boundary, normal, tangential })
        }
        (at, None) => {
            let (message, help) = match at {
                Where::Boundary(_) => (
                    "a spring needs a stiffness",
                    "add normal and tangential, stiffness per area, or stiffness along the axes",
                ),
                Where::Point(_) => ("a spring at a point needs stiffness", "give it along the axes"),
                Where::Coupling(_) => ("a spring at a coupling needs stiffness or rotational", "add one of the keys"),
            };
            Err(InputError::new("", message, help))
        }
    }
}

/// A load of the body, one of traction, pressure, force, moment, acceleration, rotation and temperature, times a
/// factor that changes in time.
#[derive(Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, rename = "load")]
pub(super) struct LoadTable {
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
    pub rotation: Option<SpinTable>,
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
pub(super) struct SpinTable {
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

/// Converts a load.
pub(super) fn load(given: LoadTable, reader: Reader<'_>) -> Result<Load, InputError> {
    let actions = given!(given; traction pressure force moment acceleration rotation temperature);
    at_most_one("a load", actions, "make two loads of them, or keep one")?;
    let first = actions.iter().find(|(_, given)| *given).map_or("", |(name, _)| *name);
    let whose = format!("a{} {first}", if first == "acceleration" { "n" } else { "" });
    let places: &[_] = given!(given; boundary point coupling);
    let rejected = match first {
        "" | "force" => &[],
        "moment" => &places[..2],
        "traction" | "pressure" => &places[1..],
        _ => places,
    };
    reject_keys(&whose, rejected)?;
    let LoadTable { boundary, point, coupling, history, .. } = given;
    let help = "give a number, or a formula of x, y and z in m or as [units] says, such as \"1e6 * (1 - x^2)\"";
    let field = |quantity, name: &str, scalar| reader.field(quantity, name, scalar, help);
    let on_boundary = |boundary| needed("a boundary", boundary, "boundary", &whose);
    let action = if let Some(traction) = given.traction {
        let component = |(k, scalar)| field(Quantity::Stress, &format!("traction[{k}]"), scalar);
        let traction = traction.into_iter().enumerate().map(component).collect::<Result<_, _>>();
        Action::Traction { boundary: on_boundary(boundary)?, traction: traction? }
    } else if let Some(pressure) = given.pressure {
        let boundary = on_boundary(boundary)?;
        Action::Pressure { boundary, pressure: field(Quantity::Stress, "pressure", pressure)? }
    } else if let Some(force) = given.force {
        let at = place((boundary, point, coupling), &whose, reader)?;
        Action::Force { at, force: reader.components(Quantity::Force, force) }
    } else if let Some(moment) = given.moment.map(OneOrMany::into_vec) {
        let help = "a moment acts on the reference point of a [[coupling]]: add the key";
        let coupling = coupling.ok_or_else(|| InputError::new("coupling", "a moment needs a coupling", help))?;
        Action::Moment { coupling, moment: reader.components(Quantity::Moment, moment) }
    } else if let Some(acceleration) = given.acceleration {
        Action::Acceleration(reader.components(Quantity::Acceleration, acceleration))
    } else if let Some(SpinTable { axis, through, speed }) = given.rotation {
        Action::Spin { axis, through: through.map(|through| reader.point(through)), speed }
    } else if let Some(temperature) = given.temperature {
        Action::Temperature(field(Quantity::Number, "temperature", temperature)?)
    } else {
        let help = "add one of traction, pressure, force, moment, acceleration, rotation and temperature";
        return Err(InputError::new("", "a load does nothing", help));
    };
    Ok(Load { action, history: history.map(points) })
}

/// A glued contact, such as the section of a bolt, whose sides a force or a shortening pulls towards each other.
#[derive(Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, rename = "pretension")]
pub(super) struct PretensionTable {
    /// Name of the section in results.
    /// Example: `name = "bolt"`. Value: name.
    pub name: String,
    /// `boundary` of a contact with `glue = true`.
    /// Example: `boundary = "shank:top"`. Value: name.
    pub boundary: String,
    /// Force across the section, positive for tension. Plane bodies without thickness: N per m of depth; bodies of
    /// revolution: over the full circumference; half models: of the half.
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

/// Converts a pretension.
pub(super) fn pretension(given: PretensionTable, reader: Reader<'_>) -> Result<Pretension, InputError> {
    at_most_one("a pretension", given!(given; force shortening), KEEP_ONE)?;
    let PretensionTable { name, boundary, force, shortening, history, lock } = given;
    let tightening = match (force, shortening) {
        (Some(force), _) => {
            let [plane, space] = [2, 3].map(|dimension| reader.in_dimension(dimension, Quantity::Force, force));
            Tightening::Force { space, plane }
        }
        (None, Some(shortening)) => Tightening::Shortening(reader.length(shortening)),
        (None, None) => {
            let message = "a pretension needs a force or a shortening";
            return Err(InputError::new("force", message, "add one of the keys"));
        }
    };
    Ok(Pretension { name, boundary, tightening, history: history.map(points), lock })
}
