//! The obstacle of a contact.

use crate::algebra::vector::Vector;
use crate::base::input_error::InputError;
use crate::body::contact::{Obstacle, Place, Rotation, Shape};
use crate::scene::SceneError;
use crate::scene::document::{self, ObstacleKind};
use crate::scene::error::Source;

use super::{foreign, formula, needed, points};

/// Converts the obstacle at `key` of the scene `source`.
pub(super) fn obstacle(given: document::Obstacle, key: &str, source: &Source) -> Result<Obstacle, SceneError> {
    let at = |fault: InputError| source.located(fault.with_key(key));
    own_keys(&given).map_err(at)?;
    let shape = match (&given.kind, &given.formula) {
        (ObstacleKind::Formula, Some(text)) => {
            let help = "give the gap as a formula of x, y and z, in m or as [units] says, such as \"0.5 * x^2 / 0.1\"";
            Shape::Formula(formula(text, format!("{key}.formula"), help, source)?)
        }
        _ => shape(&given, source).map_err(at)?,
    };
    let document::Obstacle { normal, tangent, direction, approach, motion, .. } = given;
    let (translation, rotation) = motion.map_or((None, None), |motion| (motion.translation, motion.rotation));
    Ok(Obstacle {
        shape,
        normal,
        tangent,
        direction: direction.unwrap_or_default(),
        approach: approach.map(points),
        translation: translation.map(path).transpose().map_err(at)?,
        rotation: rotation.map(|document::Rotation { axis, through, history }| Rotation {
            axis,
            through,
            history: points(history),
        }),
    })
}

fn whose(kind: &ObstacleKind) -> &'static str {
    match kind {
        ObstacleKind::Plane => "a plane",
        ObstacleKind::Cylinder => "a cylinder",
        ObstacleKind::Bore => "a bore",
        ObstacleKind::Sphere => "a sphere",
        ObstacleKind::Socket => "a socket",
        ObstacleKind::Cone => "a cone",
        ObstacleKind::Wedge => "a wedge",
        ObstacleKind::Formula => "a formula",
        ObstacleKind::Table => "a table",
        ObstacleKind::Surface => "a surface",
    }
}

/// Refuses the keys of other kinds of obstacles.
fn own_keys(obstacle: &document::Obstacle) -> Result<(), InputError> {
    let document::Obstacle { kind, gap, through, radius, apex, center, axis, .. } = obstacle;
    let document::Obstacle { angle, half_angle, formula, file, scale, .. } = obstacle;
    let keys: &[&str] = match kind {
        ObstacleKind::Plane => &["gap", "through"],
        ObstacleKind::Cylinder | ObstacleKind::Bore => &["radius", "apex", "center", "axis"],
        ObstacleKind::Sphere | ObstacleKind::Socket => &["radius", "apex", "center"],
        ObstacleKind::Cone => &["apex", "half_angle", "axis"],
        ObstacleKind::Wedge => &["apex", "angle", "axis"],
        ObstacleKind::Formula => &["formula"],
        ObstacleKind::Table => &["file"],
        ObstacleKind::Surface => &["file", "scale"],
    };
    let given = [
        ("gap", gap.is_some()),
        ("radius", radius.is_some()),
        ("angle", angle.is_some()),
        ("half_angle", half_angle.is_some()),
        ("through", through.is_some()),
        ("apex", apex.is_some()),
        ("center", center.is_some()),
        ("axis", axis.is_some()),
        ("formula", formula.is_some()),
        ("file", file.is_some()),
        ("scale", scale.is_some()),
    ];
    let alien = given.into_iter().find(|(key, given)| *given && !keys.contains(key));
    alien.map_or(Ok(()), |(key, _)| foreign(key, Some(&()), whose(kind)))
}

fn shape(obstacle: &document::Obstacle, source: &Source) -> Result<Shape, InputError> {
    let document::Obstacle { kind, gap, through, radius, apex, center, axis, .. } = obstacle;
    let document::Obstacle { angle, half_angle, file, scale, .. } = obstacle;
    let whose = whose(kind);
    let number = |key: &str, value: &Option<f64>| needed(key, *value, "kind", whose);
    let place = || match (apex, center) {
        (Some(_), Some(_)) => {
            Err(InputError::new("center", format!("{whose} has both apex and center"), "keep one of them"))
        }
        (Some(apex), None) => Ok(Place::Apex(*apex)),
        (None, Some(center)) => Ok(Place::Center(*center)),
        (None, None) => {
            let help = "add one of them: a point of the surface, or its centre or a point of its axis";
            Err(InputError::new("kind", format!("{whose} needs apex or center"), help))
        }
    };
    let apex = || needed("apex", *apex, "kind", whose);
    let path = || needed("file", file.as_ref(), "kind", whose).map(|file| source.beside(file));
    Ok(match kind {
        ObstacleKind::Plane => match (gap, through) {
            (Some(_), Some(_)) => {
                return Err(InputError::new("through", "a plane has both gap and through", "keep one of them"));
            }
            (None, Some(through)) => Shape::PlaneThrough { through: *through },
            (gap, None) => Shape::Plane { gap: gap.unwrap_or(0.0) },
        },
        ObstacleKind::Cylinder => Shape::Cylinder { radius: number("radius", radius)?, place: place()?, axis: *axis },
        ObstacleKind::Bore => Shape::Bore { radius: number("radius", radius)?, place: place()?, axis: *axis },
        ObstacleKind::Sphere => Shape::Sphere { radius: number("radius", radius)?, place: place()? },
        ObstacleKind::Socket => Shape::Socket { radius: number("radius", radius)?, place: place()? },
        ObstacleKind::Cone => Shape::Cone { apex: apex()?, half_angle: number("half_angle", half_angle)?, axis: *axis },
        ObstacleKind::Wedge => Shape::Wedge { angle: number("angle", angle)?, apex: apex()?, axis: *axis },
        ObstacleKind::Formula => return needed("formula", None, "kind", whose),
        ObstacleKind::Table => Shape::Table { file: path()?, scale: 1.0 },
        ObstacleKind::Surface => Shape::Surface { file: path()?, scale: scale.unwrap_or(1.0) },
    })
}

/// Converts the points of a translation: a time and two or three coordinates each.
fn path(given: Vec<Vec<f64>>) -> Result<Vec<(f64, Vector)>, InputError> {
    let point = |point: Vec<f64>| match point[..] {
        [t, x, y] => Some((t, [x, y].into())),
        [t, x, y, z] => Some((t, [x, y, z].into())),
        _ => None,
    };
    let help = "give points [time, x, y] or [time, x, y, z], s and m, ordered by time";
    let points: Option<_> = given.into_iter().map(point).collect();
    points.ok_or_else(|| InputError::new("motion.translation", "translation is not a list of points", help))
}
