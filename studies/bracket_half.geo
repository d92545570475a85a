// Half of the angle bracket of doc/method/benchmarks, y < 20 mm, with small elements where the roller touches, in mm:
//   gmsh -3 studies/bracket_half.geo -order 2 -format msh41 -o half.msh
//   stickslip run doc/method/benchmarks/bracket.toml --set mesh.file=$PWD/half.msh --set time.increments=6 --solver umfpack \
//     --set 'support=[{boundary="back",fix=["x","y","z"]},{boundary="middle",fix=["y"]}]'
// takes five minutes. Force and friction work are half of those of the bracket.
SetFactory("OpenCASCADE");
DefineConstant[size = 0.25, grow = 0.45, most = 4];
Box(1) = {0, 0, 0, 80, 20, 10};
Box(2) = {0, 0, 0, 10, 20, 60};
Cylinder(3) = {60, 20, -1, 0, 0, 12, 5};
Cylinder(4) = {-1, 20, 40, 12, 0, 0, 6};
BooleanUnion(5) = { Volume{1}; Delete; }{ Volume{2}; Delete; };
BooleanDifference(6) = { Volume{5}; Delete; }{ Volume{3, 4}; Delete; };
e = 1e-3;
Physical Surface("back") = Surface In BoundingBox {-e, -e, -e, e, 20 + e, 60 + e};
Physical Surface("top") = Surface In BoundingBox {10 - e, -e, 10 - e, 80 + e, 20 + e, 10 + e};
Physical Surface("middle") = Surface In BoundingBox {-e, 20 - e, -e, 80 + e, 20 + e, 60 + e};
Physical Volume("steel") = {6};
Field[1] = MathEval;
Field[1].F = Sprintf("Min(%g, Max(%g, %g*Sqrt((x-45.05)^2+(z-10)^2)))", most, size, grow);
Background Field = 1;
Mesh.MeshSizeExtendFromBoundary = 0;
Mesh.MeshSizeFromPoints = 0;
