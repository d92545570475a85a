//! Scenes of bodies in contact: what is refused, where, and with which words.

use crate::common::prelude::*;

const TWO_BLOCKS: &str = include_str!("../../../data/scenes/two_blocks.toml");

const READ: &str = include_str!("tables/pairs_as_read.txt");

#[test]
fn what_cannot_be_read_is_told_at_its_place() {
    verify_all(TWO_BLOCKS, READ, located);
}

const BUILT: &str = include_str!("tables/pairs_as_built.txt");

#[test]
fn what_the_meshes_tell_is_told_at_its_place() {
    verify_all(TWO_BLOCKS, BUILT, built);
    let far = edit(TWO_BLOCKS, "friction = 0.2\n", "friction = 0.2\nsearch = 0.3\n");
    verify_all(&far, "at = [0.0, 0.5] | at = [0.0, 0.35] | against = | inside each other | move a body out", built);
}
