// A roller with a bore that lies in a groove. Lengths in mm.
//   gmsh -2 groove.geo -format msh41
SetFactory("OpenCASCADE");
Disk(1) = {0, 0, 0, 10};
Disk(2) = {0, 0, 0, 3};
BooleanDifference(3) = { Surface{1}; Delete; }{ Surface{2}; Delete; };
Physical Curve("rim") = {1};
Physical Curve("bore") = {2};
Physical Surface("roller") = {3};

// Fine where the flanks of the groove touch, at 45 degrees to both sides.
Point(101) = {-10 / Sqrt(2), -10 / Sqrt(2), 0};
Point(102) = {10 / Sqrt(2), -10 / Sqrt(2), 0};
Field[1] = Distance;
Field[1].PointsList = {101, 102};
Field[2] = Threshold;
Field[2].InField = 1;
Field[2].SizeMin = 0.08;
Field[2].SizeMax = 1.2;
Field[2].DistMin = 0.8;
Field[2].DistMax = 10;
Background Field = 2;
Mesh.MeshSizeExtendFromBoundary = 0;
Mesh.MeshSizeFromPoints = 0;
Mesh.MeshSizeFromCurvature = 0;
