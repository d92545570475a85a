// A bracket of steel on a wall, a roller on its shelf. Lengths in mm.
//   gmsh -3 bracket.geo -format msh41
width = 20;   // along y
across = 8;   // elements along the width
n = 4;        // elements through the thickness of 8 mm

// The profile in the plane y = 0: a column at the wall and a shelf, fine where the roller touches.
x() = {0, 8, 38, 52, 60};
For i In {0:1}
  Point(1 + i) = {x(i), 0, 0};
EndFor
For i In {0:4}
  Point(11 + i) = {x(i), 0, 40};
  Point(21 + i) = {x(i), 0, 48};
EndFor
Line(1) = {1, 2}; Line(2) = {2, 12}; Line(3) = {11, 12}; Line(4) = {1, 11};
Curve Loop(1) = {1, 2, -3, -4}; Plane Surface(1) = {1};
For i In {0:4}
  Line(20 + i) = {11 + i, 21 + i};
EndFor
Line(10) = {21, 22};
Curve Loop(2) = {3, 21, -10, -20}; Plane Surface(2) = {2};
For i In {1:3}
  Line(30 + i) = {11 + i, 12 + i};
  Line(40 + i) = {21 + i, 22 + i};
  Curve Loop(2 + i) = {30 + i, 21 + i, -(40 + i), -(20 + i)}; Plane Surface(2 + i) = {2 + i};
EndFor
Transfinite Curve {1, 3, 10, 20:24} = n + 1;
Transfinite Curve {2, 4} = 11;
Transfinite Curve {31, 41} = 9;
Transfinite Curve {32, 42} = 29;
Transfinite Curve {33, 43} = 4;
Transfinite Surface {1:5};
Recombine Surface {1:5};
out() = Extrude {0, width, 0} { Surface{1:5}; Layers{across}; Recombine; };

// What the scene names: the wall side of the column, and the middle of the shelf.
Physical Surface("back") = Surface In BoundingBox {-0.01, -0.01, -0.01, 0.01, width + 0.01, 48.01};
Physical Surface("shelf") = Surface In BoundingBox {37.99, -0.01, 47.99, 52.01, width + 0.01, 48.01};
Physical Volume("bracket") = Volume{:};
