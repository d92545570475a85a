// The crown of a die: a dome of radius 100 mm and 30 mm across, its top in the origin. Lengths in mm.
//   gmsh -2 die.geo -format stl -bin -o die.stl
Point(1) = {0, 0, -100};
Point(2) = {0, 0, 0};
Point(3) = {15, 0, Sqrt(100^2 - 15^2) - 100};
Circle(1) = {2, 1, 3};     // in this order the triangles face upwards
a[] = Extrude {{0, 0, 1}, {0, 0, 0}, Pi / 2} { Curve{1}; };
b[] = Extrude {{0, 0, 1}, {0, 0, 0}, Pi / 2} { Curve{a[0]}; };
c[] = Extrude {{0, 0, 1}, {0, 0, 0}, Pi / 2} { Curve{b[0]}; };
Extrude {{0, 0, 1}, {0, 0, 0}, Pi / 2} { Curve{c[0]}; }
Mesh.MeshSizeMin = 1;
Mesh.MeshSizeMax = 1;
