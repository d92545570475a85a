//! The obstacle of a contact.

use super::{Reader, given, only, points};
use crate::algebra::vector::Vector;
use crate::base::units::Quantity;
use crate::body::contact::{Obstacle, Place, Rotation, Shape};
use crate::scene::SceneError;
use crate::scene::document::{self, ObstacleKind};

/// Converts an obstacle.
pub(super) fn obstacle(given: document::Obstacle, reader: Reader<'_>) -> Result<Obstacle, SceneError> {
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

fn shape(obstacle: &document::Obstacle, reader: Reader<'_>) -> Result<Shape, SceneError> {
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
    only(whose, keys, given).map_err(|fault| reader.at(fault))?;
    let document::Obstacle { kind, gap, through, radius, apex, center, axis, .. } = obstacle;
    let document::Obstacle { angle, half_angle, formula, file, scale, .. } = obstacle;
    let number = |key: &str, value: &Option<f64>| reader.needed(key, *value, "kind", whose);
    let radius = || Ok(reader.length(number("radius", radius)?));
    let place = || match (apex, center) {
        (Some(_), Some(_)) => reader.fault("center", format!("{whose} has both apex and center"), "keep one of them"),
        (Some(apex), None) => Ok(Place::Apex(reader.point(*apex))),
        (None, Some(center)) => Ok(Place::Center(reader.point(*center))),
        (None, None) => {
            let help = "add one of them: a point of the surface, or its centre or a point of its axis";
            reader.fault("kind", format!("{whose} needs apex or center"), help)
        }
    };
    let apex = || Ok(reader.point(reader.needed("apex", *apex, "kind", whose)?));
    let file = || Ok(reader.source.beside(reader.needed("file", file.as_ref(), "kind", whose)?));
    let (axis, scale) = (*axis, reader.length(scale.unwrap_or(1.0)));
    Ok(match kind {
        ObstacleKind::Plane => match (gap, through) {
            (Some(_), Some(_)) => {
                return reader.fault("through", "a plane has both gap and through", "keep one of them");
            }
            (None, Some(through)) => Shape::PlaneThrough { through: reader.point(*through) },
            (gap, None) => Shape::Plane { gap: reader.length(gap.unwrap_or(0.0)) },
        },
        ObstacleKind::Cylinder => Shape::Cylinder { radius: radius()?, place: place()?, axis },
        ObstacleKind::Bore => Shape::Bore { radius: radius()?, place: place()?, axis },
        ObstacleKind::Sphere => Shape::Sphere { radius: radius()?, place: place()? },
        ObstacleKind::Socket => Shape::Socket { radius: radius()?, place: place()? },
        ObstacleKind::Cone => Shape::Cone { apex: apex()?, half_angle: number("half_angle", half_angle)?, axis },
        ObstacleKind::Wedge => Shape::Wedge { angle: number("angle", angle)?, apex: apex()?, axis },
        ObstacleKind::Formula => {
            let text = reader.needed("formula", formula.as_ref(), "kind", whose)?;
            let help = "give the gap as a formula of x, y and z, in m or as [units] says, such as \"0.5 * x^2 / 0.1\"";
            Shape::Formula(reader.formula(Quantity::Length, "formula", text, help)?)
        }
        ObstacleKind::Table => Shape::Table { file: file()?, scale },
        ObstacleKind::Surface => Shape::Surface { file: file()?, scale },
    })
}

/// Converts the points of a translation: a time and two or three coordinates each.
fn path(given: Vec<Vec<f64>>, reader: Reader<'_>) -> Result<Vec<(f64, Vector)>, SceneError> {
    let point = |point: Vec<f64>| {
        let (time, to) = point.split_first()?;
        Some((*time, reader.point(to.to_vec().try_into().ok()?)))
    };
    let points: Option<_> = given.into_iter().map(point).collect();
    let wrong = || {
        let help = "give points [time, x, y] or [time, x, y, z], s and m, ordered by time";
        reader.fault("motion.translation", "translation is not a list of points", help)
    };
    points.map_or_else(wrong, Ok)
}
