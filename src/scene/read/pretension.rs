//! The pretensions of a scene.

use super::points;
use crate::base::input_error::InputError;
use crate::body::description::{Pretension, Tightening};
use crate::scene::document;

/// Converts the pretension at `key`.
pub(super) fn pretension(given: document::Pretension, key: &str) -> Result<Pretension, InputError> {
    let document::Pretension { name, boundary, force, shortening, history, lock } = given;
    let fault = |name: &str, message: &str, help: &str| Err(InputError::new(format!("{key}.{name}"), message, help));
    let tightening = match (force, shortening) {
        (Some(force), None) => Tightening::Force { space: force, plane: force },
        (None, Some(shortening)) => Tightening::Shortening(shortening),
        (Some(_), Some(_)) => {
            return fault("shortening", "a pretension has both force and shortening", "keep one of them");
        }
        (None, None) => return fault("force", "a pretension needs a force or a shortening", "add one of the keys"),
    };
    Ok(Pretension { name, boundary, tightening, history: history.map(points), lock })
}
