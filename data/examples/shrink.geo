// A quarter of a ring that is shrunk on a shaft. Lengths in mm.
//   gmsh -2 shrink.geo -format msh41
n = 20;  // elements through the ring
Point(1) = {0, 0, 0};
Point(2) = {30, 0, 0};
Point(3) = {50, 0, 0};
Point(4) = {0, 50, 0};
Point(5) = {0, 30, 0};
Line(1) = {2, 3};
Circle(2) = {3, 1, 4};
Line(3) = {4, 5};
Circle(4) = {5, 1, 2};
Curve Loop(1) = {1, 2, 3, 4};
Plane Surface(1) = {1};
Transfinite Curve {1, 3} = n + 1;
Transfinite Curve {2, 4} = 2 * n + 1;
Transfinite Surface {1};
Recombine Surface {1};
Physical Curve("x axis") = {1};
Physical Curve("y axis") = {3};
Physical Curve("bore") = {4};
Physical Surface("ring") = {1};
