//! Supports, springs and loads that cannot be, each told with file, line and cure.

use crate::common::prelude::*;

/// Refused as the scene is read.
const READ: &str = include_str!("tables/loads_as_read.txt");

/// Refused when the mesh is known.
const BUILT: &str = include_str!("tables/loads_as_built.txt");

#[test]
fn supports_springs_and_loads_that_cannot_be() {
    verify_all(BLOCK, READ, located);
    verify_all(&edit(BLOCK, "[100, 100]", "[4, 4]"), BUILT, built);
}

/// A sweep of a displacement goes through 0.
#[test]
fn a_displacement_of_nothing_may_have_a_history() {
    let moved = edit(BLOCK, "\"y\"]", "\"y\"]\ndisplacement = [0, 0]\nhistory = [[0, 0], [1, 1]]");
    model_of(&moved);
}
