// A roller, lower half, that a plane presses from below. Lengths in mm.
//   gmsh -2 roller.geo -format msh41
SetFactory("OpenCASCADE");
R = 20;       // radius
fine = 0.08;  // elements where it touches, a tenth of the half-width of the contact
coarse = 4;   // elements far away
width = 1.0;  // how far from the lowest point they stay fine
half = 6 * Pi / 180;  // what may touch: so far to both sides

Point(1) = {0, R, 0};  // centre
Point(2) = {-R, R, 0};
Point(3) = {-R * Sin(half), R - R * Cos(half), 0};
Point(4) = {0, 0, 0};  // the lowest
Point(5) = {R * Sin(half), R - R * Cos(half), 0};
Point(6) = {R, R, 0};
Circle(1) = {2, 1, 3};
Circle(2) = {3, 1, 4};
Circle(3) = {4, 1, 5};
Circle(4) = {5, 1, 6};
Line(5) = {6, 2};
Curve Loop(1) = {1:5};
Plane Surface(1) = {1};

// What the scene names: curves for supports, loads and contact, surfaces for materials.
Physical Curve("tread") = {2, 3};
Physical Curve("hub") = {5};
Physical Surface("roller") = {1};

// Fine where it touches, coarser with the distance.
Field[1] = Distance;
Field[1].PointsList = {4};
Field[2] = Threshold;
Field[2].InField = 1;
Field[2].SizeMin = fine;
Field[2].SizeMax = coarse;
Field[2].DistMin = width;
Field[2].DistMax = R;
Background Field = 2;
Mesh.MeshSizeExtendFromBoundary = 0;
Mesh.MeshSizeFromPoints = 0;
Mesh.MeshSizeFromCurvature = 0;
