//! The couplings of a scene.

use crate::base::input_error::InputError;
use crate::body::description::{Coupling, CouplingKind, Part};
use crate::scene::document;

/// Converts the coupling at `key`.
pub(super) fn coupling(given: document::Coupling, key: &str) -> Result<Coupling, InputError> {
    let document::Coupling { name, boundary, body, point, kind } = given;
    let fault = |name: &str, message: &str, help: &str| Err(InputError::new(format!("{key}.{name}"), message, help));
    let part = match (boundary, body) {
        (Some(boundary), None) => Part::Boundary(boundary),
        (None, Some(body)) => Part::Body(body),
        (Some(_), Some(_)) => return fault("body", "a coupling has both boundary and body", "keep one of them"),
        (None, None) => return fault("boundary", "a coupling needs a boundary or a body", "add one of the keys"),
    };
    let kind = match kind {
        document::CouplingKind::Rigid => CouplingKind::Rigid,
        document::CouplingKind::Distributing => CouplingKind::Distributing,
    };
    Ok(Coupling { name, part, point, kind })
}
