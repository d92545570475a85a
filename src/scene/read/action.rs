//! The supports, springs and loads of a scene.

use crate::algebra::vector::Vector;
use crate::base::formula::Formula;
use crate::base::input_error::InputError;
use crate::body::description::{Action, Axis, Bed, Direction, Field, Held, Load, Support, Where};
use crate::scene::SceneError;
use crate::scene::document::{self, Fix, Scalar, Segments};
use crate::scene::error::Source;

use super::{foreign, points};

/// Converts the support at `key`.
pub(super) fn support(given: document::Support, key: &str) -> Result<Support, InputError> {
    let document::Support { boundary, point, coupling, fix, direction, displacement, history } = given;
    let at = place(boundary, point, coupling, "a support").map_err(|fault| fault.with_key(key))?;
    let fault = |name: &str, message: &str, help: &str| Err(InputError::new(format!("{key}.{name}"), message, help));
    let directions: Vec<Direction> = match (fix, direction) {
        (Some(_), Some(_)) => return fault("direction", "a support has both fix and direction", "keep one of them"),
        (None, None) => {
            let help = "add fix = [\"x\", \"y\"], fix = [\"normal\"] or a direction such as [1, 1]";
            return Err(InputError::new(key, "a support needs fix or direction", help));
        }
        (None, Some(along)) => vec![Direction::Along(along)],
        (Some(fix), None) => fix.into_iter().map(held_along).collect(),
    };
    let moves = displacement.is_some();
    let displacements = match displacement {
        None => vec![0.0; directions.len()],
        Some(Segments(values)) if values.len() == directions.len() => values,
        Some(Segments(values)) => {
            let (n, d) = (values.len(), directions.len());
            let message = format!("displacement has {n} values, but the support holds {d} directions");
            return fault("displacement", &message, "give one for each direction that is held, in the order of fix");
        }
    };
    if history.is_some() && !moves {
        return fault("history", "a support that moves nothing has a history", "add a displacement, or remove the key");
    }
    let held =
        directions.into_iter().zip(displacements).map(|(direction, displacement)| Held { direction, displacement });
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
) -> Result<Where, InputError> {
    let both = |first: &str, second: &str| {
        Err(InputError::new(second, format!("{whose} has both {first} and {second}"), "keep one of them"))
    };
    match (boundary, point, coupling) {
        (Some(boundary), None, None) => Ok(Where::Boundary(boundary)),
        (None, Some(point), None) => Ok(Where::Point(point)),
        (None, None, Some(coupling)) => Ok(Where::Coupling(coupling)),
        (Some(_), Some(_), _) => both("boundary", "point"),
        (Some(_), _, Some(_)) => both("boundary", "coupling"),
        (None, Some(_), Some(_)) => both("point", "coupling"),
        (None, None, None) => {
            let message = format!("{whose} needs a boundary, a point or a coupling");
            Err(InputError::new("boundary", message, "add one of the keys"))
        }
    }
}

/// Converts the spring at `key`.
pub(super) fn spring(given: document::Spring, key: &str) -> Result<Bed, InputError> {
    let document::Spring { boundary, point, coupling, stiffness, rotational, normal, tangential } = given;
    let under = |fault: InputError| fault.with_key(key);
    if let Some(Segments(rotational)) = rotational {
        let whose = "a rotational spring";
        foreign("boundary", boundary.as_ref(), whose).and(foreign("point", point.as_ref(), whose)).map_err(under)?;
        if stiffness.is_some() {
            let message = "a spring has both stiffness and rotational";
            return Err(under(InputError::new(
                "stiffness",
                message,
                "make two springs of them, each with the coupling",
            )));
        }
        foreign("normal", normal.as_ref(), whose).map_err(under)?;
        foreign("tangential", tangential.as_ref(), whose).map_err(under)?;
        let missing = || InputError::new("coupling", format!("{whose} needs a coupling"), "add the key");
        return Ok(Bed::Rotational { coupling: coupling.ok_or_else(missing).map_err(under)?, rotational });
    }
    let at = place(boundary, point, coupling, "a spring").map_err(under)?;
    match (at, stiffness) {
        (at, Some(stiffness)) => {
            let whose = "a spring with a stiffness along the axes";
            foreign("normal", normal.as_ref(), whose).map_err(under)?;
            foreign("tangential", tangential.as_ref(), whose).map_err(under)?;
            Ok(Bed::Axes { at, stiffness })
        }
        (Where::Boundary(boundary), None) if normal.is_some() || tangential.is_some() => {
            Ok(Bed::Surface { boundary, normal: normal.unwrap_or(0.0), tangential: tangential.unwrap_or(0.0) })
        }
        (Where::Boundary(_), None) => {
            let help = "add normal and tangential, stiffness per area, or stiffness along the axes";
            Err(InputError::new(key, "a spring needs a stiffness", help))
        }
        (Where::Point(_), None) => {
            Err(InputError::new(key, "a spring at a point needs stiffness", "give it along the axes"))
        }
        (Where::Coupling(_), None) => {
            Err(InputError::new(key, "a spring at a coupling needs stiffness or rotational", "add one of the keys"))
        }
    }
}

/// Converts the load at `key` of the scene `source`.
pub(super) fn load(given: document::Load, key: &str, source: &Source) -> Result<Load, SceneError> {
    let document::Load {
        boundary,
        point,
        coupling,
        traction,
        pressure,
        force,
        moment,
        acceleration,
        rotation,
        temperature,
        history,
    } = given;
    let at = |fault: InputError| source.located(fault.with_key(key));
    let field = |scalar: Scalar, name: &str| field(scalar, &format!("{key}.{name}"), source);
    let on_boundary = |boundary: Option<String>, whose: &str| {
        foreign("point", point.as_ref(), whose).and(foreign("coupling", coupling.as_ref(), whose)).map_err(at)?;
        boundary.ok_or_else(|| at(InputError::new("boundary", format!("{whose} needs a boundary"), "add the key")))
    };
    let on_body = |boundary: Option<String>, whose: &str| {
        let other = foreign("point", point.as_ref(), whose).and(foreign("coupling", coupling.as_ref(), whose));
        foreign("boundary", boundary.as_ref(), whose).and(other).map_err(at)
    };
    let given = [
        ("traction", traction.is_some()),
        ("pressure", pressure.is_some()),
        ("force", force.is_some()),
        ("moment", moment.is_some()),
        ("acceleration", acceleration.is_some()),
        ("rotation", rotation.is_some()),
        ("temperature", temperature.is_some()),
    ];
    let mut present = given.iter().filter(|(_, given)| *given).map(|(name, _)| *name);
    if let (Some(first), Some(second)) = (present.next(), present.next()) {
        let message = format!("a load has both {first} and {second}");
        return Err(at(InputError::new(second, message, "make two loads of them, or keep one")));
    }
    let action = if let Some(traction) = traction {
        let boundary = on_boundary(boundary, "a traction")?;
        let component = |(k, scalar): (usize, Scalar)| field(scalar, &format!("traction[{k}]"));
        Action::Traction {
            boundary,
            traction: traction.into_iter().enumerate().map(component).collect::<Result<_, _>>()?,
        }
    } else if let Some(pressure) = pressure {
        Action::Pressure { boundary: on_boundary(boundary, "a pressure")?, pressure: field(pressure, "pressure")? }
    } else if let Some(force) = force {
        Action::Force { at: place(boundary, point, coupling, "a force").map_err(at)?, force }
    } else if let Some(Segments(moment)) = moment {
        let whose = "a moment";
        foreign("boundary", boundary.as_ref(), whose).and(foreign("point", point.as_ref(), whose)).map_err(at)?;
        let missing = || {
            let help = "a moment acts on the reference point of a [[coupling]]: add the key";
            at(InputError::new("coupling", "a moment needs a coupling", help))
        };
        Action::Moment { coupling: coupling.ok_or_else(missing)?, moment }
    } else if let Some(acceleration) = acceleration {
        on_body(boundary, "an acceleration")?;
        Action::Acceleration(acceleration)
    } else if let Some(document::Spin { axis, through, speed }) = rotation {
        on_body(boundary, "a rotation")?;
        Action::Spin { axis, through, speed }
    } else if let Some(temperature) = temperature {
        on_body(boundary, "a temperature")?;
        Action::Temperature(field(temperature, "temperature")?)
    } else {
        let help = "add one of traction, pressure, force, moment, acceleration, rotation and temperature";
        return Err(source.located(InputError::new(key, "a load does nothing", help)));
    };
    Ok(Load { action, history: history.map(points) })
}

/// Converts a number or a formula; the error points at the wrong part of the formula.
fn field(scalar: Scalar, key: &str, source: &Source) -> Result<Field, SceneError> {
    match scalar {
        Scalar::Number(value) => Ok(value.into()),
        Scalar::Text(text) => Formula::parse(&text).map(Field::from).map_err(|why| {
            let help = "give a number, or a formula of x, y and z in m or as [units] says, such as \"1e6 * (1 - x^2)\"";
            source.located_within(InputError::new(key, format!("the formula: {why}"), help), &text, &why.span)
        }),
    }
}
