// Thick sphere: the eighth x, y, z >= 0 of the shell 1 <= r <= 2.
//
// Unit: meter (lengths are relative to the inner radius of 1). The inner surface
// is open at the three symmetry planes, where flat caps close the cavity. With
// -order 2 the nodes of curved edges lie on the true spheres.
//
// Regions: body. Surfaces: inner, outer, symmetry_x (x = 0, hold u_x),
// symmetry_y, symmetry_z.
SetFactory("Built-in");
DefineConstant[ h = {0.30, Name "Parameters/target edge length [m]"} ];
Include "options.geo";

Point(1) = {0, 0, 0};
For i In {0:1}
  r = 1 + i;
  s = (i == 0) ? 0.75 * h : 1.25 * h;
  Point(10 + 10 * i) = {r, 0, 0, s};
  Point(11 + 10 * i) = {0, r, 0, s};
  Point(12 + 10 * i) = {0, 0, r, s};
  Circle(10 + 10 * i) = {10 + 10 * i, 1, 11 + 10 * i};
  Circle(11 + 10 * i) = {11 + 10 * i, 1, 12 + 10 * i};
  Circle(12 + 10 * i) = {12 + 10 * i, 1, 10 + 10 * i};
  Curve Loop(1 + i) = {10 + 10 * i, 11 + 10 * i, 12 + 10 * i};
  Surface(1 + i) = {1 + i} In Sphere {1};
EndFor
Line(1) = {10, 20};
Line(2) = {11, 21};
Line(3) = {12, 22};
Curve Loop(3) = {2, 21, -3, -11};
Curve Loop(4) = {3, 22, -1, -12};
Curve Loop(5) = {1, 20, -2, -10};
For i In {3:5}
  Plane Surface(i) = {i};
EndFor
Surface Loop(1) = {1 : 5};
Volume(1) = {1};

Physical Volume("body", 1) = {1};
Physical Surface("inner", 2) = {1};
Physical Surface("outer", 3) = {2};
Physical Surface("symmetry_x", 4) = {3};
Physical Surface("symmetry_y", 5) = {4};
Physical Surface("symmetry_z", 6) = {5};

ReverseMesh Surface{1, 3 : 5};    // so that every surface faces outward
