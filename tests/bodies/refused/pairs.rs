//! Scenes of bodies in contact: what is refused, where, and with which words.

use crate::common::prelude::*;

const TWO_BLOCKS: &str = include_str!("../../../data/scenes/two_blocks.toml");

const READ: &str = r#"
friction = 0.2¶ | friction = 0.2¶obstacle = { kind = "plane" }¶ | against = | both an obstacle and a boundary |
    keep one of them
against = "lower:top"¶ | - | [[contact]] | a contact needs an obstacle or a boundary | against =
friction = 0.2¶ | friction = 0.2¶glue = true¶ | friction = | what is glued has no friction | remove the key
against = "lower:top" | against = "upper:bottom" | against = | is against itself | in front of it
friction = 0.2¶ | - | [[contact]] | a contact needs its friction | add friction = 0.3
friction = 0.2¶ | friction = 0.2¶search = 0¶ | search = | search is 0.0 | the distance in m
friction = 0.2¶ | friction = 0.2¶adjust = -1¶ | adjust = | adjust is -1.0, but must be 0 or more | a distance in m
friction = 0.2¶ | friction = 0.2¶gap = 0¶adjust = 1e-6¶ | adjust = | left out where gap says | remove the key
friction = 0.2¶ | friction = 0.2¶gap = "1 +"¶ | gap = | something is missing | "measured"
friction = 0.2¶ | friction = 0.2¶gap = "curve"¶ | gap = | curve | "measured"
friction = 0.2¶ | glue = true¶gap = 1e-5¶ | gap = | left out where bodies are glued | remove the key
friction = 0.2¶ | friction = 0.2¶gap = "measured"¶adjust = -1¶ | adjust = | 0 or more | a distance in m
against = "lower:top" | obstacle = { kind = "plane" }¶gap = "measured" | gap = | a contact with an obstacle | remove
friction = 0.2¶ | friction = 0.2¶direction = [0, 0]¶ | direction = | a vector with a direction | [0, -1]
"#;

#[test]
fn what_cannot_be_read_is_told_at_its_place() {
    verify_all(TWO_BLOCKS, READ, located);
}

const BUILT: &str = r#"
against = "lower:top" | against = "top" | against = | no boundary `top` | lower:top
at = [0.0, 0.5] | at = [0.0, 0.8] | [[contact]] | nothing of `lower:top` is in front | longer `search`
friction = 0.2¶ | friction = 0.2¶direction = [0, 1]¶ | direction = | points into the body | turn the direction round
friction = 0.2¶ | friction = 0.2¶gap = "sqrt(-x - 1)"¶ | gap = | the gap is NaN | mend the formula
"#;

#[test]
fn what_the_meshes_tell_is_told_at_its_place() {
    verify_all(TWO_BLOCKS, BUILT, built);
    let far = edit(TWO_BLOCKS, "friction = 0.2\n", "friction = 0.2\nsearch = 0.3\n");
    verify_all(&far, "at = [0.0, 0.5] | at = [0.0, 0.35] | against = | inside each other | move a body out", built);
}
