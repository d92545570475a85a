//! Values that a scene may not have, and values that contradict one another.

use crate::common::prelude::*;

const VALUES: &str = include_str!("tables/values.txt");

#[test]
fn values_out_of_range() {
    verify_all(BLOCK, VALUES, located);
}
