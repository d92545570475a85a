//! Supports, springs and loads that cannot be, each told with file, line and cure.

use crate::common::prelude::*;

/// Refused as the scene is read.
const READ: &str = r#"
fix = ["x", "y"] | fix = [] | fix = | fix is empty | ["x", "y"]
fix = ["x", "y"] | fix = ["n"] | fix = | unknown variant `n` | one of the values
fix = ["x", "y"] | fix = ["x"]¶direction = [1, 1] | direction | both fix and direction | keep one
fix = ["x", "y"] | direction = [0, 0] | direction | a vector with a direction | give e.g.
fix = ["x", "y"] | direction = [nan, 1] | direction | finite | not nan
fix = ["x", "y"] | fix = ["x"]¶displacement = [1, 2] | displacement | 2 values & holds 1 | in the order of fix
fix = ["x", "y"] | fix = ["x"]¶displacement = inf | displacement | finite | other than nan
fix = ["x", "y"] | fix = ["x"]¶history = [[0, 1]] | history = [[0, 1]] | moves nothing | add a displacement
fix = ["x", "y"] | fix = ["x"]¶displacement = 1¶history = [[1, 1], [0, 0]] | history = [[1, 1], [0, 0]] |
    times must increase | order the points
fix = ["x", "y"] | fix = ["x"]¶point = [0, 0] | point | both boundary and point | keep one
boundary = "left"¶ | - | [[support]] | needs a boundary, a point or a coupling | add one
boundary = "left"¶fix = ["x", "y"] | point = [0, 0]¶fix = ["normal"] | fix | single point | direction
traction = [0.0, -10e6] | - | # Q2 | a load does nothing | add one of traction
traction = [0.0, -10e6] | traction = [0, "2 x"] | traction | the formula & operator is missing | a formula of x
traction = [0.0, -10e6] | traction = [0, 1, 2, 3] | traction | two or three | each axis
traction = [0.0, -10e6] | pressure = 1¶force = [0, 1] | force | both pressure and force | two loads
traction = [0.0, -10e6] | pressure = nan | pressure | finite | other than nan
traction = [0.0, -10e6] | pressure = true | pressure | a number or a formula | shows the form
traction = [0.0, -10e6] | force = [0, nan] | force | finite | not nan
traction = [0.0, -10e6] | acceleration = [0, -9.81] | boundary = "top" | an acceleration has no boundary |
    remove the key
boundary = "top"¶traction = [0.0, -10e6] | acceleration = [1] | acceleration | two or three | each axis
boundary = "top"¶traction = [0.0, -10e6] | rotation = { through = [0, 0], speed = inf } | rotation | speed & finite |
    other than nan
boundary = "top"¶traction = [0.0, -10e6] | rotation = { through = [0, 0], speed = 1, axis = [0, 0, 0] } | rotation |
    a direction | give e.g.
boundary = "top"¶traction = [0.0, -10e6] | temperature = "20 +" | temperature | the formula | a formula of x
[time] | [[spring]]¶boundary = "top"¶[time] | [[spring]] | needs a stiffness | stiffness per area
[time] | [[spring]]¶normal = 1¶[time] | [[spring]] | needs a boundary, a point or a coupling | add one
[time] | [[spring]]¶boundary = "top"¶normal = -1¶[time] | normal = -1 | 0 or more | stiffness
[time] | [[spring]]¶boundary = "top"¶normal = 0¶[time] | normal = 0 | not 0 throughout | stiffness
[time] | [[spring]]¶boundary = "top"¶normal = 1¶stiffness = [1, 1]¶[time] | normal = 1 | has no normal | remove the key
[time] | [[spring]]¶point = [0, 0]¶normal = 1¶[time] | [[spring]] | at a point needs stiffness | axes
poisson = 0.3 | poisson = 0.3¶density = 0 | density | positive | kg/m
poisson = 0.3 | poisson = 0.3¶expansion = nan | expansion | finite | other than nan
"#;

/// Refused when the mesh is known.
const BUILT: &str = r#"
fix = ["x", "y"] | fix = ["z"] | fix | two dimensions | leave out
fix = ["x", "y"] | direction = [1, 0, 0] | direction | 3 components | [x, y]
boundary = "left" | point = [0.01, 0.3] | point | no node of the mesh is at (0.01, 0.3) | the nearest
boundary = "top"¶traction = [0.0, -10e6] | rotation = { speed = 1 } | rotation | no point of its axis | through = [0, 0]
boundary = "top"¶traction = [0.0, -10e6] | acceleration = [0, 1] | [material] | a load needs the density | 7850
boundary = "top"¶traction = [0.0, -10e6] | temperature = 20 | [material] | a load needs the expansion | 12e-6
boundary = "top"¶traction = [0.0, -10e6] | acceleration = [0, 0, 1] | acceleration | 3 components | [x, y]
traction = [0.0, -10e6] | force = [0, 0, 1] | force | 3 components | [x, y]
traction = [0.0, -10e6] | pressure = "sqrt(-1 - x)" | pressure | not a finite number everywhere | has a value
traction = [0.0, -10e6] | traction = [0, "1 / (x - x)"] | traction | not a finite number | has a value
traction = [0.0, -10e6] | traction = [0, "1e6 * z"] | traction | `1e6 * z` has z, but the body has two | use x and y
boundary = "top"¶traction = [0.0, -10e6] | point = [0.31, 0.77]¶force = [0, 1] | point | no node | the nearest
[time] | [[spring]]¶boundary = "roof"¶normal = 1¶[time] | boundary = "roof" | no boundary `roof` | has the
[time] | [[support]]¶boundary = "left"¶fix = ["x"]¶displacement = 1e-3¶[time] | displacement |
    move the node at & different places | agree
"#;

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
