//! The contacts of a scene: boundaries in front of obstacles, or of each other.

use super::{Reader, given, obstacle, points};
use crate::base::units::Quantity;
use crate::body::description::{Against, Contact, Opposite};
use crate::scene::SceneError;
use crate::scene::document::{ContactTable, Names, Obstacles, Scalar};

/// Converts a contact.
pub(super) fn contact(mut given: ContactTable, reader: Reader<'_>) -> Result<Contact, SceneError> {
    let help = "give Coulomb's coefficient, or a formula of x, y and z for it, in m or as [units] says, such as \"0.1 + 0.2 * x\"";
    let friction = given.friction.take().map(|given| reader.field(Quantity::Number, "friction", given, help));
    let friction = friction.transpose()?;
    let is_glued = given.glue.unwrap_or(false);
    let (obstacle, against) = (given.obstacle.take(), given.against.take());
    let against = match (obstacle, against) {
        (Some(_), Some(_)) => {
            let help = "keep one of them; a boundary that meets both takes two [[contact]]s with parts of it";
            return reader.fault("against", "a contact has both an obstacle and a boundary that it is against", help);
        }
        (None, None) => {
            let help = "add [contact.obstacle], or against = \"name of a boundary\"";
            return reader.fault("", "a contact needs an obstacle or a boundary that it is against", help);
        }
        (Some(obstacles), None) => {
            let keys = given!(given; glue shift search gap adjust direction slave);
            reader.foreign("a contact with an obstacle", keys)?;
            Against::Obstacles(match obstacles {
                Obstacles::One(one) => {
                    vec![obstacle::obstacle(*one, Reader { key: &reader.path("obstacle"), ..reader })?]
                }
                Obstacles::Several(all) => reader.each("obstacle", all, obstacle::obstacle)?,
            })
        }
        (None, Some(names)) => {
            if is_glued {
                reader.foreign("what is glued", &[("friction", friction.is_some())])?;
            }
            Against::Boundary(opposite(names, &given, reader)?)
        }
    };
    let needs_friction = || {
        let help = "add friction = 0.3, or 0 without friction";
        reader.fault("friction", "a contact needs its friction", help)
    };
    let friction = if is_glued { 0.0.into() } else { friction.map_or_else(needs_friction, Ok)? };
    let friction_history = given.friction_history.map(points);
    Ok(Contact { boundary: given.boundary, friction, friction_history, against })
}

fn opposite(names: Names, given: &ContactTable, reader: Reader<'_>) -> Result<Opposite, SceneError> {
    let help = "give \"measured\", a number, or a formula of x, y and z, in m or as [units] says";
    Ok(Opposite {
        boundaries: match names {
            Names::One(name) => vec![name],
            Names::Several(names) => names,
        },
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
