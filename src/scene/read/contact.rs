//! The contacts of a scene: boundaries in front of obstacles, or of each other.

use crate::base::input_error::InputError;
use crate::body::contact::Friction;
use crate::body::description::{Against, Contact, FirstGap, Opposite, Slave};
use crate::scene::SceneError;
use crate::scene::document::{self, Names, Scalar};
use crate::scene::error::Source;

use super::{foreign, formula, obstacle, points};

/// Converts contact `k` of the scene `source`.
pub(super) fn contact(k: usize, given: document::ContactTable, source: &Source) -> Result<Contact, SceneError> {
    let key = format!("contact[{k}]");
    let at = |fault: InputError| source.located(fault.with_key(&key));
    let friction = given.friction.as_ref().map(|given| friction(given, &key, source)).transpose()?;
    let needs_friction = || {
        let help = "add friction = 0.3, or 0 without friction";
        at(InputError::new("friction", "a contact needs its friction", help))
    };
    let (against, friction) = match (given.obstacle, given.against) {
        (Some(_), Some(_)) => {
            let help = "keep one of them; a boundary that meets both takes two [[contact]]s with parts of it";
            return Err(at(InputError::new(
                "against",
                "a contact has both an obstacle and a boundary that it is against",
                help,
            )));
        }
        (None, None) => {
            let help = "add [contact.obstacle], or against = \"name of a boundary\"";
            return Err(source.located(InputError::new(
                key,
                "a contact needs an obstacle or a boundary that it is against",
                help,
            )));
        }
        (Some(obstacles), None) => {
            let whose = "a contact with an obstacle";
            foreign("glue", given.glue.as_ref(), whose)
                .and(foreign("shift", given.shift.as_ref(), whose))
                .and(foreign("search", given.search.as_ref(), whose))
                .and(foreign("gap", given.gap.as_ref(), whose))
                .and(foreign("adjust", given.adjust.as_ref(), whose))
                .and(foreign("direction", given.direction.as_ref(), whose))
                .and(foreign("slave", given.slave.as_ref(), whose))
                .map_err(at)?;
            let obstacles = obstacles_at(obstacles, &format!("{key}.obstacle"), source)?;
            (Against::Obstacles(obstacles), friction.ok_or_else(needs_friction)?)
        }
        (None, Some(names)) => {
            let boundaries = match names {
                Names::One(name) => vec![name],
                Names::Several(names) => names,
            };
            let gap = match given.gap {
                None => FirstGap::Measured,
                Some(Scalar::Number(gap)) => FirstGap::Uniform(gap),
                Some(Scalar::Text(text)) if text == "measured" || text == "curved" => FirstGap::Measured,
                Some(Scalar::Text(text)) => {
                    let help = "give \"measured\", a number, or a formula of x, y and z, in m or as [units] says";
                    FirstGap::Formula(formula(&text, format!("{key}.gap"), help, source)?)
                }
            };
            let slave = match given.slave {
                None | Some(document::Slave::Boundary) => Slave::First,
                Some(document::Slave::Automatic) => Slave::Automatic,
            };
            let glued = given.glue.unwrap_or(false);
            let opposite = Opposite {
                boundaries,
                glued,
                shift: given.shift,
                search: given.search,
                gap,
                adjust: given.adjust.unwrap_or(0.0),
                direction: given.direction,
                slave,
            };
            if glued {
                foreign("friction", friction.as_ref(), "what is glued").map_err(at)?;
            }
            let friction = if glued { Friction::Uniform(0.0) } else { friction.ok_or_else(needs_friction)? };
            (Against::Boundary(opposite), friction)
        }
    };
    let friction_history = given.friction_history.map(points);
    Ok(Contact { boundary: given.boundary, friction, friction_history, against })
}

fn friction(given: &document::Friction, key: &str, source: &Source) -> Result<Friction, SceneError> {
    match given {
        document::Friction::Number(coefficient) => Ok((*coefficient).into()),
        document::Friction::Formula(text) => {
            let help = "give Coulomb's coefficient, or a formula of x, y and z for it, in m or as [units] says, such as \"0.1 + 0.2 * x\"";
            Ok(formula(text, format!("{key}.friction"), help, source)?.into())
        }
    }
}

fn obstacles_at(
    given: document::Obstacles,
    key: &str,
    source: &Source,
) -> Result<Vec<crate::body::contact::Obstacle>, SceneError> {
    match given {
        document::Obstacles::One(one) => Ok(vec![obstacle::obstacle(*one, key, source)?]),
        document::Obstacles::Several(all) => (all.into_iter().enumerate())
            .map(|(j, one)| obstacle::obstacle(one, &format!("{key}[{j}]"), source))
            .collect(),
    }
}
