//! Shapes, supports, loads and obstacles that a body of revolution cannot have.

use crate::common::prelude::*;

scene! {
static DISC = r#"
[mesh] kind = "block", size = [1.0, 1.0], elements = [2, 2]
[material] young = 1e9, poisson = 0.3, density = 1000, plane = "axisymmetric"
[[support]] boundary = "top", fix = ["x", "y"]
[[contact]] boundary = "bottom", friction = 0.3
[contact.obstacle] kind = "plane", gap = 0.01
[[load]] boundary = "right", traction = [0.0, -1.0]
[time] end = 1.0, increments = 1
"# }

const FAULTS: &str = include_str!("tables/axisymmetric.txt");

#[test]
fn what_is_no_body_of_revolution() {
    assert!(discretise(&parsed(&DISC)).is_ok());
    verify_all(&DISC, FAULTS, refused);
}

/// Keys that ask nothing of the axis but what it holds by itself are no fault, and obstacles of revolution of every kind are none.
#[test]
fn what_is_one() {
    for (from, to) in [
        ("elements = [2, 2]", "elements = [2, 2]\norigin = [-1e-13, 0]"),
        ("elements = [2, 2]", "elements = [2, 2]\norigin = [0.5, 0]"),
        ("[[load]]", "[[support]]\nboundary = \"left\"\nfix = [\"x\"]\n[[load]]"),
        ("[[load]]", "[[spring]]\npoint = [0, 0.5]\nstiffness = [1e6, 0]\n[[load]]"),
        ("kind = \"plane\"\ngap = 0.01", "kind = \"sphere\"\nradius = 1.0\ncenter = [0, -1.01]"),
        ("kind = \"plane\"\ngap = 0.01", "kind = \"socket\"\nradius = 9.0\ncenter = [0, 8.9]"),
        ("kind = \"plane\"\ngap = 0.01", "kind = \"cone\"\nhalf_angle = 1.2\napex = [0, -0.01]\naxis = [0, -2]"),
        ("kind = \"plane\"\ngap = 0.01", "kind = \"wedge\"\nangle = 0.2\napex = [0.5, -0.01]"),
        ("kind = \"plane\"\ngap = 0.01", "kind = \"cylinder\"\nradius = 1\ncenter = [0.5, -1.01]"),
        ("kind = \"plane\"\ngap = 0.01", "kind = \"plane\"\nthrough = [0, -0.2]\nnormal = [0.1, -1]"),
        ("gap = 0.01", "gap = 0.01\nmotion = { translation = [[0, 0, 0], [1, 0, 0.02]] }"),
    ] {
        let text = edit(&DISC, from, to);
        assert!(discretise(&parsed(&text)).is_ok(), "{to}");
    }
}
