// A blade in the slot of a disc, one half: its root bears on the flank of the slot. Two bodies that share no node. Lengths in mm.
//   gmsh -3 dovetail.geo -format msh41
SetFactory("OpenCASCADE");

// The blade: root, flank, neck.
Point(1) = {0, -8, 0};
Point(2) = {10, -8, 0};
Point(3) = {12, -6, 0};
Point(4) = {12, -4, 0};
Point(5) = {6, 4, 0};
Point(6) = {6, 20, 0};
Point(7) = {0, 20, 0};
Line(1) = {1, 2};
Line(2) = {2, 3};
Line(3) = {3, 4};
Line(4) = {4, 5};
Line(5) = {5, 6};
Line(6) = {6, 7};
Line(7) = {7, 1};
Curve Loop(1) = {1, 2, 3, 4, 5, 6, 7};
Plane Surface(1) = {1};

// The disc with one flank of its slot, on the line of that of the blade.
Point(11) = {6.6, 3.2, 0};
Point(12) = {11.1, -2.8, 0};
Point(13) = {13.5, -4.8, 0};
Point(14) = {13.5, -10, 0};
Point(15) = {0, -10, 0};
Point(16) = {0, -25, 0};
Point(17) = {30, -25, 0};
Point(18) = {30, 3.2, 0};
Line(11) = {11, 12};
Line(12) = {12, 13};
Line(13) = {13, 14};
Line(14) = {14, 15};
Line(15) = {15, 16};
Line(16) = {16, 17};
Line(17) = {17, 18};
Line(18) = {18, 11};
Curve Loop(2) = {11, 12, 13, 14, 15, 16, 17, 18};
Plane Surface(2) = {2};

// Prisms in three layers.
blade[] = Extrude {0, 0, 6} { Surface{1}; Layers{3}; Recombine; };
disc[] = Extrude {0, 0, 6} { Surface{2}; Layers{3}; Recombine; };
Physical Volume("blade") = {blade[1]};
Physical Volume("disc") = {disc[1]};
Physical Surface("blade flank") = {blade[5]};
Physical Surface("blade top") = {blade[7]};
Physical Surface("disc flank") = {disc[2]};
Physical Surface("disc bottom") = {disc[7]};
Physical Surface("middle") = {blade[8], disc[6]};
Physical Surface("back") = {1, 2};

// Fine along the flanks.
Field[1] = Distance;
Field[1].CurvesList = {4, 11};
Field[1].Sampling = 200;
Field[2] = Threshold;
Field[2].InField = 1;
Field[2].SizeMin = 0.35;
Field[2].SizeMax = 3;
Field[2].DistMin = 0.5;
Field[2].DistMax = 12;
Background Field = 2;
Mesh.MeshSizeExtendFromBoundary = 0;
Mesh.MeshSizeFromPoints = 0;
