//! The contacts of a scene: boundaries in front of obstacles, or of each other; and the obstacles.

use super::{KEEP_ONE, Reader, at_most_one, given, needed, only, points, reject_keys};
use crate::algebra::vector::Vector;
use crate::base::input_error::{InputError, each};
use crate::base::units::Quantity;
use crate::body::contact::{Obstacle, Place, Rotation, Shape};
use crate::body::description::{Against, Contact, Opposite};
use crate::scene::document::{self, ContactTable, ObstacleKind, OneOrMany, Scalar};

/// Converts a contact.
pub(super) fn contact(mut given: ContactTable, reader: Reader<'_>) -> Result<Contact, InputError> {
    let help = "give Coulomb's coefficient, or a formula of x, y and z for it, in m or as [units] says, such as \"0.1 + 0.2 * x\"";
    let friction = given.friction.take().map(|given| reader.field(Quantity::Number, "friction", given, help));
    let friction = friction.transpose()?;
    let is_glued = given.glue.unwrap_or(false);
    let (obstacle, against) = (given.obstacle.take(), given.against.take());
    let against = match (obstacle, against) {
        (Some(_), Some(_)) => {
            let help = "keep one of them; a boundary that meets both takes two [[contact]]s with parts of it";
            return Err(InputError::new(
                "against",
                "a contact has both an obstacle and a boundary that it is against",
                help,
            ));
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
                reject_keys("what is glued", &[("friction", friction.is_some())])?;
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

/// Converts an obstacle.
pub(super) fn obstacle(given: document::Obstacle, reader: Reader<'_>) -> Result<Obstacle, InputError> {
    let shape = shape(&given, reader)?;
    let document::Obstacle { normal, tangent, direction, approach, motion, .. } = given;
    let (translation, rotation) = motion.map_or((None, None), |motion| (motion.translation, motion.rotation));
    let distance = |[time, distance]: [f64; 2]| [time, reader.length(distance)];
    Ok(Obstacle {
        shape,
        normal,
        tangent,
        direction: direction.unwrap_or_default(),
        approach: approach.map(|given| points(given).into_iter().map(distance).collect()),
        translation: translation.map(|given| path(given, reader)).transpose()?,
        rotation: rotation.map(|document::Rotation { axis, through, history }| Rotation {
            axis,
            through: reader.point(through),
            history: points(history),
        }),
    })
}

fn shape(obstacle: &document::Obstacle, reader: Reader<'_>) -> Result<Shape, InputError> {
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
    let document::Obstacle { kind, gap, through, radius, apex, center, axis, .. } = obstacle;
    let document::Obstacle { angle, half_angle, formula, file, scale, .. } = obstacle;
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
