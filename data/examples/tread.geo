// A block of a tyre's tread, glued to the belt above it. Lengths in mm.
//   gmsh -2 tread.geo -format msh41
Point(1) = {0, 0, 0};
Point(2) = {20, 0, 0};
Point(3) = {22, 8, 0};
Point(4) = {-2, 8, 0};
Line(1) = {1, 2}; Line(2) = {2, 3}; Line(3) = {3, 4}; Line(4) = {4, 1};
Curve Loop(1) = {1, 2, 3, 4};
Plane Surface(1) = {1};
// Finer towards both rims, and towards the road.
Transfinite Curve {1, 3} = 49 Using Bump 0.25;
Transfinite Curve {2, -4} = 21 Using Progression 1.06;
Transfinite Surface {1};
Recombine Surface {1};
Physical Curve("road side") = {1};
Physical Curve("belt") = {3};
Physical Surface("rubber") = {1};
