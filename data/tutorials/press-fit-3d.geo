// A quarter of a shaft (radius 20, z = 0 to 100) and of a hub (radius 20 to 40, z = 30 to 70). Lengths in mm.
//   gmsh -3 press-fit-3d.geo -format msh41
SetFactory("OpenCASCADE");
n = 12;                                     // elements along a quarter of the bore

Disk(1) = {0, 0, 0, 20};
Rectangle(2) = {0, 0, 0, 50, 50};
BooleanIntersection{ Surface{1}; Delete; }{ Surface{2}; Delete; }
Disk(11) = {0, 0, 30, 40};
Disk(12) = {0, 0, 30, 20};
Rectangle(13) = {0, 0, 30, 50, 50};
BooleanDifference(14) = { Surface{11}; Delete; }{ Surface{12}; Delete; };
BooleanIntersection(15) = { Surface{14}; Delete; }{ Surface{13}; Delete; };

Mesh.MeshSizeMin = 3.5;
Mesh.MeshSizeMax = 5;
arc[] = Curve In BoundingBox{-1, -1, -1, 20.1, 20.1, 30.1};
For i In {0 : #arc[] - 1}
  m[] = BoundingBox Curve{arc[i]};
  If (m[3] - m[0] > 19 && m[4] - m[1] > 19)
    Transfinite Curve{arc[i]} = n + 1;
  EndIf
EndFor
shaft[] = Extrude {0, 0, 100} { Surface{1}; Layers{25}; Recombine; };
hub[] = Extrude {0, 0, 40} { Surface{15}; Layers{10}; Recombine; };
Recombine Surface{1, 15};

Physical Volume("shaft") = {shaft[1]};
Physical Volume("hub") = {hub[1]};
e = 0.1;
Physical Surface("shaft top") = Surface In BoundingBox{-e, -e, 100 - e, 20 + e, 20 + e, 100 + e};
Physical Surface("hub top") = Surface In BoundingBox{-e, -e, 70 - e, 40 + e, 40 + e, 70 + e};
Physical Surface("x = 0") = Surface In BoundingBox{-e, -e, -e, e, 40 + e, 100 + e};
Physical Surface("y = 0") = Surface In BoundingBox{-e, -e, -e, 40 + e, e, 100 + e};
// The round faces of radius 20.
round[] = Surface In BoundingBox{-e, -e, -e, 20 + e, 20 + e, 100 + e};
seat[] = {}; bore[] = {};
For i In {0 : #round[] - 1}
  m[] = BoundingBox Surface{round[i]};
  If (m[3] - m[0] > 19 && m[4] - m[1] > 19 && m[5] - m[2] > 99)
    seat[] += {round[i]};
  ElseIf (m[3] - m[0] > 19 && m[4] - m[1] > 19 && m[5] - m[2] > 39)
    bore[] += {round[i]};
  EndIf
EndFor
Physical Surface("seat") = seat[];
Physical Surface("bore") = bore[];
