//! Values that a scene may not have, and values that contradict one another.

use crate::common::prelude::*;

const VALUES: &str = r#"
"bn" | "bn"¶r_factor = 2 | r_factor | the method bn in the setting paper has no r_factor | remove the key
"bn" | "bn"¶start = "safe" | start | the method bn in the setting paper has no start | remove the key
"bn" | "ip"¶r_factor = 2 | r_factor | the method ip has no r_factor | remove the key
setting = "paper" | r_factor = 0 | r_factor | solver.r_factor is 0.0 & positive | studies of r
setting = "paper" | r_factor = -1.0 | r_factor | solver.r_factor is -1.0 & positive | studies of r
method = "bn"¶setting = "paper" | method = "ip"¶partition = "cone" | partition |
    the method ip has a start and a partition in the setting paper only | remove the key
friction = 0.4 | friction = -0.1 | friction = | friction is -0.1 & 0 or more | 0 for a frictionless
0.3 | 0.5 | poisson = | material.poisson is 0.5 & below 0.5 | incompressible
0.3 | 0.7 | poisson = | material.poisson is 0.7 & below 0.5 | 0.49
0.3 | -1.0 | poisson = | material.poisson is -1.0 & above -1 | 0.49
210e9 | 0.0 | young = | material.young is 0.0 & positive | Young's modulus in Pa
210e9 | -210e9 | young = | material.young is -2 & positive | Young's modulus in Pa
[100, 100] | [10, 10, 3] | elements = | [10, 10, 3] & a number for each length | segments
[100, 100] | [10] | elements = | [10] & a number for each length | segments
elements = | grading = [1, 2, 3]¶elements = | grading = | [1.0, 2.0, 3.0] & a number for each length | segments
elements = | cells = "tetrahedron10"¶elements = | cells = | mesh.cells have 3 dimensions, but mesh.size has 2 |
    "triangle6"
elements = | cells = "prism"¶elements = | cells = | mesh.cells have 3 dimensions | "quadrilateral"
elements = | cells = "tetrahedron"¶elements = | cells = | mesh.cells have 3 dimensions, but mesh.size has 2 | "triangle"
[0.0, -10e6] | [0.0] | traction = [0.0 | traction is [0.0] & two or three | for each axis
[1.0, 1.0] | [1.0] | size = | mesh.size is [1.0] & two or three | along x, y and z
[1.0, 1.0] | [1.0, []] | size = | mesh.size is [1.0, []] & positive | along x, y and z
[1.0, 1.0] | [[0.5, 0.5], 1.0] | elements = | [100, 100] & a number for each length | segments
[100, 100] | [[50, 0], 100] | elements = | [[50, 0], 100] & a number for each length | segments
poisson = 0.3¶ | poisson = 0.3¶layers = [[0.1, 1e9, 0.3]]¶group = [{ name = "a", young = 1e9, poisson = 0.3 }]¶ |
    layers = | layers and groups | keep material.layers or
[100, 100] | [0, 100] | elements = | [0, 100] & at least 1 | numbers of elements
[100, 100] | [100, -2] | elements = | [100, -2] & at least 1 | numbers of elements
[100, 100] | [10000, 10000] | elements = | [10000, 10000] & at most 50 million | coarser mesh
[100, 100] | [4000000000, 5000000000] | elements = | at most 50 million | coarser mesh
[1.0, 1.0] | [0.0, 1.0] | size = | mesh.size is [0.0, 1.0] & positive | width and height in m
[1.0, 1.0] | [1.0, -1.0] | size = | mesh.size is [1.0, -1.0] & positive | width and height in m
[2, 1]] | [0.5, 1]] | [0.5, 1]] | from time 1 to 0.5 & increase | order the points
[2, 1]] | [1, 0]] | [1, 0]] | from time 1 to 1 & increase | each time once
// Squares and products of these overflow, and a sum of infinities is no verdict.
friction = 0.4 | friction = 1e160 | friction = | friction has the number 1e160 & overflow | SI units
gap = 1e-5 | gap = -1e308 | gap = | gap has the number -1e308 & overflow | SI units
210e9 | 1e-320 | young = | material.young is 1e-320 & 1e-50 or more | Young's modulus in Pa
size = [1.0, 1.0] | size = [1e-300, 1.0] | size = | mesh.size is 1e-300 & 1e-50 or more | in m
210e9 | 1e300 | young = | material.young has the number 1e300 & overflow | SI units
[0.0, -10e6] | [0.0, -1e308] | [0.0, -1e308] | traction has the number -1e308 & overflow | SI units
[1, 1], [2, 0]] | [1, 1e308], [2, 0]] | 1e308 | history has the number 1e308 & overflow | SI units
gap = 1e-5 | gap = 0, motion.translation = [[0, 0, 0], [1, 1e200, 0]] | 1e200 | 1e200 & overflow | SI units
[[0, 0], [1, 1], [2, 0]] | [] | history = [] | history is empty | [time, factor]
["x", "y"] | [] | fix = [] | fix is empty | ["x", "y"]
gap = 1e-5 | normal = [0, 0] | normal | normal is [0.0, 0.0] & direction | [0, -1]
gap = 1e-5 | normal = [0, -1], tangent = [0, 0] | tangent | tangent is [0.0, 0.0] | [0, -1]
gap = 1e-5 | normal = [0, -1], tangent = [1, 0.1] | tangent | right angles | leave the tangent out
gap = 1e-5 | tangent = [1, 0] | tangent | right angles to a given normal | give both
end = 2.0 | end = 0.0 | end = | time.end is 0.0 & positive | from 0 to this time
end = 2.0 | end = -1.0 | end = | time.end is -1.0 & positive | from 0 to this time
"block" | "half-plane" | elements = | a half-plane has no mesh.elements | remove the key
elements = | layers = 3¶elements = | layers = | a block has no mesh.layers | remove the key
elements = [100, 100]¶ | - | kind = "block" | a block needs mesh.elements | add the key
elements = [100, 100]¶¶[material]¶young = 210e9                   # Pa¶poisson = 0.3¶plane = "strain" |
    elements = [100, 100]¶element = "b-bar"¶[material]¶young = 210e9¶poisson = 0.3¶plane = "stress" | element = |
    mesh.element is "b-bar" & material.plane is "stress" | use "bilinear"
elements = [100, 100]¶¶[material]¶young = 210e9                   # Pa¶poisson = 0.3¶plane = "strain" |
    elements = [100, 100]¶cells = "triangle"¶element = "nodal-volume"¶[material]¶young = 210e9¶poisson = 0.3¶
    plane = "stress" | element = | mesh.element is "nodal-volume" & material.plane is "stress" | use "bilinear"
elements = | grading = [0, 1]¶elements = | grading = | [0.0, 1.0] & 1e-6 to 1e6 | size of the last
elements = | grading = [1, -2]¶elements = | grading = | [1.0, -2.0] & 1e-6 to 1e6 | size of the last
elements = | origin = [1, 0, 0]¶elements = | origin = | [1.0, 0.0, 0.0] & each axis of mesh.size | lowest corner
elements = | origin = [nan, 0]¶elements = | origin = | finite number | lowest corner
elements = | grading = [1, 1e7]¶elements = | grading = | 1e-6 to 1e6 | size of the last
"block"¶size = [1.0, 1.0]               # m¶elements = [100, 100] | "half-plane"¶size = [1.0, 1.0]¶grading = [1, 2] |
    grading = | a half-plane has no mesh.grading | remove the key
poisson = | layers = [[0.1, 1e9, 0.3],¶[0.0, 1e9, 0.3]]¶poisson = | [0.0, 1e9 |
    the thickness in material.layers[1] is 0.0 & positive | thickness of the layer in m
poisson = | layers = [[0.1, -1.0, 0.3]]¶poisson = | layers = |
    Young's modulus in material.layers[0] is -1.0 & positive | in Pa
poisson = | layers = [[0.1, 1e9, 0.5]]¶poisson = | layers = | Poisson's ratio in material.layers[0] is 0.5 & below 0.5 |
    0.49
gap = 1e-5 | radius = 1.0 | radius | a plane has no radius | remove the key
"plane", gap = 1e-5 | "cylinder" | cylinder | a cylinder needs radius | add the key
"plane", gap = 1e-5 | "cylinder", radius = -1.0, apex = [0.5, 0] | cylinder | radius is -1.0 & positive | in m
"plane", gap | "cylinder", gap | cylinder | a cylinder has no gap | remove the key
gap = 1e-5 | approach = [] | approach | approach is empty | [time, distance]
gap = 1e-5 | approach = [[1, 0], [0, 1]] | approach | from time 1 to 0 | [time, distance]
increments = 40 | increments = 0 | increments = | time.increments is 0 & at least 1 | equal increments
increments = 40 | increments = 10000001 | increments = | at most 10 million | equal increments
[1.0, 2.0] | [1.0, 2.5] | times = | holds 2.5, & from 0 to 2 | from 0 (before the first increment)
[1.0, 2.0] | [-1.0] | times = | holds -1, & from 0 to 2 | to time.end, s
"paper" | "paper"¶max_iterations = 0 | max_it | max_iterations is 0 | has not converged
"paper" | "paper"¶tolerance = 0.0 | tolerance | tolerance is 0.0 & above 0 | e.g. 1e-10
"paper" | "paper"¶tolerance = 1 | tolerance | tolerance is 1.0 & below 1 | e.g. 1e-10
[[contact]] | [[contact]]¶boundary = "bottom" # again¶friction = 0¶obstacle = { kind = "plane" }¶[[contact]] |
    boundary = "bottom"¶ | `bottom` has a [[contact]] already | one [[contact]] for each boundary
"#;

#[test]
fn values_out_of_range() {
    verify_all(BLOCK, VALUES, located);
}
