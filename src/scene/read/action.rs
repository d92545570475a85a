//! Couplings, supports, pretensions, springs and loads of a scene.

use super::{KEEP_ONE, Reader, at_most_one, given, needed, points, reject_keys};
use crate::algebra::vector::Vector;
use crate::base::input_error::InputError;
use crate::base::units::Quantity;
use crate::body::description::{
    Action, Axis, Bed, Coupling, Direction, Held, Load, Part, Pretension, Support, Tightening, Where,
};
use crate::scene::document::{self, Fix, OneOrMany};

/// Converts a support.
pub(super) fn support(given: document::Support, reader: Reader<'_>) -> Result<Support, InputError> {
    at_most_one("a support", given!(given; fix direction), KEEP_ONE)?;
    let document::Support { boundary, point, coupling, fix, direction, displacement, history } = given;
    let at = place(boundary, point, coupling, "a support", reader)?;
    let directions: Vec<Direction> = match (fix, direction) {
        (Some(fix), _) => fix.into_iter().map(held_along).collect(),
        (None, Some(along)) => vec![Direction::Along(along)],
        (None, None) => {
            let help = "add fix = [\"x\", \"y\"], fix = [\"normal\"] or a direction such as [1, 1]";
            return Err(InputError::new("", "a support needs fix or direction", help));
        }
    };
    let moves = displacement.is_some();
    let displacements = match displacement.map(OneOrMany::into_vec) {
        None => vec![0.0; directions.len()],
        Some(values) if values.len() == directions.len() => values,
        Some(values) => {
            let (n, d) = (values.len(), directions.len());
            let message = format!("displacement has {n} values, but the support holds {d} directions");
            let help = "give one for each direction that is held, in the order of fix";
            return Err(InputError::new("displacement", message, help));
        }
    };
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

/// Returns the boundary, the point or the coupling that `whose` acts on.
fn place(
    boundary: Option<String>,
    point: Option<Vector>,
    coupling: Option<String>,
    whose: &str,
    reader: Reader<'_>,
) -> Result<Where, InputError> {
    let keys = [("boundary", boundary.is_some()), ("point", point.is_some()), ("coupling", coupling.is_some())];
    at_most_one(whose, &keys, KEEP_ONE)?;
    let boundary = boundary.map(Where::Boundary).or(point.map(|point| Where::Point(reader.point(point))));
    let missing = || {
        let message = format!("{whose} needs a boundary, a point or a coupling");
        InputError::new("boundary", message, "add one of the keys")
    };
    boundary.or(coupling.map(Where::Coupling)).ok_or_else(missing)
}

/// Converts a spring.
pub(super) fn spring(given: document::Spring, reader: Reader<'_>) -> Result<Bed, InputError> {
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
    let document::Spring { boundary, point, coupling, stiffness, rotational, normal, tangential } = given;
    if let Some(rotational) = rotational.map(OneOrMany::into_vec) {
        let coupling = needed("a coupling", coupling, "coupling", "a rotational spring")?;
        return Ok(Bed::Rotational { coupling, rotational: reader.components(Quantity::Moment, rotational) });
    }
    match (place(boundary, point, coupling, "a spring", reader)?, stiffness) {
        (at, Some(stiffness)) => {
            let per_area = matches!(at, Where::Boundary(_));
            let quantity = if per_area { Quantity::Foundation } else { Quantity::Spring };
            Ok(Bed::Axes { at, stiffness: reader.components(quantity, stiffness) })
        }
        (Where::Boundary(boundary), None) if normal.is_some() || tangential.is_some() => {
            let [normal, tangential] = [normal, tangential].map(|x| reader.si(Quantity::Foundation, x.unwrap_or(0.0)));
            Ok(Bed::Surface { boundary, normal, tangential })
        }
        (Where::Boundary(_), None) => {
            let help = "add normal and tangential, stiffness per area, or stiffness along the axes";
            Err(InputError::new("", "a spring needs a stiffness", help))
        }
        (Where::Point(_), None) => {
            Err(InputError::new("", "a spring at a point needs stiffness", "give it along the axes"))
        }
        (Where::Coupling(_), None) => {
            Err(InputError::new("", "a spring at a coupling needs stiffness or rotational", "add one of the keys"))
        }
    }
}

/// Converts a load.
pub(super) fn load(given: document::Load, reader: Reader<'_>) -> Result<Load, InputError> {
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
    let document::Load { boundary, point, coupling, history, .. } = given;
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
        let at = place(boundary, point, coupling, &whose, reader)?;
        Action::Force { at, force: reader.components(Quantity::Force, force) }
    } else if let Some(moment) = given.moment.map(OneOrMany::into_vec) {
        let help = "a moment acts on the reference point of a [[coupling]]: add the key";
        let coupling = coupling.ok_or_else(|| InputError::new("coupling", "a moment needs a coupling", help))?;
        Action::Moment { coupling, moment: reader.components(Quantity::Moment, moment) }
    } else if let Some(acceleration) = given.acceleration {
        Action::Acceleration(reader.components(Quantity::Acceleration, acceleration))
    } else if let Some(document::Spin { axis, through, speed }) = given.rotation {
        Action::Spin { axis, through: through.map(|through| reader.point(through)), speed }
    } else if let Some(temperature) = given.temperature {
        Action::Temperature(field(Quantity::Number, "temperature", temperature)?)
    } else {
        let help = "add one of traction, pressure, force, moment, acceleration, rotation and temperature";
        return Err(InputError::new("", "a load does nothing", help));
    };
    Ok(Load { action, history: history.map(points) })
}

/// Converts a coupling.
pub(super) fn coupling(given: document::Coupling, reader: Reader<'_>) -> Result<Coupling, InputError> {
    at_most_one("a coupling", given!(given; boundary body), KEEP_ONE)?;
    let document::Coupling { name, boundary, body, point, kind } = given;
    let missing = || InputError::new("boundary", "a coupling needs a boundary or a body", "add one of the keys");
    let part = boundary.map(Part::Boundary).or(body.map(Part::Body)).ok_or_else(missing)?;
    Ok(Coupling { name, part, point: point.map(|point| reader.point(point)), kind })
}

/// Converts a pretension.
pub(super) fn pretension(given: document::Pretension, reader: Reader<'_>) -> Result<Pretension, InputError> {
    at_most_one("a pretension", given!(given; force shortening), KEEP_ONE)?;
    let document::Pretension { name, boundary, force, shortening, history, lock } = given;
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
