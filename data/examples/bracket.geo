// A bracket that a bolt holds on a wall. Lengths in mm.
//   gmsh -3 bracket.geo -format msh41
width = 20;   // along y
across = 6;   // elements along the width
n = 4;        // elements through the thickness of 8 mm

// The profile in the plane y = 0: a column at the wall, with the seat of the bolt in its front, and a shelf.
z() = {0, 14, 24, 40, 48};
rows() = {10, 8, 10, n};
For i In {0:4}
  Point(10 + i) = {0, 0, z(i)};
  Point(20 + i) = {8, 0, z(i)};
  Line(10 + i) = {10 + i, 20 + i};
EndFor
Transfinite Curve {10:14} = n + 1;
For i In {0:3}
  Line(20 + i) = {10 + i, 11 + i};
  Line(30 + i) = {20 + i, 21 + i};
  Transfinite Curve {20 + i, 30 + i} = rows(i) + 1;
  Curve Loop(1 + i) = {10 + i, 30 + i, -(11 + i), -(20 + i)};
  Plane Surface(1 + i) = {1 + i};
EndFor
Point(30) = {60, 0, 40};
Point(31) = {60, 0, 48};
Line(40) = {23, 30}; Line(41) = {30, 31}; Line(42) = {24, 31};
Transfinite Curve {40, 42} = 19;
Transfinite Curve {41} = n + 1;
Curve Loop(5) = {40, 41, -42, -33};
Plane Surface(5) = {5};
Transfinite Surface {1:5};
Recombine Surface {1:5};
out() = Extrude {0, width, 0} { Surface{1:5}; Layers{across}; Recombine; };

// What the scene names.
e = 0.01;
Physical Surface("back") = Surface In BoundingBox {-e, -e, -e, e, width + e, 48 + e};
Physical Surface("seat") = Surface In BoundingBox {8 - e, -e, 14 - e, 8 + e, width + e, 24 + e};
Physical Surface("shelf") = Surface In BoundingBox {8 - e, -e, 48 - e, 60 + e, width + e, 48 + e};
Physical Volume("bracket") = Volume{:};
