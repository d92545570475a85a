//! The couplings of a scene.

use super::Reader;
use crate::body::description::{Coupling, Part};
use crate::scene::{SceneError, document};

/// Converts a coupling.
pub(super) fn coupling(given: document::Coupling, reader: Reader<'_>) -> Result<Coupling, SceneError> {
    let document::Coupling { name, boundary, body, point, kind } = given;
    let part = match (boundary, body) {
        (Some(boundary), None) => Part::Boundary(boundary),
        (None, Some(body)) => Part::Body(body),
        (Some(_), Some(_)) => return reader.fault("body", "a coupling has both boundary and body", "keep one of them"),
        (None, None) => {
            return reader.fault("boundary", "a coupling needs a boundary or a body", "add one of the keys");
        }
    };
    Ok(Coupling { name, part, point: point.map(|point| reader.point(point)), kind })
}
