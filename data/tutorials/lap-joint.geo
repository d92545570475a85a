// Two plates that overlap by 40 mm. Lengths in mm. The plates share no node.
//   gmsh -2 lap-joint.geo -format msh41
// A finer mesh: gmsh -2 lap-joint.geo -format msh41 -setnumber n 2 -o lap-joint-fine.msh
DefineConstant[ n = 1 ];          // elements of 0.5 mm along the lap; n = 2: 0.25 mm, n = 0.5: 1 mm

// One plate from x0: a run without contact, the lap in three parts (free, clamped, free), another run without contact.
Macro Plate
  p = newp;
  For i In {0:4}
    Point(p + i) = {xs[i], y0, 0};
    Point(p + 5 + i) = {xs[i], y0 + 5, 0};
  EndFor
  c = newc;
  For i In {0:3}
    Line(c + i) = {p + i, p + i + 1};          // lower side
    Line(c + 4 + i) = {p + 5 + i, p + 6 + i};  // upper side
  EndFor
  For i In {0:4}
    Line(c + 8 + i) = {p + i, p + 5 + i};      // across
  EndFor
  s = news;
  For i In {0:3}
    Curve Loop(s + i) = {c + i, c + 9 + i, -(c + 4 + i), -(c + 8 + i)};
    Plane Surface(s + i) = {s + i};
    Transfinite Curve{c + i, c + 4 + i} = n * ns[i] + 1;
  EndFor
  Transfinite Curve{c + 8 : c + 12} = n * 10 + 1;
  Transfinite Surface{s : s + 3};
  Recombine Surface{s : s + 3};
Return

// The lower plate: x = 0 to 100, its lap from 60 on.
xs[] = {0, 60, 72, 88, 100}; y0 = 0; ns[] = {30, 24, 32, 24};
Call Plate;
Physical Surface("lower") = {s : s + 3};
Physical Curve("lower left") = {c + 8};
Physical Curve("lower lap") = {c + 5, c + 6, c + 7};
Physical Curve("lower washer") = {c + 2};

// The upper plate: x = 60 to 160, its lap up to 100.
xs[] = {60, 72, 88, 100, 160}; y0 = 5; ns[] = {24, 32, 24, 30};
Call Plate;
Physical Surface("upper") = {s : s + 3};
Physical Curve("upper right") = {c + 12};
Physical Curve("upper lap") = {c, c + 1, c + 2};
Physical Curve("upper washer") = {c + 5};
