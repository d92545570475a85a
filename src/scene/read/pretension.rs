//! The pretensions of a scene.

use super::{Reader, points};
use crate::base::units::Quantity;
use crate::body::description::{Pretension, Tightening};
use crate::scene::{SceneError, document};

/// Converts a pretension.
pub(super) fn pretension(given: document::Pretension, reader: Reader<'_>) -> Result<Pretension, SceneError> {
    let document::Pretension { name, boundary, force, shortening, history, lock } = given;
    let tightening = match (force, shortening) {
        (Some(force), None) => {
            let [plane, space] = [2, 3].map(|dimension| reader.in_dimension(dimension, Quantity::Force, force));
            Tightening::Force { space, plane }
        }
        (None, Some(shortening)) => Tightening::Shortening(reader.length(shortening)),
        (Some(_), Some(_)) => {
            return reader.fault("shortening", "a pretension has both force and shortening", "keep one of them");
        }
        (None, None) => {
            return reader.fault("force", "a pretension needs a force or a shortening", "add one of the keys");
        }
    };
    Ok(Pretension { name, boundary, tightening, history: history.map(points), lock })
}
